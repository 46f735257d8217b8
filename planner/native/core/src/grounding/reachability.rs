//! Relaxed reachability: which ground actions and atoms can occur when nothing is ever deleted.
//!
//! Works in layers. A layer joins the atoms that the previous one reached, evaluates all
//! attachments its candidates need in one batch per module, and lets the survivors reach new atoms.
//! Candidates whose conditions are not conjunctions of atoms wait until these can hold.

use rustc_hash::FxHashSet;

use crate::attachment::Attachments;
use crate::pddl::model::{Condition, Effect, EffectKind, ObjectId, TimedChange, When};
use crate::task::Duration;

use super::beam::Beam;
use super::costs::Costs;
use super::duration::{action_duration, impossible_duration};
use super::effect_calls::collect_effect_calls;
use super::formula::{AtomId, Formula, Instantiation, Symbols, for_all_bindings, gather};
use super::join::{Trigger, instantiate};
use super::relation::Relation;
use super::schema::{Origin, Schema};
use super::world::World;
use super::{GroundingError, GroundingLimits};

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

/// Instantiations whose conditions and costs are still to be looked at.
struct Candidates<'l> {
    list: Vec<(u32, Box<[ObjectId]>)>,
    limits: &'l GroundingLimits<'l>,
    stopped: Option<GroundingError>,
}

impl<'l> Candidates<'l> {
    /// Candidates allowed for every ground action allowed: most of them may turn out not to apply.
    const PER_OPERATOR: usize = 10;

    fn new(limits: &'l GroundingLimits<'l>) -> Self {
        Self {
            list: Vec::new(),
            limits,
            stopped: None,
        }
    }

    /// False if the limits are reached.
    fn add(&mut self, schema: u32, arguments: &[ObjectId]) -> bool {
        self.list.push((schema, arguments.into()));
        if self.list.len().is_multiple_of(1024) {
            self.stopped = self.limits.check().err();
        }
        let limit = self.limits.operators;
        if self.list.len() > self.limits.candidates {
            self.stopped = Some(GroundingError::TooManyCandidates);
        }
        if self.list.len() > limit.saturating_mul(Self::PER_OPERATOR) {
            self.stopped = Some(GroundingError::TooManyOperators { limit });
        }
        self.stopped.is_none()
    }

    fn fault(&mut self) -> Result<(), GroundingError> {
        self.stopped.take().map_or(Ok(()), Err)
    }
}

struct Conditional {
    condition: Formula,
    atom: AtomId,
    label: f32,
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
        if exploration.found.instances.len() > limits.operators {
            return Err(GroundingError::TooManyOperators {
                limit: limits.operators,
            });
        }
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
                exploration.reach_atom(predicate, atom.arguments.as_slice().into(), 0.0);
            } else {
                exploration.found.relations[predicate].insert(&atom.arguments, 0);
            }
        }
        for timed in &world.problem.timed {
            if let TimedChange::Add(atom) = &timed.change {
                let arguments = atom.arguments.as_slice().into();
                let label = timed.time as f32;
                exploration.reach_atom(atom.predicate.index(), arguments, label);
            }
        }
        exploration
    }

    fn reach_atom(&mut self, predicate: usize, arguments: Box<[ObjectId]>, label: f32) {
        let sequence = match self.beam {
            // Joins see it when it is admitted.
            Some(_) => u32::MAX,
            None => self.queue.len() as u32 + 1,
        };
        if self.found.relations[predicate].insert_labelled(&arguments, sequence, label) {
            if let Some(beam) = &mut self.beam {
                beam.pend(label, self.queue.len());
            }
            self.queue.push((predicate, arguments));
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
            instantiate(schema, &self.found.relations, None, &mut |arguments| {
                candidates.add(index as u32, arguments)
            });
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

    /// Evaluates static conditions, durations and attachments; twice, because the first pass only
    /// collects the calls whose values are missing.
    fn admit(
        &mut self,
        candidates: Vec<(u32, Box<[ObjectId]>)>,
        limits: &GroundingLimits<'_>,
    ) -> Result<(), GroundingError> {
        let mut open = candidates;
        while !open.is_empty() {
            let mut later = Vec::new();
            for (index, (schema, arguments)) in open.into_iter().enumerate() {
                if index.is_multiple_of(1024) {
                    limits.check()?;
                }
                let (incomplete, verdict) = self.examine(schema, &arguments);
                if incomplete && verdict.is_some() {
                    later.push((schema, arguments));
                } else if let Some((duration, formula)) = verdict {
                    let instance = Instance {
                        schema,
                        arguments,
                        duration,
                    };
                    self.enter(instance, formula);
                }
            }
            self.found.costs.evaluate(self.world)?;
            open = later;
        }
        Ok(())
    }

    /// Duration and non-atomic condition of a candidate; `None` if it can never apply.
    fn examine(
        &mut self,
        schema: u32,
        arguments: &[ObjectId],
    ) -> (bool, Option<(Option<Duration>, Formula)>) {
        let world = self.world;
        let Reached {
            schemas,
            relations,
            symbols,
            costs,
            impossible,
            ..
        } = &mut self.found;
        let schema = &schemas[schema as usize];
        let action = || instance_name(world, schema, arguments);
        let mut instantiation = Instantiation {
            world,
            relations,
            symbols,
            costs,
            duration: None,
            action: &action,
            incomplete: false,
        };
        let mut bindings = arguments.to_vec();
        let mut duration = None;
        if let Origin::Action(index, definition) = schema.origin {
            match action_duration(&mut instantiation, definition, &bindings) {
                Ok(found) => duration = found,
                Err(()) => {
                    let first = &mut impossible[index as usize];
                    if first.is_none()
                        && let Some((constraint, value_s)) =
                            impossible_duration(world, definition, &bindings)
                        && schema.rest.iter().all(|condition| {
                            instantiation.condition(condition, true, &mut bindings)
                                != Formula::False
                        })
                    {
                        *first = Some(ImpossibleDuration {
                            arguments: arguments.into(),
                            constraint,
                            value_s,
                        });
                    }
                    return (false, None);
                }
            }
            if let Some(Duration::Fixed(value)) = duration {
                instantiation.duration = Some(value);
            }
            collect_effect_calls(&mut instantiation, definition, &mut bindings);
        }
        let mut parts = Vec::with_capacity(schema.rest.len());
        for condition in &schema.rest {
            let formula = instantiation.condition(condition, true, &mut bindings);
            if formula == Formula::False {
                return (instantiation.incomplete, None);
            }
            parts.push(formula);
        }
        (
            instantiation.incomplete,
            Some((duration, gather(parts, true))),
        )
    }

    fn enter(&mut self, instance: Instance, formula: Formula) {
        if self.possible(&formula) {
            self.accept(instance);
        } else {
            self.waiting.push((instance, formula));
        }
    }

    fn possible(&self, formula: &Formula) -> bool {
        let symbols = &self.found.symbols;
        let relations = &self.found.relations;
        formula.possible(&|atom| {
            let (predicate, arguments) = &symbols.atoms[atom.index()];
            relations[predicate.index()].contains(arguments)
        })
    }

    /// Admits waiting instances and conditional effects whose conditions can hold by now.
    fn wake(&mut self) -> bool {
        let mut woke = false;
        for (instance, formula) in std::mem::take(&mut self.waiting) {
            if self.possible(&formula) {
                self.accept(instance);
                woke = true;
            } else {
                self.waiting.push((instance, formula));
            }
        }
        for effect in std::mem::take(&mut self.conditional) {
            if self.possible(&effect.condition) {
                let (predicate, arguments) = self.found.symbols.atoms[effect.atom.index()].clone();
                self.reach_atom(predicate.index(), arguments, effect.label);
                woke = true;
            } else {
                self.conditional.push(effect);
            }
        }
        woke
    }

    fn accept(&mut self, instance: Instance) {
        let start = self.start_label(&instance);
        let schema = &self.found.schemas[instance.schema as usize];
        match schema.origin {
            Origin::Rule(rule) => {
                if self
                    .rules_seen
                    .insert((instance.schema, instance.arguments.clone()))
                {
                    self.reach_atom(rule.predicate.index(), instance.arguments.clone(), start);
                    self.found.instances.push(instance);
                }
            }
            Origin::Action(_, definition) => {
                let mut bindings = instance.arguments.to_vec();
                let lasts = match instance.duration {
                    Some(Duration::Fixed(seconds)) => seconds as f32,
                    _ => 0.0,
                };
                for (when, effect) in &definition.effects {
                    let label = start + if *when == When::End { lasts } else { 0.0 };
                    self.reach_effect(effect, instance.schema, None, label, &mut bindings);
                }
                self.found.instances.push(instance);
            }
        }
    }

    fn reach_effect(
        &mut self,
        effect: &Effect,
        schema: u32,
        guard: Option<&Formula>,
        label: f32,
        bindings: &mut Vec<ObjectId>,
    ) {
        match &effect.kind {
            EffectKind::And(parts) => {
                for part in parts {
                    self.reach_effect(part, schema, guard, label, bindings);
                }
            }
            EffectKind::Forall(variables, body) => {
                let world = self.world;
                for_all_bindings(world, variables, bindings, &mut |bindings| {
                    self.reach_effect(body, schema, guard, label, bindings);
                });
            }
            EffectKind::When(condition, body) => {
                let inner = self.guard(&[condition], schema, guard, bindings);
                self.reach_effect(body, schema, Some(&inner), label, bindings);
            }
            EffectKind::TimedWhen(conditions, body) => {
                let conditions: Vec<&Condition> = conditions.iter().map(|(_, c)| c).collect();
                let inner = self.guard(&conditions, schema, guard, bindings);
                self.reach_effect(body, schema, Some(&inner), label, bindings);
            }
            EffectKind::Add(atom) => {
                let arguments = World::bind(&atom.arguments, bindings);
                match guard {
                    Some(formula) if !self.possible(formula) => {
                        if *formula != Formula::False {
                            let atom = self.found.symbols.atom(atom.predicate, arguments);
                            self.conditional.push(Conditional {
                                condition: formula.clone(),
                                atom,
                                label,
                            });
                        }
                    }
                    _ => self.reach_atom(atom.predicate.index(), arguments, label),
                }
            }
            EffectKind::Delete(_) | EffectKind::Assign(..) | EffectKind::Module(_) => {}
        }
    }

    fn guard(
        &mut self,
        conditions: &[&Condition],
        schema: u32,
        outer: Option<&Formula>,
        bindings: &mut Vec<ObjectId>,
    ) -> Formula {
        let world = self.world;
        let Reached {
            schemas,
            relations,
            symbols,
            costs,
            ..
        } = &mut self.found;
        let schema = &schemas[schema as usize];
        let action = || instance_name(world, schema, &[]);
        let mut instantiation = Instantiation {
            world,
            relations,
            symbols,
            costs,
            duration: None,
            action: &action,
            incomplete: false,
        };
        let mut parts: Vec<Formula> = outer.cloned().into_iter().collect();
        for condition in conditions {
            parts.push(instantiation.condition(condition, true, bindings));
        }
        gather(parts, true)
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
