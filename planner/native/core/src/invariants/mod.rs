//! Mutex groups by invariant synthesis: sets of facts of which at most one is ever true.
//!
//! A candidate is a set of predicates, each with at most one *counted* argument, whose other
//! arguments identify a group: `{at r *}`, or `{at r *, on r *}` for robots that are carried. It is
//! an invariant if no operator can raise the number of true facts of a group. A durative operator
//! may take the group's fact away at its start and give one back at its end. Candidates that fail
//! are refined by a predicate that the offending operator consumes.
//!
//! Source: Helmert, "Concise finite-domain representations for PDDL planning tasks", Artificial
//! Intelligence 173, 2009, section 5, checked here on ground operators instead of schemas.

mod candidate;

use std::collections::{HashSet, VecDeque};

use rustc_hash::FxHashMap;

use crate::pddl::model::ObjectId;
use crate::task::{Change, FactId, GroundEffect, Operator, Task};

use candidate::{Candidate, Part};

/// Candidates looked at before giving up.
const CANDIDATES: usize = 300;
/// Steps after which no further candidate is begun; some 50 ms.
const WORK: usize = 5_000_000;

/// Groups of two or more facts, largest first.
#[must_use]
pub fn synthesise(task: &Task) -> Vec<Vec<FactId>> {
    let changes: Vec<Changes> = task.operators.iter().map(Changes::of).collect();
    let mut unfit = unfit_predicates(task);
    unfit.insert(u32::MAX);
    let mut open: VecDeque<Candidate> = initial_candidates(task, &unfit).into();
    let mut seen: HashSet<Candidate> = open.iter().cloned().collect();
    let mut groups = Vec::new();
    let mut work = 0;
    let mut examined = 0;
    while let Some(candidate) = open.pop_front() {
        examined += 1;
        if examined > CANDIDATES || work > WORK {
            break;
        }
        let membership = Membership::new(task, &candidate);
        match first_threat(&changes, &membership, &mut work) {
            None => membership.collect(task, &mut groups),
            Some(threat) => {
                for refined in refinements(task, &candidate, &changes[threat.operator], threat.fact)
                {
                    let fits = refined
                        .parts
                        .iter()
                        .all(|p| !unfit.contains(&p.predicate.0));
                    if fits && seen.insert(refined.clone()) {
                        open.push_back(refined);
                    }
                }
            }
        }
    }
    groups.sort_by(|left, right| right.len().cmp(&left.len()).then(left.cmp(right)));
    groups.dedup();
    groups
}

/// Leaves out operators that need two facts of one group at once.
pub fn prune_mutex_conditions(task: &mut Task) {
    let mut groups_of: Vec<Vec<u32>> = vec![Vec::new(); task.facts.len()];
    for (index, group) in task.mutex_groups.iter().enumerate() {
        for fact in group {
            groups_of[fact.index()].push(index as u32);
        }
    }
    let clash = |facts: &[FactId]| {
        facts.iter().enumerate().any(|(index, left)| {
            facts[index + 1..].iter().any(|right| {
                groups_of[left.index()]
                    .iter()
                    .any(|group| groups_of[right.index()].contains(group))
            })
        })
    };
    task.operators.retain(|operator| {
        !clash(&operator.start_condition.positive) && !clash(&operator.invariant.positive)
    });
    task.unsolvable |= clash(&task.goal.positive);
}

/// What an operator consumes (needs and deletes) and adds at its two ends.
struct Changes {
    start_consumed: Vec<FactId>,
    start_added: Vec<FactId>,
    end_consumed: Vec<FactId>,
    end_added: Vec<FactId>,
}

impl Changes {
    fn of(operator: &Operator) -> Self {
        let consumed = |needed: &[&[FactId]], effects: &[GroundEffect]| {
            let deleted = effects.iter().filter(|effect| effect.condition.is_none());
            deleted
                .filter_map(|effect| match effect.change {
                    Change::Delete(fact) => Some(fact),
                    _ => None,
                })
                .filter(|fact| needed.iter().any(|list| list.contains(fact)))
                // What is deleted and added at once stays true.
                .filter(|fact| !effects.iter().any(|e| e.change == Change::Add(*fact)))
                .collect::<Vec<_>>()
        };
        let added = |effects: &[GroundEffect], given: &[FactId]| {
            effects
                .iter()
                .filter_map(|effect| match effect.change {
                    Change::Add(fact) => Some(fact),
                    _ => None,
                })
                .filter(|fact| !given.contains(fact))
                .collect::<Vec<_>>()
        };
        Self {
            start_consumed: consumed(
                &[&operator.start_condition.positive],
                &operator.start_effects,
            ),
            start_added: added(&operator.start_effects, &operator.start_condition.positive),
            end_consumed: consumed(
                &[
                    &operator.invariant.positive,
                    &operator.end_condition.positive,
                ],
                &operator.end_effects,
            ),
            end_added: added(&operator.end_effects, &operator.end_condition.positive),
        }
    }
}

/// Predicates that axioms or timed literals make true at will.
fn unfit_predicates(task: &Task) -> HashSet<u32> {
    let axioms = task.axioms.iter().map(|axiom| axiom.head);
    let timed = task.timed.iter().filter_map(|event| match event.change {
        Change::Add(fact) => Some(fact),
        _ => None,
    });
    axioms
        .chain(timed)
        .map(|fact| task.atoms[fact.index()].0.0)
        .collect()
}

fn initial_candidates(task: &Task, unfit: &HashSet<u32>) -> Vec<Candidate> {
    let mut seen = HashSet::new();
    let mut candidates = Vec::new();
    for (predicate, arguments) in &task.atoms {
        if unfit.contains(&predicate.0) || !seen.insert(*predicate) {
            continue;
        }
        for counted in (0..arguments.len()).map(Some).chain([None]) {
            let fixed = (0..arguments.len())
                .filter(|&p| Some(p) != counted)
                .collect();
            candidates.push(Candidate::new(Part {
                predicate: *predicate,
                counted,
                fixed,
            }));
        }
    }
    candidates
}

/// Which group of a candidate each fact belongs to.
struct Membership {
    group_of: Vec<u32>,
    groups: usize,
}

const NO_GROUP: u32 = u32::MAX;

impl Membership {
    fn new(task: &Task, candidate: &Candidate) -> Self {
        let mut numbers: FxHashMap<Vec<ObjectId>, u32> = FxHashMap::default();
        let group_of = task
            .atoms
            .iter()
            .map(
                |(predicate, arguments)| match candidate.key(*predicate, arguments) {
                    None => NO_GROUP,
                    Some(key) => {
                        let next = numbers.len() as u32;
                        *numbers.entry(key).or_insert(next)
                    }
                },
            )
            .collect();
        Self {
            group_of,
            groups: numbers.len(),
        }
    }

    fn of(&self, fact: FactId) -> u32 {
        self.group_of[fact.index()]
    }

    fn count(&self, facts: &[FactId], group: u32) -> usize {
        facts.iter().filter(|fact| self.of(**fact) == group).count()
    }

    /// Adds the groups that hold at most one fact at first.
    fn collect(&self, task: &Task, groups: &mut Vec<Vec<FactId>>) {
        let mut members = vec![Vec::new(); self.groups];
        for (fact, &group) in self.group_of.iter().enumerate() {
            if group != NO_GROUP {
                members[group as usize].push(FactId(fact as u32));
            }
        }
        let mut initially = vec![0; self.groups];
        for &fact in &task.initial_facts {
            if self.of(fact) != NO_GROUP {
                initially[self.of(fact) as usize] += 1;
            }
        }
        for (group, count) in members.into_iter().zip(initially) {
            if count <= 1 && group.len() > 1 {
                groups.push(group);
            }
        }
    }
}

struct Threat {
    operator: usize,
    fact: FactId,
}

/// The first operator that may add a fact to a group without having taken one out.
fn first_threat(changes: &[Changes], membership: &Membership, work: &mut usize) -> Option<Threat> {
    for (operator, change) in changes.iter().enumerate() {
        *work += change.start_added.len() + change.end_added.len() + 1;
        for &fact in &change.start_added {
            let group = membership.of(fact);
            if group == NO_GROUP {
                continue;
            }
            let taken = membership.count(&change.start_consumed, group);
            if taken == 0 || membership.count(&change.start_added, group) > 1 {
                return Some(Threat { operator, fact });
            }
        }
        for &fact in &change.end_added {
            let group = membership.of(fact);
            if group == NO_GROUP {
                continue;
            }
            let replaced = membership.count(&change.end_consumed, group) > 0;
            let held = membership.count(&change.start_consumed, group) > 0
                && membership.count(&change.start_added, group) == 0;
            if membership.count(&change.end_added, group) > 1 || !(replaced || held) {
                return Some(Threat { operator, fact });
            }
        }
    }
    None
}

/// Candidates extended by a predicate that the offending operator consumes.
fn refinements(
    task: &Task,
    candidate: &Candidate,
    changes: &Changes,
    fact: FactId,
) -> Vec<Candidate> {
    let (predicate, arguments) = &task.atoms[fact.index()];
    let Some(key) = candidate.key(*predicate, arguments) else {
        return Vec::new();
    };
    changes
        .start_consumed
        .iter()
        .chain(&changes.end_consumed)
        .filter_map(|consumed| {
            let (predicate, arguments) = &task.atoms[consumed.index()];
            candidate.extended(*predicate, arguments, &key)
        })
        .collect()
}
