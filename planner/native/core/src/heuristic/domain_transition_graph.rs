//! Domain transition graphs: how each variable can change its value, and under which conditions.
//!
//! Source: Helmert, "The Fast Downward planning system", JAIR 26, 2006, section 5.1; durative
//! actions as in Eyerich, Mattmüller and Röger, "Using the context-enhanced additive heuristic for
//! temporal and numeric planning", ICAPS 2009: one transition for what an action does at its start
//! and one for what it has done at its end. A comparison is a variable that the actions which
//! change its numbers may make true.

use crate::task::{Change, Task};

use super::causal_graph::CausalGraph;
use super::finite_domain::{Assignment, FiniteDomain, Variable};
use super::relaxed::RelaxedTask;

/// Source of a transition that leads from any value to its target.
pub const ANY: u32 = u32::MAX;
/// For transitions that are not supports of a comparison.
pub const NOT_NUMERIC: u32 = u32::MAX;

/// A condition on a variable, or an effect, told by its position among the predecessors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Local {
    /// Position in [`CausalGraph::predecessors`] of the variable that changes.
    pub predecessor: u32,
    /// The value.
    pub value: u32,
}

/// A change of value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Transition {
    /// The relaxed action.
    pub action: u32,
    /// The value before, or [`ANY`].
    pub source: u32,
    /// The value afterwards.
    pub target: u32,
    /// Which of the relaxed task's numeric supports makes the target true, or [`NOT_NUMERIC`].
    pub support: u32,
    /// What must hold besides.
    pub conditions: Box<[Local]>,
    /// What else becomes of the predecessors.
    pub effects: Box<[Local]>,
}

/// The graph of one variable.
#[derive(Clone, Debug, Default)]
pub struct DomainTransitionGraph {
    transitions: Vec<Transition>,
    /// Where each source's transitions begin; those from any value are last.
    offsets: Vec<u32>,
}

impl DomainTransitionGraph {
    /// The transitions from a value, without those from any value, and the first one's position.
    #[inline]
    #[must_use]
    pub fn from(&self, value: u32) -> (u32, &[Transition]) {
        self.slice(value as usize)
    }

    /// The transitions from any value, and the first one's position.
    #[inline]
    #[must_use]
    pub fn from_any(&self) -> (u32, &[Transition]) {
        self.slice(self.offsets.len().saturating_sub(2))
    }

    fn slice(&self, slot: usize) -> (u32, &[Transition]) {
        if self.offsets.is_empty() {
            return (0, &[]);
        }
        let (from, to) = (self.offsets[slot], self.offsets[slot + 1]);
        (from, &self.transitions[from as usize..to as usize])
    }

    /// A transition by its position.
    #[inline]
    #[must_use]
    pub fn transition(&self, position: u32) -> &Transition {
        &self.transitions[position as usize]
    }

    fn finish(mut transitions: Vec<Transition>, size: u32) -> Self {
        let slot = |transition: &Transition| transition.source.min(size);
        transitions.sort_by_key(|transition| (slot(transition), transition.target));
        let mut offsets = vec![0; size as usize + 2];
        for transition in &transitions {
            offsets[slot(transition) as usize + 1] += 1;
        }
        for index in 1..offsets.len() {
            offsets[index] += offsets[index - 1];
        }
        Self {
            transitions,
            offsets,
        }
    }
}

/// Actions looked at between two questions whether to stop.
const BATCH: u32 = 4_096;

/// The graphs of all variables that matter to the goal; the others' are empty. `None` if `stop` said
/// so meanwhile.
#[must_use]
pub fn domain_transition_graphs(
    stop: &dyn Fn() -> bool,
    task: &Task,
    relaxed: &RelaxedTask,
    domain: &FiniteDomain,
    causal: &CausalGraph,
) -> Option<Vec<DomainTransitionGraph>> {
    let mut lists: Vec<Vec<Transition>> = vec![Vec::new(); domain.variables() as usize];
    for action in 0..relaxed.actions.len() as u32 {
        if action.is_multiple_of(BATCH) && stop() {
            return None;
        }
        let needed: Vec<Assignment> = (relaxed.preconditions_of(action).iter())
            .map(|&proposition| domain.place(proposition))
            .collect();
        let context = context_after(task, relaxed, domain, action, &needed);
        for (target, support) in supports(relaxed, action) {
            let place = domain.place(target);
            if !causal.is_relevant(place.variable) {
                continue;
            }
            let own = needed
                .iter()
                .find(|needed| needed.variable == place.variable);
            let source = own.map_or(ANY, |own| own.value);
            if source == place.value {
                continue;
            }
            let predecessors = causal.predecessors(place.variable);
            lists[place.variable as usize].push(Transition {
                action,
                source,
                target: place.value,
                support,
                conditions: localise(predecessors, &needed),
                effects: localise(predecessors, &context),
            });
        }
    }
    let graphs = lists.into_iter().enumerate().map(|(variable, list)| {
        DomainTransitionGraph::finish(list, domain.size(variable as Variable))
    });
    Some(graphs.collect())
}

/// What an action makes true, with the positions of the numeric supports.
fn supports(relaxed: &RelaxedTask, action: u32) -> impl Iterator<Item = (u32, u32)> + '_ {
    let adds = relaxed.adds_of(action).iter();
    let numeric = relaxed.supports_of(action);
    adds.map(|&add| (add, NOT_NUMERIC)).chain(
        numeric.map(|(position, each)| (relaxed.first_comparison + each.comparison, position)),
    )
}

/// Values of variables after an action with its start and its end; later ones replace earlier ones.
fn context_after(
    task: &Task,
    relaxed: &RelaxedTask,
    domain: &FiniteDomain,
    action: u32,
    needed: &[Assignment],
) -> Vec<Assignment> {
    let mut context = needed.to_vec();
    let mut set = |place: Assignment| match context
        .iter_mut()
        .find(|known| known.variable == place.variable)
    {
        Some(known) => known.value = place.value,
        None => context.push(place),
    };
    let operator = relaxed.actions[action as usize].operator;
    if let Some(operator) = task.operators.get(operator.index()) {
        for effects in [&operator.start_effects, &operator.end_effects] {
            // Deletes first: of what one happening both deletes and adds the add prevails.
            for effect in effects.iter().filter(|effect| effect.condition.is_none()) {
                if let Change::Delete(fact) = effect.change {
                    let place = domain.place(fact.0);
                    let gone = Assignment {
                        value: domain.none_of(place.variable),
                        ..place
                    };
                    if needed.contains(&place) || domain.size(place.variable) == 2 {
                        set(gone);
                    }
                    if let Ok(at) = relaxed.negations.binary_search_by_key(&fact, |n| n.0) {
                        set(domain.place(relaxed.negations[at].1));
                    }
                }
            }
            for effect in effects.iter().filter(|effect| effect.condition.is_none()) {
                if let Change::Add(fact) = effect.change {
                    set(domain.place(fact.0));
                    if let Ok(at) = relaxed.negations.binary_search_by_key(&fact, |n| n.0) {
                        let place = domain.place(relaxed.negations[at].1);
                        set(Assignment {
                            value: domain.none_of(place.variable),
                            ..place
                        });
                    }
                }
            }
        }
    }
    for &add in relaxed.adds_of(action) {
        set(domain.place(add));
    }
    context
}

/// Assignments to predecessors by their positions; the others are dropped.
fn localise(predecessors: &[Variable], assignments: &[Assignment]) -> Box<[Local]> {
    let mut locals: Vec<Local> = assignments
        .iter()
        .filter_map(|assignment| {
            let position = predecessors.binary_search(&assignment.variable).ok()?;
            Some(Local {
                predecessor: position as u32,
                value: assignment.value,
            })
        })
        .collect();
    locals.sort_unstable();
    locals.into_boxed_slice()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heuristic::testing::relay;

    #[test]
    fn a_move_is_one_transition_and_picking_up_needs_the_place() {
        let task = relay();
        let relaxed = RelaxedTask::new(&task);
        let domain = FiniteDomain::new(&task, &relaxed);
        let causal = CausalGraph::new(&relaxed, &domain);
        let graphs = domain_transition_graphs(&|| false, &task, &relaxed, &domain, &causal)
            .expect("not stopped");
        let place = |name: &str| {
            let fact = task.facts.iter().position(|fact| fact == name).expect(name);
            domain.place(fact as u32)
        };
        let (a, b) = (place("at truck a"), place("at truck b"));
        assert_eq!(a.variable, b.variable);
        let (_, moves) = graphs[a.variable as usize].from(a.value);
        assert_eq!(moves.len(), 1);
        assert_eq!((moves[0].target, moves[0].conditions.len()), (b.value, 0));
        let (waiting, carried) = (place("parcel a"), place("in-vehicle truck"));
        assert_eq!(waiting.variable, carried.variable);
        let (_, picks) = graphs[waiting.variable as usize].from(waiting.value);
        let own = picks
            .iter()
            .find(|t| t.target == carried.value)
            .expect("pick up");
        assert_eq!(own.conditions.len(), 1);
        assert_eq!(own.conditions[0].value, a.value);
        assert!(graphs[a.variable as usize].from_any().1.is_empty());
    }
}
