//! Right of way: a route in space and time that keeps clear of other robots' announced motions.
//!
//! Windowed cooperative A* (Silver, "Cooperative Pathfinding", AIIDE 2005, section on WHCA*): robots
//! plan one after the other, each around the motions of those before it, for the next few seconds;
//! beyond the window the travel distance to the goal counts, as if alone.

use std::collections::BinaryHeap;
use std::collections::hash_map::{Entry, HashMap};

use crate::floor::{Point, distance};
use crate::lattice::Lattice;
use crate::open_list::Open;
use crate::travel::Distances;

/// Another robot's announced motion: positions every `period_s`, the last one for ever.
pub struct Motion {
    /// Positions at times 0, period, 2 period, ...
    pub positions: Vec<Point>,
    /// Distance to be kept between the two centres [m].
    pub apart_m: f64,
}

/// Parameters of the search.
#[derive(Clone, Copy)]
pub struct Window {
    /// Speed of the planning robot [m/s].
    pub speed_m_s: f64,
    /// Time between the positions of the motions [s].
    pub period_s: f64,
    /// How far ahead is planned [s].
    pub horizon_s: f64,
    /// Most states to expand before giving up.
    pub expansions: usize,
}

/// A position at a time after the start [s].
pub type TimedPoint = (f64, Point);

/// More than rounding makes of a position in a box.
const BOX_GAP_M: f64 = 1e-6;

struct State {
    node: usize,
    time_s: f64,
    cost: f64,
    parent: usize,
}

/// Plans from `start` towards the goals of `distances`; None if every motion ends in a conflict.
///
/// Waiting at a goal is free, elsewhere time costs; driving costs a little more than waiting, so that
/// a robot that has to let somebody pass does not wander.
pub fn timed_route(
    lattice: &Lattice<'_>,
    distances: &Distances,
    start: Point,
    motions: &[Motion],
    window: Window,
) -> Option<Vec<TimedPoint>> {
    let first = lattice.snap(start)?;
    let step_s = lattice.spacing_m() / window.speed_m_s;
    // Whoever already is too near may stay as near, but no nearer.
    let apart: Vec<f64> = motions
        .iter()
        .map(|motion| {
            let now = distance(start, motion.positions[0]);
            let at_node = distance(lattice.position(first), motion.positions[0]);
            motion.apart_m.min(now.min(at_node) - 1e-3)
        })
        .collect();
    let boxes: Vec<[Point; 2]> = motions.iter().map(bounding_box).collect();
    let conflicts = |from: Point, to: Point, begin_s: f64, duration_s: f64| {
        let near = motions.iter().zip(&apart).zip(&boxes);
        near.into_iter().any(|((motion, &apart), &[low, high])| {
            let is_far = (0..2).any(|axis| {
                from[axis].max(to[axis]) < low[axis] - apart - BOX_GAP_M
                    || from[axis].min(to[axis]) > high[axis] + apart + BOX_GAP_M
            });
            if is_far {
                return false;
            }
            let checks = (duration_s / 0.2).ceil().max(1.0) as usize;
            (1..=checks).any(|check| {
                let ratio = check as f64 / checks as f64;
                let mine = [
                    from[0] + ratio * (to[0] - from[0]),
                    from[1] + ratio * (to[1] - from[1]),
                ];
                let other = position_at(motion, begin_s + ratio * duration_s, window.period_s);
                distance(mine, other) < apart
            })
        })
    };
    let rest = |node: usize| distances.at(node) / window.speed_m_s;
    let mut states = vec![State {
        node: first,
        time_s: 0.0,
        cost: 0.0,
        parent: 0,
    }];
    let mut best: HashMap<(usize, usize), f64> = HashMap::new();
    let mut open = BinaryHeap::new();
    open.push(Open {
        key: rest(first),
        id: 0,
    });
    let mut expansions = 0;
    while let Some(Open { id: state, .. }) = open.pop() {
        let (node, time_s, cost) = (states[state].node, states[state].time_s, states[state].cost);
        if time_s >= window.horizon_s {
            return Some(backtrack(&states, state, lattice, start));
        }
        let slot = |node: usize, time_s: f64| (node, (time_s / step_s + 0.25) as usize);
        if best.get(&slot(node, time_s)).is_some_and(|&b| b < cost) {
            continue;
        }
        expansions += 1;
        if expansions > window.expansions {
            return None;
        }
        let here = lattice.position(node);
        let mut reach = |next: usize, duration_s: f64, price: f64| {
            let there = lattice.position(next);
            if conflicts(here, there, time_s, duration_s) {
                return;
            }
            let (time_s, cost) = (time_s + duration_s, cost + price);
            match best.entry(slot(next, time_s)) {
                Entry::Occupied(known) if *known.get() <= cost + 1e-9 => return,
                Entry::Occupied(mut known) => *known.get_mut() = cost,
                Entry::Vacant(place) => {
                    place.insert(cost);
                }
            }
            states.push(State {
                node: next,
                time_s,
                cost,
                parent: state,
            });
            open.push(Open {
                key: cost + rest(next),
                id: states.len() - 1,
            });
        };
        let at_goal = distances.at(node) <= 0.0;
        reach(node, step_s, if at_goal { 0.0 } else { step_s });
        lattice.for_each_neighbour(node, |neighbour, length| {
            let duration_s = length / window.speed_m_s;
            reach(neighbour, duration_s, 1.05 * duration_s);
        });
    }
    None
}

/// Lower left and upper right corner of all positions of a motion.
fn bounding_box(motion: &Motion) -> [Point; 2] {
    motion.positions.iter().fold(
        [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]],
        |[low, high], at| {
            [
                [low[0].min(at[0]), low[1].min(at[1])],
                [high[0].max(at[0]), high[1].max(at[1])],
            ]
        },
    )
}

fn position_at(motion: &Motion, time_s: f64, period_s: f64) -> Point {
    let last = motion.positions.len() - 1;
    let place = (time_s / period_s).max(0.0);
    let index = (place as usize).min(last);
    let next = (index + 1).min(last);
    let ratio = (place - index as f64).min(1.0);
    let (a, b) = (motion.positions[index], motion.positions[next]);
    [a[0] + ratio * (b[0] - a[0]), a[1] + ratio * (b[1] - a[1])]
}

fn backtrack(
    states: &[State],
    last: usize,
    lattice: &Lattice<'_>,
    start: Point,
) -> Vec<TimedPoint> {
    let mut points = Vec::new();
    let mut at = last;
    while at != 0 {
        points.push((states[at].time_s, lattice.position(states[at].node)));
        at = states[at].parent;
    }
    points.push((0.0, start));
    points.reverse();
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::floor::tests::drawn;
    use crate::lattice::Body;

    /// A corridor, one robot wide, with a niche above its middle.
    const NICHE: [&str; 9] = [
        "##############################",
        "#############....#############",
        "#############....#############",
        "#############....#############",
        "#............................#",
        "#............................#",
        "#............................#",
        "##############################",
        "##############################",
    ];

    fn window() -> Window {
        Window {
            speed_m_s: 1.0,
            period_s: 0.2,
            horizon_s: 12.0,
            expansions: 200_000,
        }
    }

    #[test]
    fn the_niche_lets_an_oncoming_robot_pass() {
        let floor = drawn(&NICHE, 0.2);
        let body = Body {
            radius_m: 0.25,
            margin_m: 0.03,
            comfort_m: 0.1,
            blockades: &[],
            discs: &[],
        };
        let lattice = Lattice::new(&floor, body);
        let goal = [5.3, 0.7];
        let start = [1.3, 0.7];
        let distances = lattice.distances(&[goal], lattice.snap(start).unwrap(), 12.0);
        let oncoming = Motion {
            positions: (0..26)
                .map(|k| [(5.5 - 0.2 * f64::from(k)).max(0.5), 0.7])
                .collect(),
            apart_m: 0.55,
        };
        let route = timed_route(&lattice, &distances, start, &[oncoming], window()).unwrap();
        assert!(route.iter().any(|(_, p)| p[1] > 1.0), "into the niche");
        assert_eq!(
            route.last().unwrap().1,
            floor.centre(26, 3),
            "then to the goal"
        );
        for (time_s, position) in &route {
            let other = [(5.5 - time_s).max(0.5), 0.7];
            assert!(distance(*position, other) >= 0.54, "{time_s}: {position:?}");
        }
    }

    #[test]
    fn a_dead_end_has_no_way_out() {
        let floor = drawn(
            &[
                "############",
                "#..........#",
                "#..........#",
                "#..........#",
                "############",
            ],
            0.2,
        );
        let body = Body {
            radius_m: 0.25,
            margin_m: 0.03,
            comfort_m: 0.1,
            blockades: &[],
            discs: &[],
        };
        let lattice = Lattice::new(&floor, body);
        let distances = lattice.distances(&[[0.5, 0.5]], lattice.snap([0.5, 0.5]).unwrap(), 5.0);
        let oncoming = Motion {
            positions: (0..20).map(|k| [2.0 - 0.1 * f64::from(k), 0.5]).collect(),
            apart_m: 0.55,
        };
        assert!(timed_route(&lattice, &distances, [0.5, 0.5], &[oncoming], window()).is_none());
    }
}
