//! Conversions between NumPy arrays and the kernels; nothing else lives here.
//!
//! Arrays of a map have shape (height, width), row 0 at the bottom; a cell is `row * width + column`.

mod field;
mod footprint;
mod lazy_graph;
mod regions;
mod traversability;

use numpy::PyReadonlyArray2;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

fn cells<T: numpy::Element + Copy>(array: &PyReadonlyArray2<'_, T>) -> Vec<T> {
    match array.as_slice() {
        Ok(contiguous) => contiguous.to_vec(),
        Err(_) => array.as_array().iter().copied().collect(),
    }
}

fn check(ok: bool, message: &str) -> PyResult<()> {
    if ok {
        Ok(())
    } else {
        Err(PyValueError::new_err(message.to_owned()))
    }
}

/// The extension module `semantic_attachments._core`.
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<traversability::Traversability>()?;
    module.add_class::<field::AnyAngleField>()?;
    module.add_class::<footprint::Footprint>()?;
    module.add_class::<field::Field>()?;
    module.add_class::<lazy_graph::LazyGraph>()?;
    module.add_class::<regions::DistanceTransform>()?;
    module.add_class::<regions::Region>()?;
    module.add_class::<regions::Geodesic>()
}
