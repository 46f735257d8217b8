//! What is wrong with a file, where, and how to mend it.

use super::code::Code;
use super::span::Span;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The file cannot be used for planning.
    Error,
    /// The file can be used, but it probably does not say what was meant.
    Warning,
    /// Worth knowing.
    Information,
}

impl Severity {
    /// The word printed.
    #[must_use]
    pub const fn word(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Information => "information",
        }
    }
}

/// Which file a span belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// The file that the diagnostic is about.
    Here,
    /// The domain, when the diagnostic is about a problem.
    Domain,
}

/// A second place that helps to understand the first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Which file.
    pub place: Place,
    /// Where in it.
    pub span: Span,
    /// What is to be seen there.
    pub text: String,
}

/// Replaces the text of a span (empty for an insertion).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edit {
    /// What is replaced.
    pub span: Span,
    /// By what.
    pub replacement: String,
}

/// A change that mends the fault and that an editor can make.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    /// What it does.
    pub title: String,
    /// Edits of the file that the diagnostic is about; they do not overlap.
    pub edits: Vec<Edit>,
}

/// One finding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Stable code.
    pub code: Code,
    /// How bad it is; usually the code's own severity.
    pub severity: Severity,
    /// One line: what is wrong.
    pub message: String,
    /// The fault.
    pub span: Span,
    /// Written under the fault; may be empty.
    pub label: String,
    /// Other places.
    pub notes: Vec<Note>,
    /// How to mend it.
    pub remedy: Option<String>,
    /// The remedy as an edit.
    pub fix: Option<Fix>,
}

impl Diagnostic {
    /// A finding of the code's own severity.
    #[must_use]
    pub fn new(code: Code, span: Span, message: impl Into<String>) -> Self {
        Self {
            code,
            severity: code.entry().severity,
            message: message.into(),
            span,
            label: String::new(),
            notes: Vec::new(),
            remedy: None,
            fix: None,
        }
    }

    /// Makes it a warning.
    #[must_use]
    pub const fn warning(mut self) -> Self {
        self.severity = Severity::Warning;
        self
    }

    /// Sets what is written under the fault.
    #[must_use]
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    /// Adds a place in the same file.
    #[must_use]
    pub fn note(mut self, span: Span, text: impl Into<String>) -> Self {
        self.notes.push(Note {
            place: Place::Here,
            span,
            text: text.into(),
        });
        self
    }

    /// Adds a place in the same file or in the domain.
    #[must_use]
    pub fn note_at(mut self, place: Place, span: Span, text: impl Into<String>) -> Self {
        self.notes.push(Note {
            place,
            span,
            text: text.into(),
        });
        self
    }

    /// Says how to mend it.
    #[must_use]
    pub fn remedy(mut self, remedy: impl Into<String>) -> Self {
        self.remedy = Some(remedy.into());
        self
    }

    /// Gives the remedy as one edit.
    #[must_use]
    pub fn fix(mut self, title: impl Into<String>, span: Span, replacement: &str) -> Self {
        self.fix = Some(Fix {
            title: title.into(),
            edits: vec![Edit {
                span,
                replacement: replacement.to_owned(),
            }],
        });
        self
    }

    /// Suggests another name for the text at the fault: remedy and fix in one.
    #[must_use]
    pub fn did_you_mean(self, name: Option<&str>) -> Self {
        let Some(name) = name else { return self };
        let span = self.span;
        self.remedy(format!("did you mean `{name}`?")).fix(
            format!("Replace with `{name}`"),
            span,
            name,
        )
    }
}

/// Whether any of them is an error.
#[must_use]
pub fn has_errors(diagnostics: &[Diagnostic]) -> bool {
    diagnostics
        .iter()
        .any(|diagnostic| diagnostic.severity == Severity::Error)
}

/// Collects diagnostics of one file; of each code only the first ones are kept, so that a file with a
/// million equal faults does not drown its reader.
#[derive(Clone, Debug, Default)]
pub struct Diagnostics {
    list: Vec<Diagnostic>,
    counts: Vec<(Code, usize)>,
}

impl Diagnostics {
    /// Diagnostics kept of one code.
    pub const KEPT_PER_CODE: usize = 100;

    /// Adds one.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        let code = diagnostic.code;
        let count = match self.counts.iter_mut().find(|(seen, _)| *seen == code) {
            Some((_, count)) => count,
            None => {
                self.counts.push((code, 0));
                &mut self.counts.last_mut().expect("just pushed").1
            }
        };
        *count += 1;
        if *count <= Self::KEPT_PER_CODE {
            self.list.push(diagnostic);
        }
    }

    /// Whether further diagnostics of a code are only counted.
    #[must_use]
    pub fn is_full(&self, code: Code) -> bool {
        self.counts
            .iter()
            .any(|&(seen, count)| seen == code && count >= Self::KEPT_PER_CODE)
    }

    /// Counts a diagnostic of a code that is full.
    pub fn count(&mut self, code: Code) {
        if let Some((_, count)) = self.counts.iter_mut().find(|(seen, _)| *seen == code) {
            *count += 1;
        }
    }

    /// Number of errors and warnings kept so far.
    #[must_use]
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether none was added.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// All of them in the order of the file; the last of a code says how many were left out.
    #[must_use]
    pub fn finish(mut self) -> Vec<Diagnostic> {
        self.list
            .sort_by_key(|diagnostic| (diagnostic.span, diagnostic.code.number()));
        for (code, count) in self.counts {
            if count > Self::KEPT_PER_CODE
                && let Some(last) = self.list.iter_mut().rev().find(|d| d.code == code)
            {
                let more = count - Self::KEPT_PER_CODE;
                last.message = format!("{} (and {more} more like this)", last.message);
            }
        }
        self.list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_faults_are_counted_not_repeated() {
        let mut all = Diagnostics::default();
        for start in 0..250 {
            all.push(Diagnostic::new(
                Code::UnknownPredicate,
                Span::new(start, start + 1),
                "unknown predicate `p`",
            ));
        }
        all.push(Diagnostic::new(Code::NotUtf8, Span::new(7, 8), "x"));
        let list = all.finish();
        assert_eq!(list.len(), Diagnostics::KEPT_PER_CODE + 1);
        assert!(
            list.last()
                .unwrap()
                .message
                .ends_with("(and 150 more like this)")
        );
        assert!(list.is_sorted_by_key(|diagnostic| diagnostic.span));
    }
}
