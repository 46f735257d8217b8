//! What the heuristic knows about a task: variables, graphs, costs of actions.

use crate::heuristic::causal_graph::CausalGraph;
use crate::heuristic::domain_transition_graph::{DomainTransitionGraph, domain_transition_graphs};
use crate::heuristic::finite_domain::FiniteDomain;
use crate::heuristic::relaxed::RelaxedTask;
use crate::task::Task;

/// What an action costs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Costs {
    /// One.
    #[default]
    Actions,
    /// One and its duration, in parts of the mean duration; waiting costs time too.
    Durations,
}

/// Parts of the mean duration in which durations are counted.
const PARTS: f64 = 4.0;

/// What does not change from state to state.
pub struct Graphs {
    pub(super) domain: FiniteDomain,
    pub(super) causal: CausalGraph,
    pub(super) transitions: Vec<DomainTransitionGraph>,
    /// By relaxed action.
    pub(super) costs: Vec<u32>,
    /// Seconds to cost.
    pub(super) rate: f64,
    /// Where each variable's values begin in tables over all values.
    pub(super) offsets: Vec<u32>,
}

impl Graphs {
    /// The graphs of a task; `None` if `stop` said so meanwhile.
    #[must_use]
    pub fn unless(
        stop: &dyn Fn() -> bool,
        task: &Task,
        relaxed: &RelaxedTask,
        costs: Costs,
    ) -> Option<Self> {
        let domain = FiniteDomain::new(task, relaxed);
        let causal = (!stop()).then(|| CausalGraph::new(relaxed, &domain))?;
        let transitions = domain_transition_graphs(stop, task, relaxed, &domain, &causal)?;
        let delays = || relaxed.actions.iter().map(|action| action.delay);
        let longer = delays().filter(|delay| *delay > 0.0).count().max(1);
        let mean = delays().sum::<f64>() / longer as f64;
        let rate = match costs {
            Costs::Durations if mean > 0.0 => PARTS / mean,
            _ => 0.0,
        };
        let actions = relaxed.actions.iter();
        let mut offsets = vec![0];
        for variable in 0..domain.variables() {
            offsets.push(offsets[variable as usize] + domain.size(variable));
        }
        Some(Self {
            costs: actions
                .map(|action| u32::from(!action.is_axiom()) + priced(action.delay, rate))
                .collect(),
            domain,
            causal,
            transitions,
            rate,
            offsets,
        })
    }
}

pub(super) fn priced(seconds: f64, rate: f64) -> u32 {
    (seconds * rate).round().clamp(0.0, 1e6) as u32
}
