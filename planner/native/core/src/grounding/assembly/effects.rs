//! Ground effects: quantifiers unfolded, conditions split into start, throughout and end.

use crate::pddl::model::{Effect, EffectKind, ObjectId, When};
use crate::task::{Change, Conjunction, GroundEffect};

use super::super::GroundingError;
use super::super::formula::{AtomId, Formula, gather};
use super::super::instantiation::{Instantiation, for_all_bindings};
use super::super::reachability::Instance;
use super::super::schema::Origin;
use super::super::world::World;
use super::Assembly;

/// A ground effect before atoms become facts.
pub(super) struct RawEffect {
    pub(super) when: When,
    pub(super) condition: Option<Box<[Formula; 3]>>,
    pub(super) change: RawChange,
}

pub(super) enum RawChange {
    Add(AtomId),
    Delete(AtomId),
    Other(Change),
}

impl Assembly<'_, '_> {
    /// The ground effects of an instance; `None` if one of them is undefined.
    pub(super) fn effects(&mut self, instance: &Instance) -> Option<Vec<RawEffect>> {
        let Origin::Action(_, action) = self.reached.schemas[instance.schema as usize].origin
        else {
            return Some(Vec::new());
        };
        let found = self.with(Some(instance), |instantiation, bindings| {
            let mut effects = Vec::new();
            for (when, effect) in &action.effects {
                ground_effect(instantiation, *when, effect, None, bindings, &mut effects)?;
            }
            Some(effects)
        })?;
        for effect in &found {
            if let RawChange::Add(atom) | RawChange::Delete(atom) = effect.change {
                self.touched.insert(atom);
            }
        }
        Some(found)
    }

    pub(super) fn split_effects(
        &mut self,
        effects: Vec<RawEffect>,
        instance: &Instance,
    ) -> Result<(Vec<GroundEffect>, Vec<GroundEffect>), GroundingError> {
        let mut start = Vec::new();
        let mut end = Vec::new();
        for effect in effects {
            let at_end = effect.when == When::End;
            let Some(change) = self.change(effect.change) else {
                continue;
            };
            let list = if at_end { &mut end } else { &mut start };
            let mut push = |effect: GroundEffect| {
                if !list.contains(&effect) {
                    list.push(effect);
                }
            };
            let Some(condition) = effect.condition else {
                push(GroundEffect {
                    condition: None,
                    change,
                });
                continue;
            };
            let [at_start, throughout, at_end] = *condition;
            let at_start = self.conjunctions(at_start, Some(instance))?;
            let throughout = self.conjunctions(throughout, Some(instance))?;
            let at_end = self.conjunctions(at_end, Some(instance))?;
            let ways = at_start.len() * throughout.len() * at_end.len();
            if ways > 1 && !matches!(change, Change::Add(_) | Change::Delete(_)) {
                return Err(GroundingError::Unsupported {
                    what: "a numeric or module effect under a disjunctive condition".into(),
                    span: match self.reached.schemas[instance.schema as usize].origin {
                        Origin::Action(_, action) => action.span,
                        Origin::Rule(rule) => rule.span,
                    },
                });
            }
            for first in &at_start {
                for second in &throughout {
                    for third in &at_end {
                        let conditions = [first.clone(), second.clone(), third.clone()];
                        let trivial = conditions.iter().all(Conjunction::is_empty);
                        push(GroundEffect {
                            condition: (!trivial).then(|| Box::new(conditions)),
                            change: change.clone(),
                        });
                    }
                }
            }
        }
        Ok((start, end))
    }

    /// The change over facts; `None` if it changes nothing that is ever true.
    pub(super) fn change(&mut self, change: RawChange) -> Option<Change> {
        match change {
            RawChange::Add(atom) => Some(Change::Add(self.fact(atom))),
            RawChange::Delete(atom) => {
                (self.known(atom) != Some(false)).then(|| Change::Delete(self.fact(atom)))
            }
            RawChange::Other(change) => Some(change),
        }
    }
}

fn ground_effect(
    instantiation: &mut Instantiation<'_, '_>,
    when: When,
    effect: &Effect,
    guard: Option<&[Formula; 3]>,
    bindings: &mut Vec<ObjectId>,
    effects: &mut Vec<RawEffect>,
) -> Option<()> {
    let change = match &effect.kind {
        EffectKind::And(parts) => {
            for part in parts {
                ground_effect(instantiation, when, part, guard, bindings, effects)?;
            }
            return Some(());
        }
        EffectKind::Forall(variables, body) => {
            let world = instantiation.world;
            let mut defined = Some(());
            for_all_bindings(world, variables, bindings, &mut |bindings| {
                if defined.is_some() {
                    defined = ground_effect(instantiation, when, body, guard, bindings, effects);
                }
            });
            return defined;
        }
        EffectKind::When(condition, body) => {
            let formula = instantiation.condition(condition, true, bindings);
            let slot = if when == When::Start { 0 } else { 2 };
            let Some(guard) = narrow(guard, vec![(slot, formula)]) else {
                return Some(());
            };
            return ground_effect(instantiation, when, body, Some(&guard), bindings, effects);
        }
        EffectKind::TimedWhen(conditions, body) => {
            let mut parts = Vec::new();
            for (time, condition) in conditions {
                let formula = instantiation.condition(condition, true, bindings);
                let slot = match time {
                    When::Start => 0,
                    When::OverAll => 1,
                    When::End => 2,
                };
                parts.push((slot, formula));
            }
            let Some(guard) = narrow(guard, parts) else {
                return Some(());
            };
            return ground_effect(instantiation, when, body, Some(&guard), bindings, effects);
        }
        EffectKind::Add(atom) => RawChange::Add(
            instantiation
                .symbols
                .atom(atom.predicate, &World::bind(&atom.arguments, bindings)),
        ),
        EffectKind::Delete(atom) => RawChange::Delete(
            instantiation
                .symbols
                .atom(atom.predicate, &World::bind(&atom.arguments, bindings)),
        ),
        EffectKind::Assign(assignment, term, expression) => {
            let value = instantiation.expression(expression, bindings)?;
            let fluent = instantiation
                .symbols
                .fluent(term.function, &World::bind(&term.arguments, bindings));
            RawChange::Other(Change::Assign(*assignment, fluent, value))
        }
        EffectKind::Module(call) => {
            let arguments = World::bind(&call.arguments, bindings);
            for term in &instantiation.world.domain.modules[call.module.index()].writes {
                let bound = World::bind(&term.arguments, &arguments);
                instantiation.symbols.fluent(term.function, &bound);
            }
            RawChange::Other(Change::Call(
                instantiation.symbols.call(call.module, &arguments),
            ))
        }
    };
    effects.push(RawEffect {
        when,
        condition: guard.cloned().map(Box::new),
        change,
    });
    Some(())
}

/// The guard with more conditions; `None` if it can never hold.
fn narrow(guard: Option<&[Formula; 3]>, parts: Vec<(usize, Formula)>) -> Option<[Formula; 3]> {
    let mut slots = guard
        .cloned()
        .unwrap_or([Formula::True, Formula::True, Formula::True]);
    for (slot, formula) in parts {
        let joined = gather(vec![slots[slot].clone(), formula], true);
        if joined == Formula::False {
            return None;
        }
        slots[slot] = joined;
    }
    Some(slots)
}
