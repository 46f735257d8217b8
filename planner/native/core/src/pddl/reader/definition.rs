//! Finds `(define (domain NAME) section ...)` and its sections.

use super::names::name;
use super::sink::Sink;
use crate::pddl::model::Name;
use crate::syntax::code::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::span::Span;
use crate::syntax::suggestion::nearest;
use crate::syntax::tree::{Node, Tree};

/// A definition with its parts.
pub(super) struct Definition<'t> {
    pub node: Node<'t>,
    pub name: Name,
    /// Lower-cased keyword, colon included, and the section.
    pub sections: Vec<(String, Node<'t>)>,
}

fn is_word(node: Node<'_>, word: &str) -> bool {
    node.word()
        .is_some_and(|text| text.eq_ignore_ascii_case(word))
}

/// Finds the definition of a `what` ("domain" or "problem"); a file may hold one of each.
pub(super) fn find<'t>(
    tree: &'t Tree,
    what: &str,
    known_sections: &[&str],
    sink: &mut Sink,
) -> Option<Definition<'t>> {
    let mut others = Vec::new();
    for root in tree.roots() {
        let mut parts = root.children();
        if !parts.next().is_some_and(|head| is_word(head, "define")) {
            others.push(root);
            continue;
        }
        let header = parts.next();
        let kind = header.and_then(Node::head);
        if !kind.is_some_and(|kind| is_word(kind, what)) {
            others.push(root);
            continue;
        }
        let header = header?;
        let written = header
            .children()
            .nth(1)
            .filter(|node| node.word().is_some());
        if written.is_none() {
            let place = header.span();
            sink.expected(
                place,
                &format!("the name of the {what}"),
                header.children().nth(1),
            );
        }
        let name = written.map_or_else(
            || Name {
                text: String::new(),
                span: header.span(),
            },
            name,
        );
        let sections = sections(parts, known_sections, sink);
        return Some(Definition {
            node: root,
            name,
            sections,
        });
    }
    report_absent(tree, what, &others, sink);
    None
}

fn sections<'t>(
    nodes: impl Iterator<Item = Node<'t>>,
    known: &[&str],
    sink: &mut Sink,
) -> Vec<(String, Node<'t>)> {
    let mut found = Vec::new();
    for node in nodes {
        let head = node.head().filter(|head| head.word().is_some());
        let Some(head) = head.filter(|_| node.is_list()) else {
            sink.expected(
                node.span(),
                "a section such as `(:predicates ...)`",
                Some(node),
            );
            continue;
        };
        let keyword = head.text().to_ascii_lowercase();
        if known.contains(&keyword.as_str()) {
            found.push((keyword, node));
            continue;
        }
        sink.report(Code::UnknownSection, || {
            Diagnostic::new(
                Code::UnknownSection,
                head.span(),
                format!("unknown section `{}`", head.text()),
            )
            .label("not a section of this definition")
            .did_you_mean(nearest(&keyword, known.iter().copied()))
        });
    }
    found
}

fn report_absent(tree: &Tree, what: &str, others: &[Node<'_>], sink: &mut Sink) {
    let end = tree.text().len() as u32;
    let mut diagnostic = match others.first() {
        None => Diagnostic::new(
            Code::NotADefinition,
            Span::new(0, end.min(1)),
            format!("there is no {what} in this file"),
        )
        .label("no list stands in the file"),
        Some(root) => Diagnostic::new(
            Code::NotADefinition,
            root.first_token_span(),
            format!("there is no {what} in this file"),
        )
        .label(format!("expected `(define ({what} NAME) ...)`")),
    };
    let other = if what == "domain" {
        "problem"
    } else {
        "domain"
    };
    let swapped = others.iter().any(|root| {
        root.children()
            .nth(1)
            .and_then(Node::head)
            .is_some_and(|kind| is_word(kind, other))
    });
    if swapped {
        diagnostic = diagnostic.remedy(format!(
            "this file holds a {other}; perhaps domain and problem are exchanged"
        ));
    }
    sink.push(diagnostic);
}

/// The section of a keyword that may stand once; a second one is reported.
pub(super) fn single<'t>(
    sections: &[(String, Node<'t>)],
    keyword: &str,
    sink: &mut Sink,
) -> Option<Node<'t>> {
    let mut matching = sections
        .iter()
        .filter(|(written, _)| written == keyword)
        .map(|&(_, node)| node);
    let first = matching.next();
    for again in matching {
        let head = again.head().unwrap_or(again);
        let earlier = first.and_then(Node::head).unwrap_or(again);
        sink.push(
            Diagnostic::new(
                Code::DuplicateSection,
                head.span(),
                format!("`{keyword}` is given twice"),
            )
            .label("this one is not read")
            .note(earlier.span(), "given here first")
            .remedy("join the two sections"),
        );
    }
    first
}
