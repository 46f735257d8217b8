//! Exact distance from every cell's centre to the nearest occupied square.
//!
//! Felzenszwalb and Huttenlocher, "Distance Transforms of Sampled Functions", Theory of Computing 8
//! (2012), section 2, with one change: the sources are whole squares instead of their centres, so that
//! the result is a body's true clearance. A square reaches half a cell to each side, hence the column
//! pass looks from centres at the edges between rows; in its own row a centre sees the gap along it.
//! Linear in the number of cells.

/// Columns that are worked on together: as many as share the lines of the processor's cache.
const BLOCK: usize = 16;

/// Distances in cells, row-major like `occupied`; whatever lies outside the grid counts as occupied.
pub fn distances_to_squares(occupied: &[bool], width: usize, height: usize) -> Vec<f32> {
    let mut distances = row_distances(occupied, width, height);
    let mut block = vec![0.0_f32; BLOCK * height];
    let mut edges = vec![0.0_f32; height + 1];
    let mut envelope = Envelope::with_capacity(height + 1);
    for first in (0..width).step_by(BLOCK) {
        let columns = BLOCK.min(width - first);
        for (row, line) in distances.chunks_exact(width).enumerate() {
            for (column, gap) in line[first..first + columns].iter().enumerate() {
                block[column * height + row] = gap * gap;
            }
        }
        for gaps in block.chunks_exact_mut(height).take(columns) {
            // Below the first row and above the last one everything is occupied.
            edges[0] = 0.0;
            edges[height] = 0.0;
            for (edge, rows) in edges[1..].iter_mut().zip(gaps.windows(2)) {
                *edge = rows[0].min(rows[1]);
            }
            envelope.build(&edges);
            envelope.lower(gaps);
        }
        for (row, line) in distances.chunks_exact_mut(width).enumerate() {
            for (column, distance) in line[first..first + columns].iter_mut().enumerate() {
                *distance = block[column * height + row].sqrt();
            }
        }
    }
    distances
}

/// Gap along the row to the nearest occupied square, zero inside one [cells].
fn row_distances(occupied: &[bool], width: usize, height: usize) -> Vec<f32> {
    let mut gaps = vec![0.0_f32; width * height];
    for row in 0..height {
        let line = &mut gaps[row * width..(row + 1) * width];
        let walls = &occupied[row * width..(row + 1) * width];
        let mut gap = 0.5;
        for column in 0..width {
            gap = if walls[column] { 0.0 } else { gap };
            line[column] = gap;
            gap = if gap == 0.0 { 0.5 } else { gap + 1.0 };
        }
        let mut gap = 0.5;
        for column in (0..width).rev() {
            gap = if walls[column] { 0.0 } else { gap };
            line[column] = line[column].min(gap);
            gap = if gap == 0.0 { 0.5 } else { gap + 1.0 };
        }
    }
    gaps
}

/// Lower envelope of the parabolas `edges[u] + (x - u)^2`, u the edge below row u [cells].
struct Envelope {
    vertices: Vec<(f32, f32)>,
    starts: Vec<f32>,
}

impl Envelope {
    fn with_capacity(capacity: usize) -> Self {
        Self {
            vertices: Vec::with_capacity(capacity),
            starts: Vec::with_capacity(capacity),
        }
    }

    fn build(&mut self, edges: &[f32]) {
        self.vertices.clear();
        self.starts.clear();
        for (u, &height) in edges.iter().enumerate() {
            let u = u as f32;
            let mut start = f32::NEG_INFINITY;
            while let Some(&(v, other)) = self.vertices.last() {
                start = ((height + u * u) - (other + v * v)) / (2.0 * (u - v));
                if start > self.starts[self.starts.len() - 1] {
                    break;
                }
                self.vertices.pop();
                self.starts.pop();
                start = f32::NEG_INFINITY;
            }
            self.vertices.push((u, height));
            self.starts.push(start);
        }
    }

    /// Lowers the squared distances [cells^2] at the rows' centres to the envelope.
    fn lower(&self, squared: &mut [f32]) {
        let mut k = 0;
        for (row, squared) in squared.iter_mut().enumerate() {
            let x = row as f32 + 0.5;
            while k + 1 < self.vertices.len() && self.starts[k + 1] < x {
                k += 1;
            }
            let (u, height) = self.vertices[k];
            *squared = squared.min(height + (x - u) * (x - u));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::distances_to_squares;
    use proptest::prelude::*;

    /// By definition: the gap between a centre and each occupied square, and the border.
    fn by_definition(occupied: &[bool], width: usize, height: usize, at: usize) -> f32 {
        let (column, row) = ((at % width) as f32, (at / width) as f32);
        let gap = |a: f32, b: f32| ((a - b).abs() - 0.5).max(0.0);
        let border = (column + 0.5)
            .min(row + 0.5)
            .min(width as f32 - column - 0.5)
            .min(height as f32 - row - 0.5);
        (0..occupied.len())
            .filter(|&other| occupied[other])
            .map(|other| {
                gap(column, (other % width) as f32).hypot(gap(row, (other / width) as f32))
            })
            .fold(border, f32::min)
    }

    proptest! {
        #[test]
        fn agrees_with_the_definition(width in 1_usize..14, height in 1_usize..14, bits in prop::collection::vec(prop::bool::weighted(0.15), 196)) {
            let occupied = &bits[..width * height];
            let distances = distances_to_squares(occupied, width, height);
            for at in 0..occupied.len() {
                let expected = if occupied[at] { 0.0 } else { by_definition(occupied, width, height, at) };
                prop_assert!((distances[at] - expected).abs() < 1e-4, "{at}: {} {expected}", distances[at]);
            }
        }
    }
}
