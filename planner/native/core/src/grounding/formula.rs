//! Formulas over ground symbols, and their disjunctive normal form.

use rustc_hash::FxHashMap;

use crate::pddl::model::{FunctionId, ModuleId, ObjectId, PredicateId};
use crate::task::{CallId, FluentId, NumericCondition};

/// Index of a ground atom of a changing predicate, reached or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct AtomId(pub(super) u32);

impl AtomId {
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }
}

/// A ground condition in negation normal form.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Formula {
    True,
    False,
    And(Vec<Formula>),
    Or(Vec<Formula>),
    Atom(AtomId, bool),
    Compare(NumericCondition),
    Call(CallId, bool),
}

/// Ground symbols met so far.
#[derive(Default)]
pub(super) struct Symbols {
    pub(super) atoms: Vec<(PredicateId, Box<[ObjectId]>)>,
    atom_of: Numbers,
    pub(super) fluents: Vec<(FunctionId, Box<[ObjectId]>)>,
    fluent_of: Numbers,
    pub(super) calls: Vec<(ModuleId, Box<[ObjectId]>)>,
    call_of: Numbers,
}

impl Symbols {
    pub(super) fn atom(&mut self, predicate: PredicateId, arguments: &[ObjectId]) -> AtomId {
        let next = self.atoms.len() as u32;
        let id = self.atom_of.of(predicate.index(), arguments, next);
        if id == next {
            self.atoms.push((predicate, arguments.into()));
        }
        AtomId(id)
    }

    pub(super) fn fluent(&mut self, function: FunctionId, arguments: &[ObjectId]) -> FluentId {
        let next = self.fluents.len() as u32;
        let id = self.fluent_of.of(function.index(), arguments, next);
        if id == next {
            self.fluents.push((function, arguments.into()));
        }
        FluentId(id)
    }

    pub(super) fn call(&mut self, module: ModuleId, arguments: &[ObjectId]) -> CallId {
        let next = self.calls.len() as u32;
        let id = self.call_of.of(module.index(), arguments, next);
        if id == next {
            self.calls.push((module, arguments.into()));
        }
        CallId(id)
    }
}

/// Numbers of ground symbols, by what they are instances of and by their arguments.
#[derive(Default)]
struct Numbers(Vec<FxHashMap<Box<[ObjectId]>, u32>>);

impl Numbers {
    /// The number of a symbol; it gets `next` if it has none.
    fn of(&mut self, head: usize, arguments: &[ObjectId], next: u32) -> u32 {
        if self.0.len() <= head {
            self.0.resize_with(head + 1, FxHashMap::default);
        }
        let known = &mut self.0[head];
        if let Some(&number) = known.get(arguments) {
            return number;
        }
        known.insert(arguments.into(), next);
        next
    }
}

pub(super) fn truth(value: bool) -> Formula {
    if value { Formula::True } else { Formula::False }
}

/// A simplified conjunction or disjunction.
pub(super) fn gather(parts: Vec<Formula>, conjunction: bool) -> Formula {
    let (neutral, absorbing) = (truth(conjunction), truth(!conjunction));
    let mut parts = parts;
    if parts.len() < 2 {
        return parts.pop().unwrap_or(neutral);
    }
    let mut kept = Vec::with_capacity(parts.len());
    for part in parts {
        if part == absorbing {
            return absorbing;
        }
        match part {
            Formula::And(inner) if conjunction => kept.extend(inner),
            Formula::Or(inner) if !conjunction => kept.extend(inner),
            other if other == neutral => {}
            other => kept.push(other),
        }
    }
    match kept.len() {
        0 => neutral,
        1 => kept.remove(0),
        _ if conjunction => Formula::And(kept),
        _ => Formula::Or(kept),
    }
}

impl Formula {
    /// Whether it can hold in the delete relaxation, given which atoms are reached.
    pub(super) fn possible(&self, reached: &dyn Fn(AtomId) -> bool) -> bool {
        match self {
            Self::False => false,
            Self::True | Self::Compare(_) | Self::Call(..) | Self::Atom(_, false) => true,
            Self::Atom(atom, true) => reached(*atom),
            Self::And(parts) => parts.iter().all(|part| part.possible(reached)),
            Self::Or(parts) => parts.iter().any(|part| part.possible(reached)),
        }
    }

    /// Replaces atoms whose truth never changes.
    pub(super) fn fold(self, known: &dyn Fn(AtomId) -> Option<bool>) -> Self {
        match self {
            Self::Atom(atom, positive) => match known(atom) {
                Some(value) => truth(value == positive),
                None => Self::Atom(atom, positive),
            },
            Self::And(parts) => gather(
                parts.into_iter().map(|part| part.fold(known)).collect(),
                true,
            ),
            Self::Or(parts) => gather(
                parts.into_iter().map(|part| part.fold(known)).collect(),
                false,
            ),
            other => other,
        }
    }

    /// Disjunctive normal form: each inner list is a conjunction of literals, comparisons and
    /// calls. `None` if it has more than `limit` disjuncts.
    pub(super) fn disjuncts(self, limit: usize) -> Option<Vec<Vec<Formula>>> {
        match self {
            Self::True => Some(vec![Vec::new()]),
            Self::False => Some(Vec::new()),
            Self::Or(parts) => {
                let mut all = Vec::new();
                for part in parts {
                    all.extend(part.disjuncts(limit)?);
                    if all.len() > limit {
                        return None;
                    }
                }
                Some(all)
            }
            Self::And(mut parts) => {
                // Literals first, so that disjuncts they contradict or satisfy vanish early.
                parts.sort_by_key(|part| matches!(part, Self::Or(_) | Self::And(_)));
                let mut all: Vec<Vec<Formula>> = vec![Vec::new()];
                for part in parts {
                    let choices = part.disjuncts(limit)?;
                    let mut next = Vec::with_capacity(all.len() * choices.len());
                    for so_far in &all {
                        if choices.iter().any(|c| c.iter().all(|l| so_far.contains(l))) {
                            next.push(so_far.clone());
                            continue;
                        }
                        for choice in &choices {
                            let clash = choice.iter().any(|literal| {
                                matches!(literal, Self::Atom(a, p) if so_far.contains(&Self::Atom(*a, !p)))
                            });
                            if !clash {
                                let mut joined = so_far.clone();
                                for literal in choice {
                                    if !joined.contains(literal) {
                                        joined.push(literal.clone());
                                    }
                                }
                                next.push(joined);
                            }
                        }
                        if next.len() > limit {
                            return None;
                        }
                    }
                    all = next;
                }
                Some(all)
            }
            literal => Some(vec![vec![literal]]),
        }
    }
}
