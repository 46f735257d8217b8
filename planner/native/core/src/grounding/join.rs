//! Instantiates a schema by a backtracking join over the reached atoms.
//!
//! Semi-naive evaluation (Ullman, Principles of Database and Knowledge-Base Systems, 1988, ch. 3):
//! a fresh atom is matched against one join position, positions before it accept only older atoms,
//! later ones also the fresh one, so that every instantiation is produced exactly once.

use crate::pddl::model::{Atom, ObjectId, Term};

use super::relation::Relation;
use super::schema::Schema;

const UNBOUND: ObjectId = ObjectId(u32::MAX);
/// Partial instantiations between two looks at the clock.
const STEPS: u32 = 1 << 14;

/// The fresh atom that a join starts from.
#[derive(Clone, Copy)]
pub(super) struct Trigger<'a> {
    /// Join position it is matched with.
    pub(super) position: usize,
    /// When it was reached.
    pub(super) sequence: u32,
    /// Its arguments.
    pub(super) tuple: &'a [ObjectId],
    /// Whether rows stand in the order of their sequence numbers.
    pub(super) in_order: bool,
}

/// Calls `emit` with the arguments of every instantiation that the trigger completes, or, without
/// one, of every instantiation over the atoms in the relations, until `emit` says false. `go_on` is
/// asked now and then, also while nothing is found.
pub(super) fn instantiate(
    schema: &Schema<'_>,
    relations: &[Relation],
    trigger: Option<Trigger<'_>>,
    go_on: &dyn Fn() -> bool,
    emit: &mut dyn FnMut(&[ObjectId]) -> bool,
) {
    let mut join = Join {
        schema,
        relations,
        trigger: trigger.map(|t| (t.position, t.sequence)),
        bindings: vec![UNBOUND; schema.parameters.len()],
        done: vec![false; schema.join.len()],
        stopped: false,
        in_order: trigger.is_none_or(|t| t.in_order),
        steps: 0,
        go_on,
        emit,
    };
    if let Some(trigger) = trigger {
        let mut bound = Vec::new();
        if join.unify(schema.join[trigger.position], trigger.tuple, &mut bound) {
            join.done[trigger.position] = true;
            join.extend();
        }
    } else {
        join.extend();
    }
}

struct Join<'a, 'b> {
    schema: &'a Schema<'b>,
    relations: &'a [Relation],
    trigger: Option<(usize, u32)>,
    bindings: Vec<ObjectId>,
    done: Vec<bool>,
    stopped: bool,
    in_order: bool,
    /// Partial instantiations looked at.
    steps: u32,
    go_on: &'a dyn Fn() -> bool,
    emit: &'a mut dyn FnMut(&[ObjectId]) -> bool,
}

impl Join<'_, '_> {
    fn term(&self, term: Term) -> ObjectId {
        match term {
            Term::Variable(variable) => self.bindings[variable.index()],
            Term::Object(object) => object,
        }
    }

    fn unify(&mut self, atom: &Atom, tuple: &[ObjectId], bound: &mut Vec<usize>) -> bool {
        for (&term, &object) in atom.arguments.iter().zip(tuple) {
            match term {
                Term::Object(constant) if constant != object => return false,
                Term::Object(_) => {}
                Term::Variable(variable) => {
                    let current = self.bindings[variable.index()];
                    if current == UNBOUND {
                        if !self.schema.admitted[variable.index()][object.index()] {
                            return false;
                        }
                        self.bindings[variable.index()] = object;
                        bound.push(variable.index());
                    } else if current != object {
                        return false;
                    }
                }
            }
        }
        true
    }

    fn release(&mut self, bound: &mut Vec<usize>) {
        for variable in bound.drain(..) {
            self.bindings[variable] = UNBOUND;
        }
    }

    fn equalities_hold(&self) -> bool {
        self.schema.equalities.iter().all(|&(left, right, same)| {
            let (left, right) = (self.term(left), self.term(right));
            left == UNBOUND || right == UNBOUND || (left == right) == same
        })
    }

    /// The newest sequence number that a position may use.
    fn newest(&self, position: usize) -> u32 {
        match self.trigger {
            Some((triggered, sequence)) if position < triggered => sequence.saturating_sub(1),
            Some((_, sequence)) => sequence,
            None => u32::MAX,
        }
    }

    /// Counts a partial instantiation; false if the join is to end.
    fn step(&mut self) -> bool {
        self.steps += 1;
        if self.steps.is_multiple_of(STEPS) && !(self.go_on)() {
            self.stopped = true;
        }
        !self.stopped
    }

    fn extend(&mut self) {
        if !self.step() || !self.equalities_hold() {
            return;
        }
        let Some(position) = self.cheapest() else {
            self.enumerate(0);
            return;
        };
        let schema = self.schema;
        let atom = schema.join[position];
        let relations = self.relations;
        let relation = &relations[atom.predicate.index()];
        let newest = self.newest(position);
        self.done[position] = true;
        let mut shortest: Option<&[u32]> = None;
        let mut all_bound = true;
        for (index, &term) in atom.arguments.iter().enumerate() {
            let object = self.term(term);
            if object == UNBOUND {
                all_bound = false;
            } else {
                let posting = relation.posting(index, object);
                if shortest.is_none_or(|best| posting.len() < best.len()) {
                    shortest = Some(posting);
                }
            }
        }
        if all_bound {
            let tuple: Vec<ObjectId> = atom.arguments.iter().map(|&t| self.term(t)).collect();
            if relation.reached_at(&tuple).is_some_and(|at| at <= newest) {
                self.extend();
            }
        } else {
            let mut bound = Vec::new();
            let mut visit = |join: &mut Self, row: u32| {
                if !join.step() {
                    return false;
                }
                if relation.sequence(row) > newest {
                    return !join.in_order;
                }
                if join.unify(atom, relation.tuple(row), &mut bound) {
                    join.extend();
                }
                join.release(&mut bound);
                true
            };
            match shortest {
                Some(rows) => {
                    for &row in rows {
                        if !visit(self, row) {
                            break;
                        }
                    }
                }
                None => {
                    for row in 0..relation.len() as u32 {
                        if !visit(self, row) {
                            break;
                        }
                    }
                }
            }
        }
        self.done[position] = false;
    }

    /// The open position with the fewest matching rows.
    fn cheapest(&self) -> Option<usize> {
        let mut best: Option<(usize, usize)> = None;
        for (position, atom) in self.schema.join.iter().enumerate() {
            if self.done[position] {
                continue;
            }
            let relation = &self.relations[atom.predicate.index()];
            let mut rows = relation.len();
            let mut unbound = 0;
            for (index, &term) in atom.arguments.iter().enumerate() {
                let object = self.term(term);
                if object == UNBOUND {
                    unbound += 1;
                } else {
                    rows = rows.min(relation.posting(index, object).len());
                }
            }
            if unbound == 0 {
                rows = 0;
            }
            if best.is_none_or(|(_, fewest)| rows < fewest) {
                best = Some((position, rows));
            }
        }
        best.map(|(position, _)| position)
    }

    fn enumerate(&mut self, variable: usize) {
        if variable == self.bindings.len() {
            if self.equalities_hold() {
                self.stopped = !(self.emit)(&self.bindings);
            }
            return;
        }
        if self.bindings[variable] != UNBOUND {
            self.enumerate(variable + 1);
            return;
        }
        let schema = self.schema;
        for &object in &schema.candidates[variable] {
            self.bindings[variable] = object;
            if !self.step() {
                break;
            }
            if self.equalities_hold() {
                self.enumerate(variable + 1);
            }
        }
        self.bindings[variable] = UNBOUND;
    }
}
