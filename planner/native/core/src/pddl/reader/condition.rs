//! Conditions, untimed (preconditions, goals, rules) and timed (of durative actions).

use super::expression::{number, preference_unsupported};
use super::names::lower;
use super::requirements::Feature;
use super::scope::Reader;
use super::time::specifier;
use crate::pddl::model::{Comparison, Condition, ConditionKind, ModuleKind, When};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::{Diagnostic, Edit, Fix};
use crate::syntax::span::Span;
use crate::syntax::tree::{Node, NodeKind};

/// Operators of trajectory constraints.
const TRAJECTORY: [&str; 9] = [
    "always",
    "sometime",
    "within",
    "at-most-once",
    "sometime-after",
    "sometime-before",
    "always-within",
    "hold-during",
    "hold-after",
];

impl Reader<'_> {
    /// A condition without times.
    pub fn condition(&mut self, node: Node<'_>) -> Option<Condition> {
        let kind = match node.kind() {
            NodeKind::Call => ConditionKind::Module(self.module_call(node, ModuleKind::Condition)?),
            NodeKind::Word => {
                self.expected_condition(node);
                return None;
            }
            NodeKind::List => self.condition_list(node)?,
        };
        Some(Condition {
            kind,
            span: node.span(),
        })
    }

    fn expected_condition(&mut self, node: Node<'_>) {
        let mut diagnostic = Diagnostic::new(
            Code::Malformed,
            node.span(),
            format!("expected a condition, found `{}`", node.text()),
        )
        .label("a condition stands in parentheses");
        let name = lower(node.text());
        if self.names.predicates.contains_key(name.as_ref()) {
            diagnostic = diagnostic.did_you_mean(Some(&format!("({})", node.text())));
        }
        self.sink.push(diagnostic);
    }

    fn condition_list(&mut self, node: Node<'_>) -> Option<ConditionKind> {
        let Some(head) = node.head() else {
            return Some(ConditionKind::And(Vec::new()));
        };
        if head.word().is_none() {
            let alone = node.children().count() == 1;
            if alone && head.kind() == NodeKind::Call {
                let call = self.module_call(head, ModuleKind::Condition)?;
                return Some(ConditionKind::Module(call));
            }
            self.sink
                .expected(head.span(), "a predicate or `and`, `or`, `not`", Some(head));
            return None;
        }
        let name = lower(head.text());
        let declared = self.names.predicates.contains_key(name.as_ref());
        match name.as_ref() {
            "and" => {
                let parts = node.children().skip(1);
                Some(ConditionKind::And(self.conditions(parts)))
            }
            "or" => {
                self.uses(Feature::Disjunction, head);
                let parts = node.children().skip(1);
                Some(ConditionKind::Or(self.conditions(parts)))
            }
            "not" => {
                self.uses(Feature::Negation, head);
                let [inner] = self.operands(node)?;
                Some(ConditionKind::Not(Box::new(self.condition(inner)?)))
            }
            "imply" => {
                self.uses(Feature::Disjunction, head);
                let [left, right] = self.operands(node)?;
                let (left, right) = (self.condition(left), self.condition(right));
                Some(ConditionKind::Imply(Box::new(left?), Box::new(right?)))
            }
            "forall" | "exists" => self.quantified_condition(node, head, name.as_ref()),
            "=" | "<" | "<=" | ">" | ">=" => self.comparison(node, head),
            "preference" if !declared => {
                self.sink.push(preference_unsupported(head));
                None
            }
            word if TRAJECTORY.contains(&word) && !declared => {
                self.sink.push(trajectory_unsupported(head));
                None
            }
            _ if specifier(node).is_some() => {
                self.sink.push(
                    Diagnostic::new(
                        Code::UnexpectedTime,
                        node.span(),
                        "a time where none belongs",
                    )
                    .label("only the outside of a durative action's conditions has times")
                    .remedy("remove the time specifier, or put it around the whole condition"),
                );
                None
            }
            _ => self.atom(node).map(ConditionKind::Atom),
        }
    }

    fn conditions<'t>(&mut self, nodes: impl Iterator<Item = Node<'t>>) -> Vec<Condition> {
        nodes.filter_map(|node| self.condition(node)).collect()
    }

    fn quantified_condition(
        &mut self,
        node: Node<'_>,
        head: Node<'_>,
        name: &str,
    ) -> Option<ConditionKind> {
        let universal = name == "forall";
        let feature = if universal {
            Feature::Universal
        } else {
            Feature::Existential
        };
        self.uses(feature, head);
        let [variables, body] = self.operands(node)?;
        let variables = self.quantified(Some(variables), node.span())?;
        let body = self.bound(&variables, |reader| reader.condition(body))?;
        Some(if universal {
            ConditionKind::Forall(variables, Box::new(body))
        } else {
            ConditionKind::Exists(variables, Box::new(body))
        })
    }

    fn comparison(&mut self, node: Node<'_>, head: Node<'_>) -> Option<ConditionKind> {
        let comparison = match head.text() {
            "<" => Comparison::Less,
            "<=" => Comparison::LessEqual,
            ">" => Comparison::Greater,
            ">=" => Comparison::GreaterEqual,
            _ => Comparison::Equal,
        };
        let [left, right] = self.operands(node)?;
        let numeric = comparison != Comparison::Equal
            || self.looks_numeric(left)
            || self.looks_numeric(right);
        if numeric {
            self.uses(Feature::NumericFluents, head);
            let (left, right) = (self.expression(left), self.expression(right));
            return Some(ConditionKind::Compare(comparison, left?, right?));
        }
        self.uses(Feature::Equality, head);
        let (left, right) = (self.term(left), self.term(right));
        Some(ConditionKind::Equal(left?, right?))
    }

    fn looks_numeric(&self, node: Node<'_>) -> bool {
        let Some(word) = node.word() else { return true };
        let name = lower(word);
        number(word).is_some()
            || (self.has_duration && name == "?duration")
            || (self.names.functions.contains_key(name.as_ref())
                && !self.names.objects.contains_key(name.as_ref()))
    }

    /// Exactly `N` parts behind the head.
    pub fn operands<'t, const N: usize>(&mut self, node: Node<'t>) -> Option<[Node<'t>; N]> {
        let parts: Vec<Node<'t>> = node.children().skip(1).take(N + 1).collect();
        if let Ok(exact) = <[Node<'t>; N]>::try_from(parts) {
            return Some(exact);
        }
        let count = node.children().skip(1).count();
        let head = node.head().map_or("", Node::text);
        self.sink.push(
            Diagnostic::new(
                Code::Malformed,
                node.span(),
                format!("`{head}` takes {N} parts, here it has {count}"),
            )
            .label(format!("{count} given")),
        );
        None
    }

    /// The conditions of a durative action, each with its time.
    pub fn timed_condition(&mut self, node: Node<'_>, out: &mut Vec<(When, Condition)>) {
        if let Some((when, inner)) = specifier(node) {
            if let Some(condition) = self.condition(inner) {
                out.push((when, condition));
            }
            return;
        }
        let head = node.head();
        let name = head.map_or_else(String::new, |head| head.text().to_ascii_lowercase());
        match name.as_str() {
            "" if node.is_list() => {}
            "and" => {
                for part in node.children().skip(1) {
                    self.timed_condition(part, out);
                }
            }
            "forall" => self.timed_forall(node, out),
            "preference" => self.sink.push(preference_unsupported(head.unwrap_or(node))),
            _ => self.missing_time(node, "condition", "at start"),
        }
    }

    /// `(forall (?x) (and (at start c) (over all d)))` becomes one `forall` for each time.
    fn timed_forall(&mut self, node: Node<'_>, out: &mut Vec<(When, Condition)>) {
        self.uses(Feature::Universal, node.head().unwrap_or(node));
        let Some([variables, body]) = self.operands(node) else {
            return;
        };
        let Some(variables) = self.quantified(Some(variables), node.span()) else {
            return;
        };
        let mut inner = Vec::new();
        self.bound(&variables, |reader| {
            reader.timed_condition(body, &mut inner)
        });
        for (when, conditions) in by_time(inner) {
            let span = node.span();
            let body = Box::new(Condition {
                kind: ConditionKind::And(conditions),
                span: body.span(),
            });
            let kind = ConditionKind::Forall(variables.clone(), body);
            out.push((when, Condition { kind, span }));
        }
    }

    /// A condition or effect of a durative action without a time.
    pub fn missing_time(&mut self, node: Node<'_>, what: &str, usual: &str) {
        let span = node.span();
        let mut diagnostic = Diagnostic::new(
            Code::MissingTime,
            span,
            format!("this {what} of a durative action does not say when"),
        )
        .label("no time given")
        .remedy(if what == "effect" {
            "write `(at start ...)` or `(at end ...)` around it"
        } else {
            "write `(at start ...)`, `(over all ...)` or `(at end ...)` around it"
        });
        if node.is_list() && node.is_closed() {
            diagnostic.fix = Some(Fix {
                title: format!("Put `({usual} ...)` around it"),
                edits: vec![
                    insertion(span.start, &format!("({usual} ")),
                    insertion(span.end, ")"),
                ],
            });
        }
        self.sink.push(diagnostic);
    }
}

/// Groups parts by their time, in the order of time.
pub(super) fn by_time<T>(parts: Vec<(When, T)>) -> Vec<(When, Vec<T>)> {
    let mut groups: Vec<(When, Vec<T>)> = Vec::new();
    for (when, part) in parts {
        match groups.iter_mut().find(|(time, _)| *time == when) {
            Some((_, group)) => group.push(part),
            None => groups.push((when, vec![part])),
        }
    }
    groups.sort_by_key(|&(when, _)| when);
    groups
}

fn insertion(at: u32, text: &str) -> Edit {
    Edit {
        span: Span::new(at, at),
        replacement: text.to_owned(),
    }
}

/// Trajectory constraints are refused wherever they stand.
pub(super) fn trajectory_unsupported(node: Node<'_>) -> Diagnostic {
    Diagnostic::new(
        Code::ConstraintUnsupported,
        node.span(),
        "trajectory constraints are not supported",
    )
    .label("part of PDDL 3")
    .remedy("express it by over-all conditions, timed initial literals or extra predicates")
}
