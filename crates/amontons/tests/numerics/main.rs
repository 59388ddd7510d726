//! The numerical method: elements, forms, orders of convergence, Newton's method, the coupling of a step, and backends.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../common/bodies.rs"]
mod bodies;
#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod acting;
mod adaptive;
mod backends;
mod bar;
mod bdf2;
mod bisection;
mod chosen;
mod closed_slopes;
mod condensed;
mod conditions;
mod convergence;
mod coupling;
mod driven;
mod elements;
mod final_values;
mod forms;
mod gradient;
mod identification;
mod iterations;
mod jumps;
mod kinks;
mod layers;
mod majorant;
mod majorant_hexahedra;
mod majorant_parts;
mod majorant_random;
mod manufactured;
mod newton;
mod orders;
mod other_bodies;
mod other_contacts;
mod phases;
mod pyramids;
mod random_cases;
mod redistributed;
mod refinement;
mod revolution;
mod series;
mod slopes;
mod stabilised;
mod stability;
mod steady;
mod theta;
mod thrown;
mod waves;
