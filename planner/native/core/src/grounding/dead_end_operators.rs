//! Leaves out operators after which the goal cannot be reached.
//!
//! A fact that holds at first and that nothing adds can be used up once: whatever needs and deletes it
//! takes the only *token*. What is added only by takers of the token holds the token next, and so on: a
//! graph without cycles of which a plan follows one path. Where all achievers of a goal are steps of such a graph,
//! a step that no path joins with any of them is part of no plan: a sheet that has been printed on with one image
//! will not get another. Nor is any operator that deletes a goal which nothing adds.
//!
//! What is removed occurs in no plan, so all plans stay.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::task::{Change, FactId, GroundEffect, Operator, Task};

use super::token_graph::{LARGEST_GRAPH, TokenGraph};
use super::{GroundingError, GroundingLimits};

/// Operators noted between two looks at the limits.
const BATCH: usize = 16_384;

/// Prunes the task in place. Not for tasks with attachments that change the state.
///
/// # Errors
/// A limit that is reached meanwhile.
pub(super) fn prune(task: &mut Task, limits: &GroundingLimits<'_>) -> Result<(), GroundingError> {
    let uses = Uses::new(task, limits)?;
    let mut kept = vec![true; task.operators.len()];
    for &goal in &task.goal.positive {
        if uses.never_added(goal) && uses.initial[goal.index()] {
            for &operator in &uses.deleters[goal.index()] {
                kept[operator as usize] = false;
            }
        }
    }
    let goals = uses.open_goals(task);
    // Achievers of one goal tend to share their token: each graph is looked at once.
    let mut looked_at = FxHashSet::default();
    for &goal in &goals {
        for fact in uses.tokens_behind(goal) {
            if looked_at.insert(fact) {
                limits.check()?;
                let graph = TokenGraph::new(&uses, fact);
                graph.rule_out(&uses, &goals, &mut kept);
            }
        }
    }
    uses.rule_out_unsupported(task, &mut kept);
    let mut flags = kept.iter();
    task.operators.retain(|_| *flags.next().unwrap_or(&true));
    Ok(())
}

/// Who adds, deletes and uses up facts.
pub(super) struct Uses {
    pub(super) initial: Vec<bool>,
    /// Whether timed literals or axioms make it true.
    pub(super) given: Vec<bool>,
    pub(super) adders: Vec<Vec<u32>>,
    /// Unconditionally.
    deleters: Vec<Vec<u32>>,
    /// Those that need it at start and delete it then.
    pub(super) takers: Vec<Vec<u32>>,
    /// What each operator takes, and what it adds.
    pub(super) taken: Vec<Vec<FactId>>,
    pub(super) added: Vec<Vec<FactId>>,
}

impl Uses {
    fn new(task: &Task, limits: &GroundingLimits<'_>) -> Result<Self, GroundingError> {
        let mut uses = Self {
            initial: vec![false; task.facts.len()],
            given: vec![false; task.facts.len()],
            adders: vec![Vec::new(); task.facts.len()],
            deleters: vec![Vec::new(); task.facts.len()],
            takers: vec![Vec::new(); task.facts.len()],
            taken: Vec::with_capacity(task.operators.len()),
            added: Vec::with_capacity(task.operators.len()),
        };
        for fact in &task.initial_facts {
            uses.initial[fact.index()] = true;
        }
        for axiom in &task.axioms {
            uses.given[axiom.head.index()] = true;
        }
        for event in &task.timed {
            if let Change::Add(fact) = event.change {
                uses.given[fact.index()] = true;
            }
        }
        for (index, operator) in task.operators.iter().enumerate() {
            if index.is_multiple_of(BATCH) {
                limits.check()?;
            }
            uses.note(index as u32, operator);
        }
        Ok(uses)
    }

    fn note(&mut self, index: u32, operator: &Operator) {
        let (mut added, mut taken) = (Vec::new(), Vec::new());
        for effect in effects(operator) {
            match effect.change {
                Change::Add(fact) => added.push(fact),
                Change::Delete(fact) if effect.condition.is_none() => {
                    self.deleters[fact.index()].push(index);
                }
                _ => {}
            }
        }
        for effect in &operator.start_effects {
            if let Change::Delete(fact) = effect.change
                && effect.condition.is_none()
                && operator.start_condition.positive.contains(&fact)
            {
                taken.push(fact);
            }
        }
        for list in [&mut added, &mut taken] {
            list.sort_unstable();
            list.dedup();
        }
        for fact in &added {
            self.adders[fact.index()].push(index);
        }
        for fact in &taken {
            self.takers[fact.index()].push(index);
        }
        self.added.push(added);
        self.taken.push(taken);
    }

    fn never_added(&self, fact: FactId) -> bool {
        !self.given[fact.index()] && self.adders[fact.index()].is_empty()
    }

    /// Goals that do not hold at first and that operators alone achieve.
    fn open_goals(&self, task: &Task) -> Vec<FactId> {
        let open = |goal: &&FactId| !self.initial[goal.index()] && !self.given[goal.index()];
        task.goal.positive.iter().filter(open).copied().collect()
    }

    /// Facts that can be used up once and that the achievers of a fact descend from.
    fn tokens_behind(&self, goal: FactId) -> Vec<FactId> {
        let mut tokens = Vec::new();
        let mut seen = FxHashSet::default();
        // One achiever is enough: the others have to belong to the same token.
        let Some(&achiever) = self.adders[goal.index()].first() else {
            return tokens;
        };
        let mut stack = self.taken[achiever as usize].clone();
        while let Some(fact) = stack.pop() {
            if seen.len() >= LARGEST_GRAPH || !seen.insert(fact) {
                continue;
            }
            if self.initial[fact.index()] {
                if self.never_added(fact) {
                    tokens.push(fact);
                }
                continue;
            }
            if let Some(&adder) = self.adders[fact.index()].first() {
                stack.extend_from_slice(&self.taken[adder as usize]);
            }
        }
        tokens.sort_unstable();
        tokens
    }

    /// Operators that need what nothing adds any more, and what only they would add, and so on.
    fn rule_out_unsupported(&self, task: &Task, kept: &mut [bool]) {
        let mut needed_by: FxHashMap<FactId, Vec<u32>> = FxHashMap::default();
        for (index, operator) in task.operators.iter().enumerate() {
            for fact in &operator.start_condition.positive {
                needed_by.entry(*fact).or_default().push(index as u32);
            }
        }
        let mut stack: Vec<u32> = (0..kept.len() as u32)
            .filter(|operator| !kept[*operator as usize])
            .collect();
        while let Some(operator) = stack.pop() {
            for fact in &self.added[operator as usize] {
                let index = fact.index();
                let lives = self.adders[index].iter().any(|adder| kept[*adder as usize]);
                if lives || self.initial[index] || self.given[index] {
                    continue;
                }
                for &user in needed_by.get(fact).map_or(&[][..], Vec::as_slice) {
                    if std::mem::replace(&mut kept[user as usize], false) {
                        stack.push(user);
                    }
                }
            }
        }
    }
}

fn effects(operator: &Operator) -> impl Iterator<Item = &GroundEffect> {
    operator.start_effects.iter().chain(&operator.end_effects)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::{GroundingLimits, prune};
    use crate::pddl::model::ActionId;
    use crate::task::{Change, Conjunction, FactId, GroundEffect, Operator, Task};

    /// What an instantaneous operator needs, deletes and adds.
    type Row<'a> = (&'a [u32], &'a [u32], &'a [u32]);

    fn task(facts: u32, initial: &[u32], goal: &[u32], rows: &[Row]) -> Task {
        let ids = |list: &[u32]| -> Vec<FactId> { list.iter().map(|fact| FactId(*fact)).collect() };
        let conjunction = |positive: &[u32]| Conjunction {
            positive: ids(positive),
            ..Conjunction::default()
        };
        let effect = |change| GroundEffect {
            condition: None,
            change,
        };
        let operator = |(index, row): (usize, &Row)| {
            let deletes = row
                .1
                .iter()
                .map(|fact| effect(Change::Delete(FactId(*fact))));
            let adds = row.2.iter().map(|fact| effect(Change::Add(FactId(*fact))));
            Operator {
                action: ActionId(index as u32),
                arguments: Vec::new(),
                duration: None,
                start_condition: conjunction(row.0),
                invariant: Conjunction::default(),
                end_condition: Conjunction::default(),
                also_reads: [Vec::new(), Vec::new()],
                start_effects: deletes.chain(adds).collect(),
                end_effects: Vec::new(),
            }
        };
        Task {
            facts: (0..facts).map(|fact| fact.to_string()).collect(),
            initial_facts: ids(initial),
            goal: conjunction(goal),
            operators: rows.iter().enumerate().map(operator).collect(),
            ..Task::default()
        }
    }

    fn kept(mut task: Task) -> Vec<u32> {
        prune(&mut task, &GroundingLimits::default()).unwrap();
        task.operators
            .iter()
            .map(|operator| operator.action.0)
            .collect()
    }

    #[test]
    fn a_goal_that_nothing_adds_is_kept() {
        let rows: [Row; 2] = [(&[], &[0], &[1]), (&[], &[], &[1])];
        assert_eq!(kept(task(2, &[0], &[0, 1], &rows)), [1]);
    }

    #[test]
    fn a_blank_sheet_takes_the_image_that_the_goal_names() {
        // 0 blank, 1 and 2 in one of two printers; 3 the image wanted, 4 another, 5 printed at all.
        let rows: [Row; 6] = [
            (&[0], &[0], &[1]),
            (&[0], &[0], &[2]),
            (&[1], &[1], &[3, 5]),
            (&[1], &[1], &[4, 5]),
            (&[2], &[2], &[4, 5]),
            (&[5], &[], &[]),
        ];
        assert_eq!(kept(task(6, &[0], &[3], &rows)), [0, 2, 5]);
        // With a second blank, the first may be spoiled.
        assert_eq!(kept(task(6, &[0, 1], &[3], &rows)), [0, 1, 2, 3, 4, 5]);
    }

    /// Every state is reached and left in every way: what was removed leads to no goal.
    #[test]
    fn no_plan_has_an_operator_that_was_removed() {
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let mut removed = 0;
        for _ in 0..3_000 {
            let mut some = |most: usize| -> Vec<u32> {
                let count = random.random_range(0..=most);
                (0..count).map(|_| random.random_range(0..8)).collect()
            };
            let lists: Vec<[Vec<u32>; 3]> = (0..7)
                .map(|_| {
                    let needs = some(2);
                    let mut deletes = some(1);
                    deletes.extend(needs.first());
                    [needs, deletes, some(2)]
                })
                .collect();
            let (initial, goal) = (some(3), some(2));
            let rows: Vec<Row> = lists
                .iter()
                .map(|[n, d, a]| (&n[..], &d[..], &a[..]))
                .collect();
            let kept = kept(task(8, &initial, &goal, &rows));
            let set = |list: &[u32]| list.iter().fold(0_usize, |set, fact| set | 1 << fact);
            let goal = set(&goal);
            let step = |state: usize, row: &Row| {
                (set(row.0) & !state == 0).then(|| state & !set(row.1) | set(row.2))
            };
            let mut reached = [false; 256];
            reached[set(&initial)] = true;
            let mut solves: Vec<bool> = (0..256).map(|state| goal & !state == 0).collect();
            for _ in 0..256 {
                for state in 0..256 {
                    for next in rows.iter().filter_map(|row| step(state, row)) {
                        reached[next] |= reached[state];
                        solves[state] |= solves[next];
                    }
                }
            }
            for (index, row) in rows.iter().enumerate() {
                if kept.contains(&(index as u32)) {
                    continue;
                }
                removed += 1;
                for state in (0..256).filter(|state| reached[*state]) {
                    if let Some(next) = step(state, row) {
                        assert!(!solves[next], "{rows:?} {initial:?} {goal:b}: {index}");
                    }
                }
            }
        }
        assert!(removed > 300, "only {removed} were removed");
    }
}
