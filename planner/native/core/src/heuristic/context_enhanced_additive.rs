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

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::epoch::compiled::Compiled;
use crate::epoch::state::State;
use crate::task::{Change, OperatorId, Task};

use super::additive::AGENDA;
use super::causal_graph::CausalGraph;
use super::domain_transition_graph::{
    DomainTransitionGraph, Local, NOT_NUMERIC, domain_transition_graphs,
};
use super::finite_domain::{Assignment, FiniteDomain, Variable};
use super::relaxed::{Proposition, RelaxedTask};
use super::repetition::repetitions;
use super::temporal_ff::TemporalFf;
use super::{Estimate, Heuristic};

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
/// Estimates of states that only the fallback can tell something about are this much higher.
const FALLBACK: u32 = 1 << 15;
const NONE: u32 = u32::MAX;
/// How a value was reached that will come by itself.
const SCHEDULED: u32 = u32::MAX - 1;

/// What does not change from state to state.
pub struct Graphs {
    domain: FiniteDomain,
    causal: CausalGraph,
    transitions: Vec<DomainTransitionGraph>,
    /// By relaxed action.
    costs: Vec<u32>,
    /// Seconds to cost.
    rate: f64,
    /// Where each variable's values begin in tables over all values.
    offsets: Vec<u32>,
}

impl Graphs {
    /// The graphs of a task.
    #[must_use]
    pub fn new(task: &Task, relaxed: &RelaxedTask, costs: Costs) -> Self {
        let domain = FiniteDomain::new(task, relaxed);
        let causal = CausalGraph::new(relaxed, &domain);
        let transitions = domain_transition_graphs(task, relaxed, &domain, &causal);
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
        Self {
            costs: actions
                .map(|action| u32::from(!action.is_axiom()) + priced(action.delay, rate))
                .collect(),
            domain,
            causal,
            transitions,
            rate,
            offsets,
        }
    }
}

fn priced(seconds: f64, rate: f64) -> u32 {
    (seconds * rate).round().clamp(0.0, 1e6) as u32
}

/// What the values of one variable cost from one of them.
#[derive(Clone, Copy, Debug)]
struct Problem {
    variable: Variable,
    start: u32,
    /// Its first node.
    nodes: u32,
    /// Cost of all that comes before, for the order in which nodes are settled.
    base: u32,
}

/// One value in one local problem.
#[derive(Clone, Copy, Debug)]
struct Node {
    problem: u32,
    cost: u32,
    /// A step, [`SCHEDULED`], or [`NONE`] for the start value.
    reached_by: u32,
    /// Steps that wait for it, a linked list.
    waiting: u32,
    /// First of its context's values, once it is settled.
    context: u32,
}

/// A transition tried from a settled node.
#[derive(Clone, Copy, Debug)]
struct Step {
    source: u32,
    transition: u32,
    target: u32,
    cost: u32,
    open: u32,
}

/// The heuristic.
pub struct ContextEnhancedAdditive<'a> {
    compiled: &'a Compiled<'a>,
    relaxed: &'a RelaxedTask,
    graphs: &'a Graphs,
    fallback: TemporalFf<'a>,
    /// By variable.
    values: Vec<u32>,
    /// What comes by itself, and what waiting for it costs.
    scheduled: Vec<(Assignment, u32)>,
    /// By variable and start value.
    lookup: Vec<u32>,
    problems: Vec<Problem>,
    nodes: Vec<Node>,
    steps: Vec<Step>,
    waiting: Vec<(u32, u32)>,
    contexts: Vec<u32>,
    queue: BinaryHeap<Reverse<(u32, u32)>>,
    stack: Vec<u32>,
    marked: Vec<bool>,
    preferred: Vec<OperatorId>,
    waits: bool,
}

impl<'a> ContextEnhancedAdditive<'a> {
    /// For one task.
    #[must_use]
    pub fn new(compiled: &'a Compiled<'a>, relaxed: &'a RelaxedTask, graphs: &'a Graphs) -> Self {
        let values = graphs.domain.variables() as usize;
        Self {
            compiled,
            relaxed,
            graphs,
            fallback: TemporalFf::new(compiled, relaxed),
            values: vec![0; values],
            scheduled: Vec::new(),
            lookup: vec![NONE; graphs.offsets[values] as usize],
            problems: Vec::new(),
            nodes: Vec::new(),
            steps: Vec::new(),
            waiting: Vec::new(),
            contexts: Vec::new(),
            queue: BinaryHeap::new(),
            stack: Vec::new(),
            marked: Vec::new(),
            preferred: Vec::new(),
            waits: false,
        }
    }

    /// The cost of reaching all goals from a state; `None` if some cannot be reached.
    pub fn cost(&mut self, state: &State) -> Option<u32> {
        self.reset();
        self.read(state);
        let goal = self.begin_goal();
        if self.steps[goal as usize].open == 0 {
            return Some(0);
        }
        while let Some(Reverse((key, node))) = self.queue.pop() {
            let Node { problem, cost, .. } = self.nodes[node as usize];
            let base = self.problems[problem as usize].base;
            if self.nodes[node as usize].context != NONE || key != base.saturating_add(cost) {
                continue;
            }
            self.settle(node);
            let mut cursor = std::mem::replace(&mut self.nodes[node as usize].waiting, NONE);
            while cursor != NONE {
                let (step, next) = self.waiting[cursor as usize];
                self.supply(step, cost);
                if step == goal && self.steps[goal as usize].open == 0 {
                    return Some(self.steps[goal as usize].cost);
                }
                cursor = next;
            }
            self.expand(node, key, state);
        }
        None
    }

    fn reset(&mut self) {
        let graphs = self.graphs;
        for problem in self.problems.drain(..) {
            self.lookup[(graphs.offsets[problem.variable as usize] + problem.start) as usize] =
                NONE;
        }
        self.nodes.clear();
        self.steps.clear();
        self.waiting.clear();
        self.contexts.clear();
        self.queue.clear();
        self.scheduled.clear();
        self.preferred.clear();
        self.waits = false;
    }

    /// The variables' values in a state, and what comes by itself.
    fn read(&mut self, state: &State) {
        let domain = &self.graphs.domain;
        for variable in 0..domain.variables() {
            self.values[variable as usize] = domain.none_of(variable);
        }
        self.fallback.seed(state);
        let exploration = self.fallback.exploration();
        for &proposition in exploration.reached() {
            let place = domain.place(proposition);
            if exploration.supporter(proposition) == AGENDA {
                let seconds = self.wait(state, proposition);
                let cost = priced(seconds, self.graphs.rate);
                self.scheduled.push((place, cost));
            } else {
                self.values[place.variable as usize] = place.value;
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

    /// A step that needs all goals.
    fn begin_goal(&mut self) -> u32 {
        let goal = self.steps.len() as u32;
        self.steps.push(Step {
            source: NONE,
            transition: NONE,
            target: NONE,
            cost: 0,
            open: 0,
        });
        for &proposition in &self.relaxed.goal {
            let place = self.graphs.domain.place(proposition);
            let start = self.values[place.variable as usize];
            if start != place.value {
                let problem = self.problem(place.variable, start, 0);
                self.await_node(goal, problem, place.value);
            }
        }
        goal
    }

    /// The local problem of a variable from a start value, begun if it is new.
    fn problem(&mut self, variable: Variable, start: u32, base: u32) -> u32 {
        let slot = (self.graphs.offsets[variable as usize] + start) as usize;
        if self.lookup[slot] != NONE {
            return self.lookup[slot];
        }
        let id = self.problems.len() as u32;
        let nodes = self.nodes.len() as u32;
        self.lookup[slot] = id;
        self.problems.push(Problem {
            variable,
            start,
            nodes,
            base,
        });
        let fresh = Node {
            problem: id,
            cost: NONE,
            reached_by: NONE,
            waiting: NONE,
            context: NONE,
        };
        let size = self.graphs.domain.size(variable) as usize;
        self.nodes.resize(self.nodes.len() + size, fresh);
        self.reach(nodes + start, 0, NONE);
        for index in 0..self.scheduled.len() {
            let (place, cost) = self.scheduled[index];
            if place.variable == variable && start != place.value {
                self.reach(nodes + place.value, cost, SCHEDULED);
            }
        }
        id
    }

    fn reach(&mut self, node: u32, cost: u32, reached_by: u32) {
        let slot = &mut self.nodes[node as usize];
        if cost < slot.cost {
            slot.cost = cost;
            slot.reached_by = reached_by;
            let base = self.problems[slot.problem as usize].base;
            self.queue.push(Reverse((base.saturating_add(cost), node)));
        }
    }

    /// Adds what a value costs to a step, or makes the step wait for it.
    fn await_node(&mut self, step: u32, problem: u32, value: u32) {
        let node = self.problems[problem as usize].nodes + value;
        let Node { cost, context, .. } = self.nodes[node as usize];
        if context != NONE {
            let step = &mut self.steps[step as usize];
            step.cost = step.cost.saturating_add(cost);
            return;
        }
        self.steps[step as usize].open += 1;
        let next = std::mem::replace(
            &mut self.nodes[node as usize].waiting,
            self.waiting.len() as u32,
        );
        self.waiting.push((step, next));
    }

    /// One of the values that a step waits for has been reached.
    fn supply(&mut self, id: u32, cost: u32) {
        let step = &mut self.steps[id as usize];
        step.cost = step.cost.saturating_add(cost);
        step.open -= 1;
        let Step {
            cost, open, target, ..
        } = *step;
        if open == 0 && target != NONE {
            self.reach(target, cost, id);
        }
    }

    /// Fixes the context of a node whose cost is final.
    fn settle(&mut self, node: u32) {
        let graphs = self.graphs;
        let reached_by = self.nodes[node as usize].reached_by;
        let context = self.contexts.len();
        self.nodes[node as usize].context = context as u32;
        let problem = self.problems[self.nodes[node as usize].problem as usize];
        if reached_by >= SCHEDULED {
            let predecessors = graphs.causal.predecessors(problem.variable);
            self.contexts
                .extend(predecessors.iter().map(|&v| self.values[v as usize]));
            return;
        }
        let step = self.steps[reached_by as usize];
        let before = self.nodes[step.source as usize].context as usize;
        let width = graphs.causal.predecessors(problem.variable).len();
        self.contexts.extend_from_within(before..before + width);
        let graph = &graphs.transitions[problem.variable as usize];
        for &Local { predecessor, value } in &graph.transition(step.transition).effects {
            self.contexts[context + predecessor as usize] = value;
        }
    }

    /// Tries all transitions from a settled node.
    fn expand(&mut self, node: u32, key: u32, state: &State) {
        let graphs = self.graphs;
        let problem = self.problems[self.nodes[node as usize].problem as usize];
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

    fn attempt(&mut self, source: u32, position: u32, key: u32, state: &State) {
        let graphs = self.graphs;
        let from = self.nodes[source as usize];
        let problem = self.problems[from.problem as usize];
        let transition = graphs.transitions[problem.variable as usize].transition(position);
        let target = problem.nodes + transition.target;
        let mut own = graphs.costs[transition.action as usize];
        if transition.support != NOT_NUMERIC {
            let action = &self.relaxed.actions[transition.action as usize];
            let support = &action.numeric[transition.support as usize];
            match repetitions(self.relaxed, support, state) {
                Some(times) => own = own.saturating_mul(times),
                None => return,
            }
        }
        let cost = from.cost.saturating_add(own);
        if cost >= self.nodes[target as usize].cost {
            return;
        }
        let step = self.steps.len() as u32;
        self.steps.push(Step {
            source,
            transition: position,
            target,
            cost,
            open: 0,
        });
        let predecessors = graphs.causal.predecessors(problem.variable);
        for &Local { predecessor, value } in &transition.conditions {
            let variable = predecessors[predecessor as usize];
            let present = self.contexts[(from.context + predecessor) as usize];
            if present != value && !self.closes_late_enough(transition.action, variable, value) {
                let other = self.problem(variable, present, key);
                self.await_node(step, other, value);
            }
        }
        let Step { cost, open, .. } = self.steps[step as usize];
        if open == 0 {
            self.reach(target, cost, step);
        }
    }

    /// Whether a window that something running will close stays open for long enough.
    fn closes_late_enough(&self, action: u32, variable: Variable, value: u32) -> bool {
        let domain = &self.graphs.domain;
        let closing = self.fallback.exploration().closing();
        closing.iter().any(|&(proposition, remaining)| {
            domain.place(proposition) == Assignment { variable, value }
                && self.relaxed.actions[action as usize].delay <= remaining
        })
    }

    /// Walks back from the goals and notes operators that could start now.
    fn mark(&mut self, state: &State) {
        let graphs = self.graphs;
        self.marked.clear();
        self.marked.resize(self.nodes.len(), false);
        self.stack.clear();
        for &proposition in &self.relaxed.goal {
            let place = graphs.domain.place(proposition);
            let start = self.values[place.variable as usize];
            if start != place.value {
                let problem = self.problem(place.variable, start, 0);
                let node = self.problems[problem as usize].nodes + place.value;
                self.stack.push(node);
            }
        }
        while let Some(node) = self.stack.pop() {
            if std::mem::replace(&mut self.marked[node as usize], true) {
                continue;
            }
            let reached_by = self.nodes[node as usize].reached_by;
            if reached_by == SCHEDULED {
                self.waits = true;
            }
            if reached_by >= SCHEDULED {
                continue;
            }
            let step = self.steps[reached_by as usize];
            let source = self.nodes[step.source as usize];
            let variable = self.problems[source.problem as usize].variable;
            let transition = graphs.transitions[variable as usize].transition(step.transition);
            self.stack.push(step.source);
            let predecessors = graphs.causal.predecessors(variable);
            for &Local { predecessor, value } in &transition.conditions {
                let variable = predecessors[predecessor as usize];
                let present = self.contexts[(source.context + predecessor) as usize];
                let slot = (graphs.offsets[variable as usize] + present) as usize;
                if present != value && self.lookup[slot] != NONE {
                    let problem = self.problems[self.lookup[slot] as usize];
                    let needed = problem.nodes + value;
                    if self.nodes[needed as usize].context != NONE {
                        self.stack.push(needed);
                    }
                }
            }
            let operator = self.relaxed.actions[transition.action as usize].operator;
            let compiled = self.compiled.operators.get(operator.index());
            if compiled.is_some_and(|o| o.start_condition.literals_hold(&state.facts)) {
                self.preferred.push(operator);
            }
        }
        self.preferred.sort_unstable();
        self.preferred.dedup();
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
