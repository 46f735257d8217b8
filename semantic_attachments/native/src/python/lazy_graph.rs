//! Roadmaps.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::lazy_graph;

/// A graph whose edges are looked at when a search needs them; see the module of the same name.
#[pyclass(module = "semantic_attachments._core")]
#[derive(Default)]
pub struct LazyGraph {
    graph: lazy_graph::LazyGraph,
}

fn refuse(message: &str) -> PyErr {
    PyValueError::new_err(message.to_owned())
}

impl LazyGraph {
    fn check_vertices(&self, vertices: &[u32]) -> PyResult<()> {
        let count = self.graph.vertices();
        if vertices.iter().all(|&vertex| (vertex as usize) < count) {
            Ok(())
        } else {
            Err(refuse("a vertex is not in the graph"))
        }
    }
}

#[pymethods]
impl LazyGraph {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    /// Number of edges.
    #[getter]
    fn edges(&self) -> usize {
        self.graph.edges()
    }

    /// Adds a vertex at a position [m]; its number.
    fn add_vertex(&mut self, x: f64, y: f64) -> u32 {
        self.graph.add_vertex([x, y])
    }

    /// Adds an edge with a duration [s] and a length [m]; its number.
    fn add_edge(&mut self, start: u32, goal: u32, duration: f64, length: f64) -> PyResult<u32> {
        self.check_vertices(&[start, goal])?;
        if !(duration >= 0.0 && length >= 0.0) {
            return Err(refuse("a duration or length is negative or NaN"));
        }
        Ok(self.graph.add_edge(start, goal, duration, length))
    }

    /// Remembers whether an edge is there, walls apart.
    fn settle(&mut self, edge: u32, is_there: bool) -> PyResult<()> {
        if edge as usize >= self.graph.edges() {
            return Err(refuse("an edge is not in the graph"));
        }
        self.graph.settle(edge, is_there);
        Ok(())
    }

    /// Durations [s] and edges of the quickest ways from any of some vertices to one of each goal's.
    ///
    /// `walls` are (x, y, x, y, reach) [m]. `look(edge)` answers (whether the edge is there, whether it is but for walls).
    fn search(
        &mut self,
        first: Vec<u32>,
        goals: Vec<Vec<u32>>,
        walls: Vec<[f64; 5]>,
        look: &Bound<'_, PyAny>,
    ) -> PyResult<Vec<(f64, Vec<u32>)>> {
        self.check_vertices(&first)?;
        goals
            .iter()
            .try_for_each(|goal| self.check_vertices(goal))?;
        let walls: Vec<_> = walls
            .into_iter()
            .map(|[x0, y0, x1, y1, reach]| lazy_graph::Wall {
                from: [x0, y0],
                to: [x1, y1],
                reach,
            })
            .collect();
        self.graph.search(&first, &goals, &walls, |graph, edge| {
            let (is_there, but_for_walls): (bool, bool) = look.call1((edge,))?.extract()?;
            graph.settle(edge, but_for_walls);
            Ok::<bool, PyErr>(is_there)
        })
    }
}
