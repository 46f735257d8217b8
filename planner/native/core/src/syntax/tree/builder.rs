//! Builds the tree from the tokens and recovers from unbalanced parentheses.

use super::MAXIMUM_DEPTH;
use crate::syntax::code::Code;
use crate::syntax::diagnostic::{Diagnostic, Diagnostics};
use crate::syntax::lexer::{TokenKind, Tokens, tokenize};
use crate::syntax::line_index::LineIndex;
use crate::syntax::source::SourceFile;
use crate::syntax::span::Span;

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

/// Tokens with what recovery left out marked, ends of lists, faults.
pub(super) fn build(file: &SourceFile) -> (Tokens, Vec<u32>, Diagnostics) {
    let tokens = tokenize(file.text());
    Builder {
        text: file.text(),
        lines: file.lines(),
        ends: vec![0; tokens.len()],
        tokens,
        stack: Vec::new(),
        last_root: None,
        diagnostics: Diagnostics::default(),
    }
    .build()
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
        let keep = near + matching + 1;
        if self.stack.len() > keep {
            let why = format!("`{}` follows", self.word(token));
            self.close_unclosed(keep, last_solid, &why);
        }
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
