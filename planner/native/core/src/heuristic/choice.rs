//! Heuristics by name.

use crate::epoch::compiled::Compiled;
use crate::task::Task;

use super::Heuristic;
use super::blind::Blind;
use super::context_enhanced_additive::{ContextEnhancedAdditive, Costs, Graphs};
use super::critical_path::CriticalPath;
use super::relaxed::RelaxedTask;
use super::temporal_ff::TemporalFf;

/// What guides a decision-epoch search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// [`TemporalFf`].
    TemporalFf,
    /// [`ContextEnhancedAdditive`].
    ContextEnhancedAdditive,
    /// [`CriticalPath`].
    CriticalPath,
    /// [`Blind`].
    Blind,
    /// Temporal FF and context-enhanced additive, their open lists in turns.
    Alternation,
}

impl Choice {
    /// All, with the names that users give.
    pub const NAMES: [(&'static str, Self); 5] = [
        ("temporal-ff", Self::TemporalFf),
        ("context-enhanced-additive", Self::ContextEnhancedAdditive),
        ("critical-path", Self::CriticalPath),
        ("blind", Self::Blind),
        ("alternation", Self::Alternation),
    ];

    /// The choice of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let entry = Self::NAMES.iter().find(|entry| entry.0 == name)?;
        Some(entry.1)
    }

    /// Whether it works on domain transition graphs.
    #[must_use]
    pub fn needs_graphs(self) -> bool {
        matches!(self, Self::ContextEnhancedAdditive | Self::Alternation)
    }

    /// The graphs that it needs; none also if `stop` said so meanwhile.
    #[must_use]
    pub fn graphs(
        self,
        stop: &dyn Fn() -> bool,
        task: &Task,
        relaxed: &RelaxedTask,
    ) -> Option<Graphs> {
        self.needs_graphs()
            .then(|| Graphs::unless(stop, task, relaxed, Costs::Actions))?
    }

    /// The heuristics themselves; `graphs` is what [`Self::graphs`] gave.
    #[must_use]
    pub fn heuristics<'a>(
        self,
        compiled: &'a Compiled<'a>,
        relaxed: &'a RelaxedTask,
        graphs: Option<&'a Graphs>,
    ) -> Vec<Box<dyn Heuristic + 'a>> {
        let mut heuristics: Vec<Box<dyn Heuristic + 'a>> = Vec::new();
        match self {
            Self::CriticalPath => heuristics.push(Box::new(CriticalPath::new(compiled, relaxed))),
            Self::Blind => heuristics.push(Box::new(Blind::new(compiled))),
            Self::TemporalFf | Self::Alternation => {
                heuristics.push(Box::new(TemporalFf::new(compiled, relaxed)));
            }
            Self::ContextEnhancedAdditive => {}
        }
        if let (true, Some(graphs)) = (self.needs_graphs(), graphs) {
            let cea = ContextEnhancedAdditive::new(compiled, relaxed, graphs);
            heuristics.push(Box::new(cea));
        }
        heuristics
    }
}
