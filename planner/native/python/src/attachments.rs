//! Python callables as attachments: the GIL is taken once for a batch, exceptions are kept for the façade.

use std::sync::{Arc, Mutex, PoisonError, RwLock, RwLockReadGuard};

use planner_core::attachment::{Arguments, AttachmentError, Attachments, Purity, StateView};
use planner_core::pddl::model::{self, ModuleId};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use crate::state_view::{Symbols, lend};

/// A failed call for Python: module, arguments, action, reason.
pub type FailedCall = (String, Vec<String>, String, String);

/// Takes an error apart.
pub fn failed_call(error: &AttachmentError) -> FailedCall {
    (
        error.module.clone(),
        error.arguments.clone(),
        error.action.clone(),
        error.reason.clone(),
    )
}

/// What Python provides for one module.
struct Provider {
    /// Called with the arguments of one call.
    single: Py<PyAny>,
    /// Its method `many`, called with a list of argument tuples.
    many: Option<Py<PyAny>>,
    purity: Purity,
}

/// The attachments of one planning or validation run.
pub struct PythonAttachments {
    providers: Vec<Option<Provider>>,
    names: Vec<String>,
    symbols: Arc<Symbols>,
    /// The first exception that an attachment raised.
    exception: Mutex<Option<PyErr>>,
    /// Whether Python may no longer be called; calls under way hold it.
    closed: RwLock<bool>,
}

impl PythonAttachments {
    /// Finds the provider of every module; names compare without regard to case.
    pub fn new(
        attachments: &Bound<'_, PyDict>,
        domain: &model::Domain,
        problem: &model::Problem,
    ) -> PyResult<Self> {
        let mut providers: Vec<Option<Provider>> = domain.modules.iter().map(|_| None).collect();
        for (key, value) in attachments {
            let key: String = key.extract()?;
            for (module, slot) in domain.modules.iter().zip(&mut providers) {
                if module.name.text.eq_ignore_ascii_case(&key) {
                    *slot = Some(Provider::new(&value)?);
                }
            }
        }
        Ok(Self {
            providers,
            names: domain
                .modules
                .iter()
                .map(|module| module.name.text.clone())
                .collect(),
            symbols: Arc::new(Symbols::new(domain, problem)),
            exception: Mutex::new(None),
            closed: RwLock::new(false),
        })
    }

    /// No call is made from now on, so that a search which nobody waits for can outlive the
    /// interpreter; false if one is under way.
    pub fn close(&self) -> bool {
        let closed = self.closed.try_write().map(|mut closed| *closed = true);
        closed.is_ok()
    }

    /// To be held during a call.
    fn open(&self) -> Result<RwLockReadGuard<'_, bool>, String> {
        let closed = self.closed.read().unwrap_or_else(PoisonError::into_inner);
        if *closed {
            return Err("the search is over".into());
        }
        Ok(closed)
    }

    /// Takes the first exception that an attachment raised.
    pub fn exception(&self) -> Option<PyErr> {
        self.exception.lock().ok()?.take()
    }

    fn provider(&self, module: ModuleId) -> Result<&Provider, String> {
        self.providers[module.index()].as_ref().ok_or_else(|| {
            let name = &self.names[module.index()];
            format!("no provider was given for [{name}]: pass attachments={{\"{name}\": ...}}")
        })
    }

    /// Remembers the exception and gives its text.
    fn keep(&self, py: Python<'_>, error: PyErr) -> String {
        let text = error.to_string();
        if let Ok(mut kept) = self.exception.lock()
            && kept.is_none()
        {
            *kept = Some(error.clone_ref(py));
        }
        text
    }
}

impl Provider {
    fn new(value: &Bound<'_, PyAny>) -> PyResult<Self> {
        let purity = match value.getattr_opt("purity")? {
            Some(purity) if purity.str()?.to_cow()? != "arguments" => Purity::State,
            _ => Purity::Arguments,
        };
        Ok(Self {
            single: value.clone().unbind(),
            many: value.getattr_opt("many")?.map(Bound::unbind),
            purity,
        })
    }

    /// Values of a batch, or the position of the first call that failed.
    fn values(
        &self,
        py: Python<'_>,
        calls: &[Arguments],
        state: Option<&Bound<'_, PyAny>>,
    ) -> Result<Vec<f64>, (usize, PyErr)> {
        if let Some(many) = &self.many {
            let batch = || -> PyResult<Vec<f64>> {
                let calls = calls
                    .iter()
                    .map(|call| PyTuple::new(py, call))
                    .collect::<PyResult<Vec<_>>>()?;
                let calls = PyList::new(py, calls)?;
                let values = match state {
                    Some(state) => many.bind(py).call1((calls, state))?,
                    None => many.bind(py).call1((calls,))?,
                };
                numbers(&values)
            };
            return batch().map_err(|error| (position(py, &error), error));
        }
        calls
            .iter()
            .enumerate()
            .map(|(index, call)| {
                let value = || -> PyResult<f64> {
                    let result = match state {
                        Some(state) => {
                            let mut arguments = vec![state.clone()];
                            for name in call {
                                arguments.push(name.into_pyobject(py)?.into_any());
                            }
                            self.single.bind(py).call1(PyTuple::new(py, arguments)?)?
                        }
                        None => self.single.bind(py).call1(PyTuple::new(py, call)?)?,
                    };
                    result.extract()
                };
                value().map_err(|error| (index, error))
            })
            .collect()
    }
}

/// The call of a batch that failed, if the exception tells it by an attribute `position`.
fn position(py: Python<'_>, error: &PyErr) -> usize {
    let position = error.value(py).getattr("position");
    position.and_then(|number| number.extract()).unwrap_or(0)
}

fn numbers(values: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    values
        .try_iter()?
        .map(|value| value?.extract::<f64>())
        .collect()
}

impl Attachments for PythonAttachments {
    fn purity(&self, module: ModuleId) -> Purity {
        self.providers[module.index()]
            .as_ref()
            .map_or(Purity::Arguments, |provider| provider.purity)
    }

    fn evaluate(
        &self,
        module: ModuleId,
        calls: &[Arguments],
        state: Option<&dyn StateView>,
    ) -> Result<Vec<f64>, (usize, String)> {
        let provider = self.provider(module).map_err(|reason| (0, reason))?;
        let _open = self.open().map_err(|reason| (0, reason))?;
        Python::attach(|py| {
            let values = match state {
                Some(view) if provider.purity == Purity::State => {
                    let mut position = 0;
                    lend(py, view, &self.symbols, |state| {
                        provider.values(py, calls, Some(state.as_any())).map_err(
                            |(index, error)| {
                                position = index;
                                error
                            },
                        )
                    })
                    .map_err(|error| (position, error))
                }
                _ => provider.values(py, calls, None),
            };
            let values = values.map_err(|(index, error)| (index, self.keep(py, error)))?;
            if values.len() == calls.len() {
                Ok(values)
            } else {
                let (given, asked) = (values.len(), calls.len());
                Err((0, format!("it gave {given} values for {asked} calls")))
            }
        })
    }

    fn apply(
        &self,
        module: ModuleId,
        call: &Arguments,
        state: &dyn StateView,
    ) -> Result<Option<Vec<f64>>, String> {
        let provider = self.provider(module)?;
        let _open = self.open()?;
        Python::attach(|py| {
            lend(py, state, &self.symbols, |state| {
                let mut arguments = vec![state.clone().into_any()];
                for name in call {
                    arguments.push(name.into_pyobject(py)?.into_any());
                }
                let arguments = PyTuple::new(py, arguments)?;
                let result = provider.single.bind(py).call1(arguments)?;
                if result.is_none() {
                    Ok(None)
                } else {
                    numbers(&result).map(Some)
                }
            })
            .map_err(|error| self.keep(py, error))
        })
    }
}
