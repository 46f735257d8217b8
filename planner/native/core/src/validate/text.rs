//! PDDL text of ground conditions and expressions, for messages.

use super::scene::Scene;
use crate::pddl::model::{
    Arithmetic, Comparison, Condition, ConditionKind, Expression, ExpressionKind, FunctionId,
    ModuleCall, ObjectId, Parameter, PredicateId, Term, VariableId,
};

/// How a comparison is written.
pub(super) const fn sign(comparison: Comparison) -> &'static str {
    match comparison {
        Comparison::Less => "<",
        Comparison::LessEqual => "<=",
        Comparison::Equal => "=",
        Comparison::GreaterEqual => ">=",
        Comparison::Greater => ">",
    }
}

impl Scene<'_> {
    pub(super) fn object_name(&self, object: ObjectId) -> &str {
        &self.problem.objects[object.index()].name.text
    }

    fn list(&self, head: &str, tuple: &[ObjectId]) -> String {
        let mut text = head.to_owned();
        for object in tuple {
            text.push(' ');
            text.push_str(self.object_name(*object));
        }
        text
    }

    /// `(p a b)`
    pub(super) fn fact_text(&self, predicate: PredicateId, tuple: &[ObjectId]) -> String {
        let name = &self.domain.predicates[predicate.index()].name.text;
        format!("({})", self.list(name, tuple))
    }

    /// `(f a b)`
    pub(super) fn fluent_text(&self, function: FunctionId, tuple: &[ObjectId]) -> String {
        let name = &self.domain.functions[function.index()].name.text;
        format!("({})", self.list(name, tuple))
    }

    /// A term; a variable that is not bound yet keeps the name of its quantifier.
    fn term_text<'t>(
        &'t self,
        term: Term,
        bindings: &[ObjectId],
        quantified: &[&'t str],
    ) -> &'t str {
        match term {
            Term::Object(object) => self.object_name(object),
            Term::Variable(VariableId(index)) => {
                let index = index as usize;
                bindings.get(index).map_or_else(
                    || {
                        quantified
                            .get(index - bindings.len())
                            .copied()
                            .unwrap_or("?")
                    },
                    |object| self.object_name(*object),
                )
            }
        }
    }

    fn terms(&self, head: &str, terms: &[Term], bindings: &[ObjectId], names: &[&str]) -> String {
        let mut text = head.to_owned();
        for term in terms {
            text.push(' ');
            text.push_str(self.term_text(*term, bindings, names));
        }
        text
    }

    fn call_text(&self, call: &ModuleCall, bindings: &[ObjectId], names: &[&str]) -> String {
        let module = &self.domain.modules[call.module.index()].name.text;
        format!("[{}]", self.terms(module, &call.arguments, bindings, names))
    }

    /// A condition with its variables replaced by objects.
    pub(super) fn condition_text(&self, condition: &Condition, bindings: &[ObjectId]) -> String {
        self.condition_text_in(condition, bindings, &mut Vec::new())
    }

    fn condition_text_in<'n>(
        &'n self,
        condition: &'n Condition,
        bindings: &[ObjectId],
        names: &mut Vec<&'n str>,
    ) -> String {
        match &condition.kind {
            ConditionKind::And(parts) => self.parts_text("and", parts, bindings, names),
            ConditionKind::Or(parts) => self.parts_text("or", parts, bindings, names),
            ConditionKind::Not(part) => {
                format!("(not {})", self.condition_text_in(part, bindings, names))
            }
            ConditionKind::Imply(premise, conclusion) => format!(
                "(imply {} {})",
                self.condition_text_in(premise, bindings, names),
                self.condition_text_in(conclusion, bindings, names)
            ),
            ConditionKind::Forall(parameters, part) => {
                self.quantified_text("forall", parameters, part, bindings, names)
            }
            ConditionKind::Exists(parameters, part) => {
                self.quantified_text("exists", parameters, part, bindings, names)
            }
            ConditionKind::Atom(atom) => {
                let name = &self.domain.predicates[atom.predicate.index()].name.text;
                format!("({})", self.terms(name, &atom.arguments, bindings, names))
            }
            ConditionKind::Equal(left, right) => {
                format!("({})", self.terms("=", &[*left, *right], bindings, names))
            }
            ConditionKind::Compare(comparison, left, right) => format!(
                "({} {} {})",
                sign(*comparison),
                self.expression_text_in(left, bindings, names),
                self.expression_text_in(right, bindings, names)
            ),
            ConditionKind::Module(call) => self.call_text(call, bindings, names),
        }
    }

    fn parts_text<'n>(
        &'n self,
        head: &str,
        parts: &'n [Condition],
        bindings: &[ObjectId],
        names: &mut Vec<&'n str>,
    ) -> String {
        let mut text = format!("({head}");
        for part in parts {
            text.push(' ');
            text.push_str(&self.condition_text_in(part, bindings, names));
        }
        text.push(')');
        text
    }

    fn quantified_text<'n>(
        &'n self,
        head: &str,
        parameters: &'n [Parameter],
        part: &'n Condition,
        bindings: &[ObjectId],
        names: &mut Vec<&'n str>,
    ) -> String {
        let own: Vec<&str> = parameters
            .iter()
            .map(|one| one.name.text.as_str())
            .collect();
        names.extend(&own);
        let inner = self.condition_text_in(part, bindings, names);
        names.truncate(names.len() - own.len());
        format!("({head} ({}) {inner})", own.join(" "))
    }

    /// An expression with its variables replaced by objects.
    pub(super) fn expression_text(&self, expression: &Expression, bindings: &[ObjectId]) -> String {
        self.expression_text_in(expression, bindings, &[])
    }

    fn expression_text_in(
        &self,
        expression: &Expression,
        bindings: &[ObjectId],
        names: &[&str],
    ) -> String {
        match &expression.kind {
            ExpressionKind::Number(number) => number.to_string(),
            ExpressionKind::Fluent(term) => {
                let name = &self.domain.functions[term.function.index()].name.text;
                format!("({})", self.terms(name, &term.arguments, bindings, names))
            }
            ExpressionKind::Module(call) => self.call_text(call, bindings, names),
            ExpressionKind::Duration => "?duration".into(),
            ExpressionKind::TotalTime => "total-time".into(),
            ExpressionKind::Binary(operation, left, right) => {
                let sign = match operation {
                    Arithmetic::Add => "+",
                    Arithmetic::Subtract => "-",
                    Arithmetic::Multiply => "*",
                    Arithmetic::Divide => "/",
                    Arithmetic::Minimum => "min",
                    Arithmetic::Maximum => "max",
                };
                format!(
                    "({sign} {} {})",
                    self.expression_text_in(left, bindings, names),
                    self.expression_text_in(right, bindings, names)
                )
            }
            ExpressionKind::Negate(part) => {
                format!("(- {})", self.expression_text_in(part, bindings, names))
            }
        }
    }
}
