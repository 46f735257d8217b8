//! Panics of the core become one exception; without this they would reach Python as a `BaseException`.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};

use pyo3::exceptions::PyException;
use pyo3::prelude::*;

pyo3::create_exception!(
    _core,
    Panic,
    PyException,
    "The core contradicted itself; the façade raises InternalError for it."
);

thread_local! {
    /// Where and why this thread panicked last.
    static LAST: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Keeps the message of a panic instead of printing it. The standard library of this module is its own,
/// so nobody else's panics are silenced.
pub fn install_hook() {
    std::panic::set_hook(Box::new(|panic| {
        LAST.with(|last| *last.borrow_mut() = Some(panic.to_string()));
    }));
}

/// Runs something that should not panic; gives the message of the panic if it does.
pub fn caught<T>(run: impl FnOnce() -> T) -> Result<T, String> {
    catch_unwind(AssertUnwindSafe(run)).map_err(|_| {
        LAST.with(|last| last.borrow_mut().take())
            .unwrap_or_else(|| "the core panicked".into())
    })
}

/// Runs something without the GIL that should not panic.
pub fn detached<T: Send>(py: Python<'_>, run: impl FnOnce() -> T + Send) -> PyResult<T> {
    py.detach(|| caught(run)).map_err(Panic::new_err)
}

/// Panics, so that a test can see what becomes of panics.
#[pyfunction]
pub fn panic_on_purpose(py: Python<'_>, message: &str) -> PyResult<()> {
    detached(py, || panic!("{message}"))
}
