//! The shape of plan text, before its names mean anything.
//!
//! ```text
//! plan     := step*
//! step     := [time ":"] "(" name argument* ")" ["[" duration "]"]
//! ```
//! Line breaks are blanks, comments may stand anywhere, letters become lower case. A step without
//! time starts one after the one before it, the first at 1, as in VAL.

use crate::syntax::code::Code;
use crate::syntax::diagnostic::{Diagnostic, Diagnostics};
use crate::syntax::lexer::{TokenKind, Tokens, tokenize};
use crate::syntax::source::SourceFile;
use crate::syntax::span::Span;

/// A word and where it stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Word {
    pub(super) text: String,
    pub(super) span: Span,
}

/// A step as written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct WrittenStep {
    pub(super) start: f64,
    /// Of the time, or of the opening parenthesis where there is none.
    pub(super) start_span: Span,
    pub(super) name: Word,
    pub(super) arguments: Vec<Word>,
    pub(super) duration: Option<(f64, Span)>,
    /// From the opening to the closing parenthesis.
    pub(super) span: Span,
}

/// Reads all steps; goes on behind a fault.
pub(super) fn parse(source: &SourceFile, diagnostics: &mut Diagnostics) -> Vec<WrittenStep> {
    let tokens = tokenize(source.text());
    let mut parser = Parser {
        source,
        significant: (0..tokens.len())
            .filter(|&token| {
                !matches!(
                    tokens.kinds[token],
                    TokenKind::WhiteSpace | TokenKind::Comment
                )
            })
            .collect(),
        tokens,
        position: 0,
        diagnostics,
    };
    let mut steps: Vec<WrittenStep> = Vec::new();
    let mut next_start = 1.0;
    while parser.position < parser.significant.len() {
        let before = parser.position;
        match parser.step(next_start) {
            Some(step) => {
                next_start = step.start + 1.0;
                steps.push(step);
            }
            None => parser.skip_line(before),
        }
    }
    steps
}

struct Parser<'s, 'd> {
    source: &'s SourceFile,
    tokens: Tokens,
    /// Tokens that are neither blanks nor comments.
    significant: Vec<usize>,
    position: usize,
    diagnostics: &'d mut Diagnostics,
}

impl Parser<'_, '_> {
    fn peek(&self) -> Option<TokenKind> {
        let token = *self.significant.get(self.position)?;
        Some(self.tokens.kinds[token])
    }

    /// The span of the next token, or the end of the text.
    fn span(&self) -> Span {
        self.significant.get(self.position).map_or_else(
            || {
                let end = u32::try_from(self.source.text().len()).unwrap_or(u32::MAX);
                Span::new(end.saturating_sub(1), end)
            },
            |token| self.tokens.span(*token),
        )
    }

    fn take(&mut self, kind: TokenKind) -> Option<Span> {
        let span = self.span();
        (self.peek() == Some(kind)).then(|| {
            self.position += 1;
            span
        })
    }

    fn fault(&mut self, span: Span, message: String) {
        self.diagnostics.push(
            Diagnostic::new(Code::MalformedStep, span, message)
                .label("here")
                .remedy("write steps as `0.000: (drive r1 a b) [5.000]`"),
        );
    }

    fn expected(&mut self, what: &str) {
        let span = self.span();
        let found = match self.peek() {
            Some(_) => format!("`{}`", self.source.slice(span)),
            None => "the end of the plan".into(),
        };
        self.fault(span, format!("expected {what}, found {found}"));
    }

    fn step(&mut self, next_start: f64) -> Option<WrittenStep> {
        let mut start_span = self.span();
        let start = if self.peek() == Some(TokenKind::Word) {
            let (time, span) = self.time()?;
            start_span = span;
            time
        } else {
            next_start
        };
        let Some(open) = self.take(TokenKind::LeftParenthesis) else {
            self.expected("an action such as `(drive r1 a b)`");
            return None;
        };
        let mut words = Vec::new();
        while let Some(span) = self.take(TokenKind::Word) {
            words.push(Word {
                text: self.source.slice(span).to_lowercase(),
                span,
            });
        }
        let Some(close) = self.take(TokenKind::RightParenthesis) else {
            self.expected("`)`");
            return None;
        };
        let duration = if self.peek() == Some(TokenKind::LeftBracket) {
            Some(self.duration()?)
        } else {
            None
        };
        let mut words = words.into_iter();
        let Some(name) = words.next() else {
            self.fault(open.join(close), "the step names no action".into());
            return None;
        };
        Some(WrittenStep {
            start,
            start_span,
            name,
            arguments: words.collect(),
            duration,
            span: open.join(close),
        })
    }

    /// `5.001:` or `5.001 :`
    fn time(&mut self) -> Option<(f64, Span)> {
        let span = self.take(TokenKind::Word)?;
        let text = self.source.slice(span);
        let number = match text.strip_suffix(':') {
            Some(number) => number,
            None if self.peek() == Some(TokenKind::Word)
                && self.source.slice(self.span()) == ":" =>
            {
                self.position += 1;
                text
            }
            None => {
                self.fault(
                    span,
                    format!("expected a step, found `{}`", self.source.slice(span)),
                );
                return None;
            }
        };
        match number.parse::<f64>() {
            Ok(time) if time.is_finite() => {
                let end = span.start + u32::try_from(number.len()).unwrap_or(0);
                Some((time, Span::new(span.start, end)))
            }
            _ => {
                self.fault(span, format!("`{number}` is no time in seconds"));
                None
            }
        }
    }

    /// `[5.0]`, `[ 5.0 ]` or `[D:5.0; C:1]` (what follows the semicolon is a comment then).
    fn duration(&mut self) -> Option<(f64, Span)> {
        let open = self.take(TokenKind::LeftBracket)?;
        let Some(span) = self.take(TokenKind::Word) else {
            self.expected("a duration such as `5.000`");
            return None;
        };
        let written = self.source.slice(span);
        let number = written
            .strip_prefix("D:")
            .or_else(|| written.strip_prefix("d:"))
            .unwrap_or(written)
            .to_owned();
        if self.take(TokenKind::RightBracket).is_none() {
            let rest = self.source.text()[span.end as usize..].trim_start();
            if !rest.starts_with(';') {
                self.expected("`]`");
                return None;
            }
        }
        match number.parse::<f64>() {
            Ok(duration) if duration.is_finite() => Some((duration, open.join(span))),
            _ => {
                self.fault(span, format!("`{number}` is no duration in seconds"));
                None
            }
        }
    }

    /// Goes on at the first token of a later line than the one at `before`.
    fn skip_line(&mut self, before: usize) {
        let line_of = |parser: &Self, index: usize| {
            let token = parser.significant[index];
            parser.source.lines().line(parser.tokens.span(token).start)
        };
        let line = line_of(self, before.max(self.position.saturating_sub(1)));
        self.position = self.position.max(before + 1);
        while self.position < self.significant.len() && line_of(self, self.position) <= line {
            self.position += 1;
        }
    }
}
