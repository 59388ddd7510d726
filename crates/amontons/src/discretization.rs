//! Problem 4.1 on a mesh: spaces, matrices, loads and the contact boundary.

mod linearised;
mod relaxation;
mod same;
mod tangents;
mod weight;

use std::sync::{Arc, OnceLock};

use crate::contact::{ContactBoundary, Ways, WornSides};
use crate::field::{Coefficient, Law};
use crate::forms::{self, Dilatation};
use crate::linalg::{BlockMatrix, Graph, NodalMap, by_blocks, dot, max_abs, mechanical_products, thermal_products};
use crate::mass::{means, redistributed};
use crate::material::{self, Material, TensorLaw};
use crate::mesh::{FacetSet, Mesh};
use crate::problem::Problem;
use crate::space::Space;
use crate::tensor::{Sym, SymMap, safe_scale};
use crate::time::Rule;
pub use relaxation::Relaxation;
pub(crate) use relaxation::Relaxed;
use same::{BodyForm, SameForms};
use weight::Weight;

/// The discrete problem without its state: spaces, matrices, loads and contact boundary.
#[derive(Debug)]
pub struct Discretization {
    /// The mesh.
    pub mesh: Arc<Mesh>,
    /// The strain that elasticity and viscosity see.
    pub dilatation: Vec<Dilatation>,
    /// V^h.
    pub v: Space,
    /// Q^h.
    pub q: Space,
    /// (·, ·)_{L²}, on scalars and by components on vectors.
    pub mass: BlockMatrix,
    /// The form of inertia with the mass of nodes in contact moved, and by what map; none if all keep their own.
    moved: Option<(BlockMatrix, NodalMap)>,
    /// Density ρ (kg/m³) and heat capacity as weights of the mass matrix: one number if uniform.
    density: Weight,
    capacity: Weight,
    /// Matrix of a, from the elastic laws that are linear and independent of temperature.
    pub a: BlockMatrix,
    /// Matrix of b, from the viscous laws that are linear and independent of temperature.
    pub b: BlockMatrix,
    /// Elastic and viscous laws per region that are nonlinear or depend on temperature. The entry is zero in regions
    /// whose law is in a or b; the list is empty if all laws are.
    elasticity: Vec<Law<dyn TensorLaw>>,
    viscosity: Vec<Law<dyn TensorLaw>>,
    /// Coefficients of heat and expansion that depend on temperature.
    warm: Warm,
    /// Maxwell branches, grouped by relaxation time; see [`Relaxation`].
    pub branches: Vec<Relaxation>,
    /// Matrix of d. If 𝓚 depends on temperature, it is evaluated at the tabulated temperature nearest to 0.
    pub d: BlockMatrix,
    /// Matrix of m (temperature → force). If 𝓜 depends on temperature, it is evaluated at the tabulated temperature
    /// nearest to 0.
    pub m: BlockMatrix,
    /// Matrix of e (displacement → heat).
    pub e: BlockMatrix,
    /// Springs at the boundary, added to a.
    pub springs: Option<BlockMatrix>,
    /// Dashpots at the boundary, added to b.
    pub dashpots: Option<BlockMatrix>,
    /// Convection at the boundary, added to d.
    pub convection: Option<BlockMatrix>,
    /// f(t).
    pub f: forms::Load,
    /// q_h(t).
    pub q_h: forms::Load,
    /// Contact boundary Γ_C, without nodes if there is no contact.
    pub boundary: Arc<ContactBoundary>,
    /// Facets that bound the bodies, computed by the first pairing that needs them.
    pub outside: OnceLock<FacetSet>,
    /// The sides of pairs that wear.
    pub worn: WornSides,
    /// The ways of fluids along contact points.
    pub ways: Ways,
}

/// Laws of the body at one temperature field, with their matrices if they are linear in the strain.
#[derive(Debug)]
pub struct Warmed<'a> {
    theta: &'a [f64],
    /// Matrices of a and b of the temperature-dependent laws.
    forms: Option<[BlockMatrix; 2]>,
}

/// Coefficients of heat and expansion per region. A list is empty if none of its coefficients depends on temperature.
#[derive(Debug, Default)]
struct Warm {
    capacity: Vec<Coefficient<f64>>,
    conductivity: Vec<Coefficient<Sym>>,
    expansion: Vec<Coefficient<Sym>>,
}

impl Warm {
    fn new(materials: &[Material]) -> Warm {
        fn of<T: Copy + Sync>(materials: &[Material], of: fn(&Material) -> &Coefficient<T>) -> Vec<Coefficient<T>> {
            let warms = materials.iter().any(|m| !of(m).temperatures().is_empty());
            if warms { materials.iter().map(of).cloned().collect() } else { Vec::new() }
        }
        Warm {
            capacity: of(materials, |m| &m.heat_capacity),
            conductivity: of(materials, |m| &m.conductivity),
            expansion: of(materials, |m| &m.expansion),
        }
    }
}

/// True if a law has a constant matrix: it is linear and does not depend on temperature.
pub(crate) fn is_fixed(law: &Law<dyn TensorLaw>) -> bool {
    law.is_linear() && law.temperatures().is_empty()
}

/// Laws per region that have no constant matrix, zero in place of the others; empty if every law has one.
fn others(materials: &[Material], law: fn(&Material) -> &Law<dyn TensorLaw>) -> Vec<Law<dyn TensorLaw>> {
    if materials.iter().all(|m| is_fixed(law(m))) {
        return Vec::new();
    }
    materials.iter().map(|m| if is_fixed(law(m)) { ZERO.law() } else { law(m).clone() }).collect()
}

impl Discretization {
    /// Assembles the forms of a problem.
    #[must_use]
    pub fn new(problem: &Problem) -> Discretization {
        Discretization::made(problem, &SameForms::default())
    }

    /// Assembles the forms of a problem that differs from another one in few data; forms are shared where the data of
    /// both show that they are the same.
    #[must_use]
    pub fn beside(problem: &Problem, other: (&Problem, &Discretization)) -> Discretization {
        Discretization::made(problem, &SameForms::new(problem, other))
    }

    fn made(problem: &Problem, same: &SameForms) -> Discretization {
        let mesh = Arc::clone(&problem.mesh);
        let (graph, map) = graph(problem, same);
        let (v, q) = (problem.displacement_space(), problem.temperature_space());
        let materials = &problem.materials;
        let each = |f: fn(&Material) -> &Coefficient<f64>| materials.iter().map(f).cloned().collect::<Vec<_>>();
        let tensors = |f: fn(&Material) -> &Coefficient<Sym>| materials.iter().map(f).collect::<Vec<_>>();
        let zero = ZERO.law();
        let form = |law: fn(&Material) -> &Law<dyn TensorLaw>| {
            let linear: Vec<_> = materials.iter().map(|m| if is_fixed(law(m)) { law(m) } else { &zero }).collect();
            forms::tensor_form(&mesh, &graph, &linear, &problem.dilatation()).repeated()
        };
        let boundary = Arc::new(problem.contact_boundary());
        // Loads take one thread each.
        let loads = || same.loads(|| rayon::join(|| forms::mechanical_load(problem), || forms::thermal_load(problem)));
        let matrices = || {
            let mass = same.form(BodyForm::Mass, || forms::inner_h(&mesh, &graph).repeated());
            let a = same.form(BodyForm::A, || form(|m| &m.elasticity));
            let b = same.form(BodyForm::B, || form(|m| &m.viscosity));
            let d = same.form(BodyForm::D, || forms::d(&mesh, &graph, &tensors(|m| &m.conductivity)).repeated());
            let dilatation = problem.dilatation();
            let m =
                same.form(BodyForm::M, || forms::m(&mesh, &graph, &tensors(|m| &m.expansion), &dilatation).repeated());
            let e =
                same.form(BodyForm::E, || forms::e(&mesh, &graph, &tensors(|m| &m.coupling), &dilatation).repeated());
            (mass, [a, b], d, [m, e])
        };
        let ((mass, [a, b], d, [m, e]), (f, q_h)) = rayon::join(matrices, loads);
        let density = Weight::new(&mesh, &graph, &each(|m| &m.density));
        // Without mass any matrix will do.
        let moved = map.map(|map| {
            let form = density.form(&mass);
            (redistributed(&mesh, form, &map).unwrap_or_else(|_| form.congruent(&map)).repeated(), map)
        });
        Discretization {
            mass,
            moved,
            density,
            capacity: Weight::new(&mesh, &graph, &each(|m| &m.heat_capacity)),
            a,
            b,
            elasticity: others(materials, |m| &m.elasticity),
            viscosity: others(materials, |m| &m.viscosity),
            warm: Warm::new(materials),
            branches: Relaxation::of(problem, &graph),
            d,
            m,
            e,
            springs: forms::springs(&mesh, &graph, &problem.boundary),
            dashpots: forms::dashpots(&mesh, &graph, &problem.boundary),
            convection: forms::convection(&mesh, &graph, &problem.boundary),
            f,
            q_h,
            dilatation: problem.dilatation(),
            worn: WornSides::new(&mesh, &problem.contacts, &boundary, &v.links),
            ways: Ways::new(&mesh, &problem.contacts, &boundary),
            boundary,
            outside: OnceLock::new(),
            v,
            q,
            mesh,
        }
    }

    /// True if all laws of the body are linear and independent of temperature, so that K_u does not change.
    #[must_use]
    pub fn is_linear(&self) -> bool {
        self.elasticity.is_empty() && self.viscosity.is_empty()
    }

    /// True if (4.1) depends on temperature otherwise than through m and the contact.
    #[must_use]
    pub fn softens(&self) -> bool {
        self.elasticity.iter().chain(&self.viscosity).any(|law| !law.temperatures().is_empty())
    }

    /// True if 𝓔 is a linear function of the strain everywhere, at each temperature.
    #[must_use]
    pub fn is_linearly_elastic(&self) -> bool {
        self.elasticity.iter().all(|law| law.is_linear())
    }

    /// True if 𝓔 and 𝓥 are linear functions of the strain at each temperature, so that K_u depends on temperature but
    /// not on u or w.
    #[must_use]
    pub fn is_linear_at_each_temperature(&self) -> bool {
        self.is_linearly_elastic() && self.viscosity.iter().all(|law| law.is_linear())
    }

    /// True if conduction and stored heat are linear in the temperature, so that K_θ does not change.
    #[must_use]
    pub fn conducts_linearly(&self) -> bool {
        self.warm.capacity.is_empty() && self.warm.conductivity.is_empty()
    }

    /// True if the thermal stress is linear in the temperature, so that m does not change.
    #[must_use]
    pub fn expands_linearly(&self) -> bool {
        self.warm.expansion.is_empty()
    }

    /// True if the matrices of both half-steps and all forms are constant.
    #[must_use]
    pub fn is_constant(&self) -> bool {
        self.is_linear() && self.conducts_linearly() && self.expands_linearly()
    }

    /// Inertia (ρ·, ·) as a scale and a form: ρ and (·, ·) if the density is uniform, otherwise 1 and the weighted
    /// form; with the mass redistributed where the problem says so.
    #[must_use]
    pub fn inertia(&self) -> (f64, &BlockMatrix) {
        let form = self.moved.as_ref().map_or_else(|| self.density.form(&self.mass), |(form, _)| form);
        (self.density.factor(), form)
    }

    /// The nodes without mass, ascending: those in contact if the mass is redistributed.
    #[must_use]
    pub fn massless(&self) -> &[u32] {
        self.moved.as_ref().map_or(&[], |(_, map)| &map.nodes)
    }

    /// Heat storage as a scale and a form: the heat capacity and (·, ·) if it is uniform, otherwise 1 and the weighted
    /// form.
    #[must_use]
    pub fn storage(&self) -> (f64, &BlockMatrix) {
        (self.capacity.factor(), self.capacity.form(&self.mass))
    }

    /// K_u = ρM/δ + B + γA of the linear laws, B with the dashpots and A with the springs and the branches; no B in
    /// a steady step.
    #[must_use]
    pub fn mechanical_matrix(&self, rule: Rule) -> BlockMatrix {
        let Rule { gamma, delta, .. } = rule;
        let steady = || BlockMatrix::zero(self.b.graph(), self.mesh.dim, self.mesh.dim);
        let mut matrix = if rule.is_steady() { steady() } else { self.b.clone() };
        let (rho, inertia) = self.inertia();
        let inertia = (rule.inertia(rho) / delta, Some(inertia));
        let dashpots = self.dashpots.as_ref().filter(|_| !rule.is_steady());
        let boundary = [(gamma, self.springs.as_ref()), (1.0, dashpots), inertia];
        for (factor, form) in [(gamma, Some(&self.a))].into_iter().chain(boundary) {
            if let Some(form) = form {
                matrix.add_scaled(factor, form);
            }
        }
        self.branches.iter().for_each(|branches| branches.add_stiffness(rule, &mut matrix));
        matrix
    }

    /// ρM/k, by which a change of the velocity within a length of time k acts.
    #[must_use]
    pub fn inertia_matrix(&self, k: f64) -> BlockMatrix {
        let (rho, inertia) = self.inertia();
        let mut matrix = BlockMatrix::zero(self.b.graph(), self.mesh.dim, self.mesh.dim);
        matrix.add_scaled(rho / k, inertia);
        matrix
    }

    /// Laws of the body at the nodal temperatures θ.
    #[must_use]
    pub fn warmed<'a>(&self, theta: &'a [f64]) -> Warmed<'a> {
        let is_matrix = self.softens() && self.is_linear_at_each_temperature();
        let forms = || [&self.elasticity, &self.viscosity].map(|laws| self.tangent(laws, &[], theta));
        Warmed { theta, forms: is_matrix.then(forms) }
    }

    /// The form of the elastic energy, with the springs at the boundary: for laws that are not linear their tangent at
    /// rest.
    #[must_use]
    pub fn elastic_form(&self) -> BlockMatrix {
        let (mut matrix, nodes) = (self.a.clone(), self.mesh.points.len());
        self.springs.iter().for_each(|springs| matrix.add_scaled(1.0, springs));
        if !self.elasticity.is_empty() {
            let rest = vec![0.0; nodes * self.mesh.dim];
            matrix.add_scaled(1.0, &self.tangent(&self.elasticity, &rest, &vec![0.0; nodes]));
        }
        matrix
    }

    fn tangent(&self, laws: &[Law<dyn TensorLaw>], at: &[f64], theta: &[f64]) -> BlockMatrix {
        forms::tangent(&self.mesh, self.mass.graph(), &borrowed(laws), &self.dilatation, at, theta)
    }

    /// K_θ = C/δ + D, C the mass matrix times the heat capacity and D with the convection.
    #[must_use]
    pub fn thermal_matrix(&self, rule: Rule) -> BlockMatrix {
        self.sum_of_heat(rule, self.d.clone(), self.storage())
    }

    fn sum_of_heat(&self, rule: Rule, mut d: BlockMatrix, (c, storage): (f64, &BlockMatrix)) -> BlockMatrix {
        if let Some(convection) = &self.convection {
            d.add_scaled(1.0, convection);
        }
        d.add_scaled(c / rule.delta, storage);
        d
    }

    /// True if the heat content is linear in the temperature.
    #[must_use]
    pub fn stores_linearly(&self) -> bool {
        self.warm.capacity.is_empty()
    }

    /// Stored heat per basis function, without the scale of [`Discretization::storage`]: ∫ H(θ) η with the enthalpy H,
    /// which is cθ for a constant capacity.
    #[must_use]
    pub fn stored_heat(&self, theta: &[f64]) -> Vec<f64> {
        if self.stores_linearly() {
            self.storage().1.apply(theta)
        } else {
            forms::stored_heat(&self.mesh, &self.warm.capacity, theta)
        }
    }

    /// m(θ, ·).
    #[must_use]
    pub fn thermal_force(&self, theta: &[f64]) -> Vec<f64> {
        if self.warm.expansion.is_empty() {
            self.m.apply(theta)
        } else {
            forms::expanded(&self.mesh, &self.warm.expansion, &self.dilatation, theta)
        }
    }

    /// a(u, ·) of the linear laws with the springs.
    #[must_use]
    pub fn apply_linear_a(&self, u: &[f64]) -> Vec<f64> {
        with(self.a.apply(u), self.springs.as_ref(), u)
    }

    /// a(u, ·) with the springs, at the temperature θ.
    #[must_use]
    pub fn apply_a(&self, u: &[f64], theta: &[f64]) -> Vec<f64> {
        self.with_laws(self.apply_linear_a(u), &self.elasticity, u, theta)
    }

    /// b(w, ·) with the dashpots, at the temperature θ.
    #[must_use]
    pub fn apply_b(&self, w: &[f64], theta: &[f64]) -> Vec<f64> {
        self.with_laws(with(self.b.apply(w), self.dashpots.as_ref(), w), &self.viscosity, w, theta)
    }

    /// d(θ, ·) with the convection.
    #[must_use]
    pub fn apply_d(&self, theta: &[f64]) -> Vec<f64> {
        let conductivity = &self.warm.conductivity;
        let conducted = if conductivity.is_empty() {
            self.d.apply(theta)
        } else {
            forms::conduction(&self.mesh, conductivity, theta)
        };
        with(conducted, self.convection.as_ref(), theta)
    }

    /// The stored heat and d(θ, ·).
    #[must_use]
    pub fn thermal_products(&self, theta: &[f64]) -> [Vec<f64>; 2] {
        self.thermal_products_then(theta, &mut [], |_, _, _| ()).0
    }

    /// The stored heat and d(θ, ·), with the results of `then` on blocks of them: see [`thermal_products`].
    #[must_use]
    pub fn thermal_products_then<T: Send + 'static>(
        &self,
        theta: &[f64],
        rest: &mut [f64],
        then: impl Fn(usize, [&[f64]; 2], &mut [f64]) -> T + Sync,
    ) -> ([Vec<f64>; 2], Vec<T>) {
        if self.conducts_linearly() && self.convection.is_none() {
            return thermal_products([self.storage().1, &self.d], theta, rest, then);
        }
        let (stored, conducted) = rayon::join(|| self.stored_heat(theta), || self.apply_d(theta));
        let made = by_blocks([&stored, &conducted], rest, then);
        ([stored, conducted], made)
    }

    /// (ρ)M w, a(u, ·), a(w, ·) and b(w, ·) at the temperature θ, the latter three with springs and dashpots; a(w, ·)
    /// is empty if K_u may change.
    #[must_use]
    pub fn mechanical_products(&self, u: &[f64], w: &[f64], warmed: &Warmed) -> [Vec<f64>; 4] {
        self.mechanical_products_then([u, w], warmed, &mut [], |_, _, _| ()).0
    }

    /// (ρ)M w, a(u, ·), a(w, ·) and b(w, ·), with the results of `then` on blocks of the first, second and last: see
    /// [`mechanical_products`].
    #[must_use]
    pub fn mechanical_products_then<T: Send + 'static>(
        &self,
        [u, w]: [&[f64]; 2],
        warmed: &Warmed,
        rest: &mut [f64],
        then: impl Fn(usize, [&[f64]; 3], &mut [f64]) -> T + Sync,
    ) -> ([Vec<f64>; 4], Vec<T>) {
        let (_, inertia) = self.inertia();
        let forms = [inertia, &self.a, &self.b];
        let (springs, dashpots) = (self.springs.as_ref(), self.dashpots.as_ref());
        if self.is_linear() && springs.is_none() && dashpots.is_none() {
            return mechanical_products(forms, [u, w], rest, then);
        }
        let ([mass_w, a_u, a_w, b_w], _) = mechanical_products(forms, [u, w], &mut [], |_, _, _| ());
        let (a_u, b_w) = (with(a_u, springs, u), with(b_w, dashpots, w));
        let products = if self.is_linear() {
            [mass_w, a_u, with(a_w, springs, w), b_w]
        } else if let Some([a, b]) = &warmed.forms {
            [mass_w, with(a_u, Some(a), u), Vec::new(), with(b_w, Some(b), w)]
        } else {
            let a_u = self.with_laws(a_u, &self.elasticity, u, warmed.theta);
            [mass_w, a_u, Vec::new(), self.with_laws(b_w, &self.viscosity, w, warmed.theta)]
        };
        let [mass_w, a_u, _, b_w] = &products;
        let made = by_blocks([mass_w, a_u, b_w], rest, then);
        (products, made)
    }

    /// Round-off in a(u, ·) and b(w, ·) from the last bits of u and w.
    #[must_use]
    pub fn mechanical_round_off(&self, u: &[f64], w: &[f64], theta: &[f64]) -> f64 {
        let of = |form: &BlockMatrix, boundary: Option<&BlockMatrix>, laws: &[Law<dyn TensorLaw>], at: &[f64]| {
            let tangent = if laws.is_empty() { 0.0 } else { self.tangent(laws, at, theta).round_off(at) };
            form.round_off(at) + boundary.map_or(0.0, |boundary| boundary.round_off(at)) + tangent
        };
        of(&self.a, self.springs.as_ref(), &self.elasticity, u)
            + of(&self.b, self.dashpots.as_ref(), &self.viscosity, w)
    }

    /// |A| |u|, A the matrix of a with the tangent of temperature-dependent laws: the scale against which cancelling
    /// terms are measured.
    #[must_use]
    pub fn elastic_sizes(&self, u: &[f64], theta: &[f64]) -> Vec<f64> {
        let mut sizes = self.a.magnitude(u);
        if self.softens() {
            let of_laws = self.tangent(&self.elasticity, u, theta).magnitude(u);
            sizes.iter_mut().zip(of_laws).for_each(|(sum, size)| *sum += size);
        }
        sizes
    }

    /// Round-off in d(θ, ·) with the convection from the last bits of θ.
    #[must_use]
    pub fn thermal_round_off(&self, theta: &[f64]) -> f64 {
        let d = if self.warm.conductivity.is_empty() {
            self.d.round_off(theta)
        } else {
            let all: Vec<_> = self.warm.conductivity.iter().collect();
            forms::d_at(&self.mesh, self.mass.graph(), &all, theta).round_off(theta)
        };
        d + self.convection.as_ref().map_or(0.0, |convection| convection.round_off(theta))
    }

    /// Stored energy at u and the temperature θ, or `None` if a law has no potential: ½ a(u, u) of the linear laws with
    /// the springs, plus ∫ W(ε(u)) of the others.
    #[must_use]
    pub fn stored_energy(&self, u: &[f64], theta: &[f64]) -> Option<f64> {
        let linear = 0.5 * dot(u, &self.apply_linear_a(u));
        if self.elasticity.is_empty() {
            Some(linear)
        } else {
            Some(linear + forms::energy(&self.mesh, &borrowed(&self.elasticity), &self.dilatation, u, theta)?)
        }
    }

    fn with_laws(&self, mut product: Vec<f64>, laws: &[Law<dyn TensorLaw>], at: &[f64], theta: &[f64]) -> Vec<f64> {
        if !laws.is_empty() {
            let terms = forms::residual(&self.mesh, &borrowed(laws), &self.dilatation, at, theta);
            for (sum, term) in product.iter_mut().zip(terms) {
                *sum += term;
            }
        }
        product
    }

    /// Heat flow out through convection, less what the surroundings supply: ∫ h θ.
    #[must_use]
    pub fn convected(&self, theta: &[f64]) -> f64 {
        self.convection.as_ref().map_or(0.0, |convection| convection.apply(theta).iter().sum())
    }

    /// Norm √(v·Av) with A = `matrix`: ‖v‖ in H or L² for the mass matrix, ‖ε(v)‖ for the form (ε(·), ε(·)).
    #[must_use]
    pub fn norm(&self, matrix: &BlockMatrix, v: &[f64]) -> f64 {
        let scale = safe_scale(max_abs(v));
        let scaled: Vec<f64> = v.iter().map(|v| scale * v).collect();
        dot(&scaled, &matrix.apply(&scaled)).max(0.0).sqrt() / scale
    }
}

/// The graph of the forms, with the map that moves the mass of nodes in contact, if the problem says so.
fn graph(problem: &Problem, same: &SameForms) -> (Arc<Graph>, Option<NodalMap>) {
    if let Some(graph) = same.graph() {
        return (graph, None);
    }
    let cells = Graph::of_mesh(&problem.mesh);
    // The check of the problem has found that the mass can be moved.
    let massless = Some(problem.massless_nodes()).filter(|nodes| !nodes.is_empty());
    let map = massless.and_then(|nodes| means(&cells, nodes).ok());
    (Arc::new(map.as_ref().map(|map| map.joined(&cells)).unwrap_or(cells)), map)
}

/// Zero law, for regions that have no law of their own in a form.
static ZERO: material::Branch = material::Branch::new(SymMap([[0.0; 6]; 6]), f64::INFINITY);

fn borrowed(laws: &[Law<dyn TensorLaw>]) -> Vec<&Law<dyn TensorLaw>> {
    laws.iter().collect()
}

/// Adds the product of a boundary form with x to `product`, if there is such a form.
fn with(mut product: Vec<f64>, form: Option<&BlockMatrix>, x: &[f64]) -> Vec<f64> {
    if let Some(form) = form {
        for (sum, term) in product.iter_mut().zip(form.apply(x)) {
            *sum += term;
        }
    }
    product
}
