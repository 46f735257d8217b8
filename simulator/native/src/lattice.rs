//! Routes of a disc-shaped body through a floor: a lattice of some cells' centres, eight neighbours.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use crate::floor::{Floor, Point, Segment, distance, nearest_on_segment, segment_distance};

/// Nodes of the lattice are at most this far apart where the floor's resolution allows it [m].
const SPACING_M: f64 = 0.15;
/// How far around a position a node is looked for to begin or to end at [m].
const SNAP_M: f64 = 0.6;

/// The body that is to move, and what stands in its way besides the walls.
#[derive(Clone)]
pub struct Body<'a> {
    /// Radius of the body [m].
    pub radius_m: f64,
    /// Distance that is kept from everything [m].
    pub margin_m: f64,
    /// Distance that is kept where a small detour allows it [m].
    pub comfort_m: f64,
    /// Blockades.
    pub blockades: &'a [Segment],
    /// Standing robots: centre and radius [m].
    pub discs: &'a [(Point, f64)],
}

/// The lattice over one floor for one body.
pub struct Lattice<'a> {
    /// The walls.
    pub floor: &'a Floor,
    /// The moving body.
    pub body: Body<'a>,
    columns: usize,
    rows: usize,
    stride: usize,
    blocked: Vec<bool>,
}

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

/// An open list's entry, the smallest key first, then the smallest node.
#[derive(PartialEq)]
struct Open {
    key: f64,
    node: usize,
}

impl Eq for Open {}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other
            .key
            .total_cmp(&self.key)
            .then(other.node.cmp(&self.node))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl<'a> Lattice<'a> {
    /// Lays the lattice out and marks what blockades and standing robots deny.
    pub fn new(floor: &'a Floor, body: Body<'a>) -> Self {
        let stride = ((SPACING_M / floor.resolution_m + 1e-9) as usize).max(1);
        let count = |cells: usize| (cells + stride - 1 - stride / 2) / stride;
        let (columns, rows) = (count(floor.width), count(floor.height));
        let mut lattice = Self {
            floor,
            columns,
            rows,
            stride,
            blocked: vec![false; columns * rows],
            body,
        };
        let reach = lattice.body.radius_m + lattice.body.margin_m;
        for &segment in lattice.body.blockades {
            lattice.block(segment, reach);
        }
        for &(centre, radius) in lattice.body.discs {
            lattice.block([centre, centre], reach + radius);
        }
        lattice
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// Whether there is no node at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Distance between straight neighbours [m].
    pub fn spacing_m(&self) -> f64 {
        self.stride as f64 * self.floor.resolution_m
    }

    fn cell(&self, node: usize) -> (usize, usize) {
        let half = self.stride / 2;
        (
            node % self.columns * self.stride + half,
            node / self.columns * self.stride + half,
        )
    }

    /// A node's position.
    pub fn position(&self, node: usize) -> Point {
        let (column, row) = self.cell(node);
        self.floor.centre(column, row)
    }

    /// Distance from a node to the nearest wall [m].
    pub fn clearance(&self, node: usize) -> f64 {
        let (column, row) = self.cell(node);
        self.floor.clearance_at_centre(column, row)
    }

    /// Whether the body may stand at a node.
    pub fn is_free(&self, node: usize) -> bool {
        let (column, row) = self.cell(node);
        !self.blocked[node]
            && self.clearance(node) >= self.body.radius_m + self.body.margin_m
            && self.floor.terrain_clearance_at_centre(column, row) > 0.0
    }

    /// Nodes in the rectangle that reaches `reach` around a segment.
    fn around(&self, [a, b]: Segment, reach: f64) -> impl Iterator<Item = usize> + use<> {
        let spacing = self.spacing_m();
        let index = |value: f64, axis: usize, count: usize| {
            let at = (value - self.floor.origin_m[axis]) / spacing;
            (at.max(0.0) as usize).min(count - 1)
        };
        let left = index(a[0].min(b[0]) - reach - spacing, 0, self.columns);
        let right = index(a[0].max(b[0]) + reach + spacing, 0, self.columns);
        let low = index(a[1].min(b[1]) - reach - spacing, 1, self.rows);
        let high = index(a[1].max(b[1]) + reach + spacing, 1, self.rows);
        let columns = self.columns;
        (low..=high).flat_map(move |row| (left..=right).map(move |column| row * columns + column))
    }

    fn block(&mut self, segment: Segment, reach: f64) {
        for node in self.around(segment, reach) {
            let position = self.position(node);
            if distance(position, nearest_on_segment(position, segment)) < reach {
                self.blocked[node] = true;
            }
        }
    }

    /// Whether a straight leg neither touches a wall nor comes too near a blockade.
    fn leg_is_clear(&self, from: Point, to: Point, margin_m: f64) -> bool {
        let reach = self.body.radius_m + margin_m;
        self.floor.leg_is_clear(from, to, reach)
            && self
                .body
                .blockades
                .iter()
                .all(|&blockade| segment_distance([from, to], blockade) >= reach)
            && self.body.discs.iter().all(|&(centre, radius)| {
                distance(centre, nearest_on_segment(centre, [from, to])) >= reach + radius
            })
    }

    /// The free node that is best joined with a position, if there is one near by.
    pub fn snap(&self, position: Point) -> Option<usize> {
        let room = self
            .floor
            .clearance(position, self.body.radius_m + self.body.margin_m);
        let body = room.min(self.body.radius_m) - 0.02;
        let is_outside = self.floor.is_forbidden(position);
        let mut near: Vec<(f64, usize)> = self
            .around([position, position], SNAP_M)
            .filter(|&node| self.is_free(node))
            .map(|node| (distance(position, self.position(node)), node))
            .filter(|&(far, _)| far <= SNAP_M)
            .collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        near.into_iter().map(|(_, node)| node).find(|&node| {
            let to = self.position(node);
            self.floor.disc_passes(position, to, body)
                && (is_outside || self.floor.centre_passes(position, to))
                && self
                    .body
                    .blockades
                    .iter()
                    .all(|&blockade| segment_distance([position, to], blockade) > 0.0)
        })
    }

    /// Calls `visit(neighbour, length)` for each free neighbour that a straight leg leads to.
    pub fn for_each_neighbour(&self, node: usize, mut visit: impl FnMut(usize, f64)) {
        let (column, row) = (
            (node % self.columns) as isize,
            (node / self.columns) as isize,
        );
        let spacing = self.spacing_m();
        let narrow = self.body.radius_m + self.body.margin_m + 0.6 * spacing;
        let here = self.clearance(node);
        let (at_column, at_row) = self.cell(node);
        let beside_terrain =
            self.floor.terrain_clearance_at_centre(at_column, at_row) < 1.5 * spacing;
        for (dx, dy) in [
            (1, 0),
            (0, 1),
            (-1, 0),
            (0, -1),
            (1, 1),
            (-1, 1),
            (-1, -1),
            (1, -1),
        ] {
            let (x, y) = (column + dx, row + dy);
            if x < 0 || y < 0 || x >= self.columns as isize || y >= self.rows as isize {
                continue;
            }
            let neighbour = y as usize * self.columns + x as usize;
            if !self.is_free(neighbour) {
                continue;
            }
            let tight = here.min(self.clearance(neighbour)) < narrow || beside_terrain;
            if tight
                && !self.floor.leg_is_clear(
                    self.position(node),
                    self.position(neighbour),
                    self.body.radius_m + 0.5 * self.body.margin_m,
                )
            {
                continue;
            }
            let length = if dx != 0 && dy != 0 {
                spacing * std::f64::consts::SQRT_2
            } else {
                spacing
            };
            visit(neighbour, length);
        }
    }

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
            node: first,
        });
        while let Some(Open { key, node }) = open.pop() {
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
                        node: neighbour,
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

    /// Travel distances to the nearest goal (Dijkstra), until `slack_m` beyond the node `until`.
    pub fn distances(&self, goals: &[Point], until: usize, slack_m: f64) -> Distances {
        let mut values = vec![f32::INFINITY; self.len()];
        let mut open = BinaryHeap::new();
        for node in goals.iter().filter_map(|&goal| self.snap(goal)) {
            values[node] = 0.0;
            open.push(Open { key: 0.0, node });
        }
        let mut limit = f64::INFINITY;
        let mut beyond = f32::INFINITY;
        while let Some(Open { key, node }) = open.pop() {
            if key > f64::from(values[node]) {
                continue;
            }
            if key > limit {
                beyond = key as f32;
                break;
            }
            if node == until {
                limit = key + slack_m;
            }
            self.for_each_neighbour(node, |neighbour, length| {
                let new = (key + length) as f32;
                if new < values[neighbour] {
                    values[neighbour] = new;
                    open.push(Open {
                        key: f64::from(new),
                        node: neighbour,
                    });
                }
            });
        }
        Distances {
            values_m: values,
            beyond_m: if beyond.is_finite() { beyond } else { 1e6 },
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

    /// Whether no wall lies between two positions, but for the last decimetre.
    fn sees(&self, from: Point, to: Point) -> bool {
        let far = distance(from, to);
        let ratio = (far - 0.1).max(0.0) / far.max(1e-9);
        let end = [
            from[0] + ratio * (to[0] - from[0]),
            from[1] + ratio * (to[1] - from[1]),
        ];
        self.floor.disc_passes(from, end, 0.0)
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
        let Some(first) = self.snap(start) else {
            return refuges;
        };
        let mut values = vec![f32::INFINITY; self.len()];
        let mut open = BinaryHeap::new();
        values[first] = 0.0;
        open.push(Open {
            key: 0.0,
            node: first,
        });
        while let Some(Open { key, node }) = open.pop() {
            if key > f64::from(values[node]) {
                continue;
            }
            let at = self.position(node);
            let apart = polyline
                .windows(2)
                .map(|leg| distance(at, nearest_on_segment(at, [leg[0], leg[1]])))
                .fold(f64::INFINITY, f64::min);
            if apart >= apart_m {
                refuges.push(at);
                if refuges.len() == most {
                    break;
                }
            }
            self.for_each_neighbour(node, |neighbour, length| {
                let new = (key + length) as f32;
                if new < values[neighbour] {
                    values[neighbour] = new;
                    open.push(Open {
                        key: f64::from(new),
                        node: neighbour,
                    });
                }
            });
        }
        refuges
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor::tests::drawn;

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
