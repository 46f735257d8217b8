//! Durations that can be zero, negative or infinite.

use super::Subject;
use super::walk::{self, Mention};
use crate::pddl::model::{Comparison, Domain, DurationConstraint, Expression, ExpressionKind};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::{Diagnostic, Diagnostics, Place};
use crate::syntax::span::Span;

/// Reports what the domain alone shows, and negative values in the problems.
pub(super) fn check(subject: &Subject<'_>, domain: &mut Diagnostics, problems: &mut [Diagnostics]) {
    for action in &subject.domain.actions {
        let Some(constraints) = &action.duration else {
            continue;
        };
        for constraint in constraints {
            constant_bound(constraint, domain);
        }
        let bounded = constraints
            .iter()
            .any(|constraint| constraint.comparison != Comparison::GreaterEqual);
        if !bounded {
            let span = constraints
                .first()
                .map_or(action.name.span, |constraint| constraint.span);
            domain.push(
                Diagnostic::new(
                    Code::UnboundedDuration,
                    span,
                    format!("`{}` may last forever", action.name.text),
                )
                .label("no upper limit")
                .remedy("add `(<= ?duration ...)`"),
            );
        }
    }
    negative_values(subject, problems);
}

fn constant_bound(constraint: &DurationConstraint, found: &mut Diagnostics) {
    let Some(value) = constant(&constraint.bound) else {
        return;
    };
    let upper = constraint.comparison != Comparison::GreaterEqual;
    if value < 0.0 && upper {
        found.push(
            Diagnostic::new(
                Code::NegativeDuration,
                constraint.bound.span,
                format!("a duration of {value} s is impossible"),
            )
            .label("negative")
            .remedy("durations are numbers of seconds from 0 on"),
        );
    } else if value == 0.0 && upper {
        found.push(
            Diagnostic::new(
                Code::ZeroDuration,
                constraint.bound.span,
                "this action takes no time",
            )
            .label("zero")
            .remedy("make it an `:action`, or give it a duration"),
        );
    }
}

/// The value of an expression of numbers only.
fn constant(expression: &Expression) -> Option<f64> {
    Some(match &expression.kind {
        ExpressionKind::Number(value) => *value,
        ExpressionKind::Negate(inner) => -constant(inner)?,
        ExpressionKind::Binary(operation, left, right) => {
            operation.apply(constant(left)?, constant(right)?)
        }
        _ => return None,
    })
}

/// Functions that are a whole bound of a duration and that nothing changes.
fn direct_durations(domain: &Domain) -> Vec<Option<Span>> {
    let mut uses: Vec<Option<Span>> = vec![None; domain.functions.len()];
    for constraint in domain
        .actions
        .iter()
        .flat_map(|a| a.duration.iter().flatten())
    {
        if let ExpressionKind::Fluent(fluent) = &constraint.bound.kind
            && constraint.comparison != Comparison::GreaterEqual
        {
            uses[fluent.function.index()].get_or_insert(constraint.span);
        }
    }
    walk::domain(domain, &mut |_, visit| {
        visit(&mut |mention| {
            if let Mention::Write(fluent) = mention {
                uses[fluent.function.index()] = None;
            }
        });
    });
    uses
}

fn negative_values(subject: &Subject<'_>, problems: &mut [Diagnostics]) {
    let uses = direct_durations(subject.domain);
    for (problem, found) in subject.problems.iter().zip(problems) {
        for (fluent, value) in &problem.fluents {
            let Some(span) = uses[fluent.function.index()].filter(|_| *value < 0.0) else {
                continue;
            };
            found.push(
                Diagnostic::new(
                    Code::NegativeDuration,
                    fluent.span,
                    format!("a duration of {value} s is impossible"),
                )
                .label("negative")
                .note_at(Place::Domain, span, "used as a duration here")
                .remedy("durations are numbers of seconds from 0 on"),
            );
        }
    }
}
