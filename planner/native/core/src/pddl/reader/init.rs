//! `(:init ...)`: facts, values of fluents, timed initial literals.
//!
//! Files with a million entries are read in about a second: one pass, no allocation but the
//! entries themselves.

use std::collections::hash_map::Entry;
use std::hash::{Hash, Hasher};

use rustc_hash::{FxHashMap, FxHasher};

use super::requirements::Feature;
use super::scope::Reader;
use crate::pddl::model::{GroundAtom, GroundFluent, ObjectId, Problem, TimedChange, TimedInitial};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::span::Span;
use crate::syntax::tree::{Node, NodeKind};

/// A literal or a value.
enum Entered {
    Add(GroundAtom),
    Delete(GroundAtom),
    Value(GroundFluent, f64),
}

impl Reader<'_> {
    /// Reads `(:init ...)` into a problem.
    pub fn initial_state(&mut self, section: Node<'_>, problem: &mut Problem) {
        let mut values = ValueIndex::default();
        let mut deleted = Vec::new();
        for node in section.children().skip(1) {
            if let Some((time, inner)) = timed(node) {
                self.timed_initial(node, time, inner, problem, &mut deleted);
                continue;
            }
            match self.initial_entry(node) {
                Some(Entered::Add(fact)) => problem.facts.push(fact),
                Some(Entered::Value(fluent, value)) => {
                    if let Some(earlier) = values.insert(&fluent, value, &problem.fluents) {
                        self.conflicting(fluent.span, earlier);
                    } else {
                        problem.fluents.push((fluent, value));
                    }
                }
                // False at the start anyway.
                Some(Entered::Delete(_)) | None => {}
            }
        }
        if !deleted.is_empty() {
            problem.facts.retain(|fact| {
                !deleted.iter().any(|gone: &GroundAtom| {
                    gone.predicate == fact.predicate && gone.arguments == fact.arguments
                })
            });
        }
    }

    fn conflicting(&mut self, span: Span, earlier: Span) {
        if span == earlier {
            return;
        }
        self.sink.push(
            Diagnostic::new(
                Code::ConflictingValue,
                span,
                "this fluent has another value already",
            )
            .label("the second value")
            .note(earlier, "the first value")
            .remedy("remove one of them"),
        );
    }

    fn initial_entry(&mut self, node: Node<'_>) -> Option<Entered> {
        let Some(head) = node.head().filter(|head| head.word().is_some()) else {
            self.sink
                .expected(node.span(), "a fact such as `(p a)`", Some(node));
            return None;
        };
        if !node.is_list() {
            self.sink
                .expected(node.span(), "a fact such as `(p a)`", Some(node));
            return None;
        }
        match head.text() {
            "=" => self.initial_value(node),
            word if word.eq_ignore_ascii_case("not") => {
                let [inner] = self.operands(node)?;
                inner.head().filter(|head| head.word().is_some())?;
                self.ground_atom(inner).map(Entered::Delete)
            }
            word if word.eq_ignore_ascii_case("and") => {
                self.sink.push(
                    Diagnostic::new(
                        Code::Malformed,
                        head.span(),
                        "`and` does not belong into the initial state",
                    )
                    .label("list the facts directly in (:init ...)"),
                );
                None
            }
            _ => self.ground_atom(node).map(Entered::Add),
        }
    }

    fn initial_value(&mut self, node: Node<'_>) -> Option<Entered> {
        let [fluent, value] = self.operands(node)?;
        let named = match fluent.kind() {
            NodeKind::Word => Some(fluent),
            NodeKind::List => fluent.head().filter(|head| head.word().is_some()),
            NodeKind::Call => None,
        };
        let Some(named) = named else {
            self.sink.expected(
                fluent.span(),
                "a numeric fluent such as `(f a)`",
                Some(fluent),
            );
            return None;
        };
        let function = self.function(named);
        let value = self.finite(value);
        let declaration = &self.domain.functions[function?.index()];
        let arguments =
            self.ground_arguments(fluent, &declaration.parameters, &declaration.name)?;
        let fluent = GroundFluent {
            function: function?,
            arguments,
            span: fluent.span(),
        };
        Some(Entered::Value(fluent, value?))
    }

    fn ground_atom(&mut self, node: Node<'_>) -> Option<GroundAtom> {
        let predicate = self.predicate(node.head()?)?;
        let declaration = &self.domain.predicates[predicate.index()];
        if declaration.derived {
            // Reported with the same words as for effects.
            self.changed_atom(node);
            return None;
        }
        let arguments = self.ground_arguments(node, &declaration.parameters, &declaration.name)?;
        Some(GroundAtom {
            predicate,
            arguments,
            span: node.span(),
        })
    }

    fn ground_arguments(
        &mut self,
        whole: Node<'_>,
        parameters: &[crate::pddl::model::Parameter],
        declared: &crate::pddl::model::Name,
    ) -> Option<Vec<ObjectId>> {
        let mut arguments = Vec::with_capacity(parameters.len());
        let mut complete = true;
        let mut count = 0;
        for node in whole.children().skip(1) {
            let parameter = parameters.get(count);
            count += 1;
            let Some(object) = self.object(node) else {
                complete = false;
                continue;
            };
            if let Some(parameter) = parameter {
                complete &= self.check_object(node, object, parameter, declared);
                arguments.push(object);
            }
        }
        if count != parameters.len() {
            self.wrong_arity(whole.span(), count, parameters.len(), declared);
            return None;
        }
        complete.then_some(arguments)
    }

    fn timed_initial(
        &mut self,
        node: Node<'_>,
        time: Node<'_>,
        inner: Node<'_>,
        problem: &mut Problem,
        deleted: &mut Vec<GroundAtom>,
    ) {
        self.uses(Feature::TimedInitialLiterals, node.head().unwrap_or(node));
        let seconds = self.finite(time);
        let entered = self.initial_entry(inner);
        let (Some(seconds), Some(entered)) = (seconds, entered) else {
            return;
        };
        if seconds < 0.0 {
            self.sink.push(
                Diagnostic::new(
                    Code::InvalidTimedLiteral,
                    time.span(),
                    format!("time {} lies before the start", time.text()),
                )
                .label("plans begin at time 0"),
            );
            return;
        }
        if seconds == 0.0 {
            match entered {
                Entered::Add(fact) => problem.facts.push(fact),
                Entered::Delete(fact) => deleted.push(fact),
                Entered::Value(fluent, value) => problem.fluents.push((fluent, value)),
            }
            return;
        }
        let change = match entered {
            Entered::Add(fact) => TimedChange::Add(fact),
            Entered::Delete(fact) => TimedChange::Delete(fact),
            Entered::Value(fluent, value) => TimedChange::Assign(fluent, value),
        };
        problem.timed.push(TimedInitial {
            time: seconds,
            change,
            span: node.span(),
        });
    }
}

/// `(at 5 (p a))`: the time and the literal. `(at robot1 kitchen)` is a fact, because its last
/// part is no list; `(at robot1 (p))` is taken for a timed literal and its time is refused.
fn timed(node: Node<'_>) -> Option<(Node<'_>, Node<'_>)> {
    let mut parts = node.children();
    let (head, time, inner) = (parts.next()?, parts.next()?, parts.next()?);
    let is_at = head
        .word()
        .is_some_and(|word| word.eq_ignore_ascii_case("at"));
    let timed = is_at && inner.is_list() && parts.next().is_none() && time.word().is_some();
    timed.then_some((time, inner))
}

/// Finds a second value of the same fluent without storing the fluents again.
#[derive(Default)]
struct ValueIndex {
    first: FxHashMap<u64, u32>,
}

impl ValueIndex {
    /// Notes that the next fluent has `value`; gives the earlier place of the same fluent, or its
    /// own place if the value is the same and it need not be stored again.
    fn insert(
        &mut self,
        fluent: &GroundFluent,
        value: f64,
        stored: &[(GroundFluent, f64)],
    ) -> Option<Span> {
        let mut hasher = FxHasher::default();
        (fluent.function, &fluent.arguments).hash(&mut hasher);
        let mut key = hasher.finish();
        loop {
            match self.first.entry(key) {
                Entry::Vacant(entry) => {
                    entry.insert(stored.len() as u32);
                    return None;
                }
                Entry::Occupied(entry) => {
                    let (earlier, known) = &stored[*entry.get() as usize];
                    if earlier.function == fluent.function && earlier.arguments == fluent.arguments
                    {
                        let same = (known - value).abs() == 0.0;
                        return Some(if same { fluent.span } else { earlier.span });
                    }
                    key = key.wrapping_add(1);
                }
            }
        }
    }
}
