//! `simulator._core.OccupancyMap`: log odds from laser scans.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::occupancy::{OccupancyMap, SensorModel};

/// Log odds of occupation on a grid, row 0 at the bottom.
#[pyclass(name = "OccupancyMap", module = "simulator._core")]
#[derive(Clone)]
pub struct PyOccupancyMap {
    map: OccupancyMap,
    shape: (usize, usize),
}

#[pymethods]
impl PyOccupancyMap {
    #[new]
    fn new(
        shape: (usize, usize),
        resolution_m: f64,
        origin_m: (f64, f64),
        hit: f32,
        miss: f32,
        limit: f32,
    ) -> PyResult<Self> {
        if resolution_m.is_nan() || resolution_m <= 0.0 || limit <= 0.0 {
            return Err(PyValueError::new_err(
                "resolution_m and limit must be positive",
            ));
        }
        let model = SensorModel { hit, miss, limit };
        let origin_m = [origin_m.0, origin_m.1];
        Ok(Self {
            map: OccupancyMap::new(shape.1, shape.0, resolution_m, origin_m, model),
            shape,
        })
    }

    /// Takes in a full-circle scan, the first beam along the heading.
    fn insert(
        &mut self,
        x: f64,
        y: f64,
        heading_rad: f64,
        ranges_m: PyReadonlyArray1<'_, f32>,
        range_m: f64,
    ) -> PyResult<()> {
        self.map
            .insert([x, y], heading_rad, ranges_m.as_slice()?, range_m);
        Ok(())
    }

    /// Takes in a fan of beams, the first one in direction `first_rad` of the map frame.
    fn insert_fan(
        &mut self,
        origin_m: (f64, f64),
        first_rad: f64,
        step_rad: f64,
        ranges_m: PyReadonlyArray1<'_, f32>,
        range_m: f64,
    ) -> PyResult<()> {
        let origin = [origin_m.0, origin_m.1];
        let ranges = ranges_m.as_slice()?;
        self.map
            .insert_fan(origin, first_rad, step_rad, ranges, range_m);
        Ok(())
    }

    /// Takes over whatever another map of the same shape is more certain of.
    fn merge(&mut self, other: &Self) -> PyResult<()> {
        if self.shape != other.shape {
            return Err(PyValueError::new_err("the maps have different shapes"));
        }
        self.map.merge(&other.map);
        Ok(())
    }

    /// A map of its own with the same content.
    fn copy(&self) -> Self {
        self.clone()
    }

    /// (rows, columns) int8: occupancy in percent, -1 where nothing was seen.
    fn percent<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i8>>> {
        PyArray1::from_vec(py, self.map.percent()).reshape([self.shape.0, self.shape.1])
    }

    /// All cells' log odds, (rows, columns); zero where nothing was seen.
    fn log_odds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        PyArray1::from_slice(py, self.map.log_odds()).reshape([self.shape.0, self.shape.1])
    }
}
