//! The causal graph: which variables are needed to change which.
//!
//! An arc leads from a variable to another if an action has a condition on the first and changes
//! the second. Source: Helmert, "The Fast Downward planning system", JAIR 26, 2006, section 5.2;
//! arcs between two variables that one action changes are left out, because nothing here reads
//! them.

use super::finite_domain::{FiniteDomain, Variable};
use super::relaxed::RelaxedTask;

/// Predecessors of every variable.
#[derive(Clone, Debug)]
pub struct CausalGraph {
    predecessors: Vec<Vec<Variable>>,
    relevant: Vec<bool>,
}

impl CausalGraph {
    /// The graph of a task.
    #[must_use]
    pub fn new(relaxed: &RelaxedTask, domain: &FiniteDomain) -> Self {
        let mut predecessors = vec![Vec::new(); domain.variables() as usize];
        for action in 0..relaxed.actions.len() as u32 {
            for target in relaxed.targets_of(action) {
                let changed = domain.place(target).variable;
                let needed = relaxed.preconditions_of(action).iter();
                predecessors[changed as usize].extend(
                    needed
                        .map(|&proposition| domain.place(proposition).variable)
                        .filter(|&variable| variable != changed),
                );
            }
            // Many actions need the same variables.
            for target in relaxed.targets_of(action) {
                let list = &mut predecessors[domain.place(target).variable as usize];
                if list.len() > 4_096 {
                    list.sort_unstable();
                    list.dedup();
                }
            }
        }
        for list in &mut predecessors {
            list.sort_unstable();
            list.dedup();
        }
        let goals = relaxed.goal.iter().map(|&goal| domain.place(goal).variable);
        let relevant = ancestors(&predecessors, goals);
        Self {
            predecessors,
            relevant,
        }
    }

    /// The variables that conditions on changes of a variable mention, sorted.
    #[inline]
    #[must_use]
    pub fn predecessors(&self, variable: Variable) -> &[Variable] {
        &self.predecessors[variable as usize]
    }

    /// Whether a variable is part of the goal or helps to change one that is.
    #[must_use]
    pub fn is_relevant(&self, variable: Variable) -> bool {
        self.relevant[variable as usize]
    }
}

fn ancestors(predecessors: &[Vec<Variable>], goals: impl Iterator<Item = Variable>) -> Vec<bool> {
    let mut found = vec![false; predecessors.len()];
    let mut stack: Vec<Variable> = goals.collect();
    while let Some(variable) = stack.pop() {
        if !std::mem::replace(&mut found[variable as usize], true) {
            stack.extend(&predecessors[variable as usize]);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heuristic::testing::relay;

    #[test]
    fn arcs_lead_from_conditions_to_changes() {
        let task = relay();
        let relaxed = RelaxedTask::new(&task);
        let domain = FiniteDomain::new(&task, &relaxed);
        let graph = CausalGraph::new(&relaxed, &domain);
        let [truck, parcel] = ["at truck a", "in-vehicle truck"].map(|name| {
            let fact = task.facts.iter().position(|fact| fact == name).expect(name);
            domain.place(fact as u32).variable
        });
        assert_eq!(graph.predecessors(parcel), [truck]);
        assert!(graph.predecessors(truck).is_empty());
        assert!(graph.is_relevant(truck) && graph.is_relevant(parcel));
    }
}
