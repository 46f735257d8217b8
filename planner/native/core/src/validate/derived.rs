//! Derived predicates: strata of the rules and the least fixed point in a state.
//!
//! Source: Edelkamp and Hoffmann, "PDDL2.2: the language for the classical part of IPC-4", 2004,
//! section 3.

use super::scene::{Fault, Moment, Scene};
use super::state::State;
use crate::attachment::StateView as _;
use crate::pddl::model::{Condition, ConditionKind, Domain, PredicateId};

/// Calls `visit(predicate, positive)` for every atom in a condition.
fn visit_atoms(condition: &Condition, positive: bool, visit: &mut dyn FnMut(PredicateId, bool)) {
    match &condition.kind {
        ConditionKind::And(parts) | ConditionKind::Or(parts) => {
            for part in parts {
                visit_atoms(part, positive, visit);
            }
        }
        ConditionKind::Not(part) => visit_atoms(part, !positive, visit),
        ConditionKind::Imply(premise, conclusion) => {
            visit_atoms(premise, !positive, visit);
            visit_atoms(conclusion, positive, visit);
        }
        ConditionKind::Forall(_, part) | ConditionKind::Exists(_, part) => {
            visit_atoms(part, positive, visit);
        }
        ConditionKind::Atom(atom) => visit(atom.predicate, positive),
        ConditionKind::Equal(..) | ConditionKind::Compare(..) | ConditionKind::Module(_) => {}
    }
}

/// The rules by stratum: a predicate lies above everything that it negates.
pub(super) fn strata(domain: &Domain) -> Result<Vec<Vec<usize>>, Fault> {
    let mut level = vec![0_usize; domain.predicates.len()];
    let mut changed = true;
    while changed {
        changed = false;
        for rule in &domain.derived {
            let mut needed = level[rule.predicate.index()];
            visit_atoms(&rule.condition, true, &mut |predicate, positive| {
                if domain.predicates[predicate.index()].derived {
                    needed = needed.max(level[predicate.index()] + usize::from(!positive));
                }
            });
            if needed > domain.predicates.len() {
                let name = &domain.predicates[rule.predicate.index()].name.text;
                return Err(Fault::NotStratified(name.clone()));
            }
            if needed > level[rule.predicate.index()] {
                level[rule.predicate.index()] = needed;
                changed = true;
            }
        }
    }
    let mut strata = vec![Vec::new(); level.iter().max().map_or(0, |top| top + 1)];
    for (index, rule) in domain.derived.iter().enumerate() {
        strata[level[rule.predicate.index()]].push(index);
    }
    strata.retain(|stratum| !stratum.is_empty());
    Ok(strata)
}

impl Scene<'_> {
    /// Replaces the derived facts of a state by those that follow from its other facts.
    pub(super) fn derive(&self, state: &mut State) -> Result<(), Fault> {
        for rule in &self.domain.derived {
            state.clear(rule.predicate);
        }
        for stratum in &self.strata {
            let mut changed = true;
            while changed {
                changed = false;
                for index in stratum {
                    let rule = &self.domain.derived[*index];
                    let mut found = Vec::new();
                    let moment = Moment {
                        state,
                        duration: None,
                        total_time: 0.0,
                        action: "(:derived)",
                    };
                    self.instance(&rule.parameters, &mut Vec::new(), &mut |bindings| {
                        if !state.holds(rule.predicate, bindings)
                            && self.holds(&moment, &rule.condition, bindings)?
                        {
                            found.push(bindings.clone());
                        }
                        Ok(false)
                    })?;
                    for tuple in found {
                        changed |= state.add(rule.predicate, &tuple);
                    }
                }
            }
        }
        Ok(())
    }
}
