//! The search for a first plan of one action after the other, while there is none.

use std::cell::OnceCell;

use crate::attachment::NoAttachments;
use crate::epoch::calls::Calls;
use crate::epoch::compiled::Compiled;
use crate::epoch::registry::Dominance;
use crate::epoch::search::{Found, Parameters, Search, Statistics, Status};
use crate::epoch::successors::Successors;
use crate::epoch::transitions::Transitions;
use crate::heuristic::choice::Choice;
use crate::heuristic::context_enhanced_additive::Graphs;
use crate::heuristic::relaxed::RelaxedTask;
use crate::sequential::compression::compress;
use crate::sequential::symmetry::Symmetry;
use crate::sequential::timing::one_after_the_other;
use crate::sequential::width::WidthSearch;
use crate::solve::{SolveOptions, Space};
use crate::task::{OperatorId, Task};

use super::{Setting, TOLERANCE};

/// What the search looks things up in; made when it is first needed.
pub(super) struct Tables<'t> {
    compiled: Compiled<'t>,
    relaxed: RelaxedTask,
    successors: Successors,
    calls: Calls<'t>,
    symmetry: Option<Symmetry>,
    graphs: OnceCell<Graphs>,
}

impl<'t> Tables<'t> {
    /// Prepares a task unless `stop` says so meanwhile.
    fn unless(stop: &dyn Fn() -> bool, task: &'t Task) -> Option<Self> {
        let compiled = Compiled::unless(stop, task)?;
        let relaxed = (!stop()).then(|| RelaxedTask::new(task))?;
        let successors = (!stop()).then(|| Successors::new(&compiled))?;
        let symmetry = Symmetry::unless(stop, task)?;
        Some(Self {
            graphs: OnceCell::new(),
            relaxed,
            successors,
            calls: Calls::new(task, &NoAttachments),
            symmetry,
            compiled,
        })
    }

    /// The graphs that a heuristic needs; none also if `stop` said so meanwhile.
    fn graphs(&self, stop: &dyn Fn() -> bool, heuristic: Choice) -> Option<&Graphs> {
        if heuristic.needs_graphs() && self.graphs.get().is_none() {
            let made = heuristic.graphs(stop, self.compiled.task, &self.relaxed)?;
            self.graphs.get_or_init(|| made);
        }
        self.graphs.get().filter(|_| heuristic.needs_graphs())
    }
}

/// What leads a search.
#[derive(Clone, Copy)]
enum Guide {
    Heuristic(Choice),
    Novelty,
}

enum Engine<'s> {
    BestFirst(Search<'s>),
    Width(WidthSearch<'s>),
}

/// A search that begins with its first turn and ends with its first plan.
pub(super) struct Prelude<'s> {
    guide: Guide,
    search: Option<Engine<'s>>,
    ended: bool,
}

impl<'s> Prelude<'s> {
    /// Not begun.
    fn new(guide: Guide) -> Self {
        Self {
            guide,
            search: None,
            ended: false,
        }
    }

    /// The searches that the options ask for: none if only decision epochs are searched, one if a
    /// heuristic is named.
    pub(super) fn all(options: &SolveOptions<'_>) -> Vec<Self> {
        match (options.space, options.heuristic) {
            (Space::DecisionEpochs, _) => Vec::new(),
            (Space::Portfolio, Some(named)) => vec![Self::new(Guide::Heuristic(named))],
            (Space::Portfolio, None) => vec![
                Self::new(Guide::Heuristic(Choice::TemporalFf)),
                Self::new(Guide::Novelty),
                Self::new(Guide::Heuristic(Choice::ContextEnhancedAdditive)),
            ],
        }
    }

    /// Whether there is nothing more to do.
    pub(super) fn ended(&self) -> bool {
        self.ended
    }

    /// What was done so far.
    pub(super) fn statistics(&self) -> Statistics {
        match &self.search {
            None => Statistics::default(),
            Some(Engine::BestFirst(search)) => search.statistics,
            Some(Engine::Width(search)) => search.statistics,
        }
    }

    /// Searches for `expansions` more states; a plan, timed one step after the other, if that
    /// found one.
    pub(super) fn run<'t: 's>(
        &mut self,
        setting: &Setting<'_>,
        task: &'t OnceCell<Option<Task>>,
        tables: &'s OnceCell<Tables<'t>>,
        expansions: u64,
        stop: &mut dyn FnMut() -> bool,
    ) -> Option<Found> {
        if self.ended {
            return None;
        }
        if self.search.is_none() {
            let overlap = setting.completeness.required_concurrency;
            let compressed = task.get_or_init(|| (!overlap).then(|| compress(setting.task))?);
            let Some(compressed) = compressed else {
                self.ended = true;
                return None;
            };
            let stop = || setting.interrupted().is_some();
            if tables.get().is_none() {
                let made = Tables::unless(&stop, compressed)?;
                tables.get_or_init(|| made);
            }
            let tables = tables.get()?;
            if let Guide::Heuristic(heuristic) = self.guide {
                tables.graphs(&stop, heuristic);
            }
            if stop() {
                return None;
            }
            self.search = Some(match self.guide {
                Guide::Heuristic(heuristic) => {
                    Engine::BestFirst(search(setting, tables, heuristic))
                }
                Guide::Novelty => Engine::Width(width_search(setting, tables)),
            });
        }
        let mut found = None;
        let mut keep = |plan| found = Some(plan);
        let status = match self.search.as_mut()? {
            Engine::BestFirst(search) => search.run(expansions, stop, &mut keep),
            Engine::Width(search) => search.run(expansions, stop, &mut keep),
        };
        if status != Status::Interrupted {
            self.ended = true;
        }
        let calls = setting.calls();
        let operators: Vec<OperatorId> = found?.steps.iter().map(|step| step.0).collect();
        one_after_the_other(&setting.transitions(&calls), &operators)
    }
}

fn width_search<'s>(setting: &Setting<'_>, tables: &'s Tables<'_>) -> WidthSearch<'s> {
    let transitions = Transitions {
        compiled: &tables.compiled,
        calls: &tables.calls,
    };
    let memory = setting.options.memory_limit / 4;
    let mut search = WidthSearch::new(transitions, &tables.successors, &tables.relaxed, memory);
    if let Some(symmetry) = &tables.symmetry {
        search.tell_apart_by(Box::new(|state| symmetry.fingerprint(state)));
    }
    search
}

fn search<'s>(setting: &Setting<'_>, tables: &'s Tables<'_>, heuristic: Choice) -> Search<'s> {
    let transitions = Transitions {
        compiled: &tables.compiled,
        calls: &tables.calls,
    };
    let parameters = Parameters {
        time_weight: 0.0,
        seed: setting.options.seed,
        dominance: Dominance::Untimed,
        tolerance: TOLERANCE,
        memory: setting.memory() / 4,
    };
    let heuristics = heuristic.heuristics(
        &tables.compiled,
        &tables.relaxed,
        tables.graphs(&|| false, heuristic),
    );
    let mut search = Search::new(transitions, &tables.successors, heuristics, parameters);
    if let Some(symmetry) = &tables.symmetry {
        search.tell_apart_by(Box::new(|state| symmetry.fingerprint(state)));
    }
    search
}
