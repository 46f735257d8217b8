//! Attachments that effects and their conditions mention.

use crate::pddl::model::{Action, Effect, EffectKind, ObjectId};

use super::instantiation::{Instantiation, for_all_bindings};

/// Makes the attachments that effects and their conditions mention part of the batch.
pub(super) fn collect_effect_calls(
    instantiation: &mut Instantiation<'_, '_>,
    action: &Action,
    bindings: &mut Vec<ObjectId>,
) {
    if instantiation.world.domain.modules.is_empty() {
        return;
    }
    for (_, effect) in &action.effects {
        effect_calls(instantiation, effect, bindings);
    }
}

fn effect_calls(
    instantiation: &mut Instantiation<'_, '_>,
    effect: &Effect,
    bindings: &mut Vec<ObjectId>,
) {
    match &effect.kind {
        EffectKind::And(parts) => parts
            .iter()
            .for_each(|part| effect_calls(instantiation, part, bindings)),
        EffectKind::Forall(variables, body) => {
            let world = instantiation.world;
            for_all_bindings(world, variables, bindings, &mut |bindings| {
                effect_calls(instantiation, body, bindings);
            });
        }
        EffectKind::When(condition, body) => {
            instantiation.condition(condition, true, bindings);
            effect_calls(instantiation, body, bindings);
        }
        EffectKind::TimedWhen(conditions, body) => {
            for (_, condition) in conditions {
                instantiation.condition(condition, true, bindings);
            }
            effect_calls(instantiation, body, bindings);
        }
        EffectKind::Assign(_, _, expression) => {
            instantiation.expression(expression, bindings);
        }
        EffectKind::Add(_) | EffectKind::Delete(_) | EffectKind::Module(_) => {}
    }
}
