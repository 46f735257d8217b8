//! `(define (problem NAME) ...)`.

use super::condition::trajectory_unsupported;
use super::declarations;
use super::definition::{self, Definition, single};
use super::modules;
use super::names::{Names, lower};
use super::requirements;
use super::scope::Reader;
use super::sink::Sink;
use crate::pddl::model::{Condition, ConditionKind, Domain, Metric, Name, Problem};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::{Diagnostic, Place};
use crate::syntax::suggestion::nearest;
use crate::syntax::tree::{Node, Tree};

const SECTIONS: [&str; 11] = [
    ":domain",
    ":requirements",
    ":objects",
    ":init",
    ":goal",
    ":metric",
    ":constraints",
    ":length",
    ":situation",
    ":moduleoptions",
    ":moduleexitoptions",
];

/// Reads the problem of a file.
pub(super) fn read(tree: &Tree, domain: &Domain) -> (Option<Problem>, Vec<Diagnostic>) {
    let mut sink = Sink::new(tree);
    let problem = definition::find(tree, "problem", &SECTIONS, &mut sink)
        .map(|definition| read_definition(definition, domain, &mut sink));
    (problem, sink.finish())
}

fn read_definition(definition: Definition<'_>, domain: &Domain, sink: &mut Sink) -> Problem {
    let Definition {
        node,
        name,
        sections,
    } = definition;
    let requirements = single(&sections, ":requirements", sink);
    let flags = requirements.map_or_else(Vec::new, |section| requirements::read(section, sink));
    check_domain_name(single(&sections, ":domain", sink), domain, &name, sink);
    report_without_effect(&sections, sink);
    let mut names = Names::of(domain);
    let mut objects = domain.constants.clone();
    if let Some(section) = single(&sections, ":objects", sink) {
        let inherited = domain.constants.len();
        let types = &domain.types;
        declarations::objects(section, types, &mut objects, inherited, &mut names, sink);
    }
    let mut problem = empty(name, node);
    problem.module_options = options(&sections, ":moduleoptions", sink);
    problem.module_exit_options = options(&sections, ":moduleexitoptions", sink);
    let (init, goal, metric) = (
        single(&sections, ":init", sink),
        single(&sections, ":goal", sink),
        single(&sections, ":metric", sink),
    );
    let mut reader = Reader::new(domain, &objects, &names, sink, Place::Domain);
    if let Some(section) = init {
        reader.initial_state(section, &mut problem);
    }
    match goal {
        Some(section) => reader.goal(section, &mut problem.goal),
        None => reader.missing_goal(&problem.name),
    }
    problem.metric = metric.and_then(|section| reader.metric(section));
    problem.objects = objects;
    let declared: [&[Name]; 2] = [&domain.requirements, &flags];
    requirements::check(&declared, requirements, node, sink);
    problem
}

fn empty(name: Name, node: Node<'_>) -> Problem {
    Problem {
        name,
        objects: Vec::new(),
        facts: Vec::new(),
        fluents: Vec::new(),
        timed: Vec::new(),
        goal: Condition {
            kind: ConditionKind::And(Vec::new()),
            span: node.first_token_span(),
        },
        metric: None,
        module_options: Vec::new(),
        module_exit_options: Vec::new(),
    }
}

fn check_domain_name(section: Option<Node<'_>>, domain: &Domain, name: &Name, sink: &mut Sink) {
    let written = section.and_then(|section| section.children().nth(1));
    let Some(written) = written.filter(|node| node.word().is_some()) else {
        let span = section.map_or(name.span, Node::span);
        sink.expected(span, "the name of the domain, `(:domain NAME)`", written);
        return;
    };
    if lower(written.text()) == domain.name.text {
        return;
    }
    sink.push(
        Diagnostic::new(
            Code::DomainMismatch,
            written.span(),
            format!(
                "the problem is for domain `{}`, it is read with `{}`",
                written.text(),
                domain.name.text
            ),
        )
        .label("another name")
        .note_at(Place::Domain, domain.name.span, "the domain in use")
        .fix(
            format!("Replace with `{}`", domain.name.text),
            written.span(),
            &domain.name.text,
        ),
    );
}

fn report_without_effect(sections: &[(String, Node<'_>)], sink: &mut Sink) {
    for (keyword, node) in sections {
        let head = node.head().unwrap_or(*node);
        match keyword.as_str() {
            ":constraints" => sink.push(trajectory_unsupported(head)),
            ":length" | ":situation" => sink.push(
                Diagnostic::new(
                    Code::IgnoredSection,
                    head.span(),
                    format!("`{keyword}` has no effect"),
                )
                .label("not read")
                .remedy("remove the section"),
            ),
            _ => {}
        }
    }
}

fn options(
    sections: &[(String, Node<'_>)],
    keyword: &str,
    sink: &mut Sink,
) -> Vec<(Name, Vec<Name>)> {
    sections
        .iter()
        .filter(|(written, _)| written == keyword)
        .flat_map(|(_, section)| section.children().skip(1))
        .filter_map(|entry| modules::call_with_arguments(entry, sink))
        .collect()
}

impl Reader<'_> {
    fn goal(&mut self, section: Node<'_>, goal: &mut Condition) {
        let Some([node]) = self.operands(section) else {
            return;
        };
        if let Some(condition) = self.condition(node) {
            *goal = condition;
        }
    }

    fn missing_goal(&mut self, name: &Name) {
        self.sink.push(
            Diagnostic::new(
                Code::MissingSection,
                name.span,
                "the problem has no `(:goal ...)`",
            )
            .label("nothing to plan for")
            .remedy("add `(:goal (and ...))`"),
        );
    }

    fn metric(&mut self, section: Node<'_>) -> Option<Metric> {
        let [direction, expression] = self.operands(section)?;
        const DIRECTIONS: [&str; 4] = ["minimize", "maximize", "minimise", "maximise"];
        let word = lower(direction.text());
        let Some(position) = DIRECTIONS.iter().position(|known| *known == word) else {
            self.sink.push(
                Diagnostic::new(
                    Code::Malformed,
                    direction.span(),
                    format!("expected `minimize` or `maximize`, found `{word}`"),
                )
                .label("the direction of the metric")
                .did_you_mean(nearest(&word, DIRECTIONS)),
            );
            return None;
        };
        self.in_metric = true;
        let expression = self.expression(expression);
        self.in_metric = false;
        Some(Metric {
            maximise: position % 2 == 1,
            expression: expression?,
            span: section.span(),
        })
    }
}
