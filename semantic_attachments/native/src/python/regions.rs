//! Border of the kernels on regions of a map: distance transform, skeleton, geodesic distances.

use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::prelude::*;

use super::{cells, check};
use crate::geodesic;
use crate::shape::Shape;
use crate::{distance_transform, skeleton};

/// Distance of every cell to the nearest obstacle, and which one that is.
#[pyclass(frozen, module = "semantic_attachments._core")]
pub struct DistanceTransform {
    shape: Shape,
    transform: distance_transform::DistanceTransform,
}

fn shape_of(mask: &PyReadonlyArray2<'_, bool>) -> PyResult<Shape> {
    let shape = Shape {
        height: mask.shape()[0],
        width: mask.shape()[1],
    };
    check(!shape.is_empty(), "the map has no cells")?;
    check(
        shape.height.max(shape.width) < 40_000 && shape.len() < u32::MAX as usize,
        "the map has more than 40,000 rows or columns",
    )?;
    Ok(shape)
}

fn check_cells(shape: Shape, cells: &[u32]) -> PyResult<()> {
    check(
        cells.iter().all(|&cell| (cell as usize) < shape.len()),
        "a cell is outside of the map",
    )
}

#[pymethods]
impl DistanceTransform {
    #[new]
    fn new(py: Python<'_>, obstacles: PyReadonlyArray2<'_, bool>) -> PyResult<Self> {
        let shape = shape_of(&obstacles)?;
        let obstacles = cells(&obstacles);
        let transform = py.detach(|| distance_transform::distance_transform(shape, &obstacles));
        Ok(Self { shape, transform })
    }

    /// (height, width) float32: distance to the nearest obstacle [cells], infinite without any.
    fn distances<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let distance = |&squared: &u32| match squared {
            distance_transform::NO_OBSTACLE => f32::INFINITY,
            squared => (squared as f32).sqrt(),
        };
        let distances: Vec<f32> = self.transform.squared.iter().map(distance).collect();
        distances
            .into_pyarray(py)
            .reshape([self.shape.height, self.shape.width])
    }

    /// (height, width) uint32: the nearest obstacle's cell.
    fn nearest<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        self.transform
            .nearest
            .clone()
            .into_pyarray(py)
            .reshape([self.shape.height, self.shape.width])
    }

    /// (height, width) bool: the skeleton of a region along the ridges of the distances.
    fn skeleton<'py>(
        &self,
        py: Python<'py>,
        region: PyReadonlyArray2<'_, bool>,
        least_chord_cells: f64,
        least_chord_ratio: f64,
    ) -> PyResult<Bound<'py, PyArray2<bool>>> {
        check(
            shape_of(&region)? == self.shape,
            "`region` has another shape than the obstacles",
        )?;
        let region = cells(&region);
        let pruning = skeleton::Pruning {
            least_chord_cells,
            least_chord_ratio,
        };
        let found = py.detach(|| skeleton::skeleton(self.shape, &region, &self.transform, pruning));
        found
            .into_pyarray(py)
            .reshape([self.shape.height, self.shape.width])
    }
}

/// A part of a map in which paths are measured.
#[pyclass(frozen, module = "semantic_attachments._core")]
pub struct Region {
    region: geodesic::Region,
}

/// Lengths of the shortest paths from the nearest of several sources.
#[pyclass(frozen, module = "semantic_attachments._core")]
pub struct Geodesic {
    shape: Shape,
    field: geodesic::Geodesic,
}

#[pymethods]
impl Region {
    #[new]
    fn new(py: Python<'_>, inside: PyReadonlyArray2<'_, bool>) -> PyResult<Self> {
        let shape = shape_of(&inside)?;
        let inside = cells(&inside);
        let region = py.detach(|| geodesic::Region::new(shape, &inside));
        Ok(Self { region })
    }

    /// Path lengths from the nearest source, no further than needed for the goals, if there are any.
    #[pyo3(signature = (sources, goals=Vec::new()))]
    fn geodesic(&self, py: Python<'_>, sources: Vec<u32>, goals: Vec<u32>) -> PyResult<Geodesic> {
        let shape = self.region.shape();
        check_cells(shape, &sources)?;
        check_cells(shape, &goals)?;
        let field = py.detach(|| self.region.geodesic(&sources, &goals));
        Ok(Geodesic { shape, field })
    }

    /// (n,) uint32: the cells of a shortest path from `start` to its nearest source; empty if none.
    fn descend<'py>(
        &self,
        py: Python<'py>,
        field: &Geodesic,
        start: u32,
    ) -> PyResult<Bound<'py, PyArray1<u32>>> {
        check(
            field.shape == self.region.shape(),
            "the field belongs to a map of another shape",
        )?;
        check_cells(field.shape, &[start])?;
        Ok(self.region.descend(&field.field, start).into_pyarray(py))
    }
}

#[pymethods]
impl Geodesic {
    /// (height, width) float32: path lengths [cells], infinite where there is no path.
    fn lengths<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        self.field
            .lengths_cells()
            .into_pyarray(py)
            .reshape([self.shape.height, self.shape.width])
    }

    /// (n,) float32: path lengths to some cells [cells].
    fn lengths_to<'py>(
        &self,
        py: Python<'py>,
        cells: Vec<u32>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        check_cells(self.shape, &cells)?;
        let lengths: Vec<f32> = cells
            .iter()
            .map(|&cell| self.field.length_cells(cell as usize))
            .collect();
        Ok(lengths.into_pyarray(py))
    }

    /// (height, width) uint32: index of the nearest source, 2^32 - 1 where there is no path.
    fn sources<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        self.field
            .sources()
            .into_pyarray(py)
            .reshape([self.shape.height, self.shape.width])
    }
}
