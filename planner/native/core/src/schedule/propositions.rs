//! The delete relaxation of a task: literals and numeric conditions as propositions, operators as
//! rules from propositions to propositions.

use crate::schedule::changes::helped;
use crate::schedule::model::{Comparing, Model, NONE, When};
use crate::schedule::numbering::{Numbering, uses_duration};
use crate::schedule::rows::Rows;
use crate::schedule::state::State;

/// A rule of the relaxation: an operator, or one conditional effect of it.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    /// [`NONE`] if it only says what follows from a change of a fluent.
    pub operator: u32,
    pub duration: f32,
    /// What running it costs besides time.
    pub cost: f32,
    needs: (u32, u32),
    adds: (u32, u32),
}

/// A proposition that a rule needs or adds.
#[derive(Clone, Copy, Debug)]
pub struct Term {
    pub proposition: u32,
    pub at_end: bool,
    /// Needed between start and end only.
    pub throughout: bool,
}

/// What a proposition stands for.
#[derive(Clone, Debug)]
pub enum Meaning {
    /// A fact with this value.
    Literal(u32, bool),
    /// A comparison of fluents.
    Numeric(u32),
    /// A fact with windows, for at least this long [s].
    Lasting(u32, f64),
    /// That a fluent has been changed in one way.
    Change,
}

/// The delete relaxation.
#[derive(Clone, Debug)]
pub struct Propositions {
    /// Propositions below this are the facts, true.
    pub fact_count: u32,
    /// The others.
    pub extra: Vec<Meaning>,
    pub comparisons: Vec<Comparing>,
    pub rules: Vec<Rule>,
    needs: Vec<Term>,
    adds: Vec<Term>,
    /// Rules that need a proposition.
    pub needing: Rows,
    /// Rules that need a proposition more than any other: each under the one of its needs that the
    /// fewest rules have. What a robot does needs the robot idle and somewhere; the place is what
    /// tells its rules apart.
    pub watching: Rows,
    /// Rules that add a proposition.
    pub adding: Rows,
    negation_of: Vec<u32>,
    /// Propositions that a fact with windows holds for a while.
    pub lasting: Vec<u32>,
    /// Rules that need nothing.
    pub free: Vec<u32>,
    /// Propositions of the goal.
    pub goal: Vec<u32>,
    /// First rule of each operator.
    pub rule_of: Vec<u32>,
}

impl Propositions {
    /// Relaxes a task. `costs` are the operators' costs besides time.
    pub fn new(model: &Model, initial: &State, costs: &[f32]) -> Self {
        let mut numbering = Numbering {
            negation_of: vec![NONE; model.fact_count],
            ..Numbering::default()
        };
        let mut rules = Vec::new();
        let mut needs = Vec::new();
        let mut adds: Vec<Term> = Vec::new();
        // All conditions first: effects on literals that nobody needs are left out.
        let mut ranges = Vec::with_capacity(model.shapes.len());
        for operator in 0..model.shapes.len() as u32 {
            let from = needs.len();
            for read in model.reads(operator) {
                if !read.own {
                    let duration = model.shapes[operator as usize].duration;
                    needs.push(Term {
                        proposition: match read.when {
                            When::Throughout if read.value => {
                                numbering.lasting(model, read.fact, duration)
                            }
                            _ => numbering.literal(read.fact, read.value),
                        },
                        at_end: read.when == When::End,
                        throughout: read.when == When::Throughout,
                    });
                }
            }
            if let Some(detail) = model.detail(operator) {
                for comparing in &detail.comparisons {
                    let own = detail
                        .numeric
                        .iter()
                        .any(|write| !write.at_end && comparing.reads.contains(&write.fluent.0));
                    if uses_duration(&comparing.condition) || (own && comparing.when != When::Start)
                    {
                        continue;
                    }
                    needs.push(Term {
                        proposition: numbering.comparison(&comparing.condition),
                        at_end: comparing.when == When::End,
                        throughout: comparing.when == When::Throughout,
                    });
                }
            }
            ranges.push((from as u32, needs.len() as u32));
        }
        let mut goal: Vec<u32> = model
            .goal
            .iter()
            .map(|(fact, value)| numbering.literal(*fact, *value))
            .collect();
        for comparing in &model.goal_comparisons {
            goal.push(numbering.comparison(&comparing.condition));
        }
        let mut conditional_needs = Vec::new();
        for operator in 0..model.shapes.len() as u32 {
            if let Some(detail) = model.detail(operator) {
                for effect in &detail.conditional {
                    let (from, to) = ranges[operator as usize];
                    let mut own = needs[from as usize..to as usize].to_vec();
                    for (index, part) in effect.condition.iter().enumerate() {
                        numbering.conjunction(part, index == 2 && effect.at_end, &mut own);
                    }
                    conditional_needs.push(own);
                }
            }
        }
        let mut conditional_needs = conditional_needs.into_iter();
        let mut rule_of = vec![NONE; model.shapes.len()];
        for operator in 0..model.shapes.len() as u32 {
            let shape = &model.shapes[operator as usize];
            let detail = model.detail(operator);
            let conditional: Vec<_> = detail
                .map(|detail| {
                    detail
                        .conditional
                        .iter()
                        .map(|effect| (effect, conditional_needs.next().unwrap_or_default()))
                        .collect()
                })
                .unwrap_or_default();
            if shape.excluded {
                continue;
            }
            let duration = if shape.duration.is_nan() {
                detail
                    .and_then(|detail| detail.bounds.as_ref())
                    .map(|(low, _, _)| initial.evaluate(low, 0.0, &[]))
                    .filter(|low| low.is_finite())
                    .unwrap_or(0.0)
                    .max(0.0)
            } else {
                shape.duration
            } as f32;
            let from = adds.len() as u32;
            for write in model.writes(operator) {
                let proposition = if write.value {
                    write.fact
                } else {
                    numbering.negation_of[write.fact as usize]
                };
                if proposition != NONE {
                    adds.push(Term {
                        proposition,
                        at_end: write.at_end,
                        throughout: false,
                    });
                }
                if write.value {
                    let passing = model
                        .writes(operator)
                        .iter()
                        .any(|other| other.fact == write.fact && other.after_own && !other.value);
                    let length = if passing {
                        shape.duration
                    } else {
                        f64::INFINITY
                    };
                    let lasting = numbering.lasting_up_to(write.fact, length);
                    adds.extend(lasting.map(|proposition| Term {
                        proposition,
                        at_end: write.at_end,
                        throughout: false,
                    }));
                }
            }
            if let Some(detail) = detail {
                for write in &detail.numeric {
                    helped(&mut numbering, initial, write, &mut adds);
                }
            }
            rule_of[operator as usize] = rules.len() as u32;
            rules.push(Rule {
                operator,
                duration,
                cost: costs[operator as usize],
                needs: ranges[operator as usize],
                adds: (from, adds.len() as u32),
            });
            for (effect, own) in conditional {
                let needs_from = needs.len() as u32;
                needs.extend(own);
                let from = adds.len() as u32;
                if let Some((fact, value)) = effect.fact {
                    let lasting = numbering.lasting_up_to(fact, f64::INFINITY);
                    adds.extend(lasting.filter(|_| value).map(|proposition| Term {
                        proposition,
                        at_end: effect.at_end,
                        throughout: false,
                    }));
                    let proposition = if value {
                        fact
                    } else {
                        numbering.negation_of[fact as usize]
                    };
                    if proposition != NONE {
                        adds.push(Term {
                            proposition,
                            at_end: effect.at_end,
                            throughout: false,
                        });
                    }
                }
                if let Some(write) = &effect.fluent {
                    helped(&mut numbering, initial, write, &mut adds);
                }
                rules.push(Rule {
                    operator,
                    duration,
                    cost: costs[operator as usize],
                    needs: (needs_from, needs.len() as u32),
                    adds: (from, adds.len() as u32),
                });
            }
        }
        for (change, comparisons) in &numbering.consequences {
            let (need, add) = (needs.len() as u32, adds.len() as u32);
            let term = |proposition: &u32| Term {
                proposition: *proposition,
                at_end: false,
                throughout: true,
            };
            needs.push(term(change));
            adds.extend(comparisons.iter().map(term));
            rules.push(Rule {
                operator: NONE,
                duration: 0.0,
                cost: 0.0,
                needs: (need, need + 1),
                adds: (add, adds.len() as u32),
            });
        }
        let count = model.fact_count + numbering.extra.len();
        let rows = |terms: &[Term], pick: fn(&Rule) -> (u32, u32)| {
            let pairs: Vec<(u32, u32)> = rules
                .iter()
                .enumerate()
                .flat_map(|(index, rule)| {
                    let (from, to) = pick(rule);
                    terms[from as usize..to as usize]
                        .iter()
                        .map(move |term| (term.proposition, index as u32))
                })
                .collect();
            Rows::new(count, pairs.iter().copied())
        };
        let needing = rows(&needs, |rule| rule.needs);
        let watched: Vec<(u32, u32)> = rules
            .iter()
            .enumerate()
            .filter_map(|(index, rule)| {
                let own = &needs[rule.needs.0 as usize..rule.needs.1 as usize];
                let rarest = own
                    .iter()
                    .min_by_key(|need| needing.row(need.proposition).len())?;
                Some((rarest.proposition, index as u32))
            })
            .collect();
        let watching = Rows::new(count, watched.iter().copied());
        let free = (0..rules.len() as u32).filter(|index| {
            let (from, to) = rules[*index as usize].needs;
            from == to
        });
        let free = free.collect();
        let adding = rows(&adds, |rule| rule.adds);
        let is_lasting = |index: &usize| matches!(numbering.extra[*index], Meaning::Lasting(..));
        let lasting = (0..numbering.extra.len()).filter(is_lasting);
        let lasting = lasting.map(|index| (model.fact_count + index) as u32);
        Self {
            lasting: lasting.collect(),
            fact_count: model.fact_count as u32,
            extra: numbering.extra,
            comparisons: numbering.comparisons,
            rules,
            needs,
            adds,
            needing,
            watching,
            adding,
            negation_of: numbering.negation_of,
            free,
            goal,
            rule_of,
        }
    }

    /// How many propositions there are.
    pub fn count(&self) -> usize {
        self.fact_count as usize + self.extra.len()
    }

    /// What a rule needs.
    pub fn needs(&self, rule: &Rule) -> &[Term] {
        &self.needs[rule.needs.0 as usize..rule.needs.1 as usize]
    }

    /// Entries of the table of adds.
    pub fn count_of_adds(&self) -> usize {
        self.adds.len()
    }

    /// Where a rule's adds begin in their table.
    pub fn first_add(&self, rule: &Rule) -> usize {
        rule.adds.0 as usize
    }

    /// What a rule adds.
    pub fn adds(&self, rule: &Rule) -> &[Term] {
        &self.adds[rule.adds.0 as usize..rule.adds.1 as usize]
    }

    /// The proposition of a literal; [`NONE`] if nothing ever needs it.
    pub fn of_literal(&self, fact: u32, value: bool) -> u32 {
        if value {
            fact
        } else {
            self.negation_of[fact as usize]
        }
    }

    /// The literal behind a proposition, unless it is numeric.
    pub fn literal(&self, proposition: u32) -> Option<(u32, bool)> {
        if proposition < self.fact_count {
            return Some((proposition, true));
        }
        match self.extra[(proposition - self.fact_count) as usize] {
            Meaning::Literal(fact, value) => Some((fact, value)),
            Meaning::Lasting(fact, _) => Some((fact, true)),
            Meaning::Numeric(_) | Meaning::Change => None,
        }
    }

    /// Whether a proposition holds at the end of a schedule.
    pub fn holds(&self, state: &State, proposition: u32) -> bool {
        if proposition < self.fact_count {
            return state.facts[proposition as usize].value;
        }
        match self.extra[(proposition - self.fact_count) as usize] {
            Meaning::Literal(fact, value) => state.holds(fact, value),
            Meaning::Lasting(fact, _) => state.holds(fact, true),
            Meaning::Change => false,
            Meaning::Numeric(index) => state.compares(&self.comparisons[index as usize], 0.0, &[]),
        }
    }

    /// When a proposition that holds became so [s].
    pub fn time(&self, model: &Model, state: &State, proposition: u32) -> f64 {
        if proposition < self.fact_count {
            return state.available(model, proposition, true);
        }
        match self.extra[(proposition - self.fact_count) as usize] {
            Meaning::Literal(fact, value) => state.available(model, fact, value),
            Meaning::Lasting(fact, _) => state.available(model, fact, true),
            Meaning::Change => f64::INFINITY,
            Meaning::Numeric(index) => self.comparisons[index as usize]
                .reads
                .iter()
                .map(|fluent| state.fluents[*fluent as usize].changed)
                .fold(0.0, f64::max),
        }
    }
}
