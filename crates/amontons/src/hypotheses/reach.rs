//! `contact-possible`: tests if the body can reach the foundation at all.
//!
//! Until then, (4.1), (4.2) are linear and free of contact. With the static solution u*_n for the load f_n and y² =
//! ρ‖w‖² + ‖u − u*‖²_a, testing a step with w_n and using m(θ, w) ≤ m_b‖ε(w)‖² + ‖𝓜‖²‖θ‖²/(4 m_b) gives
//!
//! ```text
//!     y_n² ≤ (y_{n−1} + ‖u*_n − u*_{n−1}‖_a)² + k ‖𝓜‖² ‖θ_{n−1}‖²/(2 m_b),
//!     (c/k + m_d λ) ‖θ_n‖ ≤ (c/k) ‖θ_{n−1}‖ + ‖𝓡‖ ‖ε(u_{n−1})‖ + ‖q_n‖,       λ = c_f²/(1 − c_f²),
//!     u_ν(x, t_n) ≤ u*_ν(x, t_n) + y_n √G(x),                                G(x) = sup v_ν(x)²/‖v‖²_a,
//! ```
//!
//! and G is the diagonal of the inverse of the condensed a. The contact laws must vanish for r ≤ 0; a is the form of
//! the scheme, including its dilatation and its springs; relaxing branches add their energy, zero at the start, to y²,
//! and dissipate. All constants are those of the discrete problem, so the result bounds its solution. Proof:
//! `book/src/theory.md`.

use std::sync::Arc;

use super::laws::{Test, tested};
use super::sample::at;
use super::step::{heat_acts_at_once, holds_the_body};
use super::tensors::largest_norm;
use super::{Constants, Finding, FindingId, FindingStatus};
use crate::contact::{Contact, ContactBoundary};
use crate::discretization::Discretization;
use crate::element::ShapeTable;
use crate::field::{Coefficient, Field};
use crate::forms;
use crate::linalg::{BlockMatrix, EXACT, Layout, SolveError, System, dot};
use crate::mass::MassMatrix;
use crate::material::Material;
use crate::mesh::CellMap;
use crate::problem::{Problem, RegionLoad};
use crate::space::Space;
use crate::tensor::Point;
use crate::units::{Measure, Units};

const ID: FindingId = FindingId::ContactPossible;

/// True if each step needs its own static solution.
pub(super) fn loads_vary(problem: &Problem) -> bool {
    let tractions =
        problem.boundary.iter().flat_map(|b| b.traction.iter().chain(&b.force).flatten().chain(&b.pressure));
    let of_region = |load: &RegionLoad| -> bool {
        let gravity = load.gravity.iter().flat_map(|(fields, _)| fields);
        load.body_force.iter().chain(gravity).any(Field::depends_on_time)
    };
    !problem.contacts.is_empty()
        && (problem.body_force.iter().chain(tractions).any(Field::depends_on_time)
            || problem.region_loads.iter().any(of_region))
}

/// `contact-possible`: fails if contact is proved impossible.
pub(super) fn possible(problem: &Problem, discrete: &Discretization, constants: &Constants) -> Finding {
    // One contact that can occur represents several.
    let each = tested(problem).enumerate().map(|(side, test)| {
        let mut finding = judge(problem, discrete, constants, &test);
        finding.place = finding.place.replacen("contact", &problem.contact_path(side), 1);
        finding
    });
    each.reduce(|best, found| if found.status < best.status { found } else { best })
        .unwrap_or_else(|| Finding::new(ID, FindingStatus::Holds, "there is no contact", "contact"))
}

fn judge(problem: &Problem, discrete: &Discretization, constants: &Constants, test: &Test) -> Finding {
    let contact = test.contact;
    if test.does_nothing() {
        let message =
            "the stiffness of the foundation is zero, and neither friction nor heat passes: [contact] has no effect";
        return Finding::new(ID, FindingStatus::Fails, message, "contact.normal.stiffness")
            .numbers(Some(0.0), Some(0.0))
            .repair("a positive stiffness");
    }
    let not_judged = |why: &str, place: &str| {
        Finding::new(ID, FindingStatus::NotCovered, format!("whether contact can occur is not checked: {why}"), place)
    };
    let (Some(material), Some(facets)) = (problem.materials.first(), problem.mesh.facets.get(&contact.on)) else {
        return not_judged("the body has no material, or does not have this side", "material");
    };
    let boundary = ContactBoundary::new(&problem.mesh, facets, contact.quadrature);
    let body = FreeBody::new(problem, discrete, material, boundary);
    if let Some((x, penetration)) = body.touching(contact) {
        let message = format!("the body touches the foundation at t = 0, at {}", at(&x));
        return Finding::new(ID, FindingStatus::Holds, message, "contact.gap").numbers(Some(penetration), Some(0.0));
    }
    if let Some((why, part)) = test.acts_open() {
        return not_judged(why, &format!("contact.{part}"));
    }
    if contact.obstacle.is_some() {
        return not_judged("the direction of contact is that of an obstacle", "contact.obstacle");
    }
    if contact.wear.is_some() {
        return not_judged("the gap grows by wear", "contact.wear");
    }
    if let Some((why, place)) = body.not_covered() {
        return not_judged(why, &place);
    }
    match body.bound(contact, constants.c_f) {
        Ok(Ok(bound)) => bound.finding(problem.units()),
        Ok(Err((why, place))) => not_judged(why, place),
        Err(error) => not_judged(&format!("the static problem has no solution: {error}"), "boundary"),
    }
}

/// The bound of u_ν at the point where it is nearest to the gap, or exceeds it most.
struct ReachBound {
    normal: f64,
    gap: f64,
    x: Point,
    t: f64,
    /// True if it bounds every solution of the steps, not only the one without contact.
    of_every_motion: bool,
}

impl ReachBound {
    fn finding(&self, units: Units) -> Finding {
        let place = format!("{}, t = {}", at(&self.x), units.exact(self.t, Measure::Time));
        let numbers = |finding: Finding| finding.numbers(Some(self.normal), Some(self.gap));
        if self.normal <= self.gap {
            let (which, other) = if self.of_every_motion {
                ("", "")
            } else {
                (" in the motion that starts without contact", ", where step-unique holds,")
            };
            let message = format!(
                "contact cannot occur{which}: u_ν stays below {:.6e}, the gap is {:.6e} (nearest at {place}), so [contact] has{other} no effect",
                self.normal, self.gap
            );
            return numbers(Finding::new(ID, FindingStatus::Fails, message, "contact.gap"))
                .repair("a smaller gap, or larger loads; or leave [contact] out");
        }
        let message = format!(
            "contact is not excluded: u_ν is bounded by {:.6e} where the gap is {:.6e}, at {place}",
            self.normal, self.gap
        );
        numbers(Finding::new(ID, FindingStatus::Holds, message, "contact.gap"))
    }
}

/// The body without contact.
struct FreeBody<'a> {
    problem: &'a Problem,
    discrete: &'a Discretization,
    /// The one material of the body.
    material: &'a Material,
    boundary: ContactBoundary,
    space: Space,
    u: Vec<f64>,
    w: Vec<f64>,
    theta: Vec<f64>,
}

impl<'a> FreeBody<'a> {
    fn new(
        problem: &'a Problem,
        discrete: &'a Discretization,
        material: &'a Material,
        boundary: ContactBoundary,
    ) -> FreeBody<'a> {
        let mesh = &problem.mesh;
        let space = problem.displacement_space();
        let scalar = Space::new(mesh, 1, std::iter::empty());
        FreeBody {
            problem,
            discrete,
            material,
            boundary,
            u: space.interpolate(mesh, &problem.initial.displacement, 0.0),
            w: space.interpolate(mesh, &problem.initial.velocity, 0.0),
            theta: scalar.interpolate(mesh, std::slice::from_ref(&problem.initial.temperature), 0.0),
            space,
        }
    }

    /// Coefficients of the normal component at each contact point: degree of freedom and factor.
    fn normals(&self) -> impl Iterator<Item = Vec<(usize, f64)>> {
        let dim = self.problem.mesh.dim;
        self.boundary.points.iter().map(move |p| {
            p.nodes
                .iter()
                .flat_map(|&(i, n)| (0..dim).map(move |c| (self.boundary.nodes[i] as usize * dim + c, n * p.normal[c])))
                .collect()
        })
    }

    /// The point of largest penetration at t = 0; `None` if the gap is open everywhere.
    fn touching(&self, contact: &Contact) -> Option<(Point, f64)> {
        let normals = self.normals().map(|terms| terms.iter().map(|&(dof, factor)| factor * self.u[dof]).sum::<f64>());
        let gaps = contact.gaps(&self.boundary.points.iter().map(|p| p.x).collect::<Vec<_>>(), 0.0);
        let points = normals.zip(&self.boundary.points).zip(gaps).map(|((u_nu, p), gap)| (p.x, u_nu - gap));
        points.max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, r)| *r >= 0.0)
    }

    /// A part of the problem that the estimate does not cover, and its place.
    fn not_covered(&self) -> Option<(&'static str, String)> {
        let (problem, m) = (self.problem, self.material);
        if !self.space.is_homogeneous() {
            return Some(("prescribed displacements move the body", "boundary".to_owned()));
        }
        let clash = |v: &[f64]| self.space.prescribed_of(v).iter().any(|v| *v != 0.0);
        if clash(&self.u) || clash(&self.w) {
            return Some(("initial data do not have the prescribed values", "initial".to_owned()));
        }
        if !problem.cyclic.is_empty() {
            return Some(("the body is a sector that is repeated about an axis", "cyclic".to_owned()));
        }
        if problem.mass == MassMatrix::Redistributed {
            return Some(("nodes in contact have no mass", "time.mass".to_owned()));
        }
        if problem.materials.len() > 1 {
            return Some(("the body has several materials", "region".to_owned()));
        }
        if is_graded(m) {
            return Some((
                "the coefficients of the material vary in space or with the temperature",
                "material".to_owned(),
            ));
        }
        if heat_acts_at_once(problem) {
            return Some(("θ_n acts on u_n in the same step", "material.expansion".to_owned()));
        }
        if !m.elasticity.is_linear() {
            return Some(("the elasticity is not linear", "material.elasticity".to_owned()));
        }
        if !problem.timeline.is_equal() || problem.timeline.lacks_inertia() {
            return Some(("steps have several lengths, or inertia acts in some of them only", "phase".to_owned()));
        }
        let heat_acts = largest_norm(problem, |m| &m.expansion) > 0.0;
        if heat_acts && let Some(given) = problem.temperature.first() {
            return Some(("a temperature that is given expands the body", given.key.clone()));
        }
        if heat_acts
            && let Some(i) = problem.boundary.iter().position(|b| {
                [&b.temperature, &b.heat_inflow].into_iter().flatten().any(|field| !field.is_zero())
                    || b.convection.is_some()
            })
        {
            return Some(("heat from a side expands the body", format!("boundary[{i}]")));
        }
        None
    }

    /// The bound over all steps, or the reason why there is none.
    fn bound(
        &self,
        contact: &Contact,
        c_f: Option<f64>,
    ) -> Result<Result<ReachBound, (&'static str, &'static str)>, SolveError> {
        let (problem, discrete, m) = (self.problem, self.discrete, self.material);
        let mesh = &problem.mesh;
        let (mut a, mass) = (discrete.a.clone(), &discrete.mass);
        if let Some(springs) = &discrete.springs {
            a.add_scaled(1.0, springs);
        }
        if !holds_the_body(problem, discrete, &a)? {
            return Ok(Err(("no displacement and no spring holds the body", "boundary")));
        }
        let a = Arc::new(a);
        let layout = Layout::of(mesh, &self.space, &self.boundary.nodes);
        let mut system = System::new(&problem.backend, &a, &layout)?;
        let normals: Vec<Vec<(usize, f64)>> = self.normals().collect();
        if !system.is_direct() && normals.len() > SOLUTIONS {
            return Ok(Err(("a large body would take a solution for each contact point", "solver.solver")));
        }
        let reach = reach(&mut system, &normals, &self.space)?;
        let load = forms::mechanical_load(problem);
        let gaps = |t: f64| contact.gaps(&self.boundary.points.iter().map(|p| p.x).collect::<Vec<_>>(), t);

        let heat = TemperatureBound::new(problem, m, mass, &self.theta, c_f);
        let thermal = largest_norm(problem, |m| &m.expansion);
        let (m_a, m_b) = (m.elasticity.constants().monotonicity, m.viscosity.constants().monotonicity);
        let k = problem.timeline.longest();
        let mut statics = static_answer(&mut system, &load.at(problem.timeline.time(1)))?;
        let mut y = (m.density.at(&ANYWHERE) * dot(&self.w, &mass.apply(&self.w))
            + energy(&a, &difference(&self.u, &statics)))
        .max(0.0)
        .sqrt();
        let (mut strain, mut theta) = ((energy(&a, &self.u) / m_a).sqrt(), heat.start);
        let mut worst: Option<ReachBound> = None;
        let (varies, gap_varies) = (loads_vary(problem), contact.gap_depends_on_time());
        let of_every_motion = thermal == 0.0 && problem.contacts.iter().all(at_rest);
        let mut gap = gaps(0.0);
        for n in 1..=problem.timeline.steps() {
            let t = problem.timeline.time(n);
            if varies && n > 1 {
                let next = static_answer(&mut system, &load.at(t))?;
                y += energy(&a, &difference(&next, &statics)).sqrt();
                statics = next;
            }
            if thermal > 0.0 && theta > 0.0 {
                if m_b <= 0.0 {
                    return Ok(Err(("heat expands a body without viscosity", "material.expansion")));
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
                    worst = Some(ReachBound { normal, gap: *gap, x: point.x, t, of_every_motion });
                }
            }
        }
        Ok(worst.ok_or(("there is no contact point", "contact")))
    }
}

/// Number of solutions without a factor up to which the bound is computed.
const SOLUTIONS: usize = 100;
/// Any point of a body with constant coefficients.
const ANYWHERE: Point = [0.0; 3];

/// True if a coefficient of a material varies in space.
fn is_graded(m: &Material) -> bool {
    m.elasticity.graded().is_some()
        || m.viscosity.graded().is_some()
        || m.density.varies()
        || m.heat_capacity.varies()
        || [&m.expansion, &m.coupling, &m.conductivity].into_iter().any(Coefficient::varies)
}

/// True if a foundation does no work on the body: it does not move, its pressure does not soften, and it has no fluid.
fn at_rest(contact: &Contact) -> bool {
    let falls = |x: &Point| contact.normal.least_slope(x, f64::NEG_INFINITY, f64::INFINITY) < 0.0;
    contact.fluid.is_none()
        && !contact.gap_depends_on_time()
        && contact.foundation_velocity.iter().all(Field::is_zero)
        && !falls(&[0.0; 3])
}

/// G at each contact point.
fn reach(system: &mut System, normals: &[Vec<(usize, f64)>], space: &Space) -> Result<Vec<f64>, SolveError> {
    let (position, n) = (system.unknowns().positions(space.free.len()), space.components);
    let length = system.condensed().len();
    let one = |terms: &Vec<(usize, f64)>| {
        let mut c = vec![0.0; length];
        for &(dof, factor) in terms {
            let directions = space.directions((dof / n) as u32);
            for (a, direction) in directions.iter().enumerate().take(n) {
                if let Some(k) = position[dof / n * n + a] {
                    c[k as usize] += factor * direction[dof % n];
                }
            }
        }
        let mut x = c.clone();
        system.solve_condensed(&mut x, EXACT)?;
        Ok(dot(&c, &x).max(0.0))
    };
    normals.iter().map(one).collect()
}

/// The solution of K x = f with zero prescribed values, over all degrees of freedom.
fn static_answer(system: &mut System, f: &[f64]) -> Result<Vec<f64>, SolveError> {
    let mut x = system.unknowns().gather(f);
    system.solve(&mut x)?;
    let mut full = vec![0.0; f.len()];
    system.unknowns().add(&x, &mut full);
    Ok(full)
}

fn energy(a: &BlockMatrix, u: &[f64]) -> f64 {
    dot(u, &a.apply(u)).max(0.0)
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// The bound of ‖θ‖.
struct TemperatureBound<'a> {
    problem: &'a Problem,
    /// ‖θ₀‖.
    start: f64,
    /// c/k, and m_d λ.
    rates: [f64; 2],
    coupling: f64,
    /// ‖q₀‖, if it is constant in time.
    source: Option<f64>,
}

impl<'a> TemperatureBound<'a> {
    fn new(
        problem: &'a Problem,
        m: &Material,
        mass: &BlockMatrix,
        theta: &[f64],
        c_f: Option<f64>,
    ) -> TemperatureBound<'a> {
        let lambda = c_f.filter(|c| *c < 1.0).map_or(0.0, |c| c * c / (1.0 - c * c));
        let m_d = m.conductivity.at(&ANYWHERE).eigenvalues(problem.mesh.dim).first().map_or(0.0, |e| e.max(0.0));
        let own = problem.region_loads.iter().map(|load| &load.heat_source);
        let varies = own.chain([&problem.heat_source]).any(Field::depends_on_time);
        TemperatureBound {
            problem,
            start: dot(theta, &mass.apply(theta)).max(0.0).sqrt(),
            rates: [m.heat_capacity.at(&ANYWHERE) / problem.timeline.longest(), m_d * lambda],
            coupling: largest_norm(problem, |m| &m.coupling),
            source: (!varies).then(|| source(problem, 0.0)),
        }
    }

    fn step(&self, theta: f64, strain: f64, t: f64) -> f64 {
        let source = self.source.unwrap_or_else(|| source(self.problem, t));
        let right = self.rates[0] * theta + self.coupling * strain + source;
        if right == 0.0 { 0.0 } else { right / (self.rates[0] + self.rates[1]) }
    }
}

/// ‖q₀(t)‖, by the quadrature rule of the load.
fn source(problem: &Problem, t: f64) -> f64 {
    let own = |region: usize| {
        let loads = problem.region_loads.iter().filter(move |load| load.region == region);
        loads.map(|load| &load.heat_source).chain([&problem.heat_source])
    };
    if problem.heat_source.is_zero() && problem.region_loads.iter().all(|load| load.heat_source.is_zero()) {
        return 0.0;
    }
    let mesh = &problem.mesh;
    let mut sum = 0.0;
    for block in &mesh.blocks {
        let table = ShapeTable::new(block.element, forms::data_degree(block.element));
        let mut map = CellMap::new(mesh, &table);
        for cell in block.cells() {
            for (q, weight) in table.weights.iter().enumerate() {
                map.at(cell, q);
                let source: f64 = own(block.region).map(|field| field.value(&map.position, t)).sum();
                sum += weight * map.measure * source.powi(2);
            }
        }
    }
    sum.sqrt()
}
