//! Admissible tractions on Γ_C, and what contact adds to the error.
//!
//! With a convex potential Φ of the pressure and its conjugate Φ*, Φ(r) + Φ*(p̂) − p̂ r ≥ 0 is zero only on the law;
//! the same holds for friction with the potential s‖d‖ of the slip d in the step.

use std::collections::HashMap;

use super::Refused;
use super::balance::FacetGiven;
use super::parallelogram::{self, on_triangles, traction_rule};
use super::skeleton::{Skeleton, linear_functions};
use super::stress::{StepLaws, StepMotion};
use crate::contact::{Contact, ContactPoint, GraphKind, NormalLaw, Quadrature};
use crate::element::{Element, ShapeTable};
use crate::inclusion::PointState;
use crate::mesh::{CellMap, FacetMap};
use crate::problem::Problem;
use crate::quadrature::{QuadratureRule, Shape, rule};
use crate::tensor::{Point, dot, length};

/// Penetration relative to the displacement that is round-off.
pub(super) const ROUND_OFF: f64 = 1e-11;

/// The normal law as the proof needs it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NormalKind {
    /// p is a nondecreasing function of r.
    Function,
    /// r ≤ 0, p ≥ 0, p r = 0.
    Rigid,
    /// r = 0.
    Bilateral,
}

impl NormalKind {
    /// The kind of a law, or `None` if it has no convex potential of the penetration alone.
    pub fn of(law: &dyn NormalLaw) -> Option<NormalKind> {
        match law.graph() {
            GraphKind::Bilateral => Some(NormalKind::Bilateral),
            GraphKind::Multivalued => law.is_rigid().then_some(NormalKind::Rigid),
            GraphKind::Function => {
                let falls = law.least_slope(&[0.0; 3], f64::NEG_INFINITY, f64::INFINITY) < 0.0;
                (!falls && law.lipschitz_in_rate() == Some(0.0)).then_some(NormalKind::Function)
            }
        }
    }
}

/// A facet of Γ_C.
#[derive(Clone, Debug)]
pub(super) struct ContactFacet {
    pub facet: usize,
    pub contact: usize,
    element: &'static Element,
    pub nodes: Vec<u32>,
    /// Distances of the vertices from the axis of a body of revolution, m; empty for other bodies.
    radii: Vec<f64>,
    pub normal: Point,
    /// Area over that of the reference facet, m².
    area: f64,
    /// g at the nodes, m.
    gap: Vec<f64>,
    /// Slip in the step at the nodes, m.
    slip: Vec<Point>,
    /// Pressure, friction and its bound at the vertices, Pa.
    pub pressure: Vec<f64>,
    friction: Vec<Point>,
    bound: Vec<f64>,
}

impl ContactFacet {
    /// Values at a place of the functions by which tractions at vertices are continued: the linear ones; on the four
    /// triangles of a parallelogram; or those of which the product with r is linear, as it is the force per length of a
    /// ring that balances.
    fn shares(&self, x: &Point) -> Vec<f64> {
        if self.element.shape == Shape::Quadrilateral {
            return parallelogram::functions(x);
        }
        let hats = linear_functions(self.element.shape, self.element, x);
        if self.radii.is_empty() {
            return hats;
        }
        let r: f64 = hats.iter().zip(&self.radii).map(|(hat, r)| hat * r).sum();
        hats.iter().zip(&self.radii).map(|(hat, own)| hat * own / r).collect()
    }
}

/// The solved step as contact sees it.
pub(super) struct SolvedContact<'a> {
    pub problem: &'a Problem,
    /// The contacts with their laws at the time of the step.
    pub contacts: &'a [Contact],
    pub boundary: &'a crate::contact::ContactBoundary,
    pub space: &'a crate::space::Space,
    pub states: &'a [PointState],
    pub temperature: &'a [f64],
    pub t: f64,
    /// γ, s.
    pub gamma: f64,
}

impl SolvedContact<'_> {
    /// True if a displacement of a node along a direction is prescribed.
    fn holds(&self, node: u32, direction: &Point) -> bool {
        self.space.held_directions(node).any(|held| dot(&held, direction).abs() > 1e-6)
    }
}

/// Γ_C facet by facet.
pub(super) struct Touching<'a> {
    pub solved: SolvedContact<'a>,
    pub facets: Vec<ContactFacet>,
    kinds: Vec<Option<NormalKind>>,
    /// Contact point by contact and node.
    points: HashMap<(usize, u32), usize>,
    scale: f64,
}

impl<'a> Touching<'a> {
    /// The facets of all contacts that act.
    ///
    /// # Errors
    /// If a facet belongs to two contacts, or the gap is not known at its nodes.
    pub fn new(solved: SolvedContact<'a>, skeleton: &Skeleton, motion: &StepMotion) -> Result<Touching<'a>, Refused> {
        let mesh = &solved.problem.mesh;
        let kinds = solved.contacts.iter().map(|contact| NormalKind::of(contact.normal.as_ref())).collect();
        let mut points = HashMap::new();
        for (number, point) in solved.boundary.points.iter().enumerate() {
            let is_nodal = solved.contacts.get(point.contact).is_some_and(|c| c.quadrature == Quadrature::Nodal);
            if let (true, [(node, _)]) = (is_nodal, point.nodes.as_slice()) {
                points.insert((point.contact, solved.boundary.nodes[*node]), number);
            }
        }
        let scale = motion.u.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
        let mut all = Touching { solved, facets: Vec::new(), kinds, points, scale };
        let mut taken = HashMap::new();
        for (contact, of) in all.solved.contacts.iter().enumerate().filter(|(_, of)| of.acts()) {
            let Some(set) = mesh.facets.get(&of.on) else { continue };
            for (element, nodes) in set.facets() {
                let facet = skeleton.find(element, nodes).ok_or_else(|| Refused::new("a contact facet of no cell"))?;
                if taken.insert(facet, contact).is_some() {
                    return Err(Refused::new("two contacts on one side"));
                }
                let facet = all.facet(contact, (facet, element, nodes), motion)?;
                all.facets.push(facet);
            }
        }
        Ok(all)
    }

    fn facet(
        &self,
        contact: usize,
        (facet, element, nodes): (usize, &'static Element, &[u32]),
        motion: &StepMotion,
    ) -> Result<ContactFacet, Refused> {
        let mesh = &self.solved.problem.mesh;
        let table = ShapeTable::new(element, 1);
        let mut map = FacetMap::new(mesh, &table);
        map.at(nodes, 0);
        let (normal, area) = (map.normal, map.area);
        let gap = nodes.iter().map(|&node| self.gap(contact, node, motion)).collect::<Result<Vec<f64>, Refused>>()?;
        let slip =
            nodes.iter().map(|&node| self.slip(contact, node, motion)).collect::<Result<Vec<Point>, Refused>>()?;
        let vertices = element.shape.vertices();
        let zero = (vec![0.0; vertices], vec![[0.0; 3]; vertices], vec![0.0; vertices]);
        let (pressure, friction, bound) = zero;
        let radius = |&node: &u32| mesh.points[node as usize][0];
        let radii = if mesh.axisymmetric { nodes[..vertices].iter().map(radius).collect() } else { Vec::new() };
        let nodes = nodes.to_vec();
        Ok(ContactFacet { facet, contact, element, nodes, radii, normal, area, gap, slip, pressure, friction, bound })
    }

    fn at_node(&self, node: u32, values: &[f64]) -> Point {
        let dim = self.solved.problem.mesh.dim;
        std::array::from_fn(|c| if c < dim { values[node as usize * dim + c] } else { 0.0 })
    }

    fn state(&self, contact: usize, node: u32) -> Option<&PointState> {
        self.points.get(&(contact, node)).and_then(|&point| self.solved.states.get(point))
    }

    /// g at a node: that of its contact point, or the datum.
    fn gap(&self, contact: usize, node: u32, motion: &StepMotion) -> Result<f64, Refused> {
        let (of, x) = (&self.solved.contacts[contact], &self.solved.problem.mesh.points[node as usize]);
        if let Some(state) = self.state(contact, node) {
            return Ok(dot(&self.at_node(node, motion.u), &state.normal) - state.penetration);
        }
        if of.obstacle.is_some() {
            return Err(Refused::new("nodes without a contact point on a side that faces an obstacle"));
        }
        Ok(of.gap.value(x, self.solved.t))
    }

    /// The slip at a node against the foundation in the step, with a normal component that does not count.
    fn slip(&self, contact: usize, node: u32, motion: &StepMotion) -> Result<Point, Refused> {
        let of = &self.solved.contacts[contact];
        if of.friction.is_frictionless() {
            return Ok([0.0; 3]);
        }
        if let Some(state) = self.state(contact, node) {
            return Ok(state.slip.map(|c| c * self.solved.gamma));
        }
        if of.obstacle.is_some() || !of.foundation_velocity.is_empty() {
            return Err(Refused::new("friction on a moving foundation at nodes without a contact point"));
        }
        let [now, before] = [motion.u, motion.before].map(|values| self.at_node(node, values));
        Ok(std::array::from_fn(|c| now[c] - before[c]))
    }

    fn penetration(&self, facet: &ContactFacet, place: usize, u: &[f64]) -> f64 {
        let r = dot(&self.at_node(facet.nodes[place], u), &facet.normal) - facet.gap[place];
        if r.abs() <= ROUND_OFF * self.scale.max(facet.gap[place].abs()) { 0.0 } else { r }
    }

    /// Says what makes contact an estimate: normals that are not those of the facets, and friction whose bound the
    /// proof does not know.
    pub fn remark(&self, remarks: &mut super::Remarks) {
        let is_turned = |facet: &ContactFacet| {
            let states = facet.nodes.iter().filter_map(|&node| self.state(facet.contact, node));
            states.into_iter().any(|state| !super::is_along(&state.normal, &facet.normal))
        };
        if self.facets.iter().any(is_turned) {
            remarks.estimate(
                "the direction of contact is not the normal of the facets: the side or its obstacle is curved",
            );
        }
    }

    /// A displacement near `u` that is admissible at all places of rigid foundations, where between nodes and at nodes
    /// without a contact point `u` need not be.
    ///
    /// On a side a quadratic r is at most zero if it is so at the vertices and 4 r_m ≤ r_1 + r_2 for the middle of each
    /// edge, by its Bernstein coefficients; a biquadratic one if also 16 r_c ≤ 4 Σ r_m − Σ r_i for the middle of the
    /// facet.
    ///
    /// # Errors
    /// If a held node is not where the foundation lets it be.
    pub fn admissible(&self, u: &[f64]) -> Result<Option<Vec<f64>>, Refused> {
        let mut repaired = u.to_vec();
        let mut is_changed = false;
        for pass in 0..3 {
            // What nodes lose is the largest of their facets.
            let mut changes: HashMap<u32, (f64, Point)> = HashMap::new();
            for facet in &self.facets {
                let n = facet.element.shape.vertices();
                let r: Vec<f64> = (0..facet.nodes.len()).map(|i| self.penetration(facet, i, &repaired)).collect();
                for (place, &node) in facet.nodes.iter().enumerate() {
                    let change = match (self.kinds[facet.contact], pass, place < n) {
                        (Some(NormalKind::Bilateral), 0, _) => r[place],
                        (Some(NormalKind::Rigid), 0, true) => r[place].max(0.0),
                        (Some(NormalKind::Rigid), 1, false) if place < 2 * n => {
                            let ends = edge(n, place);
                            (r[place] - 0.25 * (r[ends[0]] + r[ends[1]])).max(0.0)
                        }
                        (Some(NormalKind::Rigid), 2, false) if place >= 2 * n => {
                            let [vertices, middles] = [&r[..n], &r[n..2 * n]].map(|of| of.iter().sum::<f64>());
                            (r[place] - 0.25 * middles + 0.0625 * vertices).max(0.0)
                        }
                        _ => 0.0,
                    };
                    let old = changes.get(&node).map_or(0.0, |(old, _)| *old);
                    if change.abs() > old.abs() {
                        changes.insert(node, (change, facet.normal));
                    }
                }
            }
            for (node, (change, normal)) in changes {
                if self.solved.holds(node, &normal) {
                    return Err(Refused::new("a held node that penetrates a rigid foundation"));
                }
                is_changed = true;
                let dim = self.solved.problem.mesh.dim;
                (0..dim).for_each(|c| repaired[node as usize * dim + c] -= change * normal[c]);
            }
        }
        Ok(is_changed.then_some(repaired))
    }

    /// Sets the tractions at the vertices: in the cone of the laws, near the discrete ones.
    pub fn press(&mut self, laws: &StepLaws, skeleton: &Skeleton, motion: &StepMotion) {
        let mut of_stress: HashMap<(usize, u32), (Point, f64)> = HashMap::new();
        for facet in &self.facets {
            for (node, traction) in stresses_at_vertices(laws, skeleton, facet, motion) {
                let (sum, count) = of_stress.entry((facet.contact, node)).or_insert(([0.0; 3], 0.0));
                (0..3).for_each(|c| sum[c] += traction[c]);
                *count += 1.0;
            }
        }
        let mut facets = std::mem::take(&mut self.facets);
        for facet in &mut facets {
            for place in 0..facet.pressure.len() {
                let node = facet.nodes[place];
                let (sum, count) = of_stress.get(&(facet.contact, node)).copied().unwrap_or(([0.0; 3], 1.0));
                let traction = sum.map(|c| c / count);
                let (p, q, s) = self.law(facet, place, &traction, motion.u);
                (facet.pressure[place], facet.friction[place], facet.bound[place]) = (p, q, s);
            }
        }
        self.facets = facets;
        self.relieve(motion.u);
    }

    /// True if a quadratic facet on a rigid foundation is open but for one vertex or edge: the contact ends there.
    fn is_open(&self, facet: &ContactFacet, u: &[f64]) -> bool {
        let n = facet.pressure.len();
        if self.kinds[facet.contact] != Some(NormalKind::Rigid) || facet.nodes.len() == n {
            return false;
        }
        let opens: Vec<bool> = (0..facet.nodes.len()).map(|place| self.penetration(facet, place, u) < 0.0).collect();
        let is_beside = |place: usize| {
            if place < 2 * n { edge(n, place).into_iter().any(|end| opens[end]) } else { opens[..n].contains(&true) }
        };
        opens[..n].contains(&true) && (n..opens.len()).all(|place| opens[place] || !is_beside(place))
    }

    /// Gives the force of a vertex to those of its facets that are closed: a linear pressure would press on the open
    /// ones.
    fn relieve(&mut self, u: &[f64]) {
        let opens: Vec<bool> = self.facets.iter().map(|facet| self.is_open(facet, u)).collect();
        let mut areas: HashMap<(usize, u32), [f64; 2]> = HashMap::new();
        for (facet, is_open) in self.facets.iter().zip(&opens) {
            for &node in &facet.nodes[..facet.pressure.len()] {
                let [all, closed] = areas.entry((facet.contact, node)).or_default();
                *all += facet.area;
                *closed += if *is_open { 0.0 } else { facet.area };
            }
        }
        let mut facets = std::mem::take(&mut self.facets);
        for (facet, is_open) in facets.iter_mut().zip(opens) {
            for place in 0..facet.pressure.len() {
                let node = facet.nodes[place];
                let [all, closed] = areas.get(&(facet.contact, node)).copied().unwrap_or([1.0; 2]);
                let is_force = self.state(facet.contact, node).is_some() && !self.solved.holds(node, &facet.normal);
                if is_open && closed > 0.0 {
                    facet.pressure[place] = 0.0;
                } else if is_force && closed > 0.0 {
                    facet.pressure[place] *= all / closed;
                }
            }
        }
        self.facets = facets;
    }

    /// Pressure, friction and bound at a vertex, with the traction σν of the discrete stress.
    fn law(&self, facet: &ContactFacet, place: usize, traction: &Point, u: &[f64]) -> (f64, Point, f64) {
        let (node, nu) = (facet.nodes[place], &facet.normal);
        let contact = &self.solved.contacts[facet.contact];
        let x = self.solved.problem.mesh.points[node as usize];
        let r = self.penetration(facet, place, u);
        let state = self.state(facet.contact, node);
        let known = state.filter(|_| !self.solved.holds(node, nu)).map(|state| state.pressure);
        let p = match self.kinds[facet.contact] {
            // An opening of a body that rests is round-off, which the pressure tells from one that is open.
            Some(NormalKind::Rigid) => match known {
                Some(p) => p.max(0.0),
                None if r < 0.0 => 0.0,
                None => (-dot(traction, nu)).max(0.0),
            },
            Some(NormalKind::Bilateral) => known.unwrap_or(-dot(traction, nu)),
            _ => contact.normal.pressure(&x, r, 0.0, 0.0).value.max(0.0),
        };
        if contact.friction.is_frictionless() {
            return (p, [0.0; 3], 0.0);
        }
        let slip = tangential(&facet.slip[place], nu);
        let sticks = state.is_some_and(|state| state.status == crate::contact::Status::Stick);
        let seen = ContactPoint {
            x,
            penetration: r,
            pressure: if self.kinds[facet.contact] == Some(NormalKind::Bilateral) { p.abs() } else { p.max(0.0) },
            slip_speed: if sticks { 0.0 } else { length(&slip) / self.solved.gamma },
            temperature: self.solved.temperature.get(node as usize).copied().unwrap_or(0.0),
            ..ContactPoint::default()
        };
        let s = contact.friction.bound(&seen).value;
        let is_held = self.solved.space.held_directions(node).any(|held| length(&tangential(&held, nu)) > 1e-6);
        let q = match state {
            Some(state) if !is_held => tangential(&state.q, nu),
            // The support takes what it likes: friction is along the slip.
            _ if length(&slip) > 0.0 => slip.map(|c| c * s / length(&slip)),
            _ => tangential(&traction.map(|c| 0.0 - c), nu),
        };
        let size = length(&q);
        (p, if size > s { q.map(|c| c * s / size) } else { q }, s)
    }

    /// The largest pressure or friction at a vertex, Pa.
    pub fn largest_traction(&self) -> f64 {
        let of = |facet: &ContactFacet| {
            let friction = facet.friction.iter().map(length);
            facet.pressure.iter().map(|p| p.abs()).chain(friction).fold(0.0, f64::max)
        };
        self.facets.iter().map(of).fold(0.0, f64::max)
    }

    /// Adds the moments of the tractions −p̂ν − q̂ to what is known of the facets, and their forces to a vector.
    pub fn enter(&self, skeleton: &Skeleton, given: &mut [FacetGiven], forces: &mut [f64]) {
        let mesh = &self.solved.problem.mesh;
        for facet in &self.facets {
            let shape = facet.element.shape;
            // On a parallelogram the degrees of both coordinates add up.
            let degree = if shape == Shape::Quadrilateral { 2 } else { 1 } * facet.element.degree + 2;
            let rule = traction_rule(shape, degree);
            let points = rule.points.clone();
            let table = ShapeTable::of_rule(facet.element, rule);
            let mut map = FacetMap::new(mesh, &table);
            for (q, x) in points.iter().enumerate() {
                map.at(&facet.nodes, q);
                let hats = linear_functions(shape, facet.element, x);
                let weight = table.weights[q] * map.area;
                let shares = facet.shares(x);
                let traction: Point = std::array::from_fn(|c| {
                    let at = |v: usize| 0.0 - facet.pressure[v] * facet.normal[c] - facet.friction[v][c];
                    shares.iter().enumerate().map(|(v, value)| value * at(v)).sum()
                });
                for (&node, value) in facet.nodes.iter().zip(map.values()) {
                    let first = node as usize * mesh.dim;
                    (0..mesh.dim).for_each(|c| forces[first + c] += weight * value * traction[c]);
                }
                let known = &mut given[facet.facet];
                for (value, &node) in hats.iter().zip(&facet.nodes) {
                    if let Some(place) = skeleton.facets[facet.facet].place(node) {
                        known.add(place, weight * value, &traction);
                    }
                }
            }
        }
    }

    /// ∫ Φ(r) + Φ*(p̂) − p̂ r + s‖d‖ − q̂·d over a facet, J.
    pub fn term(&self, facet: &ContactFacet, u: &[f64]) -> f64 {
        let mesh = &self.solved.problem.mesh;
        let contact = &self.solved.contacts[facet.contact];
        let shape = facet.element.shape;
        let kind = self.kinds[facet.contact];
        let degree = facet.element.degree;
        let fine = pieces(shape, if shape == Shape::Quadrilateral { 4 * degree + 1 } else { 2 * degree + 3 });
        let points = fine.points.clone();
        let table = ShapeTable::of_rule(facet.element, fine);
        let mut map = FacetMap::new(mesh, &table);
        let r: Vec<f64> = (0..facet.nodes.len()).map(|place| self.penetration(facet, place, u)).collect();
        let slip: Vec<Point> = facet.slip.iter().map(|d| tangential(d, &facet.normal)).collect();
        let mut sum = 0.0;
        for (q, x) in points.iter().enumerate() {
            map.at(&facet.nodes, q);
            let hats = facet.shares(x);
            let linear = |values: &[f64]| -> f64 { hats.iter().zip(values).map(|(a, b)| a * b).sum() };
            let (p, s) = (linear(&facet.pressure), linear(&facet.bound));
            let penetration: f64 = map.values().iter().zip(&r).map(|(a, b)| a * b).sum();
            let normal = match kind {
                Some(NormalKind::Function) => fenchel(contact.normal.as_ref(), &map.position, penetration, p),
                Some(NormalKind::Rigid) => (0.0 - p * penetration).max(0.0),
                _ => 0.0,
            };
            let d: Point = std::array::from_fn(|c| map.values().iter().zip(&slip).map(|(a, d)| a * d[c]).sum());
            let q_hat: Point = std::array::from_fn(|c| hats.iter().zip(&facet.friction).map(|(a, q)| a * q[c]).sum());
            let friction = if s.is_finite() { (s * length(&d) - dot(&q_hat, &d)).max(0.0) } else { 0.0 };
            sum += table.weights[q] * map.area * (normal + friction);
        }
        sum
    }
}

/// The part of a vector along the side.
fn tangential(v: &Point, nu: &Point) -> Point {
    let along = dot(v, nu);
    std::array::from_fn(|c| v[c] - along * nu[c])
}

/// The ends of the edge of a quadratic facet whose middle a node is, n the number of vertices.
fn edge(n: usize, place: usize) -> [usize; 2] {
    match (n, place) {
        (2, _) => [0, 1],
        (_, place) => [(place - n) % n, (place - n + 1) % n],
    }
}

/// The tractions σν of the cell of a facet at its vertices.
fn stresses_at_vertices(
    laws: &StepLaws,
    skeleton: &Skeleton,
    facet: &ContactFacet,
    motion: &StepMotion,
) -> Vec<(u32, Point)> {
    let Some(&(cell, _)) = skeleton.facets[facet.facet].cells.first() else { return Vec::new() };
    let (nodes, element) = (skeleton.nodes(laws.mesh, cell), skeleton.tables(cell).element);
    let table = ShapeTable::at(element, element.nodes);
    let mut map = CellMap::new(laws.mesh, &table);
    let vertices = facet.nodes.iter().take(facet.pressure.len());
    vertices
        .filter_map(|node| {
            map.at(nodes, nodes.iter().position(|own| own == node)?);
            Some((*node, laws.at(laws.region(skeleton, cell), &map, nodes, motion).apply(&facet.normal)))
        })
        .collect()
}

/// Φ(r) + Φ*(p) − p r of a law that is a nondecreasing function, J/m².
fn fenchel(law: &dyn NormalLaw, x: &Point, r: f64, p: f64) -> f64 {
    let pressure = |r: f64| law.pressure(x, r, 0.0, 0.0).value;
    let conjugate = if p <= 0.0 {
        0.0
    } else {
        // The largest r* with a pressure of at most p: p r − Φ(r) is largest there.
        let (mut low, mut high) = (0.0, r.abs().max(f64::MIN_POSITIVE));
        let mut doublings = 0;
        while pressure(high) < p && doublings < 2100 {
            (low, high) = (high, 2.0 * high);
            doublings += 1;
        }
        for _ in 0..200 {
            let middle = f64::midpoint(low, high);
            if middle <= low || middle >= high {
                break;
            }
            if pressure(middle) < p { low = middle } else { high = middle }
        }
        p * high - law.potential(x, high)
    };
    (law.potential(x, r) + conjugate - p * r).max(0.0)
}

/// A rule on the parts of a shape, fine where kinks of the laws cut it.
fn pieces(shape: Shape, degree: usize) -> QuadratureRule {
    match shape {
        // A triangle of a parallelogram is half as long.
        Shape::Quadrilateral => on_triangles(&parts(Shape::Triangle, degree, 4)),
        _ => parts(shape, degree, 8),
    }
}

/// A rule on a number of parts per edge.
fn parts(shape: Shape, degree: usize, count: usize) -> QuadratureRule {
    let whole = rule(shape, degree);
    let step = 1.0 / count as f64;
    let mut fine = QuadratureRule { points: Vec::new(), weights: Vec::new() };
    let mut add = |of: &dyn Fn(&Point) -> Point, share: f64| {
        for (x, weight) in whole.iter() {
            fine.points.push(of(x));
            fine.weights.push(weight * share);
        }
    };
    match shape {
        Shape::Segment => {
            for i in 0..count {
                add(&|x| [(i as f64 + x[0]) * step, 0.0, 0.0], step);
            }
        }
        Shape::Triangle => {
            for i in 0..count {
                for j in 0..count - i {
                    let corner = [i as f64 * step, j as f64 * step];
                    add(&|x| [corner[0] + step * x[0], corner[1] + step * x[1], 0.0], step * step);
                    if i + j + 1 < count {
                        let far = [corner[0] + step, corner[1] + step];
                        add(&|x| [far[0] - step * x[0], far[1] - step * x[1], 0.0], step * step);
                    }
                }
            }
        }
        _ => return whole,
    }
    fine
}
