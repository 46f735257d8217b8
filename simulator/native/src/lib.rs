//! Ray casting and mapping kernels of marsupial (module simulator._core).

pub mod octree;

#[cfg(feature = "python")]
mod python;
