//! Constants of (2.12)–(2.15) on a mesh, as extreme eigenvalues of assembled forms.
//!
//! | constant | inequality | eigenvalue |
//! |---|---|---|
//! | c_k | ‖ε(v)‖ ≥ c_k ‖v‖_{H₁}, ‖v‖²_{H₁} = ‖v‖² + ‖ε(v)‖² | c_k² = 1/(1 + μ), μ = sup ‖v‖²/‖ε(v)‖² |
//! | c_f | ‖∇η‖ ≥ c_f ‖η‖_{H¹}, ‖η‖²_{H¹} = ‖η‖² + ‖∇η‖² | c_f² = 1/(1 + μ), μ = sup ‖η‖²/‖∇η‖² |
//! | s₁ | ‖v‖_{L²(Γ_C)} ≤ s₁ ‖ε(v)‖ | s₁² = sup ∫_{Γ_C} ‖v‖² / ‖ε(v)‖² |
//! | s₂ | ‖η‖_{L²(Γ_C)} ≤ s₂ ‖∇η‖ | s₂² = sup ∫_{Γ_C} η² / ‖∇η‖² |
//!
//! The suprema are taken over V^h and Q^h. If the mesh fills Ω, these are subspaces of V and Q, and **c^h ≥ c and s^h ≤
//! s**; curved sides are approximated, and the inequalities need not hold. Under refinement both tend to the constants
//! of the domain. Statements on the discrete problem use the constants on its own mesh; statements on Ω need their
//! limit.
//!
//! With the contact unknowns last, the factor gives the least energy of a trace, x·Sx, so that the suprema over Γ_C are
//! eigenvalues of the mass matrix of the trace against the condensed operator S: exact, without the interior.

use std::sync::Arc;

use serde::Serialize;

use crate::element::ShapeTable;
use crate::forms;
use crate::linalg::{
    Backend, BlockMatrix, Eigenpair, Entry, Graph, Layout, Pencil, Quotient, SolveError, System, Unknowns, dot, join,
    largest,
};
use crate::material::{Isotropic, StressState};
use crate::mesh::{FacetMap, FacetSet, Mesh};
use crate::problem::Problem;
use crate::space::Space;
use crate::tensor::{self, Point, Sym};

/// A constant on the mesh with a bound of its algebraic error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Constant {
    /// The constant.
    pub value: f64,
    /// Bound of the distance to the constant of the discrete spaces: the residual of the eigenvector and the round-off
    /// seen in its quotient.
    pub error: f64,
}

impl Constant {
    /// 1/√(1 + μ).
    fn of_norm(pair: &Eigenpair) -> Constant {
        let value = 1.0 / (1.0 + pair.value).sqrt();
        Constant { value, error: 0.5 * pair.error * value.powi(3) }
    }

    /// √μ.
    fn of_trace(pair: &Eigenpair) -> Constant {
        let value = pair.value.sqrt();
        Constant { value, error: if value > 0.0 { pair.error / value } else { 0.0 } }
    }
}

/// The constants of (2.12)–(2.15) for V^h and Q^h with their prescribed values set to zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DomainConstants {
    /// Korn's constant of (2.12); `None` if a part of the body is held by no prescribed displacement.
    pub c_k: Option<Constant>,
    /// The constant of Friedrichs and Poincaré of (2.13); `None` if a part of the body has no prescribed temperature.
    pub c_f: Option<Constant>,
    /// s₁ of (2.14) in √m; `None` without contact or without c_k.
    pub s1: Option<Constant>,
    /// The least s with ‖v_ν‖_{L²(Γ_C)} ≤ s ‖ε(v)‖, √m.
    pub s1_normal: Option<Constant>,
    /// The least s with ‖v_τ‖_{L²(Γ_C)} ≤ s ‖ε(v)‖, √m.
    pub s1_tangential: Option<Constant>,
    /// s₂ of (2.15) in √m; `None` without contact or without c_f.
    pub s2: Option<Constant>,
}

impl DomainConstants {
    /// The constants with their names: `c_k c_f s1 s1_normal s1_tangential s2`.
    #[must_use]
    pub fn named(&self) -> [(&'static str, Option<Constant>); 6] {
        [
            ("c_k", self.c_k),
            ("c_f", self.c_f),
            ("s1", self.s1),
            ("s1_normal", self.s1_normal),
            ("s1_tangential", self.s1_tangential),
            ("s2", self.s2),
        ]
    }
}

/// Computes the constants on the mesh of a problem. They depend only on the mesh, Γ_D, Γ_C and the sides of prescribed
/// temperature.
///
/// # Errors
/// Fails if a matrix does not fit into memory, or if the prescribed displacements allow a motion without strain.
pub fn domain_constants(problem: &Problem) -> Result<DomainConstants, SolveError> {
    let graph = Arc::new(Graph::of_mesh(&problem.mesh));
    constants_on(problem, &forms::inner_h(&problem.mesh, &graph))
}

/// [`domain_constants`] of a problem whose form (·, ·)_{L²} is given.
pub(super) fn constants_on(problem: &Problem, mass: &BlockMatrix) -> Result<DomainConstants, SolveError> {
    let (mesh, graph) = (&*problem.mesh, mass.graph());
    let contact = problem.contact_facets();
    let on = Domain { mesh, mass, contact: contact.as_ref(), backend: &problem.backend };
    let mechanics = || {
        let v = problem.displacement_space();
        // (ε(u), ε(v)) is the form a of the identity.
        let strain =
            || forms::a(mesh, graph, &[&Isotropic::lame(mesh.tensor_dim(), 0.0, 1.0, StressState::PlaneStress).into()]);
        constants_of(&on, &v, strain, [TracePart::Whole, TracePart::Normal, TracePart::Tangential])
    };
    let heat = || {
        let q = problem.temperature_space();
        let gradient = || forms::d(mesh, graph, &[&Sym::identity(mesh.dim)]);
        constants_of(&on, &q, gradient, [TracePart::Whole])
    };
    let (mechanics, heat) = join(problem.backend.is_collective(), mechanics, heat);
    let ((c_k, [s1, s1_normal, s1_tangential]), (c_f, [s2])) = (mechanics?, heat?);
    Ok(DomainConstants { c_k, c_f, s1, s1_normal, s1_tangential, s2 })
}

/// The part of a trace that is measured.
#[derive(Clone, Copy)]
enum TracePart {
    Whole,
    Normal,
    Tangential,
}

/// The data from which the constants of both spaces are computed.
struct Domain<'a> {
    mesh: &'a Mesh,
    mass: &'a BlockMatrix,
    contact: Option<&'a FacetSet>,
    backend: &'a Arc<dyn Backend>,
}

/// The constant of the norm and those of the parts of the trace; `None` if the space contains constants or rigid
/// motions.
fn constants_of<const N: usize>(
    on: &Domain,
    space: &Space,
    energy: impl FnOnce() -> BlockMatrix,
    parts: [TracePart; N],
) -> Result<(Option<Constant>, [Option<Constant>; N]), SolveError> {
    if !is_held(on.mass.graph(), space) {
        return Ok((None, [None; N]));
    }
    let energy = Arc::new(energy());
    let nodes = on.contact.map(FacetSet::node_list).unwrap_or_default();
    let mut system = System::new(on.backend, &energy, &Layout::of(on.mesh, space, &nodes))?;
    let mut whole = Quotient { numerator: on.mass, denominator: &energy, system: &mut system };
    let norm = largest(&mut whole)?;
    let mut traces = [None; N];
    for (trace, part) in traces.iter_mut().zip(parts) {
        let Some(contact) = on.contact else { continue };
        let entries = trace_mass(on.mesh, contact, whole.system.unknowns(), space.components, part);
        *trace = Some(Constant::of_trace(&trace_pair(&mut whole, entries)?));
    }
    Ok((Some(Constant::of_norm(&norm)), traces))
}

/// The largest eigenvalue of a form on Γ_C over the energy of the body.
fn trace_pair(whole: &mut Quotient, entries: Vec<Entry>) -> Result<Eigenpair, SolveError> {
    let mut on_contact = TraceQuotient { entries, system: &mut *whole.system };
    let mut pair = largest(&mut on_contact)?;
    let trace = dot(&pair.vector, &on_contact.numerator(&pair.vector));
    if trace > 0.0 {
        // Uses the energy of the body instead of x·Sx: S carries the round-off of the elimination.
        let body = whole.system.extend(&pair.vector)?;
        let quotient = trace / dot(&body, &whole.denominator(&body)?);
        pair.error += (quotient - pair.value).abs();
        pair.value = quotient;
    }
    Ok(pair)
}

/// True if every node is connected by cells to a node with a prescribed value.
fn is_held(graph: &Graph, space: &Space) -> bool {
    let mut reached: Vec<bool> =
        (0..graph.len() as u32).map(|node| space.held_directions(node).next().is_some()).collect();
    let mut open: Vec<usize> = (0..reached.len()).filter(|&i| reached[i]).collect();
    while let Some(i) = open.pop() {
        for &j in graph.row(i) {
            if !std::mem::replace(&mut reached[j as usize], true) {
                open.push(j as usize);
            }
        }
    }
    reached.iter().all(|&r| r)
}

/// Entries of ∫_{Γ_C} of the product of two traces, on the contact unknowns in elimination order.
fn trace_mass(mesh: &Mesh, contact: &FacetSet, unknowns: &Unknowns, components: usize, part: TracePart) -> Vec<Entry> {
    let position = unknowns.positions(mesh.points.len() * components);
    let mut entries = Vec::new();
    let tables: Vec<ShapeTable> =
        contact.blocks.iter().map(|block| ShapeTable::new(block.element, 2 * block.element.degree)).collect();
    let maps = contact.blocks.iter().zip(&tables).flat_map(|(block, table)| {
        let mut map = FacetMap::new(mesh, table);
        block.nodes.chunks_exact(block.element.nodes.len()).map(move |facet| {
            let points = table.weights.iter().enumerate().map(|(q, weight)| {
                map.at(facet, q);
                (weight * map.area, map.normal, map.values())
            });
            (facet, points.collect::<Vec<_>>())
        })
    });
    for (facet, points) in maps {
        let dofs: Vec<(usize, Point, u32)> = (0..facet.len())
            .flat_map(|n| (0..components).map(move |c| (n, c)))
            .filter_map(|(n, c)| {
                let unknown = position[facet[n] as usize * components + c]?;
                Some((n, unknowns.directions(facet[n])[c], unknown))
            })
            .collect();
        let mut block = vec![0.0; dofs.len() * dofs.len()];
        for (weight, normal, values) in points {
            let product = |r: &Point, c: &Point| {
                let (whole, along) = (tensor::dot(r, c), tensor::dot(r, &normal) * tensor::dot(c, &normal));
                match part {
                    TracePart::Whole => whole,
                    TracePart::Normal => along,
                    TracePart::Tangential => whole - along,
                }
            };
            for (a, (i, r, _)) in dofs.iter().enumerate() {
                for (b, (j, c, _)) in dofs.iter().enumerate() {
                    block[a * dofs.len() + b] += weight * values[*i] * values[*j] * product(r, c);
                }
            }
        }
        for (a, &(.., row)) in dofs.iter().enumerate() {
            entries.extend(dofs.iter().enumerate().map(|(b, &(.., column))| (row, column, block[a * dofs.len() + b])));
        }
    }
    entries
}

/// The quotient of a form on Γ_C and the least energy with the given trace.
pub(super) struct TraceQuotient<'a> {
    pub entries: Vec<Entry>,
    pub system: &'a mut System,
}

impl Pencil for TraceQuotient<'_> {
    fn size(&self) -> usize {
        self.system.condensed().len()
    }
    fn numerator(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        for &(i, j, value) in &self.entries {
            y[i as usize] += value * x[j as usize];
        }
        y
    }
    fn denominator(&self, x: &[f64]) -> Result<Vec<f64>, SolveError> {
        self.system.condensed().apply(x)
    }
    fn solve(&mut self, r: &mut [f64], enough: f64) -> Result<(), SolveError> {
        self.system.solve_condensed(r, enough)
    }
    fn has_factor(&self) -> bool {
        self.system.is_direct()
    }
}
