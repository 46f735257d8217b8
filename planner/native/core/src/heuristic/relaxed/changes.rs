//! Changes of fluents, each once, with the comparisons that it may make true.

use crate::pddl::model::Assignment;
use crate::task::{FluentId, GroundExpression};

use super::NumericSupport;
use super::builder::Builder;
use super::linear::mentions;

impl Builder<'_> {
    /// The change of a fluent with all comparisons that it may make true; `None` if there are none.
    pub(super) fn supports(
        &mut self,
        fluent: FluentId,
        change: Option<(Assignment, &GroundExpression)>,
    ) -> Option<u32> {
        let written = format!("{fluent:?} {change:?}");
        if let Some(&known) = self.change_of.get(&written) {
            let (from, to) = self.changes[known as usize];
            return (from < to).then_some(known);
        }
        let from = self.supports.len() as u32;
        for (index, comparison) in self.comparisons.iter().enumerate() {
            let coefficient = match &comparison.linear {
                Some(form) => form
                    .iter()
                    .filter(|(f, _)| *f == fluent)
                    .map(|(_, c)| c)
                    .sum(),
                None if mentions(&comparison.condition, fluent) => f64::NAN,
                None => 0.0,
            };
            if coefficient != 0.0 {
                self.supports.push(NumericSupport {
                    comparison: index as u32,
                    assignment: change.map(|(assignment, _)| assignment),
                    value: change.map(|(_, value)| value.clone()),
                    coefficient,
                });
            }
        }
        let (index, to) = (self.changes.len() as u32, self.supports.len() as u32);
        self.changes.push((from, to));
        self.change_of.insert(written, index);
        (from < to).then_some(index)
    }
}
