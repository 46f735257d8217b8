//! Probabilistic 3D occupancy map (Wurm, chapter 5; Hornung et al., Autonomous Robots 2013).
//!
//! Voxels live in bricks of 8 x 8 x 8, hashed by position. The order of voxels in a brick is the octree's
//! (Morton), so that every octree node of the three lowest levels is a contiguous run; the levels above exist
//! only while a map is pruned for writing or queried at a coarse resolution. Log odds are whole multiples
//! of a quantum, one byte each: with the thesis's constants (0.85, -0.4, -2, 3.5) and a quantum of 0.05 this loses nothing.

pub mod brick;
pub mod files;
pub mod gain;
pub mod insertion;
pub mod key;
pub mod map;
pub mod projection;
pub mod ray;
pub mod sensor_model;
pub mod traversal;
pub mod tree;
