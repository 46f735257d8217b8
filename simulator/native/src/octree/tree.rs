//! The pruned octree of a map, made when it is written or measured.

use crate::octree::brick::{Brick, BrickGrid};
use crate::octree::key::{BrickKey, VOXELS};
use crate::octree::sensor_model::UNKNOWN;

/// Levels of an OctoMap file: keys of 16 bits.
pub const DEPTH: u32 = 16;
/// Half the voxels along one edge of such a tree.
pub const HALF: i32 = 1 << (DEPTH - 1);

/// A node of the pruned tree.
#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    /// Never observed.
    Unknown,
    /// All voxels below have this stored value.
    Leaf(i8),
    /// Eight children (x is the lowest bit of a child's number) and the largest value below.
    Inner(Box<[Node; 8]>, i8),
}

impl Node {
    /// Joins eight children; eight equal leaves become one (lossless pruning, Wurm, section 5.2.4).
    #[must_use]
    pub fn join(children: [Self; 8]) -> Self {
        if let Self::Leaf(value) = children[0]
            && children.iter().all(|child| *child == Self::Leaf(value))
        {
            return Self::Leaf(value);
        }
        let Some(maximum) = children.iter().filter_map(Self::maximum).max() else {
            return Self::Unknown;
        };
        Self::Inner(Box::new(children), maximum)
    }

    /// Largest stored value below; `None` if nothing is known.
    #[must_use]
    pub fn maximum(&self) -> Option<i8> {
        match self {
            Self::Unknown => None,
            Self::Leaf(value) | Self::Inner(_, value) => Some(*value),
        }
    }

    /// Number of nodes, this one included.
    #[must_use]
    pub fn count(&self) -> usize {
        match self {
            Self::Unknown => 0,
            Self::Leaf(_) => 1,
            Self::Inner(children, _) => 1 + children.iter().map(Self::count).sum::<usize>(),
        }
    }
}

/// Builds the pruned tree of a grid, values mapped by `convert`.
///
/// # Errors
/// If a voxel lies beyond the reach of 16-bit keys.
pub fn build(grid: &BrickGrid, convert: impl Fn(i8) -> i8) -> Result<Node, String> {
    let half = HALF / 8;
    let mut keys: Vec<(u64, BrickKey)> = Vec::with_capacity(grid.len());
    for (key, _) in grid.iter() {
        let coordinates = key.coordinates().map(|k| k + half);
        if coordinates.iter().any(|k| !(0..2 * half).contains(k)) {
            return Err(format!(
                "the map reaches beyond the {} voxels a side that this file format can hold",
                2 * HALF
            ));
        }
        keys.push((morton(coordinates.map(|k| k as u64)), key));
    }
    keys.sort_unstable();
    Ok(branch(grid, &keys, DEPTH - 3, &convert))
}

fn morton(coordinates: [u64; 3]) -> u64 {
    (0..DEPTH - 3).fold(0, |code, bit| {
        (0..3).fold(code, |code, axis| {
            code | (coordinates[axis] >> bit & 1) << (3 * bit + axis as u32)
        })
    })
}

/// The node of a run of bricks, sorted in Morton order; `level` 0 is one brick.
fn branch(
    grid: &BrickGrid,
    mut keys: &[(u64, BrickKey)],
    level: u32,
    convert: &impl Fn(i8) -> i8,
) -> Node {
    if keys.is_empty() {
        return Node::Unknown;
    }
    if level == 0 {
        return grid
            .get(keys[0].1)
            .map_or(Node::Unknown, |brick| match brick {
                Brick::Uniform(value) => leaf(*value, convert),
                Brick::Dense(values) => inside(&values[..], convert),
            });
    }
    Node::join(std::array::from_fn(|child| {
        let end =
            keys.partition_point(|(code, _)| (code >> (3 * (level - 1)) & 7) as usize <= child);
        let (mine, rest) = keys.split_at(end);
        keys = rest;
        branch(grid, mine, level - 1, convert)
    }))
}

fn leaf(value: i8, convert: &impl Fn(i8) -> i8) -> Node {
    if value == UNKNOWN {
        Node::Unknown
    } else {
        Node::Leaf(convert(value))
    }
}

/// The node of a run of voxels within a brick.
fn inside(values: &[i8], convert: &impl Fn(i8) -> i8) -> Node {
    if values.len() == 1 {
        return leaf(values[0], convert);
    }
    let part = values.len() / 8;
    Node::join(std::array::from_fn(|child| {
        inside(&values[child * part..(child + 1) * part], convert)
    }))
}

/// Leaves and inner nodes that the tree of a grid would have without pruning, every known voxel a leaf.
#[must_use]
pub fn unpruned_counts(grid: &BrickGrid) -> (usize, usize) {
    let (mut leaves, mut inner) = (0, 0);
    let mut level: Vec<[i32; 3]> = Vec::with_capacity(grid.len());
    for (key, brick) in grid.iter() {
        level.push(key.coordinates());
        let known = |offset: usize| brick.value(offset) != UNKNOWN;
        leaves += (0..VOXELS).filter(|&offset| known(offset)).count();
        // Within a brick a node is a run of 8, 64 or 512 voxels.
        for run in [8, 64, VOXELS] {
            inner += (0..VOXELS / run)
                .filter(|&node| (node * run..(node + 1) * run).any(known))
                .count();
        }
    }
    for _ in 3..DEPTH {
        for node in &mut level {
            *node = node.map(|k| k >> 1);
        }
        level.sort_unstable();
        level.dedup();
        inner += level.len();
    }
    (leaves, inner)
}

/// A leaf of the pruned tree: its lowest voxel, its edge in voxels and its stored value.
pub type Leaf = ([i32; 3], i32, i8);

/// All leaves, depth first.
#[must_use]
pub fn leaves(root: &Node) -> Vec<Leaf> {
    fn collect(node: &Node, corner: [i32; 3], level: u32, into: &mut Vec<Leaf>) {
        match node {
            Node::Unknown => {}
            Node::Leaf(value) => into.push((corner, 1 << level, *value)),
            Node::Inner(children, _) => {
                for (number, child) in children.iter().enumerate() {
                    collect(child, child_corner(corner, level, number), level - 1, into);
                }
            }
        }
    }
    let mut found = Vec::new();
    collect(root, [-HALF; 3], DEPTH, &mut found);
    found
}

fn child_corner(corner: [i32; 3], level: u32, number: usize) -> [i32; 3] {
    let half = 1 << (level - 1);
    std::array::from_fn(|axis| corner[axis] + if number >> axis & 1 == 1 { half } else { 0 })
}

/// Fills a grid from a pruned tree.
///
/// # Errors
/// If an inner node lies below the level of voxels, a leaf is so coarse that it would fill more than 2^24 bricks, or
/// the grid would hold more than `limit_bytes`.
pub fn fill(grid: &mut BrickGrid, root: &Node, limit_bytes: Option<usize>) -> Result<(), String> {
    fill_node(
        grid,
        root,
        [-HALF; 3],
        DEPTH,
        limit_bytes.unwrap_or(usize::MAX),
    )
}

fn fill_node(
    grid: &mut BrickGrid,
    node: &Node,
    corner: [i32; 3],
    level: u32,
    limit_bytes: usize,
) -> Result<(), String> {
    let more = if matches!(node, Node::Leaf(_)) && level > 3 {
        1usize << (3 * (level - 3))
    } else {
        0
    };
    if grid.memory_bytes_with(more, 0) > limit_bytes {
        return Err(format!(
            "the map would take more than its limit of {limit_bytes} bytes"
        ));
    }
    match node {
        Node::Unknown => Ok(()),
        Node::Inner(..) if level == 0 => Err("the tree is deeper than 16 levels".into()),
        Node::Inner(children, _) => {
            for (number, child) in children.iter().enumerate() {
                let corner = child_corner(corner, level, number);
                fill_node(grid, child, corner, level - 1, limit_bytes)?;
            }
            Ok(())
        }
        Node::Leaf(value) if level <= 3 => {
            let voxel = crate::octree::key::VoxelKey(corner);
            let count = 1 << (3 * level);
            grid.change(voxel.brick(), |brick| {
                if count == VOXELS {
                    *brick = Brick::Uniform(*value);
                } else {
                    let first = voxel.offset();
                    brick.dense()[first..first + count].fill(*value);
                }
            });
            Ok(())
        }
        Node::Leaf(_) if level > 11 => Err(format!(
            "a leaf of {} voxels a side is too coarse to be held",
            1 << level
        )),
        Node::Leaf(value) => {
            let edge = 1 << (level - 3);
            let first = corner.map(|k| k >> 3);
            for x in 0..edge {
                for y in 0..edge {
                    for z in 0..edge {
                        let key = BrickKey::new([first[0] + x, first[1] + y, first[2] + z]);
                        grid.change(key, |brick| *brick = Brick::Uniform(*value));
                    }
                }
            }
            Ok(())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::octree::key::VoxelKey;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_grid_is_its_tree(
            voxels in prop::collection::vec((prop::array::uniform3(-20i32..20), -40i8..70), 0..200),
            block in prop::array::uniform3(-3i32..3), value in -40i8..70,
        ) {
            let mut grid = BrickGrid::default();
            grid.change(BrickKey::new(block), |brick| *brick = Brick::Uniform(value));
            for (key, value) in voxels {
                grid.set(VoxelKey(key), value);
            }
            let tree = build(&grid, |value| value).unwrap();
            let mut again = BrickGrid::default();
            fill(&mut again, &tree, None).unwrap();
            let found = leaves(&tree);
            prop_assert!(found.len() <= tree.count());
            let known: usize = found.iter().map(|leaf| (leaf.1 as usize).pow(3)).sum();
            let (voxels, inner) = unpruned_counts(&grid);
            prop_assert_eq!(known, voxels);
            prop_assert!(voxels + inner >= tree.count());
            for (corner, edge, value) in found {
                prop_assert_eq!(grid.value(VoxelKey(corner)), value);
                prop_assert_eq!(grid.value(VoxelKey(corner.map(|k| k + edge - 1))), value);
            }
            prop_assert_eq!(again.sorted_keys(), grid.sorted_keys());
            for (key, brick) in grid.iter() {
                for offset in 0..VOXELS {
                    prop_assert_eq!(again.value(key.voxel(offset)), brick.value(offset));
                }
            }
            prop_assert_eq!(build(&again, |value| value).unwrap(), tree);
        }
    }
}
