//! Contact of deformable bodies with friction and heat.
//!
//! A thermo-viscoelastic body presses on a foundation, sticks or slides on it by Coulomb's law, and
//! exchanges heat through the contact (equation numbers: Bouallala, Essoufi, Ouafik, 2025):
//!
//! ```text
//! σ = 𝓔ε(u) + 𝓥ε(u̇) − θ𝓜        ρü = Div σ + f₀                      in Ω      (2.1) (2.3)
//! q = −𝓚∇θ                        θ̇ + div q − 𝓡:ε(u) = q₀             in Ω      (2.2) (2.4)
//! −σ_ν = p_ν(u_ν − g)             ‖σ_τ‖ ≤ p_τ(u_ν − g), against u̇_τ    on Γ_C    (2.8) (2.9)
//! q·ν = k_c(u_ν − g) φ_L(θ − θ_F)                                      on Γ_C    (2.10)
//! ```
//!
//! ```
//! use amontons::{case, output::Memory, run::{Settings, run}};
//!
//! let source = case::Source::new("starter.toml", case::STARTER);
//! let case = case::parse(&source, &["mesh.n=[16, 8]".into()])?;
//! let summary = run(&case.problem, &Settings::default(), &mut [&mut Memory::default()])?;
//! println!("largest temperature: {:?} K", summary.last.temperature_max);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`problem::Problem`] holds the data, [`step`] makes the steps, [`output::Sink`]s take the results; laws are
//! the traits of [`material`] and [`contact`], and [`contract`] tests yours.
//!
//! | feature | on by default | holds |
//! |---|---|---|
//! | `case` | yes | the case file and the benchmarks: `case`, `verify` |
//! | `plot` | yes | pictures of results folders: `plot`; needs `case` |

/// The README: its program is a test.
#[cfg(all(doctest, feature = "case"))]
#[doc = include_str!("../README.md")]
pub struct Readme;

mod account;
#[cfg(feature = "case")]
pub mod accuracy;
pub mod adjoint;
pub mod arrays;
#[cfg(feature = "case")]
pub mod case;
pub mod contact;
pub mod contract;
pub mod convergence;
pub mod discretization;
pub mod element;
pub mod equation;
pub mod expression;
pub mod field;
pub mod forms;
pub mod hypotheses;
pub mod identification;
pub mod inclusion;
pub mod linalg;
mod machine;
pub mod majorant;
pub mod mass;
pub mod material;
pub mod mesh;
pub mod model;
pub mod output;
#[cfg(feature = "plot")]
pub mod plot;
pub mod problem;
pub mod pulse;
pub mod quadrature;
pub mod rigid;
pub mod run;
mod separated;
pub mod space;
pub mod stability;
pub mod state;
pub mod step;
pub mod tensor;
pub mod time;
pub mod units;
#[cfg(feature = "case")]
pub mod verify;
mod vtkhdf;
mod vtu;
