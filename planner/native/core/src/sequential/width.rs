//! Best-first width search: new states first, of those the ones with most goals.
//!
//! No heuristic is asked for each state, so that it expands many more states than a heuristic search,
//! and it is not held up where heuristics are blind. Novelty is counted apart for each number of open goals and
//! of relaxed steps done: facts of the relaxed plan of the last ancestor that reached a goal.
//!
//! Source: Lipovetzky and Geffner, "Best-first width search: exploration and exploitation in
//! classical planning", AAAI 2017 (BFWS(f5)).

use std::collections::VecDeque;

use rustc_hash::FxHashSet;

use crate::epoch::registry::{Dominance, Edge, NodeId, Registry};
use crate::epoch::search::{Found, Statistics, Status, replay};
use crate::epoch::state::State;
use crate::epoch::successors::Successors;
use crate::epoch::transitions::Transitions;
use crate::heuristic::additive::{AGENDA, AdditiveExploration, NOBODY};
use crate::heuristic::relaxed::RelaxedTask;
use crate::task::FactId;

use super::novelty::{Novelty, OLD};

/// Facts of a relaxed plan that are counted, at most.
const AIMS: usize = 128;

/// What is known about a node besides its state.
#[derive(Clone, Copy, Debug)]
struct Progress {
    /// Goals that do not hold.
    open: u32,
    /// Which relaxed plan its path follows.
    aims: u32,
    /// The facts of it that its path has reached, one bit each.
    reached: u128,
}

/// How states are told apart, and what was met.
type Fingerprints<'a> = (Box<dyn Fn(&State) -> u64 + 'a>, FxHashSet<u64>);

/// One search for a sequence of steps; deterministic.
pub struct WidthSearch<'a> {
    transitions: Transitions<'a>,
    successors: &'a Successors,
    relaxed: &'a RelaxedTask,
    exploration: AdditiveExploration<'a>,
    goal: Vec<(FactId, bool)>,
    registry: Registry,
    progress: Vec<Progress>,
    aims: Vec<Vec<FactId>>,
    novelty: Novelty,
    open: Vec<VecDeque<NodeId>>,
    fingerprints: Option<Fingerprints<'a>>,
    memory: usize,
    started: bool,
    /// States on the way to which a goal was reached, and how many of them were dead ends.
    reached: (u32, u32),
    /// What was done so far.
    pub statistics: Statistics,
}

impl<'a> WidthSearch<'a> {
    /// A search that has not begun; states and tables may take `memory` bytes.
    #[must_use]
    pub fn new(
        transitions: Transitions<'a>,
        successors: &'a Successors,
        relaxed: &'a RelaxedTask,
        memory: usize,
    ) -> Self {
        let compiled = transitions.compiled;
        let task = compiled.task;
        let goal = &task.goal;
        let wanted = goal.positive.iter().map(|fact| (*fact, true));
        let unwanted = goal.negative.iter().map(|fact| (*fact, false));
        Self {
            successors,
            relaxed,
            exploration: AdditiveExploration::new(compiled, relaxed),
            goal: wanted.chain(unwanted).collect(),
            registry: Registry::new(compiled.words, task.fluents.len(), Dominance::Untimed, 0.0),
            progress: Vec::new(),
            aims: Vec::new(),
            novelty: Novelty::new(task.facts.len(), memory / 2),
            open: Vec::new(),
            fingerprints: None,
            memory,
            started: false,
            reached: (0, 0),
            statistics: Statistics::default(),
            transitions,
        }
    }

    /// Drops states whose fingerprint has been met.
    pub fn tell_apart_by(&mut self, fingerprint: Box<dyn Fn(&State) -> u64 + 'a>) {
        self.fingerprints = Some((fingerprint, FxHashSet::default()));
    }

    /// Searches until a plan is found, `expansions` more states are expanded, `stop` says so, or the
    /// space is exhausted.
    pub fn run(
        &mut self,
        expansions: u64,
        stop: &mut dyn FnMut() -> bool,
        found: &mut dyn FnMut(Found),
    ) -> Status {
        if !self.started {
            self.started = true;
            let state = self.transitions.initial();
            if self.transitions.is_goal(&state) {
                found(replay(&self.transitions, &[]));
                return Status::Found;
            }
            if !self.enter(&state, None) {
                return Status::Exhausted;
            }
        }
        let end = self.statistics.expansions + expansions;
        let (mut parent, mut child) = (State::default(), State::default());
        let mut applicable = Vec::new();
        while self.statistics.expansions < end {
            if self.statistics.expansions.is_multiple_of(16) && stop() {
                return Status::Interrupted;
            }
            if self.statistics.expansions.is_multiple_of(1024) && self.memory() > self.memory {
                return Status::MemoryFull;
            }
            let Some(node) = self.open.iter_mut().find_map(VecDeque::pop_front) else {
                return Status::Exhausted;
            };
            self.statistics.expansions += 1;
            self.registry.load(node, &mut parent);
            if self.treacherous() && !self.relaxation_reaches_goal(&parent) {
                continue;
            }
            applicable.clear();
            let compiled = self.transitions.compiled;
            let visit = &mut |operator| applicable.push(operator);
            self.successors
                .for_each(compiled, &parent, f64::INFINITY, visit);
            for &operator in &applicable {
                child.clone_from(&parent);
                self.statistics.generated += 1;
                if !self.transitions.start(&mut child, operator, false) {
                    continue;
                }
                let edge = Edge::start(operator, false);
                if self.transitions.is_goal(&child) {
                    let mut path = self.registry.path(node);
                    path.push(edge);
                    found(replay(&self.transitions, &path));
                    return Status::Found;
                }
                self.enter(&child, Some((node, edge, &parent)));
            }
        }
        Status::Interrupted
    }

    /// Whether goals are often reached in ways that lead nowhere: then every state is worth a look.
    fn treacherous(&self) -> bool {
        let (reached, dead) = self.reached;
        reached >= 8 && 4 * dead > reached
    }

    fn relaxation_reaches_goal(&mut self, state: &State) -> bool {
        self.statistics.evaluations += 1;
        self.exploration.seed(state);
        let reaches = self.exploration.explore(state);
        self.statistics.dead_ends += u64::from(!reaches);
        reaches
    }

    fn memory(&self) -> usize {
        let fingerprints = self.fingerprints.as_ref();
        self.registry.memory()
            + self.novelty.memory()
            + self.progress.capacity() * size_of::<Progress>()
            + self.aims.len() * (AIMS * size_of::<FactId>() + 24)
            + self.progress.len() * size_of::<NodeId>()
            + fingerprints.map_or(0, |(_, met)| 9 * met.capacity())
    }

    /// Stores a state and queues it; false if it is known or a dead end.
    fn enter(&mut self, state: &State, parent: Option<(NodeId, Edge, &State)>) -> bool {
        if let Some((fingerprint, met)) = &mut self.fingerprints
            && !met.insert(fingerprint(state))
        {
            return false;
        }
        let origin = parent.map(|(node, edge, _)| (node, edge));
        let Some(node) = self.registry.insert(state, origin) else {
            return false;
        };
        let unmet = |goal: &&(FactId, bool)| state.holds(goal.0) != goal.1;
        let open = self.goal.iter().filter(unmet).count() as u32;
        let before = parent.map(|(node, _, _)| self.progress[node.0 as usize]);
        let mut progress = Progress {
            open,
            aims: before.map_or(u32::MAX, |before| before.aims),
            reached: before.map_or(0, |before| before.reached),
        };
        debug_assert_eq!(self.progress.len(), node.0 as usize);
        if before.is_none_or(|before| open < before.open) {
            self.reached.0 += 1;
            match self.relaxed_plan(state) {
                Some(aims) => {
                    progress.aims = self.aims.len() as u32;
                    progress.reached = 0;
                    self.aims.push(aims);
                }
                None => {
                    self.reached.1 += 1;
                    self.progress.push(progress);
                    return false;
                }
            }
        }
        for (bit, fact) in self.aims[progress.aims as usize].iter().enumerate() {
            if state.holds(*fact) {
                progress.reached |= 1 << bit;
            }
        }
        self.progress.push(progress);
        let class = |progress: &Progress| {
            u64::from(progress.open) << 32 | u64::from(progress.reached.count_ones())
        };
        let alike = parent
            .filter(|_| before.is_some_and(|before| class(&before) == class(&progress)))
            .map(|(_, _, state)| state.facts.as_slice());
        let novelty = self.novelty.note(class(&progress), &state.facts, alike);
        debug_assert!((1..=OLD).contains(&novelty));
        let bucket = (novelty as usize - 1) * (self.goal.len() + 1) + open as usize;
        if bucket >= self.open.len() {
            self.open.resize_with(bucket + 1, VecDeque::new);
        }
        self.open[bucket].push_back(node);
        true
    }

    /// The facts that a relaxed plan from a state makes true on its way; `None` if there is none.
    fn relaxed_plan(&mut self, state: &State) -> Option<Vec<FactId>> {
        if !self.relaxation_reaches_goal(state) {
            return None;
        }
        let mut aims = Vec::new();
        let mut seen = FxHashSet::default();
        let mut stack = self.relaxed.goal.clone();
        while let Some(proposition) = stack.pop() {
            let supporter = self.exploration.supporter(proposition);
            if supporter == NOBODY || supporter == AGENDA || !seen.insert(proposition) {
                continue;
            }
            stack.extend_from_slice(self.relaxed.preconditions_of(supporter));
            if proposition < self.relaxed.facts && aims.len() < AIMS {
                aims.push(FactId(proposition));
            }
        }
        Some(aims)
    }
}
