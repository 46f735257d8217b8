//! Python border of the planning core: conversions, errors, attachment adapter.

use pyo3::prelude::*;

/// The extension module `planner._core`.
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))
}
