//! Source text, spans, tokens, the lossless tree and diagnostics.
//!
//! ```text
//! bytes ──► SourceFile ──► Tokens (flat, with trivia) ──► Tree (lossless, recovered) ──► readers
//! ```
//!
//! The same tree serves the planner, the formatter and the editor.

pub mod code;
pub mod diagnostic;
pub mod lexer;
pub mod line_index;
pub mod render;
pub mod source;
pub mod span;
pub mod suggestion;
pub mod tree;
