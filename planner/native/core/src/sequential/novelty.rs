//! How new a state is: whether it holds a fact, or two facts together, that no state before it held.
//!
//! Source: Lipovetzky and Geffner, "Width and serialization of classical planning problems", ECAI
//! 2012. States are compared only with those of the same *class*, whatever that stands for.

use rustc_hash::FxHashMap;

/// Facts or pairs of facts met in the states of one class, one bit each.
#[derive(Debug, Default)]
struct Met {
    facts: Vec<u64>,
    /// Pair (low, high) at `high * (high - 1) / 2 + low`.
    pairs: Vec<u64>,
}

/// What the states of each class have held.
#[derive(Debug)]
pub struct Novelty {
    words: usize,
    pair_words: usize,
    classes: FxHashMap<u64, Met>,
    /// Bytes that tables of pairs may still take.
    memory_left: usize,
    held: Vec<u32>,
    fresh: Vec<u32>,
}

/// Of a state that holds nothing new.
pub const OLD: u32 = 3;

impl Novelty {
    /// Nothing met, of so many facts; tables of pairs may take `memory` bytes.
    #[must_use]
    pub fn new(facts: usize, memory: usize) -> Self {
        Self {
            words: facts.div_ceil(64),
            pair_words: (facts * facts.saturating_sub(1) / 2).div_ceil(64),
            classes: FxHashMap::default(),
            memory_left: memory,
            held: Vec::new(),
            fresh: Vec::new(),
        }
    }

    /// Bytes held, about.
    #[must_use]
    pub fn memory(&self) -> usize {
        let met = self.classes.values();
        met.map(|met| 8 * (met.facts.len() + met.pairs.len()) + 64)
            .sum()
    }

    /// Notes a state: 1 if it holds a new fact, 2 if two facts that were never held together,
    /// else [`OLD`]. `parent` are the facts of a state of the same class that has been noted, if
    /// there is one: what both hold is not new.
    pub fn note(&mut self, class: u64, state: &[u64], parent: Option<&[u64]>) -> u32 {
        self.held.clear();
        self.fresh.clear();
        for (word, &bits) in state.iter().enumerate() {
            let known = parent.map_or(0, |parent| parent[word]);
            let mut bits = bits;
            while bits != 0 {
                let fact = word as u32 * 64 + bits.trailing_zeros();
                if known & (bits & bits.wrapping_neg()) == 0 {
                    self.fresh.push(fact);
                }
                self.held.push(fact);
                bits &= bits - 1;
            }
        }
        let met = self.classes.entry(class).or_insert_with(|| {
            let size = 8 * self.pair_words;
            let afforded = size <= self.memory_left;
            self.memory_left -= if afforded { size } else { 0 };
            Met {
                facts: vec![0; self.words],
                pairs: vec![0; if afforded { self.pair_words } else { 0 }],
            }
        });
        let mut novelty = OLD;
        for &fact in &self.fresh {
            novelty = novelty.min(if enter(&mut met.facts, fact as usize) {
                1
            } else {
                OLD
            });
        }
        if met.pairs.is_empty() {
            return novelty;
        }
        for &fact in &self.fresh {
            for &other in &self.held {
                let (low, high) = (fact.min(other) as usize, fact.max(other) as usize);
                if low < high && enter(&mut met.pairs, high * (high - 1) / 2 + low) {
                    novelty = novelty.min(2);
                }
            }
        }
        novelty
    }
}

/// Sets a bit; whether it was not set before.
fn enter(bits: &mut [u64], index: usize) -> bool {
    let word = &mut bits[index / 64];
    let bit = 1 << (index % 64);
    let fresh = *word & bit == 0;
    *word |= bit;
    fresh
}

#[cfg(test)]
mod tests {
    use super::{Novelty, OLD};

    #[test]
    fn facts_then_pairs_then_nothing_is_new() {
        let mut novelty = Novelty::new(70, 1 << 20);
        let state = |facts: &[usize]| {
            let mut words = [0u64; 2];
            for fact in facts {
                words[fact / 64] |= 1 << (fact % 64);
            }
            words
        };
        assert_eq!(novelty.note(0, &state(&[0, 1]), None), 1);
        assert_eq!(novelty.note(0, &state(&[1, 69]), Some(&state(&[0, 1]))), 1);
        // Both facts are known, but not together.
        assert_eq!(novelty.note(0, &state(&[0, 69]), Some(&state(&[1, 69]))), 2);
        assert_eq!(
            novelty.note(0, &state(&[0, 1]), Some(&state(&[0, 69]))),
            OLD
        );
        // Another class has met nothing.
        assert_eq!(novelty.note(1, &state(&[0, 1]), None), 1);
    }

    #[test]
    fn without_memory_only_facts_count() {
        let mut novelty = Novelty::new(70, 10);
        assert_eq!(novelty.note(0, &[0b011, 0], None), 1);
        assert_eq!(novelty.note(0, &[0b101, 0], None), 1);
        assert_eq!(novelty.note(0, &[0b110, 0], None), OLD);
    }
}
