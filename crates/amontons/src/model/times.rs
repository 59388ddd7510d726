//! Time scales of a model: vibration, heating and relaxation.

use std::f64::consts::TAU;
use std::sync::Arc;

use serde::Serialize;

use super::supports::{holds_temperature, rigid_motions};
use crate::field::Coefficient;
use crate::forms;
use crate::linalg::{BlockMatrix, Graph, Layout, Quotient, System, join, largest};
use crate::material::{Branch, Material};
use crate::mesh::defects::components;
use crate::problem::Problem;
use crate::space::Space;

/// Time scales of the body without contact, s.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Times {
    /// Longest period of the body at rest on its supports and springs: 2π √(sup (ρv, v)/a(v, v)). `None` if the density
    /// is zero or the body is not held.
    pub first_period: Option<f64>,
    /// Time in which the slowest temperature decays by 1/e: sup (cη, η)/d(η, η), including convection. `None` if heat
    /// is steady or no side holds the temperature.
    pub heat: Option<f64>,
    /// Least and largest ratio of viscosity to elasticity, the time in which a Kelvin–Voigt body follows its load.
    /// `None` without viscosity.
    pub retardation: Option<[f64; 2]>,
    /// Relaxation times of the branches; the least and the largest for a branch that varies over the body.
    pub relaxation: Vec<f64>,
}

impl Times {
    /// The time scales of a problem.
    pub(super) fn new(problem: &Problem) -> Times {
        let graph = Arc::new(Graph::of_mesh(&problem.mesh));
        let parts = components(&problem.mesh);
        // A singular form may still have a factor by round-off.
        let held = rigid_motions(problem, &parts).iter().all(|motions| *motions == 0);
        let (first_period, heat) = join(
            problem.backend.is_collective(),
            || held.then(|| period(problem, &graph)).flatten(),
            || holds_temperature(problem, &parts).then(|| heat(problem, &graph)).flatten(),
        );
        let ratios = problem.materials.iter().flat_map(|m| {
            let (a, b) = (m.elasticity.constants(), m.viscosity.constants());
            [b.monotonicity / a.lipschitz, b.lipschitz / a.monotonicity]
        });
        let retardation = ratios.fold([f64::INFINITY, 0.0f64], |[low, high], ratio| [low.min(ratio), high.max(ratio)]);
        Times {
            first_period,
            heat,
            retardation: (retardation[1] > 0.0).then_some(retardation),
            relaxation: relaxation(problem),
        }
    }
}

fn relaxation(problem: &Problem) -> Vec<f64> {
    let varying = problem.materials.iter().flat_map(Material::varying_branches).flat_map(Branch::times);
    let mut times: Vec<f64> = problem.relaxation_times().into_iter().chain(varying).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

fn period(problem: &Problem, graph: &Arc<Graph>) -> Option<f64> {
    let (mesh, space) = (&*problem.mesh, problem.displacement_space());
    let densities = of_materials(problem, |m| &m.density)?;
    let laws: Vec<_> = problem.materials.iter().map(|m| &m.elasticity).collect();
    let mut stiffness = if laws.iter().all(|law| law.is_linear()) {
        forms::tensor_form(mesh, graph, &laws, &problem.dilatation())
    } else {
        forms::tangent(mesh, graph, &laws, &problem.dilatation(), &vec![0.0; space.free.len()], &[])
    };
    if let Some(springs) = forms::springs(mesh, graph, &problem.boundary) {
        stiffness.add_scaled(1.0, &springs);
    }
    slowest(problem, &space, &forms::weighted_inner_h(mesh, graph, &densities), stiffness).map(|mu| TAU * mu.sqrt())
}

fn heat(problem: &Problem, graph: &Arc<Graph>) -> Option<f64> {
    let mesh = &*problem.mesh;
    let capacities = of_materials(problem, |m| &m.heat_capacity)?;
    let mut conduction = forms::d(mesh, graph, &problem.materials.iter().map(|m| &m.conductivity).collect::<Vec<_>>());
    if let Some(convection) = forms::convection(mesh, graph, &problem.boundary) {
        conduction.add_scaled(1.0, &convection);
    }
    slowest(problem, &problem.temperature_space(), &forms::weighted_inner_h(mesh, graph, &capacities), conduction)
}

/// A coefficient per material; `None` if it is zero in all of them.
fn of_materials(problem: &Problem, of: fn(&Material) -> &Coefficient<f64>) -> Option<Vec<Coefficient<f64>>> {
    let is_positive = problem.values_of(of).iter().any(|sample| sample.value > 0.0);
    is_positive.then(|| problem.materials.iter().map(of).cloned().collect())
}

/// sup (storage x, x)/(energy x, x); `None` if the energy is not positive.
fn slowest(problem: &Problem, space: &Space, storage: &BlockMatrix, energy: BlockMatrix) -> Option<f64> {
    let energy = Arc::new(energy);
    let mut system = System::new(&problem.backend, &energy, &Layout::of(&problem.mesh, space, &[])).ok()?;
    let pair = largest(&mut Quotient { numerator: storage, denominator: &energy, system: &mut system }).ok()?;
    (pair.value > 0.0 && pair.value.is_finite()).then_some(pair.value)
}
