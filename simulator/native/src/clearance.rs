//! Exact distance from every cell's centre to the nearest occupied square.
//!
//! Felzenszwalb and Huttenlocher, "Distance Transforms of Sampled Functions", Theory of Computing 8
//! (2012), section 2, with one change: the sources are whole squares instead of their centres, so that
//! the result is a body's true clearance. A square reaches half a cell to each side, hence the column
//! pass works on a lattice of half cells. Linear in the number of cells.

/// Distances in cells, row-major like `occupied`; whatever lies outside the grid counts as occupied.
pub fn distances_to_squares(occupied: &[bool], width: usize, height: usize) -> Vec<f32> {
    let mut distances = row_distances(occupied, width, height);
    let half_cells = 2 * (height + 2) + 1;
    let mut samples = vec![0.0_f32; half_cells];
    let mut envelope = Envelope::with_capacity(half_cells);
    for column in 0..width {
        samples.fill(f32::INFINITY);
        for row in 0..height + 2 {
            let inside = (1..=height).contains(&row);
            let gap = if inside {
                distances[(row - 1) * width + column]
            } else {
                0.0
            };
            let squared = gap * gap;
            for sample in &mut samples[2 * row..=2 * row + 2] {
                *sample = sample.min(squared);
            }
        }
        envelope.build(&samples);
        for (row, squared) in envelope.at_centres(height).enumerate() {
            distances[row * width + column] = squared.sqrt();
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

/// Lower envelope of the parabolas `samples[u] + ((x - u) / 2)^2`, x and u in half cells.
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

    fn build(&mut self, samples: &[f32]) {
        self.vertices.clear();
        self.starts.clear();
        for (u, &sample) in samples.iter().enumerate() {
            let (u, height) = (u as f32, 4.0 * sample);
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

    /// Squared distances [cells^2] at the centres of the rows, bottom to top.
    fn at_centres(&self, height: usize) -> impl Iterator<Item = f32> + '_ {
        let mut k = 0;
        (0..height).map(move |row| {
            let x = (2 * (row + 1) + 1) as f32;
            while k + 1 < self.vertices.len() && self.starts[k + 1] < x {
                k += 1;
            }
            let (u, sample) = self.vertices[k];
            (sample + (x - u) * (x - u)) / 4.0
        })
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
