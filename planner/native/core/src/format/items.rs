//! What stands inside a list, comments included.

use crate::syntax::lexer::TokenKind;
use crate::syntax::tree::{Node, Tree};

/// A part of a list or of the file.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item<'t> {
    pub kind: ItemKind<'t>,
    /// Whether an empty line stands before it.
    pub blank_before: bool,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum ItemKind<'t> {
    Node(Node<'t>),
    /// A comment without blanks at its end; on a line of its own or behind something.
    Comment {
        text: &'t str,
        own_line: bool,
    },
}

impl<'t> Item<'t> {
    pub fn node(&self) -> Option<Node<'t>> {
        match self.kind {
            ItemKind::Node(node) => Some(node),
            ItemKind::Comment { .. } => None,
        }
    }

    pub fn word(&self) -> Option<&'t str> {
        self.node().and_then(Node::word)
    }
}

/// Parts of a list, or of the file for `None`.
pub(super) fn items<'t>(tree: &'t Tree, list: Option<Node<'t>>) -> Vec<Item<'t>> {
    let tokens = tree.tokens();
    let (mut token, end, mut nodes) = match list {
        Some(node) => {
            let end = node.token_end() - usize::from(node.is_closed());
            (node.token() + 1, end, node.children())
        }
        None => (0, tokens.len(), tree.roots()),
    };
    let mut found = Vec::new();
    let mut newlines = usize::from(list.is_none());
    while token < end {
        let span = tokens.span(token);
        let text = &tree.text()[span.start as usize..span.end as usize];
        match tokens.kinds[token] {
            TokenKind::WhiteSpace => {
                newlines = text.bytes().filter(|&byte| byte == b'\n').count();
                token += 1;
                continue;
            }
            TokenKind::Comment => {
                found.push(Item {
                    kind: ItemKind::Comment {
                        text: text.trim_end(),
                        own_line: newlines > 0,
                    },
                    blank_before: newlines > 1,
                });
                token += 1;
            }
            _ => {
                let Some(node) = nodes.next() else { break };
                found.push(Item {
                    kind: ItemKind::Node(node),
                    blank_before: newlines > 1,
                });
                token = node.token_end();
            }
        }
        newlines = 0;
    }
    found
}
