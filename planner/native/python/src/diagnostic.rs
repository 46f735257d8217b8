//! Diagnostics as Python sees them: positions count from 1.

use planner_core::syntax::diagnostic;
use planner_core::syntax::render::render;
use planner_core::syntax::source::SourceFile;
use pyo3::prelude::*;

/// One finding about a file: what, where, how to mend it.
#[pyclass(frozen, get_all, module = "planner")]
pub struct Diagnostic {
    /// Stable code, `PDDL021`.
    code: String,
    /// `error`, `warning` or `information`.
    severity: &'static str,
    /// One line.
    message: String,
    /// The file's name.
    file: String,
    /// First line, from 1.
    line: u32,
    /// First column in characters, from 1.
    column: u32,
    /// Line of the end, from 1.
    end_line: u32,
    /// Column behind the end, from 1.
    end_column: u32,
    /// How to mend it; may be absent.
    remedy: Option<String>,
    /// The finding with the line concerned and a caret under the fault.
    rendered: String,
}

#[pymethods]
impl Diagnostic {
    fn __str__(&self) -> &str {
        &self.rendered
    }

    fn __repr__(&self) -> String {
        format!(
            "<Diagnostic {} {}:{}:{} {}>",
            self.code, self.file, self.line, self.column, self.message
        )
    }
}

/// Converts the diagnostics of one file.
pub fn convert(
    diagnostics: &[diagnostic::Diagnostic],
    file: &SourceFile,
    domain: Option<&SourceFile>,
) -> Vec<Diagnostic> {
    diagnostics
        .iter()
        .map(|one| {
            let start = file.lines().position(file.text(), one.span.start);
            let end = file.lines().position(file.text(), one.span.end);
            Diagnostic {
                code: one.code.to_string(),
                severity: one.severity.word(),
                message: one.message.clone(),
                file: file.name().to_owned(),
                line: start.line + 1,
                column: start.column + 1,
                end_line: end.line + 1,
                end_column: end.column + 1,
                remedy: one.remedy.clone(),
                rendered: render(one, file, domain),
            }
        })
        .collect()
}
