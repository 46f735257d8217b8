//! Derived facts: the least fixpoint of the axioms, stratum by stratum.
//!
//! Source: Thiébaux, Hoffmann, Nebel, "In defense of PDDL axioms", Artificial Intelligence 168, 2005.

use super::compiled::{Condition, comparison_holds};
use super::state::State;
use super::transitions::Transitions;
use crate::task::FactId;

impl Transitions<'_> {
    /// Recomputes the derived facts of a state.
    pub(super) fn derive(&self, state: &mut State) {
        let compiled = self.compiled;
        if compiled.axioms.is_empty() {
            return;
        }
        for &fact in &compiled.derived {
            state.set(fact, false);
        }
        let mut from = 0;
        while from < compiled.axioms.len() {
            let stratum = compiled.axioms[from].0;
            let to = from + compiled.axioms[from..].partition_point(|axiom| axiom.0 == stratum);
            let mut changed = true;
            while changed {
                changed = false;
                for (_, condition, head) in &compiled.axioms[from..to] {
                    if !state.holds(*head) && self.derives(condition, *head, state) {
                        state.set(*head, true);
                        changed = true;
                    }
                }
            }
            from = to;
        }
    }

    fn derives(&self, condition: &Condition, head: FactId, state: &State) -> bool {
        let name = || {
            format!(
                "(:derived ({}) ...)",
                self.compiled.task.facts[head.index()]
            )
        };
        let snapshot = state.snapshot();
        condition.literals_hold(&state.facts)
            && condition.comparisons.iter().all(|comparison| {
                comparison_holds(comparison, &state.values, f64::NAN, &mut |call| {
                    self.calls.value(call, snapshot, &name)
                })
            })
            && condition
                .calls
                .iter()
                .all(|&(call, wanted)| self.calls.holds(call, snapshot, &name) == wanted)
    }
}
