//! The mutex rule: actions at one moment must not touch the same fact or fluent unless both read it,
//! both add it, both delete it, or both increase or decrease it.
//!
//! Source: Fox and Long, "PDDL2.1: an extension to PDDL for expressing temporal planning domains",
//! JAIR 20, 2003, definition 12 (mutex actions).

use std::collections::hash_map::Entry;

use rustc_hash::FxHashMap;

use super::state::Tuple;
use crate::pddl::model::{FunctionId, PredicateId};

/// A fact or a numeric fluent.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Symbol {
    Fact(PredicateId, Tuple),
    Fluent(FunctionId, Tuple),
}

/// What an occurrence does with a symbol.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Access {
    /// A condition, duration or right-hand side reads it.
    Needs,
    Adds,
    Deletes,
    /// Increases or decreases: such changes commute with one another.
    Shifts,
    /// Assigns or scales.
    Assigns,
}

impl Access {
    pub(super) const fn verb(self) -> &'static str {
        match self {
            Self::Needs => "needs",
            Self::Adds => "adds",
            Self::Deletes => "deletes",
            Self::Shifts | Self::Assigns => "changes",
        }
    }

    /// Whether two different actors may do this at one moment.
    const fn commutes_with(self, other: Self) -> bool {
        matches!(
            (self, other),
            (Self::Needs, Self::Needs)
                | (Self::Adds, Self::Adds)
                | (Self::Deletes, Self::Deletes)
                | (Self::Shifts, Self::Shifts)
        )
    }
}

/// Who does something, and when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Claim {
    /// Different for every occurrence of the plan.
    pub(super) actor: usize,
    /// The step it belongs to; `None` for timed initial literals.
    pub(super) step: Option<usize>,
    /// Counted from 1.
    pub(super) happening: usize,
    /// Of the happening [s].
    pub(super) time: f64,
    pub(super) access: Access,
}

/// Who touched what a short while ago.
#[derive(Debug, Default)]
pub(super) struct Claims {
    by_symbol: FxHashMap<Symbol, Vec<Claim>>,
    /// Smallest time between interfering happenings [s]; 0 checks within one happening only.
    separation_s: f64,
}

impl Claims {
    pub(super) fn new(separation_s: f64) -> Self {
        Self {
            by_symbol: FxHashMap::default(),
            separation_s,
        }
    }

    /// Registers a claim, or gives the earlier one that it conflicts with.
    pub(super) fn claim(&mut self, symbol: Symbol, claim: Claim) -> Result<(), Claim> {
        // A double cannot hold every sum of decimal fractions: 5.001 - 5 is a little below 0.001.
        let separation_s = self.separation_s * (1.0 - 1e-6) - 1e-12 * claim.time;
        let current = |other: &Claim| {
            other.happening == claim.happening || claim.time - other.time < separation_s
        };
        match self.by_symbol.entry(symbol) {
            Entry::Vacant(vacant) => {
                vacant.insert(vec![claim]);
                Ok(())
            }
            Entry::Occupied(mut occupied) => {
                let claims = occupied.get_mut();
                claims.retain(current);
                let conflict = claims.iter().find(|other| {
                    other.actor != claim.actor
                        && !other.access.commutes_with(claim.access)
                        && (other.happening == claim.happening
                            || other.step != claim.step
                            || claim.step.is_none())
                });
                if let Some(conflict) = conflict {
                    return Err(*conflict);
                }
                claims.push(claim);
                Ok(())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Access, Claim, Claims, Symbol};
    use crate::pddl::model::PredicateId;

    fn claim(actor: usize, happening: usize, time: f64, access: Access) -> Claim {
        Claim {
            actor,
            step: Some(actor),
            happening,
            time,
            access,
        }
    }

    fn symbol() -> Symbol {
        Symbol::Fact(PredicateId(0), Box::default())
    }

    #[test]
    fn only_like_accesses_commute() {
        use Access::{Adds, Assigns, Deletes, Needs, Shifts};
        let all = [Needs, Adds, Deletes, Shifts, Assigns];
        for one in all {
            for other in all {
                assert_eq!(one.commutes_with(other), other.commutes_with(one));
                assert_eq!(one.commutes_with(other), one == other && one != Assigns);
            }
        }
    }

    #[test]
    fn an_actor_does_not_disturb_itself() {
        let mut claims = Claims::new(0.0);
        assert!(
            claims
                .claim(symbol(), claim(1, 1, 0.0, Access::Needs))
                .is_ok()
        );
        assert!(
            claims
                .claim(symbol(), claim(1, 1, 0.0, Access::Deletes))
                .is_ok()
        );
        let conflict = claims.claim(symbol(), claim(2, 1, 0.0, Access::Needs));
        assert_eq!(conflict.unwrap_err().access, Access::Deletes);
    }

    #[test]
    fn separation_reaches_over_happenings() {
        let mut claims = Claims::new(0.001);
        assert!(
            claims
                .claim(symbol(), claim(1, 1, 5.0, Access::Adds))
                .is_ok()
        );
        assert!(
            claims
                .claim(symbol(), claim(2, 2, 5.000_5, Access::Needs))
                .is_err()
        );
        assert!(
            claims
                .claim(symbol(), claim(2, 2, 5.001, Access::Needs))
                .is_ok()
        );
    }

    #[test]
    fn without_separation_only_one_happening_counts() {
        let mut claims = Claims::new(0.0);
        assert!(
            claims
                .claim(symbol(), claim(1, 1, 5.0, Access::Adds))
                .is_ok()
        );
        assert!(
            claims
                .claim(symbol(), claim(2, 2, 5.000_5, Access::Needs))
                .is_ok()
        );
    }
}
