//! Constants, objects, predicates and functions.

use super::names::{Names, name};
use super::requirements::Feature;
use super::sink::Sink;
use super::typed_list::{MAXIMUM_MEMBERS, too_many, typed_list};
use super::types;
use crate::pddl::model::{
    FunctionDeclaration, FunctionId, Name, ObjectDeclaration, ObjectId, Parameter,
    PredicateDeclaration, PredicateId, TypeDeclaration,
};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::{Diagnostic, Place};
use crate::syntax::span::Span;
use crate::syntax::tree::Node;

/// `name` is declared again.
pub(super) fn duplicate(what: &str, again: &Name, place: Place, first: Span) -> Diagnostic {
    Diagnostic::new(
        Code::DuplicateDeclaration,
        again.span,
        format!("{what} `{}` is declared twice", again.text),
    )
    .label("the second declaration")
    .note_at(place, first, "declared here first")
    .remedy("remove or rename one of them")
}

/// Reads a typed list of variables.
pub(super) fn parameters<'t>(
    nodes: impl Iterator<Item = Node<'t>>,
    declared: &[TypeDeclaration],
    names: &Names,
    sink: &mut Sink,
) -> Vec<Parameter> {
    let mut parameters: Vec<Parameter> = Vec::new();
    for group in typed_list(nodes, sink) {
        let resolved = types::resolve(group.types, declared, names, sink);
        for member in group.members {
            let Some(word) = member.word() else {
                sink.expected(member.span(), "a variable such as `?x`", Some(member));
                continue;
            };
            if !word.starts_with('?') || word.len() == 1 {
                sink.push(
                    Diagnostic::new(
                        Code::Malformed,
                        member.span(),
                        format!("expected a variable, found `{word}`"),
                    )
                    .label("a variable begins with `?`")
                    .did_you_mean(Some(&format!("?{}", word.trim_start_matches('?')))),
                );
                continue;
            }
            if parameters.len() == MAXIMUM_MEMBERS {
                sink.push(too_many(member, "variables in one list"));
                return parameters;
            }
            let parameter = name(member);
            if let Some(first) = parameters.iter().find(|p| p.name.text == parameter.text) {
                sink.push(duplicate(
                    "variable",
                    &parameter,
                    Place::Here,
                    first.name.span,
                ));
            }
            parameters.push(Parameter {
                name: parameter,
                types: resolved.clone(),
            });
        }
    }
    parameters
}

/// Reads `(:constants ...)` or `(:objects ...)`. `objects` holds what was declared before, the first
/// `inherited` of them in the domain.
pub(super) fn objects(
    section: Node<'_>,
    declared: &[TypeDeclaration],
    objects: &mut Vec<ObjectDeclaration>,
    inherited: usize,
    names: &mut Names,
    sink: &mut Sink,
) {
    for group in typed_list(section.children().skip(1), sink) {
        let resolved = types::resolve(group.types, declared, names, sink);
        for member in group.members {
            if member.word().is_none_or(|word| word.starts_with('?')) {
                sink.expected(member.span(), "the name of an object", Some(member));
                continue;
            }
            let object = name(member);
            if let Some(&first) = names.objects.get(&object.text) {
                let earlier = &objects[first.index()];
                let place = if first.index() < inherited {
                    Place::Domain
                } else {
                    Place::Here
                };
                sink.push(
                    duplicate("object", &object, place, earlier.name.span)
                        .label("it belongs to the types of both declarations")
                        .warning(),
                );
                let merged = &mut objects[first.index()].types;
                for &more in &resolved {
                    if !merged.contains(&more) {
                        merged.push(more);
                    }
                }
                continue;
            }
            let id = ObjectId(objects.len() as u32);
            names.objects.insert(object.text.clone(), id);
            objects.push(ObjectDeclaration {
                name: object,
                types: resolved.clone(),
            });
        }
    }
}

/// `(name ?x - t ...)`: the name and the parameters.
fn signature(
    node: Node<'_>,
    what: &str,
    declared: &[TypeDeclaration],
    names: &Names,
    sink: &mut Sink,
) -> Option<(Name, Vec<Parameter>)> {
    let head = node.head().filter(|head| head.word().is_some());
    let Some(head) = head.filter(|_| node.is_list()) else {
        sink.expected(
            node.span(),
            &format!("a {what} such as `(name ?x)`"),
            Some(node),
        );
        return None;
    };
    let parameters = parameters(node.children().skip(1), declared, names, sink);
    Some((name(head), parameters))
}

/// Reads `(:predicates ...)`.
pub(super) fn predicates(
    section: Node<'_>,
    declared: &[TypeDeclaration],
    names: &mut Names,
    sink: &mut Sink,
) -> Vec<PredicateDeclaration> {
    let mut predicates: Vec<PredicateDeclaration> = Vec::new();
    for node in section.children().skip(1) {
        let Some((predicate, parameters)) = signature(node, "predicate", declared, names, sink)
        else {
            continue;
        };
        if let Some(&first) = names.predicates.get(&predicate.text) {
            let first = predicates[first.index()].name.span;
            sink.push(duplicate("predicate", &predicate, Place::Here, first));
            continue;
        }
        let id = PredicateId(predicates.len() as u32);
        names.predicates.insert(predicate.text.clone(), id);
        predicates.push(PredicateDeclaration {
            name: predicate,
            parameters,
            derived: false,
        });
    }
    predicates
}

/// Reads `(:functions ...)`; only functions to numbers.
pub(super) fn functions(
    section: Node<'_>,
    declared: &[TypeDeclaration],
    names: &mut Names,
    sink: &mut Sink,
) -> Vec<FunctionDeclaration> {
    let mut functions: Vec<FunctionDeclaration> = Vec::new();
    for group in typed_list(section.children().skip(1), sink) {
        let number = group
            .types
            .is_none_or(|node| node.text().eq_ignore_ascii_case("number"));
        if let Some(node) = group.types.filter(|_| !number) {
            sink.push(
                Diagnostic::new(
                    Code::ObjectFluentUnsupported,
                    node.span(),
                    "object fluents are not supported",
                )
                .label("only `number` is")
                .remedy("use a predicate with one more argument"),
            );
        }
        for member in group.members {
            let Some((function, parameters)) = signature(member, "function", declared, names, sink)
            else {
                continue;
            };
            sink.uses(Feature::NumericFluents, function.span);
            if let Some(&first) = names.functions.get(&function.text) {
                let first = functions[first.index()].name.span;
                sink.push(duplicate("function", &function, Place::Here, first));
                continue;
            }
            let id = FunctionId(functions.len() as u32);
            names.functions.insert(function.text.clone(), id);
            functions.push(FunctionDeclaration {
                name: function,
                parameters,
            });
        }
    }
    functions
}
