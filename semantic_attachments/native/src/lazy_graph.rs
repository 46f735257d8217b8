//! Shortest paths in a graph whose edges may turn out not to be there when they are looked at.
//!
//! An edge is looked at when it is the next step of Dijkstra's algorithm, so that few of them are; what is known of an edge is
//! kept. Source: Cohen, Phillips and Likhachev, "Planning single-arm manipulations with n-arm robots", RSS 2014
//! (Lazy Weighted A*), without a heuristic because one search serves many goals.
//! Complexity: `O(edges * log(edges))` and the edges that are looked at.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A vertex by its number.
pub type Vertex = u32;
/// An edge by its number.
pub type EdgeId = u32;

/// A segment that an edge may run into, and the distance at which it does: ends and reach, in metres.
#[derive(Clone, Copy, Debug)]
pub struct Wall {
    /// One end.
    pub from: [f64; 2],
    /// The other end.
    pub to: [f64; 2],
    /// Distance from it at which a vehicle may touch it.
    pub reach: f64,
}

#[derive(Clone, Copy, Debug)]
struct Edge {
    from: Vertex,
    to: Vertex,
    duration: f64,
    /// No point of it is farther from its ends, added up, in metres.
    length: f64,
    known: bool,
}

/// The graph; vertices have positions in metres, edges durations in seconds.
#[derive(Clone, Debug, Default)]
pub struct LazyGraph {
    positions: Vec<[f64; 2]>,
    edges: Vec<Edge>,
    outgoing: Vec<Vec<EdgeId>>,
}

/// The way to one goal: its duration, infinite if there is none, and its edges.
pub type Way = (f64, Vec<EdgeId>);

impl LazyGraph {
    /// Number of vertices.
    #[must_use]
    pub fn vertices(&self) -> usize {
        self.positions.len()
    }

    /// Number of edges.
    #[must_use]
    pub fn edges(&self) -> usize {
        self.edges.len()
    }

    /// Adds a vertex.
    pub fn add_vertex(&mut self, position: [f64; 2]) -> Vertex {
        self.positions.push(position);
        self.outgoing.push(Vec::new());
        self.positions.len() as Vertex - 1
    }

    /// Adds an edge between two vertices.
    pub fn add_edge(&mut self, from: Vertex, to: Vertex, duration: f64, length: f64) -> EdgeId {
        let edge = self.edges.len() as EdgeId;
        self.edges.push(Edge {
            from,
            to,
            duration,
            length,
            known: false,
        });
        self.outgoing[from as usize].push(edge);
        edge
    }

    /// Remembers whether an edge is there, walls apart.
    pub fn settle(&mut self, edge: EdgeId, is_there: bool) {
        let found = &mut self.edges[edge as usize];
        found.known = true;
        if !is_there {
            found.duration = f64::INFINITY;
            let from = found.from as usize;
            self.outgoing[from].retain(|&other| other != edge);
        }
    }

    /// Whether the edge has to be looked at: nothing is known of it, or a wall may be in its way.
    #[must_use]
    pub fn is_open_question(&self, edge: EdgeId, walls: &[Wall]) -> bool {
        let Edge {
            from,
            to,
            length,
            known,
            ..
        } = self.edges[edge as usize];
        let (from, to) = (self.positions[from as usize], self.positions[to as usize]);
        !known
            || walls
                .iter()
                .any(|wall| away(from, wall) + away(to, wall) <= length + 2.0 * wall.reach)
    }

    /// The quickest ways from any of some vertices to one vertex of each goal.
    ///
    /// `look` says whether an edge that is an open question is there. It may settle it.
    ///
    /// # Errors
    ///
    /// What `look` fails with.
    pub fn search<E>(
        &mut self,
        first: &[Vertex],
        goals: &[Vec<Vertex>],
        walls: &[Wall],
        mut look: impl FnMut(&mut Self, EdgeId) -> Result<bool, E>,
    ) -> Result<Vec<Way>, E> {
        let count = self.vertices();
        let mut settled = vec![false; count];
        let mut into: Vec<Option<EdgeId>> = vec![None; count];
        // The least duration by edges that are there for certain.
        let mut sure = vec![f64::INFINITY; count];
        let mut goals_of: Vec<Vec<usize>> = vec![Vec::new(); count];
        for (goal, vertices) in goals.iter().enumerate() {
            for &vertex in vertices {
                goals_of[vertex as usize].push(goal);
            }
        }
        let mut ways: Vec<Way> = vec![(f64::INFINITY, Vec::new()); goals.len()];
        let mut waiting = goals.iter().filter(|goal| !goal.is_empty()).count();
        let mut queue: BinaryHeap<Reverse<(u64, Vertex, Option<EdgeId>)>> = first
            .iter()
            .map(|&vertex| Reverse((0, vertex, None)))
            .collect();
        while let Some(Reverse((bits, vertex, edge))) = queue.pop() {
            let here = vertex as usize;
            if waiting == 0 {
                break;
            }
            if settled[here] {
                continue;
            }
            if let Some(edge) = edge
                && self.is_open_question(edge, walls)
                && !look(self, edge)?
            {
                continue;
            }
            settled[here] = true;
            into[here] = edge;
            let duration = f64::from_bits(bits);
            for &goal in &goals_of[here] {
                if ways[goal].0.is_infinite() {
                    ways[goal] = (duration, self.way_to(vertex, &into));
                    waiting -= 1;
                }
            }
            for &next in &self.outgoing[here] {
                let Edge {
                    to, duration: more, ..
                } = self.edges[next as usize];
                let reached = duration + more;
                if settled[to as usize] || reached >= sure[to as usize] {
                    continue;
                }
                if !self.is_open_question(next, walls) {
                    sure[to as usize] = reached;
                }
                queue.push(Reverse((reached.to_bits(), to, Some(next))));
            }
        }
        Ok(ways)
    }

    fn way_to(&self, goal: Vertex, into: &[Option<EdgeId>]) -> Vec<EdgeId> {
        let mut way = Vec::new();
        let mut vertex = goal;
        while let Some(edge) = into[vertex as usize] {
            way.push(edge);
            vertex = self.edges[edge as usize].from;
        }
        way.reverse();
        way
    }
}

/// Distance of a point from a wall's segment.
fn away(point: [f64; 2], wall: &Wall) -> f64 {
    let along = [wall.to[0] - wall.from[0], wall.to[1] - wall.from[1]];
    let offset = [point[0] - wall.from[0], point[1] - wall.from[1]];
    let length2 = along[0] * along[0] + along[1] * along[1];
    let share = if length2 > 0.0 {
        ((offset[0] * along[0] + offset[1] * along[1]) / length2).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (offset[0] - share * along[0]).hypot(offset[1] - share * along[1])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::convert::Infallible;

    fn by_relaxation(count: usize, edges: &[(u32, u32, f64)], first: &[u32]) -> Vec<f64> {
        let mut durations = vec![f64::INFINITY; count];
        for &vertex in first {
            durations[vertex as usize] = 0.0;
        }
        for _ in 0..count {
            for &(from, to, duration) in edges {
                let reached = durations[from as usize] + duration;
                durations[to as usize] = durations[to as usize].min(reached);
            }
        }
        durations
    }

    proptest! {
        #[test]
        fn equals_relaxation_over_the_edges_that_are_there(
            edges in proptest::collection::vec((0u32..12, 0u32..12, 0.0..9.0, any::<bool>()), 0..60),
            first in proptest::collection::vec(0u32..12, 1..3),
            goals in proptest::collection::vec(proptest::collection::vec(0u32..12, 0..3), 1..5),
        ) {
            let mut graph = LazyGraph::default();
            for vertex in 0..12 {
                graph.add_vertex([f64::from(vertex), 0.0]);
            }
            for &(from, to, duration, _) in &edges {
                graph.add_edge(from, to, duration, 100.0);
            }
            let there: Vec<_> = edges.iter().filter(|edge| edge.3).map(|&(a, b, d, _)| (a, b, d)).collect();
            let expected = by_relaxation(12, &there, &first);
            // What is learnt about edges does not change the answer of the second search.
            for _ in 0..2 {
                let ways = graph.search(&first, &goals, &[], |graph, edge| {
                    let is_there = edges[edge as usize].3;
                    graph.settle(edge, is_there);
                    Ok::<bool, Infallible>(is_there)
                }).unwrap();
                for (goal, (duration, way)) in goals.iter().zip(&ways) {
                    let best = goal.iter().map(|&v| expected[v as usize]).fold(f64::INFINITY, f64::min);
                    prop_assert!(*duration == best || (duration - best).abs() < 1e-9);
                    let sum: f64 = way.iter().map(|&edge| edges[edge as usize].2).sum();
                    prop_assert!(best.is_infinite() || (sum - best).abs() < 1e-9);
                    prop_assert!(way.iter().all(|&edge| edges[edge as usize].3));
                    prop_assert!(way.windows(2).all(|w| edges[w[0] as usize].1 == edges[w[1] as usize].0));
                }
            }
        }
    }

    #[test]
    fn only_edges_near_a_wall_are_looked_at_again() {
        let mut graph = LazyGraph::default();
        for x in [0.0, 2.0, 4.0, 6.0] {
            graph.add_vertex([x, 0.0]);
        }
        for vertex in 0..3 {
            graph.add_edge(vertex, vertex + 1, 2.0, 2.0);
        }
        let goals = [vec![3]];
        let wall = Wall {
            from: [3.0, -1.0],
            to: [3.0, 1.0],
            reach: 0.5,
        };
        let mut looked = Vec::new();
        for walls in [&[][..], &[], &[wall]] {
            let ways = graph.search(&[0], &goals, walls, |graph, edge| {
                looked.push(edge);
                graph.settle(edge, true);
                Ok::<bool, Infallible>(walls.is_empty())
            });
            assert_eq!(ways.unwrap()[0].0.is_finite(), walls.is_empty());
        }
        assert_eq!(looked, [0, 1, 2, 1]);
    }
}
