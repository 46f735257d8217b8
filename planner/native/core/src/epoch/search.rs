//! Best-first search with deferred evaluation over alternating open lists.
//!
//! A node is evaluated when it is expanded and hands its values to all its successors (Richter and
//! Helmert, "Preferred operators and deferred evaluation in satisficing planning", ICAPS 2009); see
//! [`super::alternation`] for the lists. After a plan the same search goes on and prunes what cannot
//! be shorter.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rustc_hash::FxHashSet;

use crate::heuristic::{Estimate, Heuristic};
use crate::plan::Plan;
use crate::task::{Duration, OperatorId, Task};

use super::alternation::Alternation;
use super::compiled::Compiled;
use super::registry::{Dominance, Edge, NodeId, Registry};
use super::state::State;
use super::successors::Successors;
use super::transitions::Transitions;

/// Operators from which on the limits are looked at after every state.
const LARGE: usize = 5_000;

/// Parameters of one search.
#[derive(Clone, Copy, Debug)]
pub struct Parameters {
    /// Weight of the heuristic against the time already spent, in time units an action; 0 is greedy.
    pub time_weight: f64,
    /// Shuffles successors if not 0.
    pub seed: u64,
    /// When states make others superfluous.
    pub dominance: Dominance,
    /// Differences of time that do not count [s].
    pub tolerance: f64,
    /// Bytes that states and open lists may take.
    pub memory: usize,
}

/// How a run of the search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// There is more to search.
    Interrupted,
    /// A plan was found; the search can go on.
    Found,
    /// Nothing is left.
    Exhausted,
    /// The memory allowed is full.
    MemoryFull,
}

/// What a search has done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statistics {
    /// States whose successors were generated.
    pub expansions: u64,
    /// Calls of the heuristic.
    pub evaluations: u64,
    /// Successors built.
    pub generated: u64,
    /// States that the heuristic gave up.
    pub dead_ends: u64,
}

/// How states are told apart, and what was met.
type Fingerprints<'a> = (Box<dyn Fn(&State) -> u64 + 'a>, FxHashSet<u64>);

/// One best-first search.
pub struct Search<'a> {
    transitions: Transitions<'a>,
    compiled: &'a Compiled<'a>,
    successors: &'a Successors,
    heuristics: Vec<Box<dyn Heuristic + 'a>>,
    pub(crate) parameters: Parameters,
    registry: Registry,
    open: Alternation,
    bound: f64,
    estimates: Vec<u32>,
    random: ChaCha8Rng,
    state: State,
    parent_facts: Vec<u64>,
    marked: Vec<u32>,
    stamp: u32,
    fingerprints: Option<Fingerprints<'a>>,
    started: bool,
    /// What was done so far.
    pub statistics: Statistics,
    /// Whether a duration had to be chosen among several.
    pub chose_duration: bool,
}

impl<'a> Search<'a> {
    /// A search that has not begun; with several heuristics their open lists take turns.
    #[must_use]
    pub fn new(
        transitions: Transitions<'a>,
        successors: &'a Successors,
        heuristics: Vec<Box<dyn Heuristic + 'a>>,
        parameters: Parameters,
    ) -> Self {
        let compiled = transitions.compiled;
        Self {
            transitions,
            compiled,
            successors,
            open: Alternation::new(heuristics.len()),
            estimates: Vec::with_capacity(heuristics.len()),
            heuristics,
            registry: Registry::new(
                compiled.words,
                compiled.task.fluents.len(),
                parameters.dominance,
                parameters.tolerance,
            ),
            bound: f64::INFINITY,
            random: ChaCha8Rng::seed_from_u64(parameters.seed),
            parameters,
            state: State::default(),
            parent_facts: Vec::new(),
            marked: vec![0; compiled.operators.len()],
            stamp: 0,
            fingerprints: None,
            started: false,
            statistics: Statistics::default(),
            chose_duration: false,
        }
    }

    /// Drops states whose fingerprint has been met; only for states without a clock.
    pub fn tell_apart_by(&mut self, fingerprint: Box<dyn Fn(&State) -> u64 + 'a>) {
        self.fingerprints = Some((fingerprint, FxHashSet::default()));
    }

    /// Looks only for plans that end earlier than this [s] from now on.
    pub fn set_bound(&mut self, bound: f64) {
        self.bound = bound;
    }

    /// Bytes held, about.
    #[must_use]
    pub fn memory(&self) -> usize {
        let fingerprints = self.fingerprints.as_ref();
        self.registry.memory()
            + self.open.memory()
            + fingerprints.map_or(0, |(_, met)| 9 * met.capacity())
    }

    /// Searches until a plan below the bound is found (given to `found`), `expansions` more states
    /// are expanded, `stop` says so, or the space is exhausted.
    pub fn run(
        &mut self,
        expansions: u64,
        stop: &mut dyn FnMut() -> bool,
        found: &mut dyn FnMut(Found),
    ) -> Status {
        if !self.started {
            self.started = true;
            self.state = self.transitions.initial();
            if let Some(node) = self.registry.insert(&self.state, None) {
                self.parent_facts.clear();
                if self.expand(node, None, found) {
                    return Status::Found;
                }
            }
        }
        let end = self.statistics.expansions + expansions;
        // Where a state takes long, every one is followed by a look at the limits.
        let large = self.compiled.operators.len() >= LARGE;
        let interval = if large { 1 } else { 16 };
        while self.statistics.expansions < end {
            if self.statistics.generated.is_multiple_of(interval) && stop() {
                return Status::Interrupted;
            }
            let Some((parent, edge)) = self.next() else {
                return Status::Exhausted;
            };
            self.registry.load(parent, &mut self.state);
            self.parent_facts.clone_from(&self.state.facts);
            let parent_time = self.state.time;
            self.statistics.generated += 1;
            let applies = match edge.operator() {
                None => self.transitions.advance(&mut self.state),
                Some((operator, longest)) => {
                    self.transitions.start(&mut self.state, operator, longest)
                }
            };
            if !applies || self.state.last_end() >= self.bound {
                continue;
            }
            if let Some((fingerprint, met)) = &mut self.fingerprints
                && !met.insert(fingerprint(&self.state))
            {
                continue;
            }
            let Some(node) = self.registry.insert(&self.state, Some((parent, edge))) else {
                continue;
            };
            let simultaneous = (self.state.time == parent_time)
                .then(|| edge.operator().map(|(operator, _)| operator))
                .flatten();
            if self.expand(node, simultaneous, found) {
                return Status::Found;
            }
            if self.statistics.expansions.is_multiple_of(64 * interval)
                && self.memory() > self.parameters.memory
            {
                return Status::MemoryFull;
            }
        }
        Status::Interrupted
    }

    fn next(&mut self) -> Option<(NodeId, Edge)> {
        let registry = &self.registry;
        let bound = self.bound;
        // Waiting for a timed literal does not lengthen a plan.
        let timeless = self.compiled.task.timed.is_empty();
        let mut stale = |node| registry.is_dead(node) || (timeless && registry.time(node) >= bound);
        self.open.pop(&mut stale)
    }

    /// Evaluates the current state and queues its successors; true if it is a goal.
    fn expand(
        &mut self,
        node: NodeId,
        simultaneous: Option<OperatorId>,
        found: &mut dyn FnMut(Found),
    ) -> bool {
        if self.transitions.is_goal(&self.state) {
            let plan = replay(&self.transitions, &self.registry.path(node));
            if self.compiled.task.metric.is_none() {
                self.bound = self.bound.min(plan.cost);
            }
            found(plan);
            return true;
        }
        if !self.evaluate() {
            self.statistics.dead_ends += 1;
            return false;
        }
        self.statistics.expansions += 1;
        self.open.note(&self.estimates);
        let mut edges = Vec::new();
        let mut preferred = Vec::new();
        if self.state.next_event(self.compiled).is_some() {
            edges.push(Edge::ADVANCE);
            if self.heuristics.iter().any(|each| each.prefers_waiting()) {
                preferred.push(Edge::ADVANCE);
            }
        }
        let first = (edges.len(), preferred.len());
        let (compiled, marked, stamp) = (self.compiled, &self.marked, self.stamp);
        let parent_facts = &self.parent_facts;
        let mut chose_duration = false;
        self.successors
            .for_each(compiled, &self.state, self.bound, &mut |id| {
                if simultaneous.is_some_and(|last| commutes(compiled, last, id, parent_facts)) {
                    return;
                }
                let mut push = |edge| {
                    edges.push(edge);
                    if marked[id.index()] == stamp {
                        preferred.push(edge);
                    }
                };
                if let Some(Duration::Bounds(_, upper)) = &compiled.operator(id).duration {
                    chose_duration = true;
                    if !matches!(upper, crate::task::GroundExpression::Constant(value) if value.is_infinite())
                    {
                        push(Edge::start(id, true));
                    }
                }
                push(Edge::start(id, false));
            });
        self.chose_duration |= chose_duration;
        if self.parameters.seed != 0 {
            shuffle(&mut edges[first.0..], &mut self.random);
            shuffle(&mut preferred[first.1..], &mut self.random);
        }
        for index in 0..self.estimates.len() {
            self.estimates[index] = self.priority(self.estimates[index]);
        }
        self.open.push(node, &self.estimates, edges, preferred);
        false
    }

    /// Asks all heuristics about the current state; false if one knows that it is a dead end.
    fn evaluate(&mut self) -> bool {
        self.stamp += 1;
        self.estimates.clear();
        for heuristic in &mut self.heuristics {
            self.statistics.evaluations += 1;
            let Estimate::Value(estimate) = heuristic.evaluate(&self.state) else {
                return false;
            };
            self.estimates.push(estimate);
            for operator in heuristic.preferred() {
                self.marked[operator.index()] = self.stamp;
            }
        }
        true
    }

    fn priority(&self, estimate: u32) -> u32 {
        if self.parameters.time_weight == 0.0 {
            return estimate;
        }
        let spent = self.state.last_end().max(self.state.time) / self.parameters.time_weight;
        estimate.saturating_add(spent.min(1e6) as u32)
    }
}

/// A plan as operators with their starts and durations [s].
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// By start.
    pub steps: Vec<(OperatorId, f64, Option<f64>)>,
    /// The makespan [s], or the value of the metric.
    pub cost: f64,
}

impl Found {
    /// The plan with names.
    #[must_use]
    pub fn plan(&self, task: &Task) -> Plan {
        Plan {
            steps: self
                .steps
                .iter()
                .map(|&(operator, start, duration)| task.step(operator, start, duration))
                .collect(),
        }
    }
}

/// Runs edges from the initial state and writes down the steps.
#[must_use]
pub fn replay(transitions: &Transitions<'_>, edges: &[Edge]) -> Found {
    let compiled = transitions.compiled;
    let mut state = transitions.initial();
    let mut steps = Vec::new();
    let mut makespan: f64 = 0.0;
    for edge in edges {
        match edge.operator() {
            None => {
                transitions.advance(&mut state);
            }
            Some((operator, longest)) => {
                let duration = transitions.duration(operator, &state, longest);
                transitions.start(&mut state, operator, longest);
                let durative = compiled.operator(operator).duration.is_some();
                steps.push((operator, state.time, durative.then_some(duration)));
                makespan = makespan.max(state.time + duration);
            }
        }
    }
    steps.sort_by(|left, right| left.1.total_cmp(&right.1));
    Found {
        cost: transitions.metric(&state, makespan).unwrap_or(makespan),
        steps,
    }
}

/// Whether starting `next` just after `last` only repeats the other order: both could start at the
/// parent state and do not touch each other. Of the two orders the one with rising ids is kept.
fn commutes(
    compiled: &Compiled<'_>,
    last: OperatorId,
    next: OperatorId,
    parent_facts: &[u64],
) -> bool {
    if next >= last || parent_facts.is_empty() {
        return false;
    }
    let (one, two) = (compiled.operator(last), compiled.operator(next));
    let simple = |operator: &super::compiled::CompiledOperator| {
        operator.duration.is_some()
            && !operator.may_overlap_itself
            && operator.invariant.comparisons.is_empty()
            && operator.invariant.calls.is_empty()
            && operator.start_condition.comparisons.is_empty()
            && operator.start_condition.calls.is_empty()
    };
    simple(one)
        && simple(two)
        && two.start_condition.literals_hold(parent_facts)
        && two.invariant.literals_hold(parent_facts)
        && one.invariant.literals_hold(parent_facts)
        && !one.start.interferes(&two.start)
}

fn shuffle(edges: &mut [Edge], random: &mut ChaCha8Rng) {
    for index in (1..edges.len()).rev() {
        edges.swap(index, random.random_range(0..=index));
    }
}
