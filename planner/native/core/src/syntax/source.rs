//! A source file: its name, its text and what was wrong with its bytes.

use std::sync::Arc;

use super::code::Code;
use super::diagnostic::Diagnostic;
use super::line_index::LineIndex;
use super::span::Span;

/// A file or a text given by a caller. All spans are byte offsets into [`SourceFile::text`].
#[derive(Clone, Debug)]
pub struct SourceFile {
    name: String,
    text: Arc<str>,
    lines: LineIndex,
    faults: Vec<Diagnostic>,
}

impl SourceFile {
    /// A file from text that is known to be UTF-8; `name` is shown in diagnostics.
    #[must_use]
    pub fn new(name: impl Into<String>, text: impl Into<Arc<str>>) -> Self {
        let text = text.into();
        if u32::try_from(text.len()).is_err() {
            return Self::refused(name.into(), text.len());
        }
        Self {
            name: name.into(),
            lines: LineIndex::new(&text),
            text,
            faults: Vec::new(),
        }
    }

    /// A file from bytes. A byte order mark is skipped; bytes that are not UTF-8 become U+FFFD and a diagnostic.
    #[must_use]
    pub fn from_bytes(name: impl Into<String>, bytes: &[u8]) -> Self {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let error = match std::str::from_utf8(bytes) {
            Ok(text) => return Self::new(name, text),
            Err(error) => error,
        };
        let mut file = Self::new(name, String::from_utf8_lossy(bytes));
        if file.text.is_empty() {
            return file;
        }
        let start = error.valid_up_to() as u32;
        file.faults.push(
            Diagnostic::new(
                Code::NotUtf8,
                Span::new(start, start + '\u{fffd}'.len_utf8() as u32),
                format!("byte {:#04x} is not UTF-8", bytes[start as usize]),
            )
            .label("the first byte that cannot be decoded")
            .remedy("save the file as UTF-8"),
        );
        file
    }

    fn refused(name: String, length: usize) -> Self {
        let mut file = Self::new(name, "");
        file.faults.push(
            Diagnostic::new(
                Code::FileTooLarge,
                Span::default(),
                format!("the file has {length} bytes"),
            )
            .label("at most 4 GiB can be read")
            .remedy("split the problem"),
        );
        file
    }

    /// The name shown in diagnostics.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The text.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The text, shared.
    #[must_use]
    pub fn shared_text(&self) -> Arc<str> {
        Arc::clone(&self.text)
    }

    /// Lines and columns of byte offsets.
    #[must_use]
    pub const fn lines(&self) -> &LineIndex {
        &self.lines
    }

    /// The text that a span covers.
    #[must_use]
    pub fn slice(&self, span: Span) -> &str {
        self.text
            .get(span.start as usize..span.end as usize)
            .unwrap_or_default()
    }

    /// What was wrong with the bytes.
    #[must_use]
    pub fn faults(&self) -> &[Diagnostic] {
        &self.faults
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_that_are_not_utf8_become_a_diagnostic_at_the_first_of_them() {
        let file = SourceFile::from_bytes("d.pddl", b"ab\xff\xfe c");
        assert_eq!(file.text(), "ab\u{fffd}\u{fffd} c");
        assert_eq!(file.faults().len(), 1);
        assert_eq!(file.faults()[0].code, Code::NotUtf8);
        assert_eq!(file.slice(file.faults()[0].span), "\u{fffd}");
    }

    #[test]
    fn a_slice_out_of_range_is_empty() {
        let file = SourceFile::new("d.pddl", "abc");
        assert_eq!(file.slice(Span::new(1, 3)), "bc");
        assert_eq!(file.slice(Span::new(2, 9)), "");
    }
}
