//! `[[rigid]]`.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Datum;

/// A side or a region that moves as one rigid body, by small rotations, under a given force and moment: a platen, a
/// stiff punch, the head of a bolt.
///
/// It moves as it is pushed. Conditions of other sides, and of `[[boundary]]` with `at`, hold it where they are given
/// at its points: one point in all directions is a hinge.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Rigid {
    /// Name of the side or of the region; of a region all cells are rigid, with the density of their material.
    pub on: String,
    /// Force on it in N, per unit of thickness in two dimensions, one entry per component, numbers or expressions in t;
    /// empty for none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub force: Vec<Datum>,
    /// Moment on it in N m about the place where the force acts: one entry in the plane, counterclockwise, three in
    /// space; empty for none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub moment: Vec<Datum>,
    /// Names of the phases in which force and moment act; without the key they act in all of them. The part is rigid in
    /// all phases.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phases: Option<Vec<String>>,
    /// Where the force acts, coordinates in m; default: the centre of the area of the side, of the volume of the
    /// region.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub at: Vec<f64>,
    /// Whether it keeps its direction, as a platen that is guided or that a plane of symmetry cuts: it moves and does
    /// not turn.
    #[serde(default)]
    pub guided: bool,
}
