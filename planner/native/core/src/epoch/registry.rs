//! Packed states with their parents, and the test whether an equal or better one is known.
//!
//! Two states are *alike* if they agree in facts, values and the multiset of running operators.
//! Of alike states one dominates another if nothing in it is later. Where ending earlier may be a
//! disadvantage ([`Dominance::Shifted`]), only states whose ends lie equally far ahead compare.

use std::hash::Hasher;

use crate::task::OperatorId;

use super::state::{Event, Running, State};

/// Index of a stored state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct NodeId(pub u32);

/// How a node came from its parent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge(u32);

impl Edge {
    /// Time passed to the next event.
    pub const ADVANCE: Self = Self(u32::MAX);
    const LONGEST: u32 = 1 << 31;

    /// An operator started, with its longest duration if `longest`.
    #[must_use]
    pub const fn start(operator: OperatorId, longest: bool) -> Self {
        Self(operator.0 | if longest { Self::LONGEST } else { 0 })
    }

    /// The operator and whether it got its longest duration; `None` for letting time pass.
    #[must_use]
    pub fn operator(self) -> Option<(OperatorId, bool)> {
        (self != Self::ADVANCE).then_some((
            OperatorId(self.0 & !Self::LONGEST),
            self.0 & Self::LONGEST != 0,
        ))
    }
}

/// When a state makes an alike one superfluous.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dominance {
    /// When nothing in it is later.
    Earlier,
    /// When it is the other one shifted to an earlier time.
    Shifted,
    /// When it is the other one (timed events make every moment different).
    Same,
    /// Always: times do not count (sequential plans are rescheduled afterwards).
    Untimed,
}

struct Node {
    parent: u32,
    edge: Edge,
    offset: usize,
    /// Next node with the same hash, or `u32::MAX`.
    next: u32,
    hash: u32,
    dead: bool,
}

/// All states met.
pub struct Registry {
    dominance: Dominance,
    /// Differences below this count as equal, so that orders of epsilons do not multiply states [s].
    tolerance: f64,
    words: usize,
    values: usize,
    nodes: Vec<Node>,
    bytes: Vec<u8>,
    table: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl Registry {
    /// An empty registry for states of the given sizes.
    #[must_use]
    pub fn new(words: usize, values: usize, dominance: Dominance, tolerance: f64) -> Self {
        Self {
            dominance,
            tolerance,
            words,
            values,
            nodes: Vec::new(),
            bytes: Vec::new(),
            table: vec![NONE; 1 << 12],
        }
    }

    /// Number of states.
    #[must_use]
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Bytes held.
    #[must_use]
    pub fn memory(&self) -> usize {
        self.bytes.capacity()
            + self.nodes.capacity() * size_of::<Node>()
            + self.table.capacity() * size_of::<u32>()
    }

    /// Stores a state unless a known one is as good; also forgets that known ones it beats have
    /// successors to try.
    pub fn insert(&mut self, state: &State, parent: Option<(NodeId, Edge)>) -> Option<NodeId> {
        let hash = hash(state);
        let slot = hash as usize & (self.table.len() - 1);
        let mut cursor = self.table[slot];
        while cursor != NONE {
            let node = &self.nodes[cursor as usize];
            let next = node.next;
            if node.hash == hash && !node.dead {
                match self.compare(cursor, state) {
                    Comparison::Known => return None,
                    Comparison::Beaten => self.nodes[cursor as usize].dead = true,
                    Comparison::Different => {}
                }
            }
            cursor = next;
        }
        let id = self.nodes.len() as u32;
        let offset = self.bytes.len();
        self.pack(state);
        self.nodes.push(Node {
            parent: parent.map_or(NONE, |(node, _)| node.0),
            edge: parent.map_or(Edge::ADVANCE, |(_, edge)| edge),
            offset,
            next: self.table[slot],
            hash,
            dead: false,
        });
        self.table[slot] = id;
        if self.nodes.len() > self.table.len() {
            self.grow();
        }
        Some(NodeId(id))
    }

    /// Whether a better state has replaced this one.
    #[must_use]
    pub fn is_dead(&self, node: NodeId) -> bool {
        self.nodes[node.0 as usize].dead
    }

    /// The edges from the initial state to a node.
    #[must_use]
    pub fn path(&self, node: NodeId) -> Vec<Edge> {
        let mut edges = Vec::new();
        let mut cursor = &self.nodes[node.0 as usize];
        while cursor.parent != NONE {
            edges.push(cursor.edge);
            cursor = &self.nodes[cursor.parent as usize];
        }
        edges.reverse();
        edges
    }

    /// The edge that led to a node.
    #[must_use]
    pub fn edge(&self, node: NodeId) -> Option<(NodeId, Edge)> {
        let node = &self.nodes[node.0 as usize];
        (node.parent != NONE).then_some((NodeId(node.parent), node.edge))
    }

    /// The time of a node [s].
    #[must_use]
    pub fn time(&self, node: NodeId) -> f64 {
        Reader::at(&self.bytes, self.nodes[node.0 as usize].offset).real()
    }

    /// Unpacks a state.
    pub fn load(&self, node: NodeId, state: &mut State) {
        let mut reader = Reader::at(&self.bytes, self.nodes[node.0 as usize].offset);
        state.time = reader.real();
        state.facts.clear();
        for _ in 0..self.words {
            state.facts.push(reader.word());
        }
        state.values.clear();
        for _ in 0..self.values {
            state.values.push(reader.real());
        }
        state.next_timed = reader.short();
        let (running, recent) = (reader.short(), reader.short());
        state.running.clear();
        for _ in 0..running {
            state.running.push(Running {
                operator: OperatorId(reader.short()),
                conditional: reader.short(),
                start: reader.real(),
                end: reader.real(),
            });
        }
        state.recent.clear();
        for _ in 0..recent {
            let at = reader.real();
            let (kind, index) = (reader.short(), reader.short());
            let event = match kind {
                0 => Event::Start(OperatorId(index)),
                1 => Event::End(OperatorId(index)),
                _ => Event::Timed(index),
            };
            state.recent.push((at, event));
        }
    }

    fn pack(&mut self, state: &State) {
        let bytes = &mut self.bytes;
        let mut real = |value: f64| bytes.extend_from_slice(&value.to_bits().to_le_bytes());
        real(state.time);
        for &word in &state.facts {
            bytes.extend_from_slice(&word.to_le_bytes());
        }
        for &value in &state.values {
            bytes.extend_from_slice(&value.to_bits().to_le_bytes());
        }
        let short = |bytes: &mut Vec<u8>, value: u32| bytes.extend_from_slice(&value.to_le_bytes());
        short(bytes, state.next_timed);
        short(bytes, state.running.len() as u32);
        short(bytes, state.recent.len() as u32);
        for running in &state.running {
            short(bytes, running.operator.0);
            short(bytes, running.conditional);
            bytes.extend_from_slice(&running.start.to_bits().to_le_bytes());
            bytes.extend_from_slice(&running.end.to_bits().to_le_bytes());
        }
        for &(at, event) in &state.recent {
            bytes.extend_from_slice(&at.to_bits().to_le_bytes());
            let (kind, index) = match event {
                Event::Start(operator) => (0, operator.0),
                Event::End(operator) => (1, operator.0),
                Event::Timed(index) => (2, index),
            };
            short(bytes, kind);
            short(bytes, index);
        }
    }

    fn compare(&self, known: u32, state: &State) -> Comparison {
        let mut reader = Reader::at(&self.bytes, self.nodes[known as usize].offset);
        let time = reader.real();
        for &word in &state.facts {
            if reader.word() != word {
                return Comparison::Different;
            }
        }
        for &value in &state.values {
            if reader.word() != value.to_bits() {
                return Comparison::Different;
            }
        }
        let clocked = matches!(self.dominance, Dominance::Same | Dominance::Untimed);
        if reader.short() != state.next_timed && clocked {
            return Comparison::Different;
        }
        if self.dominance == Dominance::Untimed && state.running.is_empty() {
            return Comparison::Known;
        }
        let running = reader.short() as usize;
        reader.short();
        if running != state.running.len() {
            return Comparison::Different;
        }
        let ahead = state.time - time;
        let mut known_wins = ahead >= -self.tolerance;
        let mut state_wins = ahead <= -self.tolerance;
        let shift = match self.dominance {
            Dominance::Earlier | Dominance::Untimed => 0.0,
            Dominance::Shifted => ahead,
            Dominance::Same => {
                if ahead.abs() > self.tolerance {
                    return Comparison::Different;
                }
                0.0
            }
        };
        let exact = self.dominance != Dominance::Earlier;
        // Equal multisets of operators need not be in the same order, because ends differ.
        let mut known_running: [(u32, u32, f64); 64] = [(0, 0, 0.0); 64];
        if running > 64 {
            return Comparison::Different;
        }
        for slot in known_running.iter_mut().take(running) {
            *slot = (reader.short(), reader.short(), {
                reader.real();
                reader.real()
            });
        }
        let known_running = &mut known_running[..running];
        known_running
            .sort_unstable_by(|l, r| (l.0, l.1).cmp(&(r.0, r.1)).then(l.2.total_cmp(&r.2)));
        let mut own: [(u32, u32, f64); 64] = [(0, 0, 0.0); 64];
        for (slot, running) in own.iter_mut().zip(&state.running) {
            *slot = (running.operator.0, running.conditional, running.end);
        }
        let own = &mut own[..running];
        own.sort_unstable_by(|l, r| (l.0, l.1).cmp(&(r.0, r.1)).then(l.2.total_cmp(&r.2)));
        for (known, own) in known_running.iter().zip(own.iter()) {
            if (known.0, known.1) != (own.0, own.1) {
                return Comparison::Different;
            }
            let later = own.2 - known.2 - shift;
            if exact && later.abs() > self.tolerance {
                return Comparison::Different;
            }
            known_wins &= later >= -self.tolerance;
            state_wins &= later <= self.tolerance;
        }
        if known_wins {
            Comparison::Known
        } else if state_wins {
            Comparison::Beaten
        } else {
            Comparison::Different
        }
    }

    fn grow(&mut self) {
        let size = self.table.len() * 2;
        self.table = vec![NONE; size];
        for (index, node) in self.nodes.iter_mut().enumerate() {
            if node.dead {
                continue;
            }
            let slot = node.hash as usize & (size - 1);
            node.next = self.table[slot];
            self.table[slot] = index as u32;
        }
    }
}

enum Comparison {
    Known,
    Beaten,
    Different,
}

fn hash(state: &State) -> u32 {
    let mut hasher = rustc_hash::FxHasher::default();
    for &word in &state.facts {
        hasher.write_u64(word);
    }
    for &value in &state.values {
        hasher.write_u64(value.to_bits());
    }
    let mut operators: u64 = 0;
    for running in &state.running {
        let spread = u64::from(running.operator.0) + 1;
        operators =
            operators.wrapping_add(spread.wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(23));
    }
    hasher.write_u64(operators);
    let hash = hasher.finish();
    (hash ^ (hash >> 32)) as u32
}

struct Reader<'a> {
    bytes: &'a [u8],
}

impl<'a> Reader<'a> {
    fn at(bytes: &'a [u8], offset: usize) -> Self {
        Self {
            bytes: &bytes[offset..],
        }
    }

    fn take<const N: usize>(&mut self) -> [u8; N] {
        let (head, tail) = self.bytes.split_at(N);
        self.bytes = tail;
        let mut array = [0; N];
        array.copy_from_slice(head);
        array
    }

    fn word(&mut self) -> u64 {
        u64::from_le_bytes(self.take())
    }

    fn short(&mut self) -> u32 {
        u32::from_le_bytes(self.take())
    }

    fn real(&mut self) -> f64 {
        f64::from_bits(self.word())
    }
}
