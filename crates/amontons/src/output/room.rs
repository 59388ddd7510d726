//! Disk space of the results of a run, estimated before it starts.

use super::{FieldsFormat, OutputField, Snapshot};

/// Bytes of the sides of contact per contact point in a snapshot: 20 numbers at its node, its share of the facets, and
/// the same on the other side of a pair.
const OF_SURFACE: f64 = 2.0 * 32.0 * 8.0 * 4.0 / 3.0;

/// Bytes of the snapshots, checkpoints and rows of a run.
///
/// Snapshots are written as base64, 4 characters per 3 bytes, with a temporary copy of the one being written. Three
/// checkpoints hold the state, velocities, displacements, temperatures and branches. If the snapshots are packed at the
/// end, the packed file exists in addition to them. `snapshots` is the number due, with the packed ones that become
/// separate files before the run continues.
pub(super) fn demand(
    from: &Snapshot,
    fields: &[OutputField],
    format: FieldsFormat,
    snapshots: usize,
    steps: usize,
) -> f64 {
    let problem = from.problem;
    let (mesh, physics) = (&problem.mesh, problem.physics);
    let (nodes, cells) = (mesh.points.len() as f64, mesh.cell_count() as f64);
    let of_cells: usize = mesh.blocks.iter().map(|block| block.len() * block.element.nodes.len()).sum();
    let count = |field: &OutputField| match field {
        _ if !field.is_of(physics) => [0.0; 2],
        OutputField::Stress | OutputField::Strain => [0.0, 6.0],
        OutputField::Principal => [0.0, 12.0],
        OutputField::HeatFlux => [0.0, 3.0],
        OutputField::NodalStress => [6.0, 0.0],
    };
    let [at_nodes, in_cells] = fields.iter().map(count).fold([0.0; 2], |[nodes, cells], [n, c]| [nodes + n, cells + c]);
    let mechanics = if physics.has_mechanics() { [7.0, 1.0] } else { [0.0; 2] };
    let heat = if physics.has_temperature() { 1.0 } else { 0.0 };
    // Positions; and per cell its offset, type and region.
    let numbers = nodes * (3.0 + mechanics[0] + heat + at_nodes) + cells * (mechanics[1] + in_cells);
    let grid = 8.0 * (numbers + of_cells as f64) + 13.0 * cells;
    let points = from.discretization.boundary.points.len() as f64;
    let per_snapshot = grid * 4.0 / 3.0 + points * (300.0 + OF_SURFACE);
    let state = from.state;
    let kept = state.u.len() + state.w.len() + state.theta.len() + state.branches.iter().map(Vec::len).sum::<usize>();
    let checkpoint = 8.0 * kept as f64 + points * 300.0;
    let snapshots = snapshots as f64;
    let packed = if format == FieldsFormat::Vtu { 0.0 } else { snapshots * grid };
    packed + (snapshots + 1.0) * per_snapshot + 3.0 * checkpoint + steps as f64 * 700.0
}
