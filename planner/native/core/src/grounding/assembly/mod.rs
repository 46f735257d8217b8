//! Builds the task from what relaxed reachability found.

mod conjunctions;
mod effects;
mod goal;
mod mentioned;
mod symbols;

use rustc_hash::{FxHashMap, FxHashSet};

use crate::pddl::model::{ObjectId, TimedChange, When};
use crate::task::{
    Axiom, Call, Change, Conjunction, Duration, FactId, GroundExpression, Operator, Task,
    TimedEvent,
};

use super::formula::{AtomId, Formula, gather};
use super::instantiation::Instantiation;
use super::reachability::{Instance, Reached, instance_name};
use super::schema::Origin;
use super::world::World;
use super::{GroundingError, GroundingLimits};
use effects::{RawChange, RawEffect};
use symbols::state_symbols;

struct Assembly<'a, 'b> {
    world: &'a World<'b>,
    reached: Reached<'b>,
    limits: &'a GroundingLimits<'a>,
    fact_of: FxHashMap<AtomId, FactId>,
    /// Atoms that an effect or timed literal adds or deletes.
    touched: FxHashSet<AtomId>,
    initial: FxHashSet<AtomId>,
    /// Memory for the bindings of the instance at hand.
    bindings: Vec<ObjectId>,
    task: Task,
}

pub(super) fn assemble(
    world: &World<'_>,
    reached: Reached<'_>,
    strata: &[u32],
    stateful: bool,
    limits: &GroundingLimits<'_>,
) -> Result<Task, GroundingError> {
    let mut assembly = Assembly {
        world,
        reached,
        limits,
        fact_of: FxHashMap::default(),
        touched: FxHashSet::default(),
        initial: FxHashSet::default(),
        bindings: Vec::new(),
        task: Task {
            action_names: names(world.domain.actions.iter().map(|a| &a.name.text)),
            object_names: names(world.problem.objects.iter().map(|o| &o.name.text)),
            module_names: names(world.domain.modules.iter().map(|m| &m.name.text)),
            module_kinds: world.domain.modules.iter().map(|m| m.kind).collect(),
            ..Task::default()
        },
    };
    let instances = std::mem::take(&mut assembly.reached.instances);
    let mut effects = Vec::with_capacity(instances.len());
    for (index, instance) in instances.iter().enumerate() {
        if index.is_multiple_of(1024) {
            limits.check()?;
        }
        effects.push(assembly.effects(instance));
    }
    assembly.task.operators.reserve(instances.len());
    let timed = assembly.timed();
    assembly.collect_initial();
    for (index, (instance, effects)) in instances.iter().zip(effects).enumerate() {
        if index.is_multiple_of(1024) {
            limits.check()?;
        }
        if let Some(effects) = effects {
            assembly.instance(instance, effects, strata)?;
        }
    }
    for (time, change) in timed {
        if let Some(change) = assembly.change(change) {
            assembly.task.timed.push(TimedEvent { time, change });
        }
    }
    assembly
        .task
        .timed
        .sort_by(|left, right| left.time.total_cmp(&right.time));
    assembly.goal()?;
    assembly.metric();
    Ok(assembly.finish(stateful))
}

fn names<'a>(texts: impl Iterator<Item = &'a String>) -> Vec<String> {
    texts.cloned().collect()
}

impl Assembly<'_, '_> {
    fn with<T>(
        &mut self,
        instance: Option<&Instance>,
        work: impl FnOnce(&mut Instantiation<'_, '_>, &mut Vec<ObjectId>) -> T,
    ) -> T {
        let world = self.world;
        let schemas = &self.reached.schemas;
        let action = || {
            instance.map_or_else(String::new, |i| {
                instance_name(world, &schemas[i.schema as usize], &i.arguments)
            })
        };
        let duration = match instance.and_then(|i| i.duration.as_ref()) {
            Some(Duration::Fixed(value)) => Some(*value),
            _ => None,
        };
        let mut instantiation = Instantiation {
            world,
            relations: &self.reached.relations,
            symbols: &mut self.reached.symbols,
            costs: &mut self.reached.costs,
            duration,
            action: &action,
            incomplete: false,
        };
        let bindings = &mut self.bindings;
        bindings.clear();
        bindings.extend(instance.iter().flat_map(|i| i.arguments.iter()));
        work(&mut instantiation, bindings)
    }

    fn timed(&mut self) -> Vec<(f64, RawChange)> {
        let mut events = Vec::new();
        for timed in &self.world.problem.timed {
            let symbols = &mut self.reached.symbols;
            let change = match &timed.change {
                TimedChange::Add(atom) => {
                    RawChange::Add(symbols.atom(atom.predicate, &atom.arguments))
                }
                TimedChange::Delete(atom) => {
                    RawChange::Delete(symbols.atom(atom.predicate, &atom.arguments))
                }
                TimedChange::Assign(term, value) => RawChange::Other(Change::Assign(
                    crate::pddl::model::Assignment::Assign,
                    symbols.fluent(term.function, &term.arguments),
                    GroundExpression::Constant(*value),
                )),
            };
            if let RawChange::Add(atom) | RawChange::Delete(atom) = change {
                self.touched.insert(atom);
            }
            events.push((timed.time, change));
        }
        events
    }

    fn collect_initial(&mut self) {
        for atom in &self.world.problem.facts {
            if self.world.changing_predicate[atom.predicate.index()] {
                let id = self.reached.symbols.atom(atom.predicate, &atom.arguments);
                self.initial.insert(id);
            }
        }
    }

    /// The truth value of atoms that never change.
    fn known(&self, atom: AtomId) -> Option<bool> {
        let (predicate, arguments) = &self.reached.symbols.atoms[atom.index()];
        if !self.reached.relations[predicate.index()].contains(arguments) {
            // A delete of a fact that is never true still interferes with who needs it false.
            return (!self.touched.contains(&atom)).then_some(false);
        }
        let derived = self.world.domain.predicates[predicate.index()].derived;
        (self.initial.contains(&atom) && !self.touched.contains(&atom) && !derived).then_some(true)
    }

    fn fact(&mut self, atom: AtomId) -> FactId {
        if let Some(&fact) = self.fact_of.get(&atom) {
            return fact;
        }
        let fact = FactId(self.task.facts.len() as u32);
        let (predicate, arguments) = &self.reached.symbols.atoms[atom.index()];
        let mut name = self.world.domain.predicates[predicate.index()]
            .name
            .text
            .clone();
        for object in arguments {
            name.push(' ');
            name.push_str(&self.world.problem.objects[object.index()].name.text);
        }
        self.task.facts.push(name);
        let atom_of_model = self.reached.symbols.atoms[atom.index()].clone();
        self.task.atoms.push(atom_of_model);
        self.fact_of.insert(atom, fact);
        fact
    }

    fn formula(&mut self, instance: &Instance, wanted: When) -> Formula {
        let origin = self.reached.schemas[instance.schema as usize].origin;
        self.with(Some(instance), |instantiation, bindings| match origin {
            Origin::Rule(rule) => instantiation.condition(&rule.condition, true, bindings),
            Origin::Action(_, action) => {
                let mut parts = Vec::new();
                for (when, condition) in &action.conditions {
                    if *when == wanted {
                        parts.push(instantiation.condition(condition, true, bindings));
                    }
                }
                gather(parts, true)
            }
        })
    }

    fn instance(
        &mut self,
        instance: &Instance,
        effects: Vec<RawEffect>,
        strata: &[u32],
    ) -> Result<(), GroundingError> {
        let start = self.formula(instance, When::Start);
        let starts = self.conjunctions(start, Some(instance))?;
        let action = match self.reached.schemas[instance.schema as usize].origin {
            Origin::Action(index, _) => crate::pddl::model::ActionId(index),
            Origin::Rule(rule) => {
                let atom = self
                    .reached
                    .symbols
                    .atom(rule.predicate, &instance.arguments);
                let head = self.fact(atom);
                let stratum = strata[rule.predicate.index()];
                for condition in starts {
                    self.task.axioms.push(Axiom {
                        stratum,
                        condition,
                        head,
                    });
                }
                return Ok(());
            }
        };
        let throughout = self.formula(instance, When::OverAll);
        let throughouts = self.conjunctions(throughout, Some(instance))?;
        let end = self.formula(instance, When::End);
        let ends = self.conjunctions(end, Some(instance))?;
        let (start_effects, end_effects) = self.split_effects(effects, instance)?;
        let also_reads = [
            self.mentions(instance, When::Start),
            self.mentions(instance, When::End),
        ];
        self.task.narrowed |= throughouts.len() > 1;
        let mut operator = Operator {
            action,
            arguments: instance.arguments.to_vec(),
            duration: instance.duration.clone(),
            start_condition: Conjunction::default(),
            invariant: Conjunction::default(),
            end_condition: Conjunction::default(),
            also_reads,
            start_effects,
            end_effects,
        };
        let (mut starts, mut throughouts, mut ends) = (starts, throughouts, ends);
        if starts.len() * throughouts.len() * ends.len() == 1 {
            operator.start_condition = starts.remove(0);
            operator.invariant = throughouts.remove(0);
            operator.end_condition = ends.remove(0);
            self.task.operators.push(operator);
            return Ok(());
        }
        for start_condition in &starts {
            for invariant in &throughouts {
                for end_condition in &ends {
                    self.task.operators.push(Operator {
                        start_condition: start_condition.clone(),
                        invariant: invariant.clone(),
                        end_condition: end_condition.clone(),
                        ..operator.clone()
                    });
                }
            }
        }
        Ok(())
    }

    fn finish(self, stateful: bool) -> Task {
        let Self {
            world,
            reached,
            mut task,
            initial,
            fact_of,
            ..
        } = self;
        let object = |o: &ObjectId| world.problem.objects[o.index()].name.text.clone();
        task.initial_facts = initial
            .iter()
            .filter_map(|atom| fact_of.get(atom).copied())
            .collect();
        task.initial_facts.sort_unstable();
        for (function, arguments) in &reached.symbols.fluents {
            let mut name = world.domain.functions[function.index()].name.text.clone();
            for argument in arguments {
                name.push(' ');
                name.push_str(&object(argument));
            }
            task.fluents.push(name);
            let value = world.value(*function, arguments);
            task.initial_values.push(value.unwrap_or(f64::NAN));
        }
        for (module, arguments) in &reached.symbols.calls {
            let writes = &world.domain.modules[module.index()].writes;
            task.calls.push(Call {
                module: *module,
                arguments: arguments.iter().map(object).collect(),
                writes: writes
                    .iter()
                    .map(|term| {
                        let bound = World::bind(&term.arguments, arguments);
                        let position = reached
                            .symbols
                            .fluents
                            .iter()
                            .position(|(f, a)| *f == term.function && **a == *bound);
                        crate::task::FluentId(position.unwrap_or(0) as u32)
                    })
                    .collect(),
            });
        }
        task.axioms.sort_by_key(|axiom| axiom.stratum);
        if stateful {
            task.symbols = state_symbols(world, &reached, &fact_of, &initial);
        }
        task
    }
}
