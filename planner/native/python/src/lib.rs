//! Python border of the planning core: conversions, errors, attachment adapter.
//!
//! Everything here is called by the façade in `planner/*.py`, which holds the documentation and raises the
//! exceptions; this module only converts.

mod attachments;
mod diagnostic;
mod editor;
mod model;
mod overdue;
mod panic;
mod plan;
mod report;
mod search;
mod state_view;
mod validation;

use pyo3::prelude::*;

/// The extension module `planner._core`.
#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    panic::install_hook();
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("Panic", module.py().get_type::<panic::Panic>())?;
    module.add_class::<diagnostic::Diagnostic>()?;
    module.add_class::<model::Domain>()?;
    module.add_class::<model::Problem>()?;
    module.add_class::<model::Module>()?;
    module.add_class::<state_view::State>()?;
    module.add_class::<validation::Verdict>()?;
    module.add_class::<search::Search>()?;
    module.add_class::<search::Event>()?;
    module.add_class::<report::Report>()?;
    module.add_function(wrap_pyfunction!(model::read_domain, module)?)?;
    module.add_function(wrap_pyfunction!(model::read_problem, module)?)?;
    module.add_function(wrap_pyfunction!(plan::read_plan, module)?)?;
    module.add_function(wrap_pyfunction!(plan::write_plan, module)?)?;
    module.add_function(wrap_pyfunction!(validation::validate, module)?)?;
    module.add_function(wrap_pyfunction!(panic::panic_on_purpose, module)?)?;
    editor::register(module)
}
