//! Maps of classes of robots.

use std::sync::Arc;

use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods,
};
use pyo3::prelude::*;

use super::field::{AnyAngleField, Field};
use super::{cells, check};
use crate::any_angle;
use crate::legs;
use crate::line_of_sight;
use crate::repair;
use crate::shape::Shape;
use crate::traversability;

type Legs<'py> = (
    Vec<f64>,
    Vec<bool>,
    Vec<bool>,
    Bound<'py, PyArray1<u32>>,
    Vec<usize>,
);

/// The known map as one class of robots sees it, with blockades that can be opened one by one.
#[pyclass(frozen, module = "semantic_attachments._core")]
pub struct Traversability {
    map: Arc<traversability::Traversability>,
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

    fn check_field(&self, field: &Field) -> PyResult<()> {
        check(
            field.field.shape == self.map.shape,
            "the field belongs to a map of another shape",
        )
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
        let field = py.detach(|| self.map.field(source, &opened));
        Ok(Field {
            field: Arc::new(field),
        })
    }

    /// A field that was grown on another state of the map, and the number of cells computed for it.
    ///
    /// None where it is better grown anew.
    #[pyo3(signature = (field, opened=Vec::new()))]
    fn repair(
        &self,
        py: Python<'_>,
        field: &Field,
        opened: Vec<usize>,
    ) -> PyResult<Option<(Field, usize)>> {
        self.check_opened(&opened)?;
        self.check_field(field)?;
        let old = &field.field;
        let repaired = py
            .detach(|| repair::repair(old, self.map.moves(&opened), self.map.multiplier.as_ref()));
        Ok(repaired.map(|(field, computed)| {
            let field = Arc::new(field);
            (Field { field }, computed)
        }))
    }

    /// Shortest paths from one place (cell, open blockade) to others, by the field of where a robot stands there.
    ///
    /// Lengths [cells] (n,), NaN where it stands elsewhere for the sake of the goal's blockade; whether source and goals
    /// are off the path (n,) each; cells of all paths (m,) and the ends of the paths in them (n,).
    fn legs<'py>(
        &self,
        py: Python<'py>,
        field: &Field,
        source: (u32, Option<usize>),
        goals: Vec<(u32, Option<usize>)>,
        limit_cells: f64,
    ) -> PyResult<Legs<'py>> {
        self.check_field(field)?;
        for &(cell, blockade) in goals.iter().chain([&source]) {
            self.check_cell(cell)?;
            self.check_opened(blockade.as_slice())?;
        }
        let place = |(cell, blockade): (u32, Option<usize>)| legs::Place { cell, blockade };
        let goals: Vec<_> = goals.into_iter().map(place).collect();
        let (map, grown) = (&self.map, &field.field);
        let found = py.detach(|| legs::legs(map, grown, place(source), &goals, limit_cells));
        let mut lengths = Vec::with_capacity(found.len());
        let (mut left, mut right) = (Vec::new(), Vec::new());
        let (mut cells, mut ends) = (Vec::new(), Vec::new());
        for leg in found {
            lengths.push(leg.as_ref().map_or(f64::NAN, |leg| leg.length));
            left.push(leg.as_ref().is_some_and(|leg| leg.snapped.0));
            right.push(leg.as_ref().is_some_and(|leg| leg.snapped.1));
            cells.extend(leg.into_iter().flat_map(|leg| leg.path));
            ends.push(cells.len());
        }
        Ok((lengths, left, right, cells.into_pyarray(py), ends))
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
            let multiplier = map.multiplier.as_ref().map(|factors| &factors[..]);
            any_angle::any_angle(map.shape, &moves, &passable, multiplier, source)
        });
        Ok(AnyAngleField { field })
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
