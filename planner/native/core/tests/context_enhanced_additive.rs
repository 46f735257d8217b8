//! The context-enhanced additive heuristic: worked examples, and agreement with plain recomputation.

#[path = "support/tasks.rs"]
mod tasks;

use std::fmt::Write as _;

use planner_core::attachment::NoAttachments;
use planner_core::epoch::calls::Calls;
use planner_core::epoch::compiled::Compiled;
use planner_core::epoch::state::State;
use planner_core::epoch::transitions::Transitions;
use planner_core::heuristic::context_enhanced_additive::{ContextEnhancedAdditive, Costs, Graphs};
use planner_core::heuristic::relaxed::RelaxedTask;
use planner_core::heuristic::temporal_ff::TemporalFf;
use planner_core::heuristic::{Estimate, Heuristic};
use planner_core::task::{OperatorId, Task};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use tasks::{ROBOTS, grounded, random_task};

/// The context-enhanced additive cost of a state; `None` if its contexts find no way.
fn context_enhanced(task: &Task, state: &State, costs: Costs) -> Option<u32> {
    let compiled = Compiled::new(task);
    let relaxed = RelaxedTask::new(task);
    let graphs = Graphs::unless(&|| false, task, &relaxed, costs).expect("not stopped");
    ContextEnhancedAdditive::new(&compiled, &relaxed, &graphs).cost(state)
}

fn initial(task: &Task) -> State {
    State::initial(&Compiled::new(task))
}

/// A counter of which even steps need a lamp on and odd ones need it off.
fn alternating_counter(steps: usize) -> Task {
    let mut domain = String::from(
        "(define (domain counter) (:requirements :strips)
 (:predicates (on) (off) (at ?x))
 (:action switch-on :parameters () :precondition (off) :effect (and (on) (not (off))))
 (:action switch-off :parameters () :precondition (on) :effect (and (off) (not (on))))
 (:constants",
    );
    for step in 0..=steps {
        write!(domain, " x{step}").unwrap();
    }
    domain += ")\n";
    for step in 0..steps {
        let lamp = if step % 2 == 0 { "on" } else { "off" };
        let next = step + 1;
        writeln!(
            domain,
            "(:action count{step} :parameters () :precondition (and (at x{step}) ({lamp}))
              :effect (and (at x{next}) (not (at x{step}))))"
        )
        .unwrap();
    }
    let problem = format!(
        "(define (problem p) (:domain counter) (:init (on) (at x0)) (:goal (at x{steps})))"
    );
    grounded(&(domain + ")"), &problem)
}

/// The example by which Helmert and Geffner (ICAPS 2008) tell the heuristic from the additive one:
/// the lamp has to be switched before every step but the first, which only contexts see.
#[test]
fn contexts_see_that_a_condition_has_to_be_restored() {
    for steps in [1, 2, 5, 9] {
        let task = alternating_counter(steps);
        let state = initial(&task);
        let plan_length = 2 * steps as u32 - 1;
        let cost = context_enhanced(&task, &state, Costs::Actions);
        assert_eq!(cost, Some(plan_length));
        let compiled = Compiled::new(&task);
        let relaxed = RelaxedTask::new(&task);
        let mut ff = TemporalFf::new(&compiled, &relaxed);
        // The delete relaxation switches the lamp once.
        let relaxed_plan = steps as u32 + u32::from(steps > 1);
        assert_eq!(ff.evaluate(&state), Estimate::Value(relaxed_plan));
    }
}

fn robots(charge: u32, goal: &str) -> Task {
    let problem = format!(
        "(define (problem p) (:domain robots) (:objects r - robot a b c - place)
 (:init (at r a) (way a b) (way b c) (way c b) (way b a) (= (charge) {charge})) (:goal {goal}))"
    );
    grounded(ROBOTS, &problem)
}

#[test]
fn durations_waits_and_repetitions_have_their_price() {
    // Two drives, one look.
    let task = robots(3, "(seen c)");
    assert_eq!(
        context_enhanced(&task, &initial(&task), Costs::Actions),
        Some(3)
    );
    // Loading twice besides: the charge is a comparison away by two repetitions.
    let empty = robots(1, "(seen c)");
    assert_eq!(
        context_enhanced(&empty, &initial(&empty), Costs::Actions),
        Some(5)
    );
    // Four parts of the mean duration are one: of drives alone, each costs four besides one.
    let task = robots(3, "(at r b)");
    let cost = context_enhanced(&task, &initial(&task), Costs::Durations);
    assert_eq!(cost, Some(5));
    // Of drives and looks, by their share.
    let task = robots(3, "(seen c)");
    let relaxed = RelaxedTask::new(&task);
    let delays: Vec<f64> = (relaxed.actions.iter().map(|action| action.delay))
        .filter(|delay| *delay > 0.0)
        .collect();
    let mean = delays.iter().sum::<f64>() / delays.len() as f64;
    let priced = |seconds: f64| 1 + (4.0 * seconds / mean).round() as u32;
    let cost = context_enhanced(&task, &initial(&task), Costs::Durations);
    assert_eq!(cost, Some(2 * priced(8.0) + priced(4.0)));
    // Half of a running drive is left to wait for.
    let task = robots(3, "(at r b)");
    let compiled = Compiled::new(&task);
    let calls = Calls::new(&task, &NoAttachments);
    let transitions = Transitions {
        compiled: &compiled,
        calls: &calls,
    };
    let mut state = transitions.initial();
    let drive_off = (0..task.operators.len() as u32)
        .map(OperatorId)
        .find(|&id| task.operator_name(id) == "drive r a b")
        .unwrap();
    assert!(transitions.start(&mut state, drive_off, false));
    assert_eq!(context_enhanced(&task, &state, Costs::Actions), Some(0));
    assert_eq!(context_enhanced(&task, &state, Costs::Durations), Some(4));
    state.time += 4.0;
    assert_eq!(context_enhanced(&task, &state, Costs::Durations), Some(2));
}

/// Additive costs by going through all actions until nothing changes.
fn additive_cost(task: &Task, state: &State) -> Option<u32> {
    let relaxed = RelaxedTask::new(task);
    let mut cost = vec![u32::MAX; relaxed.propositions as usize];
    for fact in 0..relaxed.facts {
        if state.holds(planner_core::task::FactId(fact)) {
            cost[fact as usize] = 0;
        }
    }
    for &(fact, proposition) in &relaxed.negations {
        if !state.holds(fact) {
            cost[proposition as usize] = 0;
        }
    }
    for &(fact, proposition) in &relaxed.lasting {
        if state.holds(fact) {
            cost[proposition as usize] = 0;
        }
    }
    let sum = |cost: &[u32], propositions: &[u32]| {
        propositions
            .iter()
            .map(|&p| cost[p as usize])
            .try_fold(0_u32, u32::checked_add)
            .filter(|sum| *sum < u32::MAX)
    };
    loop {
        let mut changed = false;
        for action in 0..relaxed.actions.len() as u32 {
            let Some(needs) = sum(&cost, relaxed.preconditions_of(action)) else {
                continue;
            };
            for &add in relaxed.adds_of(action) {
                if needs + 1 < cost[add as usize] {
                    cost[add as usize] = needs + 1;
                    changed = true;
                }
            }
        }
        if !changed {
            return sum(&cost, &relaxed.goal);
        }
    }
}

#[test]
fn without_groups_there_is_no_context_and_the_additive_cost_is_left() {
    let mut reachable = 0;
    for seed in 0..600 {
        let mut task = random_task(seed, 8);
        task.mutex_groups.clear();
        let state = initial(&task);
        let naive = additive_cost(&task, &state);
        let found = context_enhanced(&task, &state, Costs::Actions);
        assert_eq!(found, naive, "seed {seed}");
        reachable += u32::from(naive.is_some_and(|cost| cost > 1));
    }
    assert!(reachable > 40, "{reachable}");
}

/// One robot on a directed graph: the variable's cost is the length of the shortest path.
#[test]
fn one_variable_costs_what_the_shortest_path_costs() {
    for seed in 0..60 {
        let random = &mut ChaCha8Rng::seed_from_u64(seed);
        let places = random.random_range(2..9);
        let mut distance = vec![u32::MAX; places * places];
        let mut init = String::from("(at r p0)");
        for (pair, length) in distance.iter_mut().enumerate() {
            let (from, to) = (pair / places, pair % places);
            if from == to {
                *length = 0;
            } else if random.random_range(0..3) == 0 {
                *length = 1;
                write!(init, " (way p{from} p{to})").unwrap();
            }
        }
        for middle in 0..places {
            for pair in 0..places * places {
                let (from, to) = (pair / places, pair % places);
                let before = distance[from * places + middle];
                let through = before.saturating_add(distance[middle * places + to]);
                distance[pair] = distance[pair].min(through);
            }
        }
        let names: String = (0..places).map(|place| format!(" p{place}")).collect();
        let goal = places - 1;
        let problem = format!(
            "(define (problem p) (:domain graph) (:objects r - robot{names} - place)
             (:init {init}) (:goal (at r p{goal})))"
        );
        let domain = "(define (domain graph) (:requirements :typing)
             (:types robot place) (:predicates (at ?r - robot ?p - place) (way ?a ?b - place))
             (:action go :parameters (?r - robot ?a ?b - place)
              :precondition (and (at ?r ?a) (way ?a ?b))
              :effect (and (not (at ?r ?a)) (at ?r ?b))))";
        let task = grounded(domain, &problem);
        let expected = distance[goal];
        if expected == u32::MAX {
            assert!(task.unsolvable, "seed {seed}");
            continue;
        }
        let cost = context_enhanced(&task, &initial(&task), Costs::Actions);
        assert_eq!(cost, Some(expected), "seed {seed}");
    }
}
