//! Collision tests of outlines.

use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use super::{cells, check};
use crate::footprint;
use crate::shape::Shape;

/// A robot's outline on a map; poses are (x, y, heading) with positions in cells.
#[pyclass(frozen, module = "semantic_attachments._core")]
pub struct Footprint {
    footprint: footprint::Footprint,
    cells: usize,
}

fn poses(array: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<footprint::Pose>> {
    check(array.shape()[1] == 3, "poses have shape (n, 3)")?;
    let rows = array.as_array();
    Ok(rows
        .rows()
        .into_iter()
        .map(|row| [row[0], row[1], row[2]])
        .collect())
}

#[pymethods]
impl Footprint {
    /// `corners` (n, 2) of a convex polygon, counter-clockwise, or a disc if there are none; in cells.
    #[new]
    fn new(
        solid: PyReadonlyArray2<'_, bool>,
        forbidden: PyReadonlyArray2<'_, bool>,
        clearance_cells: PyReadonlyArray2<'_, f32>,
        corners: Vec<[f64; 2]>,
        radius_cells: f64,
    ) -> PyResult<Self> {
        let shape = Shape {
            height: solid.shape()[0],
            width: solid.shape()[1],
        };
        check(!shape.is_empty(), "the map has no cells")?;
        check(
            forbidden.shape() == solid.shape(),
            "`forbidden` has another shape than `solid`",
        )?;
        check(
            clearance_cells.shape() == solid.shape(),
            "`clearance_cells` has another shape than `solid`",
        )?;
        let outline = if corners.is_empty() {
            check(
                radius_cells.is_finite() && radius_cells >= 0.0,
                "the radius is not a length",
            )?;
            footprint::Outline::Disc(radius_cells)
        } else {
            check(corners.len() >= 3, "a polygon has three corners or more")?;
            check(
                corners.iter().flatten().all(|value| value.is_finite()),
                "a corner is not a position",
            )?;
            footprint::Outline::Polygon(corners)
        };
        let cells_of = cells(&solid);
        Ok(Self {
            cells: shape.len(),
            footprint: footprint::Footprint::new(
                shape,
                outline,
                cells_of,
                cells(&forbidden),
                cells(&clearance_cells),
            ),
        })
    }

    /// Whether the robot can stand at a pose.
    fn is_free(&self, x: f64, y: f64, heading: f64) -> bool {
        self.footprint.is_free([x, y, heading])
    }

    /// Whether the robot can stand at all of (n, 3) poses.
    #[pyo3(name = "all_free")]
    fn all_free(&self, path: PyReadonlyArray2<'_, f64>) -> PyResult<bool> {
        Ok(poses(&path)?
            .into_iter()
            .all(|pose| self.footprint.is_free(pose)))
    }

    /// Whether the robot overlaps one of some cells at some of (n, 3) poses.
    fn hits(&self, path: PyReadonlyArray2<'_, f64>, cells: Vec<u32>) -> PyResult<bool> {
        check(
            cells.iter().all(|&cell| (cell as usize) < self.cells),
            "a cell is outside of the map",
        )?;
        Ok(self.footprint.hits(&poses(&path)?, &cells))
    }
}
