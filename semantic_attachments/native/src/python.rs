//! Conversions between NumPy arrays and the kernels; nothing else lives here.
//!
//! Arrays of a map have shape (height, width), row 0 at the bottom; a cell is `row * width + column`.

use std::sync::Arc;

use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::any_angle;
use crate::footprint;
use crate::line_of_sight;
use crate::one_to_all;
use crate::reach;
use crate::shape::Shape;
use crate::traversability;

/// The known map as one class of robots sees it, with blockades that can be opened one by one.
#[pyclass(frozen, module = "semantic_attachments._core")]
struct Traversability {
    map: Arc<traversability::Traversability>,
}

/// The shortest-path tree of one cell.
#[pyclass(frozen, module = "semantic_attachments._core")]
struct Field {
    field: one_to_all::Field,
}

fn cells<T: numpy::Element + Copy>(array: &PyReadonlyArray2<'_, T>) -> Vec<T> {
    array.as_array().iter().copied().collect()
}

fn check(ok: bool, message: &str) -> PyResult<()> {
    if ok {
        Ok(())
    } else {
        Err(PyValueError::new_err(message.to_owned()))
    }
}

impl Traversability {
    fn check_cell(&self, cell: u32) -> PyResult<()> {
        check(
            (cell as usize) < self.map.shape.len(),
            "a cell is outside of the map",
        )
    }

    fn check_opened(&self, opened: &[usize]) -> PyResult<()> {
        let known = opened
            .iter()
            .all(|&blockade| blockade < self.map.blockade_count());
        check(known, "an opened blockade is not in the map")
    }
}

#[pymethods]
impl Traversability {
    #[new]
    #[pyo3(signature = (solid, forbidden, radius_cells, multiplier=None, blockades=Vec::new()))]
    fn new(
        py: Python<'_>,
        solid: PyReadonlyArray2<'_, bool>,
        forbidden: PyReadonlyArray2<'_, bool>,
        radius_cells: f64,
        multiplier: Option<PyReadonlyArray2<'_, f32>>,
        blockades: Vec<Vec<u32>>,
    ) -> PyResult<Self> {
        let [height, width] = [solid.shape()[0], solid.shape()[1]];
        let shape = Shape { height, width };
        check(!shape.is_empty(), "the map has no cells")?;
        check(
            shape.len() < u32::MAX as usize,
            "the map has more than 2^32 - 2 cells",
        )?;
        check(
            forbidden.shape() == solid.shape(),
            "`forbidden` has another shape than `solid`",
        )?;
        check(
            radius_cells.is_finite() && radius_cells >= 0.0,
            "`radius_cells` is not a length",
        )?;
        if let Some(factors) = &multiplier {
            check(
                factors.shape() == solid.shape(),
                "`multiplier` has another shape than `solid`",
            )?;
            let valid = factors
                .as_array()
                .iter()
                .all(|&factor| (1.0..=1e4).contains(&factor));
            check(valid, "a multiplier is not between 1 and 10000")?;
        }
        let inside = blockades
            .iter()
            .flatten()
            .all(|&cell| (cell as usize) < shape.len());
        check(inside, "a cell of a blockade is outside of the map")?;
        let (solid, forbidden) = (cells(&solid), cells(&forbidden));
        let multiplier = multiplier.as_ref().map(cells);
        let map = py.detach(|| {
            traversability::Traversability::new(
                shape,
                solid,
                &forbidden,
                radius_cells,
                multiplier,
                blockades,
            )
        });
        Ok(Self { map: Arc::new(map) })
    }

    /// (height, width) of the map.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.map.shape.height, self.map.shape.width)
    }

    /// (height, width) bool: where a robot's centre may be if there were no blockades.
    fn open<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        let (height, width) = self.shape();
        self.map
            .open()
            .to_vec()
            .into_pyarray(py)
            .reshape([height, width])
    }

    /// (height, width) bool: where a robot's centre may be with the given blockades opened.
    #[pyo3(signature = (opened=Vec::new()))]
    fn passable<'py>(
        &self,
        py: Python<'py>,
        opened: Vec<usize>,
    ) -> PyResult<Bound<'py, PyArray2<bool>>> {
        self.check_opened(&opened)?;
        let (height, width) = self.shape();
        let passable = py.detach(|| self.map.all_passable(&opened));
        passable.into_pyarray(py).reshape([height, width])
    }

    /// (n,) uint32: the cells a blockade covers once inflated, ascending.
    fn stamp<'py>(&self, py: Python<'py>, blockade: usize) -> PyResult<Bound<'py, PyArray1<u32>>> {
        self.check_opened(&[blockade])?;
        Ok(self.map.stamp(blockade).to_vec().into_pyarray(py))
    }

    /// The nearest cell a robot's centre may be in and its distance [cells], or None within the limit.
    fn nearest(
        &self,
        cell: u32,
        opened: Vec<usize>,
        limit_cells: f64,
    ) -> PyResult<Option<(u32, f64)>> {
        self.check_cell(cell)?;
        self.check_opened(&opened)?;
        Ok(self.map.nearest_passable(cell, &opened, limit_cells))
    }

    /// Distances from one cell to all others with the given blockades opened.
    #[pyo3(signature = (source, opened=Vec::new()))]
    fn field(&self, py: Python<'_>, source: u32, opened: Vec<usize>) -> PyResult<Field> {
        self.check_cell(source)?;
        self.check_opened(&opened)?;
        let map = &self.map;
        let field = py.detach(|| {
            let moves = map.moves(&opened);
            one_to_all::one_to_all(map.shape, &moves, map.multiplier.as_deref(), source)
        });
        Ok(Field { field })
    }

    /// Any-angle distances from one cell to all others with the given blockades opened.
    #[pyo3(signature = (source, opened=Vec::new()))]
    fn any_angle(
        &self,
        py: Python<'_>,
        source: u32,
        opened: Vec<usize>,
    ) -> PyResult<AnyAngleField> {
        self.check_cell(source)?;
        self.check_opened(&opened)?;
        let map = &self.map;
        let field = py.detach(|| {
            let (moves, passable) = (map.moves(&opened), map.all_passable(&opened));
            let multiplier = map.multiplier.as_deref();
            any_angle::any_angle(map.shape, &moves, &passable, multiplier, source)
        });
        Ok(AnyAngleField { field })
    }

    /// Distance and cells to `goal` with `opened` open, from a field grown with a subset of them open.
    fn reach<'py>(
        &self,
        py: Python<'py>,
        field: &Field,
        goal: u32,
        opened: Vec<usize>,
    ) -> PyResult<(f64, Bound<'py, PyArray1<u32>>)> {
        self.check_cell(goal)?;
        self.check_opened(&opened)?;
        check(
            field.field.shape == self.map.shape,
            "the field belongs to a map of another shape",
        )?;
        let (distance, path) = reach::reach(&self.map, &field.field, goal, &opened);
        Ok((distance, path.into_pyarray(py)))
    }

    /// The cells of a path between which there is no line of sight; (n,) to (m,) uint32.
    #[pyo3(signature = (path, opened=Vec::new()))]
    fn way_points<'py>(
        &self,
        py: Python<'py>,
        path: Vec<u32>,
        opened: Vec<usize>,
    ) -> PyResult<Bound<'py, PyArray1<u32>>> {
        path.iter().try_for_each(|&cell| self.check_cell(cell))?;
        self.check_opened(&opened)?;
        let passable = |cell| self.map.passable(cell, &opened);
        Ok(line_of_sight::way_points(self.map.shape, &path, passable).into_pyarray(py))
    }
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
        let shape = self.field.shape;
        self.field
            .distances
            .clone()
            .into_pyarray(py)
            .reshape([shape.height, shape.width])
    }

    /// Distance of one cell [cells].
    fn distance(&self, cell: u32) -> PyResult<f64> {
        self.check_cell(cell)?;
        Ok(self.field.distances[cell as usize])
    }

    /// (n,) uint32: the cells from the source to a goal, empty if there is no path.
    fn path_to<'py>(&self, py: Python<'py>, goal: u32) -> PyResult<Bound<'py, PyArray1<u32>>> {
        self.check_cell(goal)?;
        Ok(self.field.path_to(goal).into_pyarray(py))
    }

    /// Memory the field holds [bytes].
    #[getter]
    fn nbytes(&self) -> usize {
        self.field.distances.len() * 8 + self.field.steps.len()
    }
}

/// The tree of straight lines from one cell.
#[pyclass(frozen, module = "semantic_attachments._core")]
struct AnyAngleField {
    field: any_angle::AnyAngleField,
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

/// A robot's outline on a map; poses are (x, y, heading) with positions in cells.
#[pyclass(frozen, module = "semantic_attachments._core")]
struct Footprint {
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

/// The extension module `semantic_attachments._core`.
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<Traversability>()?;
    module.add_class::<AnyAngleField>()?;
    module.add_class::<Footprint>()?;
    module.add_class::<Field>()
}
