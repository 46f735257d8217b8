//! Ray casting and mapping kernels of marsupial (module simulator._core).

#[cfg(feature = "python")]
mod python;
