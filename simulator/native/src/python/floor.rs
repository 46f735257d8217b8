//! `simulator._core.Floor`: clearance, rays and routes on one grid of walls.

use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::floor::{Floor, Point, Segment};
use crate::lattice::{Body, Lattice};
use crate::raycast::{Obstacles, scan};
use crate::timed_route::{Motion, Window, timed_route};
use crate::travel::Distances;

type Quad = (f64, f64, f64, f64);
type Disc = (f64, f64, f64);
type Pair = (f64, f64);
type Ranges<'py> = (Bound<'py, PyArray1<f32>>, Vec<i32>);

/// Walls on a grid, row 0 at the bottom.
#[pyclass(name = "Floor", module = "simulator._core", frozen)]
pub struct PyFloor(Floor);

fn cells(array: &PyReadonlyArray2<'_, bool>) -> Vec<bool> {
    array.as_array().iter().copied().collect()
}

fn segments(quads: &[Quad]) -> Vec<Segment> {
    quads
        .iter()
        .map(|&(ax, ay, bx, by)| [[ax, ay], [bx, by]])
        .collect()
}

fn discs(triples: &[Disc]) -> Vec<(Point, f64)> {
    triples.iter().map(|&(x, y, r)| ([x, y], r)).collect()
}

fn points(pairs: &[Pair]) -> Vec<Point> {
    pairs.iter().map(|&(x, y)| [x, y]).collect()
}

fn pairs(points: Vec<Point>) -> Vec<Pair> {
    points.into_iter().map(|[x, y]| (x, y)).collect()
}

#[pymethods]
impl PyFloor {
    #[new]
    fn new(walls: PyReadonlyArray2<'_, bool>, resolution_m: f64, origin_m: Pair) -> PyResult<Self> {
        let (height, width) = (walls.shape()[0], walls.shape()[1]);
        let origin_m = [origin_m.0, origin_m.1];
        Floor::new(cells(&walls), width, height, resolution_m, origin_m)
            .map(Self)
            .map_err(|fault| PyValueError::new_err(fault.to_string()))
    }

    /// The same walls with cells that a body's centre may not enter; of the same shape.
    fn forbidding(&self, forbidden: PyReadonlyArray2<'_, bool>) -> PyResult<Self> {
        self.0
            .forbidding(cells(&forbidden))
            .map(Self)
            .map_err(|fault| PyValueError::new_err(fault.to_string()))
    }

    /// Distance from each cell's centre to the nearest wall [m], (rows, columns).
    fn clearance_field<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let field = PyArray1::from_slice(py, self.0.clearance_m());
        numpy::PyArrayMethods::reshape(&field, [self.0.height, self.0.width])
    }

    /// Exact distance from a position to the nearest wall, at most `limit_m`.
    fn clearance(&self, x: f64, y: f64, limit_m: f64) -> f64 {
        let certain = self.0.certain_clearance([x, y]);
        if certain >= limit_m {
            limit_m
        } else {
            self.0.clearance([x, y], limit_m)
        }
    }

    /// Whether a position lies in terrain that a body's centre may not enter.
    fn is_forbidden(&self, x: f64, y: f64) -> bool {
        self.0.is_forbidden([x, y])
    }

    /// Whether a disc can go straight from one position to another.
    fn leg_is_clear(&self, from_x: f64, from_y: f64, to_x: f64, to_y: f64, radius_m: f64) -> bool {
        self.0
            .leg_is_clear([from_x, from_y], [to_x, to_y], radius_m)
    }

    /// A laser scan: ranges [m] (beams,) float32, and the sorted indices of the segments seen.
    #[expect(
        clippy::too_many_arguments,
        reason = "one call a scan, without objects"
    )]
    fn scan<'py>(
        &self,
        py: Python<'py>,
        x: f64,
        y: f64,
        heading_rad: f64,
        range_m: f64,
        beams: usize,
        blockades: Vec<Quad>,
        robots: Vec<Disc>,
    ) -> Ranges<'py> {
        let (segments, discs) = (segments(&blockades), discs(&robots));
        let obstacles = Obstacles {
            segments: &segments,
            discs: &discs,
        };
        let mut ranges = vec![0.0_f32; beams];
        let mut hits = vec![0_i32; beams];
        scan(
            &self.0,
            &obstacles,
            [x, y],
            heading_rad,
            range_m,
            &mut ranges,
            &mut hits,
        );
        hits.retain(|&hit| hit >= 0);
        hits.sort_unstable();
        hits.dedup();
        (ranges.into_pyarray(py), hits)
    }

    /// A short way for a disc to the nearest of the goals, or None.
    #[expect(
        clippy::too_many_arguments,
        reason = "one call a route, without objects"
    )]
    fn route(
        &self,
        py: Python<'_>,
        start: Pair,
        goals: Vec<Pair>,
        radius_m: f64,
        margin_m: f64,
        comfort_m: f64,
        blockades: Vec<Quad>,
        robots: Vec<Disc>,
    ) -> Option<Vec<Pair>> {
        py.detach(|| {
            let (segments, discs) = (segments(&blockades), discs(&robots));
            let body = Body {
                radius_m,
                margin_m,
                comfort_m,
                blockades: &segments,
                discs: &discs,
            };
            Lattice::new(&self.0, body)
                .route([start.0, start.1], &points(&goals))
                .map(pairs)
        })
    }

    /// Places from which a disc reaches an obstacle at most `reach_m` away from its own edge.
    fn approaches(
        &self,
        obstacle: Quad,
        radius_m: f64,
        margin_m: f64,
        reach_m: f64,
        blockades: Vec<Quad>,
    ) -> Vec<Pair> {
        let segments = segments(&blockades);
        let body = Body {
            radius_m,
            margin_m,
            comfort_m: 0.0,
            blockades: &segments,
            discs: &[],
        };
        let (ax, ay, bx, by) = obstacle;
        pairs(Lattice::new(&self.0, body).approaches([[ax, ay], [bx, by]], reach_m))
    }

    /// Nearest places that keep `apart_m` from a polyline.
    #[expect(
        clippy::too_many_arguments,
        reason = "one call a search, without objects"
    )]
    fn refuges(
        &self,
        py: Python<'_>,
        start: Pair,
        polyline: Vec<Pair>,
        apart_m: f64,
        most: usize,
        radius_m: f64,
        margin_m: f64,
        blockades: Vec<Quad>,
        robots: Vec<Disc>,
    ) -> Vec<Pair> {
        py.detach(|| {
            let (segments, discs) = (segments(&blockades), discs(&robots));
            let body = Body {
                radius_m,
                margin_m,
                comfort_m: 0.0,
                blockades: &segments,
                discs: &discs,
            };
            let lattice = Lattice::new(&self.0, body);
            pairs(lattice.refuges([start.0, start.1], &points(&polyline), apart_m, most))
        })
    }

    /// A route in space and time around announced motions: (time [s], x, y), or None.
    ///
    /// `motions` are (positions every `period_s`, distance to keep). Without goals the robot only
    /// avoids the others.
    #[expect(
        clippy::too_many_arguments,
        reason = "one call a route, without objects"
    )]
    fn timed_route(
        &self,
        py: Python<'_>,
        start: Pair,
        goals: Vec<Pair>,
        motions: Vec<(Vec<Pair>, f64)>,
        speed_m_s: f64,
        period_s: f64,
        horizon_s: f64,
        radius_m: f64,
        margin_m: f64,
        blockades: Vec<Quad>,
        robots: Vec<Disc>,
    ) -> Option<Vec<(f64, f64, f64)>> {
        py.detach(|| {
            let (segments, discs) = (segments(&blockades), discs(&robots));
            let body = Body {
                radius_m,
                margin_m,
                comfort_m: 0.0,
                blockades: &segments,
                discs: &discs,
            };
            let lattice = Lattice::new(&self.0, body);
            let start = [start.0, start.1];
            let distances = if goals.is_empty() {
                Distances::none(&lattice)
            } else {
                let slack_m = speed_m_s * horizon_s;
                lattice.distances(&points(&goals), lattice.snap(start)?, slack_m)
            };
            let motions: Vec<Motion> = motions
                .iter()
                .filter(|(positions, _)| !positions.is_empty())
                .map(|(positions, apart_m)| Motion {
                    positions: points(positions),
                    apart_m: *apart_m,
                })
                .collect();
            let window = Window {
                speed_m_s,
                period_s,
                horizon_s,
                expansions: 60_000,
            };
            let route = timed_route(&lattice, &distances, start, &motions, window)?;
            Some(route.into_iter().map(|(t, [x, y])| (t, x, y)).collect())
        })
    }
}
