//! The snapshots of a run, and their fields recomputed from displacement, velocity and temperature.

use super::tables::NumberTable;
use super::{Differences, ROUND_OFF};
use crate::discretization::Discretization;
use crate::inclusion::Multipliers;
use crate::linalg::dot;
use crate::material::VTK_COMPONENTS;
use crate::mesh::Block;
use crate::output::{PointValues, StoredFields, cell_values, columns};
use crate::problem::Problem;
use crate::state::{Accumulated, Carried, Counts, Ledger, State};
use crate::tensor::Sym;
use crate::time::Pace;
use crate::vtu::{Array, Grid};

/// The fields of a snapshot.
pub(super) struct Fields {
    grid: Grid,
    dim: usize,
}

impl Fields {
    /// Reads the snapshot at a step on the mesh of a problem.
    ///
    /// # Errors
    /// The fault of the file.
    pub fn read(stored: &StoredFields, step: usize, problem: &Problem) -> Result<Fields, String> {
        let grid = stored.grid(step)?;
        let mesh = &problem.mesh;
        let same = grid.points.len() == mesh.points.len()
            && grid.points.iter().zip(&mesh.points).all(|(a, b)| a.map(f64::to_bits) == b.map(f64::to_bits));
        if !same {
            return Err("its points are not those of the mesh".to_owned());
        }
        let cells = mesh.blocks.iter().flat_map(Block::vtk_cells);
        if grid.ends.len() != mesh.cell_count() || !grid.cells().zip(cells).all(|(a, b)| a == b) {
            return Err("its cells are not those of the mesh".to_owned());
        }
        Ok(Fields { grid, dim: mesh.dim })
    }

    /// A nodal vector field, node-major.
    fn vector(&self, name: &str) -> Option<Vec<f64>> {
        let array = self.grid.point_data.get(name).filter(|array| array.components == 3)?;
        Some(array.values.chunks_exact(3).flat_map(|v| v[..self.dim].to_vec()).collect())
    }

    fn scalar(&self, name: &str) -> Option<&[f64]> {
        self.grid.point_data.get(name).filter(|array| array.components == 1).map(|array| array.values.as_slice())
    }

    /// Writes the fields into a state, and reports their differences from the former values.
    pub fn put(&self, problem: &Problem, state: &mut State, tell: &mut dyn FnMut(&str, f64, f64)) {
        let mut take = |name: &str, into: &mut Vec<f64>, from: Option<Vec<f64>>| {
            let from = from.filter(|from| from.len() == into.len());
            let difference = from.as_ref().map_or(f64::NAN, |from| largest_difference(from, into));
            tell(name, difference, into.iter().fold(0.0f64, |m, v| m.max(v.abs())));
            if let Some(from) = from {
                *into = from;
            }
        };
        if problem.physics.has_mechanics() {
            take("displacement", &mut state.u, self.vector("displacement"));
            take("velocity", &mut state.w, self.vector("velocity"));
        }
        if problem.physics.has_temperature() {
            take("temperature", &mut state.theta, self.scalar("temperature").map(<[f64]>::to_vec));
        }
    }

    /// A state with these fields; all else is zero.
    fn state(&self, discretization: &Discretization, problem: &Problem) -> State {
        let nodes = problem.mesh.points.len();
        let zero = || vec![0.0; nodes * self.dim];
        State {
            u: self.vector("displacement").unwrap_or_else(zero),
            w: self.vector("velocity").unwrap_or_else(zero),
            theta: self.scalar("temperature").map_or_else(|| vec![0.0; nodes], <[f64]>::to_vec),
            theta_rate: Vec::new(),
            earlier: None,
            settling: 0,
            step: 0,
            t: 0.0,
            multipliers: Multipliers::default(),
            branches: discretization.branches.iter().map(|branch| vec![0.0; branch.size(nodes * self.dim)]).collect(),
            carried: Carried::default(),
            surface: Accumulated::default(),
            ledger: Ledger::default(),
            counts: Counts::default(),
            temperatures: [0.0; 2],
            released: Vec::new(),
            pace: Pace::default(),
            coarse: None,
        }
    }

    /// Compares the cell values with those computed from displacement, velocity and temperature.
    pub fn differences(&self, discretization: &Discretization, problem: &Problem, found: &mut Differences) {
        let state = self.state(discretization, problem);
        // Relaxing branches have an additional stress, which no field contains.
        let relaxes = !discretization.branches.is_empty();
        let values = cell_values(problem, &state);
        let tensor = |of: fn(&PointValues) -> Sym| -> Vec<f64> {
            values.iter().flat_map(|v| VTK_COMPONENTS.map(|(i, j)| of(v).get(i, j))).collect()
        };
        let mut known: Vec<(&str, Vec<f64>)> =
            vec![("strain", tensor(|v| v.strain)), ("heat_flux", values.iter().flat_map(|v| v.heat_flux).collect())];
        if !relaxes {
            known.push(("stress", tensor(|v| v.stress)));
            known.push(("von_mises", values.iter().map(|v| v.stress.von_mises()).collect()));
        }
        for (name, computed) in known {
            let Some(Array { values, .. }) = self.grid.cell_data.get(name) else { continue };
            let size = computed.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            let difference =
                if values.len() == computed.len() { largest_difference(values, &computed) } else { f64::NAN };
            found.note(format!("{name} of the cells against the nodes"), difference, size);
        }
    }

    /// Compares energies of the fields with the row of their step.
    pub fn energies(
        &self,
        discretization: &Discretization,
        problem: &Problem,
        (history, row): (&NumberTable, usize),
        found: &mut Differences,
    ) {
        let state = self.state(discretization, problem);
        let mut note = |name: &str, computed: f64, size: f64| {
            if let Some(told) = history.value(row, name) {
                found.note(format!("{name} of the fields against history.csv"), computed - told, size.max(told.abs()));
            }
        };
        if problem.physics.has_mechanics() {
            let (rho, inertia) = discretization.inertia();
            // The time as it is written may be round-off late.
            let t = history.value(row, "t").unwrap_or(0.0) * (1.0 - ROUND_OFF);
            let phase = problem.timeline.phases().nth(problem.timeline.phase_at(t));
            let acts = phase.is_none_or(|phase| phase.analysis.has_inertia());
            let kinetic = if acts { 0.5 * rho * dot(&state.w, &inertia.apply(&state.w)) } else { 0.0 };
            note(columns::KINETIC.name, kinetic, kinetic.abs());
            let elastic =
                discretization.stored_energy(&state.u, &state.theta).filter(|_| discretization.branches.is_empty());
            if let Some(elastic) = elastic {
                // A body that moves as a whole has terms that cancel.
                let sizes = discretization.elastic_sizes(&state.u, &state.theta);
                let size = 0.5 * state.u.iter().zip(sizes).map(|(u, size)| u.abs() * size).sum::<f64>();
                note(columns::ELASTIC.name, elastic, size);
            }
        }
        if problem.physics.has_heat() {
            let (c, storage) = discretization.storage();
            let content = c * discretization.stored_heat(&state.theta).iter().sum::<f64>();
            let size = c * storage.magnitude(&state.theta).iter().sum::<f64>();
            note(columns::HEAT_CONTENT.name, content, size);
        }
    }
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, |m, d| if d > m || d.is_nan() { d } else { m })
}
