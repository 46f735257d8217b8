//! Time specifiers: `(at start X)`, `(over all X)`, `(at end X)`.

use crate::pddl::model::When;
use crate::syntax::tree::{Node, NodeKind};

/// The time and what is said of it. A list whose third part is no list is an atom of a predicate
/// that happens to be called `at` or `over`.
pub(super) fn specifier(node: Node<'_>) -> Option<(When, Node<'_>)> {
    let mut parts = node.children();
    let (first, second, inner) = (parts.next()?, parts.next()?, parts.next()?);
    if parts.next().is_some() || inner.kind() == NodeKind::Word || !node.is_list() {
        return None;
    }
    let is = |node: Node<'_>, word: &str| {
        node.word()
            .is_some_and(|text| text.eq_ignore_ascii_case(word))
    };
    let when = match (is(first, "at"), is(first, "over")) {
        (true, _) if is(second, "start") => When::Start,
        (true, _) if is(second, "end") => When::End,
        (_, true) if is(second, "all") => When::OverAll,
        _ => return None,
    };
    Some((when, inner))
}
