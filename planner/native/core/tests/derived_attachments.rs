//! Rules for derived predicates that ask an attachment about the state.

mod support;

use planner_core::attachment::{Arguments, Attachments, Purity, StateView};
use planner_core::pddl::model::{FunctionId, ModuleId};
use support::{options, read, solved};

const TANK: &str = "(define (domain tank)
 (:requirements :durative-actions :numeric-fluents :derived-predicates)
 (:predicates (ready) (started))
 (:functions (level))
 (:modules (full conditionchecker full@tank) (rest cost rest@tank))
 (:derived (ready) ([full]))
 (:durative-action pump :parameters () :duration (= ?duration 2)
  :effect (at end (increase (level) 1)))
 (:durative-action launch :parameters () :duration (= ?duration 1)
  :condition (at start (ready)) :effect (at end (started))))";

/// `full` once the level is 3; `rest` is what is missing.
struct Gauge;

impl Attachments for Gauge {
    fn purity(&self, _: ModuleId) -> Purity {
        Purity::State
    }

    fn evaluate(
        &self,
        module: ModuleId,
        calls: &[Arguments],
        state: Option<&dyn StateView>,
    ) -> Result<Vec<f64>, (usize, String)> {
        let level = state
            .and_then(|state| state.value(FunctionId(0), &[]))
            .ok_or((0, "no level".to_owned()))?;
        let value = match module.index() {
            0 => f64::from(u8::from(level >= 3.0)),
            _ => (3.0 - level).max(0.0),
        };
        Ok(vec![value; calls.len()])
    }

    fn apply(
        &self,
        _: ModuleId,
        _: &Arguments,
        _: &dyn StateView,
    ) -> Result<Option<Vec<f64>>, String> {
        Err("no effects here".into())
    }
}

fn makespan(domain: &str, level: u32) -> Option<f64> {
    let problem = format!(
        "(define (problem p) (:domain tank) (:init (= (level) {level})) (:goal (started)))"
    );
    let (domain, problem) = read(domain, &problem);
    let report = solved(&domain, &problem, &Gauge, &options());
    report.plans.last().map(|found| found.cost)
}

#[test]
fn a_condition_checker_decides_a_rule() {
    assert_eq!(makespan(TANK, 3), Some(1.0));
    // Launching waits until the third unit has been pumped.
    let found = makespan(TANK, 1);
    assert!(
        found.is_some_and(|found| (3.0..7.1).contains(&found)),
        "{found:?}"
    );
}

#[test]
fn a_cost_decides_a_rule() {
    let domain = TANK.replace("([full])", "(<= [rest] 0)");
    assert_eq!(makespan(&domain, 3), Some(1.0));
    assert!(makespan(&domain, 1).is_some_and(|found| found >= 3.0));
}

#[test]
fn its_negation_can_be_a_rule() {
    let domain = TANK.replace("([full])", "(not ([full]))");
    assert_eq!(makespan(&domain, 0), Some(1.0));
    assert_eq!(makespan(&domain, 3), None);
}
