//! Conversions between NumPy arrays and the kernels; nothing else lives here.

use pyo3::prelude::*;

/// The extension module `semantic_attachments._core`.
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))
}
