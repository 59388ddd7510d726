//! What holds a body and loads it: sides, points, planes of symmetry and sectors, their reactions, and rigid motion.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

#[macro_use]
#[path = "../common/body.rs"]
mod body;
#[path = "../common/at_rest.rs"]
mod at_rest;
#[path = "../common/mod.rs"]
mod common;

mod boundary;
mod cyclic;
mod dimensions;
mod far;
mod loads;
mod moments;
mod points;
mod reactions;
mod rigid_meets;
mod rigid_motion;
mod rigid_parts;
mod rollers;
