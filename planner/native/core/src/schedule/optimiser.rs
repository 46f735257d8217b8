//! The anytime optimiser: multi-start construction, then local search over list neighbourhoods in
//! cycles of growing length.

use std::sync::atomic::Ordering;
use std::time::Instant;

use crate::schedule::construction::Manner;
use crate::schedule::cycle::Cycle;
use crate::schedule::limits::Limits;
use crate::schedule::links::{Element, Links, Role};
use crate::schedule::local_search::Current;
use crate::schedule::model::NONE;
use crate::schedule::promptness::Promptness;
use crate::schedule::repair::{Item, Tail};
use crate::schedule::solution::{Schedule, ScheduledOperator};
use crate::schedule::state::Dispatch;
use crate::schedule::workshop::Workshop;
use crate::task::{OperatorId, Task};

/// Iterations of the first cycle; each later one is longer.
const FIRST_CYCLE: u64 = 1_500;
/// A cycle from somewhere else is worth repeating soon if it ends within this part above the best.
const COMPETITIVE: f64 = 0.05;

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The best plan is as good as the lower bound.
    Optimal,
    /// A limit was reached.
    Limit,
    /// The relaxation has no plan.
    Unsolvable,
}

/// Searches the list schedules of one task; deterministic for task, seed and node limit.
#[derive(Clone, Debug)]
pub struct Optimiser<'t> {
    pub(super) task: &'t Task,
    pub(super) workshop: Workshop,
    pub(super) links: Links,
    bound: f64,
    pub(super) persistent: Vec<u32>,
    pub(super) best: Option<Schedule>,
    best_list: Vec<Element>,
    /// Lists tried.
    pub(super) nodes: u64,
    /// Cycles so far, and the length of the next one in lists.
    cycles: u32,
    cycle_length: u64,
    /// Lists tried in cycles, and how long that took [s]: constructing a list takes much longer.
    changed: u64,
    changing_s: f64,
    /// Whether the last cycle from somewhere else came near the best plan.
    competitive: bool,
}

impl<'t> Optimiser<'t> {
    /// Compiles a task; `None` if it needs the other search space (attachments that depend on the
    /// state, derived facts).
    #[must_use]
    pub fn new(task: &'t Task, seed: u64, promptness: Option<Promptness>) -> Option<Self> {
        let workshop = Workshop::new(task, seed, promptness)?;
        let bound = if workshop.model.excluded_any {
            0.0
        } else {
            workshop.reach.iter().copied().fold(0.0, f64::max)
        };
        let persistent = (0..task.facts.len() as u32)
            .filter(|fact| {
                !workshop.model.deletable[*fact as usize]
                    && !workshop.model.initial_facts[*fact as usize]
                    && !workshop.propositions.needing.row(*fact).is_empty()
                    && !workshop.propositions.adding.row(*fact).is_empty()
            })
            .collect();
        Some(Self {
            task,
            workshop,
            links: Links::default(),
            bound,
            persistent,
            best: None,
            best_list: Vec::new(),
            nodes: 0,
            cycles: 0,
            cycle_length: FIRST_CYCLE,
            changed: 0,
            changing_s: 0.0,
            competitive: false,
        })
    }

    /// No plan has a smaller makespan [s]; infinite if the relaxation has no plan.
    #[must_use]
    pub fn lower_bound(&self) -> f64 {
        self.bound
    }

    /// The best plan so far.
    #[must_use]
    pub fn best(&self) -> Option<&Schedule> {
        self.best.as_ref()
    }

    /// Lists tried so far.
    #[must_use]
    pub fn nodes(&self) -> u64 {
        self.nodes
    }

    /// Searches until a limit is reached or the best plan is proved optimal. `incumbent` is the
    /// order of an earlier plan: what still applies of it is kept. Each better plan is reported.
    pub fn run(
        &mut self,
        incumbent: Option<&[OperatorId]>,
        limits: &Limits<'_>,
        on_plan: &mut dyn FnMut(&Schedule),
    ) -> Ending {
        if self.bound.is_infinite() {
            return Ending::Unsolvable;
        }
        let nodes_before = self.nodes;
        let begun = Instant::now();
        let done = |nodes: u64| {
            limits.reached()
                || limits
                    .nodes
                    .is_some_and(|limit| nodes - nodes_before >= limit)
        };
        if let Some(operators) = incumbent {
            self.adopt(operators, limits, on_plan);
        }
        let starts = self.begin(limits, nodes_before, on_plan);
        if !starts {
            return if self.proved() {
                Ending::Optimal
            } else {
                Ending::Limit
            };
        }
        while !done(self.nodes) && !self.proved() {
            let remaining = match limits.nodes {
                Some(limit) => limit - (self.nodes - nodes_before),
                None => self.affordable(limits, begun, nodes_before),
            };
            // A short remainder joins the last cycle: a cycle that is cut off ends hot.
            let cycle = if remaining >= 2 * self.cycle_length {
                Cycle::of(self.cycle_length)
            } else {
                match limits.deadline {
                    Some(deadline) if limits.nodes.is_none() => Cycle::until(deadline, remaining),
                    _ => Cycle::of(remaining),
                }
            };
            let (nodes, at) = (self.nodes, Instant::now());
            self.improve(cycle, limits, on_plan);
            self.changed += self.nodes - nodes;
            self.changing_s += at.elapsed().as_secs_f64();
            self.cycles += 1;
            self.cycle_length += self.cycle_length / 2;
        }
        if self.proved() {
            Ending::Optimal
        } else {
            Ending::Limit
        }
    }

    /// How many lists can be tried until the deadline, judged by the rate of the cycles so far, or of this
    /// run if there are none.
    fn affordable(&self, limits: &Limits<'_>, begun: Instant, nodes_before: u64) -> u64 {
        let Some(deadline) = limits.deadline else {
            return u64::MAX;
        };
        let left_s = deadline
            .saturating_duration_since(Instant::now())
            .as_secs_f64();
        let (lists, spent_s) = if self.changed > 0 {
            (self.changed, self.changing_s)
        } else {
            (self.nodes - nodes_before, begun.elapsed().as_secs_f64())
        };
        let rate = lists as f64 / spent_s.max(1e-6);
        ((left_s * rate) as u64).max(50)
    }

    pub(super) fn proved(&self) -> bool {
        self.workshop.objective.is_makespan()
            && self
                .best
                .as_ref()
                .is_some_and(|best| best.makespan <= self.bound + 1e-6)
    }

    /// Repairs an earlier plan, given by the order of its operators: what still applies is kept.
    pub fn adopt(
        &mut self,
        operators: &[OperatorId],
        limits: &Limits<'_>,
        on_plan: &mut dyn FnMut(&Schedule),
    ) {
        let list: Vec<u32> = operators.iter().map(|operator| operator.0).collect();
        let elements = self.links.elements(
            &self.workshop.model,
            &self.workshop.propositions,
            &list,
            true,
        );
        let useful = |element: &&Element| element.role != Role::Useless || element.primary != NONE;
        let items: Vec<Item> = elements
            .iter()
            .filter(useful)
            .map(|element| Item::Keep(element, Tail::default()))
            .collect();
        let labelling = self.workshop.labelling();
        let stop = || limits.reached();
        self.nodes += 1;
        if self
            .workshop
            .repair(&items, labelling, f64::INFINITY, &stop)
        {
            let elements = self.workshop.prune(&mut self.links);
            self.offer(&elements, on_plan);
        }
    }

    /// Constructs plans until there is one to start from, and some more.
    fn begin(
        &mut self,
        limits: &Limits<'_>,
        nodes_before: u64,
        on_plan: &mut dyn FnMut(&Schedule),
    ) -> bool {
        let stop = || limits.reached();
        let mut found = 0;
        let wanted = if self.best.is_some() { 4 } else { 12 };
        while found < wanted {
            let spent = self.nodes - nodes_before;
            if stop() || limits.nodes.is_some_and(|limit| spent >= limit) || self.proved() {
                break;
            }
            self.nodes += 1;
            let bound = self.threshold();
            let manner = match self.nodes {
                1 => Manner::Thorough,
                2 if self.best.is_none() => Manner::Hasty,
                _ => Manner::Any,
            };
            let patient = || match limits.patience {
                Some(patience) if manner != Manner::Any => {
                    limits.cancel.load(Ordering::Relaxed) || Instant::now() >= patience
                }
                _ => stop(),
            };
            if self.workshop.construct(manner, bound, &patient) {
                let elements = self.workshop.prune(&mut self.links);
                self.offer(&elements, on_plan);
            }
            found += u32::from(self.best.is_some());
        }
        self.best.is_some() && !self.proved()
    }

    /// Schedules that end later than this cannot be better than the best.
    fn threshold(&self) -> f64 {
        match &self.best {
            Some(best) if self.workshop.objective.is_time() => best.cost,
            _ => f64::INFINITY,
        }
    }

    /// Takes the schedule under construction if it is better than the best.
    pub(super) fn offer(&mut self, elements: &[Element], on_plan: &mut dyn FnMut(&Schedule)) {
        let cost = self.workshop.objective.primary(&self.workshop.state);
        let makespan = self.workshop.state.makespan;
        let better = self.best.as_ref().is_none_or(|best| {
            cost < best.cost - 1e-9 || (cost <= best.cost + 1e-9 && makespan < best.makespan - 1e-9)
        });
        if !better || cost.is_nan() || !self.workshop.goal_holds() {
            return;
        }
        let mut operators: Vec<ScheduledOperator> = self
            .workshop
            .state
            .list
            .iter()
            .map(|dispatch| self.scheduled(*dispatch))
            .collect();
        operators.sort_by(|left, right| left.start.total_cmp(&right.start));
        let schedule = Schedule {
            operators,
            makespan,
            cost,
        };
        on_plan(&schedule);
        self.best = Some(schedule);
        self.best_list = elements.to_vec();
    }

    fn scheduled(&self, dispatch: Dispatch) -> ScheduledOperator {
        let shape = &self.workshop.model.shapes[dispatch.operator as usize];
        ScheduledOperator {
            operator: OperatorId(dispatch.operator),
            start: dispatch.start,
            duration: (!shape.instantaneous).then_some(dispatch.duration),
        }
    }

    /// What a list is worth; what the best schedule costs if it has to be mended first.
    fn value_of(&mut self, elements: &[Element]) -> f64 {
        let operators = elements.iter().map(|element| element.operator);
        if self.workshop.replay(operators) && self.workshop.goal_holds() {
            return self.workshop.value();
        }
        let best = self.best.as_ref();
        best.map_or(f64::INFINITY, |best| best.cost)
    }

    /// One cycle: from the best list or from a new one.
    fn improve(&mut self, cycle: Cycle, limits: &Limits<'_>, on_plan: &mut dyn FnMut(&Schedule)) {
        let elements = self.best_list.clone();
        let value = self.value_of(&elements);
        let mut current = Current { elements, value };
        let elsewhere = self.cycles % 3 == 2 || self.cycles % 3 == 1 && self.competitive;
        if elsewhere {
            self.nodes += 1;
            let stop = || limits.reached();
            if self.workshop.construct(Manner::Any, f64::INFINITY, &stop) {
                current.elements = self.workshop.prune(&mut self.links);
                current.value = self.workshop.value();
            }
        }
        let value = self.search_from(current, cycle, limits, on_plan);
        if elsewhere && !limits.reached() {
            let best = self.value_of(&self.best_list.clone());
            self.competitive = value <= best + COMPETITIVE * best.abs();
        }
    }
}

/// Statistics of a search, for measurements.
impl Optimiser<'_> {
    /// Propositions achieved by exploration and labels settled.
    #[must_use]
    pub fn exploration_counts(&self) -> (u64, u64) {
        (self.workshop.achieved, self.workshop.exploration.settled)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;
    use std::time::{Duration, Instant};

    use super::Optimiser;
    use crate::schedule::limits::Limits;
    use crate::schedule::testing::{FACTORY, task};

    #[test]
    fn what_can_be_tried_is_judged_by_cycles_not_by_new_lists() {
        let task = task(FACTORY);
        let mut optimiser = Optimiser::new(&task, 0, None).expect("supported");
        let cancel = AtomicBool::new(false);
        let now = Instant::now();
        let limits = Limits {
            deadline: Some(now + Duration::from_secs(1000)),
            patience: None,
            cancel: &cancel,
            nodes: None,
        };
        let begun = now - Duration::from_secs(1);
        optimiser.nodes = 4;
        let by_new_lists = optimiser.affordable(&limits, begun, 0);
        assert!((1_000..=4_000).contains(&by_new_lists));
        (optimiser.changed, optimiser.changing_s) = (1_000, 1.0);
        let by_cycles = optimiser.affordable(&limits, begun, 0);
        assert!((500_000..=1_000_000).contains(&by_cycles));
    }
}
