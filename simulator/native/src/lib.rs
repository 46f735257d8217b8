//! Ray casting, navigation and mapping kernels of marsupial (module simulator._core).

pub mod clearance;
pub mod floor;
pub mod lattice;
pub mod occupancy;
pub mod octree;
mod open_list;
pub mod raycast;
pub mod scene;
pub mod slam;
pub mod timed_route;
pub mod travel;

#[cfg(feature = "python")]
mod python;
