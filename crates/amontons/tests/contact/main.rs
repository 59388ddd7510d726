//! The contact of a body with a foundation: its laws, their limits, friction, heat, wear and impact.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

#[macro_use]
#[path = "../common/body.rs"]
mod body;
#[path = "../common/column.rs"]
mod column;
#[path = "../common/mod.rs"]
mod common;

mod energy;
mod facets;
mod features;
mod fluid;
mod foundations;
mod gap_pressure;
mod halved_steps;
mod hot_friction;
mod impact;
mod laws;
mod limits;
mod pressed;
mod several;
mod shapes;
mod sliding_out;
mod snapping;
mod softening;
mod stepping;
mod stuck_indentation;
mod tools;
