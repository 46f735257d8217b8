//! Relaxed reachability: which ground actions and atoms can occur when nothing is ever deleted.
//!
//! Works in layers. A layer joins the atoms that the previous one reached, evaluates all
//! attachments its candidates need in one batch per module, and lets the survivors reach new atoms.
//! Candidates whose conditions are not conjunctions of atoms wait until these can hold.

mod admission;
mod candidates;
mod effects;

use rustc_hash::FxHashSet;

use crate::attachment::Attachments;
use crate::pddl::model::{ObjectId, TimedChange};
use crate::task::Duration;

use super::beam::Beam;
use super::costs::Costs;
use super::formula::{Formula, Symbols};
use super::join::{Trigger, instantiate};
use super::relation::Relation;
use super::schema::{Origin, Schema};
use super::world::World;
use super::{GroundingError, GroundingLimits};
use candidates::Candidates;
use effects::Conditional;

/// A ground action or rule that can occur.
pub(super) struct Instance {
    /// Index into [`Reached::schemas`].
    pub(super) schema: u32,
    pub(super) arguments: Box<[ObjectId]>,
    pub(super) duration: Option<Duration>,
}

/// What relaxed reachability found.
pub(super) struct Reached<'b> {
    pub(super) schemas: Vec<Schema<'b>>,
    pub(super) relations: Vec<Relation>,
    pub(super) symbols: Symbols,
    pub(super) costs: Costs<'b>,
    pub(super) instances: Vec<Instance>,
    /// By action, the first arguments that all conditions allow and that give a duration below
    /// zero or without a finite value.
    pub(super) impossible: Vec<Option<ImpossibleDuration>>,
}

/// Arguments whose duration is no time that can pass.
pub(super) struct ImpossibleDuration {
    pub(super) arguments: Box<[ObjectId]>,
    /// Index of the duration constraint.
    pub(super) constraint: usize,
    /// Negative, infinite or not a number [s].
    pub(super) value_s: f64,
}

struct Exploration<'a, 'b> {
    world: &'a World<'b>,
    found: Reached<'b>,
    queue: Vec<(usize, Box<[ObjectId]>)>,
    waiting: Vec<(Instance, Formula)>,
    conditional: Vec<Conditional>,
    rules_seen: FxHashSet<(u32, Box<[ObjectId]>)>,
    beam: Option<Beam>,
}

/// Runs the fixpoint.
pub(super) fn reach<'b>(
    world: &World<'b>,
    attachments: &'b dyn Attachments,
    limits: &GroundingLimits<'_>,
) -> Result<Reached<'b>, GroundingError> {
    let mut exploration = Exploration::new(world, attachments, None);
    let mut candidates = Candidates::new(limits);
    exploration.without_changing_conditions(&mut candidates)?;
    let mut head = 0;
    loop {
        while head < exploration.queue.len() {
            if head.is_multiple_of(256) {
                limits.check()?;
            }
            exploration.join_atom(head, head as u32 + 1, &mut candidates)?;
            head += 1;
        }
        if candidates.list.is_empty() && !exploration.wake() {
            break;
        }
        exploration.admit(std::mem::take(&mut candidates.list), limits)?;
        exploration.has_room(limits)?;
        exploration.wake();
        limits.check()?;
    }
    Ok(exploration.found)
}

/// Runs the fixpoint for a part of the task: of alike atoms only the nearest are joined, `width`
/// for each object in them. Actions that lead elsewhere are left out.
pub(super) fn reach_partially<'b>(
    world: &World<'b>,
    attachments: &'b dyn Attachments,
    limits: &GroundingLimits<'_>,
    width: u32,
) -> Result<Reached<'b>, GroundingError> {
    let mut exploration = Exploration::new(world, attachments, Some(Beam::new(width)));
    let mut candidates = Candidates::new(limits);
    exploration.without_changing_conditions(&mut candidates)?;
    let mut sequence = 0;
    loop {
        for head in exploration.admit_pending() {
            sequence += 1;
            let (predicate, tuple) = &exploration.queue[head];
            exploration.found.relations[*predicate].set_sequence(tuple, sequence);
            exploration.join_atom(head, sequence, &mut candidates)?;
            limits.check()?;
        }
        let open = exploration.beam.as_ref().is_some_and(Beam::has_pending);
        if candidates.list.is_empty() && !open && !exploration.wake() {
            break;
        }
        exploration.admit(std::mem::take(&mut candidates.list), limits)?;
        exploration.has_room(limits)?;
        exploration.wake();
        limits.check()?;
    }
    let mut found = exploration.found;
    if let Some(beam) = &exploration.beam {
        let schemas = &found.schemas;
        found.instances.retain(|instance| {
            let schema = &schemas[instance.schema as usize];
            beam.admits_all(schema, &instance.arguments)
        });
    }
    Ok(found)
}

impl<'a, 'b> Exploration<'a, 'b> {
    fn has_room(&self, limits: &GroundingLimits<'_>) -> Result<(), GroundingError> {
        let limit = limits.operators;
        if self.found.instances.len() > limit {
            return Err(GroundingError::TooManyOperators { limit });
        }
        Ok(())
    }

    /// The pending atoms that are near enough, nearest first, as positions in the queue.
    fn admit_pending(&mut self) -> Vec<usize> {
        let Some(beam) = &mut self.beam else {
            return Vec::new();
        };
        beam.admit(self.world, &self.queue)
    }

    /// When an instance can start at the earliest in the relaxation [s]; 0 where nobody asks.
    fn start_label(&self, instance: &Instance) -> f32 {
        if self.beam.is_none() {
            return 0.0;
        }
        let schema = &self.found.schemas[instance.schema as usize];
        let labels = schema.join.iter().filter_map(|atom| {
            let tuple = World::bind(&atom.arguments, &instance.arguments);
            self.found.relations[atom.predicate.index()].label(&tuple)
        });
        labels.fold(0.0, f32::max)
    }

    fn new(world: &'a World<'b>, attachments: &'b dyn Attachments, beam: Option<Beam>) -> Self {
        let mut schemas = Vec::new();
        for (index, action) in world.domain.actions.iter().enumerate() {
            schemas.push(Schema::of_action(world, index as u32, action));
        }
        for rule in &world.domain.derived {
            schemas.push(Schema::of_rule(world, rule));
        }
        let predicates = &world.domain.predicates;
        let mut exploration = Self {
            world,
            found: Reached {
                schemas,
                relations: predicates
                    .iter()
                    .map(|p| Relation::new(p.parameters.len()))
                    .collect(),
                symbols: Symbols::default(),
                costs: Costs::new(world, attachments),
                instances: Vec::new(),
                impossible: world.domain.actions.iter().map(|_| None).collect(),
            },
            queue: Vec::new(),
            waiting: Vec::new(),
            conditional: Vec::new(),
            rules_seen: FxHashSet::default(),
            beam,
        };
        for atom in &world.problem.facts {
            let predicate = atom.predicate.index();
            if world.changing_predicate[predicate] {
                exploration.reach_atom(predicate, &atom.arguments, 0.0);
            } else {
                exploration.found.relations[predicate].insert(&atom.arguments, 0);
            }
        }
        for timed in &world.problem.timed {
            if let TimedChange::Add(atom) = &timed.change {
                let label = timed.time as f32;
                exploration.reach_atom(atom.predicate.index(), &atom.arguments, label);
            }
        }
        exploration
    }

    fn reach_atom(&mut self, predicate: usize, arguments: &[ObjectId], label: f32) {
        let sequence = match self.beam {
            // Joins see it when it is admitted.
            Some(_) => u32::MAX,
            None => self.queue.len() as u32 + 1,
        };
        if self.found.relations[predicate].insert_labelled(arguments, sequence, label) {
            if let Some(beam) = &mut self.beam {
                beam.pend(label, self.queue.len());
            }
            self.queue.push((predicate, arguments.into()));
        }
    }

    /// Instantiations of the schemas that need no atom of a changing predicate.
    fn without_changing_conditions(
        &self,
        candidates: &mut Candidates<'_>,
    ) -> Result<(), GroundingError> {
        for (index, schema) in self.found.schemas.iter().enumerate() {
            let changing = |p: usize| self.world.changing_predicate[p];
            if schema
                .join
                .iter()
                .any(|atom| changing(atom.predicate.index()))
            {
                continue;
            }
            let limits = candidates.limits;
            let go_on = || limits.check().is_ok();
            instantiate(
                schema,
                &self.found.relations,
                None,
                &go_on,
                &mut |arguments| candidates.add(index as u32, arguments),
            );
        }
        candidates.fault()
    }

    /// Instantiations that the queue's atom at `head` completes; joins see it as the
    /// `sequence`-th.
    fn join_atom(
        &self,
        head: usize,
        sequence: u32,
        candidates: &mut Candidates<'_>,
    ) -> Result<(), GroundingError> {
        let (predicate, tuple) = &self.queue[head];
        let limits = candidates.limits;
        for (index, schema) in self.found.schemas.iter().enumerate() {
            for (position, atom) in schema.join.iter().enumerate() {
                if atom.predicate.index() != *predicate {
                    continue;
                }
                let trigger = Trigger {
                    position,
                    sequence,
                    tuple,
                    in_order: self.beam.is_none(),
                };
                instantiate(
                    schema,
                    &self.found.relations,
                    Some(trigger),
                    &|| limits.check().is_ok(),
                    &mut |arguments| {
                        let useful = self
                            .beam
                            .as_ref()
                            .is_none_or(|beam| beam.may_admit_all(self.world, schema, arguments));
                        !useful || candidates.add(index as u32, arguments)
                    },
                );
            }
        }
        candidates.fault()
    }
}

/// `action argument ...` of an instance, for messages.
pub(super) fn instance_name(
    world: &World<'_>,
    schema: &Schema<'_>,
    arguments: &[ObjectId],
) -> String {
    let mut text = match schema.origin {
        Origin::Action(_, action) => action.name.text.clone(),
        Origin::Rule(rule) => world.domain.predicates[rule.predicate.index()]
            .name
            .text
            .clone(),
    };
    for object in arguments {
        text.push(' ');
        text.push_str(&world.problem.objects[object.index()].name.text);
    }
    text
}
