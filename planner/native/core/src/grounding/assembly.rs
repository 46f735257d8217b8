//! Builds the task from what relaxed reachability found.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::pddl::model::{
    Arithmetic, Condition, ConditionKind, Effect, EffectKind, Expression, ObjectId, PredicateId,
    TimedChange, When,
};
use crate::task::{
    Axiom, Call, Change, Conjunction, Duration, FactId, FluentId, FluentPlace, GroundEffect,
    GroundExpression, Metric, Operator, StateSymbols, Task, TimedEvent,
};

use super::formula::{AtomId, Formula, Instantiation, for_all_bindings, gather};
use super::reachability::{Instance, Reached, instance_name};
use super::schema::Origin;
use super::world::World;
use super::{GroundingError, GroundingLimits};

/// A ground effect before atoms become facts.
struct RawEffect {
    when: When,
    condition: Option<[Formula; 3]>,
    change: RawChange,
}

enum RawChange {
    Add(AtomId),
    Delete(AtomId),
    Other(Change),
}

struct Assembly<'a, 'b> {
    world: &'a World<'b>,
    reached: Reached<'b>,
    limits: &'a GroundingLimits<'a>,
    fact_of: FxHashMap<AtomId, FactId>,
    /// Atoms that an effect or timed literal adds or deletes.
    touched: FxHashSet<AtomId>,
    initial: FxHashSet<AtomId>,
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
    for instance in &instances {
        effects.push(assembly.effects(instance));
    }
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
        let mut bindings = instance.map_or_else(Vec::new, |i| i.arguments.to_vec());
        work(&mut instantiation, &mut bindings)
    }

    /// The ground effects of an instance; `None` if one of them is undefined.
    fn effects(&mut self, instance: &Instance) -> Option<Vec<RawEffect>> {
        let Origin::Action(_, action) = self.reached.schemas[instance.schema as usize].origin
        else {
            return Some(Vec::new());
        };
        let found = self.with(Some(instance), |instantiation, bindings| {
            let mut effects = Vec::new();
            for (when, effect) in &action.effects {
                ground_effect(instantiation, *when, effect, None, bindings, &mut effects)?;
            }
            Some(effects)
        })?;
        for effect in &found {
            if let RawChange::Add(atom) | RawChange::Delete(atom) = effect.change {
                self.touched.insert(atom);
            }
        }
        Some(found)
    }

    fn timed(&mut self) -> Vec<(f64, RawChange)> {
        let mut events = Vec::new();
        for timed in &self.world.problem.timed {
            let symbols = &mut self.reached.symbols;
            let change = match &timed.change {
                TimedChange::Add(atom) => {
                    RawChange::Add(symbols.atom(atom.predicate, atom.arguments.as_slice().into()))
                }
                TimedChange::Delete(atom) => RawChange::Delete(
                    symbols.atom(atom.predicate, atom.arguments.as_slice().into()),
                ),
                TimedChange::Assign(term, value) => RawChange::Other(Change::Assign(
                    crate::pddl::model::Assignment::Assign,
                    symbols.fluent(term.function, term.arguments.as_slice().into()),
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
                let id = self
                    .reached
                    .symbols
                    .atom(atom.predicate, atom.arguments.as_slice().into());
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

    /// The conjunctions that a formula splits into.
    fn conjunctions(
        &mut self,
        formula: Formula,
        instance: Option<&Instance>,
    ) -> Result<Vec<Conjunction>, GroundingError> {
        let folded = formula.fold(&|atom| self.known(atom));
        let limit = self.limits.disjuncts;
        let Some(disjuncts) = folded.disjuncts(limit) else {
            let (action, span) = match instance {
                Some(instance) => {
                    let schema = &self.reached.schemas[instance.schema as usize];
                    let span = match schema.origin {
                        Origin::Action(_, action) => action.span,
                        Origin::Rule(rule) => rule.span,
                    };
                    (instance_name(self.world, schema, &instance.arguments), span)
                }
                None => ("the goal".into(), self.world.problem.goal.span),
            };
            return Err(GroundingError::TooManyDisjuncts {
                action,
                limit,
                span,
            });
        };
        Ok(disjuncts
            .into_iter()
            .filter_map(|literals| self.conjunction(literals))
            .collect())
    }

    fn conjunction(&mut self, literals: Vec<Formula>) -> Option<Conjunction> {
        let mut conjunction = Conjunction::default();
        for literal in literals {
            match literal {
                Formula::Atom(atom, true) => conjunction.positive.push(self.fact(atom)),
                Formula::Atom(atom, false) => conjunction.negative.push(self.fact(atom)),
                Formula::Compare(condition) => conjunction.comparisons.push(condition),
                Formula::Call(call, value) => conjunction.calls.push((call, value)),
                Formula::True => {}
                Formula::False | Formula::And(_) | Formula::Or(_) => return None,
            }
        }
        conjunction.positive.sort_unstable();
        conjunction.positive.dedup();
        conjunction.negative.sort_unstable();
        conjunction.negative.dedup();
        let clash = conjunction
            .positive
            .iter()
            .any(|fact| conjunction.negative.binary_search(fact).is_ok());
        (!clash).then_some(conjunction)
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

    /// Facts inside conditions that are not plain conjunctions.
    fn mentions(&mut self, instance: &Instance, wanted: When) -> Vec<FactId> {
        let Origin::Action(_, action) = self.reached.schemas[instance.schema as usize].origin
        else {
            return Vec::new();
        };
        let world = self.world;
        let mut atoms = Vec::new();
        let mut bindings = instance.arguments.to_vec();
        for (when, condition) in &action.conditions {
            if *when == wanted {
                mentioned(world, condition, false, &mut bindings, &mut atoms);
            }
        }
        for (when, effect) in &action.effects {
            mentioned_by_effect(world, effect, (*when, wanted), &mut bindings, &mut atoms);
        }
        let mut facts: Vec<FactId> = atoms
            .into_iter()
            .filter_map(|(predicate, arguments)| {
                let atom = self.reached.symbols.atom(predicate, arguments);
                (self.known(atom).is_none()).then(|| self.fact(atom))
            })
            .collect();
        facts.sort_unstable();
        facts.dedup();
        facts
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
                    .atom(rule.predicate, instance.arguments.clone());
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
        for start_condition in &starts {
            for invariant in &throughouts {
                for end_condition in &ends {
                    self.task.operators.push(Operator {
                        action,
                        arguments: instance.arguments.to_vec(),
                        duration: instance.duration.clone(),
                        start_condition: start_condition.clone(),
                        invariant: invariant.clone(),
                        end_condition: end_condition.clone(),
                        also_reads: also_reads.clone(),
                        start_effects: start_effects.clone(),
                        end_effects: end_effects.clone(),
                    });
                }
            }
        }
        Ok(())
    }

    fn split_effects(
        &mut self,
        effects: Vec<RawEffect>,
        instance: &Instance,
    ) -> Result<(Vec<GroundEffect>, Vec<GroundEffect>), GroundingError> {
        let mut start = Vec::new();
        let mut end = Vec::new();
        for effect in effects {
            let at_end = effect.when == When::End;
            let Some(change) = self.change(effect.change) else {
                continue;
            };
            let list = if at_end { &mut end } else { &mut start };
            let mut push = |effect: GroundEffect| {
                if !list.contains(&effect) {
                    list.push(effect);
                }
            };
            let Some(condition) = effect.condition else {
                push(GroundEffect {
                    condition: None,
                    change,
                });
                continue;
            };
            let [at_start, throughout, at_end] = condition;
            let at_start = self.conjunctions(at_start, Some(instance))?;
            let throughout = self.conjunctions(throughout, Some(instance))?;
            let at_end = self.conjunctions(at_end, Some(instance))?;
            let ways = at_start.len() * throughout.len() * at_end.len();
            if ways > 1 && !matches!(change, Change::Add(_) | Change::Delete(_)) {
                return Err(GroundingError::Unsupported {
                    what: "a numeric or module effect under a disjunctive condition".into(),
                    span: match self.reached.schemas[instance.schema as usize].origin {
                        Origin::Action(_, action) => action.span,
                        Origin::Rule(rule) => rule.span,
                    },
                });
            }
            for first in &at_start {
                for second in &throughout {
                    for third in &at_end {
                        let conditions = [first.clone(), second.clone(), third.clone()];
                        let trivial = conditions.iter().all(Conjunction::is_empty);
                        push(GroundEffect {
                            condition: (!trivial).then(|| Box::new(conditions)),
                            change: change.clone(),
                        });
                    }
                }
            }
        }
        Ok((start, end))
    }

    /// The change over facts; `None` if it changes nothing that is ever true.
    fn change(&mut self, change: RawChange) -> Option<Change> {
        match change {
            RawChange::Add(atom) => Some(Change::Add(self.fact(atom))),
            RawChange::Delete(atom) => {
                (self.known(atom) != Some(false)).then(|| Change::Delete(self.fact(atom)))
            }
            RawChange::Other(change) => Some(change),
        }
    }

    fn goal(&mut self) -> Result<(), GroundingError> {
        let world = self.world;
        // The first pass only asks for the attachments that the goal mentions.
        let mut formula = Formula::True;
        for _ in 0..2 {
            formula = self.with(None, |instantiation, bindings| {
                instantiation.condition(&world.problem.goal, true, bindings)
            });
            self.reached.costs.evaluate(world)?;
        }
        let mut goals = self.conjunctions(formula, None)?;
        match goals.len() {
            0 => self.task.unsolvable = true,
            1 => self.task.goal = goals.remove(0),
            _ => self.disjunctive_goal(goals),
        }
        Ok(())
    }

    /// A disjunctive goal becomes a derived fact with one axiom per disjunct.
    fn disjunctive_goal(&mut self, goals: Vec<Conjunction>) {
        let head = FactId(self.task.facts.len() as u32);
        self.task.facts.push("(goal)".into());
        self.task
            .atoms
            .push((PredicateId(u32::MAX), Box::default()));
        let stratum = 1 + self
            .task
            .axioms
            .iter()
            .map(|a| a.stratum)
            .max()
            .unwrap_or(0);
        for condition in goals {
            self.task.axioms.push(Axiom {
                stratum,
                condition,
                head,
            });
        }
        self.task.goal.positive = vec![head];
    }

    fn metric(&mut self) {
        let world = self.world;
        let Some(metric) = &world.problem.metric else {
            return;
        };
        let expression: &Expression = &metric.expression;
        let ground = self.with(None, |instantiation, bindings| {
            instantiation.expression(expression, bindings)
        });
        let Some(ground) = ground else { return };
        let makespan = matches!(slope(&ground), Some(slope) if (slope > 0.0) != metric.maximise);
        if !makespan && !matches!(ground, GroundExpression::Constant(_)) {
            self.task.metric = Some(Metric {
                maximise: metric.maximise,
                expression: ground,
            });
        }
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
            let value = world.values.get(&(*function, arguments.clone()));
            task.initial_values.push(value.copied().unwrap_or(f64::NAN));
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
                            .position(|(f, a)| *f == term.function && *a == bound);
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

/// Ground atoms of changing predicates below a disjunction, implication or quantifier.
fn mentioned(
    world: &World<'_>,
    condition: &Condition,
    inside: bool,
    bindings: &mut Vec<ObjectId>,
    atoms: &mut Vec<(PredicateId, Box<[ObjectId]>)>,
) {
    match &condition.kind {
        ConditionKind::And(parts) => {
            for part in parts {
                mentioned(world, part, inside, bindings, atoms);
            }
        }
        ConditionKind::Or(parts) => {
            for part in parts {
                mentioned(world, part, true, bindings, atoms);
            }
        }
        ConditionKind::Not(inner) => mentioned(world, inner, inside, bindings, atoms),
        ConditionKind::Imply(left, right) => {
            mentioned(world, left, true, bindings, atoms);
            mentioned(world, right, true, bindings, atoms);
        }
        ConditionKind::Forall(variables, body) | ConditionKind::Exists(variables, body) => {
            for_all_bindings(world, variables, bindings, &mut |bindings| {
                mentioned(world, body, true, bindings, atoms);
            });
        }
        ConditionKind::Atom(atom) => {
            if inside && world.changing_predicate[atom.predicate.index()] {
                atoms.push((atom.predicate, World::bind(&atom.arguments, bindings)));
            }
        }
        ConditionKind::Equal(..) | ConditionKind::Compare(..) | ConditionKind::Module(_) => {}
    }
}

/// Ground atoms in the conditions of conditional effects, `when` being the effect's time.
fn mentioned_by_effect(
    world: &World<'_>,
    effect: &Effect,
    (when, wanted): (When, When),
    bindings: &mut Vec<ObjectId>,
    atoms: &mut Vec<(PredicateId, Box<[ObjectId]>)>,
) {
    match &effect.kind {
        EffectKind::And(parts) => {
            for part in parts {
                mentioned_by_effect(world, part, (when, wanted), bindings, atoms);
            }
        }
        EffectKind::Forall(variables, body) => {
            for_all_bindings(world, variables, bindings, &mut |bindings| {
                mentioned_by_effect(world, body, (when, wanted), bindings, atoms);
            });
        }
        EffectKind::When(condition, body) => {
            if when == wanted {
                mentioned(world, condition, true, bindings, atoms);
            }
            mentioned_by_effect(world, body, (when, wanted), bindings, atoms);
        }
        EffectKind::TimedWhen(conditions, body) => {
            for (time, condition) in conditions {
                if *time == wanted {
                    mentioned(world, condition, true, bindings, atoms);
                }
            }
            mentioned_by_effect(world, body, (when, wanted), bindings, atoms);
        }
        EffectKind::Add(_)
        | EffectKind::Delete(_)
        | EffectKind::Assign(..)
        | EffectKind::Module(_) => {}
    }
}

/// Where each symbol of the model went.
fn state_symbols(
    world: &World<'_>,
    reached: &Reached<'_>,
    fact_of: &FxHashMap<AtomId, FactId>,
    initial: &FxHashSet<AtomId>,
) -> StateSymbols {
    let mut symbols = StateSymbols::default();
    for (index, key) in reached.symbols.atoms.iter().enumerate() {
        let atom = AtomId(index as u32);
        match fact_of.get(&atom) {
            Some(&fact) => {
                symbols.facts.insert(key.clone(), Some(fact));
            }
            None if initial.contains(&atom) => {
                symbols.facts.insert(key.clone(), None);
            }
            None => {}
        }
    }
    for atom in &world.problem.facts {
        if !world.changing_predicate[atom.predicate.index()] {
            let key = (atom.predicate, atom.arguments.as_slice().into());
            symbols.facts.insert(key, None);
        }
    }
    for (key, value) in &world.values {
        symbols
            .fluents
            .insert(key.clone(), FluentPlace::Constant(*value));
    }
    for (index, key) in reached.symbols.fluents.iter().enumerate() {
        symbols
            .fluents
            .insert(key.clone(), FluentPlace::Stored(FluentId(index as u32)));
    }
    symbols
}

/// Coefficient of the makespan in an expression that depends on nothing else.
fn slope(expression: &GroundExpression) -> Option<f64> {
    match expression {
        GroundExpression::Constant(_) => Some(0.0),
        GroundExpression::TotalTime => Some(1.0),
        GroundExpression::Binary(operation, left, right) => {
            let (l, r) = (slope(left)?, slope(right)?);
            match (operation, left.as_ref(), right.as_ref()) {
                (Arithmetic::Add, ..) => Some(l + r),
                (Arithmetic::Subtract, ..) => Some(l - r),
                (Arithmetic::Multiply, GroundExpression::Constant(k), _) => Some(k * r),
                (Arithmetic::Multiply | Arithmetic::Divide, _, GroundExpression::Constant(k)) => {
                    Some(if *operation == Arithmetic::Multiply {
                        l * k
                    } else {
                        l / k
                    })
                }
                _ => None,
            }
        }
        _ => None,
    }
}

fn ground_effect(
    instantiation: &mut Instantiation<'_, '_>,
    when: When,
    effect: &Effect,
    guard: Option<&[Formula; 3]>,
    bindings: &mut Vec<ObjectId>,
    effects: &mut Vec<RawEffect>,
) -> Option<()> {
    let change = match &effect.kind {
        EffectKind::And(parts) => {
            for part in parts {
                ground_effect(instantiation, when, part, guard, bindings, effects)?;
            }
            return Some(());
        }
        EffectKind::Forall(variables, body) => {
            let world = instantiation.world;
            let mut defined = Some(());
            for_all_bindings(world, variables, bindings, &mut |bindings| {
                if defined.is_some() {
                    defined = ground_effect(instantiation, when, body, guard, bindings, effects);
                }
            });
            return defined;
        }
        EffectKind::When(condition, body) => {
            let formula = instantiation.condition(condition, true, bindings);
            let slot = if when == When::Start { 0 } else { 2 };
            let Some(guard) = narrow(guard, vec![(slot, formula)]) else {
                return Some(());
            };
            return ground_effect(instantiation, when, body, Some(&guard), bindings, effects);
        }
        EffectKind::TimedWhen(conditions, body) => {
            let mut parts = Vec::new();
            for (time, condition) in conditions {
                let formula = instantiation.condition(condition, true, bindings);
                let slot = match time {
                    When::Start => 0,
                    When::OverAll => 1,
                    When::End => 2,
                };
                parts.push((slot, formula));
            }
            let Some(guard) = narrow(guard, parts) else {
                return Some(());
            };
            return ground_effect(instantiation, when, body, Some(&guard), bindings, effects);
        }
        EffectKind::Add(atom) => RawChange::Add(
            instantiation
                .symbols
                .atom(atom.predicate, World::bind(&atom.arguments, bindings)),
        ),
        EffectKind::Delete(atom) => RawChange::Delete(
            instantiation
                .symbols
                .atom(atom.predicate, World::bind(&atom.arguments, bindings)),
        ),
        EffectKind::Assign(assignment, term, expression) => {
            let value = instantiation.expression(expression, bindings)?;
            let fluent = instantiation
                .symbols
                .fluent(term.function, World::bind(&term.arguments, bindings));
            RawChange::Other(Change::Assign(*assignment, fluent, value))
        }
        EffectKind::Module(call) => {
            let arguments = World::bind(&call.arguments, bindings);
            for term in &instantiation.world.domain.modules[call.module.index()].writes {
                let bound = World::bind(&term.arguments, &arguments);
                instantiation.symbols.fluent(term.function, bound);
            }
            RawChange::Other(Change::Call(
                instantiation.symbols.call(call.module, arguments),
            ))
        }
    };
    effects.push(RawEffect {
        when,
        condition: guard.cloned(),
        change,
    });
    Some(())
}

/// The guard with more conditions; `None` if it can never hold.
fn narrow(guard: Option<&[Formula; 3]>, parts: Vec<(usize, Formula)>) -> Option<[Formula; 3]> {
    let mut slots = guard
        .cloned()
        .unwrap_or([Formula::True, Formula::True, Formula::True]);
    for (slot, formula) in parts {
        let joined = gather(vec![slots[slot].clone(), formula], true);
        if joined == Formula::False {
            return None;
        }
        slots[slot] = joined;
    }
    Some(slots)
}
