//! Strata of derived predicates, so that negation is evaluated on finished ones only.

use crate::pddl::model::{Condition, ConditionKind, Domain};

use super::GroundingError;

/// The stratum of each predicate; 0 for predicates that are not derived.
pub(super) fn strata(domain: &Domain) -> Result<Vec<u32>, GroundingError> {
    let mut strata = vec![0_u32; domain.predicates.len()];
    for rule in &domain.derived {
        strata[rule.predicate.index()] = 1;
    }
    let limit = domain.predicates.len() as u32 + 1;
    loop {
        let mut changed = false;
        for rule in &domain.derived {
            let needed = needed(&rule.condition, true, &strata);
            let own = &mut strata[rule.predicate.index()];
            if needed > *own {
                *own = needed;
                changed = true;
                if needed > limit {
                    return Err(GroundingError::Unstratifiable {
                        predicate: domain.predicates[rule.predicate.index()].name.text.clone(),
                        span: rule.span,
                    });
                }
            }
        }
        if !changed {
            return Ok(strata);
        }
    }
}

fn needed(condition: &Condition, positive: bool, strata: &[u32]) -> u32 {
    match &condition.kind {
        ConditionKind::And(parts) | ConditionKind::Or(parts) => parts
            .iter()
            .map(|part| needed(part, positive, strata))
            .max()
            .unwrap_or(0),
        ConditionKind::Not(inner) => needed(inner, !positive, strata),
        ConditionKind::Imply(left, right) => {
            needed(left, !positive, strata).max(needed(right, positive, strata))
        }
        ConditionKind::Forall(_, body) | ConditionKind::Exists(_, body) => {
            needed(body, positive, strata)
        }
        ConditionKind::Atom(atom) => {
            let stratum = strata[atom.predicate.index()];
            stratum + u32::from(stratum > 0 && !positive)
        }
        ConditionKind::Equal(..) | ConditionKind::Compare(..) | ConditionKind::Module(_) => 0,
    }
}
