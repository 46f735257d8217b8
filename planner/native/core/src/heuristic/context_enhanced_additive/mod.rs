//! The context-enhanced additive heuristic in its temporal and numeric form.
//!
//! To make a variable `v` have a value, an action needs values of other variables. The additive
//! heuristic counts each of these from the present state. This one counts them from the state in
//! which the actions that come before, for the same variable, have left them: every value of `v`
//! that is reached remembers its *context*, the values of the causal graph's predecessors of `v`.
//! One local problem for each variable and start value holds what each other value costs, all are
//! solved together, cheapest first, and share what they find.
//!
//! Temporal: an action costs one step, or its duration besides ([`Costs`]); an action's start
//! gives its start effects, its end the others; what a running action or a timed literal
//! will bring about costs the wait for it. Numeric: a comparison is a variable that an action makes
//! true by as many repetitions as the present gap takes.
//!
//! Neither admissible nor, on its own, safe: a context that cannot be left again makes a goal look
//! unreachable that is not. Such states are left to temporal FF, which calls a state a dead end only
//! if the delete relaxation does.
//!
//! Source: Helmert and Geffner, "Unifying the causal graph and additive heuristics", ICAPS 2008;
//! Eyerich, Mattmüller and Röger, "Using the context-enhanced additive heuristic for temporal and
//! numeric planning", ICAPS 2009.

mod graphs;
mod local_problems;
mod preferred;

pub use graphs::{Costs, Graphs};

use crate::epoch::compiled::Compiled;
use crate::epoch::state::State;
use crate::task::{Change, OperatorId};

use super::additive::AGENDA;
use super::domain_transition_graph::{Local, NOT_NUMERIC};
use super::finite_domain::{Assignment, Variable};
use super::relaxed::{Proposition, RelaxedTask};
use super::repetition::repetitions;
use super::temporal_ff::TemporalFf;
use super::{Estimate, Heuristic};
use graphs::priced;
use local_problems::{LocalProblems, NONE, Step};

/// Estimates of states that only the fallback can tell something about are this much higher.
const FALLBACK: u32 = 1 << 15;

/// The heuristic.
pub struct ContextEnhancedAdditive<'a> {
    compiled: &'a Compiled<'a>,
    relaxed: &'a RelaxedTask,
    graphs: &'a Graphs,
    fallback: TemporalFf<'a>,
    local: LocalProblems,
    stack: Vec<u32>,
    marked: Vec<bool>,
    preferred: Vec<OperatorId>,
    waits: bool,
}

impl<'a> ContextEnhancedAdditive<'a> {
    /// For one task.
    #[must_use]
    pub fn new(compiled: &'a Compiled<'a>, relaxed: &'a RelaxedTask, graphs: &'a Graphs) -> Self {
        Self {
            compiled,
            relaxed,
            graphs,
            fallback: TemporalFf::new(compiled, relaxed),
            local: LocalProblems::new(graphs),
            stack: Vec::new(),
            marked: Vec::new(),
            preferred: Vec::new(),
            waits: false,
        }
    }

    /// The cost of reaching all goals from a state; `None` if some cannot be reached.
    pub fn cost(&mut self, state: &State) -> Option<u32> {
        self.local.reset(self.graphs);
        self.preferred.clear();
        self.waits = false;
        self.read(state);
        let goal = self.begin_goal();
        let mut done = self.local.step(goal).open == 0;
        while !done {
            let (key, node) = self.local.settle_next(self.graphs)?;
            done = self.local.supply(node, goal);
            if !done {
                self.expand(node, key, state);
            }
        }
        Some(self.local.step(goal).cost)
    }

    /// The variables' values in a state, and what comes by itself.
    fn read(&mut self, state: &State) {
        self.fallback.seed(state);
        let exploration = self.fallback.exploration();
        for &proposition in exploration.reached() {
            let place = self.graphs.domain.place(proposition);
            if exploration.supporter(proposition) == AGENDA {
                let seconds = self.wait(state, proposition);
                let cost = priced(seconds, self.graphs.rate);
                self.local.scheduled.push((place, cost));
            } else {
                self.local.values[place.variable as usize] = place.value;
            }
        }
    }

    /// Time until something brings a proposition about by itself [s].
    fn wait(&self, state: &State, proposition: Proposition) -> f64 {
        if self.graphs.rate == 0.0 {
            return 0.0;
        }
        let running = state.running.iter().filter(|running| {
            self.relaxed.end_adds[running.operator.index()].contains(&proposition)
        });
        let timed = &self.compiled.task.timed[state.next_timed as usize..];
        let timed = timed
            .iter()
            .filter(|event| matches!(event.change, Change::Add(fact) if fact.0 == proposition));
        let ends = running.map(|running| running.end);
        let first = ends
            .chain(timed.map(|event| event.time))
            .fold(f64::INFINITY, f64::min);
        if first.is_finite() {
            (first - state.time).max(0.0)
        } else {
            0.0
        }
    }

    /// Places of goals that do not hold, and what holds in their stead.
    fn open_goals(&self) -> impl Iterator<Item = (Assignment, u32)> + use<'_> {
        let places = self.relaxed.goal.iter();
        let places = places.map(|&goal| self.graphs.domain.place(goal));
        let present = |place: &Assignment| self.local.values[place.variable as usize];
        places
            .map(move |place| (place, present(&place)))
            .filter(|(place, present)| place.value != *present)
    }

    /// A step that needs all goals.
    fn begin_goal(&mut self) -> u32 {
        let goal = self.local.begin_step(Step {
            source: NONE,
            transition: NONE,
            target: NONE,
            cost: 0,
            open: 0,
        });
        let open: Vec<(Assignment, u32)> = self.open_goals().collect();
        for (place, present) in open {
            let start = Assignment {
                value: present,
                ..place
            };
            let problem = self.local.begin(self.graphs, start, 0);
            self.local.need(goal, problem, place.value);
        }
        goal
    }

    /// Tries all transitions from a settled node.
    fn expand(&mut self, node: u32, key: u32, state: &State) {
        let graphs = self.graphs;
        let problem = self.local.problem(self.local.node(node).problem);
        let value = node - problem.nodes;
        let graph = &graphs.transitions[problem.variable as usize];
        let (first, transitions) = graph.from(value);
        for position in first..first + transitions.len() as u32 {
            self.attempt(node, position, key, state);
        }
        // From elsewhere these cost more.
        if value == problem.start {
            let (first, transitions) = graph.from_any();
            for position in first..first + transitions.len() as u32 {
                self.attempt(node, position, key, state);
            }
        }
    }

    /// Begins a step along a transition unless its target costs no more already.
    fn attempt(&mut self, source: u32, position: u32, key: u32, state: &State) {
        let graphs = self.graphs;
        let from = self.local.node(source);
        let problem = self.local.problem(from.problem);
        let transition = graphs.transitions[problem.variable as usize].transition(position);
        let target = problem.nodes + transition.target;
        let mut own = graphs.costs[transition.action as usize];
        if transition.support != NOT_NUMERIC {
            let support = &self.relaxed.supports[transition.support as usize];
            match repetitions(self.relaxed, support, state) {
                Some(times) => own = own.saturating_mul(times),
                None => return,
            }
        }
        let cost = from.cost.saturating_add(own);
        if cost >= self.local.node(target).cost {
            return;
        }
        let step = self.local.begin_step(Step {
            source,
            transition: position,
            target,
            cost,
            open: 0,
        });
        let predecessors = graphs.causal.predecessors(problem.variable);
        for &Local { predecessor, value } in &transition.conditions {
            let variable = predecessors[predecessor as usize];
            let present = self.local.context(from, predecessor);
            if present != value && !self.stays_open(transition.action, variable, value) {
                let start = Assignment {
                    variable,
                    value: present,
                };
                let other = self.local.begin(graphs, start, key);
                self.local.need(step, other, value);
            }
        }
        let Step { cost, open, .. } = self.local.step(step);
        if open == 0 {
            self.local.reach(target, cost, step);
        }
    }

    /// Whether a window that something running will close stays open for long enough.
    fn stays_open(&self, action: u32, variable: Variable, value: u32) -> bool {
        let domain = &self.graphs.domain;
        let closing = self.fallback.exploration().closing();
        closing.iter().any(|&(proposition, remaining)| {
            domain.place(proposition) == Assignment { variable, value }
                && self.relaxed.actions[action as usize].delay <= remaining
        })
    }
}

impl Heuristic for ContextEnhancedAdditive<'_> {
    fn evaluate(&mut self, state: &State) -> Estimate {
        if let Some(cost) = self.cost(state) {
            self.mark(state);
            return Estimate::Value(cost);
        }
        let estimate = self.fallback.evaluate(state);
        self.preferred.clear();
        self.preferred.extend_from_slice(self.fallback.preferred());
        self.waits = self.fallback.prefers_waiting();
        match estimate {
            Estimate::Value(value) => Estimate::Value(value.saturating_add(FALLBACK)),
            Estimate::DeadEnd => Estimate::DeadEnd,
        }
    }

    fn preferred(&self) -> &[OperatorId] {
        &self.preferred
    }

    fn prefers_waiting(&self) -> bool {
        self.waits || self.preferred.is_empty()
    }
}
