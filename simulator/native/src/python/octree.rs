//! Border of the 3D occupancy map.

use crate::octree::files;
use crate::octree::gain::Region;
use crate::octree::insertion::{Bounds, Limits};
use crate::octree::key::{LIMIT, VoxelKey};
use crate::octree::map::{Channel, Combination, MapFull, OccupancyMap};
use crate::octree::ray::RayEnd;
use crate::octree::sensor_model::SensorModel;
use crate::octree::tree;
use numpy::{
    IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyKeyError, PyMemoryError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// The kernel behind `simulator.mapping.octree.OctreeMap`.
#[pyclass(name = "Octree", module = "simulator._core")]
pub struct PyOctree {
    map: OccupancyMap,
}

type Constants = (f64, f64, f64, f64, f64);
type Corners = ([i32; 3], [i32; 3]);

fn region_of((low, high): Corners) -> Region {
    Region {
        low: VoxelKey(low),
        high: VoxelKey(high),
    }
}

fn full(refusal: MapFull) -> PyErr {
    PyMemoryError::new_err(refusal.to_string())
}

fn model((quantum, hit, miss, lowest, highest): Constants) -> PyResult<SensorModel> {
    SensorModel::new(quantum, hit, miss, lowest, highest).map_err(PyValueError::new_err)
}

fn points(array: &PyReadonlyArray2<'_, f32>) -> PyResult<Vec<[f32; 3]>> {
    if array.shape()[1] != 3 {
        return Err(PyValueError::new_err(format!(
            "points have shape ({}, {}); expected (n, 3)",
            array.shape()[0],
            array.shape()[1]
        )));
    }
    Ok(array
        .as_array()
        .rows()
        .into_iter()
        .map(|row| [row[0], row[1], row[2]])
        .collect())
}

fn combination(name: &str) -> PyResult<Combination> {
    match name {
        "max" => Ok(Combination::Maximum),
        "mean" => Ok(Combination::Mean),
        _ => Err(PyValueError::new_err(format!(
            "combine by 'max' or 'mean', not {name:?}"
        ))),
    }
}

#[pymethods]
impl PyOctree {
    #[new]
    fn new(
        resolution_m: f64,
        constants: Constants,
        memory_limit_bytes: Option<usize>,
    ) -> PyResult<Self> {
        if !(resolution_m > 0.0 && resolution_m.is_finite()) {
            return Err(PyValueError::new_err(format!(
                "resolution_m must be positive, not {resolution_m}"
            )));
        }
        let mut map = OccupancyMap::new(resolution_m, model(constants)?);
        map.memory_limit_bytes = memory_limit_bytes;
        Ok(Self { map })
    }

    #[staticmethod]
    fn read(
        py: Python<'_>,
        bytes: &[u8],
        constants: Constants,
        memory_limit_bytes: Option<usize>,
    ) -> PyResult<Self> {
        let model = model(constants)?;
        let map = py
            .detach(|| files::read(bytes, model, memory_limit_bytes))
            .map_err(PyValueError::new_err)?;
        Ok(Self { map })
    }

    #[getter]
    fn resolution_m(&self) -> f64 {
        self.map.lattice.resolution_m
    }

    fn insert_scan(
        &mut self,
        py: Python<'_>,
        origin_m: [f32; 3],
        end_points_m: PyReadonlyArray2<'_, f32>,
        max_range_m: Option<f64>,
        bounds_m: Option<([f32; 3], [f32; 3])>,
        threads: usize,
    ) -> PyResult<()> {
        let end_points = points(&end_points_m)?;
        let bounds = bounds_m.map(|(low_m, high_m)| Bounds { low_m, high_m });
        let limits = Limits {
            max_range_m,
            bounds,
        };
        let map = &mut self.map;
        py.detach(|| map.insert_scan(origin_m, &end_points, &limits, threads))
            .map_err(full)
    }

    fn log_odds<'py>(
        &self,
        py: Python<'py>,
        points_m: PyReadonlyArray2<'py, f32>,
        levels: u32,
        combine: &str,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (points, how) = (points(&points_m)?, combination(combine)?);
        let values: Vec<f64> = py.detach(|| {
            points
                .iter()
                .map(|&point| self.map.log_odds(point, levels, how))
                .collect()
        });
        Ok(values.into_pyarray(py))
    }

    /// End (0 hit, 1 unknown, 2 range) and last voxel's centre of each ray.
    #[allow(clippy::type_complexity)]
    fn cast_rays<'py>(
        &self,
        py: Python<'py>,
        origins_m: PyReadonlyArray2<'py, f32>,
        directions: PyReadonlyArray2<'py, f32>,
        max_range_m: f64,
        through_unknown: bool,
        threads: usize,
    ) -> PyResult<(Bound<'py, PyArray1<u8>>, Bound<'py, PyArray2<f64>>)> {
        let (origins, directions) = (points(&origins_m)?, points(&directions)?);
        if origins.len() != directions.len() && origins.len() != 1 {
            return Err(PyValueError::new_err(format!(
                "{} origins for {} directions; give one origin, or one a direction",
                origins.len(),
                directions.len()
            )));
        }
        let results = py.detach(|| {
            let rays: Vec<_> = directions
                .iter()
                .enumerate()
                .map(|(i, &direction)| (origins[if origins.len() == 1 { 0 } else { i }], direction))
                .collect();
            self.map
                .cast_rays(&rays, max_range_m, through_unknown, threads)
        });
        let ends: Vec<u8> = results
            .iter()
            .map(|result| match result.end {
                RayEnd::Hit => 0,
                RayEnd::Unknown => 1,
                RayEnd::Range => 2,
            })
            .collect();
        let positions: Vec<f64> = results
            .iter()
            .flat_map(|result| result.position_m)
            .collect();
        let positions = positions.into_pyarray(py).reshape([results.len(), 3])?;
        Ok((ends.into_pyarray(py), positions))
    }

    /// Keys `(n, 3)` and log odds `(n,)` of all known voxels, or of those in a box of voxels.
    #[allow(clippy::type_complexity)]
    fn known_voxels<'py>(
        &self,
        py: Python<'py>,
        region: Option<Corners>,
    ) -> PyResult<(Bound<'py, PyArray2<i32>>, Bound<'py, PyArray1<f64>>)> {
        let (voxels, values) = py.detach(|| self.map.known_voxels(region.map(region_of)));
        let count = voxels.len();
        let keys: Vec<i32> = voxels.into_iter().flat_map(|voxel| voxel.0).collect();
        let log_odds: Vec<f64> = values
            .into_iter()
            .map(|value| self.map.model.log_odds(value))
            .collect();
        Ok((
            keys.into_pyarray(py).reshape([count, 3])?,
            log_odds.into_pyarray(py),
        ))
    }

    /// Lowest voxels `(n, 3)`, edges in voxels `(n,)` and log odds `(n,)` of the pruned tree's leaves.
    #[allow(clippy::type_complexity)]
    fn leaves<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(
        Bound<'py, PyArray2<i32>>,
        Bound<'py, PyArray1<i32>>,
        Bound<'py, PyArray1<f64>>,
    )> {
        let found = py
            .detach(|| tree::build(&self.map.occupancy, |value| value))
            .map(|root| tree::leaves(&root))
            .map_err(PyValueError::new_err)?;
        let corners: Vec<i32> = found.iter().flat_map(|leaf| leaf.0).collect();
        let edges: Vec<i32> = found.iter().map(|leaf| leaf.1).collect();
        let log_odds: Vec<f64> = found
            .iter()
            .map(|leaf| self.map.model.log_odds(leaf.2))
            .collect();
        Ok((
            corners.into_pyarray(py).reshape([found.len(), 3])?,
            edges.into_pyarray(py),
            log_odds.into_pyarray(py),
        ))
    }

    /// Expected reduction of entropy `(v,)` [nat] of each origin `(v, 3)` with its directions, `(v * r, 3)`.
    #[allow(clippy::too_many_arguments)]
    fn information_gain<'py>(
        &self,
        py: Python<'py>,
        origins_m: PyReadonlyArray2<'py, f32>,
        directions: PyReadonlyArray2<'py, f32>,
        max_range_m: f64,
        region: Option<Corners>,
        threads: usize,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (origins, directions) = (points(&origins_m)?, points(&directions)?);
        if !origins.is_empty() && directions.len() % origins.len() != 0 {
            return Err(PyValueError::new_err(format!(
                "{} directions cannot be shared equally by {} origins",
                directions.len(),
                origins.len()
            )));
        }
        let gains = py.detach(|| {
            let region = region.map(region_of);
            self.map
                .information_gain(&origins, &directions, max_range_m, region, threads)
        });
        Ok(gains.into_pyarray(py))
    }

    /// First column and the largest log odds of each column `(height, width)`, NaN where unknown.
    #[allow(clippy::type_complexity)]
    fn project<'py>(
        &self,
        py: Python<'py>,
        low_z: i32,
        high_z: i32,
        columns: Option<([i32; 2], [i32; 2])>,
    ) -> PyResult<([i32; 2], Bound<'py, PyArray2<f32>>)> {
        let seen = py.detach(|| self.map.project(low_z, high_z, columns));
        let log_odds: Vec<f32> = seen
            .values
            .iter()
            .map(|&value| self.map.model.log_odds(value) as f32)
            .collect();
        let array = log_odds
            .into_pyarray(py)
            .reshape([seen.height, seen.width])?;
        Ok((seen.corner, array))
    }

    /// Forgets the bricks that lie wholly outside of a box of voxels.
    fn forget_outside(&mut self, low: [i32; 3], high: [i32; 3]) {
        self.map.forget_outside(VoxelKey(low), VoxelKey(high));
    }

    /// Sets the log odds of voxels by key; NaN makes a voxel unknown.
    fn set_voxels(
        &mut self,
        keys: PyReadonlyArray2<'_, i32>,
        log_odds: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<()> {
        let (keys, log_odds) = (keys.as_array(), log_odds.as_array());
        if keys.ncols() != 3 || keys.nrows() != log_odds.len() {
            return Err(PyValueError::new_err(
                "keys must be (n, 3) and log_odds (n,)",
            ));
        }
        for (key, &value) in keys.rows().into_iter().zip(log_odds) {
            let voxel = VoxelKey([key[0], key[1], key[2]]);
            if !voxel.within_reach() {
                return Err(PyValueError::new_err(format!(
                    "voxel {:?} lies beyond the map's reach of {LIMIT} voxels",
                    voxel.0
                )));
            }
            self.map.has_room(1, 1).map_err(full)?;
            let stored = if value.is_nan() {
                crate::octree::sensor_model::UNKNOWN
            } else {
                self.map.model.stored(value)
            };
            self.map.occupancy.set(voxel, stored);
        }
        Ok(())
    }

    /// Adds a channel, or does nothing if it is there with the same constants.
    fn add_channel(&mut self, name: &str, constants: Constants) -> PyResult<()> {
        let model = model(constants)?;
        match self.map.channels.get(name) {
            Some(channel) if channel.model != model => Err(PyValueError::new_err(format!(
                "channel {name:?} exists with another sensor model"
            ))),
            Some(_) => Ok(()),
            None => {
                let channel = Channel {
                    model,
                    grid: Default::default(),
                };
                self.map.channels.insert(name.into(), channel);
                Ok(())
            }
        }
    }

    /// Adds one measurement to a channel at each point: `hits[i]` is positive evidence.
    fn update_channel(
        &mut self,
        name: &str,
        points_m: PyReadonlyArray2<'_, f32>,
        hits: PyReadonlyArray1<'_, bool>,
    ) -> PyResult<()> {
        let points = points(&points_m)?;
        let hits = hits.as_array();
        if hits.len() != points.len() {
            return Err(PyValueError::new_err("one truth value a point is needed"));
        }
        let lattice = self.map.lattice;
        self.channel_mut(name)?;
        for (&point, &hit) in points.iter().zip(hits) {
            self.map.has_room(1, 1).map_err(full)?;
            let channel = self.channel_mut(name)?;
            if let Some(voxel) = lattice.voxel(point) {
                let value = channel.model.updated(channel.grid.value(voxel), hit);
                channel.grid.set(voxel, value);
            }
        }
        Ok(())
    }

    /// Adds measurements of any certainty to a channel: their log odds, one a point; NaN says nothing.
    fn add_to_channel(
        &mut self,
        name: &str,
        points_m: PyReadonlyArray2<'_, f32>,
        log_odds: PyReadonlyArray1<'_, f64>,
    ) -> PyResult<()> {
        let points = points(&points_m)?;
        let log_odds = log_odds.as_array();
        if log_odds.len() != points.len() {
            return Err(PyValueError::new_err("one value a point is needed"));
        }
        let lattice = self.map.lattice;
        self.channel_mut(name)?;
        for (&point, &step) in points.iter().zip(log_odds) {
            if step.is_nan() {
                continue;
            }
            self.map.has_room(1, 1).map_err(full)?;
            let channel = self.channel_mut(name)?;
            if let Some(voxel) = lattice.voxel(point) {
                let value = channel.model.moved(channel.grid.value(voxel), step);
                channel.grid.set(voxel, value);
            }
        }
        Ok(())
    }

    /// Log odds of a channel at points; NaN where it was never measured.
    fn channel_log_odds<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        points_m: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let channel = self.map.channels.get(name).ok_or_else(|| missing(name))?;
        let values: Vec<f64> = points(&points_m)?
            .into_iter()
            .map(|point| {
                self.map.lattice.voxel(point).map_or(f64::NAN, |voxel| {
                    channel.model.log_odds(channel.grid.value(voxel))
                })
            })
            .collect();
        Ok(values.into_pyarray(py))
    }

    fn memory_bytes(&self) -> usize {
        self.map.memory_bytes()
    }

    /// Bricks, and those of them that hold a value for each voxel.
    fn brick_counts(&self) -> (usize, usize) {
        let grid = &self.map.occupancy;
        (grid.len(), grid.dense_count())
    }

    /// Leaves and inner nodes of the octree without pruning.
    fn unpruned_counts(&self, py: Python<'_>) -> (usize, usize) {
        py.detach(|| tree::unpruned_counts(&self.map.occupancy))
    }

    /// Nodes of the pruned octree.
    fn node_count(&self, py: Python<'_>) -> PyResult<usize> {
        py.detach(|| tree::build(&self.map.occupancy, |value| value))
            .map(|root| root.count())
            .map_err(PyValueError::new_err)
    }

    fn write_bt<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py
            .detach(|| files::write_bt(&self.map))
            .map_err(PyValueError::new_err)?;
        Ok(PyBytes::new(py, &bytes))
    }

    fn write_ot<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py
            .detach(|| files::write_ot(&self.map))
            .map_err(PyValueError::new_err)?;
        Ok(PyBytes::new(py, &bytes))
    }
}

fn missing(name: &str) -> PyErr {
    PyKeyError::new_err(format!("no channel {name:?}: add it first"))
}

impl PyOctree {
    fn channel_mut(&mut self, name: &str) -> PyResult<&mut Channel> {
        self.map.channels.get_mut(name).ok_or_else(|| missing(name))
    }
}
