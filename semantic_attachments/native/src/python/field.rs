//! Fields of distances.

use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use super::check;
use crate::any_angle;
use crate::field;

/// The shortest-path tree of one cell.
#[pyclass(frozen, module = "semantic_attachments._core")]
pub struct Field {
    pub field: Arc<field::Field>,
}

impl Field {
    fn check_cell(&self, cell: u32) -> PyResult<()> {
        check(
            (cell as usize) < self.field.shape.len(),
            "a cell is outside of the map",
        )
    }
}

#[pymethods]
impl Field {
    /// The cell the distances are from.
    #[getter]
    fn source(&self) -> u32 {
        self.field.source
    }

    /// (height, width) float64: distance of each cell [cells], infinite where there is no path.
    fn distances<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (shape, field) = (self.field.shape, &self.field);
        py.detach(|| field.distances())
            .into_pyarray(py)
            .reshape([shape.height, shape.width])
    }

    /// Distance of one cell [cells].
    fn distance(&self, cell: u32) -> PyResult<f64> {
        self.check_cell(cell)?;
        Ok(self.field.distance(cell))
    }

    /// (n,) uint32: the cells from the source to a goal, empty if there is no path.
    fn path_to<'py>(&self, py: Python<'py>, goal: u32) -> PyResult<Bound<'py, PyArray1<u32>>> {
        self.check_cell(goal)?;
        Ok(self.field.path_to(goal).into_pyarray(py))
    }

    /// Memory the field holds [bytes].
    #[getter]
    fn nbytes(&self) -> usize {
        self.field.nbytes()
    }
}

/// The tree of straight lines from one cell.
#[pyclass(frozen, module = "semantic_attachments._core")]
pub struct AnyAngleField {
    pub field: any_angle::AnyAngleField,
}

#[pymethods]
impl AnyAngleField {
    /// Memory the field holds [bytes].
    #[getter]
    fn nbytes(&self) -> usize {
        self.field.distances.len() * 12
    }

    /// Distance of one cell [cells].
    fn distance(&self, cell: u32) -> PyResult<f64> {
        let known = self.field.distances.get(cell as usize).copied();
        known.ok_or_else(|| PyValueError::new_err("a cell is outside of the map"))
    }

    /// (n,) uint32: all cells touched on the way to a goal, empty if there is no path.
    fn path_to<'py>(&self, py: Python<'py>, goal: u32) -> PyResult<Bound<'py, PyArray1<u32>>> {
        self.distance(goal)?;
        Ok(self.field.path_to(goal).into_pyarray(py))
    }
}
