//! Grid path costs of marsupial (module `semantic_attachments._core`).
//!
//! ```text
//! inflation ──► traversability ──► one_to_all ──► field ──► legs ──► line_of_sight
//! (obstacles,    (moves; blockades   (canonical,    (distances,  (places,   (way points)
//!  by radius)     drawn and opened)   or weighted)   paths)       reach)
//!                                        repair (of a field on a changed map)
//! ```
//!
//! `reach` finds a goal behind one more opened blockade; `any_angle` is the other kind of field, and `footprint` is for
//! robots that are no discs.
//!
//! Distances are in cells; row 0 is the bottom of the map and an index is `row * width + column`.

pub mod any_angle;
pub mod buckets;
pub mod canonical;
pub mod distance_transform;
pub mod field;
pub mod footprint;
pub mod geodesic;
pub mod inflation;
pub mod lazy_graph;
pub mod legs;
pub mod length;
pub mod line_of_sight;
pub mod moves;
pub mod octile;
pub mod one_to_all;
pub mod reach;
pub mod repair;
pub mod shape;
pub mod skeleton;
pub mod traversability;
pub mod weighted;

#[cfg(feature = "python")]
mod python;
