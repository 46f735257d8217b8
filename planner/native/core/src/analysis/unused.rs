//! Declarations without use, effects that nothing reads, predicates that are never true.

use super::Subject;
use super::usage::{Usage, mentioned_objects};
use super::walk::{self, Mention};
use crate::pddl::model::{Name, Parameter, Problem, Term};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::{Diagnostic, Diagnostics};

/// Reports them.
pub(super) fn check(subject: &Subject<'_>, domain: &mut Diagnostics, problems: &mut [Diagnostics]) {
    let usage = Usage::new(subject);
    declarations(subject, &usage, domain);
    variables(subject, domain);
    for (problem, found) in subject.problems.iter().zip(problems) {
        objects(subject, problem, found);
    }
}

fn unused(code: Code, what: &str, name: &Name) -> Diagnostic {
    Diagnostic::new(
        code,
        name.span,
        format!("{what} `{}` is never used", name.text),
    )
    .label("declared here only")
    .remedy("remove the declaration, or use it")
}

fn declarations(subject: &Subject<'_>, usage: &Usage, found: &mut Diagnostics) {
    let domain = subject.domain;
    let with_problems = !subject.problems.is_empty();
    // Attachments see the whole state: what has a value may be there for them.
    let attachments = !domain.modules.is_empty();
    let seen = |initial: bool| attachments && (initial || !with_problems);
    for (declared, used) in domain.predicates.iter().zip(&usage.predicates) {
        let name = &declared.name;
        let changed = used.added.or(used.deleted);
        match changed {
            None if !used.read && !seen(used.initial) => {
                found.push(unused(Code::UnusedDeclaration, "predicate", name));
            }
            Some(effect) if !used.read && with_problems && !attachments => found.push(
                Diagnostic::new(
                    Code::EffectNeverRead,
                    effect,
                    format!(
                        "`{}` is set, but no condition, rule or goal asks for it",
                        name.text
                    ),
                )
                .label("has no consequence")
                .note(name.span, "declared here")
                .remedy("remove the effect, or ask for it in a condition"),
            ),
            _ if used.read && used.added.is_none() && !used.initial && with_problems => {
                found.push(never_true(name));
            }
            _ => {}
        }
    }
    for (declared, used) in domain.functions.iter().zip(&usage.functions) {
        let name = &declared.name;
        match used.written {
            None if !used.read && !seen(used.initial) => {
                found.push(unused(Code::UnusedDeclaration, "function", name));
            }
            Some(effect)
                if !used.read && with_problems && !attachments && name.text != "total-cost" =>
            {
                found.push(
                    Diagnostic::new(
                        Code::EffectNeverRead,
                        effect,
                        format!(
                            "`{}` changes, but no condition, duration or metric uses it",
                            name.text
                        ),
                    )
                    .label("has no consequence")
                    .note(name.span, "declared here")
                    .remedy("remove the effect, or use the value"),
                )
            }
            _ => {}
        }
    }
    for (module, &used) in domain.modules.iter().zip(&usage.modules) {
        if !used {
            found.push(unused(Code::UnusedDeclaration, "module", &module.name));
        }
    }
    for (constant, &used) in domain.constants.iter().zip(&usage.constants) {
        if !used && with_problems {
            found.push(unused(Code::UnusedObject, "constant", &constant.name));
        }
    }
}

fn never_true(name: &Name) -> Diagnostic {
    Diagnostic::new(
        Code::NeverTrue,
        name.span,
        format!("`{}` is never true", name.text),
    )
    .label("asked for, but no effect, rule or initial state makes it true")
    .remedy("add an effect or initial facts, or remove the condition")
}

fn objects(subject: &Subject<'_>, problem: &Problem, found: &mut Diagnostics) {
    let mut used = vec![false; problem.objects.len()];
    for index in mentioned_objects(problem) {
        used[index] = true;
    }
    let constants = subject.domain.constants.len();
    for (object, _) in problem
        .objects
        .iter()
        .zip(&used)
        .skip(constants)
        .filter(|&(_, &used)| !used)
    {
        found.push(
            Diagnostic::new(
                Code::UnusedObject,
                object.name.span,
                format!("object `{}` is mentioned nowhere else", object.name.text),
            )
            .label("neither in the initial state nor in the goal")
            .remedy("remove it, or say where it is"),
        );
    }
}

/// Parameters and quantified variables that their body does not mention.
fn variables(subject: &Subject<'_>, found: &mut Diagnostics) {
    walk::domain(subject.domain, &mut |body, visit| {
        let Some(body) = body else { return };
        let mut scope: Vec<(&Parameter, bool)> = body
            .parameters
            .iter()
            .map(|parameter| (parameter, !body.free))
            .collect();
        let mut levels = Vec::new();
        let mut report = |parameter: &Parameter, of: &str| {
            found.push(
                Diagnostic::new(
                    Code::UnusedVariable,
                    parameter.name.span,
                    format!("{of} does not use `{}`", parameter.name.text),
                )
                .label("multiplies the ground actions for nothing")
                .remedy("remove it, or use it in a condition"),
            );
        };
        visit(&mut |mention| match mention {
            Mention::Term(Term::Variable(variable)) => scope[variable.index()].1 = true,
            Mention::Enter(variables) => {
                levels.push(scope.len());
                scope.extend(variables.iter().map(|variable| (variable, false)));
            }
            Mention::Leave => {
                let outside = levels.pop().unwrap_or_default();
                for (parameter, used) in scope.drain(outside..) {
                    if !used {
                        report(parameter, "the quantifier");
                    }
                }
            }
            _ => {}
        });
        for (parameter, used) in scope {
            if !used {
                report(parameter, &body.of);
            }
        }
    });
}
