//! What holds between the crates: closed-form truths, numerical hard cases, agreement of the indexes,
//! determinism. Beside each robustness test stands the naive variant that it catches, so that the test
//! is known to be able to fail.
#![allow(missing_docs)]

mod agreement;
mod boxes;
mod determinism;
mod hard_cases;
mod hostile_files;
mod leaving;
mod meshes;
mod mutator;
mod optics;
mod random;
mod spheres;
mod subdivisions;
mod watertight;
mod whitted;
