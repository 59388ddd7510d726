//! Case files: what they may say, what it comes to, and the exact message about each fault.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../common/mod.rs"]
mod common;

mod acting;
mod bodies;
mod boundary;
mod conditions;
mod faults;
mod files;
mod graded_faults;
mod materials;
mod phases;
mod quantities;
mod reference;
mod sides;
mod thermal_faults;
mod valid;
