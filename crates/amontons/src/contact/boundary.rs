//! Γ_C on a mesh: contact points with their normals, weights and gaps.

use super::mortar::{Mortar, MortarRow, NodeShare, SectorImage};
use super::{
    Fluid, FrictionLaw, Frictionless, GraphKind, HeatLaw, Insulated, LumpedFoundation, NormalLaw, Obstacle, Pair,
    Preload, WearLaw,
};
use crate::element::{Element, ShapeTable};
use crate::field::{Field, Law};
use crate::mesh::{FacetMap, FacetSet, Link, Mesh};
use crate::quadrature::{QuadratureRule, Shape};
use crate::tensor::Point;
use crate::time::During;

#[cfg(test)]
mod tests;

/// Points at which the integrals over Γ_C are evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Quadrature {
    /// At the nodes, with positive weights ω_i (∫ N_i of linear facets): each contact node obeys the laws on its own.
    #[default]
    Nodal,
    /// At the points of a rule of twice the degree on each facet, hence two for P1 segments and three for P1 triangles:
    /// the laws hold at each point.
    Gauss,
}

/// Contact of one part of the boundary with the foundation or with a side of a deformable body. Make it by
/// [`Contact::new`], then set its fields.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Contact {
    /// Name of the facet set that is Γ_C. Several contacts may be on one side.
    pub on: String,
    /// Name of the contact in results; if empty, the name of its side is used, see [`super::names()`].
    pub name: String,
    /// The other side of a pair; `None` if the foundation is rigid.
    pub pair: Option<Pair>,
    /// g in m; for a pair, an offset added to the geometric gap, or the gap itself if it is given.
    pub gap: Field,
    /// Points at which the laws are evaluated.
    pub quadrature: Quadrature,
    /// p_ν.
    pub normal: Law<dyn NormalLaw>,
    /// p_τ.
    pub friction: Law<dyn FrictionLaw>,
    /// k_c and φ_L.
    pub heat: Law<dyn HeatLaw>,
    /// θ_F in K; the initial value if the foundation has a heat capacity.
    pub foundation_temperature: Field,
    /// The heat capacity of the foundation; `None` if θ_F is prescribed.
    pub foundation_heat: Option<LumpedFoundation>,
    /// The foundation as a rigid surface; `None` if the gap alone describes it, along the normal of the body.
    pub obstacle: Option<Obstacle>,
    /// The wear law; `None` without wear.
    pub wear: Option<Law<dyn WearLaw>>,
    /// Fraction of the wear depth that comes off the side `on`; the rest comes off the opposite side.
    pub wear_fraction: f64,
    /// v_F in m/s, one field per component; empty for a foundation at rest. Only its tangential part counts: motion
    /// along ν is described by the gap. For a pair it is added to the velocity of the side `with`.
    pub foundation_velocity: Vec<Field>,
    /// The tension to which the section of a tie is tightened; `None` without preload.
    pub preload: Option<Preload>,
    /// A fluid that enters where the contact is open; `None` without a fluid.
    pub fluid: Option<Fluid>,
    /// The phases in which the contact acts.
    pub during: During,
}

impl Contact {
    /// Contact of the facet set `on` by this law p_ν at its nodes, without gap, friction, heat exchange and wear. The
    /// foundation is at rest.
    #[must_use]
    pub fn new(on: impl Into<String>, normal: impl Into<Law<dyn NormalLaw>>) -> Contact {
        Contact {
            on: on.into(),
            name: String::new(),
            pair: None,
            gap: Field::ZERO,
            quadrature: Quadrature::Nodal,
            normal: normal.into(),
            friction: Frictionless.into(),
            heat: Insulated.into(),
            foundation_temperature: Field::ZERO,
            foundation_heat: None,
            obstacle: None,
            wear: None,
            wear_fraction: 1.0,
            foundation_velocity: Vec::new(),
            preload: None,
            fluid: None,
            during: During::Run,
        }
    }

    /// Makes it a contact with a side of a deformable body.
    #[must_use]
    pub fn with(self, pair: Pair) -> Contact {
        Contact { pair: Some(pair), ..self }
    }

    /// The side with the contact points: for a pair the nonmortar side.
    #[must_use]
    pub fn bearing(&self) -> &str {
        self.pair.as_ref().filter(|pair| pair.on_is_mortar).map_or(&self.on, |pair| &pair.with)
    }

    /// The side opposite to the bearing one; `None` if the foundation is rigid.
    #[must_use]
    pub fn facing(&self) -> Option<&str> {
        self.pair.as_ref().map(|pair| if pair.on_is_mortar { self.on.as_str() } else { pair.with.as_str() })
    }

    /// Both sides.
    pub fn sides(&self) -> impl Iterator<Item = &str> {
        std::iter::once(self.on.as_str()).chain(self.pair.as_ref().map(|pair| pair.with.as_str()))
    }

    /// True if heat passes between the side and a rigid foundation.
    #[must_use]
    pub fn warms_from_foundation(&self) -> bool {
        self.pair.is_none() && self.heat.conductance_bound() > 0.0
    }

    /// True if the foundation, or the mortar side, slides in a direction in which a body in `dim` dimensions cannot
    /// move: out of its plane or line, or about its axis of revolution.
    #[must_use]
    pub fn slides_out(&self, dim: usize) -> bool {
        self.foundation_velocity.iter().skip(dim).any(|v| !v.is_zero())
    }

    /// Factor ±1 that converts a force on the bearing side into a force on the side `on`.
    #[must_use]
    pub fn sign(&self) -> f64 {
        if self.pair.as_ref().is_some_and(|pair| pair.on_is_mortar) { -1.0 } else { 1.0 }
    }

    /// The fractions of the wear depth that come off the side `on` and off the opposite side.
    #[must_use]
    pub fn wear_fractions(&self) -> [f64; 2] {
        [self.wear_fraction, 1.0 - self.wear_fraction]
    }

    /// True if all friction power enters the bodies, as at a pair: the part that does not enter the bearing side enters
    /// the other.
    #[must_use]
    pub fn rubs(&self) -> bool {
        self.pair.is_some()
    }

    /// True if the contact is a tie: its two sides neither separate nor slip and keep their distance at rest.
    #[must_use]
    pub fn is_tie(&self) -> bool {
        self.pair.is_some() && self.normal.graph() == GraphKind::Bilateral && self.friction.never_slips()
    }

    /// Sets the friction law p_τ.
    #[must_use]
    pub fn friction(self, law: impl Into<Law<dyn FrictionLaw>>) -> Contact {
        Contact { friction: law.into(), ..self }
    }

    /// Sets the law of heat exchange and the foundation temperature θ_F in K.
    #[must_use]
    pub fn heat(self, law: impl Into<Law<dyn HeatLaw>>, foundation_temperature: impl Into<Field>) -> Contact {
        Contact { heat: law.into(), foundation_temperature: foundation_temperature.into(), ..self }
    }

    /// The contact with its laws at a time; `None` if no law changes with time.
    #[must_use]
    pub fn at_time(&self, t: f64) -> Option<Contact> {
        let wear = self.wear.as_ref().and_then(|law| law.at_time(t));
        let (friction, heat) = (self.friction.at_time(t), self.heat.at_time(t));
        let normal = self.normal.at_time(t);
        if normal.is_none() && friction.is_none() && heat.is_none() && wear.is_none() {
            return None;
        }
        Some(Contact {
            normal: normal.unwrap_or_else(|| self.normal.clone()),
            friction: friction.unwrap_or_else(|| self.friction.clone()),
            heat: heat.unwrap_or_else(|| self.heat.clone()),
            wear: wear.or_else(|| self.wear.clone()),
            ..self.clone()
        })
    }

    /// The gap in m at points of the body at rest: the given gap plus the distance to the obstacle.
    #[must_use]
    pub fn gaps(&self, points: &[Point], t: f64) -> Vec<f64> {
        let mut gaps = self.gap.values(points, t);
        if let Some(obstacle) = &self.obstacle {
            gaps.iter_mut().zip(points).for_each(|(gap, x)| *gap += obstacle.nearest(x, t).distance);
        }
        gaps
    }

    /// True if the gap of the body at rest may change with time.
    #[must_use]
    pub fn gap_depends_on_time(&self) -> bool {
        let moves = self.obstacle.as_ref().is_some_and(Obstacle::depends_on_time);
        self.gap.depends_on_time() || moves || self.preload.is_some()
    }
}

/// A point of Γ_C at which the laws are evaluated.
#[derive(Clone, Debug)]
pub struct PointOnBoundary {
    /// Position in m.
    pub x: Point,
    /// Unit outward normal ν.
    pub normal: Point,
    /// Weight ω in m^(d−1).
    pub weight: f64,
    /// Number of the contact of the problem to which the point belongs.
    pub contact: usize,
    /// Contact nodes (indices into [`ContactBoundary::nodes`]) with the value of their shape function here; for a pair
    /// also the nodes of the other side, with the opposite sign, so that the sum is the jump.
    pub nodes: Vec<(usize, f64)>,
    /// Number of these entries on the side of the point; they come first.
    pub own: usize,
    /// Numbers of the entries of `nodes` whose nodes are in another sector: vectors there are turned into the sector of
    /// the point. Empty except at the cut of a sector.
    pub turned: Vec<(usize, SectorImage)>,
    /// The geometric gap of a pair in m; zero at a foundation.
    pub gap: f64,
    /// Amount added to −ν·(B X) to bring the gap into the range of the distances about the point, m.
    pub clamped: f64,
    /// Amount added to the gap to close an overlap of the bodies at rest, m.
    pub closed: f64,
    /// For a pair, shares by which quantities at the point are distributed to the nodes of its own and of the other
    /// side; empty at a foundation.
    pub shares: [Vec<NodeShare>; 2],
    /// Directions along the side in which friction has no component because both sides of a pair are held alike in
    /// them; filled up with zeros.
    pub held: [Point; 3],
}

impl PointOnBoundary {
    /// The entries of the jump: contact node, value, and the sector of the node if it differs from that of the point.
    pub fn entries(&self) -> impl Iterator<Item = (usize, f64, Option<&SectorImage>)> {
        let mut turned = self.turned.iter().peekable();
        self.nodes.iter().enumerate().map(move |(entry, &(node, value))| {
            (node, value, turned.next_if(|(turned, _)| *turned == entry).map(|(_, image)| image))
        })
    }
}

/// The side of one contact.
pub enum Side<'a> {
    /// A side that faces a rigid foundation, and nodes that follow others.
    Foundation(&'a FacetSet, Quadrature, &'a [Link]),
    /// A pair of sides, and additional contact nodes besides those of its rows.
    Pair(Mortar, Vec<u32>),
}

/// Γ_C on a mesh.
#[derive(Clone, Debug, Default)]
pub struct ContactBoundary {
    /// Mesh nodes of Γ_C, ascending.
    pub nodes: Vec<u32>,
    /// The points of the quadrature.
    pub points: Vec<PointOnBoundary>,
}

impl ContactBoundary {
    /// Places the contact points on a facet set.
    #[must_use]
    pub fn new(mesh: &Mesh, set: &FacetSet, quadrature: Quadrature) -> ContactBoundary {
        ContactBoundary::on(mesh, &[(set, quadrature)])
    }

    /// Places the contact points on several facet sets, set after set. A node of two sets has a point on each.
    #[must_use]
    pub fn on(mesh: &Mesh, sides: &[(&FacetSet, Quadrature)]) -> ContactBoundary {
        let sides: Vec<Side> = sides.iter().map(|&(set, quadrature)| Side::Foundation(set, quadrature, &[])).collect();
        ContactBoundary::of(mesh, &sides)
    }

    /// Places the contact points on sides that face foundations or each other.
    #[must_use]
    pub fn of(mesh: &Mesh, sides: &[Side]) -> ContactBoundary {
        let of_side = |side: &Side| match side {
            Side::Foundation(set, ..) => set.node_list(),
            Side::Pair(mortar, kept) => {
                let of_row = |row: &MortarRow| row.own.iter().chain(&row.other).map(|(node, _)| *node).collect();
                mortar.rows.iter().flat_map(|row| -> Vec<u32> { of_row(row) }).chain(kept.iter().copied()).collect()
            }
        };
        let mut nodes: Vec<u32> = sides.iter().flat_map(of_side).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let local = |node: u32| nodes.binary_search(&node).unwrap_or_else(|slot| slot);
        let mut points = Vec::new();
        for (side, of) in sides.iter().enumerate() {
            let mut on_side = match of {
                Side::Foundation(set, Quadrature::Nodal, links) => nodal_points(mesh, set, links, local),
                Side::Foundation(set, Quadrature::Gauss, _) => gauss_points(mesh, set, local),
                Side::Pair(mortar, _) => mortar.rows.iter().map(|row| pair_point(mesh, row, local)).collect(),
            };
            for point in &mut on_side {
                point.contact = side;
            }
            points.append(&mut on_side);
        }
        ContactBoundary { nodes, points }
    }

    /// Replaces the points of some pairs, given by contact number; nodes and number of points do not change.
    #[must_use]
    pub fn with(&self, mesh: &Mesh, pairs: &[(usize, Mortar)]) -> ContactBoundary {
        let local = |node: u32| self.nodes.binary_search(&node).unwrap_or_else(|slot| slot);
        let mut points = self.points.clone();
        for (contact, mortar) in pairs {
            let of_pair = points.iter_mut().filter(|point| point.contact == *contact);
            for (point, row) in of_pair.zip(&mortar.rows) {
                *point = PointOnBoundary { contact: *contact, ..pair_point(mesh, row, local) };
            }
        }
        ContactBoundary { nodes: self.nodes.clone(), points }
    }

    /// The values at the contact nodes of a field with `components` components per node, both node-major.
    #[must_use]
    pub fn restricted(&self, components: usize, values: &[f64]) -> Vec<f64> {
        let mut restricted = Vec::with_capacity(self.nodes.len() * components);
        for &node in &self.nodes {
            restricted.extend_from_slice(&values[node as usize * components..(node as usize + 1) * components]);
        }
        restricted
    }

    /// Adds values at the nodes of Γ_C to those of a field at all nodes: the transposed of
    /// [`ContactBoundary::restricted`].
    pub fn add_restricted(&self, components: usize, values: &[f64], sum: &mut [f64]) {
        for (&node, values) in self.nodes.iter().zip(values.chunks_exact(components)) {
            let first = node as usize * components;
            sum[first..first + components].iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        }
    }

    /// N v at a contact point: the value of a vector field over all nodes.
    #[must_use]
    pub fn vector_at(&self, point: &PointOnBoundary, dim: usize, values: &[f64]) -> Point {
        let mut v = [0.0; 3];
        for (node, value, turn) in point.entries() {
            let first = self.nodes[node] as usize * dim;
            let at_node: Point = std::array::from_fn(|c| if c < dim { values[first + c] } else { 0.0 });
            let at_node = turn.map_or(at_node, |turn| turn.vector(&at_node));
            (0..dim).for_each(|c| v[c] += value * at_node[c]);
        }
        v
    }

    /// The values of a scalar field over all nodes at the contact points, on the side `on` of each contact, regardless
    /// of which side of a pair bears the points; zero where a point of the other side faces nothing.
    #[must_use]
    pub fn scalars_on(&self, contacts: &[Contact], values: &[f64]) -> Vec<f64> {
        let at = |point: &PointOnBoundary| {
            let (own, other) = point.nodes.split_at(point.own);
            let sum = |nodes: &[(usize, f64)]| -> f64 {
                nodes.iter().map(|&(node, value)| value * values[self.nodes[node] as usize]).sum()
            };
            // The shares of the other side are negative in the jump.
            if contacts[point.contact].sign() > 0.0 { sum(own) } else { 0.0 - sum(other) }
        };
        self.points.iter().map(at).collect()
    }

    /// Adds Σ ω Nᵀ f for scalars at the contact points: the first of each two values leaves one side, the second enters
    /// the other.
    pub fn scatter_heat(&self, fluxes: impl Iterator<Item = [f64; 2]>, sum: &mut [f64]) {
        for (point, [out, into]) in self.points.iter().zip(fluxes) {
            for (i, &(node, value)) in point.nodes.iter().enumerate() {
                let flux = if i < point.own { out } else { into };
                sum[self.nodes[node] as usize] += point.weight * value * flux;
            }
        }
    }

    /// Adds Σ ω Nᵀ f of vectors at the contact points (or of scalars, in their first component) to a field with
    /// `components` components at all nodes.
    pub fn scatter(&self, components: usize, vectors: impl Iterator<Item = Point>, sum: &mut [f64]) {
        for (point, vector) in self.points.iter().zip(vectors) {
            for (node, value, turn) in point.entries() {
                let at_node = turn.filter(|_| components > 1).map_or(vector, |turn| turn.back(&vector));
                for c in 0..components {
                    sum[self.nodes[node] as usize * components + c] += point.weight * value * at_node[c];
                }
            }
        }
    }
}

/// The contact point of a mortar row.
fn pair_point(mesh: &Mesh, row: &MortarRow, local: impl Fn(u32) -> usize) -> PointOnBoundary {
    let own = row.own.iter().map(|&(node, share)| (local(node), share));
    let other = row.other.iter().map(|&(node, share)| (local(node), -share));
    PointOnBoundary {
        x: mesh.points[row.node as usize],
        normal: row.normal,
        weight: row.weight,
        contact: 0,
        nodes: own.chain(other).collect(),
        own: row.own.len(),
        turned: row.turned.clone(),
        gap: row.gap,
        clamped: row.gap - row.gap_of_rows,
        closed: 0.0,
        shares: row.shares.clone(),
        held: row.held,
    }
}

/// One point per node: weight ω_i = ∫ φ_i, and the mean of the facet normals there, weighted by their shares in ω_i.
/// The facets at a node include, turned, those at a node that follows it.
fn nodal_points(mesh: &Mesh, set: &FacetSet, links: &[Link], local: impl Fn(u32) -> usize) -> Vec<PointOnBoundary> {
    let nodes = set.node_list();
    let on_set = |node: u32| nodes.binary_search(&node).unwrap_or_else(|slot| slot);
    let mut points: Vec<PointOnBoundary> = nodes
        .iter()
        .map(|&n| PointOnBoundary {
            x: mesh.points[n as usize],
            normal: [0.0; 3],
            weight: 0.0,
            contact: 0,
            nodes: vec![(local(n), 1.0)],
            own: 1,
            turned: Vec::new(),
            gap: 0.0,
            clamped: 0.0,
            closed: 0.0,
            shares: [Vec::new(), Vec::new()],
            held: [[0.0; 3]; 3],
        })
        .collect();
    for block in &set.blocks {
        let lumping = Lumping::new(mesh, block.element);
        // The normal at the node: on a curved facet a mean over the facet would be wrong by the order of its size.
        let at_nodes = ShapeTable::at(block.element, block.element.nodes);
        let (mut map, mut node_map, n) =
            (FacetMap::new(mesh, &lumping.table), FacetMap::new(mesh, &at_nodes), block.element.nodes.len());
        for facet in block.nodes.chunks_exact(n) {
            let weights = lumping.weights(&mut map, facet);
            for (i, (&node, weight)) in facet.iter().zip(&weights).enumerate() {
                node_map.at(facet, i);
                let point = &mut points[on_set(node)];
                point.weight += weight;
                for d in 0..3 {
                    point.normal[d] += weight * node_map.normal[d];
                }
            }
        }
    }
    for link in links {
        let [Ok(own), Ok(followed)] = [link.node, link.to].map(|node| nodes.binary_search(&node)) else { continue };
        let mean = link.normals(&points[own].normal, &points[followed].normal);
        [points[own].normal, points[followed].normal] = mean;
    }
    points.retain(|point| point.weight > 0.0);
    for point in &mut points {
        let length = crate::tensor::length(&point.normal);
        point.normal = point.normal.map(|c| c / length);
    }
    points
}

/// Functions φ_i that distribute a facet to its nodes: the weights ω_i = ∫ φ_i are those of the shape functions on a
/// flat facet, so that a uniform pressure at the contact points is the consistent load, and nodal quadrature passes the
/// patch test.
///
/// They are the shape functions, whose integrals are the weights of the trapezium rule and of Simpson's, except on two
/// facets where ∫ N_i is zero at some nodes: the quadratic triangle (its vertices) and the quadratic segment swept
/// around an axis (an end on the axis). There the facet is integrated by the rule whose points are its nodes, so that
/// curvature makes no weight negative; nodes without a weight are no contact points. Weights from a split into linear
/// parts would be positive at every node but differ from those of the shape functions: pressures at vertices and middle
/// nodes would oscillate.
pub(super) struct Lumping {
    pub table: ShapeTable,
    /// φ at the points of the table, one per node.
    shares: Vec<f64>,
}

impl Lumping {
    pub fn new(mesh: &Mesh, element: &'static Element) -> Lumping {
        // The area factor is constant on a flat linear facet; r raises the degree in a body of revolution.
        let degree = if element.gradient_degree == 0 { element.degree } else { 2 * element.degree + 1 }
            + usize::from(mesh.axisymmetric);
        let at_nodes = match (element.shape, element.degree) {
            (Shape::Triangle, 2) => true,
            (Shape::Segment, 2) => mesh.axisymmetric,
            _ => false,
        };
        let table = ShapeTable::new(element, degree);
        let n = element.nodes.len();
        if !at_nodes {
            let shares = (0..table.len()).flat_map(|q| table.values(q)).copied().collect();
            return Lumping { table, shares };
        }
        let weight = |i: usize| {
            let sum: f64 = (0..table.len()).map(|q| table.weights[q] * table.values(q)[i]).sum();
            // The integral of a vertex function over the triangle is zero up to round-off.
            if sum.abs() < 1e-12 * element.shape.measure() { 0.0 } else { sum }
        };
        let nodes = QuadratureRule { points: element.nodes.to_vec(), weights: (0..n).map(weight).collect() };
        Lumping {
            table: ShapeTable::of_rule(element, nodes),
            shares: (0..n * n).map(|at| f64::from(u8::from(at / n == at % n))).collect(),
        }
    }

    /// The weights of the nodes of a facet, m^(d−1).
    pub fn weights(&self, map: &mut FacetMap, facet: &[u32]) -> Vec<f64> {
        let mut weights = vec![0.0; facet.len()];
        for (q, shares) in self.shares.chunks_exact(facet.len()).enumerate() {
            map.at(facet, q);
            for (weight, share) in weights.iter_mut().zip(shares) {
                *weight += self.table.weights[q] * map.area * share;
            }
        }
        weights
    }
}

/// The points of a rule of twice the degree on each facet.
fn gauss_points(mesh: &Mesh, set: &FacetSet, local: impl Fn(u32) -> usize) -> Vec<PointOnBoundary> {
    let mut points = Vec::new();
    for block in &set.blocks {
        let table = ShapeTable::new(block.element, 2 * block.element.degree);
        let mut map = FacetMap::new(mesh, &table);
        for facet in block.nodes.chunks_exact(block.element.nodes.len()) {
            for q in 0..table.len() {
                map.at(facet, q);
                let nodes: Vec<_> =
                    facet.iter().zip(map.values()).map(|(&node, &value)| (local(node), value)).collect();
                points.push(PointOnBoundary {
                    x: map.position,
                    normal: map.normal,
                    weight: table.weights[q] * map.area,
                    contact: 0,
                    own: nodes.len(),
                    nodes,
                    turned: Vec::new(),
                    gap: 0.0,
                    clamped: 0.0,
                    closed: 0.0,
                    shares: [Vec::new(), Vec::new()],
                    held: [[0.0; 3]; 3],
                });
            }
        }
    }
    points
}
