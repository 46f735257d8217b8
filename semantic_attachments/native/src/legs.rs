//! Shortest paths from one place to many, some of which lie in blockades that are open for them only.

use crate::field::Field;
use crate::reach::reach;
use crate::traversability::Traversability;

/// A cell, and the blockade that is open for whoever starts or ends there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Where it is.
    pub cell: u32,
    /// Number of its blockade.
    pub blockade: Option<usize>,
}

/// The shortest path between two places.
#[derive(Clone, Debug, PartialEq)]
pub struct Leg {
    /// In cells times multiplier, the ways out of and into the inflation included; infinite where there is no way.
    pub length: f64,
    /// Cells on which the robot can stand.
    pub path: Vec<u32>,
    /// Whether each end is too near to an obstacle to stand on: the path begins beside it.
    pub snapped: (bool, bool),
}

/// The blockades that are open at two places, ascending.
#[must_use]
pub fn opened(source: Place, goal: Place) -> Vec<usize> {
    let mut numbers: Vec<usize> = source.blockade.into_iter().chain(goal.blockade).collect();
    numbers.sort_unstable();
    numbers.dedup();
    numbers
}

/// The legs from a source to goals, by the field grown from where a robot at the source can stand.
///
/// None where the robot can stand elsewhere because the goal's blockade is open, too: that needs a field of its own.
#[must_use]
pub fn legs(
    map: &Traversability,
    field: &Field,
    source: Place,
    goals: &[Place],
    limit_cells: f64,
) -> Vec<Option<Leg>> {
    goals
        .iter()
        .map(|&goal| {
            let opened = opened(source, goal);
            let start = map.nearest_passable(source.cell, &opened, limit_cells);
            let end = map.nearest_passable(goal.cell, &opened, limit_cells);
            let snapped = (
                start.is_none_or(|(cell, _)| cell != source.cell),
                end.is_none_or(|(cell, _)| cell != goal.cell),
            );
            let (Some(start), Some(end)) = (start, end) else {
                return Some(Leg {
                    length: f64::INFINITY,
                    path: Vec::new(),
                    snapped,
                });
            };
            if start.0 != field.source {
                return None;
            }
            let (length, path) = if goal.blockade.is_none() || goal.blockade == source.blockade {
                (field.distance(end.0), field.path_to(end.0))
            } else {
                reach(map, field, end.0, &opened)
            };
            Some(Leg {
                length: start.1 + length + end.1,
                path,
                snapped,
            })
        })
        .collect()
}
