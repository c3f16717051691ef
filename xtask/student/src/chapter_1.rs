//! A student's program of chapter 1: what `cargo xtask exercise` has written for it.

// A function half written has unused variables.
#![allow(unused)]

mod limits;

include!(env!("LANCER_PROGRAM"));
