//! `mesh-quality`: the shape of the cells.

use super::sample::at;
use super::{Finding, FindingId, FindingStatus};
use crate::mesh::Mesh;

/// Quality 2·10/(1 + 10²) of a triangle whose map from the regular one stretches ten times more in one direction than
/// across. Interpolation errors and condition numbers grow by about that factor.
const NEEDED: f64 = 20.0 / 101.0;

/// The finding on the worst cell quality, [`Mesh::worst_quality`].
pub(super) fn cells(mesh: &Mesh) -> Finding {
    let (quality, x) = mesh.worst_quality();
    let holds = quality >= NEEDED;
    let what = if holds { "the cells are well shaped" } else { "slender cells reduce the accuracy" };
    let message = format!("{what}: the worst, about {}, has the quality {quality:.4} (1: regular, 0: flat)", at(&x));
    Finding::new(FindingId::MeshQuality, FindingStatus::of(holds), message, "mesh")
        .numbers(Some(quality), Some(NEEDED))
        .repair("use cells with edges of similar length")
}
