//! The program as it is used: commands, messages and exit codes, cases to start from, studies, sweeps and reports.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod book;
mod decks;
mod hostile;
mod import;
mod included;
mod new;
mod program;
mod readme;
mod report;
mod studies;
mod sweep;
mod tutorial;
