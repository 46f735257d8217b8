//! Plans as text, one step a line: `5.001: (launch d1 c1 b) [2.000]`.

use std::fmt::Write as _;

use super::Plan;

/// What stands around the steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surroundings<'a> {
    /// The domain's name, for `;;!domain:`.
    pub domain: Option<&'a str>,
    /// The problem's name, for `;;!problem:`.
    pub problem: Option<&'a str>,
    /// States evaluated until the plan was found.
    pub evaluated: Option<u64>,
    /// The value of the metric.
    pub metric: Option<f64>,
}

/// A number of seconds that reads back as the same number: three decimals, more where they are needed.
#[must_use]
pub fn seconds(value: f64) -> String {
    let short = format!("{value:.3}");
    if short.parse() == Ok(value) {
        short
    } else {
        value.to_string()
    }
}

/// Writes a plan. [`super::reader::read`] gives the same plan back.
#[must_use]
pub fn write(plan: &Plan, around: &Surroundings<'_>) -> String {
    let mut text = String::new();
    if let Some(domain) = around.domain {
        let _ = writeln!(text, ";;!domain: {domain}");
    }
    if let Some(problem) = around.problem {
        let _ = writeln!(text, ";;!problem: {problem}");
    }
    if let Some(evaluated) = around.evaluated {
        let _ = writeln!(text, "; States evaluated: {evaluated}");
    }
    for step in &plan.steps {
        let _ = write!(text, "{}: {step}", seconds(step.start));
        if let Some(duration) = step.duration {
            let _ = write!(text, " [{}]", seconds(duration));
        }
        text.push('\n');
    }
    let _ = writeln!(text, "; Makespan: {}", seconds(plan.makespan()));
    if let Some(metric) = around.metric {
        let _ = writeln!(text, "; Metric: {metric}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{Surroundings, seconds, write};
    use crate::plan::{Plan, Step};
    use proptest::prelude::*;

    #[test]
    fn steps_look_as_editors_expect() {
        let plan = Plan {
            steps: vec![
                Step {
                    start: 0.0,
                    action: "open".into(),
                    arguments: vec![],
                    duration: None,
                },
                Step {
                    start: 5.001,
                    action: "launch".into(),
                    arguments: vec!["d1".into(), "c1".into()],
                    duration: Some(50.0 / 3.0),
                },
            ],
        };
        let around = Surroundings {
            domain: Some("d"),
            problem: Some("p"),
            evaluated: Some(7),
            metric: Some(2.5),
        };
        assert_eq!(
            write(&plan, &around),
            "\
;;!domain: d
;;!problem: p
; States evaluated: 7
0.000: (open)
5.001: (launch d1 c1) [16.666666666666668]
; Makespan: 21.66766666666667
; Metric: 2.5
"
        );
    }

    proptest! {
        #[test]
        fn every_number_reads_back(value in 0.0..1e12_f64) {
            let text = seconds(value);
            prop_assert_eq!(text.parse::<f64>().unwrap(), value);
            prop_assert!(!text.contains('e'));
        }
    }
}
