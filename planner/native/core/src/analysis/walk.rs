//! Visits everything that a condition, effect or expression mentions.

use crate::pddl::model::{
    Atom, Condition, ConditionKind, Domain, Effect, EffectKind, Expression, ExpressionKind,
    FluentTerm, ModuleCall, Parameter, Term,
};

/// One mention, in the order of the text.
#[derive(Clone, Copy)]
pub(super) enum Mention<'m> {
    /// A condition asks for an atom.
    Read(&'m Atom),
    /// The value of a fluent is used.
    Value(&'m FluentTerm),
    /// A module is called.
    Call(&'m ModuleCall),
    /// An effect makes an atom true.
    Add(&'m Atom),
    /// An effect makes an atom false.
    Delete(&'m Atom),
    /// An effect changes a fluent.
    Write(&'m FluentTerm),
    /// A variable or object stands somewhere.
    Term(Term),
    /// A quantifier begins.
    Enter(&'m [Parameter]),
    /// The innermost quantifier ends.
    Leave,
}

type Visitor<'v, 'm> = &'v mut dyn FnMut(Mention<'m>);

fn terms<'m>(arguments: &[Term], visit: Visitor<'_, 'm>) {
    for &term in arguments {
        visit(Mention::Term(term));
    }
}

/// Visits a condition.
pub(super) fn condition<'m>(condition: &'m Condition, visit: Visitor<'_, 'm>) {
    match &condition.kind {
        ConditionKind::And(parts) | ConditionKind::Or(parts) => {
            for part in parts {
                self::condition(part, visit);
            }
        }
        ConditionKind::Not(inner) => self::condition(inner, visit),
        ConditionKind::Imply(left, right) => {
            self::condition(left, visit);
            self::condition(right, visit);
        }
        ConditionKind::Forall(variables, body) | ConditionKind::Exists(variables, body) => {
            visit(Mention::Enter(variables));
            self::condition(body, visit);
            visit(Mention::Leave);
        }
        ConditionKind::Atom(atom) => {
            visit(Mention::Read(atom));
            terms(&atom.arguments, visit);
        }
        ConditionKind::Equal(left, right) => terms(&[*left, *right], visit),
        ConditionKind::Compare(_, left, right) => {
            expression(left, visit);
            expression(right, visit);
        }
        ConditionKind::Module(call) => {
            visit(Mention::Call(call));
            terms(&call.arguments, visit);
        }
    }
}

/// Visits an expression.
pub(super) fn expression<'m>(expression: &'m Expression, visit: Visitor<'_, 'm>) {
    match &expression.kind {
        ExpressionKind::Number(_) | ExpressionKind::Duration | ExpressionKind::TotalTime => {}
        ExpressionKind::Fluent(fluent) => {
            visit(Mention::Value(fluent));
            terms(&fluent.arguments, visit);
        }
        ExpressionKind::Module(call) => {
            visit(Mention::Call(call));
            terms(&call.arguments, visit);
        }
        ExpressionKind::Binary(_, left, right) => {
            self::expression(left, visit);
            self::expression(right, visit);
        }
        ExpressionKind::Negate(inner) => self::expression(inner, visit),
    }
}

/// Visits an effect.
pub(super) fn effect<'m>(effect: &'m Effect, visit: Visitor<'_, 'm>) {
    match &effect.kind {
        EffectKind::And(parts) => {
            for part in parts {
                self::effect(part, visit);
            }
        }
        EffectKind::Forall(variables, body) => {
            visit(Mention::Enter(variables));
            self::effect(body, visit);
            visit(Mention::Leave);
        }
        EffectKind::When(guard, body) => {
            condition(guard, visit);
            self::effect(body, visit);
        }
        EffectKind::TimedWhen(guards, body) => {
            for (_, guard) in guards {
                condition(guard, visit);
            }
            self::effect(body, visit);
        }
        EffectKind::Add(atom) => {
            visit(Mention::Add(atom));
            terms(&atom.arguments, visit);
        }
        EffectKind::Delete(atom) => {
            visit(Mention::Delete(atom));
            terms(&atom.arguments, visit);
        }
        EffectKind::Assign(_, target, value) => {
            visit(Mention::Write(target));
            terms(&target.arguments, visit);
            expression(value, visit);
        }
        EffectKind::Module(call) => {
            visit(Mention::Call(call));
            terms(&call.arguments, visit);
        }
    }
}

/// A part of a domain with variables of its own.
pub(super) struct Body<'m> {
    pub parameters: &'m [Parameter],
    /// What the parameters belong to, for messages.
    pub of: String,
    /// Whether every parameter has to be used: those of a rule are given by its predicate.
    pub free: bool,
}

/// Is given each body, and what walks through it.
type Begin<'b, 'm> = &'b mut dyn FnMut(Option<Body<'m>>, Walk<'_, 'm>);
/// Walks through one body.
type Walk<'w, 'm> = &'w mut dyn FnMut(Visitor<'_, 'm>);

/// Visits all actions, rules and module declarations of a domain; `begin` announces each.
pub(super) fn domain<'m>(domain: &'m Domain, begin: Begin<'_, 'm>) {
    for action in &domain.actions {
        let body = Body {
            parameters: &action.parameters,
            of: format!("action `{}`", action.name.text),
            free: true,
        };
        begin(Some(body), &mut |visit| {
            for constraint in action.duration.iter().flatten() {
                expression(&constraint.bound, visit);
            }
            for (_, part) in &action.conditions {
                condition(part, visit);
            }
            for (_, part) in &action.effects {
                effect(part, visit);
            }
        });
    }
    for rule in &domain.derived {
        let body = Body {
            parameters: &rule.parameters,
            of: "this rule".to_owned(),
            free: false,
        };
        begin(Some(body), &mut |visit| condition(&rule.condition, visit));
    }
    begin(None, &mut |visit| {
        for module in &domain.modules {
            for fluent in &module.writes {
                visit(Mention::Write(fluent));
            }
        }
    });
}
