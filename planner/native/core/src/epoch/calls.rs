//! Attachments whose value depends on the state: called once per call and state, then remembered.

use std::cell::RefCell;

use rustc_hash::FxHashMap;

use crate::attachment::{AttachmentError, Attachments, StateView};
use crate::grounding::complaint;
use crate::pddl::model::{FunctionId, ObjectId, PredicateId};
use crate::task::{CallId, FluentPlace, Task};

/// Entries after which the memo is emptied, so that it stays within some 100 MB.
const MEMO_LIMIT: usize = 500_000;

/// Results by call and fingerprint of the state.
type Memo<T> = RefCell<FxHashMap<(CallId, u64), T>>;

/// Evaluates the calls of one task.
pub struct Calls<'a> {
    task: &'a Task,
    attachments: &'a dyn Attachments,
    values: Memo<f64>,
    changes: Memo<Option<Vec<f64>>>,
    failure: RefCell<Option<AttachmentError>>,
}

/// The facts and values of one state.
#[derive(Clone, Copy)]
pub struct Snapshot<'a> {
    /// Fact bits.
    pub facts: &'a [u64],
    /// Fluent values.
    pub values: &'a [f64],
}

impl Snapshot<'_> {
    fn fingerprint(&self) -> u64 {
        use std::hash::Hasher;
        let mut hasher = rustc_hash::FxHasher::default();
        for word in self.facts {
            hasher.write_u64(*word);
        }
        for value in self.values {
            hasher.write_u64(value.to_bits());
        }
        hasher.finish()
    }
}

struct View<'a> {
    task: &'a Task,
    state: Snapshot<'a>,
}

impl StateView for View<'_> {
    fn holds(&self, predicate: PredicateId, arguments: &[ObjectId]) -> bool {
        match self.task.symbols.facts.get(&(predicate, arguments.into())) {
            Some(Some(fact)) => {
                self.state.facts[fact.index() / 64] & (1 << (fact.index() % 64)) != 0
            }
            Some(None) => true,
            None => false,
        }
    }

    fn value(&self, function: FunctionId, arguments: &[ObjectId]) -> Option<f64> {
        match self
            .task
            .symbols
            .fluents
            .get(&(function, arguments.into()))?
        {
            FluentPlace::Stored(fluent) => {
                let value = self.state.values[fluent.index()];
                (!value.is_nan()).then_some(value)
            }
            FluentPlace::Constant(value) => Some(*value),
        }
    }
}

impl<'a> Calls<'a> {
    /// For one task and its providers.
    #[must_use]
    pub fn new(task: &'a Task, attachments: &'a dyn Attachments) -> Self {
        Self {
            task,
            attachments,
            values: RefCell::default(),
            changes: RefCell::default(),
            failure: RefCell::default(),
        }
    }

    /// The first failure, which ends the search.
    pub fn failure(&self) -> Option<AttachmentError> {
        self.failure.borrow().clone()
    }

    fn fail(&self, call: CallId, action: &str, reason: String) {
        let ground = &self.task.calls[call.index()];
        self.failure
            .borrow_mut()
            .get_or_insert_with(|| AttachmentError {
                module: self.task.module_names[ground.module.index()].clone(),
                arguments: ground.arguments.clone(),
                action: action.into(),
                reason,
            });
    }

    /// The value of a cost or condition module; NaN, which makes an action inapplicable, after a
    /// failure and where it is infinite.
    pub fn value(&self, call: CallId, state: Snapshot<'_>, action: &dyn Fn() -> String) -> f64 {
        let key = (call, state.fingerprint());
        if let Some(&value) = self.values.borrow().get(&key) {
            return value;
        }
        let ground = &self.task.calls[call.index()];
        let view = View {
            task: self.task,
            state,
        };
        let arguments = std::slice::from_ref(&ground.arguments);
        let kind = self.task.module_kinds[ground.module.index()];
        let value = match self
            .attachments
            .evaluate(ground.module, arguments, Some(&view))
        {
            Ok(values) if values.len() == 1 => match complaint(kind, values[0]) {
                None if values[0].is_infinite() => f64::NAN,
                None => values[0],
                Some(reason) => {
                    self.fail(call, &action(), reason);
                    f64::NAN
                }
            },
            Ok(values) => {
                self.fail(
                    call,
                    &action(),
                    format!("{} values for 1 call", values.len()),
                );
                f64::NAN
            }
            Err((_, reason)) => {
                self.fail(call, &action(), reason);
                f64::NAN
            }
        };
        let mut memo = self.values.borrow_mut();
        if memo.len() >= MEMO_LIMIT {
            memo.clear();
        }
        memo.insert(key, value);
        value
    }

    /// Whether a condition module holds.
    pub fn holds(&self, call: CallId, state: Snapshot<'_>, action: &dyn Fn() -> String) -> bool {
        let value = self.value(call, state, action);
        value != 0.0 && !value.is_nan()
    }

    /// What an effect module writes, in the order of the call's `writes`; `None` if it does not
    /// apply.
    pub fn change(
        &self,
        call: CallId,
        state: Snapshot<'_>,
        action: &dyn Fn() -> String,
    ) -> Option<Vec<f64>> {
        let key = (call, state.fingerprint());
        if let Some(values) = self.changes.borrow().get(&key) {
            return values.clone();
        }
        let ground = &self.task.calls[call.index()];
        let view = View {
            task: self.task,
            state,
        };
        let values = match self
            .attachments
            .apply(ground.module, &ground.arguments, &view)
        {
            Ok(Some(values)) if values.len() != ground.writes.len() => {
                let reason = format!(
                    "{} values for {} fluents",
                    values.len(),
                    ground.writes.len()
                );
                self.fail(call, &action(), reason);
                None
            }
            Ok(values) => values,
            Err(reason) => {
                self.fail(call, &action(), reason);
                None
            }
        };
        let mut memo = self.changes.borrow_mut();
        if memo.len() >= MEMO_LIMIT {
            memo.clear();
        }
        memo.insert(key, values.clone());
        values
    }
}
