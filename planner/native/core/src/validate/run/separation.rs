//! Whether happenings that are too close to each other touch the same.

use super::Run;
use crate::validate::effects::Changes;
use crate::validate::interference::{Access, Claim, Symbol};
use crate::validate::timeline::Occurrence;
use crate::validate::verdict::{Failure, Reason};

impl Run<'_, '_> {
    pub(super) fn check_interference(
        &mut self,
        all: &[(Occurrence, Changes)],
    ) -> Result<(), Box<Failure>> {
        for (position, (occurrence, changes)) in all.iter().enumerate() {
            let step = match occurrence {
                Occurrence::Start(index) | Occurrence::End(index) => Some(*index),
                Occurrence::Timed(_) => None,
            };
            for (symbol, access) in changes.accesses() {
                let claim = Claim {
                    actor: (self.happening << 32) | position,
                    step,
                    happening: self.happening,
                    time: self.time,
                    access,
                };
                if let Err(other) = self.claims.claim(symbol.clone(), claim) {
                    let reason = self.interference(&symbol, access, &other);
                    return Err(self.failure(reason, step));
                }
            }
        }
        Ok(())
    }

    fn interference(&self, symbol: &Symbol, access: Access, other: &Claim) -> Reason {
        let text = match symbol {
            Symbol::Fact(predicate, tuple) => self.scene.fact_text(*predicate, tuple),
            Symbol::Fluent(function, tuple) => self.scene.fluent_text(*function, tuple),
        };
        Reason::Interference {
            access: format!("{} {text}", access.verb()),
            other: other.step.map_or_else(
                || "a timed initial literal".into(),
                |index| format!("{} (step {})", self.steps[index].text, index + 1),
            ),
            other_access: format!("{} {text}", other.access.verb()),
            distance_s: self.time - other.time,
        }
    }
}
