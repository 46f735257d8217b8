//! Why a condition is false: its smallest false part and the facts around it.

use rustc_hash::{FxHashMap, FxHashSet};

use super::interference::Symbol;
use super::scene::{Fault, Moment, Scene};
use super::state::State;
use crate::attachment::StateView as _;
use crate::pddl::model::{Condition, ConditionKind, ObjectId};

/// When a symbol last changed [s], and by what.
pub(super) type History = FxHashMap<Symbol, (f64, String)>;

/// More facts than this do not help a reader.
const MOST_FACTS: usize = 12;

impl Scene<'_> {
    /// The smallest part of a false condition that is false, with its bindings.
    pub(super) fn smallest_false<'c>(
        &self,
        moment: &Moment<'_>,
        condition: &'c Condition,
        bindings: &[ObjectId],
    ) -> Result<(&'c Condition, Vec<ObjectId>), Fault> {
        let mut stack = bindings.to_vec();
        match &condition.kind {
            ConditionKind::And(parts) => {
                for part in parts {
                    if !self.holds(moment, part, &mut stack)? {
                        return self.smallest_false(moment, part, bindings);
                    }
                }
            }
            ConditionKind::Forall(parameters, part) => {
                let exception = self.instance(parameters, &mut stack, &mut |bindings| {
                    Ok(!self.holds(moment, part, bindings)?)
                })?;
                if let Some(stack) = exception {
                    return self.smallest_false(moment, part, &stack);
                }
            }
            _ => {}
        }
        Ok((condition, stack))
    }

    /// What a reader wants to know about a false condition.
    pub(super) fn facts_around(
        &self,
        state: &State,
        condition: &Condition,
        bindings: &[ObjectId],
        history: &History,
    ) -> Result<Vec<String>, Fault> {
        let mut mentioned = FxHashSet::default();
        self.needs(condition, &mut bindings.to_vec(), &mut mentioned)?;
        let mut mentioned: Vec<_> = mentioned.into_iter().collect();
        mentioned.sort();
        let mut lines = Vec::new();
        for symbol in &mentioned {
            lines.push(self.symbol_line(state, symbol, history));
            if let Symbol::Fact(predicate, tuple) = symbol
                && !state.holds(*predicate, tuple)
                && let Some(first) = tuple.first()
            {
                for other in state.tuples(*predicate) {
                    let near = Symbol::Fact(*predicate, other.clone());
                    if other.first() == Some(first) && !mentioned.contains(&near) {
                        lines.push(self.symbol_line(state, &near, history));
                    }
                }
            }
        }
        let more = lines.len().saturating_sub(MOST_FACTS);
        lines.truncate(MOST_FACTS);
        if more > 0 {
            lines.push(format!("... and {more} more"));
        }
        Ok(lines)
    }

    fn symbol_line(&self, state: &State, symbol: &Symbol, history: &History) -> String {
        let what = match symbol {
            Symbol::Fact(predicate, tuple) => {
                let holds = state.holds(*predicate, tuple);
                format!("{} is {holds}", self.fact_text(*predicate, tuple))
            }
            Symbol::Fluent(function, tuple) => {
                let fluent = self.fluent_text(*function, tuple);
                match state.value(*function, tuple) {
                    Some(value) => format!("{fluent} is {value}"),
                    None => format!("{fluent} has no value"),
                }
            }
        };
        match history.get(symbol) {
            Some((time, cause)) => format!("{what} since {time} ({cause})"),
            None => format!("{what} since the start"),
        }
    }
}
