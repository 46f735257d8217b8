//! `(:modules ...)` of PDDL/M.
//!
//! Source: Dornhege et al., "Semantic attachments for domain-independent planning systems",
//! ICAPS 2009.

use super::declarations::{duplicate, parameters};
use super::names::{Names, lower, name, verbatim};
use super::scope::Reader;
use super::sink::Sink;
use crate::pddl::model::{Domain, FluentTerm, ModuleDeclaration, ModuleId, ModuleKind, Name};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::{Diagnostic, Place};
use crate::syntax::suggestion::nearest;
use crate::syntax::tree::{Node, NodeKind};

const KINDS: [(&str, ModuleKind); 3] = [
    ("conditionchecker", ModuleKind::Condition),
    ("effect", ModuleKind::Effect),
    ("cost", ModuleKind::Cost),
];

/// Reads the modules; `domain` holds types, constants, predicates and functions.
pub(super) fn read(
    section: Node<'_>,
    domain: &Domain,
    names: &mut Names,
    sink: &mut Sink,
) -> Vec<ModuleDeclaration> {
    let mut modules: Vec<ModuleDeclaration> = Vec::new();
    for node in section.children().skip(1) {
        let Some(module) = declaration(node, domain, names, sink) else {
            continue;
        };
        if let Some(&first) = names.modules.get(&module.name.text) {
            let first = modules[first.index()].name.span;
            sink.push(duplicate("module", &module.name, Place::Here, first));
            continue;
        }
        let id = ModuleId(modules.len() as u32);
        names.modules.insert(module.name.text.clone(), id);
        modules.push(module);
    }
    modules
}

fn declaration(
    node: Node<'_>,
    domain: &Domain,
    names: &Names,
    sink: &mut Sink,
) -> Option<ModuleDeclaration> {
    let parts: Vec<Node<'_>> = node.children().collect();
    if let Some(head) = parts.first()
        && head.text().eq_ignore_ascii_case("subplan_generator")
    {
        sink.push(unsupported(*head, "subplan generators"));
        return None;
    }
    let [head, middle @ .., kind, call] = parts.as_slice() else {
        sink.expected(
            node.span(),
            "a module such as `(name ?x - type cost function@provider)`",
            Some(node),
        );
        return None;
    };
    if !node.is_list() || [head, kind, call].iter().any(|part| part.word().is_none()) {
        sink.expected(
            node.span(),
            "a module such as `(name ?x - type cost function@provider)`",
            Some(node),
        );
        return None;
    }
    let is_fluent = |part: &&Node<'_>| part.kind() != NodeKind::Word && !is_either(**part);
    let first_fluent = middle
        .iter()
        .position(|part| is_fluent(&part))
        .unwrap_or(middle.len());
    let (variables, fluents) = middle.split_at(first_fluent);
    let parameters = parameters(variables.iter().copied(), &domain.types, names, sink);
    let kind = module_kind(*kind, sink)?;
    let writes = written(fluents, kind, &parameters, domain, names, sink);
    let provider = provider(*call, sink)?;
    Some(ModuleDeclaration {
        name: name(*head),
        parameters,
        writes,
        kind,
        call: provider,
    })
}

fn is_either(node: Node<'_>) -> bool {
    node.head()
        .is_some_and(|head| head.text().eq_ignore_ascii_case("either"))
}

fn module_kind(node: Node<'_>, sink: &mut Sink) -> Option<ModuleKind> {
    let word = lower(node.text());
    if word == "grounding" {
        sink.push(unsupported(node, "grounding modules"));
        return None;
    }
    let found = KINDS.iter().find(|(keyword, _)| *keyword == word);
    if found.is_none() {
        sink.push(
            Diagnostic::new(
                Code::ModuleKindUnsupported,
                node.span(),
                format!("`{}` is no kind of module", node.text()),
            )
            .label("expected `conditionchecker`, `cost` or `effect`")
            .did_you_mean(nearest(&word, KINDS.iter().map(|(keyword, _)| *keyword))),
        );
    }
    found.map(|&(_, kind)| kind)
}

fn unsupported(node: Node<'_>, what: &str) -> Diagnostic {
    Diagnostic::new(
        Code::ModuleKindUnsupported,
        node.span(),
        format!("{what} are not supported"),
    )
    .label("this kind of PDDL/M module cannot be used")
    .remedy("use modules of the kinds `conditionchecker`, `cost` and `effect`")
}

fn provider(node: Node<'_>, sink: &mut Sink) -> Option<Name> {
    let call = verbatim(node);
    if call.text.contains('@') {
        return Some(call);
    }
    sink.push(
        Diagnostic::new(
            Code::Malformed,
            call.span,
            format!("`{}` names no provider", call.text),
        )
        .label("expected `function@provider`"),
    );
    None
}

/// The fluents that an effect module writes, over the module's own parameters.
fn written(
    nodes: &[Node<'_>],
    kind: ModuleKind,
    parameters: &[crate::pddl::model::Parameter],
    domain: &Domain,
    names: &Names,
    sink: &mut Sink,
) -> Vec<FluentTerm> {
    if kind != ModuleKind::Effect {
        if let Some(first) = nodes.first() {
            sink.expected(first.span(), "the kind of the module", Some(*first));
        }
        return Vec::new();
    }
    let mut reader = Reader::new(domain, &domain.constants, names, sink, Place::Here);
    reader.variables.extend_from_slice(parameters);
    let mut fluents = Vec::new();
    for &node in nodes {
        if node.is_list() && node.head().is_some_and(|head| head.word().is_some()) {
            fluents.extend(reader.fluent(node));
        } else {
            reader
                .sink
                .expected(node.span(), "a fluent such as `(fuel ?r)`", Some(node));
        }
    }
    fluents
}

/// `(:oplinit f@lib)`, or one entry of `(:moduleoptions (f@lib arg ...))`.
pub(super) fn call_with_arguments(node: Node<'_>, sink: &mut Sink) -> Option<(Name, Vec<Name>)> {
    let parts: Vec<Node<'_>> = if node.word().is_some() {
        vec![node]
    } else {
        node.children().collect()
    };
    let Some((call, arguments)) = parts
        .split_first()
        .filter(|(call, _)| call.word().is_some())
    else {
        sink.expected(
            node.span(),
            "a call such as `(init@provider argument)`",
            Some(node),
        );
        return None;
    };
    let call = provider(*call, sink)?;
    Some((call, arguments.iter().map(|&part| verbatim(part)).collect()))
}
