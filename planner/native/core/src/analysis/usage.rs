//! Who reads, writes and mentions what, over the domain and all problems.

use super::Subject;
use super::walk::{self, Mention};
use crate::pddl::model::{ConditionKind, Problem, Term, TimedChange};
use crate::syntax::span::Span;

/// Use of one predicate.
#[derive(Clone, Debug, Default)]
pub(super) struct PredicateUse {
    /// A condition, rule or goal asks for it.
    pub read: bool,
    /// The first effect that makes it true.
    pub added: Option<Span>,
    /// The first effect that makes it false.
    pub deleted: Option<Span>,
    /// It is true initially, or made true by a timed initial literal, in some problem.
    pub initial: bool,
}

/// Use of one function.
#[derive(Clone, Debug, Default)]
pub(super) struct FunctionUse {
    /// Its value is used.
    pub read: bool,
    /// The first effect that changes it.
    pub written: Option<Span>,
    /// It has an initial value in some problem.
    pub initial: bool,
}

/// Use of everything that a domain declares.
#[derive(Debug)]
pub(super) struct Usage {
    pub predicates: Vec<PredicateUse>,
    pub functions: Vec<FunctionUse>,
    pub modules: Vec<bool>,
    pub constants: Vec<bool>,
}

impl Usage {
    pub fn new(subject: &Subject<'_>) -> Self {
        let domain = subject.domain;
        let mut usage = Self {
            predicates: vec![PredicateUse::default(); domain.predicates.len()],
            functions: vec![FunctionUse::default(); domain.functions.len()],
            modules: vec![false; domain.modules.len()],
            constants: vec![false; domain.constants.len()],
        };
        walk::domain(domain, &mut |_, visit| {
            visit(&mut |mention| usage.note(mention));
        });
        for rule in &domain.derived {
            usage.predicates[rule.predicate.index()]
                .added
                .get_or_insert(rule.span);
        }
        for problem in subject.problems {
            usage.problem(problem);
        }
        usage
    }

    fn note(&mut self, mention: Mention<'_>) {
        match mention {
            Mention::Read(atom) => self.predicates[atom.predicate.index()].read = true,
            Mention::Add(atom) => {
                let first = &mut self.predicates[atom.predicate.index()].added;
                first.get_or_insert(atom.span);
            }
            Mention::Delete(atom) => {
                let first = &mut self.predicates[atom.predicate.index()].deleted;
                first.get_or_insert(atom.span);
            }
            Mention::Value(fluent) => self.functions[fluent.function.index()].read = true,
            Mention::Write(fluent) => {
                let first = &mut self.functions[fluent.function.index()].written;
                first.get_or_insert(fluent.span);
            }
            Mention::Call(call) => self.modules[call.module.index()] = true,
            Mention::Term(Term::Object(object)) => {
                if let Some(mentioned) = self.constants.get_mut(object.index()) {
                    *mentioned = true;
                }
            }
            Mention::Term(Term::Variable(_)) | Mention::Enter(_) | Mention::Leave => {}
        }
    }

    fn problem(&mut self, problem: &Problem) {
        walk::condition(&problem.goal, &mut |mention| self.note(mention));
        if let Some(metric) = &problem.metric {
            walk::expression(&metric.expression, &mut |mention| self.note(mention));
        }
        for fact in &problem.facts {
            self.predicates[fact.predicate.index()].initial = true;
        }
        for (fluent, _) in &problem.fluents {
            self.functions[fluent.function.index()].initial = true;
        }
        for timed in &problem.timed {
            match &timed.change {
                TimedChange::Add(fact) => {
                    self.predicates[fact.predicate.index()].initial = true;
                }
                TimedChange::Delete(_) => {}
                TimedChange::Assign(fluent, _) => {
                    self.functions[fluent.function.index()].initial = true;
                }
            }
        }
        for object in mentioned_objects(problem) {
            if let Some(mentioned) = self.constants.get_mut(object) {
                *mentioned = true;
            }
        }
    }
}

/// Indices of the objects that a problem mentions anywhere but in their declaration.
pub(super) fn mentioned_objects(problem: &Problem) -> Vec<usize> {
    let mut mentioned = vec![false; problem.objects.len()];
    let mut mark = |index: usize| mentioned[index] = true;
    for fact in &problem.facts {
        fact.arguments
            .iter()
            .for_each(|object| mark(object.index()));
    }
    for (fluent, _) in &problem.fluents {
        fluent
            .arguments
            .iter()
            .for_each(|object| mark(object.index()));
    }
    for timed in &problem.timed {
        let arguments = match &timed.change {
            TimedChange::Add(fact) | TimedChange::Delete(fact) => &fact.arguments,
            TimedChange::Assign(fluent, _) => &fluent.arguments,
        };
        arguments.iter().for_each(|object| mark(object.index()));
    }
    let mut term = |mention: Mention<'_>| {
        if let Mention::Term(Term::Object(object)) = mention {
            mark(object.index());
        }
    };
    walk::condition(&problem.goal, &mut term);
    if let Some(metric) = &problem.metric {
        walk::expression(&metric.expression, &mut term);
    }
    let quantified = matches!(
        problem.goal.kind,
        ConditionKind::Forall(..) | ConditionKind::Exists(..)
    );
    (0..mentioned.len())
        .filter(|&index| mentioned[index] || quantified)
        .collect()
}
