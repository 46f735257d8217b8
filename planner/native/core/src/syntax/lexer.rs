//! Splits text into a flat, lossless array of tokens, white space and comments included.

use super::span::Span;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TokenKind {
    /// `(`
    LeftParenthesis,
    /// `)`
    RightParenthesis,
    /// `[`, opens the call of a module.
    LeftBracket,
    /// `]`
    RightBracket,
    /// A name, variable, keyword, number or operator.
    Word,
    /// Blanks and newlines.
    WhiteSpace,
    /// `;` to the end of the line.
    Comment,
    /// Characters that PDDL has no use for.
    Invalid,
    /// A token that recovery left out of the tree: a closer without opener, or too deep nesting.
    Skipped,
}

impl TokenKind {
    /// Whether the token is no part of the tree.
    #[must_use]
    pub const fn is_trivia(self) -> bool {
        matches!(
            self,
            Self::WhiteSpace | Self::Comment | Self::Invalid | Self::Skipped
        )
    }

    /// Whether the token opens a list or a call.
    #[must_use]
    pub const fn opens(self) -> bool {
        matches!(self, Self::LeftParenthesis | Self::LeftBracket)
    }
}

/// All tokens of a text; token `i` ends where token `i + 1` starts, so nothing can be lost.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tokens {
    /// What each token is.
    pub kinds: Vec<TokenKind>,
    /// First byte of each token, and the length of the text at the end.
    pub starts: Vec<u32>,
}

impl Tokens {
    /// Number of tokens.
    #[must_use]
    pub fn len(&self) -> usize {
        self.kinds.len()
    }

    /// Whether the text was empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.kinds.is_empty()
    }

    /// Where a token stands.
    #[must_use]
    pub fn span(&self, token: usize) -> Span {
        Span::new(self.starts[token], self.starts[token + 1])
    }
}

/// Splits a text shorter than 4 GiB into tokens in linear time.
#[must_use]
pub fn tokenize(text: &str) -> Tokens {
    let bytes = text.as_bytes();
    let mut tokens = Tokens {
        kinds: Vec::with_capacity(bytes.len() / 3),
        starts: Vec::with_capacity(bytes.len() / 3 + 1),
    };
    let mut position = 0;
    while position < bytes.len() {
        let start = position;
        let class = CLASSES[bytes[start] as usize];
        let kind = match class {
            Class::Delimiter(kind) => {
                position += 1;
                kind
            }
            Class::Semicolon => {
                position = bytes[start..]
                    .iter()
                    .position(|&byte| byte == b'\n')
                    .map_or(bytes.len(), |length| start + length);
                TokenKind::Comment
            }
            Class::Blank | Class::Invalid | Class::Word => {
                position += 1;
                while position < bytes.len() && CLASSES[bytes[position] as usize] == class {
                    position += 1;
                }
                match class {
                    Class::Blank => TokenKind::WhiteSpace,
                    Class::Invalid => TokenKind::Invalid,
                    _ => TokenKind::Word,
                }
            }
        };
        tokens.kinds.push(kind);
        tokens.starts.push(start as u32);
    }
    tokens.starts.push(bytes.len() as u32);
    tokens
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Class {
    Delimiter(TokenKind),
    Semicolon,
    Blank,
    Invalid,
    Word,
}

/// Class of every byte; bytes of multi-byte characters count as letters.
static CLASSES: [Class; 256] = {
    let mut classes = [Class::Word; 256];
    let mut byte = 0;
    while byte < 256 {
        classes[byte] = match byte as u8 {
            b'(' => Class::Delimiter(TokenKind::LeftParenthesis),
            b')' => Class::Delimiter(TokenKind::RightParenthesis),
            b'[' => Class::Delimiter(TokenKind::LeftBracket),
            b']' => Class::Delimiter(TokenKind::RightBracket),
            b';' => Class::Semicolon,
            b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c => Class::Blank,
            b'"' | b'\'' | b'`' | b',' | b'{' | b'}' | 0x7f | 0..=0x1f => Class::Invalid,
            _ => Class::Word,
        };
        byte += 1;
    }
    classes
};

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn tokens_of_a_small_text() {
        let text = "(p ?x) ; why\n[m a]\0{";
        let tokens = tokenize(text);
        let kinds: Vec<_> = tokens.kinds.clone();
        use TokenKind::*;
        assert_eq!(
            kinds,
            [
                LeftParenthesis,
                Word,
                WhiteSpace,
                Word,
                RightParenthesis,
                WhiteSpace,
                Comment,
                WhiteSpace,
                LeftBracket,
                Word,
                WhiteSpace,
                Word,
                RightBracket,
                Invalid
            ]
        );
    }

    proptest! {
        #[test]
        fn nothing_is_lost_and_every_boundary_is_a_character_boundary(text in "[\\PC\\n\\t();\\[\\]]{0,80}") {
            let tokens = tokenize(&text);
            prop_assert_eq!(tokens.starts.first().copied(), Some(0));
            let joined: String = (0..tokens.len())
                .map(|token| {
                    let span = tokens.span(token);
                    &text[span.start as usize..span.end as usize]
                })
                .collect();
            prop_assert_eq!(joined, text);
        }
    }
}
