//! The shape of a grid: cells by index, row and column, and the eight steps between neighbours.

/// Length of each of the eight steps, in cells, in the order of [`STEPS`].
pub const STEP_LENGTHS: [f64; 8] = [
    1.0,
    1.0,
    1.0,
    1.0,
    std::f64::consts::SQRT_2,
    std::f64::consts::SQRT_2,
    std::f64::consts::SQRT_2,
    std::f64::consts::SQRT_2,
];

/// The eight steps as (row, column): east, north, west, south, then the diagonals.
pub const STEPS: [(i64, i64); 8] = [
    (0, 1),
    (1, 0),
    (0, -1),
    (-1, 0),
    (1, 1),
    (1, -1),
    (-1, -1),
    (-1, 1),
];

/// Rows and columns of a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Number of rows.
    pub height: usize,
    /// Number of columns.
    pub width: usize,
}

impl Shape {
    /// Number of cells.
    #[must_use]
    pub fn len(self) -> usize {
        self.height * self.width
    }

    /// Whether the grid has no cell.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Row and column of a cell.
    #[must_use]
    pub fn row_column(self, cell: u32) -> (i64, i64) {
        let cell = cell as usize;
        ((cell / self.width) as i64, (cell % self.width) as i64)
    }

    /// The cell at a row and column, if the grid has it.
    #[must_use]
    pub fn cell(self, row: i64, column: i64) -> Option<u32> {
        let inside = row >= 0
            && column >= 0
            && (row as usize) < self.height
            && (column as usize) < self.width;
        inside.then(|| (row as usize * self.width + column as usize) as u32)
    }

    /// The cell one step away, if the grid has it.
    #[must_use]
    pub fn neighbour(self, cell: u32, step: usize) -> Option<u32> {
        let (row, column) = self.row_column(cell);
        self.cell(row + STEPS[step].0, column + STEPS[step].1)
    }

    /// Differences of cell indices, by step.
    #[must_use]
    pub fn offsets(self) -> [isize; 8] {
        STEPS.map(|(row, column)| row as isize * self.width as isize + column as isize)
    }
}

/// Octile distance: the least length of an 8-connected path without obstacles, in cells.
#[must_use]
pub fn octile(a: (i64, i64), b: (i64, i64)) -> f64 {
    let (rows, columns) = (a.0.abs_diff(b.0), a.1.abs_diff(b.1));
    let (most, least) = (rows.max(columns), rows.min(columns));
    (most - least) as f64 + least as f64 * std::f64::consts::SQRT_2
}
