//! Executes a plan happening by happening.

mod separation;

use super::effects::{Changes, LongEffect};
use super::evaluate::compare;
use super::explain::History;
use super::interference::{Access, Claims};
use super::resolve::GroundStep;
use super::scene::{Moment, Scene};
use super::state::State;
use super::text::sign;
use super::timeline::{Happening, Occurrence};
use super::verdict::{Failure, Reason};
use crate::pddl::model::{Comparison, Condition, ObjectId, When};

/// An action between its start and its end.
struct Running<'a> {
    step: usize,
    long_effects: Vec<LongEffect<'a>>,
}

/// The execution of a plan up to some happening.
pub(super) struct Run<'s, 'a> {
    scene: &'s Scene<'a>,
    steps: &'s [GroundStep<'a>],
    tolerance_s: f64,
    pub(super) state: State,
    running: Vec<Running<'a>>,
    claims: Claims,
    history: History,
    happening: usize,
    time: f64,
    tracing: bool,
    pub(super) report: Vec<String>,
}

impl<'s, 'a> Run<'s, 'a> {
    pub(super) fn new(
        scene: &'s Scene<'a>,
        steps: &'s [GroundStep<'a>],
        initial: State,
        options: &super::Options,
    ) -> Self {
        Self {
            scene,
            steps,
            tolerance_s: options.tolerance_s,
            state: initial,
            running: Vec::new(),
            claims: Claims::new(options.least_gap_s()),
            history: History::default(),
            happening: 0,
            time: 0.0,
            tracing: options.report,
            report: Vec::new(),
        }
    }

    /// Derived facts of the initial state.
    pub(super) fn begin(&mut self) -> Result<(), Box<Failure>> {
        self.scene
            .derive(&mut self.state)
            .map_err(|fault| self.failure(fault.into(), None))
    }

    /// Conditions, mutex, changes, invariants: one happening.
    pub(super) fn step(&mut self, happening: &Happening) -> Result<(), Box<Failure>> {
        self.happening += 1;
        self.time = happening.time;
        self.note(|run| format!("happening {}, time {}", run.happening, run.time));
        for occurrence in &happening.occurrences {
            self.check_conditions(*occurrence)?;
        }
        let mut all = Vec::with_capacity(happening.occurrences.len());
        for occurrence in &happening.occurrences {
            all.push((*occurrence, self.changes_of(*occurrence)?));
        }
        self.check_interference(&all)?;
        self.apply(&all)?;
        self.check_invariants()
    }

    /// The goal, in the state after the last happening.
    pub(super) fn check_goal(&mut self) -> Result<(), Box<Failure>> {
        let goal = &self.scene.problem.goal;
        let moment = self.moment(None);
        let verdict = self.scene.holds(&moment, goal, &mut Vec::new());
        if verdict.map_err(|fault| self.failure(fault.into(), None))? {
            self.note(|_| "the goal holds".into());
            return Ok(());
        }
        Err(self.unsatisfied(goal, &[], None, Reason::Goal))
    }

    fn moment(&self, step: Option<usize>) -> Moment<'_> {
        Moment {
            state: &self.state,
            duration: step.and_then(|index| self.steps[index].duration),
            total_time: self.time,
            action: step.map_or("(the goal)", |index| self.steps[index].text.as_str()),
        }
    }

    fn note(&mut self, line: impl FnOnce(&Self) -> String) {
        if self.tracing {
            let line = line(self);
            self.report.push(line);
        }
    }

    fn failure(&self, reason: Reason, step: Option<usize>) -> Box<Failure> {
        Box::new(Failure {
            reason,
            time: Some(self.time),
            happening: Some(self.happening.max(1)),
            step,
            action: step.map(|index| self.steps[index].text.clone()),
            facts: Vec::new(),
        })
    }

    /// A failure for a false condition.
    fn unsatisfied(
        &self,
        condition: &Condition,
        bindings: &[ObjectId],
        step: Option<usize>,
        reason: impl FnOnce(String) -> Reason,
    ) -> Box<Failure> {
        let moment = self.moment(step);
        let explained = self
            .scene
            .smallest_false(&moment, condition, bindings)
            .and_then(|(part, stack)| {
                let facts = self
                    .scene
                    .facts_around(&self.state, part, &stack, &self.history)?;
                Ok((self.scene.condition_text(part, &stack), facts))
            });
        match explained {
            Ok((text, facts)) => Box::new(Failure {
                facts,
                ..*self.failure(reason(text), step)
            }),
            Err(fault) => self.failure(fault.into(), step),
        }
    }

    /// Durations and the conditions at start or at end, in the state before the happening.
    fn check_conditions(&mut self, occurrence: Occurrence) -> Result<(), Box<Failure>> {
        let (index, now) = match occurrence {
            Occurrence::Start(index) => (index, When::Start),
            Occurrence::End(index) => (index, When::End),
            Occurrence::Timed(index) => {
                self.note(|_| format!("  timed initial literal {}", index + 1));
                return Ok(());
            }
        };
        let step = &self.steps[index];
        self.note(|_| {
            let word = match (now, step.duration) {
                (When::End, _) => "end of",
                (_, Some(_)) => "start of",
                (_, None) => "instantaneous",
            };
            format!("  {word} {}", step.text)
        });
        self.check_duration(index, now)?;
        for (when, condition) in &step.action.conditions {
            if *when == now {
                let when = step.duration.map(|_| *when);
                self.check(index, when, condition)?;
            }
        }
        Ok(())
    }

    fn check(
        &mut self,
        index: usize,
        when: Option<When>,
        condition: &Condition,
    ) -> Result<(), Box<Failure>> {
        let step = &self.steps[index];
        let moment = self.moment(Some(index));
        let holds = self
            .scene
            .holds(&moment, condition, &mut step.arguments.clone())
            .map_err(|fault| self.failure(fault.into(), Some(index)))?;
        if !holds {
            return Err(
                self.unsatisfied(condition, &step.arguments, Some(index), |condition| {
                    Reason::Condition { when, condition }
                }),
            );
        }
        self.note(|run| {
            let text = run.scene.condition_text(condition, &step.arguments);
            match when {
                Some(When::OverAll) => format!("  over all of {}: {text} holds", step.text),
                _ => format!("    {text} holds"),
            }
        });
        Ok(())
    }

    fn check_duration(&mut self, index: usize, now: When) -> Result<(), Box<Failure>> {
        let step = &self.steps[index];
        let (Some(found), Some(constraints)) = (step.duration, &step.action.duration) else {
            return Ok(());
        };
        for constraint in constraints.iter().filter(|one| one.when == now) {
            let moment = self.moment(Some(index));
            let bound = self
                .scene
                .value(&moment, &constraint.bound, &step.arguments)
                .map_err(|fault| self.failure(fault.into(), Some(index)))?;
            let tolerance_s = self.tolerance_s;
            let holds = bound.is_finite()
                && match constraint.comparison {
                    Comparison::Equal => (found - bound).abs() <= tolerance_s,
                    Comparison::LessEqual => found - bound <= tolerance_s,
                    Comparison::GreaterEqual => bound - found <= tolerance_s,
                    strict => compare(strict, found, bound),
                };
            let expression = self
                .scene
                .expression_text(&constraint.bound, &step.arguments);
            let comparison = sign(constraint.comparison);
            if !holds {
                let reason = Reason::Duration {
                    found,
                    comparison,
                    bound,
                    expression,
                };
                return Err(self.failure(reason, Some(index)));
            }
            self.note(|_| format!("    duration {found} {comparison} {expression} holds"));
        }
        Ok(())
    }

    /// What an occurrence reads and changes, in the state before the happening.
    fn changes_of(&mut self, occurrence: Occurrence) -> Result<Changes, Box<Failure>> {
        let (index, now) = match occurrence {
            Occurrence::Start(index) => (index, When::Start),
            Occurrence::End(index) => (index, When::End),
            Occurrence::Timed(index) => {
                return Ok(Changes::timed(&self.scene.problem.timed[index].change));
            }
        };
        let step = &self.steps[index];
        // Taken out so that the state can be read while the long effects are followed.
        let mut running = std::mem::take(&mut self.running);
        let changes = self.collect_changes(index, now, &mut running);
        self.running = running;
        let changes = changes.map_err(|reason| self.failure(reason, Some(index)))?;
        if let Some((function, tuple)) = changes.double_assignment() {
            let fluent = self.scene.fluent_text(function, tuple);
            return Err(self.failure(Reason::DoubleAssignment(fluent), Some(index)));
        }
        debug_assert_eq!(step.arguments.len(), step.action.parameters.len());
        Ok(changes)
    }

    fn collect_changes(
        &self,
        index: usize,
        now: When,
        running: &mut Vec<Running<'a>>,
    ) -> Result<Changes, Reason> {
        let step = &self.steps[index];
        let moment = self.moment(Some(index));
        let mut bindings = step.arguments.clone();
        let mut changes = Changes::default();
        for (when, condition) in &step.action.conditions {
            if *when == now {
                self.scene
                    .needs(condition, &mut bindings, &mut changes.reads)?;
            }
        }
        for constraint in step.action.duration.iter().flatten() {
            if constraint.when == now {
                Scene::reads(&constraint.bound, &bindings, &mut changes.reads);
            }
        }
        if now == When::Start && step.duration.is_some() {
            let mut long_effects = Vec::new();
            for (_, effect) in &step.action.effects {
                self.scene.long_effects(
                    &moment,
                    effect,
                    &mut bindings,
                    &mut changes.reads,
                    &mut long_effects,
                )?;
            }
            running.push(Running {
                step: index,
                long_effects,
            });
        }
        for (when, effect) in &step.action.effects {
            if *when == now {
                self.scene
                    .collect(&moment, effect, &mut bindings, &mut changes)?;
            }
        }
        if now == When::End
            && let Some(position) = running.iter().position(|one| one.step == index)
        {
            for mut long in running.remove(position).long_effects {
                self.scene.collect_long(&moment, &mut long, &mut changes)?;
            }
        }
        Ok(changes)
    }

    fn apply(&mut self, all: &[(Occurrence, Changes)]) -> Result<(), Box<Failure>> {
        for (_, changes) in all {
            changes.apply_deletes(&mut self.state);
        }
        for (occurrence, changes) in all {
            changes.apply_adds_and_values(&mut self.state);
            let cause = match occurrence {
                Occurrence::Start(index) if self.steps[*index].duration.is_some() => {
                    format!("start of {}", self.steps[*index].text)
                }
                Occurrence::Start(index) => self.steps[*index].text.clone(),
                Occurrence::End(index) => format!("end of {}", self.steps[*index].text),
                Occurrence::Timed(_) => "timed initial literal".into(),
            };
            for line in changes.lines(self.scene) {
                self.note(|_| format!("  {cause} {line}"));
            }
            for (symbol, access) in changes.accesses() {
                if access != Access::Needs {
                    self.history.insert(symbol, (self.time, cause.clone()));
                }
            }
        }
        if self.scene.domain.derived.is_empty() {
            return Ok(());
        }
        self.scene
            .derive(&mut self.state)
            .map_err(|fault| self.failure(fault.into(), None))
    }

    /// What running actions need over all, in the state that lasts until the next happening.
    fn check_invariants(&mut self) -> Result<(), Box<Failure>> {
        let mut running = std::mem::take(&mut self.running);
        for one in &mut running {
            let step = &self.steps[one.step];
            for (when, condition) in &step.action.conditions {
                if *when == When::OverAll {
                    self.check(one.step, Some(When::OverAll), condition)?;
                }
            }
            let moment = self.moment(Some(one.step));
            for long in &mut one.long_effects {
                self.scene
                    .follow(&moment, long, When::OverAll)
                    .map_err(|fault| self.failure(fault.into(), Some(one.step)))?;
            }
        }
        self.running = running;
        Ok(())
    }
}
