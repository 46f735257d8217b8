//! `a b - t c - (either u v) d`: names in groups with the type written behind each.

use super::sink::Sink;
use crate::syntax::code::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::tree::Node;

/// Parameters of one action, predicate or quantifier, and types of one `either`, at most.
pub(super) const MAXIMUM_MEMBERS: usize = 256;

/// More than [`MAXIMUM_MEMBERS`].
pub(super) fn too_many(node: Node<'_>, what: &str) -> Diagnostic {
    Diagnostic::new(
        Code::TooManyMembers,
        node.first_token_span(),
        format!("more than {MAXIMUM_MEMBERS} {what}"),
    )
    .label("this list is not read")
}

/// Names that share a type; `None` where no type is written.
pub(super) struct Group<'t> {
    pub members: Vec<Node<'t>>,
    pub types: Option<Node<'t>>,
}

/// Splits a list into groups. Members may be words or, for functions, lists.
pub(super) fn typed_list<'t>(
    nodes: impl Iterator<Item = Node<'t>>,
    sink: &mut Sink,
) -> Vec<Group<'t>> {
    let mut nodes = nodes.peekable();
    let mut groups = Vec::new();
    let mut members = Vec::new();
    while let Some(node) = nodes.next() {
        if node.word() != Some("-") {
            members.push(node);
            continue;
        }
        if members.is_empty() {
            sink.expected(node.span(), "a name before the dash", Some(node));
        }
        let types = nodes.next_if(|next| next.word() != Some("-"));
        if types.is_none() {
            sink.expected(node.span(), "a type behind the dash", nodes.peek().copied());
        }
        groups.push(Group {
            members: std::mem::take(&mut members),
            types,
        });
    }
    if !members.is_empty() {
        groups.push(Group {
            members,
            types: None,
        });
    }
    groups
}
