//! A planner state that attachments may look at while they are called.

#![allow(unsafe_code)]

use std::ptr::NonNull;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, ThreadId};

use planner_core::attachment::StateView;
use planner_core::pddl::model;
use pyo3::exceptions::{PyKeyError, PyRuntimeError};
use pyo3::prelude::*;
use rustc_hash::FxHashMap;

/// Ids of the names that Python uses.
pub struct Symbols {
    predicates: FxHashMap<String, model::PredicateId>,
    functions: FxHashMap<String, model::FunctionId>,
    objects: FxHashMap<String, model::ObjectId>,
}

impl Symbols {
    /// The symbols of a domain and a problem.
    pub fn new(domain: &model::Domain, problem: &model::Problem) -> Self {
        Self {
            predicates: (0..)
                .map(model::PredicateId)
                .zip(&domain.predicates)
                .map(|(id, one)| (one.name.text.clone(), id))
                .collect(),
            functions: (0..)
                .map(model::FunctionId)
                .zip(&domain.functions)
                .map(|(id, one)| (one.name.text.clone(), id))
                .collect(),
            objects: (0..)
                .map(model::ObjectId)
                .zip(&problem.objects)
                .map(|(id, one)| (one.name.text.clone(), id))
                .collect(),
        }
    }

    fn arguments(&self, names: &[String]) -> PyResult<Vec<model::ObjectId>> {
        names
            .iter()
            .map(|name| {
                self.objects
                    .get(name)
                    .copied()
                    .ok_or_else(|| PyKeyError::new_err(format!("the problem has no object {name}")))
            })
            .collect()
    }
}

/// A borrowed view whose lifetime is erased.
struct Borrowed(NonNull<dyn StateView>);

// SAFETY: the pointer is followed only by the thread that lent it, see `State::with`; any thread may drop it.
unsafe impl Send for Borrowed {}

/// A read-only view of the state in which an attachment is called; useless after the call.
#[pyclass(frozen, module = "planner")]
pub struct State {
    view: Mutex<Option<Borrowed>>,
    lender: ThreadId,
    symbols: Arc<Symbols>,
}

impl State {
    fn with<R>(&self, read: impl FnOnce(&dyn StateView) -> R) -> PyResult<R> {
        let view = self.view.lock().unwrap_or_else(PoisonError::into_inner);
        match &*view {
            // SAFETY: `lend` sets the pointer from a reference that outlives the call of `lend` and clears it
            // before it returns; only the lending thread, which is inside that call, gets here.
            Some(view) if self.lender == thread::current().id() => {
                Ok(read(unsafe { view.0.as_ref() }))
            }
            _ => Err(PyRuntimeError::new_err(
                "a state can be read only while the attachment is called, and by its thread",
            )),
        }
    }
}

/// Clears a lent view even if the borrower panics.
struct Lent<'py>(Bound<'py, State>);

impl Drop for Lent<'_> {
    fn drop(&mut self) {
        let mut view = self
            .0
            .get()
            .view
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        *view = None;
    }
}

/// Lends a state to Python code for the time of one call.
pub fn lend<'py, R>(
    py: Python<'py>,
    view: &dyn StateView,
    symbols: &Arc<Symbols>,
    call: impl FnOnce(&Bound<'py, State>) -> PyResult<R>,
) -> PyResult<R> {
    // SAFETY: only the lifetime is erased; `Lent` clears the pointer before `view` goes out of scope.
    let erased: NonNull<dyn StateView> = unsafe {
        std::mem::transmute::<NonNull<dyn StateView + '_>, NonNull<dyn StateView + 'static>>(
            NonNull::from(view),
        )
    };
    let state = Bound::new(
        py,
        State {
            view: Mutex::new(Some(Borrowed(erased))),
            lender: thread::current().id(),
            symbols: Arc::clone(symbols),
        },
    )?;
    let lent = Lent(state);
    call(&lent.0)
}

#[pymethods]
impl State {
    /// Whether a fact holds: `state.holds("at", "e1", "a")`.
    #[pyo3(signature = (predicate, *arguments))]
    fn holds(&self, predicate: &str, arguments: Vec<String>) -> PyResult<bool> {
        let id = *self.symbols.predicates.get(predicate).ok_or_else(|| {
            PyKeyError::new_err(format!("the domain has no predicate {predicate}"))
        })?;
        let arguments = self.symbols.arguments(&arguments)?;
        self.with(|view| view.holds(id, &arguments))
    }

    /// The value of a numeric fluent, `None` where it is undefined: `state.value("energy", "e1")`.
    #[pyo3(signature = (function, *arguments))]
    fn value(&self, function: &str, arguments: Vec<String>) -> PyResult<Option<f64>> {
        let id =
            *self.symbols.functions.get(function).ok_or_else(|| {
                PyKeyError::new_err(format!("the domain has no function {function}"))
            })?;
        let arguments = self.symbols.arguments(&arguments)?;
        self.with(|view| view.value(id, &arguments))
    }
}
