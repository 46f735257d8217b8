//! Values of attachments that depend on their arguments only: asked for in batches, kept for ever.

use std::time::{Duration, Instant};

use rustc_hash::FxHashMap;

use crate::attachment::{AttachmentError, Attachments, Purity};
use crate::pddl::model::{ModuleId, ModuleKind, ObjectId};

use super::world::World;
use super::{GroundingError, GroundingLimits};

type Arguments = Box<[ObjectId]>;

/// Calls in the first batch of a module, and in any.
const FIRST_BATCH: usize = 256;
const LARGEST_BATCH: usize = 8_192;
/// What a batch should take: the limits are looked at in between.
const BATCH_TIME: Duration = Duration::from_millis(10);

/// The memo and the calls it still lacks.
pub(super) struct Costs<'a> {
    attachments: &'a dyn Attachments,
    pure: Vec<bool>,
    known: Vec<FxHashMap<Arguments, f64>>,
    wanted: Vec<Vec<(Arguments, String)>>,
}

impl<'a> Costs<'a> {
    pub(super) fn new(world: &World<'_>, attachments: &'a dyn Attachments) -> Self {
        let modules = world.domain.modules.len();
        let pure = (0..modules as u32)
            .map(|module| {
                world.domain.modules[module as usize].kind != ModuleKind::Effect
                    && attachments.purity(ModuleId(module)) == Purity::Arguments
            })
            .collect();
        Self {
            attachments,
            pure,
            known: vec![FxHashMap::default(); modules],
            wanted: vec![Vec::new(); modules],
        }
    }

    /// Whether a module's value is known before searching.
    pub(super) fn is_pure(&self, module: ModuleId) -> bool {
        self.pure[module.index()]
    }

    /// The value of a call; `None` puts it into the next batch on behalf of an action.
    pub(super) fn value(
        &mut self,
        module: ModuleId,
        arguments: &[ObjectId],
        action: &dyn Fn() -> String,
    ) -> Option<f64> {
        if let Some(&value) = self.known[module.index()].get(arguments) {
            return Some(value);
        }
        self.wanted[module.index()].push((arguments.into(), action()));
        None
    }

    /// Evaluates what is wanted, by module in batches between which the limits are looked at.
    pub(super) fn evaluate(
        &mut self,
        world: &World<'_>,
        limits: &GroundingLimits<'_>,
    ) -> Result<(), GroundingError> {
        for module in 0..self.wanted.len() {
            let mut wanted = std::mem::take(&mut self.wanted[module]);
            wanted.sort_by(|left, right| left.0.cmp(&right.0));
            wanted.dedup_by(|left, right| left.0 == right.0);
            let (mut rest, mut length) = (wanted.as_slice(), FIRST_BATCH);
            while !rest.is_empty() {
                limits.check()?;
                let begun = Instant::now();
                let (batch, later) = rest.split_at(length.min(rest.len()));
                self.evaluate_batch(world, module, batch)?;
                rest = later;
                // Some attachments compute a path, others look a number up.
                length = if begun.elapsed() > BATCH_TIME {
                    (length / 2).max(1)
                } else {
                    (length * 2).min(LARGEST_BATCH)
                };
            }
        }
        Ok(())
    }

    fn evaluate_batch(
        &mut self,
        world: &World<'_>,
        module: usize,
        wanted: &[(Arguments, String)],
    ) -> Result<(), AttachmentError> {
        let declaration = &world.domain.modules[module];
        let calls: Vec<Vec<String>> = wanted
            .iter()
            .map(|(arguments, _)| {
                arguments
                    .iter()
                    .map(|object| world.problem.objects[object.index()].name.text.clone())
                    .collect()
            })
            .collect();
        let fault = |position: usize, reason: String| AttachmentError {
            module: declaration.name.text.clone(),
            arguments: calls.get(position).cloned().unwrap_or_default(),
            action: wanted
                .get(position)
                .map(|(_, action)| action.clone())
                .unwrap_or_default(),
            reason,
        };
        let values = self
            .attachments
            .evaluate(ModuleId(module as u32), &calls, None)
            .map_err(|(position, reason)| fault(position, reason))?;
        if values.len() != calls.len() {
            let reason = format!("{} values for {} calls", values.len(), calls.len());
            return Err(fault(0, reason));
        }
        for (position, &value) in values.iter().enumerate() {
            if let Some(reason) = complaint(declaration.kind, value) {
                return Err(fault(position, reason));
            }
        }
        for ((arguments, _), value) in wanted.iter().zip(values) {
            self.known[module].insert(arguments.clone(), value);
        }
        Ok(())
    }
}

/// What is wrong with a module's value, if anything.
#[must_use]
pub(crate) fn complaint(kind: ModuleKind, value: f64) -> Option<String> {
    match kind {
        _ if value.is_nan() => Some("it returned NaN; return infinity where there is none".into()),
        ModuleKind::Cost if value < 0.0 => Some(format!("it returned the negative cost {value}")),
        _ => None,
    }
}
