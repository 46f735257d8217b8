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

use std::sync::Arc;

use super::code::Code;
use super::diagnostic::{Diagnostic, Diagnostics};
use super::lexer::{TokenKind, Tokens, tokenize};
use super::line_index::LineIndex;
use super::source::SourceFile;
use super::span::Span;

/// Lists nested deeper than this are refused, so that no reader's recursion is unbounded.
pub const MAXIMUM_DEPTH: usize = 400;

/// Keywords that open a section directly inside `(define`.
const SECTIONS: [&str; 21] = [
    ":domain",
    ":requirements",
    ":types",
    ":constants",
    ":predicates",
    ":functions",
    ":modules",
    ":action",
    ":durative-action",
    ":derived",
    ":process",
    ":event",
    ":constraints",
    ":objects",
    ":init",
    ":goal",
    ":metric",
    ":length",
    ":oplinit",
    ":moduleoptions",
    ":moduleexitoptions",
];

/// Keys that stand directly inside an action.
const ACTION_KEYS: [&str; 5] = [
    ":parameters",
    ":duration",
    ":condition",
    ":precondition",
    ":effect",
];

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
        let tokens = tokenize(file.text());
        let builder = Builder {
            text: file.text(),
            lines: file.lines(),
            ends: vec![0; tokens.len()],
            tokens,
            stack: Vec::new(),
            last_root: None,
            diagnostics: Diagnostics::default(),
        };
        let (tokens, ends, mut diagnostics) = builder.build();
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

struct Builder<'s> {
    text: &'s str,
    lines: &'s LineIndex,
    tokens: Tokens,
    ends: Vec<u32>,
    /// Openers not yet closed.
    stack: Vec<u32>,
    /// The last list closed at the top: opener and closer.
    last_root: Option<(u32, u32)>,
    diagnostics: Diagnostics,
}

impl Builder<'_> {
    fn build(mut self) -> (Tokens, Vec<u32>, Diagnostics) {
        let mut last_solid = 0;
        for token in 0..self.tokens.len() as u32 {
            let index = token as usize;
            self.ends[index] = token + 1;
            match self.tokens.kinds[index] {
                TokenKind::LeftParenthesis | TokenKind::LeftBracket => {
                    if let Some(section) = self.section_after(token) {
                        self.start_section(last_solid, token, section);
                    }
                    self.stack.push(token);
                }
                TokenKind::RightParenthesis | TokenKind::RightBracket => {
                    self.close(last_solid, token);
                }
                TokenKind::Word => self.check_word(last_solid, token),
                TokenKind::Invalid => self.report_invalid(token),
                TokenKind::WhiteSpace | TokenKind::Comment | TokenKind::Skipped => {}
            }
            if !self.tokens.kinds[index].is_trivia() {
                last_solid = token;
            }
        }
        self.close_unclosed(0, last_solid, "the file ends");
        (self.tokens, self.ends, self.diagnostics)
    }

    fn word(&self, token: u32) -> &str {
        let span = self.tokens.span(token as usize);
        &self.text[span.start as usize..span.end as usize]
    }

    /// The section keyword directly behind an opener.
    fn section_after(&self, opener: u32) -> Option<&'static str> {
        let next = opener as usize + 1;
        if *self.tokens.kinds.get(next)? != TokenKind::Word {
            return None;
        }
        let word = self.word(next as u32);
        if !word.starts_with(':') {
            return None;
        }
        SECTIONS
            .into_iter()
            .find(|section| word.eq_ignore_ascii_case(section))
    }

    fn start_section(&mut self, last_solid: u32, token: u32, section: &str) {
        if self.stack.len() > 1 {
            self.close_unclosed(1, last_solid, &format!("`({section}` begins"));
        } else if self.stack.is_empty()
            && let Some((opener, closer)) = self.last_root.take()
        {
            let section_span = self.tokens.span(token as usize + 1);
            self.diagnostics.push(
                Diagnostic::new(
                    Code::StrayCloser,
                    self.tokens.span(closer as usize),
                    "this parenthesis ends the definition too early",
                )
                .label("one too many here or before")
                .note(section_span, format!("`{section}` still belongs to it"))
                .remedy("remove one `)`"),
            );
            self.tokens.kinds[closer as usize] = TokenKind::Skipped;
            self.stack.push(opener);
        }
    }

    fn check_word(&mut self, last_solid: u32, token: u32) {
        if self.stack.len() <= 2 || !self.word(token).starts_with(':') {
            return;
        }
        let word = self.word(token);
        let Some(key) = ACTION_KEYS
            .into_iter()
            .find(|key| word.eq_ignore_ascii_case(key))
        else {
            return;
        };
        let in_action = self.section_after(self.stack[1]).is_some_and(|section| {
            matches!(
                section,
                ":action" | ":durative-action" | ":process" | ":event"
            )
        });
        if in_action {
            self.close_unclosed(2, last_solid, &format!("`{key}` begins"));
        }
    }

    fn close(&mut self, last_solid: u32, token: u32) {
        let kind = self.tokens.kinds[token as usize];
        let opener_kind = if kind == TokenKind::RightParenthesis {
            TokenKind::LeftParenthesis
        } else {
            TokenKind::LeftBracket
        };
        let near = self.stack.len().saturating_sub(2);
        let matching = self.stack[near..]
            .iter()
            .rposition(|&opener| self.tokens.kinds[opener as usize] == opener_kind);
        let Some(matching) = matching else {
            let closer = self.word(token).to_owned();
            self.diagnostics.push(
                Diagnostic::new(
                    Code::StrayCloser,
                    self.tokens.span(token as usize),
                    format!("`{closer}` closes nothing"),
                )
                .label("no opener belongs to it")
                .remedy(format!("remove this `{closer}`"))
                .fix(
                    format!("Remove `{closer}`"),
                    self.tokens.span(token as usize),
                    "",
                ),
            );
            self.tokens.kinds[token as usize] = TokenKind::Skipped;
            return;
        };
        let closer = self.word(token).to_owned();
        self.close_unclosed(
            near + matching + 1,
            last_solid,
            &format!("`{closer}` follows"),
        );
        let opener = self.stack.pop().expect("the matching opener is on top");
        self.ends[opener as usize] = token + 1;
        self.limit_depth(opener, token);
        if self.stack.is_empty() {
            self.last_root = Some((opener, token));
        }
    }

    /// Closes all but the outermost `keep` open lists behind `last_solid`, with one diagnostic.
    fn close_unclosed(&mut self, keep: usize, last_solid: u32, why: &str) {
        if self.stack.len() <= keep {
            return;
        }
        let count = self.stack.len() - keep;
        let innermost = *self.stack.last().expect("longer than `keep`");
        let kind = self.tokens.kinds[innermost as usize];
        let (what, closer) = if kind == TokenKind::LeftBracket {
            ("bracket", "]")
        } else {
            ("parenthesis", ")")
        };
        let message = if count == 1 {
            format!("this {what} is never closed")
        } else {
            format!("{count} parentheses are never closed, this is the innermost")
        };
        let end = self.tokens.span(last_solid as usize).end;
        let span = self.tokens.span(innermost as usize);
        let mut diagnostic = Diagnostic::new(Code::UnclosedParenthesis, span, message)
            .label(format!("still open where {why}"))
            .remedy(format!("add the missing `{closer}`"));
        diagnostic = match self.suspect(innermost, last_solid) {
            Some(place) => diagnostic.note(
                self.tokens.span(place as usize),
                format!("by its indentation, `{closer}` is missing before this"),
            ),
            None => diagnostic.fix(
                format!("Insert `{closer}`"),
                Span::new(end, end),
                &closer.repeat(count),
            ),
        };
        self.diagnostics.push(diagnostic);
        while self.stack.len() > keep {
            let opener = self.stack.pop().expect("longer than `keep`");
            self.ends[opener as usize] = last_solid + 1;
            self.limit_depth(opener, last_solid + 1);
        }
    }

    /// The first list inside an unclosed one that starts a line no further right than the line on
    /// which the list around it starts: most likely the closer is missing before it.
    fn suspect(&self, opener: u32, last: u32) -> Option<u32> {
        let mut known = (u32::MAX, 0);
        // Indentation of the line of a token, and whether the token is the first in it.
        let mut indentation = |token: u32| {
            let start = self.tokens.span(token as usize).start;
            let line = self.lines.line(start);
            let line_start = self.lines.start(line);
            if known.0 != line {
                let text = &self.text.as_bytes()[line_start as usize..];
                let blanks = text.iter().take_while(|byte| matches!(byte, b' ' | b'\t'));
                known = (line, blanks.count() as u32);
            }
            (known.1, start - line_start == known.1)
        };
        let mut open = vec![indentation(opener).0];
        for token in opener + 1..=last {
            match self.tokens.kinds[token as usize] {
                TokenKind::LeftParenthesis | TokenKind::LeftBracket => {
                    let (here, first_in_line) = indentation(token);
                    if first_in_line && open.last().is_some_and(|&around| here <= around) {
                        return Some(token);
                    }
                    open.push(here);
                }
                TokenKind::RightParenthesis | TokenKind::RightBracket => {
                    open.pop();
                }
                _ => {}
            }
            if open.len() > MAXIMUM_DEPTH {
                return None;
            }
        }
        None
    }

    /// Takes the inside of a list at the greatest depth out of the tree.
    fn limit_depth(&mut self, opener: u32, end: u32) {
        if self.stack.len() != MAXIMUM_DEPTH {
            return;
        }
        self.diagnostics.push(
            Diagnostic::new(
                Code::NestedTooDeeply,
                self.tokens.span(opener as usize),
                format!("nested more than {MAXIMUM_DEPTH} lists deep"),
            )
            .label("what is inside is not read")
            .remedy("write sums and conjunctions with many members in one list"),
        );
        for token in opener + 1..end {
            let kind = &mut self.tokens.kinds[token as usize];
            if !kind.is_trivia() {
                *kind = TokenKind::Skipped;
            }
        }
    }

    fn report_invalid(&mut self, token: u32) {
        let span = self.tokens.span(token as usize);
        let shown: String = self
            .word(token)
            .chars()
            .take(8)
            .flat_map(char::escape_default)
            .collect();
        self.diagnostics.push(
            Diagnostic::new(
                Code::InvalidCharacter,
                span,
                format!("`{shown}` has no meaning in PDDL"),
            )
            .label("not allowed here")
            .remedy("remove it, or make it a comment with `;`"),
        );
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
