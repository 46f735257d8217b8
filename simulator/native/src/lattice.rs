//! Where a disc-shaped body can be on a floor: a lattice of some cells' centres, eight neighbours.

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
    pub(crate) fn around(
        &self,
        [a, b]: Segment,
        reach: f64,
    ) -> impl Iterator<Item = usize> + use<> {
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
    pub(crate) fn leg_is_clear(&self, from: Point, to: Point, margin_m: f64) -> bool {
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

    /// Whether no wall lies between two positions, but for the last decimetre.
    pub(crate) fn sees(&self, from: Point, to: Point) -> bool {
        let far = distance(from, to);
        let ratio = (far - 0.1).max(0.0) / far.max(1e-9);
        let end = [
            from[0] + ratio * (to[0] - from[0]),
            from[1] + ratio * (to[1] - from[1]),
        ];
        self.floor.disc_passes(from, end, 0.0)
    }
}
