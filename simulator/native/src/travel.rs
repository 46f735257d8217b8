//! Travel over a lattice: shortest comfortable routes, distances, and places to get out of the way.

use std::collections::BinaryHeap;

use crate::floor::{Point, Segment, distance, nearest_on_segment};
use crate::lattice::Lattice;
use crate::open_list::Open;

/// Travel distance to the nearest goal from every node that was looked at.
pub struct Distances {
    values_m: Vec<f32>,
    beyond_m: f32,
}

impl Distances {
    /// Distance from a node [m]; where the search did not reach, the distance at which it ended.
    pub fn at(&self, node: usize) -> f64 {
        f64::from(self.values_m[node].min(self.beyond_m))
    }

    /// No goal: all distances are zero.
    pub fn none(lattice: &Lattice<'_>) -> Self {
        Self {
            values_m: vec![0.0; lattice.len()],
            beyond_m: 0.0,
        }
    }
}

impl Lattice<'_> {
    /// Length of a leg, made up to 40 % longer where it runs close to a wall.
    fn comfortable(&self, node: usize, length: f64) -> f64 {
        let spare = self.clearance(node) - self.body.radius_m - self.body.margin_m;
        let want = self.body.comfort_m.max(1e-6);
        length * (1.0 + 0.4 * (1.0 - spare / want).clamp(0.0, 1.0))
    }

    /// A short comfortable way to the nearest of the goals, string-pulled; A*, both ends exact.
    pub fn route(&self, start: Point, goals: &[Point]) -> Option<Vec<Point>> {
        let first = self.snap(start)?;
        let ends: Vec<(usize, Point)> = goals
            .iter()
            .filter_map(|&goal| self.snap(goal).map(|node| (node, goal)))
            .collect();
        let (mut low, mut high) = (ends.first()?.1, ends.first()?.1);
        for (node, _) in &ends {
            let at = self.position(*node);
            for axis in 0..2 {
                low[axis] = low[axis].min(at[axis]);
                high[axis] = high[axis].max(at[axis]);
            }
        }
        let remaining = |node: usize| {
            let at = self.position(node);
            let beyond = |axis: usize| (low[axis] - at[axis]).max(at[axis] - high[axis]).max(0.0);
            beyond(0).hypot(beyond(1))
        };
        let mut costs = vec![f32::INFINITY; self.len()];
        let mut parents = vec![u32::MAX; self.len()];
        let mut open = BinaryHeap::new();
        costs[first] = 0.0;
        open.push(Open {
            key: remaining(first),
            id: first,
        });
        while let Some(Open { key, id: node }) = open.pop() {
            let cost = f64::from(costs[node]);
            if key > cost + remaining(node) + 1e-3 {
                continue;
            }
            if let Some(&(_, goal)) = ends.iter().find(|(end, _)| *end == node) {
                let mut points = vec![goal];
                let mut at = node;
                while at != first {
                    at = parents[at] as usize;
                    points.push(self.position(at));
                }
                if points.len() > 1 {
                    points.pop();
                }
                points.push(start);
                points.reverse();
                return Some(self.shorten(&points));
            }
            self.for_each_neighbour(node, |neighbour, length| {
                let new = (cost + self.comfortable(neighbour, length)) as f32;
                if new < costs[neighbour] - 1e-6 {
                    costs[neighbour] = new;
                    parents[neighbour] = node as u32;
                    open.push(Open {
                        key: f64::from(new) + remaining(neighbour),
                        id: neighbour,
                    });
                }
            });
        }
        None
    }

    /// Leaves out points while the direct leg keeps the comfortable distance.
    fn shorten(&self, points: &[Point]) -> Vec<Point> {
        let margin = self.body.margin_m + 0.5 * self.body.comfort_m;
        let mut short = vec![points[0]];
        let mut at = 0;
        while at + 1 < points.len() {
            let mut next = at + 1;
            let mut stride = 1;
            // Doubling steps while the leg is clear, then halving ones.
            while stride > 0 {
                let ahead = (next + stride).min(points.len() - 1);
                if ahead > next && self.leg_is_clear(points[at], points[ahead], margin) {
                    next = ahead;
                    stride *= 2;
                } else {
                    stride /= 2;
                }
            }
            short.push(points[next]);
            at = next;
        }
        short
    }

    /// Dijkstra's search from some nodes: visits nodes in the order of their distance [m] until the
    /// visitor says no. Returns all distances, and the one at which it ended.
    fn settle(
        &self,
        starts: impl Iterator<Item = usize>,
        mut goes_on: impl FnMut(usize, f64) -> bool,
    ) -> (Vec<f32>, Option<f32>) {
        let mut values_m = vec![f32::INFINITY; self.len()];
        let mut open = BinaryHeap::new();
        for node in starts {
            values_m[node] = 0.0;
            open.push(Open { key: 0.0, id: node });
        }
        while let Some(Open { key, id: node }) = open.pop() {
            if key > f64::from(values_m[node]) {
                continue;
            }
            if !goes_on(node, key) {
                return (values_m, Some(key as f32));
            }
            self.for_each_neighbour(node, |neighbour, length| {
                let new = (key + length) as f32;
                if new < values_m[neighbour] {
                    values_m[neighbour] = new;
                    open.push(Open {
                        key: f64::from(new),
                        id: neighbour,
                    });
                }
            });
        }
        (values_m, None)
    }

    /// Travel distances to the nearest goal, until `slack_m` beyond the node `until`.
    pub fn distances(&self, goals: &[Point], until: usize, slack_m: f64) -> Distances {
        let ends = goals.iter().filter_map(|&goal| self.snap(goal));
        let mut limit_m = f64::INFINITY;
        let (values_m, ended_m) = self.settle(ends, |node, far_m| {
            if node == until {
                limit_m = far_m + slack_m;
            }
            far_m <= limit_m
        });
        Distances {
            values_m,
            beyond_m: ended_m.unwrap_or(1e6),
        }
    }

    /// Places where the body stands free with an obstacle in plain reach, at most `reach_m` away
    /// from its own edge.
    pub fn approaches(&self, obstacle: Segment, reach_m: f64) -> Vec<Point> {
        let far = self.body.radius_m + reach_m;
        self.around(obstacle, far)
            .filter(|&node| self.is_free(node))
            .map(|node| self.position(node))
            .filter(|&position| {
                let nearest = nearest_on_segment(position, obstacle);
                distance(position, nearest) <= far && self.sees(position, nearest)
            })
            .collect()
    }

    /// The free places nearest to a position by travel that keep `apart_m` from a polyline.
    pub fn refuges(
        &self,
        start: Point,
        polyline: &[Point],
        apart_m: f64,
        most: usize,
    ) -> Vec<Point> {
        let mut refuges = Vec::new();
        self.settle(self.snap(start).into_iter(), |node, _| {
            let at = self.position(node);
            let apart = polyline
                .windows(2)
                .map(|leg| distance(at, nearest_on_segment(at, [leg[0], leg[1]])))
                .fold(f64::INFINITY, f64::min);
            if apart >= apart_m {
                refuges.push(at);
            }
            refuges.len() < most
        });
        refuges
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor::tests::drawn;
    use crate::lattice::Body;

    const ROOMS: [&str; 11] = [
        "#####################",
        "#.........#.........#",
        "#.........#.........#",
        "#.........#.........#",
        "#...................#",
        "#...................#",
        "#...................#",
        "#.........#.........#",
        "#.........#.........#",
        "#.........#.........#",
        "#####################",
    ];

    fn body(blockades: &[Segment]) -> Body<'_> {
        Body {
            radius_m: 0.2,
            margin_m: 0.03,
            comfort_m: 0.2,
            blockades,
            discs: &[],
        }
    }

    fn length(points: &[Point]) -> f64 {
        points.windows(2).map(|leg| distance(leg[0], leg[1])).sum()
    }

    #[test]
    fn a_route_passes_the_door_and_touches_no_wall() {
        let floor = drawn(&ROOMS, 0.2);
        let lattice = Lattice::new(&floor, body(&[]));
        let (start, goal) = ([0.7, 1.7], [3.5, 1.7]);
        let route = lattice.route(start, &[goal]).unwrap();
        assert_eq!((route[0], *route.last().unwrap()), (start, goal));
        for leg in route.windows(2) {
            assert!(floor.leg_is_clear(leg[0], leg[1], 0.2), "{leg:?}");
        }
        assert!(length(&route) < 3.4, "{route:?}");
    }

    #[test]
    fn a_blockade_closes_the_door_and_can_be_approached_from_both_sides() {
        let floor = drawn(&ROOMS, 0.2);
        let door = [[[2.1, 0.8], [2.1, 1.4]]];
        let lattice = Lattice::new(&floor, body(&door));
        assert!(lattice.route([0.7, 1.7], &[[3.5, 1.7]]).is_none());
        let approaches = lattice.approaches(door[0], 0.5);
        assert!(approaches.iter().any(|p| p[0] < 2.0));
        assert!(approaches.iter().any(|p| p[0] > 2.2));
        let route = lattice.route([0.7, 1.7], &approaches).unwrap();
        assert!(route.last().unwrap()[0] < 2.0);
    }

    #[test]
    fn distances_agree_with_the_lattice_metric() {
        let floor = drawn(&["........................"; 24], 0.2);
        let lattice = Lattice::new(&floor, body(&[]));
        let goal = floor.centre(5, 5);
        let until = lattice.snap(floor.centre(15, 9)).unwrap();
        let distances = lattice.distances(&[goal], until, 1.0);
        let octile = 0.2 * (6.0 + 4.0 * std::f64::consts::SQRT_2);
        assert!((distances.at(until) - octile).abs() < 1e-4);
    }

    #[test]
    fn a_refuge_is_away_from_the_line() {
        let floor = drawn(&ROOMS, 0.2);
        let lattice = Lattice::new(&floor, body(&[]));
        let line = [[0.3, 1.1], [3.9, 1.1]];
        let refuges = lattice.refuges([2.1, 1.1], &line, 0.5, 5);
        assert_eq!(refuges.len(), 5);
        for refuge in refuges {
            assert!((refuge[1] - 1.1).abs() >= 0.5);
        }
    }
}
