//! The forms that two problems have in common: by their data, before one of them is assembled, and by their matrices.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::{Discretization, is_fixed};
use crate::field::{Coefficient, Law};
use crate::forms::Load;
use crate::linalg::{BlockMatrix, Graph};
use crate::material::{Material, TensorLaw};
use crate::mesh::{FacetBlock, FacetSet, Mesh};
use crate::problem::Problem;
use crate::tensor::Sym;

/// A form of the bodies.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum BodyForm {
    Mass,
    A,
    B,
    D,
    M,
    E,
}

impl BodyForm {
    const ALL: [BodyForm; 6] = [BodyForm::Mass, BodyForm::A, BodyForm::B, BodyForm::D, BodyForm::M, BodyForm::E];

    fn of(self, discrete: &Discretization) -> &BlockMatrix {
        match self {
            BodyForm::Mass => &discrete.mass,
            BodyForm::A => &discrete.a,
            BodyForm::B => &discrete.b,
            BodyForm::D => &discrete.d,
            BodyForm::M => &discrete.m,
            BodyForm::E => &discrete.e,
        }
    }

    /// True if the materials of two problems on one mesh show that they have the same form: laws that vary in space or
    /// with the temperature do not.
    fn is_same(self, a: &Problem, b: &Problem) -> bool {
        let materials = || a.materials.iter().zip(&b.materials);
        let laws = |law: fn(&Material) -> &Law<dyn TensorLaw>| materials().all(|(a, b)| is_same_law(law(a), law(b)));
        let coefficients = |of: fn(&Material) -> &Coefficient<Sym>| {
            let are_same = |(a, b): (&Material, &Material)| {
                of(a).constant().is_some_and(|a| of(b).constant().is_some_and(|b| same_bits(&a, &b)))
            };
            materials().all(are_same)
        };
        let has_same_strain = || a.dilatation() == b.dilatation();
        match self {
            BodyForm::Mass => true,
            BodyForm::A => has_same_strain() && laws(|m| &m.elasticity),
            BodyForm::B => has_same_strain() && laws(|m| &m.viscosity),
            BodyForm::D => coefficients(|m| &m.conductivity),
            BodyForm::M => has_same_strain() && coefficients(|m| &m.expansion),
            BodyForm::E => has_same_strain() && coefficients(|m| &m.coupling),
        }
    }
}

/// The forms and loads that a problem has in common with another one on the same mesh, as far as their data show it.
#[derive(Default)]
pub(super) struct SameForms<'a> {
    /// The other one, if both have the same mesh.
    of: Option<&'a Discretization>,
    forms: Vec<BodyForm>,
    loads: bool,
}

impl<'a> SameForms<'a> {
    pub fn new(problem: &Problem, (other, of): (&Problem, &'a Discretization)) -> SameForms<'a> {
        let is_plain = |problem: &Problem| problem.massless_nodes().is_empty();
        let is_alike = problem.materials.len() == other.materials.len() && is_plain(problem) && is_plain(other);
        if !is_alike || !is_same_mesh(&problem.mesh, &other.mesh) {
            return SameForms::default();
        }
        let forms = BodyForm::ALL.into_iter().filter(|form| form.is_same(problem, other)).collect();
        SameForms { of: Some(of), forms, loads: has_same_loads(problem, other) }
    }

    /// The graph of both.
    pub fn graph(&self) -> Option<Arc<Graph>> {
        self.of.map(|of| Arc::clone(of.mass.graph()))
    }

    /// The form of the other one, or a form that is made.
    pub fn form(&self, form: BodyForm, make: impl FnOnce() -> BlockMatrix) -> BlockMatrix {
        self.of.filter(|_| self.forms.contains(&form)).map_or_else(make, |of| form.of(of).clone())
    }

    /// The loads of mechanics and heat.
    pub fn loads(&self, make: impl FnOnce() -> (Load, Load)) -> (Load, Load) {
        self.of.filter(|_| self.loads).map_or_else(make, |of| (of.f.shared(), of.q_h.shared()))
    }
}

fn is_same_mesh(a: &Arc<Mesh>, b: &Arc<Mesh>) -> bool {
    let same_points = || {
        let coordinates = |mesh: &Mesh| mesh.points.iter().flatten().map(|c| c.to_bits()).collect::<Vec<u64>>();
        coordinates(a) == coordinates(b)
    };
    let same_cells = || {
        a.blocks.len() == b.blocks.len()
            && a.blocks
                .iter()
                .zip(&b.blocks)
                .all(|(a, b)| std::ptr::eq(a.element, b.element) && a.region == b.region && a.nodes == b.nodes)
    };
    let same_sides = || are_same_sets(&a.facets, &b.facets) && are_same_sets(&a.edges, &b.edges);
    let bits = |mesh: &Mesh| mesh.thickness.map(f64::to_bits);
    Arc::ptr_eq(a, b)
        || (same_sides()
            && (a.dim, a.axisymmetric, bits(a)) == (b.dim, b.axisymmetric, bits(b))
            && same_cells()
            && same_points())
}

/// True if the loads of two problems on one mesh have the same data. Of loads of regions and rigid parts this is not
/// told.
fn has_same_loads(a: &Problem, b: &Problem) -> bool {
    let is_plain = |problem: &Problem| problem.region_loads.is_empty() && problem.rigid.is_empty();
    is_plain(a)
        && is_plain(b)
        && (&a.body_force, &a.heat_source, &a.boundary) == (&b.body_force, &b.heat_source, &b.boundary)
}

fn are_same_sets(a: &BTreeMap<String, FacetSet>, b: &BTreeMap<String, FacetSet>) -> bool {
    let is_same = |(a, b): (&FacetBlock, &FacetBlock)| std::ptr::eq(a.element, b.element) && a.nodes == b.nodes;
    a.len() == b.len()
        && a.iter().zip(b).all(|((name, a), (other, b))| {
            name == other && a.blocks.len() == b.blocks.len() && a.blocks.iter().zip(&b.blocks).all(is_same)
        })
}

/// True if two laws are linear, do not vary, and have the same values, or if neither has a constant matrix.
fn is_same_law(a: &Law<dyn TensorLaw>, b: &Law<dyn TensorLaw>) -> bool {
    if !is_fixed(a) && !is_fixed(b) {
        return true;
    }
    let strains = (0..6).map(|i| Sym(std::array::from_fn(|j| f64::from(u8::from(i == j)))));
    let x = [0.0; 3];
    let (of_a, of_b) = (a.at(&x), b.at(&x));
    is_fixed(a)
        && is_fixed(b)
        && [a, b].iter().all(|law| law.graded().is_none() && law.arrays().is_empty())
        && strains.into_iter().all(|strain| same_bits(&of_a.value(&x, &strain), &of_b.value(&x, &strain)))
}

fn same_bits(a: &Sym, b: &Sym) -> bool {
    a.0.iter().zip(&b.0).all(|(a, b)| a.to_bits() == b.to_bits())
}

impl Discretization {
    /// True if the forms of (4.1) and of (4.2) are to the bit those of another discretization; false for laws that are
    /// not in matrices, and for (4.1) of a body with Maxwell branches.
    #[must_use]
    pub fn has_same_forms(&self, other: &Discretization) -> [bool; 2] {
        let in_matrices =
            |of: &Discretization| of.is_linear() && of.warm.expansion.is_empty() && of.branches.is_empty();
        let mechanics = [self, other].into_iter().all(in_matrices)
            && is_same(self.inertia(), other.inertia())
            && [(&self.a, &other.a), (&self.b, &other.b), (&self.m, &other.m)].iter().all(|(a, b)| a.is_same(b))
            && are_same(self.springs.as_ref(), other.springs.as_ref())
            && are_same(self.dashpots.as_ref(), other.dashpots.as_ref());
        let heat = [self, other].into_iter().all(Discretization::conducts_linearly)
            && is_same(self.storage(), other.storage())
            && [(&self.d, &other.d), (&self.e, &other.e)].iter().all(|(a, b)| a.is_same(b))
            && are_same(self.convection.as_ref(), other.convection.as_ref());
        [mechanics, heat]
    }
}

impl Discretization {
    /// True if the loads were shared with another discretization: the prescribed values are then the same, too.
    pub(crate) fn shares_loads(&self, other: &Discretization) -> bool {
        self.f.is_shared(&other.f) && self.q_h.is_shared(&other.q_h)
    }

    /// Takes the forms of another one with constant forms in the place of its own.
    pub(crate) fn take_forms(&mut self, other: &Discretization) {
        let forms = [&mut self.a, &mut self.b, &mut self.m, &mut self.e, &mut self.d, &mut self.mass];
        let others = [&other.a, &other.b, &other.m, &other.e, &other.d, &other.mass];
        forms.into_iter().zip(others).for_each(|(form, other)| form.clone_from(other));
        let on_boundary = [&mut self.springs, &mut self.dashpots, &mut self.convection];
        let others = [&other.springs, &other.dashpots, &other.convection];
        on_boundary.into_iter().zip(others).for_each(|(form, other)| form.clone_from(other));
        self.moved.clone_from(&other.moved);
        self.density.clone_from(&other.density);
        self.capacity.clone_from(&other.capacity);
    }
}

/// True if scales and forms are the same.
fn is_same(a: (f64, &BlockMatrix), b: (f64, &BlockMatrix)) -> bool {
    a.0.to_bits() == b.0.to_bits() && a.1.is_same(b.1)
}

/// True if both forms are the same, or neither is there.
fn are_same(a: Option<&BlockMatrix>, b: Option<&BlockMatrix>) -> bool {
    match (a, b) {
        (None, None) => true,
        (Some(a), Some(b)) => a.is_same(b),
        _ => false,
    }
}
