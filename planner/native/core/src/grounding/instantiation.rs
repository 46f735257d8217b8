//! Ground conditions and expressions under bindings of parameters, with static parts folded.

use crate::pddl::model::{
    Arithmetic, Comparison, Condition, ConditionKind, Expression, ExpressionKind, FluentTerm,
    ModuleCall, ObjectId, Parameter,
};
use crate::task::{GroundExpression, NumericCondition};

use super::costs::Costs;
use super::formula::{Formula, Symbols, gather, truth};
use super::relation::Relation;
use super::world::World;

/// What instantiating needs; `incomplete` is set when an attachment's value was not known yet.
pub(super) struct Instantiation<'a, 'b> {
    pub(super) world: &'a World<'b>,
    pub(super) relations: &'a [Relation],
    pub(super) symbols: &'a mut Symbols,
    pub(super) costs: &'a mut Costs<'b>,
    /// Duration of the action where it is a number.
    pub(super) duration: Option<f64>,
    /// The ground action on whose behalf attachments are called.
    pub(super) action: &'a dyn Fn() -> String,
    pub(super) incomplete: bool,
}

impl Instantiation<'_, '_> {
    /// The formula for a condition (or its negation) under bindings.
    pub(super) fn condition(
        &mut self,
        condition: &Condition,
        positive: bool,
        bindings: &mut Vec<ObjectId>,
    ) -> Formula {
        match &condition.kind {
            ConditionKind::And(parts) => self.connect(parts, positive, positive, bindings),
            ConditionKind::Or(parts) => self.connect(parts, positive, !positive, bindings),
            ConditionKind::Not(inner) => self.condition(inner, !positive, bindings),
            ConditionKind::Imply(left, right) => {
                let parts = vec![
                    self.condition(left, !positive, bindings),
                    self.condition(right, positive, bindings),
                ];
                gather(parts, !positive)
            }
            ConditionKind::Forall(variables, body) => {
                self.quantify(variables, body, positive, positive, bindings)
            }
            ConditionKind::Exists(variables, body) => {
                self.quantify(variables, body, positive, !positive, bindings)
            }
            ConditionKind::Atom(atom) => {
                let arguments = World::bind(&atom.arguments, bindings);
                if self.world.changing_predicate[atom.predicate.index()] {
                    Formula::Atom(self.symbols.atom(atom.predicate, &arguments), positive)
                } else {
                    truth(self.relations[atom.predicate.index()].contains(&arguments) == positive)
                }
            }
            ConditionKind::Equal(left, right) => truth(
                (World::value_of(*left, bindings) == World::value_of(*right, bindings)) == positive,
            ),
            ConditionKind::Compare(comparison, left, right) => {
                let left = self.expression(left, bindings);
                let right = self.expression(right, bindings);
                match (left, right) {
                    (Some(left), Some(right)) => compare(*comparison, left, right, positive),
                    _ => Formula::False,
                }
            }
            ConditionKind::Module(call) => self.checker(call, positive, bindings),
        }
    }

    fn connect(
        &mut self,
        parts: &[Condition],
        positive: bool,
        conjunction: bool,
        bindings: &mut Vec<ObjectId>,
    ) -> Formula {
        let mut formulas = Vec::with_capacity(parts.len());
        for part in parts {
            let formula = self.condition(part, positive, bindings);
            match (&formula, conjunction) {
                (Formula::False, true) | (Formula::True, false) => return formula,
                _ => formulas.push(formula),
            }
        }
        gather(formulas, conjunction)
    }

    fn quantify(
        &mut self,
        variables: &[Parameter],
        body: &Condition,
        positive: bool,
        conjunction: bool,
        bindings: &mut Vec<ObjectId>,
    ) -> Formula {
        let mut formulas = Vec::new();
        let depth = bindings.len();
        for_all_bindings(self.world, variables, bindings, &mut |bindings| {
            formulas.push(self.condition(body, positive, bindings));
        });
        bindings.truncate(depth);
        gather(formulas, conjunction)
    }

    fn checker(&mut self, call: &ModuleCall, positive: bool, bindings: &[ObjectId]) -> Formula {
        let arguments = World::bind(&call.arguments, bindings);
        if !self.costs.is_pure(call.module) {
            return Formula::Call(self.symbols.call(call.module, &arguments), positive);
        }
        match self.costs.value(call.module, &arguments, self.action) {
            Some(value) => truth((value != 0.0 && value.is_finite()) == positive),
            None => {
                self.incomplete = true;
                Formula::True
            }
        }
    }

    /// The expression under bindings; `None` where it is undefined or infinite.
    pub(super) fn expression(
        &mut self,
        expression: &Expression,
        bindings: &[ObjectId],
    ) -> Option<GroundExpression> {
        match &expression.kind {
            ExpressionKind::Number(value) => Some(GroundExpression::Constant(*value)),
            ExpressionKind::Fluent(term) => self.fluent(term, bindings),
            ExpressionKind::Module(call) => {
                let arguments = World::bind(&call.arguments, bindings);
                if !self.costs.is_pure(call.module) {
                    let call = self.symbols.call(call.module, &arguments);
                    return Some(GroundExpression::Call(call));
                }
                match self.costs.value(call.module, &arguments, self.action) {
                    Some(value) => value
                        .is_finite()
                        .then_some(GroundExpression::Constant(value)),
                    None => {
                        self.incomplete = true;
                        Some(GroundExpression::Constant(1.0))
                    }
                }
            }
            ExpressionKind::Duration => Some(
                self.duration
                    .map_or(GroundExpression::Duration, GroundExpression::Constant),
            ),
            ExpressionKind::TotalTime => Some(GroundExpression::TotalTime),
            ExpressionKind::Binary(operation, left, right) => {
                let left = self.expression(left, bindings)?;
                let right = self.expression(right, bindings)?;
                combine(*operation, left, right)
            }
            ExpressionKind::Negate(inner) => {
                let inner = self.expression(inner, bindings)?;
                combine(Arithmetic::Subtract, GroundExpression::Constant(0.0), inner)
            }
        }
    }

    fn fluent(&mut self, term: &FluentTerm, bindings: &[ObjectId]) -> Option<GroundExpression> {
        let arguments = World::bind(&term.arguments, bindings);
        if self.world.changing_function[term.function.index()] {
            let fluent = self.symbols.fluent(term.function, &arguments);
            return Some(GroundExpression::Fluent(fluent));
        }
        let value = self.world.value(term.function, &arguments);
        value.map(GroundExpression::Constant)
    }
}

/// Calls `visit` with the bindings extended by every combination of objects for the variables.
pub(super) fn for_all_bindings(
    world: &World<'_>,
    variables: &[Parameter],
    bindings: &mut Vec<ObjectId>,
    visit: &mut dyn FnMut(&mut Vec<ObjectId>),
) {
    let Some((first, others)) = variables.split_first() else {
        visit(bindings);
        return;
    };
    for object in world.candidates(first) {
        bindings.push(object);
        for_all_bindings(world, others, bindings, visit);
        bindings.pop();
    }
}

fn compare(
    comparison: Comparison,
    left: GroundExpression,
    right: GroundExpression,
    positive: bool,
) -> Formula {
    use Comparison::{Equal, Greater, GreaterEqual, Less, LessEqual};
    if let (GroundExpression::Constant(left), GroundExpression::Constant(right)) = (&left, &right) {
        return truth(comparison.holds(*left, *right) == positive);
    }
    let comparison = match (comparison, positive) {
        (other, true) => other,
        (Less, false) => GreaterEqual,
        (LessEqual, false) => Greater,
        (Greater, false) => LessEqual,
        (GreaterEqual, false) => Less,
        (Equal, false) => {
            let less = compare(Less, left.clone(), right.clone(), true);
            let more = compare(Greater, left, right, true);
            return gather(vec![less, more], false);
        }
    };
    Formula::Compare(NumericCondition {
        comparison,
        left,
        right,
    })
}

/// A folded operation; `None` where it is undefined.
pub(super) fn combine(
    operation: Arithmetic,
    left: GroundExpression,
    right: GroundExpression,
) -> Option<GroundExpression> {
    if let (GroundExpression::Constant(left), GroundExpression::Constant(right)) = (&left, &right) {
        let value = operation.apply(*left, *right);
        return value
            .is_finite()
            .then_some(GroundExpression::Constant(value));
    }
    Some(GroundExpression::Binary(
        operation,
        Box::new(left),
        Box::new(right),
    ))
}
