//! `(define (domain NAME) ...)`.

use super::condition::trajectory_unsupported;
use super::declarations::{self, duplicate};
use super::definition::{self, Definition, single};
use super::names::{Names, lower};
use super::requirements::{self, Feature};
use super::scope::Reader;
use super::sink::Sink;
use super::{modules, types};
use crate::pddl::model::{Action, DerivedRule, Domain};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::{Diagnostic, Place};
use crate::syntax::tree::{Node, Tree};

const SECTIONS: [&str; 13] = [
    ":requirements",
    ":types",
    ":constants",
    ":predicates",
    ":functions",
    ":modules",
    ":action",
    ":durative-action",
    ":derived",
    ":oplinit",
    ":constraints",
    ":process",
    ":event",
];

/// Reads the domain of a file.
pub(super) fn read(tree: &Tree) -> (Option<Domain>, Vec<Diagnostic>) {
    let mut sink = Sink::new(tree);
    let domain = definition::find(tree, "domain", &SECTIONS, &mut sink)
        .map(|definition| read_definition(definition, &mut sink));
    (domain, sink.finish())
}

fn read_definition(definition: Definition<'_>, sink: &mut Sink) -> Domain {
    let Definition {
        node,
        name,
        sections,
    } = definition;
    refuse(&sections, sink);
    let (mut domain, mut names) = empty(name, node);
    let requirements = single(&sections, ":requirements", sink);
    if let Some(section) = requirements {
        domain.requirements = requirements::read(section, sink);
    }
    if let Some(section) = single(&sections, ":types", sink) {
        types::read(section, &mut domain.types, &mut names, sink);
    }
    if let Some(section) = single(&sections, ":constants", sink) {
        let constants = &mut domain.constants;
        declarations::objects(section, &domain.types, constants, 0, &mut names, sink);
    }
    if let Some(section) = single(&sections, ":predicates", sink) {
        domain.predicates = declarations::predicates(section, &domain.types, &mut names, sink);
    }
    if let Some(section) = single(&sections, ":functions", sink) {
        domain.functions = declarations::functions(section, &domain.types, &mut names, sink);
    }
    if let Some(section) = single(&sections, ":modules", sink) {
        domain.modules = modules::read(section, &domain, &mut names, sink);
    }
    if let Some(section) = single(&sections, ":oplinit", sink)
        && let Some(call) = section.children().nth(1)
    {
        domain.action_initialiser = modules::call_with_arguments(call, sink).map(|(call, _)| call);
    }
    mark_derived(&sections, &mut domain, &names);
    let (actions, derived) = read_bodies(&sections, &domain, &names, sink);
    domain.actions = actions;
    domain.derived = derived;
    requirements::check(&[&domain.requirements], requirements, node, sink);
    domain
}

fn empty(name: crate::pddl::model::Name, node: Node<'_>) -> (Domain, Names) {
    let domain = Domain {
        name,
        requirements: Vec::new(),
        types: vec![types::root(node.span())],
        constants: Vec::new(),
        predicates: Vec::new(),
        functions: Vec::new(),
        modules: Vec::new(),
        actions: Vec::new(),
        derived: Vec::new(),
        action_initialiser: None,
    };
    let names = Names::of(&domain);
    (domain, names)
}

/// Reports the sections that are known and not supported.
fn refuse(sections: &[(String, Node<'_>)], sink: &mut Sink) {
    for (keyword, node) in sections {
        let head = node.head().unwrap_or(*node);
        match keyword.as_str() {
            ":constraints" => sink.push(trajectory_unsupported(head)),
            ":process" | ":event" => sink.push(
                Diagnostic::new(
                    Code::ProcessUnsupported,
                    head.span(),
                    "processes and events are not supported",
                )
                .label("part of PDDL+")
                .remedy("changes at known times can be timed initial literals"),
            ),
            _ => {}
        }
    }
}

/// Predicates at the head of a rule are derived; effects have to know before they are read.
fn mark_derived(sections: &[(String, Node<'_>)], domain: &mut Domain, names: &Names) {
    for (_, section) in sections.iter().filter(|(keyword, _)| keyword == ":derived") {
        let head = section.children().nth(1).and_then(Node::head);
        let predicate = head.and_then(|head| names.predicates.get(lower(head.text()).as_ref()));
        if let Some(predicate) = predicate {
            domain.predicates[predicate.index()].derived = true;
        }
    }
}

fn read_bodies(
    sections: &[(String, Node<'_>)],
    domain: &Domain,
    names: &Names,
    sink: &mut Sink,
) -> (Vec<Action>, Vec<DerivedRule>) {
    let mut reader = Reader::new(domain, &domain.constants, names, sink, Place::Here);
    let mut actions: Vec<Action> = Vec::new();
    let mut derived = Vec::new();
    let mut first_of = rustc_hash::FxHashMap::default();
    for (keyword, section) in sections {
        let action = match keyword.as_str() {
            ":action" => reader.action(*section, false),
            ":durative-action" => reader.action(*section, true),
            ":derived" => {
                derived.extend(reader.derived_rule(*section));
                None
            }
            _ => None,
        };
        let Some(action) = action else { continue };
        let first = *first_of
            .entry(action.name.text.clone())
            .or_insert(action.name.span);
        if first != action.name.span {
            let again = duplicate("action", &action.name, Place::Here, first);
            reader.sink.push(again);
            continue;
        }
        actions.push(action);
    }
    (actions, derived)
}

impl Reader<'_> {
    fn derived_rule(&mut self, section: Node<'_>) -> Option<DerivedRule> {
        self.uses(Feature::DerivedPredicates, section.head()?);
        let [head, body] = self.operands(section)?;
        let named = head.head().filter(|node| node.word().is_some());
        let Some(named) = named else {
            let span = head.span();
            self.sink
                .expected(span, "a predicate such as `(p ?x)`", Some(head));
            return None;
        };
        let predicate = self.predicate(named);
        let written = head.children().skip(1);
        let mut parameters =
            declarations::parameters(written, &self.domain.types, self.names, self.sink);
        if let Some(predicate) = predicate {
            let declaration = &self.domain.predicates[predicate.index()];
            if parameters.len() != declaration.parameters.len() {
                let wanted = declaration.parameters.len();
                self.wrong_arity(head.span(), parameters.len(), wanted, &declaration.name);
                return None;
            }
            let untyped = !head.children().any(|node| node.word() == Some("-"));
            for (own, declared) in parameters.iter_mut().zip(&declaration.parameters) {
                if untyped {
                    own.types.clone_from(&declared.types);
                }
            }
        }
        let condition = self.bound(&parameters, |reader| reader.condition(body));
        Some(DerivedRule {
            predicate: predicate?,
            parameters,
            condition: condition?,
            span: section.span(),
        })
    }
}
