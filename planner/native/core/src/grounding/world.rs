//! What stays the same while grounding: type members, static facts, static fluents.

use rustc_hash::FxHashMap;

use crate::pddl::model::{
    Domain, Effect, EffectKind, Expression, ExpressionKind, FunctionId, ObjectId, Parameter,
    Problem, Term, TimedChange, TypeId,
};

use super::tuple::Tuple;

/// The domain and problem with the tables that grounding looks things up in.
pub(super) struct World<'a> {
    pub(super) domain: &'a Domain,
    pub(super) problem: &'a Problem,
    /// Whether an effect, a timed initial literal or a derived rule can change the predicate.
    pub(super) changing_predicate: Vec<bool>,
    /// Whether an effect, a module or a timed assignment can change the function.
    pub(super) changing_function: Vec<bool>,
    /// Initial values, by function.
    values: Vec<FxHashMap<&'a [ObjectId], f64>>,
    members: Vec<Vec<bool>>,
}

impl<'a> World<'a> {
    pub(super) fn new(domain: &'a Domain, problem: &'a Problem) -> Self {
        let mut world = Self {
            domain,
            problem,
            changing_predicate: domain.predicates.iter().map(|p| p.derived).collect(),
            changing_function: vec![false; domain.functions.len()],
            values: vec![FxHashMap::default(); domain.functions.len()],
            members: type_members(domain, problem),
        };
        for (term, value) in &problem.fluents {
            world.values[term.function.index()].insert(&term.arguments, *value);
        }
        for rule in &domain.derived {
            world.changing_predicate[rule.predicate.index()] = true;
        }
        for action in &domain.actions {
            for (_, effect) in &action.effects {
                world.mark_changes(effect);
            }
        }
        for timed in &problem.timed {
            match &timed.change {
                TimedChange::Add(atom) | TimedChange::Delete(atom) => {
                    world.changing_predicate[atom.predicate.index()] = true;
                }
                TimedChange::Assign(term, _) => {
                    world.changing_function[term.function.index()] = true;
                }
            }
        }
        world
    }

    fn mark_changes(&mut self, effect: &Effect) {
        match &effect.kind {
            EffectKind::And(parts) => parts.iter().for_each(|part| self.mark_changes(part)),
            EffectKind::Forall(_, body)
            | EffectKind::When(_, body)
            | EffectKind::TimedWhen(_, body) => self.mark_changes(body),
            EffectKind::Add(atom) | EffectKind::Delete(atom) => {
                self.changing_predicate[atom.predicate.index()] = true;
            }
            EffectKind::Assign(_, term, _) => {
                self.changing_function[term.function.index()] = true;
            }
            EffectKind::Module(call) => {
                for term in &self.domain.modules[call.module.index()].writes {
                    self.changing_function[term.function.index()] = true;
                }
            }
        }
    }

    /// Whether an object may be bound to a parameter.
    pub(super) fn admits(&self, parameter: &Parameter, object: ObjectId) -> bool {
        parameter
            .types
            .iter()
            .any(|kind| self.members[kind.index()][object.index()])
    }

    /// All objects that may be bound to a parameter.
    pub(super) fn candidates(&self, parameter: &Parameter) -> Vec<ObjectId> {
        (0..self.problem.objects.len() as u32)
            .map(ObjectId)
            .filter(|&object| self.admits(parameter, object))
            .collect()
    }

    /// The initial value of a fluent, if it has one.
    pub(super) fn value(&self, function: FunctionId, arguments: &[ObjectId]) -> Option<f64> {
        self.values[function.index()].get(arguments).copied()
    }

    /// The value of an expression of numbers and static fluents; it may be infinite or not a number.
    pub(super) fn static_value(
        &self,
        expression: &Expression,
        bindings: &[ObjectId],
    ) -> Option<f64> {
        Some(match &expression.kind {
            ExpressionKind::Number(value) => *value,
            ExpressionKind::Fluent(term) if !self.changing_function[term.function.index()] => {
                let arguments = Self::bind(&term.arguments, bindings);
                self.value(term.function, &arguments)?
            }
            ExpressionKind::Negate(inner) => -self.static_value(inner, bindings)?,
            ExpressionKind::Binary(operation, left, right) => operation.apply(
                self.static_value(left, bindings)?,
                self.static_value(right, bindings)?,
            ),
            _ => return None,
        })
    }

    /// Replaces bound variables.
    pub(super) fn bind(terms: &[Term], bindings: &[ObjectId]) -> Tuple {
        let objects = terms.iter().map(|term| Self::value_of(*term, bindings));
        objects.into()
    }

    /// The object that a term stands for.
    pub(super) fn value_of(term: Term, bindings: &[ObjectId]) -> ObjectId {
        match term {
            Term::Variable(variable) => bindings[variable.index()],
            Term::Object(object) => object,
        }
    }
}

fn type_members(domain: &Domain, problem: &Problem) -> Vec<Vec<bool>> {
    let mut members = vec![vec![false; problem.objects.len()]; domain.types.len()];
    for (index, object) in problem.objects.iter().enumerate() {
        let mut open: Vec<TypeId> = object.types.clone();
        open.push(TypeId(0));
        while let Some(kind) = open.pop() {
            if !std::mem::replace(&mut members[kind.index()][index], true) {
                open.extend(&domain.types[kind.index()].parents);
            }
        }
    }
    members
}
