//! Local problems: what each value of a variable costs from a start value, solved all together.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::heuristic::domain_transition_graph::Local;
use crate::heuristic::finite_domain::{Assignment, Variable};

use super::graphs::Graphs;

pub(super) const NONE: u32 = u32::MAX;
/// How a value was reached that will come by itself.
pub(super) const SCHEDULED: u32 = u32::MAX - 1;

/// What the values of one variable cost from one of them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Problem {
    pub(super) variable: Variable,
    pub(super) start: u32,
    /// Its first node.
    pub(super) nodes: u32,
    /// Cost of all that comes before, for the order in which nodes are settled.
    base: u32,
}

/// One value in one local problem.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) problem: u32,
    pub(super) cost: u32,
    /// A step, [`SCHEDULED`], or [`NONE`] for the start value.
    pub(super) reached_by: u32,
    /// Steps that wait for it, a linked list.
    waiting: u32,
    /// First of its context's values; [`NONE`] until it is settled.
    pub(super) context: u32,
}

/// A transition tried from a settled node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Step {
    pub(super) source: u32,
    pub(super) transition: u32,
    pub(super) target: u32,
    pub(super) cost: u32,
    pub(super) open: u32,
}

/// The local problems of one state.
#[derive(Default)]
pub(super) struct LocalProblems {
    /// By variable: its value in the state.
    pub(super) values: Vec<u32>,
    /// What comes by itself, and what waiting for it costs.
    pub(super) scheduled: Vec<(Assignment, u32)>,
    /// By variable and start value.
    lookup: Vec<u32>,
    problems: Vec<Problem>,
    nodes: Vec<Node>,
    steps: Vec<Step>,
    waiting: Vec<(u32, u32)>,
    contexts: Vec<u32>,
    queue: BinaryHeap<Reverse<(u32, u32)>>,
}

impl LocalProblems {
    pub(super) fn new(graphs: &Graphs) -> Self {
        let variables = graphs.domain.variables() as usize;
        Self {
            values: vec![0; variables],
            lookup: vec![NONE; graphs.offsets[variables] as usize],
            ..Self::default()
        }
    }

    pub(super) fn reset(&mut self, graphs: &Graphs) {
        for problem in self.problems.drain(..) {
            let slot = graphs.offsets[problem.variable as usize] + problem.start;
            self.lookup[slot as usize] = NONE;
        }
        self.nodes.clear();
        self.steps.clear();
        self.waiting.clear();
        self.contexts.clear();
        self.queue.clear();
        self.scheduled.clear();
        for variable in 0..graphs.domain.variables() {
            self.values[variable as usize] = graphs.domain.none_of(variable);
        }
    }

    pub(super) fn nodes(&self) -> usize {
        self.nodes.len()
    }

    pub(super) fn node(&self, node: u32) -> Node {
        self.nodes[node as usize]
    }

    pub(super) fn step(&self, step: u32) -> Step {
        self.steps[step as usize]
    }

    pub(super) fn problem(&self, problem: u32) -> Problem {
        self.problems[problem as usize]
    }

    /// The value of a predecessor in the context of a settled node.
    pub(super) fn context(&self, node: Node, predecessor: u32) -> u32 {
        self.contexts[(node.context + predecessor) as usize]
    }

    /// The local problem of a variable from a start value, if it was needed so far.
    pub(super) fn find(&self, graphs: &Graphs, place: Assignment) -> Option<u32> {
        let slot = graphs.offsets[place.variable as usize] + place.value;
        let id = self.lookup[slot as usize];
        (id != NONE).then_some(id)
    }

    /// The local problem of a variable from a start value, begun if it is new.
    pub(super) fn begin(&mut self, graphs: &Graphs, place: Assignment, base: u32) -> u32 {
        if let Some(known) = self.find(graphs, place) {
            return known;
        }
        let Assignment {
            variable,
            value: start,
        } = place;
        let id = self.problems.len() as u32;
        let nodes = self.nodes.len() as u32;
        self.lookup[(graphs.offsets[variable as usize] + start) as usize] = id;
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
        let size = graphs.domain.size(variable) as usize;
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

    /// A step towards a node, or towards the goals if `target` is [`NONE`].
    pub(super) fn begin_step(&mut self, step: Step) -> u32 {
        self.steps.push(step);
        self.steps.len() as u32 - 1
    }

    pub(super) fn reach(&mut self, node: u32, cost: u32, reached_by: u32) {
        let slot = &mut self.nodes[node as usize];
        if cost < slot.cost {
            slot.cost = cost;
            slot.reached_by = reached_by;
            let base = self.problems[slot.problem as usize].base;
            self.queue.push(Reverse((base.saturating_add(cost), node)));
        }
    }

    /// Adds what a value costs to a step, or makes the step wait for it.
    pub(super) fn need(&mut self, step: u32, problem: u32, value: u32) {
        let node = self.problems[problem as usize].nodes + value;
        let Node { cost, context, .. } = self.nodes[node as usize];
        if context != NONE {
            let step = &mut self.steps[step as usize];
            step.cost = step.cost.saturating_add(cost);
            return;
        }
        self.steps[step as usize].open += 1;
        let entry = self.waiting.len() as u32;
        let next = std::mem::replace(&mut self.nodes[node as usize].waiting, entry);
        self.waiting.push((step, next));
    }

    /// Takes the cheapest open node and its key, and fixes its context.
    pub(super) fn settle_next(&mut self, graphs: &Graphs) -> Option<(u32, u32)> {
        while let Some(Reverse((key, node))) = self.queue.pop() {
            let Node {
                problem,
                cost,
                context,
                ..
            } = self.nodes[node as usize];
            let base = self.problems[problem as usize].base;
            if context == NONE && key == base.saturating_add(cost) {
                self.fix_context(node, graphs);
                return Some((key, node));
            }
        }
        None
    }

    /// The context of a node is that of the node before, changed by the step that leads from there.
    fn fix_context(&mut self, node: u32, graphs: &Graphs) {
        let reached_by = self.nodes[node as usize].reached_by;
        let context = self.contexts.len();
        self.nodes[node as usize].context = context as u32;
        let problem = self.problems[self.nodes[node as usize].problem as usize];
        let predecessors = graphs.causal.predecessors(problem.variable);
        if reached_by >= SCHEDULED {
            let values = predecessors.iter().map(|&v| self.values[v as usize]);
            self.contexts.extend(values);
            return;
        }
        let step = self.steps[reached_by as usize];
        let before = self.nodes[step.source as usize].context as usize;
        self.contexts
            .extend_from_within(before..before + predecessors.len());
        let graph = &graphs.transitions[problem.variable as usize];
        for &Local { predecessor, value } in &graph.transition(step.transition).effects {
            self.contexts[context + predecessor as usize] = value;
        }
    }

    /// Tells the steps that wait for a settled node; true if `goal` waits for nothing any more.
    pub(super) fn supply(&mut self, node: u32, goal: u32) -> bool {
        let Node { cost, waiting, .. } = self.nodes[node as usize];
        let mut cursor = waiting;
        while cursor != NONE {
            let (id, next) = self.waiting[cursor as usize];
            let step = &mut self.steps[id as usize];
            step.cost = step.cost.saturating_add(cost);
            step.open -= 1;
            let step = *step;
            if step.open == 0 {
                if id == goal {
                    return true;
                }
                self.reach(step.target, step.cost, id);
            }
            cursor = next;
        }
        self.nodes[node as usize].waiting = NONE;
        false
    }
}
