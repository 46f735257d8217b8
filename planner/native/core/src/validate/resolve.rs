//! The steps of a plan, looked up in the domain and the problem.

use rustc_hash::FxHashMap;

use super::types::TypeTable;
use super::verdict::{Failure, Reason};
use crate::pddl::model::{Action, ActionId, Domain, ObjectId, Parameter, Problem};
use crate::plan::{Plan, Step};

/// A step with its symbols resolved.
#[derive(Clone, Debug)]
pub(super) struct GroundStep<'a> {
    pub(super) action: &'a Action,
    pub(super) arguments: Vec<ObjectId>,
    pub(super) start: f64,
    /// `None` for instantaneous actions.
    pub(super) duration: Option<f64>,
    /// `(drive e1 a b)`
    pub(super) text: String,
}

impl GroundStep<'_> {
    pub(super) fn end(&self) -> f64 {
        self.start + self.duration.unwrap_or(0.0)
    }
}

/// Names of the actions and objects that a plan may use.
pub(crate) struct Names<'a> {
    domain: &'a Domain,
    problem: &'a Problem,
    types: TypeTable,
    actions: FxHashMap<&'a str, ActionId>,
    objects: FxHashMap<&'a str, ObjectId>,
}

impl<'a> Names<'a> {
    pub(crate) fn new(domain: &'a Domain, problem: &'a Problem) -> Self {
        Self {
            domain,
            problem,
            types: TypeTable::new(domain, problem),
            actions: (0..)
                .map(ActionId)
                .zip(&domain.actions)
                .map(|(id, action)| (action.name.text.as_str(), id))
                .collect(),
            objects: (0..)
                .map(ObjectId)
                .zip(&problem.objects)
                .map(|(id, object)| (object.name.text.as_str(), id))
                .collect(),
        }
    }

    /// The action of a step whose name, arguments, times all fit.
    pub(crate) fn check(&self, step: &Step) -> Result<&'a Action, Reason> {
        self.resolve(step).map(|ground| ground.action)
    }

    fn resolve(&self, step: &Step) -> Result<GroundStep<'a>, Reason> {
        let id = self
            .actions
            .get(step.action.to_lowercase().as_str())
            .ok_or_else(|| Reason::UnknownAction(step.action.clone()))?;
        let action = &self.domain.actions[id.index()];
        if action.parameters.len() != step.arguments.len() {
            return Err(Reason::WrongArity {
                expected: action.parameters.len(),
                found: step.arguments.len(),
            });
        }
        let arguments = action
            .parameters
            .iter()
            .zip(&step.arguments)
            .enumerate()
            .map(|(position, (parameter, argument))| self.object(position, parameter, argument))
            .collect::<Result<Vec<_>, _>>()?;
        for time in [Some(step.start), step.duration].into_iter().flatten() {
            if !time.is_finite() || time < 0.0 {
                return Err(Reason::BadTime(time));
            }
        }
        let duration = match (&action.duration, step.duration) {
            (Some(_), None) => return Err(Reason::MissingDuration),
            (None, Some(duration)) if duration != 0.0 => {
                return Err(Reason::UnexpectedDuration(duration));
            }
            (None, _) => None,
            (Some(_), duration) => duration,
        };
        Ok(GroundStep {
            action,
            arguments,
            start: step.start,
            duration,
            text: step.to_string(),
        })
    }

    fn object(
        &self,
        position: usize,
        parameter: &Parameter,
        argument: &str,
    ) -> Result<ObjectId, Reason> {
        let object = *self
            .objects
            .get(argument.to_lowercase().as_str())
            .ok_or_else(|| Reason::UnknownObject {
                position,
                name: argument.to_owned(),
            })?;
        let types = &self.problem.objects[object.index()].types;
        if self.types.admits(parameter, types) {
            return Ok(object);
        }
        let wanted: Vec<&str> = parameter
            .types
            .iter()
            .map(|one| self.domain.types[one.index()].name.text.as_str())
            .collect();
        let wanted = match wanted.as_slice() {
            [only] => (*only).to_owned(),
            several => format!("(either {})", several.join(" ")),
        };
        Err(Reason::WrongType {
            position,
            argument: argument.to_owned(),
            parameter: format!("{} - {wanted}", parameter.name.text),
        })
    }
}

/// Resolves every step, or tells of the first that cannot be.
pub(super) fn resolve<'a>(
    names: &Names<'a>,
    plan: &Plan,
) -> Result<Vec<GroundStep<'a>>, Box<Failure>> {
    plan.steps
        .iter()
        .enumerate()
        .map(|(index, step)| {
            names.resolve(step).map_err(|reason| {
                Box::new(Failure {
                    step: Some(index),
                    action: Some(step.to_string()),
                    ..Failure::outside_time(reason)
                })
            })
        })
        .collect()
}
