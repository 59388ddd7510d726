//! Sectors of cyclic bodies: pairs the nodes of the two cut sides.

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use super::{FacetSet, Mesh, Spheres, cross};
use crate::tensor::{Point, dot, length, minus};

/// Fraction of the shortest distance of two nodes of a facet within which a node must have its partner.
const SAME: f64 = 1e-3;
/// Fraction of the angle of a sector by which it may differ from 2π/n, for rounded input.
const WHOLE: f64 = 1e-3;

/// A node whose value is the turned value of another one: u(node) = R u(to); scalars are equal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// The following node.
    pub node: u32,
    /// The leading node, which follows none.
    pub to: u32,
    /// R by the images of the axes: entry c is R e_c.
    pub turn: [Point; 3],
}

impl Link {
    /// R v.
    #[must_use]
    pub fn turned(&self, v: &Point) -> Point {
        turned(&self.turn, v)
    }

    /// The sums of normals at the node and at its leader, including those of the facets in the neighbouring sector.
    #[must_use]
    pub fn normals(&self, own: &Point, followed: &Point) -> [Point; 2] {
        let own = self.back(own);
        let sum = std::array::from_fn(|c| own[c] + followed[c]);
        [self.turned(&sum), sum]
    }

    /// Rᵀ v.
    #[must_use]
    pub fn back(&self, v: &Point) -> Point {
        self.turn.map(|image| dot(&image, v))
    }
}

/// R v, with R given by the images of the axes.
fn turned(turn: &[Point; 3], v: &Point) -> Point {
    std::array::from_fn(|d| (0..3).map(|c| v[c] * turn[c][d]).sum())
}

/// All nodes of a mesh that follow others, and the nodes on the axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Links {
    /// The nodes that follow others, ascending.
    pub nodes: Vec<Link>,
    /// The nodes on the axis of rotation, each with two directions across it along which vectors vanish.
    pub on_axis: Vec<(u32, [Point; 2])>,
}

impl Links {
    /// Combines two sets of links; `None` if a node would follow twice, or follow a follower.
    #[must_use]
    pub fn and(mut self, other: Links) -> Option<Links> {
        self.nodes.extend(other.nodes);
        self.on_axis.extend(other.on_axis);
        self.nodes.sort_unstable_by_key(|link| link.node);
        let is_once = self.nodes.windows(2).all(|pair| pair[0].node != pair[1].node);
        (is_once && self.nodes.iter().all(|link| link_of(&self.nodes, link.to).is_none())).then_some(self)
    }
}

/// The link of a node; `links` are sorted by node.
#[must_use]
pub fn link_of(links: &[Link], node: u32) -> Option<&Link> {
    links.binary_search_by_key(&node, |link| link.node).ok().and_then(|i| links.get(i))
}

/// The leader of a node, or the node itself.
#[must_use]
pub fn leader(links: &[Link], node: u32) -> u32 {
    link_of(links, node).map_or(node, |link| link.to)
}

/// A body that is one sector of a cyclic body: all fields on the second side are those on the first one, turned.
#[derive(Clone, Debug, PartialEq)]
pub struct Cyclic {
    /// Names of the two sides along which a sector meets its neighbours.
    pub sides: [String; 2],
    /// A point of the axis, m.
    pub through: Point,
    /// The direction of the axis; in the plane z.
    pub axis: Point,
}

/// Reason why two sides define no sector.
#[derive(Clone, Debug, PartialEq)]
pub enum NotCyclic {
    /// The sides have different numbers of nodes.
    Count([usize; 2]),
    /// The angle in degrees between the sides is no integer fraction of 360.
    Angle(f64),
    /// A node of the first side is turned to a position without a node of the second one: the position in m, and the
    /// distance of the nearest node in m.
    Apart(Point, f64),
    /// A facet of the first side, at this position, is turned onto no facet of the second although the nodes match: the
    /// facets are split differently.
    Cut(Point),
}

impl Cyclic {
    /// Links the nodes of the second side to those of the first, and returns the number of sectors of the whole.
    ///
    /// # Errors
    /// The reason why the sides define no sector.
    pub fn links(&self, mesh: &Mesh) -> Result<(Links, usize), NotCyclic> {
        static NONE: FacetSet = FacetSet { blocks: Vec::new() };
        let sets = self.sides.each_ref().map(|side| mesh.facets.get(side).unwrap_or(&NONE));
        let [first, second] = sets.map(FacetSet::node_list);
        if first.len() != second.len() {
            return Err(NotCyclic::Count([first.len(), second.len()]));
        }
        let axis = self.axis.map(|c| c / length(&self.axis));
        let from_axis = |x: &Point| {
            let x: Point = std::array::from_fn(|c| x[c] - self.through[c]);
            let along = dot(&x, &axis);
            (std::array::from_fn(|c| x[c] - along * axis[c]), along)
        };
        let mean = |nodes: &[u32]| -> Point {
            let sum = nodes.iter().map(|&node| from_axis(&mesh.points[node as usize]).0);
            sum.fold([0.0; 3], |sum: Point, x: Point| std::array::from_fn(|c| sum[c] + x[c]))
        };
        let [from, to] = [&first, &second].map(|nodes| mean(nodes));
        let angle = dot(&cross(&from, &to), &axis).atan2(dot(&from, &to));
        let sectors = (TAU / angle.abs()).round();
        let part = TAU / sectors;
        if !(sectors.is_finite() && (angle.abs() - part).abs() <= WHOLE * part) {
            return Err(NotCyclic::Angle(angle.to_degrees().abs()));
        }
        // The angle measured on the mesh, so that the sides match despite rounded coordinates.
        let turn = rotation(&axis, angle);
        let image = |node: u32| {
            let x: Point = std::array::from_fn(|c| mesh.points[node as usize][c] - self.through[c]);
            let x = turned(&turn, &x);
            std::array::from_fn(|c| x[c] + self.through[c])
        };
        let near = SAME * shortest(mesh, sets);
        let mut links = Links::default();
        let tree = Spheres::new(second.len(), &|place| (mesh.points[second[place] as usize], 0.0));
        for &node in &first {
            let x = image(node);
            let apart = |place: usize| length(&minus(&x, &mesh.points[second[place] as usize]));
            let nearest = tree.nearest(&x, &apart).map(|place| (second[place], apart(place)));
            let (partner, distance) = nearest.unwrap_or((node, f64::INFINITY));
            if distance > near || distance.is_nan() {
                return Err(NotCyclic::Apart(x, distance));
            }
            if partner == node {
                links.on_axis.push((node, across(&axis)));
            } else {
                links.nodes.push(Link { node: partner, to: node, turn });
            }
        }
        links.nodes.sort_unstable_by_key(|link| link.node);
        let leader_of = |&node: &u32| leader(&links.nodes, node);
        let facets = |set: &FacetSet| -> BTreeSet<Vec<u32>> {
            let sorted = |nodes: &[u32]| nodes.iter().map(leader_of).collect::<BTreeSet<u32>>().into_iter().collect();
            set.facets().map(|(_, nodes)| sorted(nodes)).collect()
        };
        let [of_first, of_second] = sets.map(facets);
        match of_first.difference(&of_second).next().and_then(|facet| facet.first()) {
            Some(&node) => Err(NotCyclic::Cut(mesh.points[node as usize])),
            None => Ok((links, sectors as usize)),
        }
    }
}

impl Cyclic {
    /// A vector of a sector, turned into the one `places` further in the positive sense about the axis, of `sectors`.
    #[must_use]
    pub fn vector(&self, v: &Point, [places, sectors]: [usize; 2]) -> Point {
        let axis = self.axis.map(|c| c / length(&self.axis));
        turned(&rotation(&axis, TAU * places as f64 / sectors as f64), v)
    }

    /// A position in a sector, turned likewise.
    #[must_use]
    pub fn position(&self, x: &Point, places: [usize; 2]) -> Point {
        let image = self.vector(&minus(x, &self.through), places);
        std::array::from_fn(|c| image[c] + self.through[c])
    }
}

/// The images of the axes under a rotation about a unit vector: Rodrigues' formula.
fn rotation(axis: &Point, angle: f64) -> [Point; 3] {
    let (s, c) = angle.sin_cos();
    std::array::from_fn(|e| {
        let unit: Point = std::array::from_fn(|d| f64::from(u8::from(d == e)));
        let (along, side) = (dot(axis, &unit), cross(axis, &unit));
        std::array::from_fn(|d| c * unit[d] + s * side[d] + (1.0 - c) * along * axis[d])
    })
}

/// Two directions across an axis: x and y if the axis is z.
fn across(axis: &Point) -> [Point; 2] {
    let least = (0..3).min_by(|&a, &b| axis[a].abs().total_cmp(&axis[b].abs())).unwrap_or(0);
    let unit: Point = std::array::from_fn(|d| f64::from(u8::from(d == least)));
    let along = dot(axis, &unit);
    let first: Point = std::array::from_fn(|d| unit[d] - along * axis[d]);
    let first = first.map(|c| c / length(&first));
    [first, cross(axis, &first)]
}

/// The shortest distance of two nodes of a facet on both sides; infinite in one dimension, where facets are points.
fn shortest(mesh: &Mesh, sets: [&FacetSet; 2]) -> f64 {
    let distance = |a: u32, b: u32| length(&minus(&mesh.points[a as usize], &mesh.points[b as usize]));
    let facets = sets.into_iter().flat_map(FacetSet::facets);
    facets.fold(f64::INFINITY, |least, (_, nodes)| {
        let pairs = nodes.iter().enumerate().flat_map(|(i, &a)| nodes[..i].iter().map(move |&b| (a, b)));
        pairs.fold(least, |least, (a, b)| least.min(distance(a, b)))
    })
}
