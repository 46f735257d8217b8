//! `:duration` of a durative action.

use super::names::lower;
use super::requirements::Feature;
use super::scope::Reader;
use super::time::specifier;
use crate::pddl::model::{Comparison, DurationConstraint, When};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::tree::Node;

impl Reader<'_> {
    /// Duration constraints: none, one, or several joined by `and`.
    pub fn duration(&mut self, node: Node<'_>, when: When, out: &mut Vec<DurationConstraint>) {
        if let Some((time, inner)) = specifier(node) {
            if time == When::OverAll {
                self.invalid_duration(node, "a duration is fixed at the start or at the end");
            } else {
                self.duration(inner, time, out);
            }
            return;
        }
        let Some(head) = node.head() else {
            if node.word().is_some() {
                self.invalid_duration(node, "write `(= ?duration ...)`");
            }
            return;
        };
        let comparison = match lower(head.text()).as_ref() {
            "and" => {
                for part in node.children().skip(1) {
                    self.duration(part, when, out);
                }
                return;
            }
            "=" => Comparison::Equal,
            "<=" => Comparison::LessEqual,
            ">=" => Comparison::GreaterEqual,
            "<" | ">" => {
                let wider = format!("{}=", head.text());
                self.sink.push(
                    Diagnostic::new(
                        Code::InvalidDuration,
                        head.span(),
                        format!("`{}` cannot bound a duration", head.text()),
                    )
                    .label("strict inequalities are not part of PDDL 2.1")
                    .did_you_mean(Some(&wider)),
                );
                return;
            }
            _ => {
                self.invalid_duration(node, "write `(= ?duration ...)`");
                return;
            }
        };
        if comparison != Comparison::Equal {
            self.uses(Feature::DurationInequalities, head);
        }
        self.bound_of(node, comparison, when, out);
    }

    fn bound_of(
        &mut self,
        node: Node<'_>,
        comparison: Comparison,
        when: When,
        out: &mut Vec<DurationConstraint>,
    ) {
        let Some([left, right]) = self.operands(node) else {
            return;
        };
        let is_duration = |node: Node<'_>| {
            node.word()
                .is_some_and(|word| word.eq_ignore_ascii_case("?duration"))
        };
        let (comparison, bound) = match (is_duration(left), is_duration(right)) {
            (true, false) => (comparison, right),
            (false, true) => (comparison.mirrored(), left),
            _ => {
                self.invalid_duration(node, "one side has to be `?duration`");
                return;
            }
        };
        self.has_duration = false;
        let expression = self.expression(bound);
        if let Some(bound) = expression {
            let span = node.span();
            out.push(DurationConstraint {
                comparison,
                when,
                bound,
                span,
            });
        }
    }

    fn invalid_duration(&mut self, node: Node<'_>, label: &str) {
        self.sink.push(
            Diagnostic::new(
                Code::InvalidDuration,
                node.span(),
                "this is no constraint of the duration",
            )
            .label(label)
            .remedy("use `=`, `<=` or `>=` between `?duration` and a numeric expression"),
        );
    }
}
