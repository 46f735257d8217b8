//! Semantic attachments (PDDL/M modules): what the planner asks of code outside it.
//!
//! Source: Dornhege et al., "Semantic attachments for domain-independent planning systems",
//! ICAPS 2009.

use crate::pddl::model::{FunctionId, ModuleId, ObjectId, PredicateId};

/// A read-only view of one planner state, for attachments that depend on it.
///
/// Symbols are those of the typed model, so that the search, the validator and a border to
/// another language can each offer one.
pub trait StateView {
    /// Whether a fact holds, static ones included.
    fn holds(&self, predicate: PredicateId, arguments: &[ObjectId]) -> bool;
    /// The value of a numeric fluent, static ones included; `None` where it is undefined.
    fn value(&self, function: FunctionId, arguments: &[ObjectId]) -> Option<f64>;
}

/// What the value of an attachment depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purity {
    /// Its arguments only: evaluated once per argument tuple.
    Arguments,
    /// Its arguments and the whole state.
    State,
}

/// Names of a call's arguments, one tuple per ground call.
pub type Arguments = Vec<String>;

/// An attachment that fails. It stops planning; it never becomes a wrong plan.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("attachment [{}] of action {action}: {reason}", self.call())]
pub struct AttachmentError {
    /// The module's name.
    pub module: String,
    /// The arguments it was called with.
    pub arguments: Arguments,
    /// The action that needed it.
    pub action: String,
    /// What went wrong.
    pub reason: String,
}

impl AttachmentError {
    /// The call without its brackets: `pathCost r1 a b`.
    #[must_use]
    pub fn call(&self) -> String {
        let words: Vec<&str> = std::iter::once(self.module.as_str())
            .chain(self.arguments.iter().map(String::as_str))
            .collect();
        words.join(" ")
    }
}

/// Evaluates the modules of a domain.
///
/// The planner batches calls, memoises the results of [`Purity::Arguments`] modules, and
/// checks every value: NaN and negative costs are errors, infinity means inapplicable.
pub trait Attachments: Sync {
    /// What the module's value depends on.
    fn purity(&self, module: ModuleId) -> Purity;

    /// Costs in seconds, or truth values as 0 and 1, of many calls of one module; `state` is given to
    /// [`Purity::State`] modules only.
    ///
    /// # Errors
    /// The reason, with the position of the first call that failed.
    fn evaluate(
        &self,
        module: ModuleId,
        calls: &[Arguments],
        state: Option<&dyn StateView>,
    ) -> Result<Vec<f64>, (usize, String)>;

    /// New values of the fluents an effect module writes; `None` means the effect does not apply.
    ///
    /// # Errors
    /// The reason of the failure.
    fn apply(
        &self,
        module: ModuleId,
        call: &Arguments,
        state: &dyn StateView,
    ) -> Result<Option<Vec<f64>>, String>;
}

/// For domains without modules.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoAttachments;

impl Attachments for NoAttachments {
    fn purity(&self, _: ModuleId) -> Purity {
        Purity::Arguments
    }

    fn evaluate(
        &self,
        _: ModuleId,
        _: &[Arguments],
        _: Option<&dyn StateView>,
    ) -> Result<Vec<f64>, (usize, String)> {
        Err((0, "no provider was given for this module".into()))
    }

    fn apply(
        &self,
        _: ModuleId,
        _: &Arguments,
        _: &dyn StateView,
    ) -> Result<Option<Vec<f64>>, String> {
        Err("no provider was given for this module".into())
    }
}
