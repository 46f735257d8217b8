//! Objects that can be exchanged, and a fingerprint of states that does not tell them apart.
//!
//! Two objects are interchangeable if exchanging them maps the operators and the goal onto
//! themselves. Of states that differ only by such an exchange one is enough (Pochter, Zohar,
//! Rosenschein, "Exploiting problem symmetries in state-based planners", AAAI 2011). Fingerprints
//! are made by colour refinement, so states that it cannot tell apart may be conflated: good for
//! finding plans, not for proofs.

use rustc_hash::FxHashMap;

use crate::epoch::state::State;
use crate::task::{Change, Conjunction, Operator, OperatorId, Task};

const NONE: u32 = u32::MAX;
/// Operators looked at in all, at most.
const EFFORT: usize = 20_000_000;

/// A fact or fluent without the names of interchangeable objects.
#[derive(Clone, Debug)]
struct Anonymous {
    shape: u64,
    /// The interchangeable objects in it, in order, as indices into the colours.
    objects: Vec<u32>,
}

/// The interchangeable objects of a task.
#[derive(Clone, Debug)]
pub struct Symmetry {
    facts: Vec<Anonymous>,
    fluents: Vec<Anonymous>,
    objects: usize,
    /// Sets of interchangeable objects, by index into the task's objects.
    pub classes: Vec<Vec<u32>>,
}

impl Symmetry {
    /// Finds the classes of a task; `None` if no two objects are interchangeable.
    #[must_use]
    pub fn new(task: &Task) -> Option<Self> {
        Self::unless(&|| false, task)?
    }

    /// The same unless `stop` says so meanwhile.
    #[allow(clippy::option_option)] // stopped, or nothing found
    pub fn unless(stop: &dyn Fn() -> bool, task: &Task) -> Option<Option<Self>> {
        let tables = Tables::new(task);
        let mut classes: Vec<Vec<u32>> = Vec::new();
        let mut effort = 0;
        for object in 0..task.object_names.len() as u32 {
            if tables.mentions[object as usize].is_empty() {
                continue;
            }
            if stop() {
                return None;
            }
            let same = classes.iter_mut().find(|class| {
                let count = tables.mentions[object as usize].len();
                if tables.mentions[class[0] as usize].len() != count || effort > EFFORT {
                    return false;
                }
                effort += 2 * count;
                tables.interchangeable(class[0], object)
            });
            match same {
                Some(class) => class.push(object),
                None => classes.push(vec![object]),
            }
        }
        classes.retain(|class| class.len() > 1);
        if classes.is_empty() {
            return Some(None);
        }
        let mut class_of = vec![(NONE, NONE); task.object_names.len()];
        let mut objects = 0;
        for (index, class) in classes.iter().enumerate() {
            for object in class {
                class_of[*object as usize] = (index as u32, objects);
                objects += 1;
            }
        }
        let anonymous = |kind: u64, arguments: &[u32]| {
            let mut shape = mix(0x51_7CC1, kind);
            let mut inside = Vec::new();
            for argument in arguments {
                let (class, index) = class_of[*argument as usize];
                shape = if class == NONE {
                    mix(shape, u64::from(*argument))
                } else {
                    inside.push(index);
                    mix(shape, u64::from(class) | 1 << 40)
                };
            }
            Anonymous {
                shape,
                objects: inside,
            }
        };
        let facts = task.atoms.iter().map(|(predicate, arguments)| {
            let arguments: Vec<u32> = arguments.iter().map(|object| object.0).collect();
            anonymous(u64::from(predicate.0), &arguments)
        });
        let mut kinds: FxHashMap<&str, u64> = FxHashMap::default();
        let fluents = tables.fluents.iter().map(|(function, arguments)| {
            let next = kinds.len() as u64 + (1 << 41);
            anonymous(*kinds.entry(*function).or_insert(next), arguments)
        });
        Some(Some(Self {
            facts: facts.collect(),
            fluents: fluents.collect(),
            objects: objects as usize,
            classes,
        }))
    }

    /// The same for states that differ by an exchange of interchangeable objects.
    #[must_use]
    pub fn fingerprint(&self, state: &State) -> u64 {
        let mut colours = vec![0_u64; self.objects];
        self.refine(state, &mut colours);
        let mut refined = colours.clone();
        self.refine(state, &mut refined);
        let mut sum = mix(u64::from(state.next_timed), 7);
        self.visit(state, &mut |anonymous, value| {
            sum = sum.wrapping_add(colour(anonymous, value, &refined));
        });
        sum
    }

    /// Adds to each object's colour what holds of it, seen through the others' colours.
    fn refine(&self, state: &State, colours: &mut [u64]) {
        let before = colours.to_vec();
        self.visit(state, &mut |anonymous, value| {
            if anonymous.objects.is_empty() {
                return;
            }
            let whole = colour(anonymous, value, &before);
            for (position, object) in anonymous.objects.iter().enumerate() {
                let slot = &mut colours[*object as usize];
                *slot = slot.wrapping_add(mix(whole, position as u64));
            }
        });
    }

    fn visit(&self, state: &State, visit: &mut dyn FnMut(&Anonymous, u64)) {
        for (word, bits) in state.facts.iter().enumerate() {
            let mut bits = *bits;
            while bits != 0 {
                let fact = word * 64 + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                visit(&self.facts[fact], 1);
            }
        }
        for (fluent, value) in self.fluents.iter().zip(&state.values) {
            visit(fluent, value.to_bits());
        }
    }
}

fn colour(anonymous: &Anonymous, value: u64, colours: &[u64]) -> u64 {
    let objects = anonymous.objects.iter();
    objects.fold(mix(anonymous.shape, value), |sum, object| {
        mix(sum, colours[*object as usize])
    })
}

/// A step of a hash (the finaliser of splitmix64).
fn mix(left: u64, right: u64) -> u64 {
    let mut value = left.rotate_left(17) ^ right.wrapping_add(0x9E37_79B9_7F4A_7C15);
    value = (value ^ (value >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    value = (value ^ (value >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    value ^ (value >> 31)
}

/// What testing an exchange looks things up in.
struct Tables<'t> {
    task: &'t Task,
    fact_of: FxHashMap<(u32, Vec<u32>), u32>,
    fluents: Vec<(&'t str, Vec<u32>)>,
    fluent_of: FxHashMap<(&'t str, Vec<u32>), u32>,
    operator_of: FxHashMap<(u32, Vec<u32>), Option<OperatorId>>,
    /// Operators that mention an object.
    mentions: Vec<Vec<u32>>,
}

impl<'t> Tables<'t> {
    fn new(task: &'t Task) -> Self {
        let mut mentions = vec![Vec::new(); task.object_names.len()];
        let mut operator_of = FxHashMap::default();
        for (index, operator) in task.operators.iter().enumerate() {
            let arguments: Vec<u32> = operator.arguments.iter().map(|object| object.0).collect();
            for object in &arguments {
                let list: &mut Vec<u32> = &mut mentions[*object as usize];
                if list.last() != Some(&(index as u32)) {
                    list.push(index as u32);
                }
            }
            // Several operators of one name, from a split condition, are not told apart.
            operator_of
                .entry((operator.action.0, arguments))
                .and_modify(|known| *known = None)
                .or_insert(Some(OperatorId(index as u32)));
        }
        let object_of: FxHashMap<&str, u32> = (0..)
            .zip(&task.object_names)
            .map(|(index, name)| (name.as_str(), index))
            .collect();
        let split = |name: &'t String| {
            let mut words = name.split(' ');
            let function = words.next().unwrap_or_default();
            let arguments = words.filter_map(|word| object_of.get(word).copied());
            (function, arguments.collect::<Vec<u32>>())
        };
        let fluents: Vec<_> = task.fluents.iter().map(split).collect();
        let numbered = (0..).zip(&task.atoms);
        Self {
            fact_of: numbered
                .map(|(index, (predicate, arguments))| {
                    let arguments = arguments.iter().map(|object| object.0).collect();
                    ((predicate.0, arguments), index)
                })
                .collect(),
            fluent_of: fluents.iter().cloned().zip(0..).collect(),
            fluents,
            operator_of,
            mentions,
            task,
        }
    }

    fn interchangeable(&self, one: u32, other: u32) -> bool {
        let swap = Swap {
            tables: self,
            one,
            other,
        };
        swap.conjunction(&self.task.goal).as_ref() == Some(&sorted(&self.task.goal))
            && self.task.axioms.is_empty()
            && [one, other].iter().all(|object| {
                let operators = &self.mentions[*object as usize];
                operators.iter().all(|operator| swap.keeps(*operator))
            })
    }
}

struct Swap<'a, 't> {
    tables: &'a Tables<'t>,
    one: u32,
    other: u32,
}

impl Swap<'_, '_> {
    fn object(&self, object: u32) -> u32 {
        match object {
            object if object == self.one => self.other,
            object if object == self.other => self.one,
            object => object,
        }
    }

    fn objects(&self, objects: &[u32]) -> Vec<u32> {
        objects.iter().map(|object| self.object(*object)).collect()
    }

    fn fact(&self, fact: u32) -> Option<u32> {
        let (predicate, arguments) = &self.tables.task.atoms[fact as usize];
        let arguments = arguments.iter().map(|object| self.object(object.0));
        let key = (predicate.0, arguments.collect());
        self.tables.fact_of.get(&key).copied()
    }

    fn fluent(&self, fluent: u32) -> Option<u32> {
        let (function, arguments) = &self.tables.fluents[fluent as usize];
        let key = (*function, self.objects(arguments));
        self.tables.fluent_of.get(&key).copied()
    }

    /// Whether the operator's image is an operator with the image of its conditions and effects.
    fn keeps(&self, operator: u32) -> bool {
        let task = self.tables.task;
        let own = &task.operators[operator as usize];
        let arguments: Vec<u32> = own.arguments.iter().map(|object| object.0).collect();
        let key = (own.action.0, self.objects(&arguments));
        let Some(Some(image)) = self.tables.operator_of.get(&key) else {
            return false;
        };
        let image = &task.operators[image.index()];
        own.duration == image.duration
            && plain(own)
            && plain(image)
            && self.conjunction(&own.start_condition).as_ref()
                == Some(&sorted(&image.start_condition))
            && self.changes(own) == unchanged(image)
    }

    fn conjunction(&self, conjunction: &Conjunction) -> Option<(Vec<u32>, Vec<u32>)> {
        if !conjunction.comparisons.is_empty() || !conjunction.calls.is_empty() {
            return None;
        }
        let map = |facts: &[crate::task::FactId]| {
            let facts = facts.iter().map(|fact| self.fact(fact.0));
            let mut facts = facts.collect::<Option<Vec<u32>>>()?;
            facts.sort_unstable();
            Some(facts)
        };
        Some((map(&conjunction.positive)?, map(&conjunction.negative)?))
    }

    fn changes(&self, operator: &Operator) -> Option<Vec<(u8, u32, u64)>> {
        let mut changes = operator
            .start_effects
            .iter()
            .map(|effect| match &effect.change {
                Change::Add(fact) => Some((0, self.fact(fact.0)?, 0)),
                Change::Delete(fact) => Some((1, self.fact(fact.0)?, 0)),
                Change::Assign(assignment, fluent, value) => {
                    let crate::task::GroundExpression::Constant(value) = value else {
                        return None;
                    };
                    Some((
                        2 + *assignment as u8,
                        self.fluent(fluent.0)?,
                        value.to_bits(),
                    ))
                }
                Change::Call(_) => None,
            })
            .collect::<Option<Vec<_>>>()?;
        changes.sort_unstable();
        Some(changes)
    }
}

/// Whether an operator of a compressed task has no parts that exchanging does not look at.
fn plain(operator: &Operator) -> bool {
    operator.duration.is_none()
        && operator.invariant.is_empty()
        && operator.end_condition.is_empty()
        && operator.end_effects.is_empty()
        && operator.start_effects.iter().all(|e| e.condition.is_none())
}

fn sorted(conjunction: &Conjunction) -> (Vec<u32>, Vec<u32>) {
    let list = |facts: &[crate::task::FactId]| facts.iter().map(|fact| fact.0).collect();
    (list(&conjunction.positive), list(&conjunction.negative))
}

fn unchanged(operator: &Operator) -> Option<Vec<(u8, u32, u64)>> {
    let mut changes: Vec<(u8, u32, u64)> = operator
        .start_effects
        .iter()
        .map(|effect| match &effect.change {
            Change::Add(fact) => Some((0, fact.0, 0)),
            Change::Delete(fact) => Some((1, fact.0, 0)),
            Change::Assign(assignment, fluent, value) => match value {
                crate::task::GroundExpression::Constant(value) => {
                    Some((2 + *assignment as u8, fluent.0, value.to_bits()))
                }
                _ => None,
            },
            Change::Call(_) => None,
        })
        .collect::<Option<Vec<_>>>()?;
    changes.sort_unstable();
    Some(changes)
}
