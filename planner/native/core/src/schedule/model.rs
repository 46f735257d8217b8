//! A ground task in the flat form that dispatching and relaxed exploration walk over.

use crate::pddl::model::Assignment;
use crate::task::{
    Change, Conjunction, Duration, FluentId, GroundEffect, GroundExpression, NumericCondition, Task,
};

/// Least separation of two happenings that interfere [s] (PDDL 2.1).
pub const EPSILON: f64 = 0.001;

/// Stands for "no such index".
pub const NONE: u32 = u32::MAX;

/// When a condition has to hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// Just before the start.
    Start,
    /// Between start and end.
    Throughout,
    /// Just before the end.
    End,
}

/// A literal that an operator needs.
#[derive(Clone, Copy, Debug)]
pub struct Read {
    pub fact: u32,
    pub value: bool,
    pub when: When,
    /// The operator's own start effect supplies it.
    pub own: bool,
}

/// A literal that an operator makes true.
#[derive(Clone, Copy, Debug)]
pub struct Write {
    pub fact: u32,
    pub value: bool,
    pub at_end: bool,
    /// The operator writes the same fact at its start too.
    pub after_own: bool,
}

/// A change of a fluent.
#[derive(Clone, Debug)]
pub struct NumericWrite {
    pub assignment: Assignment,
    pub fluent: FluentId,
    pub value: GroundExpression,
    pub at_end: bool,
    /// Fluents that `value` reads.
    pub reads: Vec<u32>,
}

impl NumericWrite {
    /// Whether simultaneous changes commute.
    pub fn additive(&self) -> bool {
        matches!(self.assignment, Assignment::Increase | Assignment::Decrease)
    }
}

/// A comparison, when it has to hold and the fluents it reads.
#[derive(Clone, Debug)]
pub struct Comparing {
    pub condition: NumericCondition,
    pub when: When,
    pub reads: Vec<u32>,
}

/// An effect that depends on the state.
#[derive(Clone, Debug)]
pub struct ConditionalWrite {
    pub condition: [Conjunction; 3],
    pub at_end: bool,
    pub fact: Option<(u32, bool)>,
    pub fluent: Option<NumericWrite>,
}

/// What few operators have.
#[derive(Clone, Debug, Default)]
pub struct Detail {
    pub bounds: Option<(GroundExpression, GroundExpression, Vec<u32>)>,
    pub comparisons: Vec<Comparing>,
    pub numeric: Vec<NumericWrite>,
    pub conditional: Vec<ConditionalWrite>,
}

/// An operator's slices of the tables.
#[derive(Clone, Copy, Debug)]
pub struct Shape {
    /// Fixed duration [s]; NaN if it depends on the state.
    pub duration: f64,
    pub reads: (u32, u32),
    pub writes: (u32, u32),
    /// Index into [`Model::details`] or [`NONE`].
    pub detail: u32,
    pub instantaneous: bool,
    /// Left out: it can never run in this space.
    pub excluded: bool,
}

/// The compiled task.
#[derive(Clone, Debug)]
pub struct Model {
    pub fact_count: usize,
    pub initial_facts: Vec<bool>,
    pub initial_values: Vec<f64>,
    pub shapes: Vec<Shape>,
    pub reads: Vec<Read>,
    pub writes: Vec<Write>,
    pub details: Vec<Detail>,
    /// Facts with past windows a reader may use; index into the state's windows or [`NONE`].
    pub window_of: Vec<u32>,
    /// The facts with windows.
    pub windowed: Vec<u32>,
    pub goal: Vec<(u32, bool)>,
    pub goal_comparisons: Vec<Comparing>,
    /// What the goal wants of each fact.
    pub goal_value: Vec<Option<bool>>,
    /// Operators that write a goal fact the wrong way.
    pub threatens_goal: Vec<bool>,
    /// Whether an operator can make the fact false (true).
    pub deletable: Vec<bool>,
    /// Whether operators that may be part of a plan were left out.
    pub excluded_any: bool,
}

/// Fluents that an expression reads; `None` if it calls an attachment.
pub fn fluents_of(expression: &GroundExpression, out: &mut Vec<u32>) -> Option<()> {
    match expression {
        GroundExpression::Constant(_)
        | GroundExpression::Duration
        | GroundExpression::TotalTime => Some(()),
        GroundExpression::Fluent(fluent) => {
            out.push(fluent.0);
            Some(())
        }
        GroundExpression::Call(_) => None,
        GroundExpression::Binary(_, left, right) => {
            fluents_of(left, out)?;
            fluents_of(right, out)
        }
    }
}

fn comparings(
    comparisons: &[NumericCondition],
    when: When,
    out: &mut Vec<Comparing>,
) -> Option<()> {
    for condition in comparisons {
        let mut reads = Vec::new();
        fluents_of(&condition.left, &mut reads)?;
        fluents_of(&condition.right, &mut reads)?;
        out.push(Comparing {
            condition: condition.clone(),
            when,
            reads,
        });
    }
    Some(())
}

impl Model {
    /// Compiles a task; `None` if it uses what this space does not know: attachments that depend
    /// on the state and derived facts.
    pub fn new(task: &Task) -> Option<Self> {
        if !task.axioms.is_empty() || !task.goal.calls.is_empty() {
            return None;
        }
        let fact_count = task.facts.len();
        let mut initial_facts = vec![false; fact_count];
        for fact in &task.initial_facts {
            initial_facts[fact.index()] = true;
        }
        let mut model = Self {
            fact_count,
            initial_facts,
            initial_values: task.initial_values.clone(),
            shapes: Vec::with_capacity(task.operators.len()),
            reads: Vec::with_capacity(task.operators.len() * 2),
            writes: Vec::with_capacity(task.operators.len() * 3),
            details: Vec::new(),
            window_of: vec![NONE; fact_count],
            windowed: Vec::new(),
            goal_value: vec![None; fact_count],
            threatens_goal: Vec::new(),
            goal: literals(&task.goal).collect(),
            goal_comparisons: Vec::new(),
            deletable: vec![false; fact_count],
            excluded_any: false,
        };
        comparings(
            &task.goal.comparisons,
            When::End,
            &mut model.goal_comparisons,
        )?;
        for event in &task.timed {
            match &event.change {
                Change::Add(fact) | Change::Delete(fact) => model.window(fact.0),
                Change::Assign(..) => {}
                Change::Call(_) => return None,
            }
        }
        for (fact, value) in literals(&task.goal) {
            model.goal_value[fact as usize] = Some(value);
        }
        let mut own = Vec::new();
        for operator in &task.operators {
            model.add(operator, &mut own)?;
        }
        Some(model)
    }

    fn window(&mut self, fact: u32) {
        let slot = &mut self.window_of[fact as usize];
        if *slot == NONE {
            *slot = self.windowed.len() as u32;
            self.windowed.push(fact);
        }
    }

    fn add(&mut self, operator: &crate::task::Operator, own: &mut Vec<(u32, bool)>) -> Option<()> {
        let reads_from = self.reads.len() as u32;
        let writes_from = self.writes.len() as u32;
        let mut detail = Detail::default();
        let duration = match &operator.duration {
            None => 0.0,
            Some(Duration::Fixed(seconds)) => *seconds,
            Some(Duration::Bounds(low, high)) => {
                let mut reads = Vec::new();
                fluents_of(low, &mut reads)?;
                fluents_of(high, &mut reads)?;
                detail.bounds = Some((low.clone(), high.clone(), reads));
                f64::NAN
            }
        };
        let mut excluded = false;
        own.clear();
        self.effects(&operator.start_effects, false, own, &mut detail)?;
        let start_writes = own.len();
        self.effects(&operator.end_effects, true, own, &mut detail)?;
        let conditions = [
            (&operator.start_condition, When::Start),
            (&operator.invariant, When::Throughout),
            (&operator.end_condition, When::End),
        ];
        for (condition, when) in conditions {
            if !condition.calls.is_empty() {
                return None;
            }
            comparings(&condition.comparisons, when, &mut detail.comparisons)?;
            for (fact, value) in literals(condition) {
                let supplied = own[..start_writes]
                    .iter()
                    .find(|(written, _)| *written == fact)
                    .map(|(_, supplied)| *supplied);
                let own = when != When::Start && supplied.is_some();
                if own && supplied != Some(value) {
                    excluded = true;
                }
                self.reads.push(Read {
                    fact,
                    value,
                    when,
                    own,
                });
            }
        }
        // Start and end of a very short action are one happening: leave out those whose end would
        // interfere with their own start.
        if operator.duration.is_some() && duration < EPSILON {
            let touched = |fact: u32| own[..start_writes].iter().any(|(other, _)| *other == fact);
            let interferes = own[start_writes..].iter().any(|(fact, _)| touched(*fact))
                || self.reads[reads_from as usize..]
                    .iter()
                    .any(|read| read.when != When::Start && touched(read.fact))
                || !detail.numeric.is_empty()
                || !detail.conditional.is_empty();
            excluded |= interferes;
            self.excluded_any |= interferes;
        }
        // Conditional effects are decided by the state before the operator.
        let decided = detail.conditional.iter().any(|effect| {
            let mut parts = effect.condition.iter().skip(1);
            parts.any(|part| {
                literals(part)
                    .any(|(fact, _)| own[..start_writes].iter().any(|(other, _)| *other == fact))
                    || !part.comparisons.is_empty() && !detail.numeric.is_empty()
            })
        });
        if decided || (detail.conditional.len() > 1 && chained(&detail.conditional)) {
            return None;
        }
        for write in &self.writes[writes_from as usize..] {
            if !write.value {
                self.deletable[write.fact as usize] = true;
            }
        }
        let transient: Vec<u32> = self.writes[writes_from as usize..]
            .iter()
            .filter(|write| write.after_own && !write.value)
            .map(|write| write.fact)
            .collect();
        for fact in transient {
            self.window(fact);
        }
        let plain = detail.bounds.is_none()
            && detail.comparisons.is_empty()
            && detail.numeric.is_empty()
            && detail.conditional.is_empty();
        let detail = if plain {
            NONE
        } else {
            self.details.push(detail);
            self.details.len() as u32 - 1
        };
        let threat = |write: &Write| self.goal_value[write.fact as usize] == Some(!write.value);
        self.threatens_goal
            .push(self.writes[writes_from as usize..].iter().any(threat));
        self.shapes.push(Shape {
            duration,
            reads: (reads_from, self.reads.len() as u32),
            writes: (writes_from, self.writes.len() as u32),
            detail,
            instantaneous: operator.duration.is_none(),
            excluded,
        });
        Some(())
    }

    fn effects(
        &mut self,
        effects: &[GroundEffect],
        at_end: bool,
        own: &mut Vec<(u32, bool)>,
        detail: &mut Detail,
    ) -> Option<()> {
        let from = own.len();
        let first_write = self.writes.len();
        for effect in effects {
            if let Some(condition) = &effect.condition {
                if condition.iter().any(|part| !part.calls.is_empty()) {
                    return None;
                }
                let (fact, fluent) = match &effect.change {
                    Change::Add(fact) => (Some((fact.0, true)), None),
                    Change::Delete(fact) => (Some((fact.0, false)), None),
                    Change::Assign(assignment, fluent, value) => {
                        (None, Some(numeric(*assignment, *fluent, value, at_end)?))
                    }
                    Change::Call(_) => return None,
                };
                detail.conditional.push(ConditionalWrite {
                    condition: (**condition).clone(),
                    at_end,
                    fact,
                    fluent,
                });
                continue;
            }
            let (fact, value) = match &effect.change {
                Change::Add(fact) => (fact.0, true),
                Change::Delete(fact) => (fact.0, false),
                Change::Assign(assignment, fluent, value) => {
                    detail
                        .numeric
                        .push(numeric(*assignment, *fluent, value, at_end)?);
                    continue;
                }
                Change::Call(_) => return None,
            };
            // An add wins over a delete of the same happening.
            if let Some(seen) = own[from..].iter().position(|(other, _)| *other == fact) {
                if value {
                    own[from + seen].1 = true;
                    self.writes[first_write + seen].value = true;
                }
                continue;
            }
            let after_own = at_end && own[..from].iter().any(|(other, _)| *other == fact);
            own.push((fact, value));
            self.writes.push(Write {
                fact,
                value,
                at_end,
                after_own,
            });
        }
        Some(())
    }

    /// Literals that an operator needs.
    pub fn reads(&self, operator: u32) -> &[Read] {
        let (from, to) = self.shapes[operator as usize].reads;
        &self.reads[from as usize..to as usize]
    }

    /// Literals that an operator writes whatever the state.
    pub fn writes(&self, operator: u32) -> &[Write] {
        let (from, to) = self.shapes[operator as usize].writes;
        &self.writes[from as usize..to as usize]
    }

    /// Numeric and conditional parts of an operator.
    pub fn detail(&self, operator: u32) -> Option<&Detail> {
        self.details
            .get(self.shapes[operator as usize].detail as usize)
    }
}

/// Literals of a conjunction as (fact, value).
pub fn literals(condition: &Conjunction) -> impl Iterator<Item = (u32, bool)> + '_ {
    let positive = condition.positive.iter().map(|fact| (fact.0, true));
    positive.chain(condition.negative.iter().map(|fact| (fact.0, false)))
}

fn numeric(
    assignment: Assignment,
    fluent: FluentId,
    value: &GroundExpression,
    at_end: bool,
) -> Option<NumericWrite> {
    let mut reads = Vec::new();
    fluents_of(value, &mut reads)?;
    Some(NumericWrite {
        assignment,
        fluent,
        value: value.clone(),
        at_end,
        reads,
    })
}

/// Whether a conditional start effect writes what a later part of another one reads.
fn chained(effects: &[ConditionalWrite]) -> bool {
    effects
        .iter()
        .filter(|effect| !effect.at_end)
        .any(|writer| {
            writer.fluent.is_some()
                || writer.fact.is_some_and(|(fact, _)| {
                    effects.iter().any(|reader| {
                        let mut parts = reader.condition.iter().skip(1);
                        reader.at_end
                            && parts.any(|part| literals(part).any(|(other, _)| other == fact))
                    })
                })
        })
}
