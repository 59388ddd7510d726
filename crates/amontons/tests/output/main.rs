//! What a run gives: fields, probes and pictures.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

#[macro_use]
#[path = "../common/body.rs"]
mod body;
#[path = "../common/at_rest.rs"]
mod at_rest;
#[path = "../common/mod.rs"]
mod common;

mod contact_probes;
mod fields;
mod plot;
mod plot_damage;
mod plot_space;
mod plot_truth;
mod probes;
