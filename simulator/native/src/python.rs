//! Conversions between NumPy arrays and the kernels; nothing else lives here.

mod floor;
mod occupancy;
mod octree;
mod scene;
mod slam;

use pyo3::prelude::*;

/// The extension module `simulator._core`.
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<floor::PyFloor>()?;
    module.add_class::<occupancy::PyOccupancyMap>()?;
    module.add_class::<octree::PyOctree>()?;
    module.add_class::<scene::PySolids>()?;
    module.add_class::<slam::PyLikelihoodField>()?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))
}
