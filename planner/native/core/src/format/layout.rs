//! How each kind of list is broken into lines.

use super::WIDTH;
use super::items::{Item, ItemKind, items};
use super::printer::Printer;
use crate::syntax::lexer::TokenKind;
use crate::syntax::tree::{Node, NodeKind, Tree};

const INDENT: usize = 2;

/// Lays out a whole file.
pub(super) fn lay_out(tree: &Tree) -> String {
    let mut layout = Layout {
        tree,
        widths: widths(tree),
        printer: Printer::default(),
    };
    let roots = items(tree, None);
    layout.vertical(&roots, 0);
    layout.printer.finish()
}

struct Layout<'t> {
    tree: &'t Tree,
    /// Columns of each list on one line, by its first token; `usize::MAX` if it holds a comment.
    widths: Vec<usize>,
    printer: Printer,
}

/// One-line widths of all lists, from the last token to the first.
fn widths(tree: &Tree) -> Vec<usize> {
    let tokens = tree.tokens();
    let mut widths = vec![0; tokens.len()];
    let mut open: Vec<(usize, usize)> = Vec::new();
    let add = |total: &mut usize, more: usize| *total = total.saturating_add(more);
    for token in 0..tokens.len() {
        let span = tokens.span(token);
        let own = match tokens.kinds[token] {
            kind if kind.opens() => {
                open.push((token, 2));
                continue;
            }
            TokenKind::RightParenthesis | TokenKind::RightBracket => {
                let Some((opener, width)) = open.pop() else {
                    continue;
                };
                // Every part was counted with a blank; the first needs none.
                let width = if width > 2 { width - 1 } else { width };
                widths[opener] = width;
                width
            }
            TokenKind::Word => tree.text()[span.start as usize..span.end as usize]
                .chars()
                .count(),
            TokenKind::Comment => usize::MAX,
            _ => continue,
        };
        widths[token] = widths[token].max(own);
        if let Some((_, total)) = open.last_mut() {
            add(total, own.saturating_add(1));
        }
    }
    widths
}

fn lower(word: Option<&str>) -> String {
    word.map_or_else(String::new, str::to_ascii_lowercase)
}

impl<'t> Layout<'t> {
    fn width(&self, node: Node<'t>) -> usize {
        self.widths[node.token()]
    }

    /// Whether a blank and so many columns have room on this line.
    fn fits(&self, width: usize) -> bool {
        width < WIDTH.saturating_sub(self.printer.column())
    }

    /// A word or a list; `indent` is that of the line on which it begins.
    fn node(&mut self, node: Node<'t>, indent: usize) {
        if node.kind() == NodeKind::Word {
            self.printer.text(node.text());
            return;
        }
        let width = self.width(node);
        if width <= WIDTH.saturating_sub(self.printer.column()) && !always_broken(node) {
            self.flat(node);
        } else {
            self.broken(node, indent);
        }
    }

    fn flat(&mut self, node: Node<'t>) {
        let Some(_) = node.head() else {
            self.printer.text(if node.is_list() { "()" } else { "[]" });
            return;
        };
        let (open, close) = delimiters(node);
        self.printer.text(open);
        for (position, child) in node.children().enumerate() {
            if position > 0 {
                self.printer.text(" ");
            }
            match child.kind() {
                NodeKind::Word => self.printer.text(child.text()),
                _ => self.flat(child),
            }
        }
        self.printer.text(close);
    }

    fn broken(&mut self, node: Node<'t>, indent: usize) {
        let (open, close) = delimiters(node);
        let parts = items(self.tree, Some(node));
        self.printer.text(open);
        match lower(node.head().and_then(Node::word)).as_str() {
            "define" => {
                let rest = self.on_the_first_line(&parts, 2, indent);
                self.vertical(&parts[rest..], indent + INDENT);
            }
            ":action" | ":durative-action" | ":process" | ":event" => {
                let rest = self.on_the_first_line(&parts, 2, indent);
                self.keys(&parts[rest..], indent + INDENT);
            }
            ":objects" | ":constants" | ":types" => {
                let rest = self.on_the_first_line(&parts, 1, indent);
                self.typed(&parts[rest..], indent + INDENT);
            }
            ":predicates" | ":functions" | ":modules" | ":init" => {
                let rest = self.on_the_first_line(&parts, 1, indent);
                self.vertical_typed(&parts[rest..], indent + INDENT);
            }
            "forall" | "exists" | ":derived" => {
                let rest = self.on_the_first_line(&parts, 2, indent);
                self.rest(&parts[rest..], indent);
            }
            _ => {
                let leading = parts
                    .iter()
                    .take_while(|part| part.word().is_some())
                    .count();
                let rest = self.on_the_first_line(&parts, leading.max(1), indent);
                self.rest(&parts[rest..], indent);
            }
        }
        if self.printer.line_is_over() {
            self.printer.newline(indent);
        }
        self.printer.text(close);
    }

    /// Puts the first `count` nodes behind the opener; gives how many parts were written. Comments
    /// between them end the line.
    fn on_the_first_line(&mut self, parts: &[Item<'t>], count: usize, indent: usize) -> usize {
        let mut nodes = 0;
        for (position, part) in parts.iter().enumerate() {
            match part.kind {
                ItemKind::Node(_) if nodes == count => return position,
                ItemKind::Node(node) => {
                    nodes += 1;
                    self.follow(node, indent);
                }
                ItemKind::Comment {
                    own_line: false,
                    text,
                } => self.trailing(text),
                ItemKind::Comment { .. } => {
                    if nodes == count {
                        return position;
                    }
                    self.own_line_comment(part, indent + INDENT);
                }
            }
        }
        parts.len()
    }

    /// The parts behind the head: a single list hugs the head, words are filled, several lists
    /// stand on lines of their own.
    fn rest(&mut self, parts: &[Item<'t>], indent: usize) {
        if let [only] = parts
            && let Some(node) = only.node()
            && node.kind() != NodeKind::Word
            && !self.printer.line_is_over()
        {
            self.printer.space();
            self.node(node, indent);
            return;
        }
        self.vertical(parts, indent + INDENT);
    }

    /// Behind the last part if there is room, else on a new line.
    fn follow(&mut self, node: Node<'t>, indent: usize) {
        let room = self.fits(self.width(node));
        if self.printer.line_is_over() || (!room && node.kind() == NodeKind::Word) {
            self.printer.newline(indent + INDENT);
            self.node(node, indent + INDENT);
        } else {
            self.printer.space();
            self.node(node, indent);
        }
    }

    fn trailing(&mut self, text: &str) {
        if !self.printer.is_empty() {
            self.printer.space();
        }
        self.printer.comment(text);
    }

    fn own_line_comment(&mut self, part: &Item<'t>, indent: usize) {
        if let ItemKind::Comment { text, .. } = part.kind {
            if !self.printer.is_empty() {
                if part.blank_before {
                    self.printer.blank_line();
                }
                self.printer.newline(indent);
            }
            self.printer.comment(text);
        }
    }

    /// Every part on a line of its own.
    fn vertical(&mut self, parts: &[Item<'t>], indent: usize) {
        for (position, part) in parts.iter().enumerate() {
            match part.kind {
                ItemKind::Comment {
                    own_line: false,
                    text,
                } => self.trailing(text),
                ItemKind::Comment { .. } | ItemKind::Node(_) => {
                    let blank = part.blank_before || begins_action(parts, position);
                    if blank && !self.printer.is_empty() {
                        self.printer.blank_line();
                    }
                    self.line(part, indent);
                }
            }
        }
    }

    fn line(&mut self, part: &Item<'t>, indent: usize) {
        if !self.printer.is_empty() {
            self.printer.newline(indent);
        }
        match part.kind {
            ItemKind::Comment { text, .. } => self.printer.comment(text),
            ItemKind::Node(node) => self.node(node, indent),
        }
    }

    /// `(p) (q) - number`: a dash and its type stay on the line of the list before.
    fn vertical_typed(&mut self, parts: &[Item<'t>], indent: usize) {
        let mut behind_dash = false;
        for part in parts {
            let dash = part.word() == Some("-");
            match part.kind {
                ItemKind::Comment {
                    own_line: false,
                    text,
                } => self.trailing(text),
                ItemKind::Node(node) if (dash || behind_dash) && !self.printer.line_is_over() => {
                    self.printer.space();
                    self.node(node, indent);
                }
                _ => {
                    if part.blank_before {
                        self.printer.blank_line();
                    }
                    self.line(part, indent);
                }
            }
            behind_dash = dash;
        }
    }

    /// `a b - t c - u`: one group a line.
    fn typed(&mut self, parts: &[Item<'t>], indent: usize) {
        let mut group_begins = true;
        let mut behind_dash = false;
        for part in parts {
            match part.kind {
                ItemKind::Comment {
                    own_line: false,
                    text,
                } => self.trailing(text),
                ItemKind::Comment { .. } => {
                    self.own_line_comment(part, indent);
                }
                ItemKind::Node(node) => {
                    let room = self.fits(self.width(node));
                    if group_begins || self.printer.line_is_over() || !room {
                        if group_begins && part.blank_before {
                            self.printer.blank_line();
                        }
                        self.printer.newline(indent);
                    }
                    self.printer.space();
                    self.node(node, indent);
                    group_begins = behind_dash;
                    behind_dash = node.word() == Some("-");
                }
            }
        }
    }

    /// `:key value` pairs, one a line.
    fn keys(&mut self, parts: &[Item<'t>], indent: usize) {
        for part in parts {
            let key = part.word().is_some_and(|word| word.starts_with(':'));
            match part.kind {
                ItemKind::Comment {
                    own_line: false,
                    text,
                } => self.trailing(text),
                ItemKind::Node(node) if !key && !self.printer.line_is_over() => {
                    self.printer.space();
                    self.node(node, indent);
                }
                _ => {
                    if part.blank_before {
                        self.printer.blank_line();
                    }
                    self.line(part, indent);
                }
            }
        }
    }
}

/// Whether an action begins at a position, or comments on lines of their own that lead to one.
fn begins_action(parts: &[Item<'_>], position: usize) -> bool {
    let own_line = |part: &Item<'_>| matches!(part.kind, ItemKind::Comment { own_line: true, .. });
    if position > 0 && own_line(&parts[position - 1]) {
        return false;
    }
    let next = parts[position..].iter().find(|part| !own_line(part));
    let head = next.and_then(Item::node).and_then(Node::head);
    matches!(
        lower(head.and_then(Node::word)).as_str(),
        ":action" | ":durative-action"
    )
}

fn delimiters(node: Node<'_>) -> (&'static str, &'static str) {
    if node.is_list() {
        ("(", ")")
    } else {
        ("[", "]")
    }
}

/// Definitions and actions are never written on one line, declarations only if there is one.
fn always_broken(node: Node<'_>) -> bool {
    match lower(node.head().and_then(Node::word)).as_str() {
        "define" | ":action" | ":durative-action" => true,
        ":predicates" | ":functions" | ":modules" | ":init" => node.children().count() > 2,
        _ => false,
    }
}
