//! Causal links of an operator list: what each operator is for.

use smallvec::SmallVec;

use crate::schedule::model::{Model, NONE, When, Write, literals};
use crate::schedule::propositions::Propositions;

/// What the facts that an operator achieves are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Nothing: it can be left out.
    Useless,
    /// Only facts that their consumers use up, like a position on the way.
    Transit,
    /// Facts that stay or that several operators use.
    Lasting,
    /// A goal.
    Goal,
}

/// An operator of a list with its purpose.
#[derive(Clone, Debug)]
pub struct Element {
    pub operator: u32,
    pub role: Role,
    /// The proposition to achieve anew if the operator cannot run; [`NONE`] if only fluents.
    pub primary: u32,
    /// Literals that later operators or the goal take from it.
    pub purposes: SmallVec<[(u32, bool); 2]>,
    /// The operators that take them.
    pub consumers: SmallVec<[Consumer; 2]>,
}

impl Element {
    /// Whether moves start from it: what it is for stays, or is a goal.
    pub fn is_anchor(&self) -> bool {
        matches!(self.role, Role::Goal | Role::Lasting) && self.primary != NONE
    }
}

/// An operator that takes what another one achieves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Consumer {
    pub position: u32,
    /// What it takes.
    pub proposition: u32,
    /// Whether it cannot start before the other one has ended.
    pub follows: bool,
}

/// Reusable memory.
#[derive(Clone, Debug, Default)]
pub struct Links {
    producer: Vec<u32>,
    /// Who made it the other value before, for facts with past windows.
    former: Vec<u32>,
    value: Vec<bool>,
    writers: Vec<Vec<u32>>,
    touched: Vec<u32>,
}

struct Link {
    producer: u32,
    consumer: u32,
    fact: u32,
    value: bool,
    used_up: bool,
    /// Whether the consumer needs it from its start on.
    from_start: bool,
}

impl Links {
    /// Finds what each operator is for. With `cautious`, every operator that changed a fluent
    /// which is read later counts as needed; otherwise only those that reach numeric goals or
    /// feed values, and the list has to be replayed to see whether it still works.
    pub fn elements(
        &mut self,
        model: &Model,
        propositions: &Propositions,
        operators: &[u32],
        cautious: bool,
    ) -> Vec<Element> {
        self.producer.resize(model.fact_count, NONE);
        self.former.resize(model.fact_count, NONE);
        self.value.resize(model.fact_count, false);
        self.writers.resize(model.initial_values.len(), Vec::new());
        let mut links = Vec::with_capacity(operators.len() * 3);
        let mut numeric = Vec::new();
        for (position, operator) in operators.iter().enumerate() {
            let position = position as u32;
            for read in model.reads(*operator) {
                if !read.own {
                    let used_up = model
                        .writes(*operator)
                        .iter()
                        .any(|write| write.fact == read.fact && write.value != read.value);
                    let from_start = read.when != When::End;
                    let use_of = (used_up, from_start);
                    self.link(position, read.fact, read.value, use_of, &mut links);
                }
            }
            if let Some(detail) = model.detail(*operator) {
                let mut fluents = Vec::new();
                if let Some((_, _, reads)) = &detail.bounds {
                    fluents.extend_from_slice(reads);
                }
                for write in &detail.numeric {
                    fluents.extend_from_slice(&write.reads);
                }
                for effect in &detail.conditional {
                    for (fact, value) in effect.condition.iter().flat_map(literals) {
                        self.link(position, fact, value, (false, false), &mut links);
                    }
                    if let Some(write) = &effect.fluent {
                        fluents.extend_from_slice(&write.reads);
                    }
                }
                if cautious {
                    for comparing in &detail.comparisons {
                        fluents.extend_from_slice(&comparing.reads);
                    }
                }
                for fluent in fluents {
                    for writer in &self.writers[fluent as usize] {
                        numeric.push((*writer, position));
                    }
                }
                for write in &detail.numeric {
                    self.writers[write.fluent.index()].push(position);
                }
                for effect in &detail.conditional {
                    if let Some(write) = &effect.fluent {
                        self.writers[write.fluent.index()].push(position);
                    }
                    if let Some((fact, value)) = effect.fact {
                        self.write(model, position, fact, value);
                    }
                }
            }
            for write in model.writes(*operator) {
                self.write(model, position, write.fact, write.value);
            }
        }
        let end = operators.len() as u32;
        for (fact, value) in &model.goal {
            self.link(end, *fact, *value, (false, false), &mut links);
        }
        for comparing in &model.goal_comparisons {
            for fluent in &comparing.reads {
                for writer in &self.writers[*fluent as usize] {
                    numeric.push((*writer, end));
                }
            }
        }
        for fact in self.touched.drain(..) {
            self.producer[fact as usize] = NONE;
            self.former[fact as usize] = NONE;
        }
        for writers in &mut self.writers {
            writers.clear();
        }
        collect(model, propositions, operators, &links, &numeric)
    }

    fn link(
        &self,
        consumer: u32,
        fact: u32,
        value: bool,
        (used_up, from_start): (bool, bool),
        links: &mut Vec<Link>,
    ) {
        let index = fact as usize;
        let latest = self.producer[index];
        let producer = if latest == NONE || self.value[index] == value {
            latest
        } else {
            self.former[index]
        };
        if producer != NONE {
            links.push(Link {
                producer,
                consumer,
                fact,
                value,
                used_up,
                from_start,
            });
        }
    }

    fn write(&mut self, model: &Model, position: u32, fact: u32, value: bool) {
        let index = fact as usize;
        let before = if self.producer[index] == NONE {
            model.initial_facts[index]
        } else {
            self.value[index]
        };
        if before != value {
            if self.producer[index] == NONE {
                self.touched.push(fact);
            }
            self.former[index] = self.producer[index];
            self.producer[index] = position;
            self.value[index] = value;
        }
    }
}

fn collect(
    model: &Model,
    propositions: &Propositions,
    operators: &[u32],
    links: &[Link],
    numeric: &[(u32, u32)],
) -> Vec<Element> {
    let mut elements: Vec<Element> = operators
        .iter()
        .map(|operator| Element {
            operator: *operator,
            role: Role::Useless,
            primary: NONE,
            purposes: SmallVec::new(),
            consumers: SmallVec::new(),
        })
        .collect();
    let end = operators.len();
    // Both are sorted by consumer: going backwards, a consumer's role is final when it is met.
    let (mut links, mut numeric) = (links, numeric);
    for consumer in (0..=end).rev() {
        let of_links = links.partition_point(|link| (link.consumer as usize) < consumer);
        let of_numeric = numeric.partition_point(|(_, other)| (*other as usize) < consumer);
        let (before, here) = links.split_at(of_links);
        let (numeric_before, numeric_here) = numeric.split_at(of_numeric);
        (links, numeric) = (before, numeric_before);
        if consumer < end && elements[consumer].role == Role::Useless {
            continue;
        }
        for (producer, _) in numeric_here {
            let element = &mut elements[*producer as usize];
            if element.role == Role::Useless {
                element.role = Role::Transit;
            }
            element.consumers.push(Consumer {
                position: consumer as u32,
                proposition: NONE,
                follows: false,
            });
        }
        for link in here {
            let element = &mut elements[link.producer as usize];
            let role = if consumer == end {
                Role::Goal
            } else if link.used_up || model.shapes[element.operator as usize].envelope {
                Role::Transit
            } else {
                Role::Lasting
            };
            let rank = |role: Role| role as u8;
            let proposition = propositions.of_literal(link.fact, link.value);
            if element.primary == NONE || rank(role) > rank(element.role) {
                element.primary = proposition;
            }
            if rank(role) > rank(element.role) {
                element.role = role;
            }
            if !element.purposes.contains(&(link.fact, link.value)) {
                element.purposes.push((link.fact, link.value));
            }
            let supplies = |write: &&Write| write.fact == link.fact && write.value == link.value;
            let writes = model.writes(element.operator);
            element.consumers.push(Consumer {
                position: consumer as u32,
                proposition,
                follows: link.from_start
                    && model.window_of[link.fact as usize] == NONE
                    && writes
                        .iter()
                        .find(supplies)
                        .is_some_and(|write| write.at_end),
            });
        }
    }
    elements
}
