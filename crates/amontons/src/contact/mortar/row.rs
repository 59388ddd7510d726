//! The rows of the contact points: D, M, weight, normal and gap.

use std::collections::BTreeMap;

use super::dual::Dual;
use super::image::SectorImage;
use super::join::Joining;
use super::{FacingSides, MortarRow, NodeShare, Pairing};
use crate::mesh::leader;
use crate::tensor::{Point, dot, given, length};

/// Coefficients of a row, relative to 1, that count as round-off.
const ROUND_OFF: f64 = 1e-15;
/// Gap relative to the largest coordinate of its nodes that is the round-off of coordinates.
const LAST_BITS: f64 = 16.0 * f64::EPSILON;
/// Length of a mean of unit normals below which it has no direction.
const DIRECTION: f64 = 1e-9;
/// cos 35°: a normal closer to a plane of symmetry is treated as lying in it; half a facet is turned by less.
const SYMMETRIC: f64 = super::cut::FACING;
/// Share of a hat that counts as full coverage.
const WHOLE: f64 = 1.0 - 1e-9;
/// Cosine between the normal and a direction below which the direction counts as tangential.
const ALONG: f64 = 1e-6;

/// A node with the power of the turn that brings its vectors into the sector of the point.
type TurnedNode = (u32, i8);

/// The sums that a contact point collects from the parts.
#[derive(Clone, Debug, Default)]
struct RowSums {
    normal: Point,
    weight: f64,
    own: BTreeMap<TurnedNode, f64>,
    other: BTreeMap<TurnedNode, f64>,
    shares: [BTreeMap<TurnedNode, f64>; 2],
    /// The parts on which its function is nonzero, and whether they are turned back into its sector.
    parts: Vec<(usize, bool)>,
}

/// The rows of all candidates with laws, by node and patch ascending; of all candidates if `keeps_all` is set.
pub(super) fn rows(pairing: &Pairing, joining: &Joining) -> Vec<MortarRow> {
    let Pairing { sides, nonmortar, covered, candidates, .. } = pairing;
    let mut gathered = vec![RowSums::default(); candidates.all.len()];
    let is_whole = is_covered_whole(pairing, joining);
    for (number, part) in nonmortar.parts().iter().enumerate() {
        let of_part = &candidates.of[number][..part.corners.len()];
        if covered[number].samples.is_empty() {
            continue;
        }
        let is_dual = of_part.iter().all(|corner| joining.has_law[corner.candidate]);
        let dual = Dual::new(nonmortar, &pairing.mortar, part, &covered[number].samples, is_dual);
        for (a, corner) in of_part.iter().enumerate() {
            let of_normal = if is_whole { 1.0 } else { dual.weight[a] };
            for &(k, share) in &joining.to[corner.candidate] {
                gathered[k].add(pairing, (number, a), &dual, [share, share * of_normal]);
            }
        }
    }
    let far = extent(sides);
    let mut rows = Vec::new();
    for (number, mut gathered) in gathered.into_iter().enumerate() {
        if !joining.has_law[number] {
            if sides.keeps_all {
                gathered.normal = mean_normal(pairing, number);
            } else {
                continue;
            }
        }
        rows.extend(gathered.row(pairing, number, far));
    }
    rows
}

/// True if the whole side is covered and each node has a law of its own: all facets at a node then have equal weight in
/// its normal, instead of the integral of the function on each. The two means differ by a quarter of the product of the
/// relative differences of two neighbours in size and in direction.
fn is_covered_whole(pairing: &Pairing, joining: &Joining) -> bool {
    let Pairing { nonmortar, candidates, .. } = pairing;
    let corners = nonmortar.parts().iter().zip(&candidates.shares);
    joining.has_law.iter().all(|has_law| *has_law)
        && corners.into_iter().all(|(part, shares)| shares[..part.corners.len()].iter().all(|share| *share > WHOLE))
}

/// An upper bound of the distance between bodies of the mesh.
fn extent(sides: &FacingSides) -> f64 {
    length(&std::array::from_fn(|c| {
        let along = || sides.mesh.points.iter().map(|x| x[c]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    }))
}

/// The mean normal of the facets at a candidate, covered or not.
fn mean_normal(pairing: &Pairing, candidate: usize) -> Point {
    let corners = &pairing.candidates.all[candidate].corners;
    corners.iter().fold([0.0; 3], |sum, &at| {
        let normal = normal_at(pairing, at);
        std::array::from_fn(|c| sum[c] + normal[c])
    })
}

/// The normal of a facet at a corner of a part, in the sector of the candidate.
fn normal_at(pairing: &Pairing, (number, corner): (usize, usize)) -> Point {
    let part = &pairing.nonmortar.parts()[number];
    let normal = pairing.nonmortar.normal_at(part.facet, part.local[corner]);
    let shift = -i8::from(pairing.candidates.of[number][corner].follows);
    pairing.image(shift).vector(&normal)
}

impl Pairing<'_> {
    /// The turn by `times` sectors.
    fn image(&self, times: i8) -> SectorImage {
        self.sector.map_or(SectorImage::SELF, |next| next.times(times))
    }
}

impl RowSums {
    /// Adds the function of a corner with the factor `share`, and its normal with the factor `of_normal`.
    fn add(&mut self, pairing: &Pairing, (number, a): (usize, usize), dual: &Dual, [share, of_normal]: [f64; 2]) {
        let Pairing { nonmortar, mortar, candidates, sides, .. } = pairing;
        let part = &nonmortar.parts()[number];
        let shift = -i8::from(candidates.of[number][a].follows);
        let (weight, normal) = (share * dual.weight[a], normal_at(pairing, (number, a)));
        self.weight += weight;
        self.normal = std::array::from_fn(|c| self.normal[c] + of_normal * normal[c]);
        if !self.parts.contains(&(number, shift != 0)) {
            self.parts.push((number, shift != 0));
        }
        let (_, nodes) = nonmortar.facet(part.facet);
        for (node, value) in nodes.iter().zip(&dual.own[a]) {
            *self.own.entry((*node, shift)).or_default() += share * value;
        }
        let own = leader(sides.supports.links, nonmortar.node(part, a));
        *self.shares[0].entry((own, 0)).or_default() += weight;
        for (other, values, hats) in &dual.other {
            let other = &mortar.parts()[*other];
            let power = shift + mortar.power(other.facet);
            for (node, value) in mortar.facet(other.facet).1.iter().zip(&values[a]) {
                *self.other.entry((*node, power)).or_default() += share * value;
            }
            for (corner, hat) in hats[a].iter().take(other.corners.len()).enumerate() {
                let node = mortar.node(other, corner);
                let followed = leader(sides.supports.links, node);
                let power = power + i8::from(followed != node);
                *self.shares[1].entry((followed, power)).or_default() += share * hat;
            }
        }
    }

    /// The row of a candidate; `None` if it has no normal.
    fn row(self, pairing: &Pairing, number: usize, far: f64) -> Option<MortarRow> {
        let (sides, node) = (pairing.sides, pairing.candidates.all[number].node);
        let held = (sides.supports.held)(node);
        let normal = along_supports(&self.normal, &held)?;
        let weight = self.weight;
        let is_covered = weight > 0.0;
        let entries = |sums: &BTreeMap<TurnedNode, f64>| -> Vec<(TurnedNode, f64)> {
            sums.iter().map(|(&l, sum)| (l, sum / weight)).filter(|(_, share)| share.abs() > ROUND_OFF).collect()
        };
        let (mut own, other) =
            if is_covered { (entries(&self.own), entries(&self.other)) } else { (vec![((node, 0), 1.0)], Vec::new()) };
        // The node of the point comes first.
        own.sort_by_key(|((j, power), _)| (*j != node, *power != 0));
        let place = |entries: &[(TurnedNode, f64)]| -> Point {
            entries.iter().fold([0.0; 3], |sum, &((node, power), share)| {
                let x = pairing.image(power).position(&sides.x[node as usize]);
                std::array::from_fn(|c| sum[c] + share * x[c])
            })
        };
        let (mut gap, mut lever, mut gap_of_rows) = (far, 0.0, far);
        if is_covered {
            let (from, to) = (place(&own), place(&other));
            let apart: Point = std::array::from_fn(|c| to[c] - from[c]);
            gap_of_rows = dot(&normal, &apart);
            lever = length(&std::array::from_fn(|c| apart[c] - gap_of_rows * normal[c]));
            gap = self.within_range(pairing, &normal, gap_of_rows);
            // Sides that touch have zero gap and, without a load, zero force.
            let largest = own.iter().chain(&other).flat_map(|((l, _), _)| sides.x[*l as usize]);
            if gap.abs() <= LAST_BITS * largest.fold(0.0, |largest: f64, x| largest.max(x.abs())) {
                gap = 0.0;
            }
        }
        let blocked = blocked(sides, node, &normal, &held, &other);
        let turned = own.iter().chain(&other).enumerate().filter(|(_, ((_, power), _))| *power != 0);
        let turned = turned.map(|(entry, ((_, power), _))| (entry, pairing.image(*power))).collect();
        let plain =
            |entries: Vec<(TurnedNode, f64)>| entries.into_iter().map(|((node, _), share)| (node, share)).collect();
        let shares = self.shares.map(|shares| {
            let sum: f64 = shares.values().sum();
            let of = |((node, power), part): (TurnedNode, f64)| {
                let turn = (power != 0).then(|| pairing.image(power));
                NodeShare { node, part: part / sum, turn }
            };
            shares.into_iter().filter(|(_, part)| *part > 0.0).map(of).collect()
        });
        let (own, other) = (plain(own), plain(other));
        Some(MortarRow { node, normal, weight, own, other, turned, gap, gap_of_rows, lever, shares, held: blocked })
    }

    /// The gap, limited to the range of the distances along ν on the parts where the function is nonzero.
    fn within_range(&self, pairing: &Pairing, normal: &Point, gap: f64) -> f64 {
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        for &(number, is_turned) in &self.parts {
            for apart in &pairing.covered[number].apart {
                let apart = if is_turned { pairing.image(-1).vector(apart) } else { *apart };
                let distance = dot(normal, &apart);
                range = [range[0].min(distance), range[1].max(distance)];
            }
        }
        gap.max(range[0]).min(range[1])
    }
}

/// ν from a sum of normals, made tangential to planes of symmetry as if the mirrored facets were included. A prescribed
/// direction along the normal itself is no such plane.
fn along_supports(sum: &Point, held: &[Point; 3]) -> Option<Point> {
    let size = length(sum);
    if size <= DIRECTION {
        return None;
    }
    let mut normal = sum.map(|c| c / size);
    for direction in held {
        let along = dot(&normal, direction);
        let rest: Point = std::array::from_fn(|c| normal[c] - along * direction[c]);
        let size = length(&rest);
        if size > SYMMETRIC {
            normal = rest.map(|c| c / size);
        }
    }
    Some(normal)
}

/// The directions along the side in which the displacement is prescribed alike at a node and at a node that it faces:
/// the shear vanishes in planes of symmetry, and the slip along these directions would be that of the neighbours alone.
fn blocked(
    sides: &FacingSides,
    node: u32,
    normal: &Point,
    held: &[Point; 3],
    other: &[(TurnedNode, f64)],
) -> [Point; 3] {
    let is_alike = |direction: &&Point| {
        let alike = |((l, power), _): &(TurnedNode, f64)| *power == 0 && (sides.supports.alike)(node, *l, direction);
        dot(direction, normal).abs() <= ALONG && other.iter().any(alike)
    };
    let mut blocked = given(held).filter(is_alike);
    std::array::from_fn(|_| blocked.next().copied().unwrap_or_default())
}
