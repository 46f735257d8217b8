//! Grid path costs of marsupial (module `semantic_attachments._core`).
//!
//! ```text
//! obstacles ──► traversability ──► one_to_all ──► path ──► line of sight
//! (inflation     (blockades drawn    (field of       (cells)    (way points)
//!  by radius)     and opened)         distances)
//!                                        └──► reach (a goal behind one more opened blockade)
//! ```
//!
//! Distances are in cells; row 0 is the bottom of the map and an index is `row * width + column`.

pub mod any_angle;
pub mod footprint;
pub mod inflation;
pub mod line_of_sight;
pub mod moves;
pub mod one_to_all;
pub mod reach;
pub mod shape;
pub mod traversability;

#[cfg(feature = "python")]
mod python;
