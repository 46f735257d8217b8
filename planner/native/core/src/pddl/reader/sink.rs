//! Where the reader leaves what it finds: diagnostics and the parts of PDDL in use.

use super::requirements::{Feature, Usage};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::{Diagnostic, Diagnostics};
use crate::syntax::span::Span;
use crate::syntax::tree::{Node, NodeKind, Tree};

/// Collects diagnostics and features of one file.
#[derive(Default)]
pub(super) struct Sink {
    diagnostics: Diagnostics,
    pub usage: Usage,
}

impl Sink {
    /// Starts with the faults of the tree.
    pub fn new(tree: &Tree) -> Self {
        let mut sink = Self::default();
        for diagnostic in tree.diagnostics() {
            sink.push(diagnostic.clone());
        }
        sink
    }

    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.diagnostics.push(diagnostic);
    }

    /// Adds a diagnostic that is costly to make: only if it will be kept.
    pub fn report(&mut self, code: Code, make: impl FnOnce() -> Diagnostic) {
        if self.diagnostics.is_full(code) {
            self.diagnostics.count(code);
        } else {
            self.diagnostics.push(make());
        }
    }

    /// Notes that a feature is used, and where first.
    pub fn uses(&mut self, feature: Feature, span: Span) {
        self.usage.note(feature, span);
    }

    /// "expected X": something else stands where X should.
    pub fn expected(&mut self, span: Span, what: &str, found: Option<Node<'_>>) {
        let found = found.map_or_else(|| "nothing".to_owned(), describe);
        self.push(
            Diagnostic::new(
                Code::Malformed,
                span,
                format!("expected {what}, found {found}"),
            )
            .label(format!("{what} expected here")),
        );
    }

    pub fn finish(self) -> Vec<Diagnostic> {
        self.diagnostics.finish()
    }
}

/// A node in a few words.
pub(super) fn describe(node: Node<'_>) -> String {
    let shortened = |text: &str| -> String {
        if text.chars().count() <= 30 && !text.contains('\n') {
            return text.to_owned();
        }
        let first: String = text
            .chars()
            .take_while(|&character| character != '\n')
            .take(24)
            .collect();
        format!("{} ...", first.trim_end())
    };
    match node.kind() {
        NodeKind::Word => format!("`{}`", shortened(node.text())),
        NodeKind::List | NodeKind::Call => format!("`{}`", shortened(node.text())),
    }
}
