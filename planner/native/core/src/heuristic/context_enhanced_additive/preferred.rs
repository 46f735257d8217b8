//! Operators that the cheapest ways to the goals begin with.

use crate::epoch::state::State;
use crate::heuristic::domain_transition_graph::Local;
use crate::heuristic::finite_domain::Assignment;

use super::ContextEnhancedAdditive;
use super::local_problems::{NONE, SCHEDULED};

impl ContextEnhancedAdditive<'_> {
    /// Walks back from the goals and notes operators that could start now.
    pub(super) fn mark(&mut self, state: &State) {
        self.marked.clear();
        self.marked.resize(self.local.nodes(), false);
        let mut stack = std::mem::take(&mut self.stack);
        stack.extend(
            self.open_goals()
                .filter_map(|(goal, present)| self.node_of(goal, present)),
        );
        while let Some(node) = stack.pop() {
            if std::mem::replace(&mut self.marked[node as usize], true) {
                continue;
            }
            match self.local.node(node).reached_by {
                SCHEDULED => self.waits = true,
                NONE => {}
                step => self.mark_step(step, state, &mut stack),
            }
        }
        self.stack = stack;
        self.preferred.sort_unstable();
        self.preferred.dedup();
    }

    /// The settled node of a value in the local problem from another one.
    fn node_of(&self, wanted: Assignment, present: u32) -> Option<u32> {
        let start = Assignment {
            value: present,
            ..wanted
        };
        let problem = self.local.find(self.graphs, start)?;
        let node = self.local.problem(problem).nodes + wanted.value;
        (self.local.node(node).context != NONE).then_some(node)
    }

    /// Marks what a step needs, and its operator if that could start now.
    fn mark_step(&mut self, step: u32, state: &State, stack: &mut Vec<u32>) {
        let step = self.local.step(step);
        let source = self.local.node(step.source);
        let variable = self.local.problem(source.problem).variable;
        let graph = &self.graphs.transitions[variable as usize];
        let transition = graph.transition(step.transition);
        stack.push(step.source);
        let predecessors = self.graphs.causal.predecessors(variable);
        for &Local { predecessor, value } in &transition.conditions {
            let wanted = Assignment {
                variable: predecessors[predecessor as usize],
                value,
            };
            let present = self.local.context(source, predecessor);
            if present != value {
                stack.extend(self.node_of(wanted, present));
            }
        }
        let operator = self.relaxed.actions[transition.action as usize].operator;
        let compiled = self.compiled.operators.get(operator.index());
        if compiled.is_some_and(|o| o.start_condition.literals_hold(&state.facts)) {
            self.preferred.push(operator);
        }
    }
}
