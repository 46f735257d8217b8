//! Diagnostics as text: file, line and column, the line itself, a caret under the fault, the remedy.
//!
//! ```text
//! error[PDDL021]: unknown predicate `claered`
//!   --> domain.pddl:12:14
//!    |
//! 12 |  :effect (at end (claered ?b))
//!    |                   ^^^^^^^ not declared in (:predicates ...)
//!    = help: did you mean `cleared`?
//! ```

use std::fmt::Write as _;

use super::diagnostic::{Diagnostic, Place};
use super::source::SourceFile;
use super::span::Span;

/// Characters shown of a line at most.
const WINDOW: usize = 160;

/// Renders one diagnostic of `file`; `domain` is the domain when `file` is a problem.
#[must_use]
pub fn render(diagnostic: &Diagnostic, file: &SourceFile, domain: Option<&SourceFile>) -> String {
    let notes: Vec<(&SourceFile, Span, &str)> = diagnostic
        .notes
        .iter()
        .filter_map(|note| {
            let source = match note.place {
                Place::Here => Some(file),
                Place::Domain => domain,
            };
            Some((source?, note.span, note.text.as_str()))
        })
        .collect();
    let margin = std::iter::once((file, diagnostic.span))
        .chain(notes.iter().map(|&(source, span, _)| (source, span)))
        .map(|(source, span)| (source.lines().line(span.start) + 1).to_string().len())
        .max()
        .unwrap_or(1);
    let mut out = format!(
        "{}[{}]: {}\n",
        diagnostic.severity.word(),
        diagnostic.code,
        diagnostic.message
    );
    excerpt(
        &mut out,
        margin,
        "-->",
        file,
        diagnostic.span,
        '^',
        &diagnostic.label,
    );
    for (source, span, text) in notes {
        excerpt(&mut out, margin, ":::", source, span, '-', text);
    }
    if let Some(remedy) = &diagnostic.remedy {
        let _ = writeln!(out, "{:margin$} = help: {remedy}", "");
    }
    out
}

/// Renders all of them, one blank line between each.
#[must_use]
pub fn render_all(
    diagnostics: &[Diagnostic],
    file: &SourceFile,
    domain: Option<&SourceFile>,
) -> String {
    let parts: Vec<String> = diagnostics
        .iter()
        .map(|diagnostic| render(diagnostic, file, domain))
        .collect();
    parts.join("\n")
}

fn excerpt(
    out: &mut String,
    margin: usize,
    arrow: &str,
    file: &SourceFile,
    span: Span,
    mark: char,
    label: &str,
) {
    let place = file.lines().position(file.text(), span.start);
    let (line, column) = (place.line + 1, place.column + 1);
    let range = file.lines().line_range(file.text(), place.line);
    let width = file
        .slice(Span::new(span.start, span.end.min(range.end as u32)))
        .chars()
        .count()
        .max(1);
    let shown = window(&file.text()[range], place.column as usize, width);
    let blank = "";
    let _ = writeln!(
        out,
        "{blank:margin$}{arrow} {}:{line}:{column}",
        file.name()
    );
    let _ = writeln!(out, "{blank:margin$} |");
    let _ = writeln!(out, "{line:margin$} | {}", shown.text);
    let marks: String = std::iter::repeat_n(mark, shown.width).collect();
    let space = if label.is_empty() { "" } else { " " };
    let _ = writeln!(
        out,
        "{blank:margin$} | {:indent$}{marks}{space}{label}",
        "",
        indent = shown.indent
    );
}

struct Shown {
    text: String,
    indent: usize,
    width: usize,
}

/// The part of a line around the fault, with control characters shown as blanks.
fn window(line: &str, column: usize, width: usize) -> Shown {
    let visible = |character: char| {
        if character.is_control() {
            ' '
        } else {
            character
        }
    };
    let first = if column + width.min(WINDOW / 2) > WINDOW {
        column - WINDOW / 4
    } else {
        0
    };
    let mut characters = line.chars().skip(first).map(visible);
    let mut text: String = characters.by_ref().take(WINDOW).collect();
    let width = width.min(WINDOW - (column - first)).max(1);
    if characters.next().is_some() {
        text.push_str(" ...");
    }
    let text = text.trim_end().to_owned();
    if first == 0 {
        return Shown {
            text,
            indent: column,
            width,
        };
    }
    Shown {
        text: format!("... {text}"),
        indent: column - first + 4,
        width,
    }
}

#[cfg(test)]
mod tests {
    use super::super::code::Code;
    use super::*;

    #[test]
    fn a_caret_stands_under_the_fault_and_the_remedy_below() {
        let file = SourceFile::new("d.pddl", "(a\n\t(claered ?b))\n");
        let start = file.text().find("claered").unwrap() as u32;
        let diagnostic = Diagnostic::new(
            Code::UnknownPredicate,
            Span::new(start, start + 7),
            "unknown predicate `claered`",
        )
        .label("not declared")
        .note(Span::new(0, 1), "inside this")
        .did_you_mean(Some("cleared"));
        let expected = "\
error[PDDL021]: unknown predicate `claered`
 --> d.pddl:2:3
  |
2 |  (claered ?b))
  |   ^^^^^^^ not declared
 ::: d.pddl:1:1
  |
1 | (a
  | - inside this
  = help: did you mean `cleared`?
";
        assert_eq!(render(&diagnostic, &file, None), expected);
    }

    #[test]
    fn a_very_long_line_is_cut_around_the_fault() {
        let text = format!("{}X{}", "a ".repeat(5000), " b".repeat(5000));
        let file = SourceFile::new("d.pddl", text);
        let diagnostic =
            Diagnostic::new(Code::UnknownPredicate, Span::new(10_000, 10_001), "unknown");
        let rendered = render(&diagnostic, &file, None);
        assert!(rendered.len() < 600, "{rendered}");
        let lines: Vec<&str> = rendered.lines().collect();
        let caret = lines[4].find('^').unwrap();
        assert_eq!(lines[3].as_bytes()[caret], b'X', "{rendered}");
    }

    #[test]
    fn an_empty_file_can_be_shown() {
        let file = SourceFile::new("d.pddl", "");
        let diagnostic = Diagnostic::new(Code::NotADefinition, Span::default(), "nothing here");
        assert!(render(&diagnostic, &file, None).contains("d.pddl:1:1"));
    }
}
