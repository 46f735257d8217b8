//! Source text, spans, tokens, the lossless tree and diagnostics.

pub mod span;
