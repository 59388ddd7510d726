//! Pairs of deformable bodies: how they are found, their mortar rows, physics, orders, and what is said of faults.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../common/mod.rs"]
mod common;

mod automatic;
mod faults;
mod field;
mod formulation;
mod heat_alone;
mod loose;
mod manufactured;
mod meaning;
mod mortar;
mod orders;
mod patch;
mod physics;
mod preload;
mod press_fit;
mod scan;
mod stacks;
mod two_bodies;
mod wear;
