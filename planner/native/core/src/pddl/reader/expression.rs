//! Numeric expressions.

use super::names::lower;
use super::scope::Reader;
use crate::pddl::model::{Arithmetic, Expression, ExpressionKind, ModuleKind};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::tree::{Node, NodeKind};

/// Longer sums and products become balanced trees instead of left-deep ones, so that no
/// recursion over an expression is deep.
const LEFT_DEEP: usize = 32;

/// A number as PDDL writes it; infinite if it is too large, `None` if it is none.
pub(super) fn number(word: &str) -> Option<f64> {
    let digits = word.strip_prefix(['-', '+']).unwrap_or(word);
    if !digits.starts_with(|first: char| first.is_ascii_digit() || first == '.') {
        return None;
    }
    word.parse().ok()
}

impl Reader<'_> {
    /// A finite number, or a diagnostic.
    pub fn finite(&mut self, node: Node<'_>) -> Option<f64> {
        let value = node.word().and_then(number);
        match value {
            Some(value) if value.is_finite() => Some(value),
            _ => {
                let message = match value {
                    Some(_) => format!("`{}` is too large", node.text()),
                    None => format!("expected a number, found {}", super::sink::describe(node)),
                };
                self.sink.push(
                    Diagnostic::new(Code::InvalidNumber, node.span(), message)
                        .label("a number such as 3, 0.5 or 1e-3"),
                );
                None
            }
        }
    }

    /// A numeric expression.
    pub fn expression(&mut self, node: Node<'_>) -> Option<Expression> {
        let kind = match node.kind() {
            NodeKind::Word => self.expression_word(node)?,
            NodeKind::Call => ExpressionKind::Module(self.module_call(node, ModuleKind::Cost)?),
            NodeKind::List => return self.expression_list(node),
        };
        Some(Expression {
            kind,
            span: node.span(),
        })
    }

    fn expression_word(&mut self, node: Node<'_>) -> Option<ExpressionKind> {
        let word = node.text();
        if number(word).is_some() {
            return self.finite(node).map(ExpressionKind::Number);
        }
        match lower(word).as_ref() {
            "?duration" if self.has_duration => Some(ExpressionKind::Duration),
            "#t" => {
                self.sink.push(
                    Diagnostic::new(
                        Code::ContinuousEffect,
                        node.span(),
                        "continuous effects are not supported",
                    )
                    .label("change that goes on during the action")
                    .remedy("change the value at the start or the end, by `?duration` if need be"),
                );
                None
            }
            "total-time" if self.in_metric => Some(ExpressionKind::TotalTime),
            text if text.starts_with('?') => {
                let diagnostic = Diagnostic::new(
                    Code::InvalidNumber,
                    node.span(),
                    format!("`{word}` is no number"),
                );
                self.sink.push(if text == "?duration" {
                    diagnostic.label("only durative actions have a duration")
                } else {
                    diagnostic.label("a variable stands for an object")
                });
                None
            }
            _ => self.fluent(node).map(ExpressionKind::Fluent),
        }
    }

    fn expression_list(&mut self, node: Node<'_>) -> Option<Expression> {
        let span = node.span();
        let Some(head) = node.head() else {
            self.sink.expected(span, "a numeric expression", Some(node));
            return None;
        };
        let name = lower(head.text());
        let operation = match name.as_ref() {
            "+" => Arithmetic::Add,
            "-" => Arithmetic::Subtract,
            "*" => Arithmetic::Multiply,
            "/" => Arithmetic::Divide,
            "total-time" if self.in_metric => {
                return Some(Expression {
                    kind: ExpressionKind::TotalTime,
                    span,
                });
            }
            "is-violated" => {
                self.sink.push(preference_unsupported(head));
                return None;
            }
            _ if head.kind() == NodeKind::Call && node.children().count() == 1 => {
                return self.expression(head);
            }
            _ if head.word().is_none() => {
                self.sink
                    .expected(head.span(), "a function or an operator", Some(head));
                return None;
            }
            _ => {
                let fluent = self.fluent(node)?;
                return Some(Expression {
                    kind: ExpressionKind::Fluent(fluent),
                    span,
                });
            }
        };
        self.arithmetic(node, operation)
    }

    fn arithmetic(&mut self, node: Node<'_>, operation: Arithmetic) -> Option<Expression> {
        let span = node.span();
        let operands: Vec<Option<Expression>> = node
            .children()
            .skip(1)
            .map(|operand| self.expression(operand))
            .collect();
        let count = operands.len();
        let mut operands: Vec<Expression> = operands.into_iter().collect::<Option<_>>()?;
        let admissible = match operation {
            Arithmetic::Add | Arithmetic::Multiply => count >= 1,
            Arithmetic::Subtract => count == 1 || count == 2,
            Arithmetic::Divide | Arithmetic::Minimum | Arithmetic::Maximum => count == 2,
        };
        if !admissible {
            let head = node.head().map_or("", Node::text);
            self.sink.push(
                Diagnostic::new(
                    Code::WrongArity,
                    span,
                    format!("`{head}` cannot have {count} operands"),
                )
                .label(match operation {
                    Arithmetic::Subtract => "one or two needed",
                    Arithmetic::Divide => "two needed",
                    _ => "at least one needed",
                }),
            );
            return None;
        }
        if count == 1 && operation == Arithmetic::Subtract {
            let operand = Box::new(operands.pop()?);
            return Some(Expression {
                kind: ExpressionKind::Negate(operand),
                span,
            });
        }
        let mut folded = fold(operation, operands)?;
        folded.span = span;
        Some(folded)
    }
}

/// Joins operands: to the left if they are few, balanced if they are many.
fn fold(operation: Arithmetic, mut operands: Vec<Expression>) -> Option<Expression> {
    if operands.len() > LEFT_DEEP {
        let right = operands.split_off(operands.len() / 2);
        let left = fold(operation, operands)?;
        let right = fold(operation, right)?;
        return Some(binary(operation, left, right));
    }
    operands
        .into_iter()
        .reduce(|left, right| binary(operation, left, right))
}

fn binary(operation: Arithmetic, left: Expression, right: Expression) -> Expression {
    let span = left.span.join(right.span);
    Expression {
        kind: ExpressionKind::Binary(operation, Box::new(left), Box::new(right)),
        span,
    }
}

/// Preferences are refused wherever they stand.
pub(super) fn preference_unsupported(node: Node<'_>) -> Diagnostic {
    Diagnostic::new(
        Code::PreferenceUnsupported,
        node.span(),
        "preferences are not supported",
    )
    .label("part of PDDL 3")
    .remedy("make it a goal, or leave it out")
}
