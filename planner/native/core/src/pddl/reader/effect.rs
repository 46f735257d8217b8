//! Effects, untimed and timed.

use super::condition::by_time;
use super::names::lower;
use super::requirements::Feature;
use super::scope::Reader;
use super::time::specifier;
use crate::pddl::model::{
    Assignment, Atom, Condition, ConditionKind, Effect, EffectKind, ModuleKind, When,
};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::tree::{Node, NodeKind};

fn assignment(word: &str) -> Option<Assignment> {
    Some(match word {
        "assign" => Assignment::Assign,
        "increase" => Assignment::Increase,
        "decrease" => Assignment::Decrease,
        "scale-up" => Assignment::ScaleUp,
        "scale-down" => Assignment::ScaleDown,
        _ => return None,
    })
}

impl Reader<'_> {
    /// An effect without times.
    pub fn effect(&mut self, node: Node<'_>) -> Option<Effect> {
        let kind = match node.kind() {
            NodeKind::Call => EffectKind::Module(self.module_call(node, ModuleKind::Effect)?),
            NodeKind::Word => {
                self.sink.expected(node.span(), "an effect", Some(node));
                return None;
            }
            NodeKind::List => self.effect_list(node)?,
        };
        Some(Effect {
            kind,
            span: node.span(),
        })
    }

    fn effect_list(&mut self, node: Node<'_>) -> Option<EffectKind> {
        let Some(head) = node.head() else {
            return Some(EffectKind::And(Vec::new()));
        };
        if head.word().is_none() {
            let alone = node.children().count() == 1;
            if alone && head.kind() == NodeKind::Call {
                let call = self.module_call(head, ModuleKind::Effect)?;
                return Some(EffectKind::Module(call));
            }
            self.sink
                .expected(head.span(), "a predicate, `and` or `not`", Some(head));
            return None;
        }
        let name = lower(head.text());
        match name.as_ref() {
            "and" => Some(EffectKind::And(
                node.children()
                    .skip(1)
                    .filter_map(|part| self.effect(part))
                    .collect(),
            )),
            "forall" => {
                self.uses(Feature::ConditionalEffects, head);
                let [variables, body] = self.operands(node)?;
                let variables = self.quantified(Some(variables), node.span())?;
                let body = self.bound(&variables, |reader| reader.effect(body))?;
                Some(EffectKind::Forall(variables, Box::new(body)))
            }
            "when" => {
                self.uses(Feature::ConditionalEffects, head);
                let [condition, body] = self.operands(node)?;
                let (condition, body) = (self.condition(condition), self.effect(body));
                Some(EffectKind::When(condition?, Box::new(body?)))
            }
            "not" => {
                let [inner] = self.operands(node)?;
                if inner.head().is_none_or(|head| head.word().is_none()) {
                    self.sink
                        .expected(inner.span(), "an atom such as `(p ?x)`", Some(inner));
                    return None;
                }
                self.changed_atom(inner).map(EffectKind::Delete)
            }
            "or" | "imply" | "exists" | "=" | "<" | "<=" | ">" | ">=" => {
                let mut diagnostic = Diagnostic::new(
                    Code::Malformed,
                    node.span(),
                    format!("`{name}` is a condition and no effect"),
                )
                .label("no effect");
                if name == "=" {
                    diagnostic = diagnostic.remedy("write `(assign (f) value)`");
                }
                self.sink.push(diagnostic);
                None
            }
            word => {
                if let Some(how) = assignment(word) {
                    return self.numeric_effect(node, head, how);
                }
                if specifier(node).is_some() {
                    self.unexpected_time(node);
                    return None;
                }
                self.changed_atom(node).map(EffectKind::Add)
            }
        }
    }

    fn unexpected_time(&mut self, node: Node<'_>) {
        self.sink.push(
            Diagnostic::new(
                Code::UnexpectedTime,
                node.span(),
                "a time where none belongs",
            )
            .label("only the outside of a durative action's effects has times")
            .remedy("remove the time specifier, or make the action a `:durative-action`"),
        );
    }

    fn numeric_effect(
        &mut self,
        node: Node<'_>,
        head: Node<'_>,
        how: Assignment,
    ) -> Option<EffectKind> {
        self.uses(Feature::NumericFluents, head);
        let [target, value] = self.operands(node)?;
        if target.kind() == NodeKind::Call {
            self.sink
                .expected(target.span(), "a numeric fluent", Some(target));
            return None;
        }
        let known =
            target.word().is_some() || target.head().is_some_and(|head| head.word().is_some());
        if !known {
            self.sink
                .expected(target.span(), "a numeric fluent", Some(target));
        }
        let target = if known { self.fluent(target) } else { None };
        let value = self.expression(value);
        Some(EffectKind::Assign(how, target?, value?))
    }

    /// An atom that an effect makes true or false.
    pub fn changed_atom(&mut self, node: Node<'_>) -> Option<Atom> {
        let atom = self.atom(node)?;
        let declaration = &self.domain.predicates[atom.predicate.index()];
        if declaration.derived {
            self.sink.push(
                Diagnostic::new(
                    Code::DerivedChanged,
                    node.span(),
                    format!(
                        "`{}` is derived and cannot be changed",
                        declaration.name.text
                    ),
                )
                .label("set here")
                .note_at(self.domain_place, declaration.name.span, "derived by rules")
                .remedy("change what the rules depend on"),
            );
            return None;
        }
        Some(atom)
    }

    /// The effects of a durative action, each with its time.
    pub fn timed_effect(&mut self, node: Node<'_>, out: &mut Vec<(When, Effect)>) {
        if let Some((when, inner)) = specifier(node) {
            if when == When::OverAll {
                self.sink.push(
                    Diagnostic::new(
                        Code::UnexpectedTime,
                        node.span(),
                        "an effect cannot last over all",
                    )
                    .label("effects happen at the start or at the end")
                    .remedy("write `(at start ...)` or `(at end ...)`"),
                );
                return;
            }
            if let Some(effect) = self.effect(inner) {
                out.push((when, effect));
            }
            return;
        }
        let head = node.head();
        let name = head.map_or_else(String::new, |head| head.text().to_ascii_lowercase());
        match name.as_str() {
            "" if node.is_list() => {}
            "and" => {
                for part in node.children().skip(1) {
                    self.timed_effect(part, out);
                }
            }
            "forall" => self.timed_forall_effect(node, out),
            "when" => self.timed_when(node, out),
            "increase" | "decrease" if has_continuous_time(node) => {
                // Reading the expression reports `#t` itself.
                self.effect(node);
            }
            _ => self.missing_time(node, "effect", "at end"),
        }
    }

    fn timed_forall_effect(&mut self, node: Node<'_>, out: &mut Vec<(When, Effect)>) {
        self.uses(Feature::ConditionalEffects, node.head().unwrap_or(node));
        let Some([variables, body]) = self.operands(node) else {
            return;
        };
        let Some(variables) = self.quantified(Some(variables), node.span()) else {
            return;
        };
        let mut inner = Vec::new();
        self.bound(&variables, |reader| reader.timed_effect(body, &mut inner));
        for (when, effects) in by_time(inner) {
            let effect = all_of(effects, body);
            let kind = EffectKind::Forall(variables.clone(), Box::new(effect));
            let span = node.span();
            out.push((when, Effect { kind, span }));
        }
    }

    /// `(when (at start c) (at end e))`.
    fn timed_when(&mut self, node: Node<'_>, out: &mut Vec<(When, Effect)>) {
        self.uses(Feature::ConditionalEffects, node.head().unwrap_or(node));
        let Some([condition, body]) = self.operands(node) else {
            return;
        };
        let mut conditions = Vec::new();
        self.timed_condition(condition, &mut conditions);
        let mut inner = Vec::new();
        self.timed_effect(body, &mut inner);
        let span = node.span();
        for (when, effects) in by_time(inner) {
            let effect = all_of(effects, body);
            let same_time = conditions.iter().all(|&(time, _)| time == when);
            let kind = if same_time {
                let all: Vec<Condition> = conditions.iter().map(|(_, c)| c.clone()).collect();
                let condition = Condition {
                    kind: ConditionKind::And(all),
                    span: condition.span(),
                };
                EffectKind::When(condition, Box::new(effect))
            } else {
                EffectKind::TimedWhen(conditions.clone(), Box::new(effect))
            };
            out.push((when, Effect { kind, span }));
        }
    }
}

/// One effect for several.
fn all_of(mut effects: Vec<Effect>, body: Node<'_>) -> Effect {
    if effects.len() == 1 {
        return effects.remove(0);
    }
    Effect {
        kind: EffectKind::And(effects),
        span: body.span(),
    }
}

/// Whether `#t` stands somewhere inside.
fn has_continuous_time(node: Node<'_>) -> bool {
    match node.word() {
        Some(word) => word.eq_ignore_ascii_case("#t"),
        None => node.children().any(has_continuous_time),
    }
}
