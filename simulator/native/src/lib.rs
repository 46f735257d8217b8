//! Ray casting, navigation and mapping kernels of marsupial (module simulator._core).

pub mod clearance;
pub mod floor;
pub mod lattice;
pub mod raycast;
pub mod timed_route;

pub mod octree;

#[cfg(feature = "python")]
mod python;
