//! Border of the 3D scene.

use crate::scene::{Cylinder, SolidBox, Solids};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The kernel behind `simulator.mapping.scene.Scene`.
#[pyclass(name = "Solids", module = "simulator._core", frozen)]
pub struct PySolids {
    solids: Solids,
}

fn columns(array: &PyReadonlyArray2<'_, f64>, expected: usize, what: &str) -> PyResult<()> {
    let shape = array.shape();
    if shape[1] == expected {
        Ok(())
    } else {
        Err(PyValueError::new_err(format!(
            "{what} have shape ({}, {}); expected (n, {expected})",
            shape[0], shape[1]
        )))
    }
}

#[pymethods]
impl PySolids {
    /// Boxes `(n, 7)`: centre, size, turn about z; cylinders `(n, 6)`: base, radius, height, closed.
    #[new]
    fn new(
        boxes: PyReadonlyArray2<'_, f64>,
        cylinders: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Self> {
        columns(&boxes, 7, "boxes")?;
        columns(&cylinders, 6, "cylinders")?;
        let boxes = boxes
            .as_array()
            .rows()
            .into_iter()
            .map(|row| SolidBox {
                centre_m: [row[0], row[1], row[2]],
                half_m: [row[3] / 2.0, row[4] / 2.0, row[5] / 2.0],
                turn: [row[6].cos(), row[6].sin()],
            })
            .collect();
        let cylinders = cylinders
            .as_array()
            .rows()
            .into_iter()
            .map(|row| Cylinder {
                base_m: [row[0], row[1], row[2]],
                radius_m: row[3],
                height_m: row[4],
                closed: row[5] != 0.0,
            })
            .collect();
        Ok(Self {
            solids: Solids { boxes, cylinders },
        })
    }

    /// Distance `(n,)` along unit directions `(n, 3)` and the number of the solid that is hit `(n,)`.
    #[allow(clippy::type_complexity)]
    fn cast<'py>(
        &self,
        py: Python<'py>,
        origin_m: [f64; 3],
        directions: PyReadonlyArray2<'py, f64>,
        threads: usize,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<i32>>)> {
        columns(&directions, 3, "directions")?;
        let directions: Vec<[f64; 3]> = directions
            .as_array()
            .rows()
            .into_iter()
            .map(|row| [row[0], row[1], row[2]])
            .collect();
        let (distances, numbers): (Vec<f64>, Vec<i32>) = py
            .detach(|| self.solids.cast(origin_m, &directions, threads))
            .into_iter()
            .unzip();
        Ok((distances.into_pyarray(py), numbers.into_pyarray(py)))
    }
}
