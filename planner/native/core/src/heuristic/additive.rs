//! Relaxed exploration by additive costs (h_add): what makes every proposition true most cheaply.
//!
//! Propositions are settled in the order of their costs, which are numbers of actions, until all
//! goals are: the work depends on how far the goal is, not on the size of the task. A precondition
//! that is settled looks at an action only if what the action adds could still become cheaper,
//! which it reads beside the action's number; most of them end there.
//!
//! Source: Bonet and Geffner, "Planning as heuristic search", Artificial Intelligence 129, 2001;
//! numeric conditions by repetition of the best achiever as in Scala et al., "Subgoaling
//! techniques for satisficing and optimal numeric planning", JAIR 68, 2020.

use crate::epoch::compiled::{Compiled, comparison_holds, evaluate};
use crate::epoch::state::State;
use crate::pddl::model::Assignment;

use super::relaxed::{MANY, Proposition, Reader, RelaxedTask};
use super::repetition::{repetitions, undecidable};

/// Cost of what has not been reached.
pub const UNREACHED: u32 = u32::MAX;
/// Supporter of what holds already.
pub const NOBODY: u32 = u32::MAX;
/// Supporter of what a running operator or a timed literal will supply.
pub const AGENDA: u32 = u32::MAX - 1;
/// Cap on costs, so that buckets stay few.
const MOST: u32 = 100_000;

/// What an action still waits for.
#[derive(Clone, Copy, Debug)]
struct Counter {
    open: u32,
    sum: u32,
}

/// Costs and supporters of propositions in one state after the other.
pub struct AdditiveExploration<'a> {
    compiled: &'a Compiled<'a>,
    relaxed: &'a RelaxedTask,
    cost: Vec<u32>,
    supporter: Vec<u32>,
    settled: Vec<bool>,
    preconditions: Vec<u32>,
    /// By change of a fluent: what the preconditions of the cheapest action that makes it cost.
    made: Vec<u32>,
    touched_changes: Vec<u32>,
    counters: Vec<Counter>,
    /// By lasting proposition: for how long its fact still holds, where that is known to end.
    remaining: Vec<f64>,
    closing: Vec<(Proposition, f64)>,
    touched_propositions: Vec<Proposition>,
    touched_actions: Vec<u32>,
    buckets: Vec<Vec<Proposition>>,
    predicted: Vec<f64>,
}

impl<'a> AdditiveExploration<'a> {
    /// For one task.
    #[must_use]
    pub fn new(compiled: &'a Compiled<'a>, relaxed: &'a RelaxedTask) -> Self {
        let propositions = relaxed.propositions as usize;
        let preconditions: Vec<u32> = relaxed.actions.iter().map(|a| a.preconditions).collect();
        Self {
            compiled,
            relaxed,
            cost: vec![UNREACHED; propositions],
            supporter: vec![NOBODY; propositions],
            settled: vec![false; propositions],
            made: vec![UNREACHED; relaxed.changes.len()],
            touched_changes: Vec::new(),
            counters: preconditions
                .iter()
                .map(|&open| Counter { open, sum: 0 })
                .collect(),
            preconditions,
            remaining: vec![f64::INFINITY; propositions],
            closing: Vec::new(),
            touched_propositions: Vec::new(),
            touched_actions: Vec::new(),
            buckets: Vec::new(),
            predicted: Vec::new(),
        }
    }

    /// The cost of a proposition [actions]; exact for settled ones only.
    #[inline]
    #[must_use]
    pub fn cost(&self, proposition: Proposition) -> u32 {
        self.cost[proposition as usize]
    }

    /// The action that makes a proposition true, [`NOBODY`] or [`AGENDA`].
    #[inline]
    #[must_use]
    pub fn supporter(&self, proposition: Proposition) -> u32 {
        self.supporter[proposition as usize]
    }

    /// What has been reached so far; just after [`Self::seed`], what holds or will by itself.
    #[must_use]
    pub fn reached(&self) -> &[Proposition] {
        &self.touched_propositions
    }

    /// What lasts now but will end, and after how long [s].
    #[must_use]
    pub fn closing(&self) -> &[(Proposition, f64)] {
        &self.closing
    }

    /// Forgets the last state and marks what holds, or will hold by itself, in a new one.
    pub fn seed(&mut self, state: &State) {
        self.reset();
        self.seed_propositions(state);
    }

    fn reset(&mut self) {
        for &proposition in &self.touched_propositions {
            self.cost[proposition as usize] = UNREACHED;
            self.settled[proposition as usize] = false;
            self.supporter[proposition as usize] = NOBODY;
        }
        self.touched_propositions.clear();
        for change in self.touched_changes.drain(..) {
            self.made[change as usize] = UNREACHED;
        }
        for &action in &self.touched_actions {
            self.counters[action as usize] = Counter {
                open: self.preconditions[action as usize],
                sum: 0,
            };
        }
        self.touched_actions.clear();
        for bucket in &mut self.buckets {
            bucket.clear();
        }
        for (proposition, _) in self.closing.drain(..) {
            self.remaining[proposition as usize] = f64::INFINITY;
        }
    }

    /// Facts that hold now last, unless the end of something running deletes them.
    fn seed_lasting(&mut self, state: &State) {
        let relaxed = self.relaxed;
        for &(fact, proposition) in &relaxed.lasting {
            if !state.holds(fact) {
                continue;
            }
            let closes = state
                .running
                .iter()
                .filter(|running| self.compiled.operator(running.operator).end_deletes(fact))
                .map(|running| running.end - state.time)
                .fold(f64::INFINITY, f64::min);
            if closes.is_infinite() {
                self.reach(proposition, 0, NOBODY);
            } else {
                self.remaining[proposition as usize] = closes;
                self.closing.push((proposition, closes));
            }
        }
    }

    /// Gives what closes later to the actions that are short enough.
    fn use_closing(&mut self, state: &State) {
        let relaxed = self.relaxed;
        for index in 0..self.closing.len() {
            let (proposition, remaining) = self.closing[index];
            for &Reader { action, .. } in relaxed.readers_of(proposition) {
                if relaxed.actions[action as usize].delay <= remaining {
                    self.support(action, 0, state);
                }
            }
        }
    }

    /// One more precondition of an action is supported.
    #[inline]
    fn support(&mut self, action: u32, cost: u32, state: &State) {
        let counter = &mut self.counters[action as usize];
        let open = self.preconditions[action as usize];
        if counter.open == open {
            self.touched_actions.push(action);
        }
        counter.open -= 1;
        counter.sum = counter.sum.saturating_add(cost);
        if counter.open == 0 {
            let sum = counter.sum;
            self.fire(action, sum, state);
        }
    }

    #[inline]
    fn reach(&mut self, proposition: Proposition, cost: u32, supporter: u32) {
        let old = self.cost[proposition as usize];
        if cost >= old {
            return;
        }
        if old == UNREACHED {
            self.touched_propositions.push(proposition);
        }
        self.cost[proposition as usize] = cost;
        self.supporter[proposition as usize] = supporter;
        let bucket = cost as usize;
        if bucket >= self.buckets.len() {
            self.buckets.resize_with(bucket + 1, Vec::new);
        }
        self.buckets[bucket].push(proposition);
    }

    fn seed_propositions(&mut self, state: &State) {
        for (word, &bits) in state.facts.iter().enumerate() {
            let mut bits = bits;
            while bits != 0 {
                let fact = word as u32 * 64 + bits.trailing_zeros();
                bits &= bits - 1;
                self.reach(fact, 0, NOBODY);
            }
        }
        let relaxed = self.relaxed;
        for &(fact, proposition) in &relaxed.negations {
            if !state.holds(fact) {
                self.reach(proposition, 0, NOBODY);
            }
        }
        for running in &state.running {
            for &proposition in &relaxed.end_adds[running.operator.index()] {
                self.reach(proposition, 0, AGENDA);
            }
        }
        for event in &self.compiled.task.timed[state.next_timed as usize..] {
            match &event.change {
                crate::task::Change::Add(fact) => {
                    self.reach(fact.0, 0, AGENDA);
                    for proposition in relaxed.lasting_of(*fact) {
                        self.reach(proposition, 0, AGENDA);
                    }
                }
                crate::task::Change::Delete(fact) => {
                    if let Ok(at) = relaxed.negations.binary_search_by_key(fact, |n| n.0) {
                        self.reach(relaxed.negations[at].1, 0, AGENDA);
                    }
                }
                _ => {}
            }
        }
        if !relaxed.lasting.is_empty() {
            self.seed_lasting(state);
        }
        if !relaxed.comparisons.is_empty() {
            self.seed_comparisons(state);
        }
    }

    fn seed_comparisons(&mut self, state: &State) {
        self.predicted.clear();
        self.predicted.extend_from_slice(&state.values);
        let mut pending = false;
        let mut apply = |change: &crate::task::Change, duration: f64, values: &mut Vec<f64>| {
            if let crate::task::Change::Assign(assignment, fluent, value) = change {
                pending = true;
                let value = evaluate(value, values, duration, 0.0, &mut |_| f64::NAN);
                let slot = &mut values[fluent.index()];
                match assignment {
                    Assignment::Assign => *slot = value,
                    Assignment::Increase => *slot += value,
                    Assignment::Decrease => *slot -= value,
                    Assignment::ScaleUp => *slot *= value,
                    Assignment::ScaleDown => *slot /= value,
                }
            } else if let crate::task::Change::Call(_) = change {
                pending = true;
            }
        };
        for running in &state.running {
            let operator = self.compiled.operator(running.operator);
            for effect in &operator.end.effects {
                apply(
                    &effect.change,
                    running.end - running.start,
                    &mut self.predicted,
                );
            }
        }
        for event in &self.compiled.task.timed[state.next_timed as usize..] {
            apply(&event.change, 0.0, &mut self.predicted);
        }
        let relaxed = self.relaxed;
        for (index, comparison) in relaxed.comparisons.iter().enumerate() {
            let proposition = relaxed.first_comparison + index as Proposition;
            let now = comparison_holds(&comparison.condition, &state.values, f64::NAN, &mut |_| {
                f64::NAN
            });
            if now || undecidable(comparison) {
                self.reach(proposition, 0, NOBODY);
            } else if pending
                && comparison_holds(
                    &comparison.condition,
                    &self.predicted,
                    f64::NAN,
                    &mut |_| f64::NAN,
                )
            {
                self.reach(proposition, 0, AGENDA);
            }
        }
    }

    /// Explores until the costs of all goals are certain; false if some goal cannot be reached.
    pub fn explore(&mut self, state: &State) -> bool {
        let relaxed = self.relaxed;
        if relaxed.goal.is_empty() {
            return true;
        }
        for &action in &relaxed.unconditional {
            self.fire(action, 0, state);
        }
        self.use_closing(state);
        let mut bucket = 0;
        while bucket < self.buckets.len() {
            if self.buckets[bucket].is_empty() {
                bucket += 1;
                continue;
            }
            // Nothing in this bucket or a later one makes a goal cheaper than this.
            let limit = bucket as u32;
            if relaxed.goal.iter().all(|&goal| self.cost(goal) <= limit) {
                return true;
            }
            while let Some(proposition) = self.buckets[bucket].pop() {
                let slot = proposition as usize;
                if self.settled[slot] || self.cost[slot] != limit {
                    continue;
                }
                self.settled[slot] = true;
                self.serve_readers(proposition, limit, state);
            }
            bucket += 1;
        }
        relaxed
            .goal
            .iter()
            .all(|&goal| self.cost(goal) != UNREACHED)
    }

    /// Tells the actions that a proposition is a precondition of what it costs.
    #[inline]
    fn serve_readers(&mut self, proposition: Proposition, cost: u32, state: &State) {
        let relaxed = self.relaxed;
        let closing = self.remaining[proposition as usize];
        if closing.is_infinite() {
            for reader in relaxed.readers_of(proposition) {
                // The action costs at least one more than this precondition.
                if reader.only_add == MANY || self.cost[reader.only_add as usize] > cost + 1 {
                    self.support(reader.action, cost, state);
                }
            }
            return;
        }
        for reader in relaxed.readers_of(proposition) {
            // What was short enough for a closing window has been served.
            if relaxed.actions[reader.action as usize].delay > closing {
                self.support(reader.action, cost, state);
            }
        }
    }

    #[inline]
    fn fire(&mut self, index: u32, sum: u32, state: &State) {
        let relaxed = self.relaxed;
        let action = &relaxed.actions[index as usize];
        let own = u32::from(!action.is_axiom());
        let cost = sum.min(MOST) + own;
        for &proposition in relaxed.adds_of(index) {
            self.reach(proposition, cost, index);
        }
        for &change in &action.changes {
            // Another action has made this change as cheaply.
            let made = &mut self.made[change as usize];
            if *made <= sum {
                continue;
            }
            if *made == UNREACHED {
                self.touched_changes.push(change);
            }
            *made = sum;
            let (from, to) = relaxed.changes[change as usize];
            for support in &relaxed.supports[from as usize..to as usize] {
                let proposition = relaxed.first_comparison + support.comparison;
                if self.cost[proposition as usize] == 0 {
                    continue;
                }
                if let Some(repetitions) = repetitions(relaxed, support, state) {
                    self.reach(proposition, (sum + own * repetitions).min(MOST), index);
                }
            }
        }
    }
}
