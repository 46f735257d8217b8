//! What the relaxed exploration is asked, and how it is to look.

use crate::schedule::model::Model;
use crate::schedule::propositions::Propositions;
use crate::schedule::state::State;

/// How labels are computed.
#[derive(Clone, Copy, Debug)]
pub struct Labelling {
    /// Weight of additive cost against time.
    pub effort: f32,
    /// Relative noise on durations; breaks symmetry between like objects.
    pub noise: f32,
    /// Decides the noise.
    pub salt: u32,
    /// Leave out operators that destroy goals which hold.
    pub protect: bool,
    /// Count on past windows of facts that do not hold.
    pub windows: bool,
    /// Weight of the distance to the target in the order of labels: with 1 they are the least ones,
    /// with more of it fewer are looked at.
    pub greed: f32,
    /// Of what an operator needs, achieve the farthest first, and rely on what its operators add
    /// besides: what is near, like a vehicle's place, is often lost on the way to the rest.
    pub far_first: bool,
    /// A proposition that must not be achieved, or [`NONE`](crate::schedule::model::NONE).
    pub without: u32,
}

/// What the last rule must look like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Restriction {
    /// It may be any.
    #[default]
    None,
    /// It must add this too.
    With(u32),
    /// It must be this operator's.
    Operator(u32),
}

/// What to explore: from the state behind a list to one proposition.
#[derive(Clone, Copy)]
pub struct Question<'a> {
    pub model: &'a Model,
    pub propositions: &'a Propositions,
    pub state: &'a State,
    pub target: u32,
    pub labelling: Labelling,
    pub restriction: Restriction,
    /// What is not reached before this time is of no use [s].
    pub latest: f32,
    /// Whether to give up: then the target counts as out of reach.
    pub stop: &'a dyn Fn() -> bool,
}

impl Restriction {
    /// Whether a rule looks like that.
    pub fn admits(self, propositions: &Propositions, rule: u32) -> bool {
        let rule = &propositions.rules[rule as usize];
        match self {
            Self::None => true,
            Self::With(with) => {
                let mut adds = propositions.adds(rule).iter();
                adds.any(|add| add.proposition == with)
            }
            Self::Operator(operator) => rule.operator == operator,
        }
    }
}
