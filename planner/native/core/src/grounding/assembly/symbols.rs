//! What became of the model's symbols, for attachments that look at states.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::task::{FactId, FluentId, FluentPlace, StateSymbols};

use super::super::formula::AtomId;
use super::super::reachability::Reached;
use super::super::world::World;

/// Where each symbol of the model went.
pub(super) fn state_symbols(
    world: &World<'_>,
    reached: &Reached<'_>,
    fact_of: &FxHashMap<AtomId, FactId>,
    initial: &FxHashSet<AtomId>,
) -> StateSymbols {
    let mut symbols = StateSymbols::default();
    for (index, key) in reached.symbols.atoms.iter().enumerate() {
        let atom = AtomId(index as u32);
        match fact_of.get(&atom) {
            Some(&fact) => {
                symbols.facts.insert(key.clone(), Some(fact));
            }
            None if initial.contains(&atom) => {
                symbols.facts.insert(key.clone(), None);
            }
            None => {}
        }
    }
    for atom in &world.problem.facts {
        if !world.changing_predicate[atom.predicate.index()] {
            let key = (atom.predicate, atom.arguments.as_slice().into());
            symbols.facts.insert(key, None);
        }
    }
    for (term, value) in &world.problem.fluents {
        let key = (term.function, term.arguments.as_slice().into());
        symbols.fluents.insert(key, FluentPlace::Constant(*value));
    }
    for (index, key) in reached.symbols.fluents.iter().enumerate() {
        symbols
            .fluents
            .insert(key.clone(), FluentPlace::Stored(FluentId(index as u32)));
    }
    symbols
}
