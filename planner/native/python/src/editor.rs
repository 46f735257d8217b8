//! What editors and the checking commands need: findings with places as editors count them, formatting,
//! occurrences of names, completions, the table of codes.
//!
//! Lines and columns count from 0 and columns are UTF-16 code units, as in the Language Server Protocol.

use planner_core::analysis::{self, Occurrence};
use planner_core::pddl;
use planner_core::syntax::code::{Code, TABLE};
use planner_core::syntax::diagnostic::{Diagnostic, Place};
use planner_core::syntax::line_index::Position;
use planner_core::syntax::render::render;
use planner_core::syntax::source::SourceFile;
use planner_core::syntax::span::Span;
use planner_core::syntax::tree::Tree;
use pyo3::prelude::*;

/// First line and column, last line and the column behind the end.
type Range = (u32, u32, u32, u32);

fn range(file: &SourceFile, span: Span) -> Range {
    let start = file.lines().position_utf16(file.text(), span.start);
    let end = file.lines().position_utf16(file.text(), span.end);
    (start.line, start.column, end.line, end.column)
}

/// One finding with everything an editor can show.
#[pyclass(frozen, get_all, module = "planner")]
pub struct Finding {
    /// Stable code, `PDDL021`.
    code: String,
    /// `error`, `warning` or `information`.
    severity: &'static str,
    /// One line.
    message: String,
    /// Written under the fault.
    label: String,
    /// The file's name.
    file: String,
    /// Where.
    range: Range,
    /// Other places: file, range, text.
    notes: Vec<(String, Range, String)>,
    /// How to mend it.
    remedy: Option<String>,
    /// The remedy as edits: title, ranges and replacements.
    fix: Option<(String, Vec<(Range, String)>)>,
    /// The finding with the line concerned and a caret under the fault.
    rendered: String,
}

fn finding(one: &Diagnostic, file: &SourceFile, domain: &SourceFile) -> Finding {
    let notes = one.notes.iter().map(|note| {
        let source = match note.place {
            Place::Here => file,
            Place::Domain => domain,
        };
        let place = range(source, note.span);
        (source.name().to_owned(), place, note.text.clone())
    });
    Finding {
        code: one.code.to_string(),
        severity: one.severity.word(),
        message: one.message.clone(),
        label: one.label.clone(),
        file: file.name().to_owned(),
        range: range(file, one.span),
        notes: notes.collect(),
        remedy: one.remedy.clone(),
        fix: one.fix.as_ref().map(|fix| {
            let edits = fix.edits.iter();
            let edits = edits.map(|edit| (range(file, edit.span), edit.replacement.clone()));
            (fix.title.clone(), edits.collect())
        }),
        rendered: render(one, file, Some(domain)),
    }
}

/// A file: name and bytes.
type File = (String, Vec<u8>);

fn source((name, bytes): File) -> SourceFile {
    SourceFile::from_bytes(name, &bytes)
}

/// Findings in the domain, then in each problem.
#[pyfunction]
pub fn check_files(
    py: Python<'_>,
    domain: File,
    problems: Vec<File>,
    providers: Option<Vec<String>>,
) -> Vec<Vec<Finding>> {
    py.detach(|| {
        let domain = source(domain);
        let problems: Vec<SourceFile> = problems.into_iter().map(source).collect();
        let borrowed: Vec<&SourceFile> = problems.iter().collect();
        let found = analysis::check_files(&domain, &borrowed, providers.as_deref());
        std::iter::once(&domain)
            .chain(&problems)
            .zip(found)
            .map(|(file, list)| list.iter().map(|one| finding(one, file, &domain)).collect())
            .collect()
    })
}

/// The formatted text, or why it cannot be formatted.
#[pyfunction]
pub fn format_file(py: Python<'_>, file: File) -> (Option<String>, Vec<Finding>) {
    py.detach(|| {
        let file = source(file);
        match planner_core::format::format(&file) {
            Ok(text) => (Some(text), Vec::new()),
            Err(faults) => {
                let faults = faults.iter().map(|one| finding(one, &file, &file));
                (None, faults.collect())
            }
        }
    })
}

/// A row of the table of codes: code, severity, title, what, why, example.
type Row = (
    String,
    &'static str,
    &'static str,
    &'static str,
    &'static str,
    &'static str,
);

/// All diagnostic codes.
#[pyfunction]
pub fn codes() -> Vec<Row> {
    TABLE
        .iter()
        .map(|entry| {
            (
                entry.code.to_string(),
                entry.severity.word(),
                entry.title,
                entry.what,
                entry.why,
                entry.example,
            )
        })
        .collect()
}

/// The code that somebody wrote as `PDDL021`, `pddl21` or `21`.
#[pyfunction]
pub fn parse_code(text: &str) -> Option<String> {
    Code::parse(text).map(|code| code.to_string())
}

/// `domain` or `problem`, its name, and for a problem the name of its domain.
#[pyfunction]
pub fn definition_of(text: &str) -> Option<(&'static str, String, Option<String>)> {
    let tree = Tree::new(&SourceFile::new("", text));
    let word = |text: Option<&str>| text.unwrap_or_default().to_ascii_lowercase();
    tree.roots().find_map(|root| {
        let header = root.children().nth(1)?;
        let mut parts = header.children();
        let kind = word(parts.next()?.word());
        let name = word(parts.next().and_then(|node| node.word()));
        match kind.as_str() {
            "domain" => Some(("domain", name, None)),
            "problem" => {
                let domain = root.children().find_map(|section| {
                    let mut parts = section.children();
                    let head = parts.next()?.word()?;
                    let domain = parts.next()?.word()?;
                    head.eq_ignore_ascii_case(":domain")
                        .then(|| domain.to_ascii_lowercase())
                });
                Some(("problem", name, domain))
            }
            _ => None,
        }
    })
}

/// A name somewhere in a file.
#[pyclass(frozen, get_all, module = "planner")]
pub struct Mention {
    /// `type`, `object`, `predicate`, `function`, `module`, `action`, `variable`, `domain`, `problem`.
    kind: &'static str,
    /// Lower-cased.
    name: String,
    /// As it stands here.
    text: String,
    /// Where.
    range: Range,
    /// Whether it is declared here.
    definition: bool,
    /// Tells variables of the same name apart; 0 for everything else.
    scope: u32,
    /// The list that declares it.
    declaration: Option<Range>,
    /// Its text.
    declaration_text: Option<String>,
}

fn mention(one: Occurrence, file: &SourceFile) -> Mention {
    Mention {
        kind: one.kind.word(),
        name: one.name,
        text: file.slice(one.span).to_owned(),
        range: range(file, one.span),
        definition: one.definition,
        scope: one.scope,
        declaration: one.declaration.map(|span| range(file, span)),
        declaration_text: one.declaration.map(|span| file.slice(span).to_owned()),
    }
}

/// All names in a problem read with a domain, or in the domain if there is no problem.
#[pyfunction]
pub fn mentions(py: Python<'_>, domain: Option<&str>, problem: Option<&str>) -> Vec<Mention> {
    py.detach(|| {
        let domain = domain.map(|text| SourceFile::new("", text));
        let problem = problem.map(|text| SourceFile::new("", text));
        let (domain_model, problem_model) = models(domain.as_ref(), problem.as_ref());
        let Some(file) = problem.as_ref().or(domain.as_ref()) else {
            return Vec::new();
        };
        let tree = Tree::new(file);
        analysis::occurrences(&tree, domain_model.as_ref(), problem_model.as_ref())
            .into_iter()
            .map(|one| mention(one, file))
            .collect()
    })
}

fn models(
    domain: Option<&SourceFile>,
    problem: Option<&SourceFile>,
) -> (Option<pddl::model::Domain>, Option<pddl::model::Problem>) {
    let domain = domain.and_then(|file| pddl::read_domain(file).0);
    let problem = match (&domain, problem) {
        (Some(domain), Some(file)) => pddl::read_problem(file, domain).0,
        _ => None,
    };
    (domain, problem)
}

/// What can be written: text, kind (`keyword` for words of the language), detail.
#[pyfunction]
pub fn completions(
    py: Python<'_>,
    text: &str,
    line: u32,
    column: u32,
    domain: Option<&str>,
) -> Vec<(String, &'static str, String)> {
    py.detach(|| {
        let file = SourceFile::new("", text);
        let domain = domain.map(|text| SourceFile::new("", text));
        let (mut domain_model, mut problem) = models(domain.as_ref(), Some(&file));
        if let (Some(model), Some(source)) = (&mut domain_model, &domain) {
            model.spell_as_in(source);
            if let Some(problem) = &mut problem {
                problem.spell_as_in(&file, model);
            }
        }
        let offset = file
            .lines()
            .offset_utf16(file.text(), Position { line, column });
        analysis::completions(
            &Tree::new(&file),
            offset,
            domain_model.as_ref(),
            problem.as_ref(),
        )
        .into_iter()
        .map(|one| {
            let kind = one.kind.map_or("keyword", |kind| kind.word());
            (one.text, kind, one.detail)
        })
        .collect()
    })
}

/// Adds everything to the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<Finding>()?;
    module.add_class::<Mention>()?;
    module.add_function(wrap_pyfunction!(check_files, module)?)?;
    module.add_function(wrap_pyfunction!(format_file, module)?)?;
    module.add_function(wrap_pyfunction!(codes, module)?)?;
    module.add_function(wrap_pyfunction!(parse_code, module)?)?;
    module.add_function(wrap_pyfunction!(definition_of, module)?)?;
    module.add_function(wrap_pyfunction!(mentions, module)?)?;
    module.add_function(wrap_pyfunction!(completions, module)?)
}
