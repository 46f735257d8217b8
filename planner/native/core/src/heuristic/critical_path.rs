//! The critical path heuristic: the earliest time at which each goal alone could hold, if every
//! action waited only for its latest condition (h_max over time).
//!
//! Admissible for the makespan: start effects count from the start, end effects from the end, what
//! runs supplies its end effects when it ends. Source: Haslum and Geffner, "Heuristic planning with
//! time and resources", ECP 2001 (h^1).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::epoch::compiled::{Compiled, comparison_holds};
use crate::epoch::state::State;
use crate::task::{Change, OperatorId};

use super::relaxed::{Proposition, RelaxedTask};
use super::{Estimate, Heuristic};

/// Non-negative times ordered by their bits.
fn key(time: f64) -> u64 {
    time.max(0.0).to_bits()
}

/// Computes lower bounds of the makespan.
pub struct CriticalPath<'a> {
    compiled: &'a Compiled<'a>,
    relaxed: &'a RelaxedTask,
    time: Vec<f64>,
    open_preconditions: Vec<u32>,
    /// When the conditions at start and throughout of each action may hold.
    ready: Vec<f64>,
    queue: BinaryHeap<Reverse<(u64, Proposition)>>,
    /// By goal: when an action that supplies it may have ended.
    finished: Vec<f64>,
    is_goal: Vec<bool>,
    /// The bound of the first state that [`Heuristic::evaluate`] was asked about [s].
    whole: Option<f64>,
}

impl<'a> CriticalPath<'a> {
    /// For one task.
    #[must_use]
    pub fn new(compiled: &'a Compiled<'a>, relaxed: &'a RelaxedTask) -> Self {
        Self {
            compiled,
            relaxed,
            time: vec![f64::INFINITY; relaxed.propositions as usize],
            open_preconditions: Vec::new(),
            ready: vec![0.0; relaxed.actions.len()],
            queue: BinaryHeap::new(),
            finished: vec![f64::INFINITY; relaxed.propositions as usize],
            is_goal: {
                let mut is_goal = vec![false; relaxed.propositions as usize];
                for &goal in &relaxed.goal {
                    is_goal[goal as usize] = true;
                }
                is_goal
            },
            whole: None,
        }
    }

    fn reach(&mut self, proposition: Proposition, time: f64) {
        if time < self.time[proposition as usize] {
            self.time[proposition as usize] = time;
            self.queue.push(Reverse((key(time), proposition)));
        }
    }

    fn reach_lasting(&mut self, fact: crate::task::FactId, time: f64) {
        let relaxed = self.relaxed;
        for proposition in relaxed.lasting_of(fact) {
            self.reach(proposition, time);
        }
    }

    fn seed(&mut self, state: &State) {
        let relaxed = self.relaxed;
        for fact in 0..relaxed.facts {
            if state.holds(crate::task::FactId(fact)) {
                self.reach(fact, 0.0);
            }
        }
        for &(fact, proposition) in &relaxed.negations {
            if !state.holds(fact) {
                self.reach(proposition, 0.0);
            }
        }
        for &(fact, proposition) in &relaxed.lasting {
            if state.holds(fact) {
                self.reach(proposition, 0.0);
            }
        }
        for running in &state.running {
            for &proposition in &relaxed.end_adds[running.operator.index()] {
                self.reach(proposition, running.end - state.time);
            }
            for effect in &self.compiled.operator(running.operator).end.effects {
                if effect.condition.is_some()
                    && let Change::Add(fact) = effect.change
                {
                    self.reach(fact.0, running.end - state.time);
                    self.reach_lasting(fact, running.end - state.time);
                }
            }
        }
        for event in &self.compiled.task.timed[state.next_timed as usize..] {
            match &event.change {
                Change::Add(fact) => {
                    self.reach(fact.0, event.time - state.time);
                    self.reach_lasting(*fact, event.time - state.time);
                }
                Change::Delete(fact) => {
                    if let Ok(at) = relaxed.negations.binary_search_by_key(fact, |n| n.0) {
                        self.reach(relaxed.negations[at].1, event.time - state.time);
                    }
                }
                _ => {}
            }
        }
        // A comparison that does not hold may be made true by running operators and timed literals.
        let pending = !state.running.is_empty()
            || (state.next_timed as usize) < self.compiled.task.timed.len();
        for (index, comparison) in relaxed.comparisons.iter().enumerate() {
            let holds =
                comparison_holds(&comparison.condition, &state.values, f64::NAN, &mut |_| {
                    f64::NAN
                });
            if holds || pending || comparison.linear.is_none() {
                self.reach(relaxed.first_comparison + index as Proposition, 0.0);
            }
        }
    }

    /// The earliest time after a state at which every proposition of the goal may hold [s];
    /// infinite if some never can.
    pub fn remaining(&mut self, state: &State) -> f64 {
        let relaxed = self.relaxed;
        self.time.fill(f64::INFINITY);
        self.open_preconditions.clear();
        self.open_preconditions
            .extend(relaxed.actions.iter().map(|action| action.preconditions));
        self.ready.fill(0.0);
        self.queue.clear();
        self.seed(state);
        for &goal in &relaxed.goal {
            self.finished[goal as usize] = self.time[goal as usize];
        }
        for event in &self.compiled.task.timed[state.next_timed as usize..] {
            // What happens by itself does not lengthen a plan.
            if let Change::Add(fact) = event.change {
                self.finished[fact.index()] = 0.0;
            }
            if let Change::Delete(fact) = event.change
                && let Ok(at) = relaxed.negations.binary_search_by_key(&fact, |n| n.0)
            {
                self.finished[relaxed.negations[at].1 as usize] = 0.0;
            }
            if let Change::Assign(..) | Change::Call(_) = event.change {
                let first = relaxed.first_comparison as usize;
                self.finished[first..].fill(0.0);
            }
        }
        for &action in &relaxed.unconditional {
            self.fire(action, 0.0);
        }
        while let Some(Reverse((bits, proposition))) = self.queue.pop() {
            let time = f64::from_bits(bits);
            if time > self.time[proposition as usize] {
                continue;
            }
            for (action, late) in relaxed.timed_readers_of(proposition) {
                if !late {
                    self.ready[action as usize] = time;
                }
                let open = &mut self.open_preconditions[action as usize];
                *open -= 1;
                if *open == 0 {
                    self.fire(action, time);
                }
            }
        }
        let mut latest: f64 = (state.last_end() - state.time).max(0.0);
        for &goal in &relaxed.goal {
            latest = latest.max(self.finished[goal as usize]);
        }
        latest
    }

    /// All conditions of an action may hold at `time`, those at its end the last ones perhaps.
    fn fire(&mut self, index: u32, time: f64) {
        let relaxed = self.relaxed;
        let ready = self.ready[index as usize];
        let action = &relaxed.actions[index as usize];
        let ends = match self.compiled.operators.get(action.operator.index()) {
            Some(operator) => time.max(ready + operator.least_duration),
            None => time,
        };
        for proposition in relaxed.targets_of(index) {
            self.reach(proposition, time.max(ready + action.delay));
            if self.is_goal[proposition as usize] {
                let finished = &mut self.finished[proposition as usize];
                *finished = finished.min(ends);
            }
        }
    }

    /// The relaxed time of a proposition in the last evaluation [s].
    #[must_use]
    pub fn time_of(&self, proposition: Proposition) -> f64 {
        self.time[proposition as usize]
    }
}

/// Steps into which the time at the initial state is divided where the bound guides a search.
const STEPS: f64 = 1_000.0;

impl Heuristic for CriticalPath<'_> {
    /// The bound in thousandths of that of the first state it was asked about.
    fn evaluate(&mut self, state: &State) -> Estimate {
        let remaining = self.remaining(state);
        if remaining.is_infinite() {
            return Estimate::DeadEnd;
        }
        let whole = *self.whole.get_or_insert(remaining.max(f64::MIN_POSITIVE));
        Estimate::Value((remaining / whole * STEPS).ceil().min(1e9) as u32)
    }

    fn preferred(&self) -> &[OperatorId] {
        &[]
    }

    fn prefers_waiting(&self) -> bool {
        false
    }
}

/// A lower bound of the makespan of every plan [s]; infinite if there is none.
#[must_use]
pub fn makespan_bound(compiled: &Compiled<'_>, relaxed: &RelaxedTask) -> f64 {
    CriticalPath::new(compiled, relaxed).remaining(&State::initial(compiled))
}
