//! What a body (condition, effect, expression) is read against: names, bound variables, place.

use super::names::{Names, lower};
use super::requirements::Feature;
use super::sink::Sink;
use super::types::Hierarchy;
use crate::pddl::model::{Domain, ObjectDeclaration, ObjectId, Parameter, Term, VariableId};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::{Diagnostic, Place};
use crate::syntax::span::Span;
use crate::syntax::suggestion::nearest;
use crate::syntax::tree::Node;

/// Reads bodies of a domain or a problem.
pub(super) struct Reader<'d> {
    pub domain: &'d Domain,
    /// Constants, and in a problem its objects behind them.
    pub objects: &'d [ObjectDeclaration],
    pub names: &'d Names,
    pub hierarchy: Hierarchy<'d>,
    pub sink: &'d mut Sink,
    /// Variables in scope, outermost first.
    pub variables: Vec<Parameter>,
    /// Whether `?duration` has a meaning here.
    pub has_duration: bool,
    /// Whether `total-time` has a meaning here.
    pub in_metric: bool,
    /// Where declarations of the domain stand, seen from the file being read.
    pub domain_place: Place,
}

impl<'d> Reader<'d> {
    pub fn new(
        domain: &'d Domain,
        objects: &'d [ObjectDeclaration],
        names: &'d Names,
        sink: &'d mut Sink,
        domain_place: Place,
    ) -> Self {
        Self {
            domain,
            objects,
            names,
            hierarchy: Hierarchy::new(&domain.types),
            sink,
            variables: Vec::new(),
            has_duration: false,
            in_metric: false,
            domain_place,
        }
    }

    /// Reads `read` with more variables in scope.
    pub fn bound<T>(&mut self, more: &[Parameter], read: impl FnOnce(&mut Self) -> T) -> T {
        let outside = self.variables.len();
        self.variables.extend_from_slice(more);
        let result = read(self);
        self.variables.truncate(outside);
        result
    }

    /// The variables of a quantifier: `(?x - t ...)`.
    pub fn quantified(&mut self, node: Option<Node<'_>>, around: Span) -> Option<Vec<Parameter>> {
        let Some(list) = node.filter(|node| node.is_list()) else {
            self.sink.expected(
                node.map_or(around, Node::span),
                "a list of variables such as `(?x - type)`",
                node,
            );
            return None;
        };
        Some(super::declarations::parameters(
            list.children(),
            &self.domain.types,
            self.names,
            self.sink,
        ))
    }

    /// The innermost variable of a name.
    pub fn variable(&self, name: &str) -> Option<VariableId> {
        self.variables
            .iter()
            .rposition(|variable| variable.name.text == name)
            .map(|position| VariableId(position as u32))
    }

    /// A variable, constant or object.
    pub fn term(&mut self, node: Node<'_>) -> Option<Term> {
        let Some(word) = node.word() else {
            self.sink
                .expected(node.span(), "a variable or an object", Some(node));
            return None;
        };
        let name = lower(word);
        if !word.starts_with('?') {
            return self.object(node).map(Term::Object);
        }
        if let Some(variable) = self.variable(&name) {
            return Some(Term::Variable(variable));
        }
        let variables = &self.variables;
        self.sink.report(Code::UnknownVariable, || {
            let known = variables.iter().map(|variable| variable.name.text.as_str());
            let suggestion = nearest(&name, known);
            let diagnostic = Diagnostic::new(
                Code::UnknownVariable,
                node.span(),
                format!("unknown variable `{word}`"),
            )
            .label("no parameter or quantifier introduces it");
            match suggestion {
                Some(_) => diagnostic.did_you_mean(suggestion),
                None if name == "?duration" => {
                    diagnostic.remedy("`?duration` is a number and no argument")
                }
                None => diagnostic.remedy(format!("add `{word}` to the parameters")),
            }
        });
        None
    }

    /// A constant or object.
    pub fn object(&mut self, node: Node<'_>) -> Option<ObjectId> {
        let Some(word) = node.word() else {
            self.sink
                .expected(node.span(), "the name of an object", Some(node));
            return None;
        };
        let name = lower(word);
        if let Some(&object) = self.names.objects.get(name.as_ref()) {
            return Some(object);
        }
        let (objects, variables) = (self.objects, &self.variables);
        let domain_place = self.domain_place;
        self.sink.report(Code::UnknownObject, || {
            let known = objects.iter().map(|object| object.name.text.as_str());
            let variables = variables.iter().map(|variable| variable.name.text.as_str());
            let suggestion = nearest(&name, variables.chain(known));
            let (label, place) = match domain_place {
                Place::Here => ("no constant of this name", "(:constants ...)"),
                Place::Domain => ("neither an object nor a constant", "(:objects ...)"),
            };
            let diagnostic = Diagnostic::new(
                Code::UnknownObject,
                node.span(),
                format!("unknown object `{word}`"),
            )
            .label(label);
            match suggestion {
                Some(_) => diagnostic.did_you_mean(suggestion),
                None => diagnostic.remedy(format!("declare `{word}` in {place}")),
            }
        });
        None
    }

    /// Notes that a feature is used here.
    pub fn uses(&mut self, feature: Feature, node: Node<'_>) {
        self.sink.uses(feature, node.first_token_span());
    }
}
