//! Laws of materials: nonlinear ones, branches that relax, coefficients that vary or depend on the temperature, and
//! mechanics or heat alone.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../common/mod.rs"]
mod common;

mod body;
mod given;
mod graded;
mod physics;
mod relaxation;
mod thermal;
