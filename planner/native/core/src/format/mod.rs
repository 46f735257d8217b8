//! The formatter: one layout for every file, comments kept.
//!
//! Only white space changes: words, their case, parentheses and comments stay in their order.
//! Formatting is idempotent, and reading a formatted file gives what the file gave before.
//!
//! A list stands on one line if it fits and holds no comment; otherwise its parts stand on lines of
//! their own, two columns further right than the line on which the list begins. One blank line
//! between parts is kept, and stands before every action.

mod items;
mod layout;
mod printer;

use crate::syntax::diagnostic::{Diagnostic, has_errors};
use crate::syntax::source::SourceFile;
use crate::syntax::tree::Tree;

/// Columns of a line.
pub const WIDTH: usize = 100;

/// Formats a file.
///
/// # Errors
/// Its diagnostics, if its parentheses or characters are faulty: then nobody knows what belongs where.
pub fn format(file: &SourceFile) -> Result<String, Vec<Diagnostic>> {
    let tree = Tree::new(file);
    if has_errors(tree.diagnostics()) {
        return Err(tree.diagnostics().to_vec());
    }
    Ok(layout::lay_out(&tree))
}
