//! What the delete relaxation of a problem shows: actions that never apply, durations that no time has.

use std::time::{Duration, Instant};

use super::Subject;
use super::goals;
use crate::attachment::{Arguments, Attachments, Purity, StateView};
use crate::grounding::{GroundingError, GroundingLimits, Relaxation};
use crate::pddl::model::{
    Action, ActionId, Atom, Condition, ConditionKind, Domain, ExpressionKind, ModuleId, ObjectId,
    Problem, TypeId,
};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::{Diagnostic, Diagnostics};

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

/// Reports actions that apply in no problem, impossible durations, and goals out of reach. Of
/// problems that are too large to be looked through in a few seconds it says so.
pub(super) fn check(subject: &Subject<'_>, domain: &mut Diagnostics, problems: &mut [Diagnostics]) {
    let mut relaxations = Vec::new();
    for (problem, found) in subject.problems.iter().zip(problems) {
        let limits = GroundingLimits {
            operators: OPERATORS,
            deadline: Some(Instant::now() + TIME),
            ..GroundingLimits::default()
        };
        let relaxation = Relaxation::new(subject.domain, problem, &Favourable, &limits);
        match &relaxation {
            Ok(relaxation) => goals::check(subject.domain, problem, relaxation, found),
            Err(error) => found.push(stopped(problem, error)),
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
        for (relaxation, problem) in known.iter().zip(subject.problems) {
            if let Some(found) = impossible_duration(action, id, relaxation, problem) {
                domain.push(found);
                break;
            }
        }
    }
}

fn stopped(problem: &Problem, error: &GroundingError) -> Diagnostic {
    let reason = match error {
        GroundingError::TimedOut => format!("it took longer than {} s", TIME.as_secs()),
        GroundingError::TooManyOperators { limit } => {
            format!("it has more than {limit} ground actions, or ten times as many candidates")
        }
        other => other.to_string(),
    };
    Diagnostic::new(
        Code::NotExamined,
        problem.name.span,
        format!(
            "`{}` was not searched for actions that never apply and goals out of reach: {reason}",
            problem.name.text
        ),
    )
    .label("only partly checked")
    .remedy("check the domain with a smaller problem, too")
}

fn ground_action(action: &Action, problem: &Problem, arguments: &[ObjectId]) -> String {
    let mut text = action.name.text.clone();
    for object in arguments {
        text.push(' ');
        text.push_str(&problem.objects[object.index()].name.text);
    }
    text
}

/// A computed duration that is negative or not finite; one that stands in the problem as it is
/// gets reported there.
fn impossible_duration(
    action: &Action,
    id: ActionId,
    relaxation: &Relaxation,
    problem: &Problem,
) -> Option<Diagnostic> {
    let (arguments, constraint, value_s) = relaxation.impossible_duration(id)?;
    let constraint = action.duration.as_ref()?.get(constraint)?;
    if matches!(
        constraint.bound.kind,
        ExpressionKind::Fluent(_) | ExpressionKind::Number(_)
    ) {
        return None;
    }
    let called = ground_action(action, problem, arguments);
    let (code, message, remedy) = if value_s < 0.0 && value_s.is_finite() {
        (
            Code::NegativeDuration,
            format!("`({called})` would last {value_s} s"),
            "durations are numbers of seconds from 0 on",
        )
    } else {
        (
            Code::InfiniteDuration,
            format!("the duration of `({called})` has no finite value"),
            "exclude a divisor of 0 by a condition, or mend the value in the problem",
        )
    };
    Some(
        Diagnostic::new(code, constraint.span, message)
            .label(format!("{value_s} in problem `{}`", problem.name.text))
            .remedy(remedy),
    )
}

fn takes_no_time(action: &Action, problem: &Problem, arguments: &[ObjectId]) -> Diagnostic {
    let constraint = action.duration.as_ref().and_then(|list| list.first());
    Diagnostic::new(
        Code::ZeroDuration,
        constraint.map_or(action.name.span, |constraint| constraint.span),
        format!(
            "`({})` takes no time",
            ground_action(action, problem, arguments)
        ),
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
