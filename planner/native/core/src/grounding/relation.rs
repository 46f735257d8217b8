//! Tables of ground atoms with one posting list per argument and object.

use rustc_hash::FxHashMap;

use crate::pddl::model::ObjectId;

/// The tuples of one predicate reached so far, in the order in which they were reached.
#[derive(Debug, Default)]
pub(super) struct Relation {
    arity: usize,
    arguments: Vec<ObjectId>,
    reached_at: Vec<u32>,
    labels: Vec<f32>,
    row_of: FxHashMap<Box<[ObjectId]>, u32>,
    postings: Vec<FxHashMap<ObjectId, Vec<u32>>>,
}

impl Relation {
    pub(super) fn new(arity: usize) -> Self {
        Self {
            arity,
            postings: vec![FxHashMap::default(); arity],
            ..Self::default()
        }
    }

    /// Number of tuples.
    pub(super) fn len(&self) -> usize {
        self.reached_at.len()
    }

    /// Adds a tuple with the sequence number of its reaching; false if it was there.
    pub(super) fn insert(&mut self, tuple: &[ObjectId], sequence: u32) -> bool {
        self.insert_labelled(tuple, sequence, 0.0)
    }

    /// The same with the time at which it can be reached in the relaxation [s].
    pub(super) fn insert_labelled(
        &mut self,
        tuple: &[ObjectId],
        sequence: u32,
        label: f32,
    ) -> bool {
        if self.row_of.contains_key(tuple) {
            return false;
        }
        let row = self.len() as u32;
        self.row_of.insert(tuple.into(), row);
        self.arguments.extend_from_slice(tuple);
        self.reached_at.push(sequence);
        self.labels.push(label);
        for (posting, &object) in self.postings.iter_mut().zip(tuple) {
            posting.entry(object).or_default().push(row);
        }
        true
    }

    /// Whether the tuple was reached.
    pub(super) fn contains(&self, tuple: &[ObjectId]) -> bool {
        self.row_of.contains_key(tuple)
    }

    /// The sequence number at which a tuple was reached.
    pub(super) fn reached_at(&self, tuple: &[ObjectId]) -> Option<u32> {
        self.row_of
            .get(tuple)
            .map(|&row| self.reached_at[row as usize])
    }

    /// Gives a tuple its place in the order in which joins see them.
    pub(super) fn set_sequence(&mut self, tuple: &[ObjectId], sequence: u32) {
        if let Some(&row) = self.row_of.get(tuple) {
            self.reached_at[row as usize] = sequence;
        }
    }

    /// The time at which a tuple can be reached in the relaxation [s].
    pub(super) fn label(&self, tuple: &[ObjectId]) -> Option<f32> {
        self.row_of.get(tuple).map(|&row| self.labels[row as usize])
    }

    /// The arguments of a row.
    pub(super) fn tuple(&self, row: u32) -> &[ObjectId] {
        let start = row as usize * self.arity;
        &self.arguments[start..start + self.arity]
    }

    /// The sequence number of a row.
    pub(super) fn sequence(&self, row: u32) -> u32 {
        self.reached_at[row as usize]
    }

    /// Rows that have an object at a position, ascending.
    pub(super) fn posting(&self, position: usize, object: ObjectId) -> &[u32] {
        self.postings[position]
            .get(&object)
            .map_or(&[], Vec::as_slice)
    }
}
