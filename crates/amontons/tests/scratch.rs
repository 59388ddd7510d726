#![allow(dead_code, clippy::all, clippy::pedantic, unused)]
#[path = "common/mod.rs"]
mod common;
#[path = "numerics/majorant.rs"]
mod majorant;
