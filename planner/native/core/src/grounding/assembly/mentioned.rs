//! Atoms that conditions mention although their truth does not decide them: they count as read.

use crate::pddl::model::{
    Condition, ConditionKind, Effect, EffectKind, ObjectId, PredicateId, When,
};
use crate::task::FactId;

use super::super::instantiation::for_all_bindings;
use super::super::reachability::Instance;
use super::super::schema::Origin;
use super::super::tuple::Tuple;
use super::super::world::World;
use super::Assembly;

impl Assembly<'_, '_> {
    /// Facts inside conditions that are not plain conjunctions.
    pub(super) fn mentions(&mut self, instance: &Instance, wanted: When) -> Vec<FactId> {
        let Origin::Action(_, action) = self.reached.schemas[instance.schema as usize].origin
        else {
            return Vec::new();
        };
        let world = self.world;
        let mut atoms = Vec::new();
        let mut bindings = instance.arguments.to_vec();
        for (when, condition) in &action.conditions {
            if *when == wanted {
                mentioned(world, condition, false, &mut bindings, &mut atoms);
            }
        }
        for (when, effect) in &action.effects {
            mentioned_by_effect(world, effect, (*when, wanted), &mut bindings, &mut atoms);
        }
        let mut facts: Vec<FactId> = atoms
            .into_iter()
            .filter_map(|(predicate, arguments)| {
                let atom = self.reached.symbols.atom(predicate, &arguments);
                (self.known(atom).is_none()).then(|| self.fact(atom))
            })
            .collect();
        facts.sort_unstable();
        facts.dedup();
        facts
    }
}

/// Ground atoms of changing predicates below a disjunction, implication or quantifier.
fn mentioned(
    world: &World<'_>,
    condition: &Condition,
    inside: bool,
    bindings: &mut Vec<ObjectId>,
    atoms: &mut Vec<(PredicateId, Tuple)>,
) {
    match &condition.kind {
        ConditionKind::And(parts) => {
            for part in parts {
                mentioned(world, part, inside, bindings, atoms);
            }
        }
        ConditionKind::Or(parts) => {
            for part in parts {
                mentioned(world, part, true, bindings, atoms);
            }
        }
        ConditionKind::Not(inner) => mentioned(world, inner, inside, bindings, atoms),
        ConditionKind::Imply(left, right) => {
            mentioned(world, left, true, bindings, atoms);
            mentioned(world, right, true, bindings, atoms);
        }
        ConditionKind::Forall(variables, body) | ConditionKind::Exists(variables, body) => {
            for_all_bindings(world, variables, bindings, &mut |bindings| {
                mentioned(world, body, true, bindings, atoms);
            });
        }
        ConditionKind::Atom(atom) => {
            if inside && world.changing_predicate[atom.predicate.index()] {
                atoms.push((atom.predicate, World::bind(&atom.arguments, bindings)));
            }
        }
        ConditionKind::Equal(..) | ConditionKind::Compare(..) | ConditionKind::Module(_) => {}
    }
}

/// Ground atoms in the conditions of conditional effects, `when` being the effect's time.
fn mentioned_by_effect(
    world: &World<'_>,
    effect: &Effect,
    (when, wanted): (When, When),
    bindings: &mut Vec<ObjectId>,
    atoms: &mut Vec<(PredicateId, Tuple)>,
) {
    match &effect.kind {
        EffectKind::And(parts) => {
            for part in parts {
                mentioned_by_effect(world, part, (when, wanted), bindings, atoms);
            }
        }
        EffectKind::Forall(variables, body) => {
            for_all_bindings(world, variables, bindings, &mut |bindings| {
                mentioned_by_effect(world, body, (when, wanted), bindings, atoms);
            });
        }
        EffectKind::When(condition, body) => {
            if when == wanted {
                mentioned(world, condition, true, bindings, atoms);
            }
            mentioned_by_effect(world, body, (when, wanted), bindings, atoms);
        }
        EffectKind::TimedWhen(conditions, body) => {
            for (time, condition) in conditions {
                if *time == wanted {
                    mentioned(world, condition, true, bindings, atoms);
                }
            }
            mentioned_by_effect(world, body, (when, wanted), bindings, atoms);
        }
        EffectKind::Add(_)
        | EffectKind::Delete(_)
        | EffectKind::Assign(..)
        | EffectKind::Module(_) => {}
    }
}
