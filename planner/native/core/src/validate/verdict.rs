//! What validation found.

use std::fmt;

use crate::attachment::AttachmentError;
use crate::pddl::model::When;

/// The result of validating a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The end of the last step [s]; of all steps, also where the plan failed before.
    pub makespan: f64,
    /// The value of the problem's metric in the final state; `None` for an invalid plan or without metric.
    pub metric: Option<f64>,
    /// The first failure; `None` for a valid plan.
    pub failure: Option<Failure>,
    /// One line a check and a change, in order of time; empty unless asked for.
    pub report: Vec<String>,
}

impl Verdict {
    /// Whether the plan is valid.
    #[must_use]
    pub fn valid(&self) -> bool {
        self.failure.is_none()
    }
}

/// Why, when and where a plan fails.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// What is wrong.
    pub reason: Reason,
    /// When [s]; `None` for a fault of the plan's text.
    pub time: Option<f64>,
    /// Which happening, counted from 1; `None` for a fault of the plan's text.
    pub happening: Option<usize>,
    /// Which step of the plan, counted from 0; `None` for goals and timed initial literals.
    pub step: Option<usize>,
    /// The step as text, `(drive e1 a b)`.
    pub action: Option<String>,
    /// The facts and values around the failure.
    pub facts: Vec<String>,
}

impl Failure {
    /// A failure that belongs to no happening.
    pub(super) const fn outside_time(reason: Reason) -> Self {
        Self {
            reason,
            time: None,
            happening: None,
            step: None,
            action: None,
            facts: Vec::new(),
        }
    }
}

/// What is wrong with a plan.
#[derive(Clone, Debug, PartialEq)]
pub enum Reason {
    /// No action of the domain has this name.
    UnknownAction(String),
    /// No object of the problem has this name.
    UnknownObject {
        /// Which argument, from 0.
        position: usize,
        /// Its name.
        name: String,
    },
    /// The action takes another number of arguments.
    WrongArity {
        /// Parameters of the action.
        expected: usize,
        /// Arguments in the plan.
        found: usize,
    },
    /// An argument is not of the parameter's type.
    WrongType {
        /// Which argument, from 0.
        position: usize,
        /// The argument.
        argument: String,
        /// The parameter, `?r - robot`.
        parameter: String,
    },
    /// A start or duration that is negative or no number.
    BadTime(f64),
    /// A durative action without duration.
    MissingDuration,
    /// An instantaneous action with a duration other than zero.
    UnexpectedDuration(f64),
    /// The duration violates a constraint.
    Duration {
        /// The duration in the plan [s].
        found: f64,
        /// `=`, `<=` or `>=`.
        comparison: &'static str,
        /// The bound in this state [s].
        bound: f64,
        /// The bound as written.
        expression: String,
    },
    /// A condition does not hold.
    Condition {
        /// When it must hold; `None` for instantaneous actions.
        when: Option<When>,
        /// The smallest part of it that is false.
        condition: String,
    },
    /// Two actions touch the same fact or fluent too close to one another.
    Interference {
        /// What the action does, `deletes (at e1 a)`.
        access: String,
        /// The other action.
        other: String,
        /// What the other does, `needs (at e1 a)`.
        other_access: String,
        /// The time between the two [s].
        distance_s: f64,
    },
    /// One action gives a fluent two values at once.
    DoubleAssignment(String),
    /// A fluent without a value is read.
    Undefined(String),
    /// A division by zero or a result that is no number.
    NotANumber(String),
    /// An effect module says that it does not apply.
    EffectRefused(String),
    /// An attachment failed.
    Attachment(AttachmentError),
    /// The rules of a derived predicate depend on its own negation.
    NotStratified(String),
    /// A goal does not hold at the end.
    Goal(String),
}

impl Reason {
    /// A stable word for programs.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::UnknownAction(_) => "unknown-action",
            Self::UnknownObject { .. } => "unknown-object",
            Self::WrongArity { .. } => "wrong-arity",
            Self::WrongType { .. } => "wrong-type",
            Self::BadTime(_) => "bad-time",
            Self::MissingDuration => "missing-duration",
            Self::UnexpectedDuration(_) => "unexpected-duration",
            Self::Duration { .. } => "duration",
            Self::Condition { .. } => "condition",
            Self::Interference { .. } => "interference",
            Self::DoubleAssignment(_) => "double-assignment",
            Self::Undefined(_) => "undefined",
            Self::NotANumber(_) => "not-a-number",
            Self::EffectRefused(_) => "effect-refused",
            Self::Attachment(_) => "attachment",
            Self::NotStratified(_) => "not-stratified",
            Self::Goal(_) => "goal",
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownAction(name) => write!(formatter, "the domain has no action {name}"),
            Self::UnknownObject { name, .. } => {
                write!(formatter, "the problem has no object {name}")
            }
            Self::WrongArity { expected, found } => {
                write!(
                    formatter,
                    "the action takes {expected} arguments, not {found}"
                )
            }
            Self::WrongType {
                argument,
                parameter,
                ..
            } => write!(formatter, "{argument} cannot stand for {parameter}"),
            Self::BadTime(time) => write!(formatter, "{time} is no time after the start"),
            Self::MissingDuration => write!(
                formatter,
                "the action is durative: write its duration behind it, like [5.0]"
            ),
            Self::UnexpectedDuration(duration) => write!(
                formatter,
                "the action is instantaneous and cannot last {duration}"
            ),
            Self::Duration {
                found,
                comparison,
                bound,
                expression,
            } => {
                write!(
                    formatter,
                    "its duration is {found} but must be {comparison} {bound}"
                )?;
                if *expression != bound.to_string() {
                    write!(formatter, ", the value of {expression}")?;
                }
                Ok(())
            }
            Self::Condition { when, condition } => {
                let when = match when {
                    None => "",
                    Some(When::Start) => "at start ",
                    Some(When::OverAll) => "over all ",
                    Some(When::End) => "at end ",
                };
                write!(formatter, "its condition {when}{condition} does not hold")
            }
            Self::Interference {
                access,
                other,
                other_access,
                distance_s,
            } => {
                write!(
                    formatter,
                    "mutex violation: it {access} and {other} {other_access}"
                )?;
                if *distance_s > 0.0 {
                    write!(formatter, ", {distance_s} s apart")
                } else {
                    write!(formatter, " at the same time")
                }
            }
            Self::DoubleAssignment(fluent) => {
                write!(formatter, "it changes {fluent} twice at the same time")
            }
            Self::Undefined(fluent) => write!(formatter, "{fluent} has no value"),
            Self::NotANumber(expression) => {
                write!(formatter, "{expression} divides by zero or is no number")
            }
            Self::EffectRefused(call) => write!(formatter, "its effect {call} does not apply"),
            Self::Attachment(error) => write!(formatter, "{error}"),
            Self::NotStratified(predicate) => write!(
                formatter,
                "the rules of the derived predicate {predicate} depend on its own negation"
            ),
            Self::Goal(goal) => write!(formatter, "the goal {goal} does not hold at the end"),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let (Some(happening), Some(time)) = (self.happening, self.time) {
            write!(formatter, "happening {happening}, time {time}: ")?;
        }
        if let Some(action) = &self.action {
            match self.step {
                Some(step) => write!(formatter, "{action} (step {}): ", step + 1)?,
                None => write!(formatter, "{action}: ")?,
            }
        }
        write!(formatter, "{}", self.reason)?;
        for fact in &self.facts {
            write!(formatter, "\n  {fact}")?;
        }
        Ok(())
    }
}
