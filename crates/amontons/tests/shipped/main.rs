//! What is shipped: guide, documents, sources and examples keep their word, cases and benchmarks their values.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../common/mod.rs"]
mod common;

mod adding;
mod book;
mod brake_disc;
mod brake_pad;
mod elmer;
mod examples;
mod expected;
mod layers;
mod names;
mod paper_reference;
mod papers;
mod verify;
