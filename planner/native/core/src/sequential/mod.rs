//! Plans of one action after the other, for tasks in which the first plan is the difficulty.
//!
//! ```text
//! compression   every operator becomes one instantaneous step (start, over all and end together)
//! epoch::search best-first search on the compressed task, whose states have no clock
//! width         the same by novelty (novelty.rs) in place of a heuristic
//! symmetry      states that differ only by interchangeable objects count once
//! timing        the steps found, run one after the other in the real task
//! ```
//!
//! Searching without a clock meets each state once, which solves puzzles with long plans; the list
//! schedules then overlap what can overlap. Source of the idea: Eyerich, Mattmüller, Röger, ICAPS
//! 2009, and Vidal, "YAHSP3", IPC 2014, both reschedule sequential plans.

pub mod compression;
pub mod novelty;
pub mod symmetry;
pub mod timing;
pub mod width;
