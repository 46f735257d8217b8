//! What stays the same while a plan is validated, and the values of its attachments.

use std::cell::RefCell;

use rustc_hash::FxHashMap;

use super::state::{State, Tuple};
use super::types::TypeTable;
use crate::attachment::{AttachmentError, Attachments, Purity};
use crate::pddl::model::{
    Domain, FunctionId, ModuleCall, ModuleId, ModuleKind, ObjectId, Problem, Term,
};

/// A condition, effect or expression that has no value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Fault {
    /// A numeric fluent without a value.
    Undefined(String),
    /// A division by zero, or a result that is no number.
    NotANumber(String),
    /// An attachment that failed.
    Attachment(AttachmentError),
    /// The rules for derived predicates depend on their own negation.
    NotStratified(String),
}

/// A fluent that an effect module writes, and its new value.
pub(super) type NewValue = (FunctionId, Tuple, f64);

/// A domain and problem with the tables that validation needs.
pub(super) struct Scene<'a> {
    pub(super) domain: &'a Domain,
    pub(super) problem: &'a Problem,
    pub(super) types: TypeTable,
    /// Rules for derived predicates, lower strata first.
    pub(super) strata: Vec<Vec<usize>>,
    attachments: &'a dyn Attachments,
    memo: RefCell<FxHashMap<(ModuleId, Tuple), f64>>,
}

/// The moment at which something is evaluated.
#[derive(Clone, Copy)]
pub(super) struct Moment<'a> {
    pub(super) state: &'a State,
    /// `?duration` of the action concerned [s].
    pub(super) duration: Option<f64>,
    /// `total-time` [s].
    pub(super) total_time: f64,
    /// The action concerned, for messages.
    pub(super) action: &'a str,
}

impl<'a> Scene<'a> {
    pub(super) fn new(
        domain: &'a Domain,
        problem: &'a Problem,
        attachments: &'a dyn Attachments,
    ) -> Result<Self, Fault> {
        Ok(Self {
            domain,
            problem,
            types: TypeTable::new(domain, problem),
            strata: super::derived::strata(domain)?,
            attachments,
            memo: RefCell::default(),
        })
    }

    /// The object that a term stands for.
    pub(super) fn object(term: Term, bindings: &[ObjectId]) -> ObjectId {
        match term {
            Term::Variable(variable) => bindings[variable.index()],
            Term::Object(object) => object,
        }
    }

    /// The objects that terms stand for.
    pub(super) fn tuple(terms: &[Term], bindings: &[ObjectId]) -> Tuple {
        terms
            .iter()
            .map(|term| Self::object(*term, bindings))
            .collect()
    }

    fn names(&self, tuple: &[ObjectId]) -> Vec<String> {
        tuple
            .iter()
            .map(|object| self.problem.objects[object.index()].name.text.clone())
            .collect()
    }

    fn attachment_error(
        &self,
        module: ModuleId,
        tuple: &[ObjectId],
        action: &str,
        reason: String,
    ) -> Fault {
        Fault::Attachment(AttachmentError {
            module: self.domain.modules[module.index()].name.text.clone(),
            arguments: self.names(tuple),
            action: action.to_owned(),
            reason,
        })
    }

    /// The value of a cost or condition module, remembered where it depends on its arguments only.
    pub(super) fn call(
        &self,
        call: &ModuleCall,
        bindings: &[ObjectId],
        moment: &Moment<'_>,
    ) -> Result<f64, Fault> {
        let tuple = Self::tuple(&call.arguments, bindings);
        let pure = self.attachments.purity(call.module) == Purity::Arguments;
        let key = (call.module, tuple);
        if pure && let Some(value) = self.memo.borrow().get(&key) {
            return Ok(*value);
        }
        let view: Option<&dyn crate::attachment::StateView> =
            if pure { None } else { Some(moment.state) };
        let fault = |reason| self.attachment_error(call.module, &key.1, moment.action, reason);
        let values = self
            .attachments
            .evaluate(call.module, &[self.names(&key.1)], view)
            .map_err(|(_, reason)| fault(reason))?;
        let [value] = values[..] else {
            return Err(fault(format!("it gave {} values for 1 call", values.len())));
        };
        let kind = self.domain.modules[call.module.index()].kind;
        if value.is_nan() || (kind == ModuleKind::Cost && value < 0.0) {
            return Err(fault(format!("its value is {value}")));
        }
        if pure {
            self.memo.borrow_mut().insert(key, value);
        }
        Ok(value)
    }

    /// The fluents that an effect module writes, and their new values; `None` if it does not apply.
    pub(super) fn apply(
        &self,
        call: &ModuleCall,
        bindings: &[ObjectId],
        moment: &Moment<'_>,
    ) -> Result<Option<Vec<NewValue>>, Fault> {
        let tuple = Self::tuple(&call.arguments, bindings);
        let writes = &self.domain.modules[call.module.index()].writes;
        let fault = |reason| self.attachment_error(call.module, &tuple, moment.action, reason);
        let values = self
            .attachments
            .apply(call.module, &self.names(&tuple), moment.state)
            .map_err(fault)?;
        let Some(values) = values else {
            return Ok(None);
        };
        if values.len() != writes.len() || values.iter().any(|value| !value.is_finite()) {
            return Err(fault(format!(
                "it gave {values:?} for {} fluents",
                writes.len()
            )));
        }
        Ok(Some(
            writes
                .iter()
                .zip(values)
                .map(|(term, value)| (term.function, Self::tuple(&term.arguments, &tuple), value))
                .collect(),
        ))
    }
}
