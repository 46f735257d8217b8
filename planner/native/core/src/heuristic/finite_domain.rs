//! Finite-domain variables over the propositions of the relaxed task.
//!
//! Facts of which at most one is ever true become the values of one variable; every other
//! proposition is a variable of its own. Each variable has a last value for "none of these".
//!
//! Source: Helmert, "Concise finite-domain representations for PDDL planning tasks", Artificial
//! Intelligence 173, 2009, section 6 (greedy cover by the largest mutex groups).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::task::{FactId, Task};

use super::relaxed::{Proposition, RelaxedTask};

/// Index of a variable.
pub type Variable = u32;

/// A value of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Assignment {
    /// The variable.
    pub variable: Variable,
    /// Its value.
    pub value: u32,
}

/// All variables.
#[derive(Clone, Debug)]
pub struct FiniteDomain {
    places: Vec<Assignment>,
    sizes: Vec<u32>,
}

impl FiniteDomain {
    /// Covers the propositions.
    #[must_use]
    pub fn new(task: &Task, relaxed: &RelaxedTask) -> Self {
        let unplaced = Assignment {
            variable: u32::MAX,
            value: 0,
        };
        let mut domain = Self {
            places: vec![unplaced; relaxed.propositions as usize],
            sizes: Vec::new(),
        };
        let mut queue: BinaryHeap<(usize, Reverse<usize>)> = (task.mutex_groups.iter().enumerate())
            .map(|(index, group)| (group.len(), Reverse(index)))
            .collect();
        while let Some((size, Reverse(index))) = queue.pop() {
            let free: Vec<FactId> = (task.mutex_groups[index].iter().copied())
                .filter(|fact| domain.places[fact.index()] == unplaced)
                .collect();
            if free.len() < 2 {
                continue;
            }
            if free.len() < size {
                queue.push((free.len(), Reverse(index)));
                continue;
            }
            domain.push(free.iter().map(|fact| fact.0));
        }
        for proposition in 0..relaxed.propositions {
            if domain.places[proposition as usize] == unplaced {
                domain.push(std::iter::once(proposition));
            }
        }
        domain
    }

    fn push(&mut self, propositions: impl Iterator<Item = Proposition>) {
        let variable = self.sizes.len() as Variable;
        let mut size = 0;
        for proposition in propositions {
            self.places[proposition as usize] = Assignment {
                variable,
                value: size,
            };
            size += 1;
        }
        self.sizes.push(size + 1);
    }

    /// The number of variables.
    #[must_use]
    pub fn variables(&self) -> u32 {
        self.sizes.len() as u32
    }

    /// The number of values of a variable, "none of these" included.
    #[inline]
    #[must_use]
    pub fn size(&self, variable: Variable) -> u32 {
        self.sizes[variable as usize]
    }

    /// The value "none of these".
    #[inline]
    #[must_use]
    pub fn none_of(&self, variable: Variable) -> u32 {
        self.sizes[variable as usize] - 1
    }

    /// The variable and the value that a proposition stands for.
    #[inline]
    #[must_use]
    pub fn place(&self, proposition: Proposition) -> Assignment {
        self.places[proposition as usize]
    }
}
