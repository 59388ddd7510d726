//! The certificate: its verdicts, its constants, and the condition under which a step has one solution.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../common/mod.rs"]
mod common;

mod certificate;
mod constants;
mod step_eigenvalue;
mod step_solutions;
mod verdicts;
