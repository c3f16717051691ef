//! What holds between the crates: closed-form truths, numerical hard cases, agreement of the indexes,
//! determinism. Beside each robustness test stands the naive variant that it catches, so that the test
//! is known to be able to fail.
#![allow(missing_docs)]

mod agreement;
mod boxes;
mod determinism;
mod distributed;
mod effects;
mod hard_cases;
mod hostile_files;
mod irradiance;
mod lamps;
mod leaving;
mod meshes;
mod motion;
mod mutator;
mod optics;
mod paths;
mod random;
mod spheres;
mod statistics;
mod subdivisions;
mod watertight;
mod whitted;
