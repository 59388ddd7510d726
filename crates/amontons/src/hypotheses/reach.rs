//! `contact-possible`: whether the body can reach the foundation at all.
//!
//! Until it does, (4.1), (4.2) are linear and free of contact. With u*_n the static answer to the load f_n and y² = ρ‖w‖² + ‖u − u*‖²_a, testing a
//! step with w_n and using m(θ, w) ≤ m_b‖ε(w)‖² + ‖𝓜‖²‖θ‖²/(4 m_b) gives
//!
//! ```text
//!     y_n² ≤ (y_{n−1} + ‖u*_n − u*_{n−1}‖_a)² + k ‖𝓜‖² ‖θ_{n−1}‖²/(2 m_b),
//!     (c/k + m_d λ) ‖θ_n‖ ≤ (c/k) ‖θ_{n−1}‖ + ‖𝓡‖ ‖ε(u_{n−1})‖ + ‖q_n‖,       λ = c_f²/(1 − c_f²),
//!     u_ν(x, t_n) ≤ u*_ν(x, t_n) + y_n √G(x),                                G(x) = sup v_ν(x)²/‖v‖²_a,
//! ```
//!
//! and G is the diagonal of the inverse of the condensed a. All constants are those of the discrete problem, so the bound is one of its
//! solution. Proof: `book/src/theory.md`.

use std::sync::Arc;

use super::laws::{at, gravity, norm};
use super::step::heat_acts_at_once;
use super::{Constants, Finding, Status};
use crate::contact::{Contact, ContactBoundary};
use crate::element::Table;
use crate::field::Field;
use crate::forms;
use crate::linalg::{BlockMatrix, FactorError, Graph, System, Unknowns, dot};
use crate::material::Material;
use crate::mesh::CellMap;
use crate::problem::Problem;
use crate::space::Space;
use crate::tensor::Point;

const ID: &str = "contact-possible";

/// Whether a static problem has to be solved for every step.
pub(super) fn loads_vary(problem: &Problem) -> bool {
    let tractions = problem.boundary.iter().flat_map(|b| b.traction.iter().flatten().chain(&b.pressure));
    !problem.contacts.is_empty() && problem.body_force.iter().chain(tractions).any(Field::depends_on_time)
}

/// `contact-possible`: fails where contact is proved impossible.
pub(super) fn possible(problem: &Problem, constants: &Constants) -> Finding {
    // Of several contacts one that can occur stands for all.
    let each = (0..problem.contacts.len()).filter_map(|side| {
        let mut finding = possible_on(problem, constants, side)?;
        finding.place = finding.place.replacen("contact", &problem.contact_path(side), 1);
        Some(finding)
    });
    each.reduce(|best, found| if gravity(&found) < gravity(&best) { found } else { best })
        .unwrap_or_else(|| Finding::new(ID, Status::Holds, "there is no contact to be possible", "contact"))
}

fn possible_on(problem: &Problem, constants: &Constants, side: usize) -> Option<Finding> {
    let contact = problem.contacts.get(side)?;
    let boundary = ContactBoundary::new(&problem.mesh, problem.mesh.facets.get(&contact.on)?, contact.quadrature);
    Some(judge(problem, constants, contact, boundary))
}

fn judge(problem: &Problem, constants: &Constants, contact: &Contact, boundary: ContactBoundary) -> Finding {
    if contact.normal.lipschitz() == Some(0.0) {
        let message = "the stiffness of the foundation is zero: there is no contact force";
        return Finding::new(ID, Status::Fails, message, "contact.normal.stiffness").numbers(Some(0.0), Some(0.0)).repair("a positive stiffness");
    }
    let Some(material) = problem.materials.first() else {
        return Finding::new(ID, Status::NotCovered, "whether contact can occur is not judged: the body has no material", "material");
    };
    let body = Body::new(problem, material, boundary);
    if let Some((x, penetration)) = body.touching(contact) {
        let message = format!("the body touches the foundation at t = 0, at {}", at(&x));
        return Finding::new(ID, Status::Holds, message, "contact.gap").numbers(Some(penetration), Some(0.0));
    }
    if contact.obstacle.is_some() {
        let message = "whether contact can occur is not judged: the direction of contact is that of an obstacle";
        return Finding::new(ID, Status::NotCovered, message, "contact.obstacle");
    }
    if contact.wear.is_some() {
        return Finding::new(ID, Status::NotCovered, "whether contact can occur is not judged: the gap grows by wear", "contact.wear");
    }
    if let Some((why, place)) = body.not_covered() {
        return Finding::new(ID, Status::NotCovered, format!("whether contact can occur is not judged: {why}"), &place);
    }
    if constants.c_k.is_none() {
        return Finding::new(ID, Status::NotCovered, "whether contact can occur is not judged: no displacement holds the body", "boundary");
    }
    match body.bound(contact, constants.c_f) {
        Ok(Ok(bound)) => bound.finding(),
        Ok(Err(why)) => Finding::new(ID, Status::NotCovered, format!("whether contact can occur is not judged: {why}"), "material.expansion"),
        Err(error) => {
            let message = format!("whether contact can occur is not judged: the static problem has no solution: {error}");
            Finding::new(ID, Status::NotCovered, message, "boundary")
        }
    }
}

/// The bound of u_ν where it comes nearest to the gap, or exceeds it most.
struct Bound {
    normal: f64,
    gap: f64,
    x: Point,
    t: f64,
}

impl Bound {
    fn finding(&self) -> Finding {
        let place = format!("{}, t = {} s", at(&self.x), self.t);
        let numbers = |finding: Finding| finding.numbers(Some(self.normal), Some(self.gap));
        if self.normal <= self.gap {
            let message = format!(
                "contact cannot occur: u_ν stays below {:.6e}, the gap is {:.6e} (nearest at {place}), so [contact] has no effect",
                self.normal, self.gap
            );
            return numbers(Finding::new(ID, Status::Fails, message, "contact.gap")).repair("a smaller gap, or larger loads; or leave [contact] out");
        }
        let message = format!("contact is not excluded: u_ν is bounded by {:.6e} where the gap is {:.6e}, at {place}", self.normal, self.gap);
        numbers(Finding::new(ID, Status::Holds, message, "contact.gap"))
    }
}

/// The body without contact.
struct Body<'a> {
    problem: &'a Problem,
    /// The one material of the body.
    material: &'a Material,
    boundary: ContactBoundary,
    graph: Arc<Graph>,
    space: Space,
    u: Vec<f64>,
    w: Vec<f64>,
    theta: Vec<f64>,
}

impl<'a> Body<'a> {
    fn new(problem: &'a Problem, material: &'a Material, boundary: ContactBoundary) -> Body<'a> {
        let mesh = &problem.mesh;
        let space = problem.displacement_space();
        let scalar = Space::new(mesh, 1, std::iter::empty());
        Body {
            problem,
            material,
            boundary,
            graph: Arc::new(Graph::of_mesh(mesh)),
            u: space.interpolate(mesh, &problem.initial.displacement, 0.0),
            w: space.interpolate(mesh, &problem.initial.velocity, 0.0),
            theta: scalar.interpolate(mesh, std::slice::from_ref(&problem.initial.temperature), 0.0),
            space,
        }
    }

    /// Coefficients of the normal component at each contact point: degree of freedom and factor.
    fn normals(&self) -> impl Iterator<Item = Vec<(usize, f64)>> {
        let dim = self.problem.mesh.dim;
        self.boundary
            .points
            .iter()
            .map(move |p| p.nodes.iter().flat_map(|&(i, n)| (0..dim).map(move |c| (self.boundary.nodes[i] as usize * dim + c, n * p.normal[c]))).collect())
    }

    /// The place of largest penetration at t = 0, if the gap is closed somewhere.
    fn touching(&self, contact: &Contact) -> Option<(Point, f64)> {
        let normals = self.normals().map(|terms| terms.iter().map(|&(dof, factor)| factor * self.u[dof]).sum::<f64>());
        let gaps = contact.gaps(&self.boundary.points.iter().map(|p| p.x).collect::<Vec<_>>(), 0.0);
        let points = normals.zip(&self.boundary.points).zip(gaps).map(|((u_nu, p), gap)| (p.x, u_nu - gap));
        points.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, r)| *r >= 0.0)
    }

    /// What the estimate does not cover, and its place.
    fn not_covered(&self) -> Option<(&'static str, String)> {
        let (problem, m) = (self.problem, self.material);
        if !self.space.is_homogeneous() {
            return Some(("prescribed displacements move the body", "boundary".to_owned()));
        }
        let clash = |v: &[f64]| v.iter().zip(&self.space.free).any(|(v, free)| !free && *v != 0.0);
        if clash(&self.u) || clash(&self.w) {
            return Some(("initial data do not have the prescribed values", "initial".to_owned()));
        }
        if problem.materials.len() > 1 {
            return Some(("the body has several materials", "region".to_owned()));
        }
        if heat_acts_at_once(problem) {
            return Some(("θ_n acts on u_n in the same step", "material.expansion".to_owned()));
        }
        if m.prony.is_some() {
            return Some(("the material remembers its past", "material".to_owned()));
        }
        if !m.elasticity.is_linear() {
            return Some(("the elasticity is not linear", "material.elasticity".to_owned()));
        }
        if let Some(i) = problem.boundary.iter().position(|b| b.spring.is_some()) {
            return Some(("springs hold the body", format!("boundary[{i}].spring")));
        }
        if norm(&m.expansion, problem.mesh.dim) > 0.0
            && let Some(i) = problem
                .boundary
                .iter()
                .position(|b| [&b.temperature, &b.heat_inflow].into_iter().flatten().any(|field| !field.is_zero()) || b.convection.is_some())
        {
            return Some(("heat from a side expands the body", format!("boundary[{i}]")));
        }
        None
    }

    /// The bound over all steps, or what stands in its way.
    fn bound(&self, contact: &Contact, c_f: Option<f64>) -> Result<Result<Bound, &'static str>, FactorError> {
        let (problem, m) = (self.problem, self.material);
        let mesh = &problem.mesh;
        let a = forms::a(mesh, &self.graph, &[m.elasticity.as_ref()]);
        let mass = forms::inner_h(mesh, &self.graph);
        let unknowns = Unknowns::new(&a, &mesh.points, mesh.dim, &self.space.free, &self.boundary.nodes);
        let mut system = System::new(&a, unknowns)?;
        let normals: Vec<Vec<(usize, f64)>> = self.normals().collect();
        let reach = reach(&mut system, &normals, self.space.free.len());
        let load = forms::f(mesh, &problem.body_force, &problem.boundary);
        let gaps = |t: f64| contact.gaps(&self.boundary.points.iter().map(|p| p.x).collect::<Vec<_>>(), t);

        let heat = Heat::new(problem, m, &mass, &self.theta, c_f);
        let thermal = norm(&m.expansion, mesh.dim);
        let (m_a, m_b) = (m.elasticity.constants().monotonicity, m.viscosity.constants().monotonicity);
        let k = problem.k();
        let mut statics = static_answer(&mut system, &load.at(problem.time(1)));
        let mut y = (m.density * dot(&self.w, &mass.apply(&self.w)) + energy(&a, &difference(&self.u, &statics))).max(0.0).sqrt();
        let (mut strain, mut theta) = ((energy(&a, &self.u) / m_a).sqrt(), heat.start);
        let mut worst: Option<Bound> = None;
        let (varies, gap_varies) = (loads_vary(problem), contact.gap_depends_on_time());
        let mut gap = gaps(0.0);
        for n in 1..=problem.steps {
            let t = problem.time(n);
            if varies && n > 1 {
                let next = static_answer(&mut system, &load.at(t));
                y += energy(&a, &difference(&next, &statics)).sqrt();
                statics = next;
            }
            if thermal > 0.0 && theta > 0.0 {
                if m_b <= 0.0 {
                    return Ok(Err("heat expands a body without viscosity"));
                }
                y = (y * y + 0.5 * k * (thermal * theta).powi(2) / m_b).sqrt();
            }
            theta = heat.step(theta, strain, t);
            strain = (energy(&a, &statics).sqrt() + y) / m_a.sqrt();
            if gap_varies {
                gap = gaps(t);
            }
            for (((terms, g_x), gap), point) in normals.iter().zip(&reach).zip(&gap).zip(&self.boundary.points) {
                let normal = terms.iter().map(|&(dof, factor)| factor * statics[dof]).sum::<f64>() + y * g_x.sqrt();
                if worst.as_ref().is_none_or(|w| normal - gap > w.normal - w.gap || normal.is_nan()) {
                    worst = Some(Bound { normal, gap: *gap, x: point.x, t });
                }
            }
        }
        Ok(worst.ok_or("there is no contact point"))
    }
}

/// G at each contact point.
fn reach(system: &mut System, normals: &[Vec<(usize, f64)>], size: usize) -> Vec<f64> {
    let mut position = vec![None; size];
    for (k, &dof) in system.unknowns().contact().iter().enumerate() {
        position[dof as usize] = Some(k);
    }
    let length = system.unknowns().contact().len();
    let one = |terms: &Vec<(usize, f64)>| {
        let mut c = vec![0.0; length];
        for &(dof, factor) in terms {
            if let Some(k) = position[dof] {
                c[k] += factor;
            }
        }
        let mut x = c.clone();
        system.solve_condensed(&mut x);
        dot(&c, &x).max(0.0)
    };
    normals.iter().map(one).collect()
}

/// The solution of K x = f with zero prescribed values, over all degrees of freedom.
fn static_answer(system: &mut System, f: &[f64]) -> Vec<f64> {
    let mut x = system.unknowns().gather(f);
    system.solve(&mut x);
    let mut full = vec![0.0; f.len()];
    system.unknowns().add(&x, &mut full);
    full
}

fn energy(a: &BlockMatrix, u: &[f64]) -> f64 {
    dot(u, &a.apply(u)).max(0.0)
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// The bound of ‖θ‖.
struct Heat<'a> {
    problem: &'a Problem,
    /// ‖θ₀‖.
    start: f64,
    /// c/k, and m_d λ.
    rates: [f64; 2],
    coupling: f64,
    /// ‖q₀‖, if it is constant in time.
    source: Option<f64>,
}

impl<'a> Heat<'a> {
    fn new(problem: &'a Problem, m: &Material, mass: &BlockMatrix, theta: &[f64], c_f: Option<f64>) -> Heat<'a> {
        let lambda = c_f.filter(|c| *c < 1.0).map_or(0.0, |c| c * c / (1.0 - c * c));
        let m_d = m.conductivity.eigenvalues(problem.mesh.dim).first().map_or(0.0, |e| e.max(0.0));
        let varies = problem.heat_source.depends_on_time();
        Heat {
            problem,
            start: dot(theta, &mass.apply(theta)).max(0.0).sqrt(),
            rates: [m.heat_capacity / problem.k(), m_d * lambda],
            coupling: norm(&m.coupling, problem.mesh.dim),
            source: (!varies).then(|| source(problem, 0.0)),
        }
    }

    fn step(&self, theta: f64, strain: f64, t: f64) -> f64 {
        let source = self.source.unwrap_or_else(|| source(self.problem, t));
        let right = self.rates[0] * theta + self.coupling * strain + source;
        if right == 0.0 { 0.0 } else { right / (self.rates[0] + self.rates[1]) }
    }
}

/// ‖q₀(t)‖ by the rule that integrates the load.
fn source(problem: &Problem, t: f64) -> f64 {
    if problem.heat_source.is_zero() {
        return 0.0;
    }
    let mesh = &problem.mesh;
    let mut sum = 0.0;
    for block in &mesh.blocks {
        let table = Table::new(block.element, forms::data_degree(block.element));
        let mut map = CellMap::new(mesh, &table);
        for cell in block.cells() {
            for (q, weight) in table.weights.iter().enumerate() {
                map.at(cell, q);
                sum += weight * map.measure * problem.heat_source.value(&map.position, t).powi(2);
            }
        }
    }
    sum.sqrt()
}
