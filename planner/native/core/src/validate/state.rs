//! A state of the validator: facts and values by symbol, with the derived facts of that moment.

use std::sync::Arc;

use rustc_hash::{FxHashMap, FxHashSet};

use crate::attachment::StateView;
use crate::pddl::model::{Domain, FunctionId, ObjectId, PredicateId, Problem};

/// The arguments of a ground atom or fluent.
pub(super) type Tuple = Box<[ObjectId]>;

/// Which facts hold and which values the numeric fluents have.
///
/// Tables are shared between copies until one of them writes: what no action changes is never copied.
#[derive(Clone, Debug, Default)]
pub(super) struct State {
    facts: Vec<Arc<FxHashSet<Tuple>>>,
    values: Vec<Arc<FxHashMap<Tuple, f64>>>,
}

impl State {
    /// The state at time 0, without derived facts.
    pub(super) fn initial(domain: &Domain, problem: &Problem) -> Self {
        let mut state = Self {
            facts: vec![Arc::default(); domain.predicates.len()],
            values: vec![Arc::default(); domain.functions.len()],
        };
        for fact in &problem.facts {
            state.add(fact.predicate, &fact.arguments);
        }
        for (fluent, value) in &problem.fluents {
            state.set(fluent.function, &fluent.arguments, *value);
        }
        // The field's convention: costs start at zero even where the problem does not say so.
        for (index, function) in domain.functions.iter().enumerate() {
            if function.name.text == "total-cost" && function.parameters.is_empty() {
                let values = Arc::make_mut(&mut state.values[index]);
                values.entry(Box::default()).or_insert(0.0);
            }
        }
        state
    }

    /// Makes a fact true.
    pub(super) fn add(&mut self, predicate: PredicateId, arguments: &[ObjectId]) -> bool {
        !self.facts[predicate.index()].contains(arguments)
            && Arc::make_mut(&mut self.facts[predicate.index()]).insert(arguments.into())
    }

    /// Makes a fact false.
    pub(super) fn delete(&mut self, predicate: PredicateId, arguments: &[ObjectId]) {
        if self.facts[predicate.index()].contains(arguments) {
            Arc::make_mut(&mut self.facts[predicate.index()]).remove(arguments);
        }
    }

    /// Gives a fluent a value.
    pub(super) fn set(&mut self, function: FunctionId, arguments: &[ObjectId], value: f64) {
        Arc::make_mut(&mut self.values[function.index()]).insert(arguments.into(), value);
    }

    /// Forgets all facts of a predicate.
    pub(super) fn clear(&mut self, predicate: PredicateId) {
        self.facts[predicate.index()] = Arc::default();
    }

    /// The tuples for which a predicate holds, sorted.
    pub(super) fn tuples(&self, predicate: PredicateId) -> Vec<&Tuple> {
        let mut tuples: Vec<_> = self.facts[predicate.index()].iter().collect();
        tuples.sort();
        tuples
    }
}

impl StateView for State {
    fn holds(&self, predicate: PredicateId, arguments: &[ObjectId]) -> bool {
        self.facts[predicate.index()].contains(arguments)
    }

    fn value(&self, function: FunctionId, arguments: &[ObjectId]) -> Option<f64> {
        self.values[function.index()].get(arguments).copied()
    }
}
