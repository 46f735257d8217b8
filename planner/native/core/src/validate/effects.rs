//! What an occurrence changes, evaluated in the state before it.

use rustc_hash::FxHashSet;

use super::interference::{Access, Symbol};
use super::scene::{Fault, Moment, Scene};
use super::state::{State, Tuple};
use super::verdict::Reason;
use crate::attachment::StateView as _;
use crate::pddl::model::{
    Assignment, Condition, Effect, EffectKind, FunctionId, ObjectId, PredicateId, TimedChange, When,
};

/// The changes that one occurrence makes, and what it touches.
#[derive(Debug, Default)]
pub(super) struct Changes {
    pub(super) reads: FxHashSet<Symbol>,
    adds: Vec<(PredicateId, Tuple)>,
    deletes: Vec<(PredicateId, Tuple)>,
    updates: Vec<(Assignment, FunctionId, Tuple, f64)>,
}

/// A conditional effect at the end whose condition speaks of the start or the interval, too.
#[derive(Clone, Debug)]
pub(super) struct LongEffect<'a> {
    conditions: &'a [(When, Condition)],
    effect: &'a Effect,
    bindings: Vec<ObjectId>,
    holds: bool,
}

impl From<Fault> for Reason {
    fn from(fault: Fault) -> Self {
        match fault {
            Fault::Undefined(fluent) => Self::Undefined(fluent),
            Fault::NotANumber(expression) => Self::NotANumber(expression),
            Fault::Attachment(error) => Self::Attachment(error),
            Fault::NotStratified(predicate) => Self::NotStratified(predicate),
        }
    }
}

impl Changes {
    /// Everything touched, sorted: reads before writes.
    pub(super) fn accesses(&self) -> Vec<(Symbol, Access)> {
        let mut all: Vec<_> = self
            .reads
            .iter()
            .map(|symbol| (symbol.clone(), Access::Needs))
            .collect();
        all.sort();
        let fact = |(predicate, tuple): &(PredicateId, Tuple), access| {
            (Symbol::Fact(*predicate, tuple.clone()), access)
        };
        all.extend(self.deletes.iter().map(|one| fact(one, Access::Deletes)));
        all.extend(self.adds.iter().map(|one| fact(one, Access::Adds)));
        all.extend(self.updates.iter().map(|(assignment, function, tuple, _)| {
            let access = match assignment {
                Assignment::Increase | Assignment::Decrease => Access::Shifts,
                Assignment::Assign | Assignment::ScaleUp | Assignment::ScaleDown => Access::Assigns,
            };
            (Symbol::Fluent(*function, tuple.clone()), access)
        }));
        all
    }

    /// A fluent that this occurrence changes twice in ways that do not commute.
    pub(super) fn double_assignment(&self) -> Option<(FunctionId, &Tuple)> {
        let shifts = |one: &Assignment| matches!(one, Assignment::Increase | Assignment::Decrease);
        self.updates
            .iter()
            .enumerate()
            .find(|(index, (kind, function, tuple, _))| {
                self.updates[..*index]
                    .iter()
                    .any(|(other, id, other_tuple, _)| {
                        id == function && other_tuple == tuple && !(shifts(kind) && shifts(other))
                    })
            })
            .map(|(_, (_, function, tuple, _))| (*function, tuple))
    }

    /// First half of applying all changes of a happening: deletes come before adds.
    pub(super) fn apply_deletes(&self, state: &mut State) {
        for (predicate, tuple) in &self.deletes {
            state.delete(*predicate, tuple);
        }
    }

    /// Second half: adds and new values.
    pub(super) fn apply_adds_and_values(&self, state: &mut State) {
        for (predicate, tuple) in &self.adds {
            state.add(*predicate, tuple);
        }
        for (assignment, function, tuple, amount) in &self.updates {
            let old = state.value(*function, tuple).unwrap_or(f64::NAN);
            let new = match assignment {
                Assignment::Assign => *amount,
                Assignment::Increase => old + amount,
                Assignment::Decrease => old - amount,
                Assignment::ScaleUp => old * amount,
                Assignment::ScaleDown => old / amount,
            };
            state.set(*function, tuple, new);
        }
    }

    /// The changes as text.
    pub(super) fn lines(&self, scene: &Scene<'_>) -> Vec<String> {
        let mut lines = Vec::new();
        for (predicate, tuple) in &self.deletes {
            lines.push(format!("deletes {}", scene.fact_text(*predicate, tuple)));
        }
        for (predicate, tuple) in &self.adds {
            lines.push(format!("adds {}", scene.fact_text(*predicate, tuple)));
        }
        for (assignment, function, tuple, amount) in &self.updates {
            let fluent = scene.fluent_text(*function, tuple);
            lines.push(match assignment {
                Assignment::Assign => format!("assigns {amount} to {fluent}"),
                Assignment::Increase => format!("increases {fluent} by {amount}"),
                Assignment::Decrease => format!("decreases {fluent} by {amount}"),
                Assignment::ScaleUp => format!("multiplies {fluent} by {amount}"),
                Assignment::ScaleDown => format!("divides {fluent} by {amount}"),
            });
        }
        lines
    }

    /// What a timed initial literal changes.
    pub(super) fn timed(change: &TimedChange) -> Self {
        let mut changes = Self::default();
        match change {
            TimedChange::Add(atom) => changes
                .adds
                .push((atom.predicate, atom.arguments.as_slice().into())),
            TimedChange::Delete(atom) => changes
                .deletes
                .push((atom.predicate, atom.arguments.as_slice().into())),
            TimedChange::Assign(fluent, value) => changes.updates.push((
                Assignment::Assign,
                fluent.function,
                fluent.arguments.as_slice().into(),
                *value,
            )),
        }
        changes
    }
}

impl Scene<'_> {
    /// Adds what an effect changes in this moment.
    pub(super) fn collect(
        &self,
        moment: &Moment<'_>,
        effect: &Effect,
        bindings: &mut Vec<ObjectId>,
        changes: &mut Changes,
    ) -> Result<(), Reason> {
        match &effect.kind {
            EffectKind::And(parts) => {
                for part in parts {
                    self.collect(moment, part, bindings, changes)?;
                }
            }
            EffectKind::Forall(parameters, part) => {
                for stack in self.instances(parameters, bindings)? {
                    self.collect(moment, part, &mut stack.clone(), changes)?;
                }
            }
            EffectKind::When(condition, part) => {
                if self.holds(moment, condition, bindings)? {
                    self.needs(condition, bindings, &mut changes.reads)?;
                    self.collect(moment, part, bindings, changes)?;
                }
            }
            // Followed from the action's start on: see LongEffect.
            EffectKind::TimedWhen(..) => {}
            EffectKind::Add(atom) => changes
                .adds
                .push((atom.predicate, Self::tuple(&atom.arguments, bindings))),
            EffectKind::Delete(atom) => changes
                .deletes
                .push((atom.predicate, Self::tuple(&atom.arguments, bindings))),
            EffectKind::Assign(assignment, term, expression) => {
                let tuple = Self::tuple(&term.arguments, bindings);
                let amount = self.value(moment, expression, bindings)?;
                Self::reads(expression, bindings, &mut changes.reads);
                let defined = moment.state.value(term.function, &tuple).is_some();
                if *assignment != Assignment::Assign && !defined {
                    return Err(Reason::Undefined(self.fluent_text(term.function, &tuple)));
                }
                if *assignment == Assignment::ScaleDown && amount == 0.0 {
                    let text = self.expression_text(expression, bindings);
                    return Err(Reason::NotANumber(text));
                }
                changes
                    .updates
                    .push((*assignment, term.function, tuple, amount));
            }
            EffectKind::Module(call) => {
                let Some(values) = self.apply(call, bindings, moment)? else {
                    let module = &self.domain.modules[call.module.index()].name.text;
                    return Err(Reason::EffectRefused(format!("[{module}]")));
                };
                for (function, tuple, value) in values {
                    changes
                        .updates
                        .push((Assignment::Assign, function, tuple, value));
                }
            }
        }
        Ok(())
    }

    fn instances(
        &self,
        parameters: &[crate::pddl::model::Parameter],
        bindings: &mut Vec<ObjectId>,
    ) -> Result<Vec<Vec<ObjectId>>, Fault> {
        let mut all = Vec::new();
        self.instance(parameters, bindings, &mut |stack| {
            all.push(stack.clone());
            Ok(false)
        })?;
        Ok(all)
    }

    /// The conditional effects of an action whose conditions carry times of their own, and whether
    /// their conditions at start hold.
    pub(super) fn long_effects<'e>(
        &self,
        moment: &Moment<'_>,
        effect: &'e Effect,
        bindings: &mut Vec<ObjectId>,
        reads: &mut FxHashSet<Symbol>,
        found: &mut Vec<LongEffect<'e>>,
    ) -> Result<(), Fault> {
        match &effect.kind {
            EffectKind::And(parts) => {
                for part in parts {
                    self.long_effects(moment, part, bindings, reads, found)?;
                }
            }
            EffectKind::Forall(parameters, part) => {
                for stack in self.instances(parameters, bindings)? {
                    self.long_effects(moment, part, &mut stack.clone(), reads, found)?;
                }
            }
            EffectKind::TimedWhen(conditions, part) => {
                let mut long = LongEffect {
                    conditions,
                    effect: part,
                    bindings: bindings.clone(),
                    holds: true,
                };
                self.follow(moment, &mut long, When::Start)?;
                for (when, condition) in conditions {
                    if *when == When::Start {
                        self.needs(condition, bindings, reads)?;
                    }
                }
                found.push(long);
            }
            _ => {}
        }
        Ok(())
    }

    /// Checks the conditions of a long effect that speak of this time.
    pub(super) fn follow(
        &self,
        moment: &Moment<'_>,
        long: &mut LongEffect<'_>,
        now: When,
    ) -> Result<(), Fault> {
        for (when, condition) in long.conditions {
            if *when == now {
                long.holds = long.holds && self.holds(moment, condition, &mut long.bindings)?;
            }
        }
        Ok(())
    }

    /// Adds what a long effect changes at the end of its action.
    pub(super) fn collect_long(
        &self,
        moment: &Moment<'_>,
        long: &mut LongEffect<'_>,
        changes: &mut Changes,
    ) -> Result<(), Reason> {
        self.follow(moment, long, When::End)?;
        if long.holds {
            for (when, condition) in long.conditions {
                if *when == When::End {
                    self.needs(condition, &mut long.bindings, &mut changes.reads)?;
                }
            }
            self.collect(moment, long.effect, &mut long.bindings, changes)?;
        }
        Ok(())
    }
}
