//! Lines and columns of byte offsets.

/// A place as people and editors count it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Position {
    /// Line, from 0.
    pub line: u32,
    /// Column, from 0, in the unit asked for.
    pub column: u32,
}

/// Starts of the lines of a text; `\n` ends a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LineIndex {
    starts: Vec<u32>,
}

impl LineIndex {
    /// Finds the lines of `text`, which must be shorter than 4 GiB.
    #[must_use]
    pub fn new(text: &str) -> Self {
        let starts = std::iter::once(0)
            .chain(
                text.bytes()
                    .enumerate()
                    .filter(|&(_, byte)| byte == b'\n')
                    .map(|(index, _)| index as u32 + 1),
            )
            .collect();
        Self { starts }
    }

    /// Number of lines; a text that ends with a newline has an empty last line.
    #[must_use]
    pub fn len(&self) -> usize {
        self.starts.len()
    }

    /// Never: even an empty text has one line.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.starts.is_empty()
    }

    /// The line, from 0, that holds a byte offset.
    #[must_use]
    pub fn line(&self, offset: u32) -> u32 {
        (self.starts.partition_point(|&start| start <= offset) - 1) as u32
    }

    /// First byte of a line.
    #[must_use]
    pub fn start(&self, line: u32) -> u32 {
        self.starts[line as usize]
    }

    /// Byte range of a line without its newline.
    #[must_use]
    pub fn line_range(&self, text: &str, line: u32) -> std::ops::Range<usize> {
        let Some(&start) = self.starts.get(line as usize) else {
            return text.len()..text.len();
        };
        let start = start as usize;
        let end = self
            .starts
            .get(line as usize + 1)
            .map_or(text.len(), |&next| next as usize - 1);
        let end = if end > start && text.as_bytes()[end - 1] == b'\r' {
            end - 1
        } else {
            end
        };
        start..end
    }

    /// Line and column in characters, both from 0.
    #[must_use]
    pub fn position(&self, text: &str, offset: u32) -> Position {
        self.measured(text, offset, |prefix| prefix.chars().count())
    }

    /// Line and column in UTF-16 code units, both from 0, as the Language Server Protocol counts.
    #[must_use]
    pub fn position_utf16(&self, text: &str, offset: u32) -> Position {
        self.measured(text, offset, |prefix| prefix.encode_utf16().count())
    }

    /// Byte offset of a line and UTF-16 column; a place past the end is moved to the end.
    #[must_use]
    pub fn offset_utf16(&self, text: &str, position: Position) -> u32 {
        let range = self.line_range(text, position.line);
        let mut units = 0;
        for (index, character) in text[range.clone()].char_indices() {
            if units >= position.column {
                return (range.start + index) as u32;
            }
            units += character.len_utf16() as u32;
        }
        range.end as u32
    }

    fn measured(&self, text: &str, offset: u32, count: impl Fn(&str) -> usize) -> Position {
        let mut end = (offset as usize).min(text.len());
        while !text.is_char_boundary(end) {
            end -= 1;
        }
        let line = self.line(end as u32);
        let start = self.starts[line as usize] as usize;
        Position {
            line,
            column: count(&text[start..end]) as u32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "ab\r\nä𝕏c\n";

    #[test]
    fn columns_count_characters_or_utf16_units() {
        let index = LineIndex::new(TEXT);
        let c = TEXT.find('c').unwrap() as u32;
        assert_eq!(index.position(TEXT, c), Position { line: 1, column: 2 });
        assert_eq!(
            index.position_utf16(TEXT, c),
            Position { line: 1, column: 3 }
        );
        assert_eq!(index.offset_utf16(TEXT, Position { line: 1, column: 3 }), c);
    }

    #[test]
    fn places_past_the_end_are_moved_to_the_end() {
        let index = LineIndex::new(TEXT);
        assert_eq!(index.len(), 3);
        assert_eq!(
            index.offset_utf16(TEXT, Position { line: 9, column: 9 }),
            TEXT.len() as u32
        );
        assert_eq!(index.offset_utf16(TEXT, Position { line: 0, column: 9 }), 2);
        assert_eq!(index.position(TEXT, 999), Position { line: 2, column: 0 });
    }
}
