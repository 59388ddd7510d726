//! Wear of the sides of pairs: the depth belongs to the surface of a body and moves with it, regardless of which side
//! bears the contact points.
//!
//! The depth of a side is h = Σ_a h_a L_a, L_a the linear functions of the vertices of its facets. The volume worn off
//! at a contact point i in a step is ω_i d_i, d_i = k κ p_i ‖w_τ‖: a fraction of it comes off the side `on`, the rest
//! off the side `with`. On each side it is distributed to the vertices by shares W_ia ≥ 0, Σ_a W_ia = 1, and the depth
//! there grows by the volume over the area A_a of the vertex,
//!
//! ```text
//!     δh_a = Σ_i W_ia ω_i d_i / A_a,      g_i = gap of the geometry + Σ_a W_ia h_a of both sides,
//! ```
//!
//! so that ∫h = Σ A_a h_a is the volume worn off. A_a is ∫L_a if the pair is updated; otherwise it is the part that the
//! other side faces, Σ_i W_ia ω_i.

use std::collections::BTreeMap;

use super::boundary::{ContactBoundary, PointOnBoundary};
use super::{Contact, Pair};
use crate::element::{Element, ShapeTable};
use crate::mesh::{FacetMap, FacetSet, Link, Mesh, leader};
use crate::quadrature::rule;

/// Fraction of the area of a vertex that is round-off.
const NONE: f64 = 1e-12;

/// Values by vertex of a side.
type VertexValues = Vec<(usize, f64)>;

/// The sides of pairs that wear, with the vertices that keep the depth.
#[derive(Clone, Debug, Default)]
pub struct WornSides {
    sides: Vec<WornSide>,
    /// By contact, the numbers of the sides `on` and `with`; `None` for a side that does not wear.
    of_contact: Vec<[Option<usize>; 2]>,
}

/// One side.
#[derive(Clone, Debug)]
struct WornSide {
    name: String,
    /// The vertices whose linear functions do not vanish at each node of the side, with the values there.
    vertices: BTreeMap<u32, VertexValues>,
    /// A_a by vertex, m^(d−1).
    areas: Vec<f64>,
}

/// Material worn off the sides of pairs, in a step or since the start.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Worn {
    /// Wear depth of each side by vertex, m.
    pub depths: Vec<Vec<f64>>,
    /// Volume worn off the sides `on` and `with` of each contact, m^d; zero for foundations.
    pub volumes: Vec<[f64; 2]>,
}

impl WornSides {
    /// The sides of pairs that wear, with the contact points of the bodies at rest. Nodes that follow others, as on the
    /// cut of a sector, share the depth of their leaders.
    #[must_use]
    pub fn new(mesh: &Mesh, contacts: &[Contact], boundary: &ContactBoundary, links: &[Link]) -> WornSides {
        let mut all = WornSides::default();
        let wearing = |contact: &&Contact| contact.pair.is_some() && contact.wear.is_some();
        for contact in contacts.iter().filter(wearing) {
            for (name, _) in contact.sides().zip(contact.wear_fractions()).filter(|(_, fraction)| *fraction > 0.0) {
                if let Some(set) = mesh.facets.get(name).filter(|_| all.find(name).is_none()) {
                    all.sides.push(WornSide::new(mesh, name, set, links));
                }
            }
        }
        let of = |contact: &Contact| {
            let mut sides = contact.sides().map(|name| all.find(name).filter(|_| contact.pair.is_some()));
            [sides.next().flatten(), sides.next().flatten()]
        };
        all.of_contact = contacts.iter().map(of).collect();
        let stays = |side: usize| {
            let pairs = contacts.iter().zip(&all.of_contact).filter(|(_, sides)| sides.contains(&Some(side)));
            pairs.into_iter().all(|(contact, _)| !contact.pair.as_ref().is_some_and(Pair::is_updated))
        };
        let faced = all.faced(contacts, boundary);
        for (side, faced) in (0..all.sides.len()).zip(faced).filter(|(side, _)| stays(*side)).collect::<Vec<_>>() {
            all.sides[side].areas = faced;
        }
        all
    }

    /// The state without wear.
    #[must_use]
    pub fn fresh(&self) -> Worn {
        let depths = self.sides.iter().map(|side| vec![0.0; side.areas.len()]).collect();
        Worn { depths, volumes: vec![[0.0; 2]; self.of_contact.len()] }
    }

    /// The number of depths per side in a state.
    #[must_use]
    pub fn lengths(&self) -> Vec<usize> {
        self.sides.iter().map(|side| side.areas.len()).collect()
    }

    fn find(&self, name: &str) -> Option<usize> {
        self.sides.iter().position(|side| side.name == name)
    }

    /// By side and vertex, the part of its area that the points face: Σ_i W_ia ω_i.
    fn faced(&self, contacts: &[Contact], boundary: &ContactBoundary) -> Vec<Vec<f64>> {
        let mut faced: Vec<Vec<f64>> = self.sides.iter().map(|side| vec![0.0; side.areas.len()]).collect();
        for point in boundary.points.iter().filter(|point| contacts[point.contact].wear.is_some()) {
            for (side, shares) in self.of_point(contacts, point).into_iter().flatten() {
                for (vertex, share) in shares {
                    faced[side][vertex] += share * point.weight;
                }
            }
        }
        faced
    }

    /// The shares of a point in the vertices of the sides `on` and `with` that wear, with the numbers of these sides.
    fn of_point(&self, contacts: &[Contact], point: &PointOnBoundary) -> [Option<(usize, VertexValues)>; 2] {
        let sides = self.of_contact.get(point.contact).copied().unwrap_or_default();
        let [own, other] = &point.shares;
        let shares = if contacts[point.contact].sign() > 0.0 { [own, other] } else { [other, own] };
        [0, 1].map(|k| {
            let side = sides[k]?;
            let vertices = &self.sides.get(side)?.vertices;
            let mut sums = BTreeMap::<usize, f64>::new();
            for share in shares[k] {
                for &(vertex, value) in vertices.get(&share.node).into_iter().flatten() {
                    *sums.entry(vertex).or_default() += share.part * value;
                }
            }
            Some((side, sums.into_iter().collect()))
        })
    }

    /// At each contact point, the depth off both sides of its pair in m, and the opening of the gap per depth worn off
    /// there: the fraction of the areas of its vertices that is faced, 1 if all of it is. At foundations they are
    /// `worn` and 1.
    #[must_use]
    pub fn at_points(
        &self,
        contacts: &[Contact],
        boundary: &ContactBoundary,
        worn: &[f64],
        depths: &[Vec<f64>],
    ) -> Vec<[f64; 2]> {
        if contacts.iter().all(|contact| contact.wear.is_none()) && self.sides.is_empty() {
            return Vec::new();
        }
        let faced = self.faced(contacts, boundary);
        let at = |(i, point): (usize, &PointOnBoundary)| {
            let contact = &contacts[point.contact];
            if contact.pair.is_none() {
                return [worn.get(i).copied().unwrap_or(0.0), 1.0];
            }
            let (mut depth, mut opening) = (0.0, 0.0);
            let sides = self.of_point(contacts, point).into_iter().zip(contact.wear_fractions());
            for (side, shares, fraction) in sides.filter_map(|(of, fraction)| of.map(|(i, all)| (i, all, fraction))) {
                for (vertex, share) in shares {
                    depth += share * depths[side][vertex];
                    opening += fraction * share * self.sides[side].part(vertex, faced[side][vertex]);
                }
            }
            [depth, opening]
        };
        boundary.points.iter().enumerate().map(at).collect()
    }

    /// The wear after the depths `worn` in m have come off at the contact points.
    #[must_use]
    pub fn after(&self, contacts: &[Contact], boundary: &ContactBoundary, before: &Worn, worn: &[f64]) -> Worn {
        let mut after = before.clone();
        for (point, depth) in boundary.points.iter().zip(worn).filter(|(_, depth)| **depth > 0.0) {
            let contact = &contacts[point.contact];
            let sides = self.of_point(contacts, point).into_iter().zip(contact.wear_fractions()).enumerate();
            for (k, (of, fraction)) in sides {
                let Some((side, shares)) = of else { continue };
                let volume = fraction * point.weight * depth;
                after.volumes[point.contact][k] += volume;
                for (vertex, share) in shares {
                    let area = self.sides[side].areas[vertex];
                    if area > 0.0 {
                        after.depths[side][vertex] += share * volume / area;
                    }
                }
            }
        }
        after
    }

    /// At each contact point the depth off both sides of its pair, m; zero at foundations. It is linear in the depths
    /// of the vertices.
    #[must_use]
    pub fn depths_at(&self, contacts: &[Contact], boundary: &ContactBoundary, depths: &[Vec<f64>]) -> Vec<f64> {
        let mut all = vec![0.0; boundary.points.len()];
        self.visit(contacts, boundary, |i, [side, vertex], [share, _]| all[i] += share * depths[side][vertex]);
        all
    }

    /// The transposed of [`WornSides::depths_at`].
    #[must_use]
    pub fn depths_at_transposed(
        &self,
        contacts: &[Contact],
        boundary: &ContactBoundary,
        weights: &[f64],
    ) -> Vec<Vec<f64>> {
        let mut all = self.fresh().depths;
        self.visit(contacts, boundary, |i, [side, vertex], [share, _]| all[side][vertex] += share * weights[i]);
        all
    }

    /// The growth of the depths of the vertices by depths that come off at the contact points, in which it is linear,
    /// m.
    #[must_use]
    pub fn growth(&self, contacts: &[Contact], boundary: &ContactBoundary, worn: &[f64]) -> Vec<Vec<f64>> {
        let mut all = self.fresh().depths;
        self.visit(contacts, boundary, |i, [side, vertex], [_, part]| all[side][vertex] += part * worn[i]);
        all
    }

    /// The transposed of [`WornSides::growth`].
    #[must_use]
    pub fn growth_transposed(
        &self,
        contacts: &[Contact],
        boundary: &ContactBoundary,
        weights: &[Vec<f64>],
    ) -> Vec<f64> {
        let mut all = vec![0.0; boundary.points.len()];
        self.visit(contacts, boundary, |i, [side, vertex], [_, part]| all[i] += part * weights[side][vertex]);
        all
    }

    /// Shows each point of a pair with each side and vertex: the share W_ia, and the growth of the depth there per
    /// depth that comes off at the point.
    fn visit(
        &self,
        contacts: &[Contact],
        boundary: &ContactBoundary,
        mut see: impl FnMut(usize, [usize; 2], [f64; 2]),
    ) {
        if self.sides.is_empty() {
            return;
        }
        for (i, point) in boundary.points.iter().enumerate() {
            let fractions = contacts[point.contact].wear_fractions();
            for (of, fraction) in self.of_point(contacts, point).into_iter().zip(fractions) {
                let Some((side, shares)) = of else { continue };
                for (vertex, share) in shares {
                    let area = self.sides[side].areas[vertex];
                    let part = if area > 0.0 { fraction * point.weight * share / area } else { 0.0 };
                    see(i, [side, vertex], [share, part]);
                }
            }
        }
    }

    /// The depth off a side of a contact at a node, m; `None` if this side does not wear or has no such node.
    #[must_use]
    pub fn depth(&self, contact: usize, is_on: bool, node: u32, depths: &[Vec<f64>]) -> Option<f64> {
        let side = self.of_contact.get(contact)?[usize::from(!is_on)]?;
        let vertices = self.sides[side].vertices.get(&node)?;
        Some(vertices.iter().map(|&(vertex, value)| value * depths[side][vertex]).sum())
    }

    /// The area and the depth of each vertex of a side; `None` if the side does not wear.
    #[must_use]
    pub fn of_side<'a>(&'a self, name: &str, depths: &'a [Vec<f64>]) -> Option<impl Iterator<Item = (f64, f64)> + 'a> {
        let side = self.find(name)?;
        Some(self.sides[side].areas.iter().copied().zip(depths.get(side)?.iter().copied()))
    }

    /// The largest depth on either side of a contact, m.
    #[must_use]
    pub fn largest(&self, contact: usize, depths: &[Vec<f64>]) -> f64 {
        let sides = self.of_contact.get(contact).into_iter().flatten().flatten();
        sides.filter_map(|&side| depths.get(side)).flat_map(|of| of.iter()).fold(0.0, |most, depth| depth.max(most))
    }
}

impl WornSide {
    fn new(mesh: &Mesh, name: &str, set: &FacetSet, links: &[Link]) -> WornSide {
        let (mut numbers, mut vertices, mut areas) = (BTreeMap::new(), BTreeMap::new(), Vec::new());
        for block in &set.blocks {
            let linear = Element::find(block.element.shape, 1).unwrap_or(block.element);
            let corners = block.element.shape.vertices();
            let degree = 2 * block.element.degree + usize::from(mesh.axisymmetric);
            let [table, functions] =
                [block.element, linear].map(|element| ShapeTable::of_rule(element, rule(element.shape, degree)));
            let (mut map, mut values) = (FacetMap::new(mesh, &table), vec![0.0; linear.nodes.len()]);
            for facet in block.nodes.chunks_exact(block.element.nodes.len()) {
                let of_corners: Vec<usize> = facet[..corners]
                    .iter()
                    .map(|&node| {
                        *numbers.entry(leader(links, node)).or_insert_with(|| {
                            areas.push(0.0);
                            areas.len() - 1
                        })
                    })
                    .collect();
                for (node, at) in facet.iter().zip(block.element.nodes) {
                    (linear.shape_functions)(at, &mut values);
                    let shares = of_corners.iter().copied().zip(values.iter().copied());
                    vertices.entry(*node).or_insert_with(|| shares.filter(|(_, value)| *value != 0.0).collect());
                }
                for q in 0..table.len() {
                    map.at(facet, q);
                    for (&vertex, value) in of_corners.iter().zip(functions.values(q)) {
                        areas[vertex] += table.weights[q] * map.area * value;
                    }
                }
            }
        }
        WornSide { name: name.to_owned(), vertices, areas }
    }

    /// The fraction of the area of a vertex that is faced.
    fn part(&self, vertex: usize, faced: f64) -> f64 {
        let area = self.areas[vertex];
        if faced >= area * (1.0 - NONE) { 1.0 } else { faced / area }
    }
}
