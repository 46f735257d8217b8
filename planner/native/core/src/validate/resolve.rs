//! The steps of a plan, looked up in the domain and the problem.

use rustc_hash::FxHashMap;

use super::scene::Scene;
use super::verdict::{Failure, Reason};
use crate::pddl::model::{Action, ActionId, ObjectId, Parameter};
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

/// Names of actions and objects.
struct Names<'a> {
    actions: FxHashMap<&'a str, ActionId>,
    objects: FxHashMap<&'a str, ObjectId>,
}

/// Resolves every step, or tells of the first that cannot be.
pub(super) fn resolve<'a>(
    scene: &Scene<'a>,
    plan: &Plan,
) -> Result<Vec<GroundStep<'a>>, Box<Failure>> {
    let names = Names {
        actions: (0..)
            .map(ActionId)
            .zip(&scene.domain.actions)
            .map(|(id, action)| (action.name.text.as_str(), id))
            .collect(),
        objects: (0..)
            .map(ObjectId)
            .zip(&scene.problem.objects)
            .map(|(id, object)| (object.name.text.as_str(), id))
            .collect(),
    };
    plan.steps
        .iter()
        .enumerate()
        .map(|(index, step)| {
            resolve_step(scene, &names, step).map_err(|reason| {
                Box::new(Failure {
                    step: Some(index),
                    action: Some(step.to_string()),
                    ..Failure::outside_time(reason)
                })
            })
        })
        .collect()
}

fn resolve_step<'a>(
    scene: &Scene<'a>,
    names: &Names<'_>,
    step: &Step,
) -> Result<GroundStep<'a>, Reason> {
    let id = names
        .actions
        .get(step.action.to_lowercase().as_str())
        .ok_or_else(|| Reason::UnknownAction(step.action.clone()))?;
    let action = &scene.domain.actions[id.index()];
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
        .map(|(parameter, argument)| argument_of(scene, names, parameter, argument))
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

fn argument_of(
    scene: &Scene<'_>,
    names: &Names<'_>,
    parameter: &Parameter,
    argument: &str,
) -> Result<ObjectId, Reason> {
    let object = *names
        .objects
        .get(argument.to_lowercase().as_str())
        .ok_or_else(|| Reason::UnknownObject(argument.to_owned()))?;
    let types = &scene.problem.objects[object.index()].types;
    if scene.types.admits(parameter, types) {
        return Ok(object);
    }
    let wanted: Vec<&str> = parameter
        .types
        .iter()
        .map(|one| scene.domain.types[one.index()].name.text.as_str())
        .collect();
    let wanted = match wanted.as_slice() {
        [only] => (*only).to_owned(),
        several => format!("(either {})", several.join(" ")),
    };
    Err(Reason::WrongType {
        argument: argument.to_owned(),
        parameter: format!("{} - {wanted}", parameter.name.text),
    })
}
