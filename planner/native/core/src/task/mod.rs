//! The grounded planning task that both search spaces work on.
//!
//! Facts and numeric fluents that no operator or timed initial literal can change are folded
//! away by grounding; what stays is what a state has to store. Disjunctions and quantifiers are
//! compiled away (operators are split), so conditions are conjunctions of literals, numeric
//! comparisons and attachments.

use rustc_hash::FxHashMap;

use crate::pddl::model::{
    ActionId, Arithmetic, Assignment, Comparison, FunctionId, ModuleId, ModuleKind, ObjectId,
    PredicateId,
};
use crate::plan::{Step, without_dust};

macro_rules! ids {
    ($($(#[$doc:meta])* $name:ident),* $(,)?) => {$(
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub struct $name(pub u32);
        impl $name {
            /// Position in the table that this id points into.
            #[must_use]
            pub const fn index(self) -> usize {
                self.0 as usize
            }
        }
    )*};
}

ids! {
    /// Index into [`Task::facts`].
    FactId,
    /// Index into [`Task::fluents`].
    FluentId,
    /// Index into [`Task::operators`].
    OperatorId,
    /// Index into [`Task::calls`].
    CallId,
}

/// A grounded task.
#[derive(Clone, Debug, Default)]
pub struct Task {
    /// Names of the action schemas, by [`ActionId`].
    pub action_names: Vec<String>,
    /// Names of the objects, by [`ObjectId`].
    pub object_names: Vec<String>,
    /// Names of the modules, by [`ModuleId`].
    pub module_names: Vec<String>,
    /// Names of the facts, `at e1 t3`.
    pub facts: Vec<String>,
    /// The model's atom behind each fact; the predicate of a disjunctive goal is `u32::MAX`.
    pub atoms: Vec<(PredicateId, Box<[ObjectId]>)>,
    /// Names of the numeric fluents.
    pub fluents: Vec<String>,
    /// Facts true at time 0, sorted.
    pub initial_facts: Vec<FactId>,
    /// Values of the fluents at time 0; NaN where undefined.
    pub initial_values: Vec<f64>,
    /// Timed initial literals, sorted by time.
    pub timed: Vec<TimedEvent>,
    /// Ground actions.
    pub operators: Vec<Operator>,
    /// Derived facts: rules in the order of their strata.
    pub axioms: Vec<Axiom>,
    /// Attachment calls that stay in the search (their value depends on the state).
    pub calls: Vec<Call>,
    /// The goal.
    pub goal: Conjunction,
    /// What is minimised; `None` is the makespan.
    pub metric: Option<Metric>,
    /// Sets of facts of which at most one is true in every reachable state.
    pub mutex_groups: Vec<Vec<FactId>>,
    /// Whether relaxed reachability already proves that the goal cannot be reached.
    pub unsolvable: bool,
    /// Kinds of the modules, by [`ModuleId`].
    pub module_kinds: Vec<ModuleKind>,
    /// Where the model's symbols went; empty unless an attachment may look at states.
    pub symbols: StateSymbols,
    /// Whether compiling lost plans: a disjunction that has to hold over an interval was split
    /// into actions of which each keeps one disjunct throughout.
    pub narrowed: bool,
    /// Whether operators that may be part of a plan were left out, because there are too many.
    pub partial: bool,
}

/// The model's ground symbols and what became of them, for attachments that look at states.
#[derive(Clone, Debug, Default)]
pub struct StateSymbols {
    /// Atoms that states store; `None` for those that are always true.
    pub facts: FxHashMap<(PredicateId, Box<[ObjectId]>), Option<FactId>>,
    /// Fluents that states store, or the value of those that never change.
    pub fluents: FxHashMap<(FunctionId, Box<[ObjectId]>), FluentPlace>,
}

/// What became of a fluent of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FluentPlace {
    /// States store it.
    Stored(FluentId),
    /// It always has this value.
    Constant(f64),
}

impl Task {
    /// The plan step that runs an operator, with times of whole nanoseconds where they were meant.
    #[must_use]
    pub fn step(&self, operator: OperatorId, start: f64, duration: Option<f64>) -> Step {
        let ground = &self.operators[operator.index()];
        Step {
            start: without_dust(start),
            action: self.action_names[ground.action.index()].clone(),
            arguments: ground
                .arguments
                .iter()
                .map(|object| self.object_names[object.index()].clone())
                .collect(),
            duration: duration.map(without_dust),
        }
    }

    /// `action argument ...`, for messages.
    #[must_use]
    pub fn operator_name(&self, operator: OperatorId) -> String {
        let step = self.step(operator, 0.0, None);
        let mut text = step.action;
        for argument in step.arguments {
            text.push(' ');
            text.push_str(&argument);
        }
        text
    }
}

/// A conjunction of literals, comparisons and condition attachments.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Conjunction {
    /// Facts that must hold, sorted.
    pub positive: Vec<FactId>,
    /// Facts that must not hold, sorted.
    pub negative: Vec<FactId>,
    /// Numeric comparisons.
    pub comparisons: Vec<NumericCondition>,
    /// Condition attachments and the value each must have.
    pub calls: Vec<(CallId, bool)>,
}

impl Conjunction {
    /// Whether it is trivially true.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.positive.is_empty()
            && self.negative.is_empty()
            && self.comparisons.is_empty()
            && self.calls.is_empty()
    }
}

/// `left comparison right`.
#[derive(Clone, Debug, PartialEq)]
pub struct NumericCondition {
    /// The comparison.
    pub comparison: Comparison,
    /// Left-hand side.
    pub left: GroundExpression,
    /// Right-hand side.
    pub right: GroundExpression,
}

/// A ground numeric expression with static parts folded.
#[derive(Clone, Debug, PartialEq)]
pub enum GroundExpression {
    /// A number.
    Constant(f64),
    /// A fluent's current value.
    Fluent(FluentId),
    /// The duration of the operator.
    Duration,
    /// The time at which the plan ends (metric only).
    TotalTime,
    /// A cost attachment that depends on the state.
    Call(CallId),
    /// An operation.
    Binary(Arithmetic, Box<GroundExpression>, Box<GroundExpression>),
}

/// A ground attachment call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Call {
    /// The module.
    pub module: ModuleId,
    /// Names of its arguments.
    pub arguments: Vec<String>,
    /// Fluents that it writes, for effect modules.
    pub writes: Vec<FluentId>,
}

/// A ground action.
#[derive(Clone, Debug)]
pub struct Operator {
    /// The action schema.
    pub action: ActionId,
    /// The objects bound to its parameters.
    pub arguments: Vec<ObjectId>,
    /// `None` for an instantaneous action, whose conditions and effects all stand at start.
    pub duration: Option<Duration>,
    /// Must hold at start.
    pub start_condition: Conjunction,
    /// Must hold between start and end.
    pub invariant: Conjunction,
    /// Must hold at end.
    pub end_condition: Conjunction,
    /// Facts that the conditions at start and at end mention although their truth does not
    /// decide them (the other disjuncts, implications that hold anyway). They count as read where
    /// happenings interfere.
    pub also_reads: [Vec<FactId>; 2],
    /// Happen at start; of what one happening both deletes and adds the add prevails.
    pub start_effects: Vec<GroundEffect>,
    /// Happen at end.
    pub end_effects: Vec<GroundEffect>,
}

/// The duration of a ground action [s].
#[derive(Clone, Debug, PartialEq)]
pub enum Duration {
    /// Known when grounding.
    Fixed(f64),
    /// Between two bounds that are evaluated when the action starts.
    Bounds(GroundExpression, GroundExpression),
}

/// An effect, perhaps conditional.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundEffect {
    /// Evaluated in the state at start (first), throughout (second) and when the effect happens (third);
    /// all empty for an unconditional effect.
    pub condition: Option<Box<[Conjunction; 3]>>,
    /// What changes.
    pub change: Change,
}

/// A change of the state.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// Becomes true.
    Add(FactId),
    /// Becomes false.
    Delete(FactId),
    /// Gets a new value.
    Assign(Assignment, FluentId, GroundExpression),
    /// Calls an effect attachment.
    Call(CallId),
}

/// Something that happens by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedEvent {
    /// When [s].
    pub time: f64,
    /// What.
    pub change: Change,
}

/// A rule for a derived fact.
#[derive(Clone, Debug, PartialEq)]
pub struct Axiom {
    /// Evaluated after all axioms of lower strata.
    pub stratum: u32,
    /// If this holds,
    pub condition: Conjunction,
    /// so does this.
    pub head: FactId,
}

/// What is optimised when it is not the makespan.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    /// Whether more is better.
    pub maximise: bool,
    /// Evaluated in the final state.
    pub expression: GroundExpression,
}
