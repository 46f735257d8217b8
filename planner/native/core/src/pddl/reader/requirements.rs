//! Requirement flags: which are known, which are missing.

use super::names::name;
use super::sink::Sink;
use crate::pddl::model::Name;
use crate::syntax::code::Code;
use crate::syntax::diagnostic::Diagnostic;
use crate::syntax::span::Span;
use crate::syntax::suggestion::nearest;
use crate::syntax::tree::Node;

macro_rules! features {
    ($($name:ident $flag:literal $part:literal implied by [$($implied:literal)*];)*) => {
        /// A part of PDDL with a flag of its own.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(super) enum Feature { $($name,)* }

        impl Feature {
            const ALL: &[Self] = &[$(Self::$name,)*];

            /// Its flag.
            pub const fn flag(self) -> &'static str {
                match self { $(Self::$name => $flag,)* }
            }

            /// What it is called in a message.
            const fn part(self) -> &'static str {
                match self { $(Self::$name => $part,)* }
            }

            /// Other flags that include it.
            const fn implied_by(self) -> &'static [&'static str] {
                match self { $(Self::$name => &[$($implied,)*],)* }
            }
        }
    };
}

features! {
    Typing ":typing" "types" implied by [":adl" ":ucpop"];
    Equality ":equality" "equality" implied by [":adl" ":ucpop"];
    Negation ":negative-preconditions" "negative conditions" implied by [":adl" ":ucpop"];
    Disjunction ":disjunctive-preconditions" "disjunctions" implied by [":adl" ":ucpop"];
    Existential ":existential-preconditions" "`exists`"
        implied by [":adl" ":ucpop" ":quantified-preconditions"];
    Universal ":universal-preconditions" "`forall` in conditions"
        implied by [":adl" ":ucpop" ":quantified-preconditions"];
    ConditionalEffects ":conditional-effects" "conditional effects" implied by [":adl" ":ucpop"];
    NumericFluents ":numeric-fluents" "numeric fluents"
        implied by [":fluents" ":action-costs" ":goal-utilities"];
    DurativeActions ":durative-actions" "durative actions"
        implied by [":duration-inequalities" ":timed-initial-literals" ":continuous-effects"];
    DurationInequalities ":duration-inequalities" "duration inequalities" implied by [];
    TimedInitialLiterals ":timed-initial-literals" "timed initial literals" implied by [];
    DerivedPredicates ":derived-predicates" "derived predicates" implied by [":domain-axioms"];
}

/// Known flags that are not the flag of a [`Feature`].
const OTHER_FLAGS: [&str; 10] = [
    ":strips",
    ":adl",
    ":ucpop",
    ":fluents",
    ":quantified-preconditions",
    ":action-costs",
    ":domain-axioms",
    ":modules",
    ":existential-preconditions",
    ":numeric-fluents",
];

/// Flags of parts of PDDL that are not supported.
const UNSUPPORTED: [&str; 8] = [
    ":preferences",
    ":constraints",
    ":continuous-effects",
    ":object-fluents",
    ":time",
    ":processes",
    ":events",
    ":goal-utilities",
];

/// All flags that may be offered to an author, supported ones only.
pub(crate) fn supported_flags() -> impl Iterator<Item = &'static str> {
    Feature::ALL
        .iter()
        .map(|feature| feature.flag())
        .chain(OTHER_FLAGS.into_iter().take(8))
}

/// Which features a file uses and where first.
#[derive(Default)]
pub(super) struct Usage {
    first: [Option<Span>; Feature::ALL.len()],
}

impl Usage {
    pub fn note(&mut self, feature: Feature, span: Span) {
        self.first[feature as usize].get_or_insert(span);
    }
}

/// Reads `(:requirements ...)`.
pub(super) fn read(section: Node<'_>, sink: &mut Sink) -> Vec<Name> {
    let mut flags = Vec::new();
    for node in section.children().skip(1) {
        let Some(word) = node.word() else {
            sink.expected(node.span(), "a requirement flag", Some(node));
            continue;
        };
        let flag = name(node);
        if UNSUPPORTED.contains(&flag.text.as_str()) {
            sink.push(
                Diagnostic::new(
                    Code::UnsupportedRequirement,
                    node.span(),
                    format!("`{word}` is not supported"),
                )
                .label("used anywhere, it will be refused there"),
            );
        } else if !supported_flags().any(|known| known == flag.text) {
            sink.report(Code::UnknownRequirement, || {
                Diagnostic::new(
                    Code::UnknownRequirement,
                    node.span(),
                    format!("unknown requirement flag `{word}`"),
                )
                .label("ignored")
                .did_you_mean(nearest(&flag.text, supported_flags()))
            });
        }
        flags.push(flag);
    }
    flags
}

/// Warns of features without a flag. `declared` are all flags in force, `section` is where the
/// file's own `(:requirements ...)` stands, `definition` the `(define` of the file.
pub(super) fn check(
    declared: &[&[Name]],
    section: Option<Node<'_>>,
    definition: Node<'_>,
    sink: &mut Sink,
) {
    for &feature in Feature::ALL {
        let Some(span) = sink.usage.first[feature as usize] else {
            continue;
        };
        // A problem cannot help using what its domain is made of; the domain has the warning.
        let of_domain = matches!(feature, Feature::Typing | Feature::NumericFluents);
        if of_domain && declared.len() > 1 {
            continue;
        }
        let has = |flag: &str| {
            declared
                .iter()
                .any(|flags| flags.iter().any(|name| name.text == flag))
        };
        if has(feature.flag()) || feature.implied_by().iter().any(|flag| has(flag)) {
            continue;
        }
        let flag = feature.flag();
        let mut diagnostic = Diagnostic::new(
            Code::MissingRequirement,
            span,
            format!("{} need the requirement flag `{flag}`", feature.part()),
        )
        .label("first used here")
        .remedy(format!("add `{flag}` to (:requirements ...)"));
        let edit = match section {
            Some(section) => section
                .children()
                .last()
                .map(|last| (last.span().end, format!(" {flag}"))),
            None => definition
                .children()
                .nth(1)
                .map(|head| (head.span().end, format!("\n  (:requirements {flag})"))),
        };
        if let Some((end, text)) = edit {
            diagnostic = diagnostic.fix(format!("Add `{flag}`"), Span::new(end, end), &text);
        }
        sink.push(diagnostic);
    }
}
