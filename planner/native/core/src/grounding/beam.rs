//! Which atoms a partial grounding goes on from, where grounding everything would take too long.
//!
//! A team of 100 robots at 500 places has 100 * 500 * 500 moves, nearly all of them useless. Of the
//! atoms that agree in predicate, in one object and in the types of the others, only the `width`
//! that the relaxation reaches first are joined further: to each place some robots of each type, to
//! each robot some places. An action counts only if all it adds is among these.

use std::hash::Hasher;

use rustc_hash::{FxHashMap, FxHashSet, FxHasher};

use crate::pddl::model::{Effect, EffectKind, ObjectId};

use super::schema::{Origin, Schema};
use super::world::World;

type Tuple = Box<[ObjectId]>;

/// Predicate, position, the object there, and a hash of the first types of the others.
type Key = (usize, usize, ObjectId, u64);

/// What has been admitted.
pub(super) struct Beam {
    width: u32,
    counts: FxHashMap<Key, u32>,
    admitted: FxHashSet<(usize, Tuple)>,
    pending: Vec<(f32, usize)>,
}

impl Beam {
    /// Admits up to `width` atoms for each object.
    pub(super) fn new(width: u32) -> Self {
        Self {
            width,
            counts: FxHashMap::default(),
            admitted: FxHashSet::default(),
            pending: Vec::new(),
        }
    }

    /// Notes that the queue's atom at a position was reached.
    pub(super) fn pend(&mut self, label: f32, position: usize) {
        self.pending.push((label, position));
    }

    /// Whether atoms wait for being admitted.
    pub(super) fn has_pending(&self) -> bool {
        !self.pending.is_empty()
    }

    /// Admits what is near enough and forgets the other pending atoms.
    pub(super) fn admit(&mut self, world: &World<'_>, queue: &[(usize, Tuple)]) -> Vec<usize> {
        let mut pending = std::mem::take(&mut self.pending);
        pending.sort_by(|left, right| left.0.total_cmp(&right.0).then(left.1.cmp(&right.1)));
        let mut positions = Vec::new();
        for (_, position) in pending {
            let (predicate, tuple) = &queue[position];
            if self.is_open(world, *predicate, tuple) {
                for key in keys(world, *predicate, tuple) {
                    *self.counts.entry(key).or_insert(0) += 1;
                }
                self.admitted.insert((*predicate, tuple.clone()));
                positions.push(position);
            }
        }
        positions
    }

    fn is_open(&self, world: &World<'_>, predicate: usize, tuple: &[ObjectId]) -> bool {
        tuple.is_empty()
            || keys(world, predicate, tuple).any(|key| {
                self.counts
                    .get(&key)
                    .is_none_or(|count| *count < self.width)
            })
    }

    /// Whether all that an instance adds is admitted or may still be.
    pub(super) fn may_admit_all(
        &self,
        world: &World<'_>,
        schema: &Schema<'_>,
        bindings: &[ObjectId],
    ) -> bool {
        added(schema, bindings, &mut |predicate, tuple| {
            self.admitted.contains(&(predicate, tuple.clone()))
                || self.is_open(world, predicate, &tuple)
        })
    }

    /// Whether all that an instance adds is admitted.
    pub(super) fn admits_all(&self, schema: &Schema<'_>, bindings: &[ObjectId]) -> bool {
        added(schema, bindings, &mut |predicate, tuple| {
            self.admitted.contains(&(predicate, tuple))
        })
    }
}

fn keys<'k>(
    world: &'k World<'_>,
    predicate: usize,
    tuple: &'k [ObjectId],
) -> impl Iterator<Item = Key> + 'k {
    (0..tuple.len()).map(move |position| {
        let mut types = FxHasher::default();
        for (other, object) in tuple.iter().enumerate() {
            if other != position {
                let first = world.problem.objects[object.index()].types.first();
                types.write_u32(first.map_or(0, |kind| kind.0));
            }
        }
        (predicate, position, tuple[position], types.finish())
    })
}

/// Whether a test holds for every atom that an instance adds in any case.
fn added(
    schema: &Schema<'_>,
    bindings: &[ObjectId],
    test: &mut dyn FnMut(usize, Tuple) -> bool,
) -> bool {
    match schema.origin {
        Origin::Rule(rule) => test(rule.predicate.index(), bindings.into()),
        Origin::Action(_, action) => action
            .effects
            .iter()
            .all(|(_, effect)| effect_adds(effect, bindings, test)),
    }
}

fn effect_adds(
    effect: &Effect,
    bindings: &[ObjectId],
    test: &mut dyn FnMut(usize, Tuple) -> bool,
) -> bool {
    match &effect.kind {
        EffectKind::And(parts) => parts.iter().all(|part| effect_adds(part, bindings, test)),
        EffectKind::Add(atom) => test(
            atom.predicate.index(),
            World::bind(&atom.arguments, bindings).as_ref().into(),
        ),
        _ => true,
    }
}
