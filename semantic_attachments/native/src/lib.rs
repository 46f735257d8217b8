//! Grid path costs of marsupial (module semantic_attachments._core).

#[cfg(feature = "python")]
mod python;
