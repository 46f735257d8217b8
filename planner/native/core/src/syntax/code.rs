//! The table of all diagnostic codes: title, what it says, why it matters, an example that gives it.
//!
//! `marsupial explain`, the documentation and the tests read this table. A code is never given
//! to another meaning; a retired number stays unused.

use std::fmt;

use super::diagnostic::Severity;

/// One row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The code.
    pub code: Code,
    /// The severity it usually has.
    pub severity: Severity,
    /// A few words.
    pub title: &'static str,
    /// What the diagnostic says.
    pub what: &'static str,
    /// Why it matters and what to do.
    pub why: &'static str,
    /// A text that gives it; an `;;; problem` line parts a domain from a problem, a `;;; plan` line a problem
    /// from a plan.
    pub example: &'static str,
}

macro_rules! codes {
    ($($name:ident = $number:literal $severity:ident $title:literal
        what $what:literal why $why:literal example $example:literal)*) => {
        /// A stable code, printed as `PDDL0xx`.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Code {
            $(#[doc = $title] $name = $number,)*
        }

        /// All codes, by number.
        pub const TABLE: &[Entry] = &[
            $(Entry {
                code: Code::$name,
                severity: Severity::$severity,
                title: $title,
                what: $what,
                why: $why,
                example: $example,
            },)*
        ];
    };
}

codes! {
    UnclosedParenthesis = 1 Error "parenthesis never closed"
        what "An opening parenthesis or bracket has no closing one before the next section, the next key of an action or the end of the file."
        why "Everything behind it would be read as part of the wrong list. Reading goes on at the next section, so later faults are reported in the same run."
        example "(define (domain d)\n  (:predicates (p)\n  (:action a :parameters () :effect (p)))"
    StrayCloser = 2 Error "closing parenthesis too many"
        what "A closing parenthesis or bracket has no opening one, or it ends the definition although sections follow."
        why "Usually a line before it has one closer too many."
        example "(define (domain d)\n  (:predicates (p)))\n  (:action a :parameters () :effect (p)))"
    InvalidCharacter = 3 Error "character without meaning"
        what "Control characters, quotes, commas, backticks and braces are no part of PDDL."
        why "They often come from copying out of a formatted document or from a binary file."
        example "(define (domain d) (:predicates (p), (q)))"
    NotUtf8 = 4 Error "not UTF-8"
        what "The file holds bytes that are not UTF-8."
        why "Positions and names would be ambiguous. Save the file as UTF-8. (Inside comments this is only a warning.)"
        example "(define (domain d\u{fffd}) (:predicates (p)))"
    NestedTooDeeply = 5 Error "nested too deeply"
        what "Lists are nested more than 400 deep."
        why "No real file needs it; it usually means that closing parentheses are missing all along."
        example "((((((((...))))))))"
    FileTooLarge = 6 Error "file too large"
        what "The file has 4 GiB or more."
        why "Positions are kept in 32 bits."
        example "(a file of 4 GiB)"
    NotADefinition = 7 Error "no definition found"
        what "The file holds no `(define (domain ...) ...)` or no `(define (problem ...) ...)`, whichever was asked for."
        why "Perhaps domain and problem were exchanged, or the file is empty."
        example "(domain d)"
    Malformed = 8 Error "malformed"
        what "Something else was expected at this place."
        why "The label says what was expected there."
        example "(define (domain d) (:predicates p))"
    UnknownSection = 9 Error "unknown section or key"
        what "A section of a definition or a key of an action is not known."
        why "It would be ignored silently otherwise, and the plan would not mean what the file says."
        example "(define (domain d) (:predicate (p)))"
    DuplicateSection = 10 Error "section given twice"
        what "A section or key that may stand once stands twice."
        why "It is unclear which one counts."
        example "(define (domain d) (:predicates (p)) (:action a :parameters () :effect (p) :effect (not (p))))"
    MissingSection = 11 Error "section missing"
        what "A section that every file needs is absent: a problem's goal, a durative action's duration."
        why "Without it there is nothing to plan for."
        example "(define (domain d) (:predicates (p)))\n;;; problem\n(define (problem p) (:domain d) (:init (p)))"
    InvalidNumber = 12 Error "not a usable number"
        what "A number was expected, or the number is too large for a 64-bit float."
        why "Numbers are written as in 3, 0.5 or 1e-3."
        example "(define (domain d) (:functions (f)))\n;;; problem\n(define (problem p) (:domain d) (:init (= (f) three)) (:goal (and)))"
    TooManyMembers = 13 Error "too many members"
        what "A list of variables or of the types of one `either` has more than 256 members."
        why "Such lists come from a fault in a generator; grounding could never enumerate them."
        example "(define (domain d) (:predicates (p ?x1 ?x2 ?x3 ... ?x257)))"
    UnknownType = 20 Error "unknown type"
        what "A type is used that (:types ...) does not declare."
        why "Often a typing error; otherwise declare it."
        example "(define (domain d) (:requirements :typing) (:types robot) (:predicates (at ?r - robt)))"
    UnknownPredicate = 21 Error "unknown predicate"
        what "A predicate is used that (:predicates ...) does not declare."
        why "Often a typing error; otherwise declare it."
        example "(define (domain d) (:predicates (cleared)) (:action a :parameters () :effect (claered)))"
    UnknownFunction = 22 Error "unknown function"
        what "A numeric function is used that (:functions ...) does not declare."
        why "Often a typing error; otherwise declare it, `(total-cost)` too."
        example "(define (domain d) (:requirements :numeric-fluents) (:functions (fuel)) (:action a :parameters () :effect (decrease (feul) 1)))"
    UnknownObject = 23 Error "unknown object"
        what "A name is used that is neither a constant of the domain nor an object of the problem."
        why "Often a typing error, or a variable without its question mark."
        example "(define (domain d) (:constants home) (:predicates (at ?x)) (:action a :parameters () :effect (at hoem)))"
    UnknownVariable = 24 Error "unknown variable"
        what "A variable is used that no parameter list or quantifier around it introduces."
        why "Often a typing error; otherwise add it to `:parameters`."
        example "(define (domain d) (:predicates (at ?x)) (:action a :parameters (?place) :effect (at ?palce)))"
    UnknownModule = 25 Error "unknown module"
        what "A call in square brackets names a module that (:modules ...) does not declare."
        why "Without the declaration neither the kind nor the provider of the module is known."
        example "(define (domain d) (:requirements :durative-actions) (:predicates (p)) (:durative-action a :parameters () :duration (= ?duration [pathCost]) :condition () :effect (at end (p))))"
    DuplicateDeclaration = 27 Error "declared twice"
        what "A name is declared twice."
        why "It is unclear which declaration counts."
        example "(define (domain d) (:predicates (p) (p ?x)))"
    CyclicType = 28 Error "type is its own supertype"
        what "A type is, perhaps through others, its own supertype."
        why "Types have to form a hierarchy below `object`."
        example "(define (domain d) (:requirements :typing) (:types a - b b - a) (:predicates (p)))"
    WrongArity = 29 Error "wrong number of arguments"
        what "A predicate, function or module is used with more or fewer arguments than its declaration has."
        why "The second label shows the declaration."
        example "(define (domain d) (:predicates (at ?r ?x)) (:action a :parameters (?r) :effect (at ?r)))"
    TypeMismatch = 30 Error "type mismatch"
        what "An argument can never be of the declared type."
        why "No object could make the atom true."
        example "(define (domain d) (:requirements :typing) (:types robot place) (:predicates (at ?r - robot)) (:action a :parameters (?p - place) :effect (at ?p)))"
    WiderType = 31 Warning "argument of a wider type"
        what "A variable's type is wider than the declared type of the argument: only some of its objects fit."
        why "The atom is false for the others. Narrow the variable's type, or widen the declaration."
        example "(define (domain d) (:requirements :typing) (:types car - vehicle vehicle) (:predicates (parked ?c - car)) (:action a :parameters (?v - vehicle) :effect (parked ?v)))"
    ImplicitType = 33 Warning "supertype not declared itself"
        what "A supertype does not stand on the left of a dash anywhere; it is taken as a subtype of `object`."
        why "Many files are written so and it is harmless, except where the name is a typing error."
        example "(define (domain d) (:requirements :typing) (:types car - vehicle) (:predicates (p ?v - vehicle)))"
    WrongModuleKind = 34 Error "module of another kind"
        what "A cost module is used as a condition or effect, a condition checker as a number, and so on."
        why "The kind in (:modules ...) says what the module returns."
        example "(define (domain d) (:predicates (p)) (:modules (free conditionchecker free@world)) (:action a :parameters () :effect ([free])))"
    DomainMismatch = 35 Warning "problem names another domain"
        what "The `(:domain ...)` of a problem is not the name of the domain it is read with."
        why "Perhaps the wrong file was given."
        example "(define (domain d) (:predicates (p)))\n;;; problem\n(define (problem p) (:domain e) (:init) (:goal (p)))"
    KindMismatch = 36 Error "predicate and function confused"
        what "A predicate stands where a number is needed, or a function where a condition is needed."
        why "A function's value has to be compared, as in `(>= (fuel ?r) 1)`."
        example "(define (domain d) (:requirements :numeric-fluents) (:predicates (p)) (:functions (fuel)) (:action a :parameters () :precondition (fuel) :effect (p)))"
    MissingTime = 40 Error "no time given"
        what "A condition or effect of a durative action does not say when."
        why "Write `(at start ...)`, `(over all ...)` or `(at end ...)` around it."
        example "(define (domain d) (:requirements :durative-actions) (:predicates (p)) (:durative-action a :parameters () :duration (= ?duration 1) :condition () :effect (p)))"
    UnexpectedTime = 41 Error "time where none belongs"
        what "A time specifier stands in an instantaneous action, a goal or a rule, or `over all` in an effect."
        why "Only durative actions have a start and an end, and effects happen at one of them."
        example "(define (domain d) (:predicates (p)) (:action a :parameters () :effect (at end (p))))"
    InvalidDuration = 43 Error "duration not understood"
        what "A duration constraint is not `=`, `<=` or `>=` between `?duration` and a numeric expression."
        why "PDDL 2.1 knows no strict inequalities of durations; several constraints are joined by `and`."
        example "(define (domain d) (:requirements :durative-actions :duration-inequalities) (:predicates (p)) (:durative-action a :parameters () :duration (< ?duration 1) :condition () :effect (at end (p))))"
    DerivedChanged = 44 Error "derived predicate changed"
        what "An effect or the initial state sets a predicate that `(:derived ...)` rules define."
        why "Its value follows from the rules alone."
        example "(define (domain d) (:requirements :derived-predicates) (:predicates (p) (q)) (:derived (q) (p)) (:action a :parameters () :effect (q)))"
    InvalidTimedLiteral = 47 Error "timed initial literal in the past"
        what "A timed initial literal has a negative time."
        why "Plans begin at time 0."
        example "(define (domain d) (:requirements :timed-initial-literals) (:predicates (p)))\n;;; problem\n(define (problem x) (:domain d) (:init (at -5 (p))) (:goal (p)))"
    ConflictingValue = 49 Error "two initial values"
        what "A numeric fluent is given two different initial values."
        why "It is unclear which one counts."
        example "(define (domain d) (:requirements :numeric-fluents) (:functions (f)))\n;;; problem\n(define (problem p) (:domain d) (:init (= (f) 1) (= (f) 2)) (:goal (and)))"
    ContinuousEffect = 50 Error "continuous effects are not supported"
        what "`#t` describes a change that goes on during an action."
        why "Values change at the start and the end of actions only. Often `(at end (decrease (fuel) ?duration))` will do."
        example "(define (domain d) (:requirements :durative-actions :numeric-fluents) (:functions (f)) (:durative-action a :parameters () :duration (= ?duration 1) :condition () :effect (increase (f) (* #t 1))))"
    PreferenceUnsupported = 51 Error "preferences are not supported"
        what "`(preference ...)` and `(is-violated ...)` are soft goals of PDDL 3."
        why "Every condition is binding here. Make it a goal or leave it out."
        example "(define (domain d) (:predicates (p)))\n;;; problem\n(define (problem x) (:domain d) (:init) (:goal (preference s (p))))"
    ConstraintUnsupported = 52 Error "trajectory constraints are not supported"
        what "`(:constraints ...)` and operators such as `always` and `sometime` speak of the whole trajectory."
        why "Express them by over-all conditions, timed initial literals or extra predicates."
        example "(define (domain d) (:predicates (p)) (:constraints (always (p))))"
    ProcessUnsupported = 53 Error "processes and events are not supported"
        what "`(:process ...)` and `(:event ...)` are PDDL+."
        why "Exogenous changes at known times can be timed initial literals."
        example "(define (domain d) (:predicates (p)) (:event e :parameters () :precondition (p) :effect (not (p))))"
    ObjectFluentUnsupported = 54 Error "object fluents are not supported"
        what "A function returns something other than a number."
        why "Use a predicate with one more argument."
        example "(define (domain d) (:requirements :typing) (:types place) (:predicates (p)) (:functions (position) - place))"
    ModuleKindUnsupported = 55 Error "kind of module not supported"
        what "A module is neither `conditionchecker`, `cost` nor `effect`."
        why "Grounding modules and subplan generators of PDDL/M are not supported: list the objects in the problem instead."
        example "(define (domain d) (:predicates (p)) (:modules (poses ?x grounding poses@world)))"
    MissingRequirement = 60 Warning "requirement flag missing"
        what "The file uses a part of PDDL without its flag in `(:requirements ...)`."
        why "This planner reads it all the same, others may refuse the file."
        example "(define (domain d) (:predicates (p)) (:action a :parameters () :precondition (not (p)) :effect (p)))"
    UnknownRequirement = 61 Warning "unknown requirement flag"
        what "A requirement flag is not known."
        why "It is ignored; perhaps it is a typing error."
        example "(define (domain d) (:requirements :typng) (:predicates (p)))"
    UnsupportedRequirement = 62 Warning "requirement that is not supported"
        what "A requirement flag names a part of PDDL that this planner does not support."
        why "The file can still be used as long as it does not use that part."
        example "(define (domain d) (:requirements :preferences) (:predicates (p)))"
    IgnoredSection = 63 Warning "section without effect"
        what "A section is read but has no effect on planning."
        why "`(:length ...)` and `(:situation ...)` belong to older versions of PDDL."
        example "(define (domain d) (:predicates (p)))\n;;; problem\n(define (problem x) (:domain d) (:init) (:goal (p)) (:length (:parallel 3)))"
    MalformedStep = 70 Error "step not understood"
        what "A line of a plan is no step, or its time is no number of seconds from 0 on."
        why "A step is written `0.000: (go a) [5.000]`: start, action with arguments, duration. Comments begin with a semicolon."
        example "(define (domain d) (:types room) (:predicates (in ?r - room)) (:durative-action go :parameters (?r - room) :duration (= ?duration 5) :condition () :effect (at end (in ?r))))\n;;; problem\n(define (problem x) (:domain d) (:objects a - room) (:init) (:goal (in a)))\n;;; plan\n0.0 (go a) [5.0]"
    UnknownAction = 71 Error "unknown action"
        what "A step of a plan names an action that the domain does not have."
        why "The plan belongs to another domain, or the name is misspelt."
        example "(define (domain d) (:types room) (:predicates (in ?r - room)) (:durative-action go :parameters (?r - room) :duration (= ?duration 5) :condition () :effect (at end (in ?r))))\n;;; problem\n(define (problem x) (:domain d) (:objects a - room) (:init) (:goal (in a)))\n;;; plan\n0.0: (goo a) [5.0]"
    StepDuration = 72 Error "duration missing or not wanted"
        what "A step of a durative action has no duration, or a step of an instantaneous action has one."
        why "Without its duration nobody can tell when a step ends."
        example "(define (domain d) (:types room) (:predicates (in ?r - room)) (:durative-action go :parameters (?r - room) :duration (= ?duration 5) :condition () :effect (at end (in ?r))))\n;;; problem\n(define (problem x) (:domain d) (:objects a - room) (:init) (:goal (in a)))\n;;; plan\n0.0: (go a)"
    UnusedDeclaration = 80 Warning "declared but never used"
        what "A predicate, function or module is declared and used nowhere."
        why "It is left over, or what should use it has a typing error that happens to be another name."
        example "(define (domain d) (:predicates (p) (q)) (:action a :parameters () :precondition (p) :effect (p)))"
    UnusedVariable = 81 Warning "variable never used"
        what "A parameter or quantified variable is mentioned nowhere in its body."
        why "Grounding makes one copy of the action for each of its objects, all alike."
        example "(define (domain d) (:predicates (p)) (:action a :parameters (?x) :precondition (p) :effect (p)))"
    UnusedObject = 82 Warning "object never mentioned"
        what "An object stands neither in the initial state nor in the goal, or a constant nowhere at all."
        why "Most actions need to know something of their arguments; perhaps a fact is missing."
        example "(define (domain d) (:predicates (p ?x)) (:action a :parameters (?x) :precondition (p ?x) :effect (p ?x)))\n;;; problem\n(define (problem x) (:domain d) (:objects one two) (:init (p one)) (:goal (p one)))"
    EffectNeverRead = 83 Warning "effect that nothing reads"
        what "Effects change a predicate or function that no condition, rule, duration, goal or metric asks for."
        why "The effect has no consequence: it is left over, or a condition is missing."
        example "(define (domain d) (:predicates (p) (log)) (:action a :parameters () :precondition (p) :effect (log)))\n;;; problem\n(define (problem x) (:domain d) (:init (p)) (:goal (p)))"
    NeverTrue = 84 Warning "predicate never true"
        what "A condition asks for a predicate that no effect, rule or initial state makes true."
        why "What asks for it can never apply."
        example "(define (domain d) (:predicates (p) (ready)) (:action a :parameters () :precondition (or (p) (ready)) :effect (p)))\n;;; problem\n(define (problem x) (:domain d) (:requirements :disjunctive-preconditions) (:init (p)) (:goal (p)))"
    BrokenInvariant = 86 Warning "action breaks its own over-all condition"
        what "An over-all condition is made false by the action's own effect at start."
        why "The action can never be executed: the condition has to hold between start and end."
        example "(define (domain d) (:requirements :durative-actions :negative-preconditions) (:predicates (p)) (:durative-action a :parameters () :duration (= ?duration 1) :condition (over all (p)) :effect (and (at start (not (p))) (at end (p)))))"
    ZeroDuration = 87 Warning "duration of zero"
        what "A durative action takes no time, always or for some arguments that a problem allows."
        why "Start and end then fall together; often a distance from a place to itself is the cause."
        example "(define (domain d) (:requirements :durative-actions) (:predicates (p)) (:durative-action a :parameters () :duration (= ?duration 0) :condition (at start (p)) :effect (at end (p))))"
    NegativeDuration = 88 Warning "negative duration"
        what "A duration is a negative number."
        why "The action can never apply with such a duration."
        example "(define (domain d) (:requirements :durative-actions) (:predicates (p)) (:durative-action a :parameters () :duration (= ?duration (- 2 3)) :condition (at start (p)) :effect (at end (p))))"
    UnboundedDuration = 89 Warning "duration without an upper limit"
        what "Nothing bounds the duration of an action from above."
        why "The planner may choose any duration; usually a limit was forgotten."
        example "(define (domain d) (:requirements :durative-actions :duration-inequalities) (:predicates (p)) (:durative-action a :parameters () :duration (>= ?duration 1) :condition (at start (p)) :effect (at end (p))))"
    ContradictoryEffects = 90 Warning "deleted and added at once"
        what "An action deletes and adds the same atom at the same time."
        why "By the semantics of PDDL the addition wins and the deletion has no effect."
        example "(define (domain d) (:predicates (p)) (:action a :parameters () :precondition (p) :effect (and (not (p)) (p))))"
    ActionNeverApplies = 91 Warning "action can never apply"
        what "No plan can contain the action in any of the problems given, even if nothing were ever deleted."
        why "An initial fact is missing, a type is wrong, or a condition is misspelt."
        example "(define (domain d) (:predicates (p) (q)) (:action a :parameters () :precondition (q) :effect (q)) (:action b :parameters () :precondition (p) :effect (p)))\n;;; problem\n(define (problem x) (:domain d) (:init (p)) (:goal (p)))"
    UnreachableGoal = 92 Warning "goal out of reach"
        what "A fact that the goal asks for can never become true, even if nothing were ever deleted."
        why "The problem has no plan."
        example "(define (domain d) (:predicates (p) (q)) (:action a :parameters () :precondition (q) :effect (q)))\n;;; problem\n(define (problem x) (:domain d) (:init (p)) (:goal (q)))"
    MissingProvider = 93 Warning "attachment without provider"
        what "A module of the domain has the name of no attachment that is installed."
        why "Planning would stop with an error at the first call."
        example "(define (domain d) (:predicates (p)) (:modules (free conditionchecker free@world)) (:action a :parameters () :precondition (and (p) ([free])) :effect (p)))"
    InfiniteDuration = 94 Warning "duration without a finite value"
        what "A problem's values make a duration infinite or no number, a division by zero usually."
        why "The action can never apply with these arguments."
        example "(define (domain d) (:requirements :durative-actions :numeric-fluents) (:predicates (p)) (:functions (speed)) (:durative-action a :parameters () :duration (= ?duration (/ 10 (speed))) :condition (at start (p)) :effect (at end (p))))\n;;; problem\n(define (problem x) (:domain d) (:init (p) (= (speed) 0)) (:goal (p)))"
    NotExamined = 95 Information "only partly checked"
        what "A problem is too large for the checks that need all its ground actions: those for actions that never apply, impossible durations and goals out of reach."
        why "Nobody should take their silence for praise. They stop after a few seconds and 300,000 ground actions; a smaller problem of the same domain shows most faults of the domain."
        example "(define (domain d) (:requirements :durative-actions) (:predicates (p) (q ?a ?b ?c ?d ?e ?f ?g ?h)) (:action a :parameters (?a ?b ?c ?d ?e ?f ?g ?h) :precondition (p) :effect (q ?a ?b ?c ?d ?e ?f ?g ?h)))\n;;; problem\n(define (problem x) (:domain d) (:objects o1 o2 o3 o4 o5 o6 o7 o8) (:init (p)) (:goal (q o1 o2 o3 o4 o5 o6 o7 o8)))"
}

impl Code {
    /// Its number.
    #[must_use]
    pub const fn number(self) -> u16 {
        self as u16
    }

    /// Its row of the table.
    ///
    /// # Panics
    /// Never: the macro writes enum and table together.
    #[must_use]
    pub fn entry(self) -> &'static Entry {
        TABLE
            .iter()
            .find(|entry| entry.code == self)
            .expect("every code has a row")
    }

    /// The code written as `PDDL021`, `pddl21` or `21`.
    #[must_use]
    pub fn parse(text: &str) -> Option<Self> {
        let digits = text
            .trim()
            .trim_start_matches(|character: char| character.is_ascii_alphabetic());
        let number: u16 = digits.parse().ok()?;
        TABLE
            .iter()
            .map(|entry| entry.code)
            .find(|code| code.number() == number)
    }
}

impl fmt::Display for Code {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "PDDL{:03}", self.number())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_in_order_and_can_be_parsed_back() {
        assert!(TABLE.is_sorted_by_key(|entry| entry.code.number()));
        for entry in TABLE {
            assert_eq!(Code::parse(&entry.code.to_string()), Some(entry.code));
        }
        assert_eq!(Code::UnclosedParenthesis.to_string(), "PDDL001");
        assert_eq!(Code::parse("pddl21"), Some(Code::UnknownPredicate));
        assert_eq!(Code::parse("PDDL999"), None);
        assert_eq!(Code::parse("x"), None);
    }
}
