//! Goals that the delete relaxation shows to be out of reach.

use crate::grounding::Relaxation;
use crate::pddl::model::{
    Action, ActionId, Atom, Condition, ConditionKind, Domain, ObjectId, Parameter, PredicateId,
    Problem, Term, TimedChange, TypeId,
};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::{Diagnostic, Diagnostics, Place};

use super::walk::{self, Mention};

/// Ground conditions looked at for one goal.
const CONDITIONS: usize = 200_000;
/// Missing facts kept for one part of a goal.
const MISSING: usize = 10;

/// Reports every part of a goal that can never hold, with the facts that are missing.
pub(super) fn check(
    domain: &Domain,
    problem: &Problem,
    relaxation: &Relaxation,
    found: &mut Diagnostics,
) {
    let mut goal = Goal {
        domain,
        problem,
        relaxation,
        left: CONDITIONS,
    };
    goal.report(&problem.goal, found);
    if goal.left == 0 {
        found.push(
            Diagnostic::new(
                Code::NotExamined,
                problem.goal.span,
                format!("only {CONDITIONS} instances of the goal's quantifiers were examined"),
            )
            .label("only partly checked"),
        );
    }
}

/// A fact that the goal asks for, or forbids, and that no plan brings about.
struct Missing<'m> {
    atom: &'m Atom,
    arguments: Vec<ObjectId>,
    /// False for a fact that would have to be false.
    wanted: bool,
}

struct Goal<'m> {
    domain: &'m Domain,
    problem: &'m Problem,
    relaxation: &'m Relaxation,
    left: usize,
}

impl<'m> Goal<'m> {
    fn report(&mut self, condition: &'m Condition, found: &mut Diagnostics) {
        if let ConditionKind::And(parts) = &condition.kind {
            for part in parts {
                self.report(part, found);
            }
            return;
        }
        let Some(missing) = self.missing(condition, true, &mut Vec::new()) else {
            return;
        };
        if missing.is_empty() {
            found.push(
                Diagnostic::new(
                    Code::UnreachableGoal,
                    condition.span,
                    "this can never hold: the goal is out of reach",
                )
                .label("false for all objects of the problem")
                .remedy("check the objects and their types"),
            );
        }
        for one in &missing {
            found.push(self.unreachable(one));
        }
    }

    /// What is missing for a condition (or its negation) that can never hold; `None` if it may.
    fn missing(
        &mut self,
        condition: &'m Condition,
        positive: bool,
        bindings: &mut Vec<ObjectId>,
    ) -> Option<Vec<Missing<'m>>> {
        if self.left == 0 {
            return None;
        }
        self.left -= 1;
        match &condition.kind {
            ConditionKind::And(parts) | ConditionKind::Or(parts) => {
                let all = matches!(condition.kind, ConditionKind::And(_)) == positive;
                let each = parts.iter().map(|part| (part, positive));
                self.connected(each, all, bindings)
            }
            ConditionKind::Not(inner) => self.missing(inner, !positive, bindings),
            ConditionKind::Imply(left, right) => {
                let each = [(&**left, !positive), (&**right, positive)];
                self.connected(each.into_iter(), !positive, bindings)
            }
            ConditionKind::Forall(variables, body) => {
                self.quantified(variables, body, positive, positive, bindings)
            }
            ConditionKind::Exists(variables, body) => {
                self.quantified(variables, body, positive, !positive, bindings)
            }
            ConditionKind::Atom(atom) => self.fact(atom, positive, bindings),
            ConditionKind::Equal(left, right) => {
                let same = value_of(*left, bindings) == value_of(*right, bindings);
                (same != positive).then(Vec::new)
            }
            ConditionKind::Compare(..) | ConditionKind::Module(_) => None,
        }
    }

    /// A conjunction (`all`) fails with any of its parts, a disjunction with all of them.
    fn connected(
        &mut self,
        parts: impl Iterator<Item = (&'m Condition, bool)>,
        all: bool,
        bindings: &mut Vec<ObjectId>,
    ) -> Option<Vec<Missing<'m>>> {
        let mut verdict = Verdict::new(all);
        for (part, positive) in parts {
            if verdict.add(self.missing(part, positive, bindings)) {
                break;
            }
        }
        verdict.close()
    }

    fn quantified(
        &mut self,
        variables: &'m [Parameter],
        body: &'m Condition,
        positive: bool,
        all: bool,
        bindings: &mut Vec<ObjectId>,
    ) -> Option<Vec<Missing<'m>>> {
        let Some((first, others)) = variables.split_first() else {
            return self.missing(body, positive, bindings);
        };
        let mut verdict = Verdict::new(all);
        for index in 0..self.problem.objects.len() {
            let object = ObjectId(index as u32);
            if !is_member(self.domain, self.problem, object, &first.types) {
                continue;
            }
            bindings.push(object);
            let part = self.quantified(others, body, positive, all, bindings);
            bindings.pop();
            if verdict.add(part) {
                break;
            }
        }
        // Bindings that were not looked at may be the ones that hold.
        if self.left == 0 && !all {
            return None;
        }
        verdict.close()
    }

    fn fact(
        &self,
        atom: &'m Atom,
        wanted: bool,
        bindings: &[ObjectId],
    ) -> Option<Vec<Missing<'m>>> {
        let arguments: Vec<ObjectId> = atom
            .arguments
            .iter()
            .map(|&term| value_of(term, bindings))
            .collect();
        let possible = if wanted {
            self.relaxation.reaches(atom.predicate, &arguments)
        } else {
            !self.stays_true(atom.predicate, &arguments)
        };
        (!possible).then(|| {
            vec![Missing {
                atom,
                arguments,
                wanted,
            }]
        })
    }

    /// Whether a fact is true at first and nothing that can happen deletes any fact of its predicate.
    fn stays_true(&self, predicate: PredicateId, arguments: &[ObjectId]) -> bool {
        let derived = self.domain.derived.iter();
        let timed = self.problem.timed.iter();
        self.problem
            .facts
            .iter()
            .any(|fact| fact.predicate == predicate && fact.arguments == arguments)
            && !derived.into_iter().any(|rule| rule.predicate == predicate)
            && !timed.into_iter().any(
                |one| matches!(&one.change, TimedChange::Delete(fact) if fact.predicate == predicate),
            )
            && self.domain.actions.iter().enumerate().all(|(index, action)| {
                self.relaxation.applications(ActionId(index as u32)) == 0
                    || !changes(action, predicate, false)
            })
    }

    fn unreachable(&self, missing: &Missing<'_>) -> Diagnostic {
        let mut fact = self.domain.predicates[missing.atom.predicate.index()]
            .name
            .text
            .clone();
        for object in &missing.arguments {
            fact.push(' ');
            fact.push_str(&self.problem.objects[object.index()].name.text);
        }
        let value = if missing.wanted { "true" } else { "false" };
        let diagnostic = Diagnostic::new(
            Code::UnreachableGoal,
            missing.atom.span,
            format!("`({fact})` can never become {value}: the goal is out of reach"),
        )
        .label("no sequence of actions leads here");
        let predicate = missing.atom.predicate;
        let maker = self
            .domain
            .actions
            .iter()
            .enumerate()
            .find(|(_, action)| changes(action, predicate, missing.wanted));
        let Some((index, action)) = maker else {
            let declared = &self.domain.predicates[predicate.index()].name;
            let remedy = if missing.wanted {
                "add an effect that makes it true, or put the fact into (:init ...)"
            } else {
                "add an effect that makes it false, or take the fact out of (:init ...)"
            };
            return diagnostic
                .note_at(
                    Place::Domain,
                    declared.span,
                    format!("no action makes it {value}"),
                )
                .remedy(remedy);
        };
        let name = &action.name.text;
        let text = if self.relaxation.applications(ActionId(index as u32)) > 0 {
            format!("`{name}` makes such facts {value}, but not this one")
        } else {
            format!("`{name}` would make it {value}, but can never apply")
        };
        diagnostic
            .note_at(Place::Domain, action.name.span, text)
            .remedy("check the initial facts that its conditions need")
    }
}

/// Collects what is missing in the parts of a condition.
struct Verdict<'m> {
    all: bool,
    /// Whether a part was found that settles it.
    settled: bool,
    missing: Vec<Missing<'m>>,
}

impl<'m> Verdict<'m> {
    const fn new(all: bool) -> Self {
        Self {
            all,
            settled: false,
            missing: Vec::new(),
        }
    }

    /// Takes a part; true if the others need not be looked at.
    fn add(&mut self, part: Option<Vec<Missing<'m>>>) -> bool {
        match part {
            Some(missing) => {
                self.settled |= self.all;
                let room = MISSING.saturating_sub(self.missing.len());
                self.missing.extend(missing.into_iter().take(room));
                self.all && self.missing.len() == MISSING
            }
            None => {
                self.settled |= !self.all;
                !self.all
            }
        }
    }

    /// `None` if the condition may hold: a conjunction without a missing part, a disjunction with
    /// a part that may.
    fn close(self) -> Option<Vec<Missing<'m>>> {
        (self.settled == self.all).then_some(self.missing)
    }
}

fn value_of(term: Term, bindings: &[ObjectId]) -> ObjectId {
    match term {
        Term::Variable(variable) => bindings[variable.index()],
        Term::Object(object) => object,
    }
}

fn is_member(domain: &Domain, problem: &Problem, object: ObjectId, types: &[TypeId]) -> bool {
    let mut open = problem.objects[object.index()].types.clone();
    while let Some(kind) = open.pop() {
        if types.contains(&kind) {
            return true;
        }
        open.extend(&domain.types[kind.index()].parents);
    }
    types.contains(&TypeId(0))
}

/// Whether an action has an effect that makes facts of a predicate true (or false).
fn changes(action: &Action, predicate: PredicateId, value: bool) -> bool {
    let mut found = false;
    for (_, effect) in &action.effects {
        walk::effect(effect, &mut |mention| match mention {
            Mention::Add(atom) => found |= value && atom.predicate == predicate,
            Mention::Delete(atom) => found |= !value && atom.predicate == predicate,
            _ => {}
        });
    }
    found
}
