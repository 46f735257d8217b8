//! Over-all conditions that the action itself destroys, and atoms set both ways at once.

use crate::pddl::model::{
    Action, Atom, Condition, ConditionKind, Domain, Effect, EffectKind, When,
};
use crate::syntax::code::Code;
use crate::syntax::diagnostic::{Diagnostic, Diagnostics};

/// Reports them.
pub(super) fn check(domain: &Domain, found: &mut Diagnostics) {
    for action in &domain.actions {
        let mut changes = Vec::new();
        for (when, effect) in &action.effects {
            unconditional(effect, *when, &mut changes);
        }
        broken_invariants(domain, action, &changes, found);
        contradictions(domain, &changes, found);
    }
}

/// An unconditional change of an atom.
struct Change<'m> {
    when: When,
    atom: &'m Atom,
    becomes: bool,
}

fn unconditional<'m>(effect: &'m Effect, when: When, changes: &mut Vec<Change<'m>>) {
    match &effect.kind {
        EffectKind::And(parts) => parts
            .iter()
            .for_each(|part| unconditional(part, when, changes)),
        EffectKind::Add(atom) => changes.push(Change {
            when,
            atom,
            becomes: true,
        }),
        EffectKind::Delete(atom) => changes.push(Change {
            when,
            atom,
            becomes: false,
        }),
        _ => {}
    }
}

fn same(left: &Atom, right: &Atom) -> bool {
    left.predicate == right.predicate && left.arguments == right.arguments
}

/// The literals of a conjunction.
fn literals<'m>(condition: &'m Condition, found: &mut Vec<(&'m Atom, bool)>) {
    match &condition.kind {
        ConditionKind::And(parts) => parts.iter().for_each(|part| literals(part, found)),
        ConditionKind::Atom(atom) => found.push((atom, true)),
        ConditionKind::Not(inner) => {
            if let ConditionKind::Atom(atom) = &inner.kind {
                found.push((atom, false));
            }
        }
        _ => {}
    }
}

fn broken_invariants(
    domain: &Domain,
    action: &Action,
    changes: &[Change<'_>],
    found: &mut Diagnostics,
) {
    let over_all = action
        .conditions
        .iter()
        .filter(|(when, _)| *when == When::OverAll);
    let mut wanted = Vec::new();
    over_all.for_each(|(_, condition)| literals(condition, &mut wanted));
    for (atom, value) in wanted {
        let at_start = |becomes: bool| {
            changes.iter().find(move |change| {
                change.when == When::Start && change.becomes == becomes && same(change.atom, atom)
            })
        };
        // Where both are written, the addition wins.
        let broken_by = match (at_start(!value), at_start(value)) {
            (Some(change), None) => change,
            (Some(change), Some(_)) if !value => change,
            _ => continue,
        };
        let name = &domain.predicates[atom.predicate.index()].name.text;
        found.push(
            Diagnostic::new(
                Code::BrokenInvariant,
                atom.span,
                format!(
                    "`{}` breaks its own over-all condition on `{name}`",
                    action.name.text
                ),
            )
            .label("has to hold from start to end")
            .note(
                broken_by.atom.span,
                "but the action itself ends it at start",
            )
            .remedy("make the condition `at start`, or move the effect to `at end`"),
        );
    }
}

fn contradictions(domain: &Domain, changes: &[Change<'_>], found: &mut Diagnostics) {
    for deleted in changes.iter().filter(|change| !change.becomes) {
        let added = changes.iter().find(|change| {
            change.becomes && change.when == deleted.when && same(change.atom, deleted.atom)
        });
        let Some(added) = added else { continue };
        let name = &domain.predicates[deleted.atom.predicate.index()].name.text;
        found.push(
            Diagnostic::new(
                Code::ContradictoryEffects,
                deleted.atom.span,
                format!("`{name}` is deleted and added at the same time"),
            )
            .label("without effect: the addition wins")
            .note(added.atom.span, "added here")
            .remedy("remove one of the two, or set them at different times"),
        );
    }
}
