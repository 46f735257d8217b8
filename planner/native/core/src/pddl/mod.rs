//! The typed model of a domain and a problem, and the reader that fills it.

pub mod model;
