//! Actions and derived rules as joins over positive atoms, plus whatever a join cannot decide.

use crate::pddl::model::{
    Action, Atom, Condition, ConditionKind, DerivedRule, Effect, EffectKind, ObjectId, Parameter,
    Term, When,
};

use super::world::World;

/// What a schema instantiates.
#[derive(Clone, Copy)]
pub(super) enum Origin<'a> {
    /// Action number and definition.
    Action(u32, &'a Action),
    /// A derived rule.
    Rule(&'a DerivedRule),
}

/// A schema ready for joining.
pub(super) struct Schema<'a> {
    pub(super) origin: Origin<'a>,
    pub(super) parameters: &'a [Parameter],
    /// Objects admitted by each parameter.
    pub(super) candidates: Vec<Vec<ObjectId>>,
    /// Membership table of `candidates`, by object.
    pub(super) admitted: Vec<Vec<bool>>,
    /// Positive atoms that have to be reached before the schema applies.
    pub(super) join: Vec<&'a Atom>,
    /// Pairs of terms that must (not) be the same object.
    pub(super) equalities: Vec<(Term, Term, bool)>,
    /// Conditions that are neither of these.
    pub(super) rest: Vec<&'a Condition>,
}

impl<'a> Schema<'a> {
    pub(super) fn of_action(world: &World<'a>, index: u32, action: &'a Action) -> Self {
        let mut schema = Self::empty(world, Origin::Action(index, action), &action.parameters);
        let mut added = Vec::new();
        for (when, effect) in &action.effects {
            if *when == When::Start && action.duration.is_some() {
                unconditional_adds(effect, &mut added);
            }
        }
        for (when, condition) in &action.conditions {
            schema.split(condition, *when, &added);
        }
        schema
    }

    pub(super) fn of_rule(world: &World<'a>, rule: &'a DerivedRule) -> Self {
        let mut schema = Self::empty(world, Origin::Rule(rule), &rule.parameters);
        schema.split(&rule.condition, When::Start, &[]);
        schema
    }

    fn empty(world: &World<'a>, origin: Origin<'a>, parameters: &'a [Parameter]) -> Self {
        let candidates: Vec<Vec<ObjectId>> =
            parameters.iter().map(|p| world.candidates(p)).collect();
        let objects = world.problem.objects.len();
        let admitted = candidates
            .iter()
            .map(|list| {
                let mut table = vec![false; objects];
                list.iter().for_each(|object| table[object.index()] = true);
                table
            })
            .collect();
        Self {
            origin,
            parameters,
            candidates,
            admitted,
            join: Vec::new(),
            equalities: Vec::new(),
            rest: Vec::new(),
        }
    }

    /// Sorts the conjuncts; a condition that the action's own start effect supplies needs no support.
    fn split(&mut self, condition: &'a Condition, when: When, added: &[&Atom]) {
        match &condition.kind {
            ConditionKind::And(parts) => {
                for part in parts {
                    self.split(part, when, added);
                }
            }
            ConditionKind::Atom(atom) => {
                let own = when != When::Start
                    && added.iter().any(|other| {
                        other.predicate == atom.predicate && other.arguments == atom.arguments
                    });
                if !own && !self.join.iter().any(|other| same(other, atom)) {
                    self.join.push(atom);
                }
            }
            ConditionKind::Equal(left, right) => self.equalities.push((*left, *right, true)),
            ConditionKind::Not(inner) => match &inner.kind {
                ConditionKind::Equal(left, right) => self.equalities.push((*left, *right, false)),
                _ => self.rest.push(condition),
            },
            _ => self.rest.push(condition),
        }
    }
}

fn same(left: &Atom, right: &Atom) -> bool {
    left.predicate == right.predicate && left.arguments == right.arguments
}

fn unconditional_adds<'a>(effect: &'a Effect, added: &mut Vec<&'a Atom>) {
    match &effect.kind {
        EffectKind::And(parts) => parts
            .iter()
            .for_each(|part| unconditional_adds(part, added)),
        EffectKind::Add(atom) => added.push(atom),
        _ => {}
    }
}
