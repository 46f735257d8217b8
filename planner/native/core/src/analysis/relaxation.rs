//! What the delete relaxation of a problem never reaches: actions and goals.

use std::time::{Duration, Instant};

use super::Subject;
use crate::attachment::{Arguments, Attachments, Purity, StateView};
use crate::grounding::{GroundingLimits, Relaxation};
use crate::pddl::model::{
    Action, ActionId, Atom, Condition, ConditionKind, Domain, ModuleId, ObjectId, PredicateId,
    Problem, Term, TypeId,
};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::{Diagnostic, Diagnostics, Place};

/// Time spent on one problem: an author waits for it.
const TIME: Duration = Duration::from_secs(3);
/// Ground actions looked at.
const OPERATORS: usize = 300_000;

/// Attachments of which only the most favourable is assumed.
struct Favourable;

impl Attachments for Favourable {
    // A value that is not known when grounding may turn out either way.
    fn purity(&self, _: ModuleId) -> Purity {
        Purity::State
    }

    fn evaluate(
        &self,
        _: ModuleId,
        calls: &[Arguments],
        _: Option<&dyn StateView>,
    ) -> Result<Vec<f64>, (usize, String)> {
        Ok(vec![1.0; calls.len()])
    }

    fn apply(
        &self,
        _: ModuleId,
        _: &Arguments,
        _: &dyn StateView,
    ) -> Result<Option<Vec<f64>>, String> {
        Ok(None)
    }
}

/// Reports actions that apply in no problem, and goals out of reach. Problems that are too large
/// to be looked through in a few seconds are passed over.
pub(super) fn check(subject: &Subject<'_>, domain: &mut Diagnostics, problems: &mut [Diagnostics]) {
    let mut relaxations = Vec::new();
    for (problem, found) in subject.problems.iter().zip(problems) {
        let limits = GroundingLimits {
            operators: OPERATORS,
            deadline: Some(Instant::now() + TIME),
            ..GroundingLimits::default()
        };
        let relaxation = Relaxation::new(subject.domain, problem, &Favourable, &limits);
        if let Ok(relaxation) = &relaxation {
            goal(subject.domain, problem, relaxation, &problem.goal, found);
        }
        relaxations.push(relaxation.ok());
    }
    let Some(known) = relaxations.into_iter().collect::<Option<Vec<Relaxation>>>() else {
        return;
    };
    for (index, action) in subject.domain.actions.iter().enumerate() {
        let id = ActionId(index as u32);
        if !known.is_empty() && known.iter().all(|one| one.applications(id) == 0) {
            domain.push(never_applies(subject, &known, action));
        }
        for (relaxation, problem) in known.iter().zip(subject.problems) {
            if let Some(arguments) = relaxation.without_duration(id) {
                domain.push(takes_no_time(action, problem, arguments));
                break;
            }
        }
    }
}

fn takes_no_time(action: &Action, problem: &Problem, arguments: &[ObjectId]) -> Diagnostic {
    let constraint = action.duration.as_ref().and_then(|list| list.first());
    let names: Vec<&str> = arguments
        .iter()
        .map(|object| problem.objects[object.index()].name.text.as_str())
        .collect();
    Diagnostic::new(
        Code::ZeroDuration,
        constraint.map_or(action.name.span, |constraint| constraint.span),
        format!("`({} {})` takes no time", action.name.text, names.join(" ")),
    )
    .label(format!("0 s in problem `{}`", problem.name.text))
    .remedy("exclude such arguments by a condition, or give them a duration")
}

fn never_applies(subject: &Subject<'_>, known: &[Relaxation], action: &Action) -> Diagnostic {
    let mut diagnostic = Diagnostic::new(
        Code::ActionNeverApplies,
        action.name.span,
        format!("`{}` can never apply", action.name.text),
    )
    .label("even if nothing were ever deleted");
    let without_object = action.parameters.iter().find(|parameter| {
        subject
            .problems
            .iter()
            .all(|problem| !has_member(subject.domain, problem, &parameter.types))
    });
    if let Some(parameter) = without_object {
        return diagnostic
            .note(parameter.name.span, "no object has this type")
            .remedy("declare such an object in the problem");
    }
    let mut atoms = Vec::new();
    for (_, condition) in &action.conditions {
        positive_atoms(condition, &mut atoms);
    }
    let missing = atoms.iter().find(|atom| {
        known
            .iter()
            .all(|relaxation| relaxation.facts(atom.predicate) == 0)
    });
    diagnostic = match missing {
        Some(atom) => {
            let name = &subject.domain.predicates[atom.predicate.index()].name.text;
            diagnostic.note(atom.span, format!("no fact of `{name}` ever becomes true"))
        }
        None => match action.conditions.first() {
            Some((_, condition)) => diagnostic.note(
                condition.span,
                "no objects fulfil all conditions together, or the duration has no value for them",
            ),
            None => diagnostic,
        },
    };
    diagnostic.remedy("check the types of its parameters and what makes its conditions true")
}

fn has_member(domain: &Domain, problem: &Problem, types: &[TypeId]) -> bool {
    problem.objects.iter().any(|object| {
        let mut open = object.types.clone();
        while let Some(kind) = open.pop() {
            if types.contains(&kind) {
                return true;
            }
            open.extend(&domain.types[kind.index()].parents);
        }
        types.contains(&TypeId(0))
    })
}

fn positive_atoms<'m>(condition: &'m Condition, found: &mut Vec<&'m Atom>) {
    match &condition.kind {
        ConditionKind::And(parts) => parts.iter().for_each(|part| positive_atoms(part, found)),
        ConditionKind::Atom(atom) => found.push(atom),
        _ => {}
    }
}

/// Reports ground atoms of a goal that the relaxation does not reach.
fn goal(
    domain: &Domain,
    problem: &Problem,
    relaxation: &Relaxation,
    condition: &Condition,
    found: &mut Diagnostics,
) {
    match &condition.kind {
        ConditionKind::And(parts) => {
            for part in parts {
                goal(domain, problem, relaxation, part, found);
            }
        }
        ConditionKind::Atom(atom) if !reaches(relaxation, atom) => {
            found.push(unreachable(domain, problem, relaxation, atom));
        }
        ConditionKind::Or(parts) => {
            let mut missing = Vec::new();
            for part in parts {
                match &part.kind {
                    ConditionKind::Atom(atom) if !reaches(relaxation, atom) => missing.push(atom),
                    _ => return,
                }
            }
            for atom in missing {
                found.push(unreachable(domain, problem, relaxation, atom));
            }
        }
        _ => {}
    }
}

fn reaches(relaxation: &Relaxation, atom: &Atom) -> bool {
    let arguments: Option<Vec<ObjectId>> = atom
        .arguments
        .iter()
        .map(|term| match term {
            Term::Object(object) => Some(*object),
            Term::Variable(_) => None,
        })
        .collect();
    arguments.is_none_or(|arguments| relaxation.reaches(atom.predicate, &arguments))
}

fn unreachable(
    domain: &Domain,
    problem: &Problem,
    relaxation: &Relaxation,
    atom: &Atom,
) -> Diagnostic {
    let mut fact = domain.predicates[atom.predicate.index()].name.text.clone();
    for term in &atom.arguments {
        if let Term::Object(object) = term {
            fact.push(' ');
            fact.push_str(&problem.objects[object.index()].name.text);
        }
    }
    let diagnostic = Diagnostic::new(
        Code::UnreachableGoal,
        atom.span,
        format!("`({fact})` can never become true: the goal is out of reach"),
    )
    .label("no sequence of actions leads here");
    let makers: Vec<(usize, &Action)> = domain
        .actions
        .iter()
        .enumerate()
        .filter(|(_, action)| adds(action, atom.predicate))
        .collect();
    if makers.is_empty() {
        let declared = &domain.predicates[atom.predicate.index()].name;
        return diagnostic
            .note_at(Place::Domain, declared.span, "no action makes it true")
            .remedy("add an effect that makes it true, or put the fact into (:init ...)");
    }
    let (index, action) = makers[0];
    let applies = relaxation.applications(ActionId(index as u32)) > 0;
    let text = if applies {
        format!(
            "`{}` makes such facts true, but not this one",
            action.name.text
        )
    } else {
        format!(
            "`{}` would make it true, but can never apply",
            action.name.text
        )
    };
    diagnostic
        .note_at(Place::Domain, action.name.span, text)
        .remedy("check the initial facts that its conditions need")
}

fn adds(action: &Action, predicate: PredicateId) -> bool {
    let mut found = false;
    for (_, effect) in &action.effects {
        super::walk::effect(effect, &mut |mention| {
            if let super::walk::Mention::Add(atom) = mention {
                found |= atom.predicate == predicate;
            }
        });
    }
    found
}
