//! Reads plan text against a domain and a problem.

use super::parser::{WrittenStep, parse};
use super::{Plan, Step};
use crate::pddl::model::{Action, Domain, Problem};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::{Diagnostic, Diagnostics, has_errors};
use crate::syntax::source::SourceFile;
use crate::syntax::suggestion::nearest;
use crate::validate::{Names, Reason};

/// Reads a plan; `None` where a diagnostic is an error. Steps are sorted by start, equal starts keep
/// their order.
#[must_use]
pub fn read(
    source: &SourceFile,
    domain: &Domain,
    problem: &Problem,
) -> (Option<Plan>, Vec<Diagnostic>) {
    let mut diagnostics = Diagnostics::default();
    for fault in source.faults() {
        diagnostics.push(fault.clone());
    }
    let written = parse(source, &mut diagnostics);
    let names = Names::new(domain, problem);
    let mut steps = Vec::with_capacity(written.len());
    for one in &written {
        let mut step = step_of(one);
        match names.check(&step) {
            Ok(action) => {
                if action.duration.is_none() {
                    step.duration = None;
                }
            }
            Err(reason) => diagnostics.push(explain(one, &reason, domain, problem)),
        }
        steps.push(step);
    }
    steps.sort_by(|left, right| left.start.total_cmp(&right.start));
    let diagnostics = diagnostics.finish();
    let plan = (!has_errors(&diagnostics)).then_some(Plan { steps });
    (plan, diagnostics)
}

fn step_of(written: &WrittenStep) -> Step {
    Step {
        start: written.start,
        action: written.name.text.clone(),
        arguments: written
            .arguments
            .iter()
            .map(|word| word.text.clone())
            .collect(),
        duration: written.duration.map(|(duration, _)| duration),
    }
}

/// A diagnostic with the span that the reason speaks of.
fn explain(
    written: &WrittenStep,
    reason: &Reason,
    domain: &Domain,
    problem: &Problem,
) -> Diagnostic {
    let message = reason.to_string();
    let name = &written.name;
    let action = || -> Option<&Action> {
        domain
            .actions
            .iter()
            .find(|action| action.name.text == name.text)
    };
    match reason {
        Reason::UnknownAction(unknown) => {
            let known = domain.actions.iter().map(|one| one.name.text.as_str());
            Diagnostic::new(Code::UnknownAction, name.span, message)
                .label("no such action")
                .did_you_mean(nearest(unknown, known))
        }
        Reason::UnknownObject {
            position,
            name: unknown,
        } => {
            let known = problem.objects.iter().map(|one| one.name.text.as_str());
            Diagnostic::new(
                Code::UnknownObject,
                written.arguments[*position].span,
                message,
            )
            .label("no such object")
            .did_you_mean(nearest(unknown, known))
        }
        Reason::WrongArity { .. } => {
            let signature = action().map_or_else(String::new, |action| {
                let mut text = format!("({}", action.name.text);
                for parameter in &action.parameters {
                    text.push(' ');
                    text.push_str(&parameter.name.text);
                }
                text + ")"
            });
            Diagnostic::new(Code::WrongArity, written.span, message)
                .label("wrong number of arguments")
                .remedy(format!("write it as `{signature}`"))
        }
        Reason::WrongType { position, .. } => Diagnostic::new(
            Code::TypeMismatch,
            written.arguments[*position].span,
            message,
        )
        .label("not of this type"),
        Reason::BadTime(time) => {
            let span = match written.duration {
                Some((duration, span)) if written.start >= 0.0 && duration == *time => span,
                _ => written.start_span,
            };
            Diagnostic::new(Code::MalformedStep, span, message)
                .label("must not be negative")
                .remedy("times count in seconds from the start of the plan, which is 0")
        }
        Reason::UnexpectedDuration(_) => {
            let span = written.duration.map_or(written.span, |(_, span)| span);
            Diagnostic::new(Code::StepDuration, span, message)
                .label("the action takes no time")
                .remedy("leave the duration out")
        }
        _ => Diagnostic::new(Code::StepDuration, written.span, message)
            .label("lasts how long?")
            .remedy("write the duration in seconds behind the step, like `[5.000]`"),
    }
}
