//! Which candidates can occur: their durations, attachments and conditions that are no atoms.

use crate::pddl::model::ObjectId;
use crate::task::Duration;

use super::super::duration::{action_duration, impossible_duration};
use super::super::effect_calls::collect_effect_calls;
use super::super::formula::{Formula, gather};
use super::super::instantiation::Instantiation;
use super::super::schema::Origin;
use super::super::{GroundingError, GroundingLimits};
use super::{Exploration, ImpossibleDuration, Instance, Reached, instance_name};

impl Exploration<'_, '_> {
    /// Evaluates static conditions, durations and attachments; twice, because the first pass only
    /// collects the calls whose values are missing.
    pub(super) fn admit(
        &mut self,
        candidates: Vec<(u32, Box<[ObjectId]>)>,
        limits: &GroundingLimits<'_>,
    ) -> Result<(), GroundingError> {
        let mut open = candidates;
        while !open.is_empty() {
            let mut later = Vec::new();
            for (index, (schema, arguments)) in open.into_iter().enumerate() {
                if index.is_multiple_of(1024) {
                    limits.check()?;
                }
                let (incomplete, verdict) = self.examine(schema, &arguments);
                if incomplete && verdict.is_some() {
                    later.push((schema, arguments));
                } else if let Some((duration, formula)) = verdict {
                    let instance = Instance {
                        schema,
                        arguments,
                        duration,
                    };
                    self.enter(instance, formula);
                }
            }
            self.found.costs.evaluate(self.world, limits)?;
            open = later;
        }
        Ok(())
    }

    /// Duration and non-atomic condition of a candidate; `None` if it can never apply.
    fn examine(
        &mut self,
        schema: u32,
        arguments: &[ObjectId],
    ) -> (bool, Option<(Option<Duration>, Formula)>) {
        let world = self.world;
        let Reached {
            schemas,
            relations,
            symbols,
            costs,
            impossible,
            ..
        } = &mut self.found;
        let schema = &schemas[schema as usize];
        let action = || instance_name(world, schema, arguments);
        let mut instantiation = Instantiation {
            world,
            relations,
            symbols,
            costs,
            duration: None,
            action: &action,
            incomplete: false,
        };
        let mut bindings = arguments.to_vec();
        let mut duration = None;
        if let Origin::Action(index, definition) = schema.origin {
            match action_duration(&mut instantiation, definition, &bindings) {
                Ok(found) => duration = found,
                Err(()) => {
                    let first = &mut impossible[index as usize];
                    if first.is_none()
                        && let Some((constraint, value_s)) =
                            impossible_duration(world, definition, &bindings)
                        && schema.rest.iter().all(|condition| {
                            instantiation.condition(condition, true, &mut bindings)
                                != Formula::False
                        })
                    {
                        *first = Some(ImpossibleDuration {
                            arguments: arguments.into(),
                            constraint,
                            value_s,
                        });
                    }
                    return (false, None);
                }
            }
            if let Some(Duration::Fixed(value)) = duration {
                instantiation.duration = Some(value);
            }
            collect_effect_calls(&mut instantiation, definition, &mut bindings);
        }
        let mut parts = Vec::with_capacity(schema.rest.len());
        for condition in &schema.rest {
            let formula = instantiation.condition(condition, true, &mut bindings);
            if formula == Formula::False {
                return (instantiation.incomplete, None);
            }
            parts.push(formula);
        }
        (
            instantiation.incomplete,
            Some((duration, gather(parts, true))),
        )
    }

    fn enter(&mut self, instance: Instance, formula: Formula) {
        if self.possible(&formula) {
            self.accept(instance);
        } else {
            self.waiting.push((instance, formula));
        }
    }

    pub(super) fn possible(&self, formula: &Formula) -> bool {
        let symbols = &self.found.symbols;
        let relations = &self.found.relations;
        formula.possible(&|atom| {
            let (predicate, arguments) = &symbols.atoms[atom.index()];
            relations[predicate.index()].contains(arguments)
        })
    }

    /// Admits waiting instances and conditional effects whose conditions can hold by now.
    pub(super) fn wake(&mut self) -> bool {
        let mut woke = false;
        for (instance, formula) in std::mem::take(&mut self.waiting) {
            if self.possible(&formula) {
                self.accept(instance);
                woke = true;
            } else {
                self.waiting.push((instance, formula));
            }
        }
        for effect in std::mem::take(&mut self.conditional) {
            if self.possible(&effect.condition) {
                let (predicate, arguments) = self.found.symbols.atoms[effect.atom.index()].clone();
                self.reach_atom(predicate.index(), &arguments, effect.label);
                woke = true;
            } else {
                self.conditional.push(effect);
            }
        }
        woke
    }
}
