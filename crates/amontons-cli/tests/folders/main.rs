//! Results folders: what a run writes, how it goes on after an interruption, and how changes of it are found.
#![allow(clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

#[path = "../common/mod.rs"]
mod common;

mod fields_format;
mod folder;
mod resume;
mod resume_tool;
mod verify_folder;
