//! Kernels of SLAM: scoring scans in likelihood fields, correlative scan matching.

pub mod correlative;
pub mod likelihood_field;
