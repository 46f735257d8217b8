//! The lossless tree: the flat token array plus, for every opener, where its list ends.
//!
//! A node is the index of its first token, so the tree costs four bytes a token and dropping it
//! cannot overflow the stack, however deep the nesting. Recovery knows three things about PDDL:
//! a section such as `(:action` stands directly inside `(define`, a key such as `:effect` directly
//! inside an action, and a closer matches only its own kind of opener. Each unbalanced
//! parenthesis thus spoils at most its own section.
//!
//! ```
//! use planner_core::syntax::{source::SourceFile, tree::Tree};
//! let tree = Tree::new(&SourceFile::new("p.pddl", "(at robot1 [cost a])"));
//! let list = tree.roots().next().unwrap();
//! let words: Vec<&str> = list.children().map(|node| node.text()).collect();
//! assert_eq!(words, ["at", "robot1", "[cost a]"]);
//! ```

mod builder;

use std::sync::Arc;

use super::code::Code;
use super::diagnostic::Diagnostic;
use super::lexer::{TokenKind, Tokens};
use super::source::SourceFile;
use super::span::Span;

/// Lists nested deeper than this are refused, so that no reader's recursion is unbounded.
pub const MAXIMUM_DEPTH: usize = 400;

/// The tree of one file.
#[derive(Clone, Debug)]
pub struct Tree {
    text: Arc<str>,
    tokens: Tokens,
    /// One past the last token of the list that starts here; for other tokens the next index.
    ends: Vec<u32>,
    diagnostics: Vec<Diagnostic>,
}

impl Tree {
    /// Reads a file; never fails, faults are in [`Tree::diagnostics`].
    #[must_use]
    pub fn new(file: &SourceFile) -> Self {
        let (tokens, ends, mut diagnostics) = builder::build(file);
        for fault in file.faults() {
            let only_comments = fault.code == Code::NotUtf8
                && (0..tokens.len())
                    .filter(|&token| file.slice(tokens.span(token)).contains('\u{fffd}'))
                    .all(|token| tokens.kinds[token] == TokenKind::Comment);
            let fault = fault.clone();
            diagnostics.push(if only_comments {
                fault.warning()
            } else {
                fault
            });
        }
        Self {
            text: file.shared_text(),
            tokens,
            ends,
            diagnostics: diagnostics.finish(),
        }
    }

    /// Faults of bytes, characters and parentheses.
    #[must_use]
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// All tokens, trivia included.
    #[must_use]
    pub const fn tokens(&self) -> &Tokens {
        &self.tokens
    }

    /// The whole text.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Nodes at the top.
    #[must_use]
    pub fn roots(&self) -> Children<'_> {
        Children {
            tree: self,
            next: 0,
            end: self.tokens.len() as u32,
        }
    }

    /// The innermost nodes around a byte offset, outermost first; a word counts when the offset
    /// touches its end.
    #[must_use]
    pub fn path_to(&self, offset: u32) -> Vec<Node<'_>> {
        let mut path = Vec::new();
        let mut level = self.roots();
        while let Some(node) = level.find(|node| {
            let span = node.span();
            let end = if node.kind() == NodeKind::Word || !node.is_closed() {
                span.end
            } else {
                span.end - 1
            };
            span.start <= offset && offset <= end
        }) {
            path.push(node);
            level = node.children();
        }
        path
    }
}

/// What a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeKind {
    /// `( ... )`
    List,
    /// `[ ... ]`
    Call,
    /// A word.
    Word,
}

/// A word, list or call of a tree.
#[derive(Clone, Copy, Debug)]
pub struct Node<'t> {
    tree: &'t Tree,
    token: u32,
}

impl<'t> Node<'t> {
    /// What it is.
    #[must_use]
    pub fn kind(self) -> NodeKind {
        match self.tree.tokens.kinds[self.token as usize] {
            TokenKind::LeftParenthesis => NodeKind::List,
            TokenKind::LeftBracket => NodeKind::Call,
            _ => NodeKind::Word,
        }
    }

    /// Whether it is `( ... )`.
    #[must_use]
    pub fn is_list(self) -> bool {
        self.kind() == NodeKind::List
    }

    /// The word, if it is one.
    #[must_use]
    pub fn word(self) -> Option<&'t str> {
        (self.kind() == NodeKind::Word).then(|| self.text())
    }

    /// Where it stands.
    #[must_use]
    pub fn span(self) -> Span {
        let starts = &self.tree.tokens.starts;
        let end = self.tree.ends[self.token as usize];
        Span::new(starts[self.token as usize], starts[end as usize])
    }

    /// The opener of a list, or the whole word.
    #[must_use]
    pub fn first_token_span(self) -> Span {
        self.tree.tokens.span(self.token as usize)
    }

    /// Whether the closer of a list was written.
    #[must_use]
    pub fn is_closed(self) -> bool {
        let last = self.tree.ends[self.token as usize] as usize - 1;
        last > self.token as usize
            && matches!(
                (self.kind(), self.tree.tokens.kinds[last]),
                (NodeKind::List, TokenKind::RightParenthesis)
                    | (NodeKind::Call, TokenKind::RightBracket)
            )
    }

    /// The text, from opener to closer for a list.
    #[must_use]
    pub fn text(self) -> &'t str {
        let span = self.span();
        &self.tree.text[span.start as usize..span.end as usize]
    }

    /// Index of its first token.
    #[must_use]
    pub const fn token(self) -> usize {
        self.token as usize
    }

    /// Index one past its last token.
    #[must_use]
    pub fn token_end(self) -> usize {
        self.tree.ends[self.token as usize] as usize
    }

    /// Its parts; none for a word.
    #[must_use]
    pub fn children(self) -> Children<'t> {
        let mut end = self.tree.ends[self.token as usize];
        if self.is_closed() {
            end -= 1;
        }
        Children {
            tree: self.tree,
            next: self.token + 1,
            end: end.max(self.token + 1),
        }
    }

    /// Its first part.
    #[must_use]
    pub fn head(self) -> Option<Node<'t>> {
        self.children().next()
    }
}

/// The parts of a list, without trivia.
#[derive(Clone, Copy, Debug)]
pub struct Children<'t> {
    tree: &'t Tree,
    next: u32,
    end: u32,
}

impl<'t> Iterator for Children<'t> {
    type Item = Node<'t>;

    fn next(&mut self) -> Option<Node<'t>> {
        while self.next < self.end {
            let token = self.next;
            let kind = self.tree.tokens.kinds[token as usize];
            if kind.is_trivia() {
                self.next += 1;
                continue;
            }
            self.next = self.tree.ends[token as usize];
            return Some(Node {
                tree: self.tree,
                token,
            });
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tree(text: &str) -> Tree {
        Tree::new(&SourceFile::new("t.pddl", text))
    }

    fn codes(tree: &Tree) -> Vec<Code> {
        tree.diagnostics().iter().map(|d| d.code).collect()
    }

    fn sections(tree: &Tree) -> Vec<String> {
        let root = tree.roots().next().unwrap();
        root.children()
            .filter(|node| node.is_list())
            .map(|node| node.head().unwrap().text().to_owned())
            .collect()
    }

    #[test]
    fn a_section_closes_what_is_open_before_it() {
        let tree = tree("(define (domain d)\n (:predicates (p) (q)\n (:action a)\n (:action b))");
        assert_eq!(codes(&tree), [Code::UnclosedParenthesis]);
        assert_eq!(
            sections(&tree),
            ["domain", ":predicates", ":action", ":action"]
        );
    }

    #[test]
    fn an_action_key_closes_the_condition_before_it() {
        let tree = tree(
            "(define (domain d) (:action a :precondition (and (p) (q) :effect (r)) (:action b))",
        );
        assert_eq!(codes(&tree), [Code::UnclosedParenthesis]);
        let diagnostic = &tree.diagnostics()[0];
        let open = "(define (domain d) (:action a :precondition ".len() as u32;
        assert_eq!(diagnostic.span.start, open);
        assert_eq!(sections(&tree), ["domain", ":action", ":action"]);
    }

    #[test]
    fn a_section_after_the_end_reopens_the_definition() {
        let tree = tree("(define (domain d)\n (:predicates (p)))\n (:action a)\n)");
        assert_eq!(codes(&tree), [Code::StrayCloser]);
        assert_eq!(sections(&tree), ["domain", ":predicates", ":action"]);
    }

    #[test]
    fn brackets_match_only_brackets() {
        let tree1 = tree("(a [b c) d)");
        assert_eq!(
            codes(&tree1),
            [Code::UnclosedParenthesis, Code::StrayCloser]
        );
        let tree2 = tree("(a b] c)");
        assert_eq!(codes(&tree2), [Code::StrayCloser]);
        let words: Vec<&str> = tree2
            .roots()
            .next()
            .unwrap()
            .children()
            .map(Node::text)
            .collect();
        assert_eq!(words, ["a", "b", "c"]);
    }

    #[test]
    fn indentation_tells_where_the_closer_is_missing() {
        let text = "(:init\n  (p a)\n  (q b\n  (r c)\n)";
        let tree = tree(text);
        let note = &tree.diagnostics()[0].notes[0];
        assert_eq!(note.span.start as usize, text.find("(r c)").unwrap());
    }

    #[test]
    fn deep_nesting_is_refused_not_followed() {
        for text in [
            "(".repeat(100_000),
            format!("{}{}", "(".repeat(100_000), ")".repeat(100_000)),
        ] {
            let tree = tree(&text);
            assert!(codes(&tree).contains(&Code::NestedTooDeeply));
            let mut depth = 0;
            let mut node = tree.roots().next();
            while let Some(inner) = node {
                depth += 1;
                node = inner.children().next();
            }
            assert_eq!(depth, MAXIMUM_DEPTH + 1);
        }
    }

    #[test]
    fn the_path_to_an_offset_goes_from_the_outermost_list_to_the_word() {
        let text = "(define (domain d) (:predicates (at ?x)))";
        let tree = tree(text);
        let path: Vec<&str> = tree
            .path_to(text.find("?x").unwrap() as u32)
            .into_iter()
            .map(Node::text)
            .collect();
        assert_eq!(path.len(), 4);
        assert_eq!(path[2..], ["(at ?x)", "?x"]);
    }
}
