//! The case file: from TOML to a checked [`Problem`](crate::problem::Problem), or all its faults at once.
//!
//! A case passes four gates. The TOML parser reads it. Overrides are set into its text. The document is checked against
//! the JSON Schema of the file, which is derived from the types that mirror it. Conditions on several values are
//! checked while the problem is built. Faults of the later gates are collected, and each is given the place in the
//! file, or the override, where its value comes from.
//!
//! ```
//! use amontons::case::{self, Source};
//!
//! let source = Source::new("starter.toml", case::STARTER);
//! let case = case::parse(&source, &["mesh.n=8".to_owned()])?;
//! assert_eq!(case.problem.mesh.points.len(), 81);
//! # Ok::<(), case::CaseError>(())
//! ```

mod accuracy;
mod automatic;
mod benchmark;
mod blocks;
mod build;
mod check;
mod coefficient;
mod contact;
mod cyclic;
mod data;
mod elasticity;
mod fault;
mod files;
mod gradient;
mod identity;
mod laws;
mod library;
mod loads;
mod loci;
mod material;
mod memory;
mod mesh;
mod nearest;
mod obstacle;
mod overrides;
mod pair;
mod parse;
mod path;
mod phases;
mod physics;
mod place;
mod points;
mod probe;
mod quantity;
mod raw;
mod reference;
mod refine_where;
mod request;
mod rigid;
mod schema;
mod side_facts;
mod side_names;
mod sides;
mod solid;
mod stability;
mod study;
mod syntax;
mod table;
mod text;
mod verify;

pub use fault::{CaseError, CaseFault, FaultPlace, GivenBackend, Source};
pub use files::Files;
pub use gradient::{family, parameter, settings};
pub use library::{KnownMaterial, materials};
pub use parse::{Case, parse, read, source};
pub use reference::{
    GlossaryEntry, Word, explain, json as reference_json, markdown as reference_markdown, reference, similar,
};
pub use request::{AskedAccuracy, ReferenceRequest, StudyRequest, StudyRequestError};
pub use schema::schema;
pub use study::{divided_steps, meshes, study};
pub use verify::{Check, ColumnTake, Comparison, ErrorName, Expected, Verify};

/// A small complete case with every key explained, written by `amontons new`.
pub const STARTER: &str = include_str!("starter.toml");
