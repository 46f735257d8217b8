//! Which operators can start in a state.
//!
//! Every operator is listed under one fact of its start condition, the one that the fewest
//! states share; a state looks only at the lists of the facts it holds.

use crate::task::{FactId, OperatorId};

use super::compiled::Compiled;
use super::state::State;

/// The successor generator of a task.
#[derive(Debug)]
pub struct Successors {
    offsets: Vec<u32>,
    listed: Vec<OperatorId>,
    unconditional: Vec<OperatorId>,
    /// Facts that have a list, one bit each.
    keys: Vec<u64>,
}

impl Successors {
    /// Lists the operators of a task.
    #[must_use]
    pub fn new(compiled: &Compiled<'_>) -> Self {
        let task = compiled.task;
        let mut group_size = vec![1_usize; task.facts.len()];
        for group in &task.mutex_groups {
            for fact in group {
                let size = &mut group_size[fact.index()];
                *size = (*size).max(group.len());
            }
        }
        let mut uses = vec![0_usize; task.facts.len()];
        for operator in &task.operators {
            for fact in &operator.start_condition.positive {
                uses[fact.index()] += 1;
            }
        }
        let mut lists: Vec<Vec<OperatorId>> = vec![Vec::new(); task.facts.len()];
        let mut unconditional = Vec::new();
        for (index, operator) in task.operators.iter().enumerate() {
            let id = OperatorId(index as u32);
            let own = |fact: &&FactId| {
                !operator.start_effects.iter().any(|effect| {
                    matches!(effect.change, crate::task::Change::Add(added) if added == **fact)
                })
            };
            let key = operator
                .start_condition
                .positive
                .iter()
                .chain(operator.invariant.positive.iter().filter(own))
                .max_by_key(|fact| {
                    let fact = fact.index();
                    (group_size[fact], usize::MAX - uses[fact])
                });
            match key {
                Some(fact) => lists[fact.index()].push(id),
                None => unconditional.push(id),
            }
        }
        let mut offsets = vec![0];
        let mut listed = Vec::with_capacity(task.operators.len());
        let mut keys = vec![0; compiled.words];
        for (fact, list) in lists.into_iter().enumerate() {
            if !list.is_empty() {
                keys[fact / 64] |= 1 << (fact % 64);
            }
            listed.extend(list);
            offsets.push(listed.len() as u32);
        }
        Self {
            offsets,
            listed,
            unconditional,
            keys,
        }
    }

    /// Calls `visit` with every operator whose literals at start hold and which would end before
    /// `limit`; numeric conditions and attachments are left to the start itself.
    pub fn for_each(
        &self,
        compiled: &Compiled<'_>,
        state: &State,
        limit: f64,
        visit: &mut dyn FnMut(OperatorId),
    ) {
        let mut consider = |id: OperatorId| {
            let operator = compiled.operator(id);
            if operator.start_condition.literals_hold(&state.facts)
                && state.time + operator.least_duration < limit
                && (operator.may_overlap_itself
                    || !state.running.iter().any(|running| running.operator == id))
            {
                visit(id);
            }
        };
        for &id in &self.unconditional {
            consider(id);
        }
        for (word, (&bits, &keys)) in state.facts.iter().zip(&self.keys).enumerate() {
            let mut bits = bits & keys;
            while bits != 0 {
                let fact = word * 64 + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                let list = self.offsets[fact] as usize..self.offsets[fact + 1] as usize;
                for &id in &self.listed[list] {
                    consider(id);
                }
            }
        }
    }
}
