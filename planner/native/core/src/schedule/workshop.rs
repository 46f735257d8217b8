//! What all schemes work with: the compiled task, one schedule under construction, the memory of
//! the exploration; and the step they share: achieving one proposition.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::schedule::exploration::Exploration;
use crate::schedule::lower_bound::goal_bounds;
use crate::schedule::model::{Model, NONE};
use crate::schedule::objective::Objective;
use crate::schedule::promptness::Promptness;
use crate::schedule::propositions::Propositions;
use crate::schedule::question::{Labelling, Question, Restriction};
use crate::schedule::state::{Dispatch, State};
use crate::task::Task;

/// How often a relaxed plan may be computed anew to achieve one proposition.
const ATTEMPTS: u32 = 24;

/// How greedily labels are looked at.
const GREED: [f32; 4] = [1.0, 1.0, 1.5, 3.0];

/// Tables, schedule under construction and memory.
#[derive(Clone, Debug)]
pub struct Workshop {
    pub model: Model,
    pub propositions: Propositions,
    pub objective: Objective,
    pub state: State,
    pub exploration: Exploration,
    pub random: ChaCha8Rng,
    plans: Vec<Vec<(u32, u32)>>,
    /// Envelopes that start when something has to happen inside.
    pub(super) waiting: Vec<u32>,
    /// Whether there are envelopes at all.
    envelopes: bool,
    /// Longest list that is tried.
    pub longest: usize,
    /// How often each goal could not be achieved where it stood.
    pub urgency: Vec<f64>,
    /// Lower bound on the time at which each goal can hold [s].
    pub reach: Vec<f64>,
    /// Propositions achieved by exploration since creation.
    pub achieved: u64,
    /// Whether a list was given up because something would have ended too late.
    pub late: bool,
}

impl Workshop {
    /// Compiles a task; `None` if the list-schedule space cannot express it.
    pub fn new(task: &Task, seed: u64, promptness: Option<Promptness>) -> Option<Self> {
        let model = Model::new(task)?;
        let state = State::new(&model, task);
        let objective = Objective::new(task, promptness)?;
        let costs = objective.operator_costs(&model, &state);
        let propositions = Propositions::new(&model, &state, &costs);
        let exploration = Exploration::new(&propositions, objective.is_time());
        Some(Self {
            longest: 2_000 + 20 * model.goal.len(),
            objective,
            exploration,
            random: ChaCha8Rng::seed_from_u64(seed),
            plans: Vec::new(),
            waiting: Vec::new(),
            envelopes: model.shapes.iter().any(|shape| shape.envelope),
            urgency: vec![0.0; propositions.goal.len()],
            reach: goal_bounds(&model, &propositions, &state),
            achieved: 0,
            late: false,
            model,
            propositions,
            state,
        })
    }

    /// Random labels: mostly earliest times, sometimes with weight on additive cost.
    pub fn labelling(&mut self) -> Labelling {
        let effort = if self.objective.is_time() {
            [0.0, 0.0, 0.05, 0.2, 1.0][self.random.random_range(0..5)]
        } else {
            [0.1, 1.0, 10.0][self.random.random_range(0..3)]
        };
        Labelling {
            effort,
            noise: [0.0, 0.1, 0.5][self.random.random_range(0..3)],
            salt: self.random.random(),
            far_first: false,
            without: NONE,
            protect: self.random.random_bool(0.7),
            windows: true,
            greed: GREED[self.random.random_range(0..GREED.len())],
        }
    }

    /// Whether a proposition holds behind the list.
    pub fn holds(&self, proposition: u32) -> bool {
        self.propositions.holds(&self.state, proposition)
    }

    /// Whether a proposition holds or an operator may still read that it did.
    fn readable(&self, proposition: u32) -> bool {
        let literal = self.propositions.literal(proposition);
        let past = |(fact, value): (u32, bool)| {
            value
                && self.model.window_of[fact as usize] != NONE
                && self.state.available(&self.model, fact, true).is_finite()
        };
        self.holds(proposition) || literal.is_some_and(past)
    }

    /// Whether all goals hold.
    pub fn goal_holds(&self) -> bool {
        self.propositions.goal.iter().all(|goal| self.holds(*goal))
    }

    /// The applicable operator that achieves a proposition first; one that also adds all that
    /// `like` adds (and so moves the same objects) if there is any and `faithful` is set.
    pub fn substitute(&self, proposition: u32, like: u32, faithful: bool) -> Option<Dispatch> {
        let wanted = match self.propositions.rule_of[like as usize] {
            NONE => &[],
            rule => self
                .propositions
                .adds(&self.propositions.rules[rule as usize]),
        };
        let mut best: Option<(usize, Dispatch)> = None;
        for rule in self.propositions.adding.row(proposition) {
            let rule = &self.propositions.rules[*rule as usize];
            if rule.operator == NONE {
                continue;
            }
            let applicable = self
                .propositions
                .needs(rule)
                .iter()
                .all(|need| self.readable(need.proposition));
            if !applicable {
                continue;
            }
            let Some(dispatch) = self.state.earliest(&self.model, rule.operator) else {
                continue;
            };
            let missing = if faithful {
                let adds = self.propositions.adds(rule);
                let lacks = |term: &&crate::schedule::propositions::Term| {
                    !adds.iter().any(|add| add.proposition == term.proposition)
                };
                wanted.iter().filter(lacks).count().min(1)
            } else {
                0
            };
            let better = best
                .as_ref()
                .is_none_or(|(worse, other)| (missing, dispatch.end()) < (*worse, other.end()));
            if better {
                best = Some((missing, dispatch));
            }
        }
        best.map(|(_, dispatch)| dispatch)
    }

    /// The label of a proposition behind the list, infinite if the relaxation does not reach it.
    pub fn label(&mut self, target: u32, labelling: Labelling, stop: &dyn Fn() -> bool) -> f32 {
        let mut plan = self.plans.pop().unwrap_or_default();
        let label = self.exploration.relaxed_plan(
            Question {
                model: &self.model,
                propositions: &self.propositions,
                state: &self.state,
                target,
                labelling,
                restriction: Restriction::None,
                latest: f32::INFINITY,
                stop,
            },
            &mut plan,
        );
        self.plans.push(plan);
        label
    }

    /// Appends operators until a proposition holds: executes relaxed plans as far as they are
    /// executable. What was appended stays if it fails, be it that one of them would end at the bound
    /// or after it ([`Self::late`]).
    pub fn achieve(
        &mut self,
        target: u32,
        labelling: Labelling,
        restriction: Restriction,
        bound: f64,
        stop: &dyn Fn() -> bool,
    ) -> bool {
        let mut plan = self.plans.pop().unwrap_or_default();
        let reached = self.execute(target, labelling, restriction, bound, stop, &mut plan);
        self.plans.push(plan);
        reached
    }

    fn execute(
        &mut self,
        target: u32,
        mut labelling: Labelling,
        mut restriction: Restriction,
        bound: f64,
        stop: &dyn Fn() -> bool,
        plan: &mut Vec<(u32, u32)>,
    ) -> bool {
        self.achieved += 1;
        for attempt in 0..ATTEMPTS {
            if attempt > 0 && stop() {
                return false;
            }
            if self.holds(target) || self.awaited(target) {
                return true;
            }
            if self.state.list.len() > self.longest {
                return false;
            }
            let label = self.exploration.relaxed_plan(
                Question {
                    model: &self.model,
                    propositions: &self.propositions,
                    state: &self.state,
                    target,
                    labelling,
                    restriction,
                    // Noise makes durations longer, by half of it on average.
                    latest: bound as f32 * (1.0 + 0.5 * labelling.noise),
                    stop,
                },
                plan,
            );
            if !label.is_finite() {
                if labelling.protect && self.exploration.protected {
                    labelling.protect = false;
                    continue;
                }
                if self.exploration.cut {
                    self.late = true;
                    return false;
                }
                if restriction != Restriction::None {
                    restriction = Restriction::None;
                } else if labelling.protect {
                    labelling.protect = false;
                } else if labelling.windows && !self.model.windowed.is_empty() {
                    labelling.windows = false;
                } else {
                    return false;
                }
                continue;
            }
            let before = self.state.list.len();
            for (operator, proposition) in plan.iter().copied() {
                if self.holds(proposition) {
                    continue;
                }
                let end = self.append(operator).or_else(|| {
                    let other = self.substitute(proposition, operator, true)?;
                    self.append(other.operator)
                });
                let Some(end) = end else { break };
                if end >= bound {
                    self.late = true;
                    return false;
                }
            }
            if self.state.list.len() == before && labelling.windows {
                labelling.windows = false;
            } else if self.state.list.len() == before {
                // The relaxation believes in something that does not work: look elsewhere.
                if labelling.noise >= 2.0 {
                    return false;
                }
                labelling.noise += 0.7;
                labelling.salt = labelling.salt.wrapping_mul(747_796_405).wrapping_add(1);
            }
        }
        false
    }

    /// Starts over with nothing.
    pub fn reset(&mut self) {
        self.late = false;
        self.state.reset();
        self.waiting.clear();
    }

    /// Starts over with as many of these operators as the list under construction begins with; how
    /// many these are. The same operators in the same order are the same schedule.
    pub fn start_over(&mut self, operators: impl Iterator<Item = u32>) -> usize {
        if self.envelopes {
            // Their times depend on what comes after them.
            self.reset();
            return 0;
        }
        self.late = false;
        self.state.keep_beginning(operators)
    }

    /// Starts over with these operators, each at its earliest start, envelopes around what happens in
    /// them; false if one does not apply.
    pub fn replay(&mut self, operators: impl Iterator<Item = u32> + Clone) -> bool {
        let kept = self.start_over(operators.clone());
        let mut operators = operators.skip(kept);
        let applies = operators.all(|operator| self.append(operator).is_some());
        self.tighten_envelopes();
        applies
    }

    /// What the schedule under construction is worth; smaller is better.
    pub fn value(&self) -> f64 {
        self.objective.value(&self.model, &self.state)
    }
}
