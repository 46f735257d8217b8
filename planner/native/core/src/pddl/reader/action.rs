//! `(:action ...)` and `(:durative-action ...)`.

use super::declarations;
use super::names::name;
use super::requirements::Feature;
use super::scope::Reader;
use crate::pddl::model::{Action, Condition, DurationConstraint, Effect, Parameter, When};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::span::Span;
use crate::syntax::suggestion::nearest;
use crate::syntax::tree::Node;

/// Values of the keys of an action.
#[derive(Default)]
struct Keys<'t> {
    /// Key without its colon, where it stands, its value.
    found: Vec<(&'static str, Span, Option<Node<'t>>)>,
}

impl<'t> Keys<'t> {
    fn get(&self, key: &str) -> Option<Node<'t>> {
        self.found
            .iter()
            .find(|(found, _, _)| *found == key)
            .and_then(|&(_, _, value)| value)
    }
}

/// Conditions and effects with their times.
type Body = (Vec<(When, Condition)>, Vec<(When, Effect)>);

const DURATIVE: &[&str] = &[":parameters", ":duration", ":condition", ":effect"];
const INSTANTANEOUS: &[&str] = &[":parameters", ":precondition", ":effect"];

impl Reader<'_> {
    /// Reads an action; `None` if it has no name.
    pub fn action(&mut self, section: Node<'_>, durative: bool) -> Option<Action> {
        let mut nodes = section.children().skip(1).peekable();
        let named = nodes.next_if(|node| node.word().is_some_and(|word| !word.starts_with(':')));
        let Some(named) = named else {
            let found = nodes.peek().copied();
            let span = found.unwrap_or(section).span();
            self.sink.expected(span, "the name of the action", found);
            return None;
        };
        let keys = self.keys(nodes, if durative { DURATIVE } else { INSTANTANEOUS });
        let parameters = self.parameters(keys.get(":parameters"));
        self.variables.clear();
        self.variables.extend_from_slice(&parameters);
        let duration = durative.then(|| self.action_duration(named, section, &keys));
        self.has_duration = durative;
        let (conditions, effects) = if durative {
            self.uses(Feature::DurativeActions, section.head().unwrap_or(section));
            self.timed_body(keys.get(":condition"), keys.get(":effect"))
        } else {
            self.body(keys.get(":precondition"), keys.get(":effect"))
        };
        self.has_duration = false;
        self.variables.clear();
        Some(Action {
            name: name(named),
            parameters,
            duration,
            conditions,
            effects,
            span: section.span(),
        })
    }

    fn parameters(&mut self, node: Option<Node<'_>>) -> Vec<Parameter> {
        let Some(node) = node else { return Vec::new() };
        if !node.is_list() {
            self.sink
                .expected(node.span(), "a list of parameters", Some(node));
            return Vec::new();
        }
        declarations::parameters(node.children(), &self.domain.types, self.names, self.sink)
    }

    fn action_duration(
        &mut self,
        named: Node<'_>,
        section: Node<'_>,
        keys: &Keys<'_>,
    ) -> Vec<DurationConstraint> {
        let mut constraints = Vec::new();
        match keys.get(":duration") {
            Some(node) => self.duration(node, When::Start, &mut constraints),
            None => self.sink.push(
                Diagnostic::new(
                    Code::MissingSection,
                    named.span(),
                    format!("durative action `{}` has no `:duration`", named.text()),
                )
                .label("how long does it take?")
                .note(
                    section.head().unwrap_or(section).span(),
                    "an action that takes no time is written with `:action`",
                )
                .remedy("add `:duration (= ?duration ...)`"),
            ),
        }
        constraints
    }

    fn timed_body(&mut self, condition: Option<Node<'_>>, effect: Option<Node<'_>>) -> Body {
        let (mut conditions, mut effects) = (Vec::new(), Vec::new());
        if let Some(node) = condition {
            self.timed_condition(node, &mut conditions);
        }
        if let Some(node) = effect {
            self.timed_effect(node, &mut effects);
        }
        (conditions, effects)
    }

    fn body(&mut self, condition: Option<Node<'_>>, effect: Option<Node<'_>>) -> Body {
        let condition = condition.and_then(|node| self.condition(node));
        let effect = effect.and_then(|node| self.effect(node));
        let at_start = When::Start;
        (
            condition.into_iter().map(|part| (at_start, part)).collect(),
            effect.into_iter().map(|part| (at_start, part)).collect(),
        )
    }

    fn keys<'t>(
        &mut self,
        nodes: impl Iterator<Item = Node<'t>>,
        known: &'static [&'static str],
    ) -> Keys<'t> {
        let mut keys = Keys::default();
        let mut nodes = nodes.peekable();
        while let Some(node) = nodes.next() {
            let Some(word) = node.word().filter(|word| word.starts_with(':')) else {
                self.sink
                    .expected(node.span(), "a key such as `:effect`", Some(node));
                continue;
            };
            let word = word.to_ascii_lowercase();
            let value = nodes.next_if(|next| next.word().is_none_or(|word| !word.starts_with(':')));
            let Some(&key) = known.iter().find(|key| **key == word) else {
                self.unknown_key(node, &word, known);
                continue;
            };
            if value.is_none() {
                self.sink.expected(
                    node.span(),
                    &format!("a list behind `{key}`"),
                    nodes.peek().copied(),
                );
            }
            if let Some(&(_, first, _)) = keys.found.iter().find(|(found, _, _)| *found == key) {
                self.sink.push(
                    Diagnostic::new(
                        Code::DuplicateSection,
                        node.span(),
                        format!("`{key}` is given twice"),
                    )
                    .label("this one is not read")
                    .note(first, "given here first")
                    .remedy("join the two with `and`"),
                );
                continue;
            }
            keys.found.push((key, node.span(), value));
        }
        keys
    }

    fn unknown_key(&mut self, node: Node<'_>, word: &str, known: &'static [&'static str]) {
        if word == ":grounding" {
            self.sink.push(
                Diagnostic::new(
                    Code::ModuleKindUnsupported,
                    node.span(),
                    "grounding modules are not supported",
                )
                .label("`:grounding` of PDDL/M")
                .remedy("list the objects in the problem"),
            );
            return;
        }
        let other = match word {
            ":precondition" if known == DURATIVE => Some(":condition"),
            ":condition" if known == INSTANTANEOUS => Some(":precondition"),
            _ => nearest(word, known.iter().copied()),
        };
        let label = match (word, known == DURATIVE) {
            (":precondition", true) => "a durative action has a `:condition`",
            (":condition", false) => "an instantaneous action has a `:precondition`",
            (":duration", false) => "only a `:durative-action` has a duration",
            _ => "not a key of an action",
        };
        self.sink.push(
            Diagnostic::new(
                Code::UnknownSection,
                node.span(),
                format!("unknown key `{word}`"),
            )
            .label(label)
            .did_you_mean(other),
        );
    }
}
