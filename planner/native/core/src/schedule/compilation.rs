//! Compiles a ground task into the flat form of this space.

use crate::pddl::model::Assignment;
use crate::schedule::model::{
    Comparing, ConditionalWrite, Detail, EPSILON, Model, NONE, NumericWrite, Read, Shape, When,
    Write, fluents_of, literals,
};
use crate::task::{
    Change, Duration, FactId, FluentId, GroundEffect, GroundExpression, NumericCondition, Task,
};

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
            window_lengths: Vec::new(),
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
        for lengths in &mut model.window_lengths {
            lengths.sort_by(f64::total_cmp);
            lengths.dedup();
        }
        Some(model)
    }

    fn window(&mut self, fact: u32) {
        let slot = &mut self.window_of[fact as usize];
        if *slot == NONE {
            *slot = self.windowed.len() as u32;
            self.windowed.push(fact);
            self.window_lengths.push(Vec::new());
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
        let own_reads = &self.reads[reads_from as usize..];
        let undoes = detail.conditional.iter().any(|effect| {
            !effect.at_end
                && effect.fact.is_some_and(|(fact, _)| {
                    own_reads
                        .iter()
                        .any(|read| read.fact == fact && read.when != When::Start)
                })
        });
        if decided || undoes || (detail.conditional.len() > 1 && chained(&detail.conditional)) {
            return None;
        }
        let mention = |facts: &[FactId], at_end: bool| {
            let facts = facts.iter().map(move |fact| (fact.0, at_end));
            facts.collect::<Vec<_>>()
        };
        detail.mentions = mention(&operator.also_reads[0], false);
        detail
            .mentions
            .extend(mention(&operator.also_reads[1], true));
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
        for fact in &transient {
            self.window(*fact);
            let opens = own[..start_writes].contains(&(*fact, true));
            if opens && !excluded {
                let length = if duration.is_nan() {
                    f64::INFINITY
                } else {
                    duration
                };
                self.window_lengths[self.window_of[*fact as usize] as usize].push(length);
            }
        }
        let plain = detail.bounds.is_none()
            && detail.comparisons.is_empty()
            && detail.numeric.is_empty()
            && detail.conditional.is_empty()
            && detail.mentions.is_empty();
        let start_reads = &self.reads[reads_from as usize..];
        let restores = |write: &Write| {
            let reads = |read: &Read| (read.fact, read.value) == (write.fact, true);
            write.after_own
                && start_reads
                    .iter()
                    .any(|read| read.when == When::Start && reads(read))
        };
        let envelope = plain
            && own[..start_writes]
                .iter()
                .any(|(fact, value)| *value && transient.contains(fact))
            && self.writes[writes_from as usize..]
                .iter()
                .all(|write| !write.value || transient.contains(&write.fact) || restores(write));
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
            envelope,
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
