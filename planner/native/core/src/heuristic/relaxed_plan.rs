//! The FF heuristic on the temporal delete relaxation, supporters chosen by h_add.
//!
//! Source: Hoffmann and Nebel, "The FF planning system", JAIR 14, 2001; supporters as in Keyder and
//! Geffner, "Heuristics for planning with action costs revisited", ECAI 2008; numeric conditions
//! by repetition of the best achiever as in Scala et al., "Subgoaling techniques for satisficing
//! and optimal numeric planning", JAIR 68, 2020. Not admissible. Exploration goes in the order of
//! h_add values and stops when all goals have theirs, so its cost depends on how far the goal is,
//! not on the size of the task.

use crate::epoch::compiled::{Compiled, comparison_holds, evaluate};
use crate::epoch::state::State;
use crate::pddl::model::{Assignment, Comparison};
use crate::task::OperatorId;

use super::relaxed::{NumericSupport, Proposition, RelaxedTask};
use super::{Estimate, Heuristic};

const UNREACHED: u32 = u32::MAX;
const NOBODY: u32 = u32::MAX;
/// Supporter of what a running operator or a timed literal will supply.
const AGENDA: u32 = u32::MAX - 1;

/// FF with preferred operators.
pub struct RelaxedPlan<'a> {
    compiled: &'a Compiled<'a>,
    relaxed: &'a RelaxedTask,
    cost: Vec<u32>,
    supporter: Vec<u32>,
    settled: Vec<bool>,
    is_goal: Vec<bool>,
    open_preconditions: Vec<u32>,
    sum: Vec<u32>,
    /// By lasting proposition: for how long its fact still holds, where that is known to end.
    remaining: Vec<f64>,
    closing: Vec<Proposition>,
    touched_propositions: Vec<Proposition>,
    touched_actions: Vec<u32>,
    buckets: Vec<Vec<Proposition>>,
    predicted: Vec<f64>,
    in_plan: Vec<u32>,
    stamp: u32,
    stack: Vec<Proposition>,
    seen: Vec<u32>,
    preferred: Vec<OperatorId>,
    waiting: bool,
}

impl<'a> RelaxedPlan<'a> {
    /// For one task.
    #[must_use]
    pub fn new(compiled: &'a Compiled<'a>, relaxed: &'a RelaxedTask) -> Self {
        let propositions = relaxed.propositions as usize;
        let actions = relaxed.actions.len();
        let mut is_goal = vec![false; propositions];
        for &goal in &relaxed.goal {
            is_goal[goal as usize] = true;
        }
        Self {
            compiled,
            relaxed,
            cost: vec![UNREACHED; propositions],
            supporter: vec![NOBODY; propositions],
            settled: vec![false; propositions],
            is_goal,
            open_preconditions: relaxed.actions.iter().map(|a| a.preconditions).collect(),
            sum: vec![0; actions],
            remaining: vec![f64::INFINITY; propositions],
            closing: Vec::new(),
            touched_propositions: Vec::new(),
            touched_actions: Vec::new(),
            buckets: Vec::new(),
            predicted: Vec::new(),
            in_plan: vec![0; compiled.operators.len()],
            stamp: 0,
            stack: Vec::new(),
            seen: vec![0; propositions],
            preferred: Vec::new(),
            waiting: false,
        }
    }

    fn reset(&mut self) {
        for &proposition in &self.touched_propositions {
            self.cost[proposition as usize] = UNREACHED;
            self.settled[proposition as usize] = false;
            self.supporter[proposition as usize] = NOBODY;
        }
        self.touched_propositions.clear();
        for &action in &self.touched_actions {
            self.open_preconditions[action as usize] =
                self.relaxed.actions[action as usize].preconditions;
            self.sum[action as usize] = 0;
        }
        self.touched_actions.clear();
        for bucket in &mut self.buckets {
            bucket.clear();
        }
        self.preferred.clear();
        self.waiting = false;
        for proposition in self.closing.drain(..) {
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
                self.closing.push(proposition);
            }
        }
    }

    /// Gives what closes later to the actions that are short enough.
    fn use_closing(&mut self, state: &State) {
        let relaxed = self.relaxed;
        for index in 0..self.closing.len() {
            let proposition = self.closing[index];
            let remaining = self.remaining[proposition as usize];
            for &action in relaxed.readers_of(proposition) {
                if relaxed.actions[action as usize].delay <= remaining {
                    self.support(action, 0, state);
                }
            }
        }
    }

    /// One more precondition of an action is supported.
    #[inline]
    fn support(&mut self, action: u32, cost: u32, state: &State) {
        let index = action as usize;
        if self.sum[index] == 0
            && self.open_preconditions[index] == self.relaxed.actions[index].preconditions
        {
            self.touched_actions.push(action);
        }
        self.open_preconditions[index] -= 1;
        self.sum[index] = self.sum[index].saturating_add(cost);
        if self.open_preconditions[index] == 0 {
            self.fire(action, self.sum[index], state);
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

    fn seed(&mut self, state: &State) {
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

    /// Explores until every goal is settled; false if some goal cannot be reached.
    fn explore(&mut self, state: &State) -> bool {
        let relaxed = self.relaxed;
        let mut missing = relaxed.goal.len();
        if missing == 0 {
            return true;
        }
        for &action in &relaxed.unconditional {
            self.fire(action, 0, state);
        }
        self.use_closing(state);
        let mut bucket = 0;
        while bucket < self.buckets.len() {
            let Some(proposition) = self.buckets[bucket].pop() else {
                bucket += 1;
                continue;
            };
            let slot = proposition as usize;
            if self.settled[slot] || self.cost[slot] != bucket as u32 {
                continue;
            }
            self.settled[slot] = true;
            if self.is_goal[slot] {
                missing -= 1;
                if missing == 0 {
                    return true;
                }
            }
            let closing = self.remaining[slot];
            for &action in relaxed.readers_of(proposition) {
                // What was short enough for a closing window has been served.
                if closing.is_infinite() || relaxed.actions[action as usize].delay > closing {
                    self.support(action, bucket as u32, state);
                }
            }
        }
        false
    }

    #[inline]
    fn fire(&mut self, index: u32, sum: u32, state: &State) {
        let relaxed = self.relaxed;
        let action = &relaxed.actions[index as usize];
        let own = u32::from(action.operator.0 != u32::MAX);
        let cost = sum.min(MOST) + own;
        for &proposition in &action.adds {
            self.reach(proposition, cost, index);
        }
        for support in &action.numeric {
            let proposition = relaxed.first_comparison + support.comparison;
            if self.cost[proposition as usize] == 0 {
                continue;
            }
            if let Some(repetitions) = self.repetitions(support, state) {
                self.reach(proposition, (sum + own * repetitions).min(MOST), index);
            }
        }
    }

    /// How often an action has to be repeated to make a comparison true by itself.
    fn repetitions(&self, support: &NumericSupport, state: &State) -> Option<u32> {
        let comparison = &self.relaxed.comparisons[support.comparison as usize];
        let (Some(assignment), Some(value)) = (support.assignment, &support.value) else {
            return Some(1);
        };
        if support.coefficient.is_nan() {
            return Some(1);
        }
        let none = &mut |_| f64::NAN;
        let value = evaluate(value, &state.values, f64::NAN, 0.0, none);
        let left = evaluate(
            &comparison.condition.left,
            &state.values,
            f64::NAN,
            0.0,
            none,
        );
        let right = evaluate(
            &comparison.condition.right,
            &state.values,
            f64::NAN,
            0.0,
            none,
        );
        let gap = left - right;
        let delta = match assignment {
            Assignment::Increase => support.coefficient * value,
            Assignment::Decrease => -support.coefficient * value,
            Assignment::Assign | Assignment::ScaleUp | Assignment::ScaleDown => return Some(1),
        };
        if delta.is_nan() || gap.is_nan() {
            return Some(1);
        }
        let rises = match comparison.condition.comparison {
            Comparison::Greater | Comparison::GreaterEqual => true,
            Comparison::Less | Comparison::LessEqual => false,
            Comparison::Equal => gap < 0.0,
        };
        if delta == 0.0 || (delta > 0.0) != rises {
            // Another effect on the way may make it useful; a last resort keeps dead ends honest.
            return (comparison.condition.comparison == Comparison::Equal && delta != 0.0)
                .then_some(1_000);
        }
        Some((gap.abs() / delta.abs()).ceil().clamp(1.0, 1e6) as u32)
    }

    /// Walks back from the goal and returns the number of actions used.
    fn extract(&mut self, state: &State) -> u32 {
        self.stamp += 1;
        let relaxed = self.relaxed;
        let mut total = 0_u32;
        self.stack.clear();
        self.stack.extend_from_slice(&relaxed.goal);
        while let Some(proposition) = self.stack.pop() {
            let slot = proposition as usize;
            if self.seen[slot] == self.stamp {
                continue;
            }
            self.seen[slot] = self.stamp;
            let index = self.supporter[slot];
            if index == AGENDA {
                self.waiting = true;
                continue;
            }
            if index == NOBODY {
                continue;
            }
            let action = &relaxed.actions[index as usize];
            self.stack
                .extend_from_slice(relaxed.preconditions_of(index));
            if action.operator.0 == u32::MAX {
                continue;
            }
            let slot = action.operator.index();
            let mut repetitions = 1;
            if proposition >= relaxed.first_comparison {
                let comparison = proposition - relaxed.first_comparison;
                let supports = action.numeric.iter().filter(|s| s.comparison == comparison);
                repetitions = supports
                    .filter_map(|support| self.repetitions(support, state))
                    .min()
                    .unwrap_or(1);
            }
            if self.in_plan[slot] == self.stamp {
                total = total.saturating_add(repetitions - 1);
                continue;
            }
            self.in_plan[slot] = self.stamp;
            total = total.saturating_add(repetitions);
            let operator = self.compiled.operator(action.operator);
            if operator.start_condition.literals_hold(&state.facts) {
                self.preferred.push(action.operator);
            }
        }
        total
    }
}

/// Cap on costs, so that buckets stay few.
const MOST: u32 = 100_000;

fn undecidable(comparison: &super::relaxed::RelaxedComparison) -> bool {
    // Attachments and `?duration` are known only when the action starts.
    use crate::task::GroundExpression as E;
    fn inside(expression: &E) -> bool {
        match expression {
            E::Duration | E::Call(_) => true,
            E::Binary(_, left, right) => inside(left) || inside(right),
            _ => false,
        }
    }
    inside(&comparison.condition.left) || inside(&comparison.condition.right)
}

impl Heuristic for RelaxedPlan<'_> {
    fn evaluate(&mut self, state: &State) -> Estimate {
        self.reset();
        self.seed(state);
        if !self.explore(state) {
            return Estimate::DeadEnd;
        }
        Estimate::Value(self.extract(state))
    }

    fn preferred(&self) -> &[OperatorId] {
        &self.preferred
    }

    fn prefers_waiting(&self) -> bool {
        self.waiting || self.preferred.is_empty()
    }
}
