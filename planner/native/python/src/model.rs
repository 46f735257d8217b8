//! Domains and problems as Python sees them.

use std::sync::Arc;

use planner_core::pddl;
use planner_core::pddl::model;
use planner_core::syntax::diagnostic::has_errors;
use planner_core::syntax::source::SourceFile;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PySet, PyTuple};

use crate::diagnostic::{Diagnostic, convert};
use crate::panic;

/// A domain: read once, used for many problems.
#[pyclass(frozen, module = "planner")]
pub struct Domain {
    pub model: Arc<model::Domain>,
    pub source: Arc<SourceFile>,
}

/// A problem, read against its domain.
#[pyclass(frozen, module = "planner")]
pub struct Problem {
    pub domain: Py<Domain>,
    pub model: Arc<model::Problem>,
    pub source: Arc<SourceFile>,
}

/// An entry of `(:modules ...)`.
#[pyclass(frozen, get_all, module = "planner")]
pub struct Module {
    /// The name used between square brackets.
    name: String,
    /// `cost`, `conditionchecker` or `effect`.
    kind: &'static str,
    /// The provider as written: `pathCost@libgrid.so`.
    call: String,
    /// Names and types of the parameters.
    parameters: Vec<(String, Vec<String>)>,
}

/// Reads a domain; `None` where a diagnostic is an error.
#[pyfunction]
pub fn read_domain(
    py: Python<'_>,
    text: &[u8],
    name: &str,
) -> PyResult<(Option<Py<Domain>>, Vec<Diagnostic>)> {
    let source = SourceFile::from_bytes(name, text);
    let (model, diagnostics) = panic::detached(py, || pddl::read_domain(&source))?;
    let model = model.filter(|_| !has_errors(&diagnostics));
    let diagnostics = convert(&diagnostics, &source, None);
    let domain = model
        .map(|model| {
            Py::new(
                py,
                Domain {
                    model: Arc::new(model),
                    source: Arc::new(source),
                },
            )
        })
        .transpose()?;
    Ok((domain, diagnostics))
}

/// Reads a problem against its domain; `None` where a diagnostic is an error.
#[pyfunction]
pub fn read_problem(
    py: Python<'_>,
    domain: &Bound<'_, Domain>,
    text: &[u8],
    name: &str,
) -> PyResult<(Option<Py<Problem>>, Vec<Diagnostic>)> {
    let source = SourceFile::from_bytes(name, text);
    let parsed = Arc::clone(&domain.get().model);
    let (model, diagnostics) = panic::detached(py, || pddl::read_problem(&source, &parsed))?;
    let model = model.filter(|_| !has_errors(&diagnostics));
    let diagnostics = convert(&diagnostics, &source, Some(&domain.get().source));
    let problem = model
        .map(|model| {
            Py::new(
                py,
                Problem {
                    domain: domain.clone().unbind(),
                    model: Arc::new(model),
                    source: Arc::new(source),
                },
            )
        })
        .transpose()?;
    Ok((problem, diagnostics))
}

impl Domain {
    fn type_names(&self, types: &[model::TypeId]) -> Vec<String> {
        types
            .iter()
            .map(|one| self.model.types[one.index()].name.text.clone())
            .collect()
    }
}

#[pymethods]
impl Domain {
    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.model.name.text
    }

    /// Its text as read.
    #[getter]
    fn text(&self) -> &str {
        self.source.text()
    }

    /// The name of the file it was read from.
    #[getter]
    fn file(&self) -> &str {
        self.source.name()
    }

    /// Names of the actions, in the order written.
    #[getter]
    fn actions(&self) -> Vec<&str> {
        self.model
            .actions
            .iter()
            .map(|action| action.name.text.as_str())
            .collect()
    }

    /// `(:requirements ...)` as written.
    #[getter]
    fn requirements(&self) -> Vec<&str> {
        self.model
            .requirements
            .iter()
            .map(|one| one.text.as_str())
            .collect()
    }

    /// Types and their direct supertypes.
    #[getter]
    fn types<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let types = PyDict::new(py);
        for one in &self.model.types {
            types.set_item(&one.name.text, self.type_names(&one.parents))?;
        }
        Ok(types)
    }

    /// `(:modules ...)`: semantic attachments.
    #[getter]
    fn modules(&self) -> Vec<Module> {
        self.model
            .modules
            .iter()
            .map(|module| Module {
                name: module.name.text.clone(),
                kind: match module.kind {
                    model::ModuleKind::Cost => "cost",
                    model::ModuleKind::Condition => "conditionchecker",
                    model::ModuleKind::Effect => "effect",
                },
                call: module.call.text.clone(),
                parameters: module
                    .parameters
                    .iter()
                    .map(|one| (one.name.text.clone(), self.type_names(&one.types)))
                    .collect(),
            })
            .collect()
    }

    fn __repr__(&self) -> String {
        format!("<Domain {}>", self.model.name.text)
    }
}

impl Problem {
    fn tuple<'py>(
        &self,
        py: Python<'py>,
        head: &str,
        arguments: &[model::ObjectId],
    ) -> PyResult<Bound<'py, PyTuple>> {
        let names = std::iter::once(head).chain(
            arguments
                .iter()
                .map(|object| self.model.objects[object.index()].name.text.as_str()),
        );
        PyTuple::new(py, names.collect::<Vec<_>>())
    }
}

#[pymethods]
impl Problem {
    /// Its name.
    #[getter]
    fn name(&self) -> &str {
        &self.model.name.text
    }

    /// Its text as read.
    #[getter]
    fn text(&self) -> &str {
        self.source.text()
    }

    /// The name of the file it was read from.
    #[getter]
    fn file(&self) -> &str {
        self.source.name()
    }

    /// The domain it was read against.
    #[getter]
    fn domain(&self, py: Python<'_>) -> Py<Domain> {
        self.domain.clone_ref(py)
    }

    /// Objects, the domain's constants first, and the names of their types.
    #[getter]
    fn objects<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let objects = PyDict::new(py);
        for object in &self.model.objects {
            let types = self.domain.get().type_names(&object.types);
            objects.set_item(&object.name.text, types)?;
        }
        Ok(objects)
    }

    /// Values of numeric fluents at time 0: `{("x", "target_1"): 12.5}`.
    #[getter]
    fn fluents<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let fluents = PyDict::new(py);
        let functions = &self.domain.get().model.functions;
        for (fluent, value) in &self.model.fluents {
            let name = &functions[fluent.function.index()].name.text;
            fluents.set_item(self.tuple(py, name, &fluent.arguments)?, value)?;
        }
        Ok(fluents)
    }

    /// Facts true at time 0: `{("at", "e1", "a")}`.
    #[getter]
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PySet>> {
        let facts = PySet::empty(py)?;
        let predicates = &self.domain.get().model.predicates;
        for fact in &self.model.facts {
            let name = &predicates[fact.predicate.index()].name.text;
            facts.add(self.tuple(py, name, &fact.arguments)?)?;
        }
        Ok(facts)
    }

    /// `(:moduleoptions ...)`: calls and their arguments as written.
    #[getter]
    fn module_options(&self) -> Vec<(String, Vec<String>)> {
        self.model
            .module_options
            .iter()
            .map(|(call, arguments)| {
                let arguments = arguments.iter().map(|one| one.text.clone()).collect();
                (call.text.clone(), arguments)
            })
            .collect()
    }

    fn __repr__(&self) -> String {
        format!("<Problem {}>", self.model.name.text)
    }
}
