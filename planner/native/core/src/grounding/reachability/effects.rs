//! What an instance that can occur makes true, under its conditions.

use crate::pddl::model::{Condition, Effect, EffectKind, ObjectId, When};
use crate::task::Duration;

use super::super::formula::{AtomId, Formula, gather};
use super::super::instantiation::{Instantiation, for_all_bindings};
use super::super::schema::Origin;
use super::super::world::World;
use super::{Exploration, Instance, Reached, instance_name};

/// An effect whose condition cannot hold yet.
pub(super) struct Conditional {
    pub(super) condition: Formula,
    pub(super) atom: AtomId,
    pub(super) label: f32,
}

impl Exploration<'_, '_> {
    pub(super) fn accept(&mut self, instance: Instance) {
        let start = self.start_label(&instance);
        let schema = &self.found.schemas[instance.schema as usize];
        match schema.origin {
            Origin::Rule(rule) => {
                if self
                    .rules_seen
                    .insert((instance.schema, instance.arguments.clone()))
                {
                    self.reach_atom(rule.predicate.index(), &instance.arguments, start);
                    self.found.instances.push(instance);
                }
            }
            Origin::Action(_, definition) => {
                let mut bindings = instance.arguments.to_vec();
                let lasts = match instance.duration {
                    Some(Duration::Fixed(seconds)) => seconds as f32,
                    _ => 0.0,
                };
                for (when, effect) in &definition.effects {
                    let label = start + if *when == When::End { lasts } else { 0.0 };
                    self.reach_effect(effect, instance.schema, None, label, &mut bindings);
                }
                self.found.instances.push(instance);
            }
        }
    }

    fn reach_effect(
        &mut self,
        effect: &Effect,
        schema: u32,
        guard: Option<&Formula>,
        label: f32,
        bindings: &mut Vec<ObjectId>,
    ) {
        match &effect.kind {
            EffectKind::And(parts) => {
                for part in parts {
                    self.reach_effect(part, schema, guard, label, bindings);
                }
            }
            EffectKind::Forall(variables, body) => {
                let world = self.world;
                for_all_bindings(world, variables, bindings, &mut |bindings| {
                    self.reach_effect(body, schema, guard, label, bindings);
                });
            }
            EffectKind::When(condition, body) => {
                let inner = self.guard(&[condition], schema, guard, bindings);
                self.reach_effect(body, schema, Some(&inner), label, bindings);
            }
            EffectKind::TimedWhen(conditions, body) => {
                let conditions: Vec<&Condition> = conditions.iter().map(|(_, c)| c).collect();
                let inner = self.guard(&conditions, schema, guard, bindings);
                self.reach_effect(body, schema, Some(&inner), label, bindings);
            }
            EffectKind::Add(atom) => {
                let arguments = World::bind(&atom.arguments, bindings);
                match guard {
                    Some(formula) if !self.possible(formula) => {
                        if *formula != Formula::False {
                            let atom = self.found.symbols.atom(atom.predicate, &arguments);
                            self.conditional.push(Conditional {
                                condition: formula.clone(),
                                atom,
                                label,
                            });
                        }
                    }
                    _ => self.reach_atom(atom.predicate.index(), &arguments, label),
                }
            }
            EffectKind::Delete(_) | EffectKind::Assign(..) | EffectKind::Module(_) => {}
        }
    }

    fn guard(
        &mut self,
        conditions: &[&Condition],
        schema: u32,
        outer: Option<&Formula>,
        bindings: &mut Vec<ObjectId>,
    ) -> Formula {
        let world = self.world;
        let Reached {
            schemas,
            relations,
            symbols,
            costs,
            ..
        } = &mut self.found;
        let schema = &schemas[schema as usize];
        let action = || instance_name(world, schema, &[]);
        let mut instantiation = Instantiation {
            world,
            relations,
            symbols,
            costs,
            duration: None,
            action: &action,
            incomplete: false,
        };
        let mut parts: Vec<Formula> = outer.cloned().into_iter().collect();
        for condition in conditions {
            parts.push(instantiation.condition(condition, true, bindings));
        }
        gather(parts, true)
    }
}
