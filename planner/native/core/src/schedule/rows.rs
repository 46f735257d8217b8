//! Lists by index, one after the other in memory.

/// Compressed sparse rows.
#[derive(Clone, Debug, Default)]
pub struct Rows {
    from: Vec<u32>,
    items: Vec<u32>,
}

impl Rows {
    pub(super) fn new(count: usize, pairs: impl Iterator<Item = (u32, u32)> + Clone) -> Self {
        let mut from = vec![0u32; count + 1];
        for (row, _) in pairs.clone() {
            from[row as usize + 1] += 1;
        }
        for row in 0..count {
            from[row + 1] += from[row];
        }
        let mut next = from.clone();
        let mut items = vec![0; from[count] as usize];
        for (row, item) in pairs {
            items[next[row as usize] as usize] = item;
            next[row as usize] += 1;
        }
        Self { from, items }
    }

    /// The items of a row.
    pub fn row(&self, row: u32) -> &[u32] {
        let row = row as usize;
        &self.items[self.from[row] as usize..self.from[row + 1] as usize]
    }
}
