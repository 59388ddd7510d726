//! Visibility between facets: two facets see each other unless a body, possibly their own, lies between them.

use std::collections::BTreeSet;

use super::part::{FlatPiece, SideFacets};
use super::tree::SphereTree;
use crate::mesh::{FacetSet, Link, Mesh, cross, link_of};
use crate::tensor::{Point, dot, length};

/// Distance of two parts, relative to the size of one, up to which nothing fits between them: no body is that thin.
const NEAR: f64 = 1e-3;
/// Fraction of a line at its ends that counts as lying on the parts themselves.
const END: f64 = 1e-6;
/// Margin by which a facet hides beyond its edges, relative to its size: the round-off of an edge that two facets
/// share.
const EDGE: f64 = 1e-9;

/// The line from a point of a nonmortar part to the mortar part that faces it.
pub(super) struct SightLine<'p> {
    pub own: &'p FlatPiece,
    pub other: &'p FlatPiece,
    pub from: Point,
    pub to: Point,
}

/// The facets that bound the bodies of a mesh. Two parts see each other along a line that crosses none of them: in a
/// gap the line then runs outside of all bodies; where bodies overlap it leaves neither, so the overlap is shallower
/// than both.
pub(super) struct Sight<'a> {
    tree: SphereTree<'a>,
}

/// The facets that bound bodies, except those along which a sector continues.
pub(super) fn boundary(mesh: &Mesh, links: &[Link]) -> FacetSet {
    let all = mesh.boundary();
    if links.is_empty() {
        return all;
    }
    let followed: BTreeSet<u32> = links.iter().map(|link| link.to).collect();
    let is_linked = |node: &u32| link_of(links, *node).is_some() || followed.contains(node);
    let mut kept = FacetSet::default();
    for (element, nodes) in all.facets().filter(|(_, nodes)| !nodes.iter().all(is_linked)) {
        kept.push(element, nodes.iter().copied());
    }
    kept
}

impl SightLine<'_> {
    /// True if something may fit between the ends.
    pub fn is_long(&self) -> bool {
        length(&std::array::from_fn(|c| self.to[c] - self.from[c])) > NEAR * self.own.radius
    }
}

impl<'a> Sight<'a> {
    pub fn new(facets: &'a SideFacets) -> Sight<'a> {
        Sight { tree: SphereTree::new(facets.parts()) }
    }

    /// True if no facet is between the ends of a long line.
    pub fn is_clear(&self, line: &SightLine) -> bool {
        let apart: Point = std::array::from_fn(|c| line.to[c] - line.from[c]);
        let size = length(&apart);
        let along = apart.map(|c| c / size);
        let meets = |centre: &Point, radius: f64| {
            let from: Point = std::array::from_fn(|c| centre[c] - line.from[c]);
            let at = dot(&from, &along).clamp(0.0, size);
            let miss: Point = std::array::from_fn(|c| from[c] - at * along[c]);
            dot(&miss, &miss) <= radius * radius * (1.0 + EDGE)
        };
        let met = self.tree.met(&meets);
        met.iter().filter(|(_, part)| !is_part(part, line.own) && !is_part(part, line.other)).all(|(_, part)| {
            let cuts = |share: f64| share > END && share < 1.0 - END;
            !crossing(part, &line.from, &apart).is_some_and(cuts)
        })
    }
}

/// True if two parts have the same corners.
fn is_part(a: &FlatPiece, b: &FlatPiece) -> bool {
    let same = |x: &Point, y: &Point| length(&std::array::from_fn(|c| x[c] - y[c])) <= EDGE * a.radius;
    same(&a.centre, &b.centre) && a.corners.iter().all(|x| b.corners.iter().any(|y| same(x, y)))
}

/// The fraction of a line at which it crosses a part; `None` if it misses the part or runs along it.
fn crossing(part: &FlatPiece, from: &Point, apart: &Point) -> Option<f64> {
    match part.corners.as_slice() {
        [] => None,
        [point] => (apart[0] != 0.0).then(|| (point[0] - from[0]) / apart[0]),
        [a, b] => {
            let edge: Point = std::array::from_fn(|c| b[c] - a[c]);
            let to_start: Point = std::array::from_fn(|c| a[c] - from[c]);
            let turn = |u: &Point, v: &Point| u[0] * v[1] - u[1] * v[0];
            let determinant = turn(apart, &edge);
            let inside = |share: f64| (-EDGE..=1.0 + EDGE).contains(&share);
            (determinant.abs() > EDGE * length(apart) * length(&edge))
                .then(|| [turn(&to_start, &edge), turn(&to_start, apart)].map(|of| of / determinant))
                .and_then(|[share, along]| inside(along).then_some(share))
        }
        [first, rest @ ..] => rest.windows(2).find_map(|pair| of_triangle([first, &pair[0], &pair[1]], from, apart)),
    }
}

fn of_triangle([a, b, c]: [&Point; 3], from: &Point, apart: &Point) -> Option<f64> {
    let minus = |x: &Point, y: &Point| -> Point { std::array::from_fn(|d| x[d] - y[d]) };
    let (along, across, to_start) = (minus(b, a), minus(c, a), minus(from, a));
    let normal = cross(&along, &across);
    let determinant = -dot(&normal, apart);
    if determinant.abs() <= EDGE * length(&normal) * length(apart) {
        return None;
    }
    let share = dot(&normal, &to_start) / determinant;
    let turned = cross(&to_start, apart);
    let [s, t] = [dot(&across, &turned) / determinant, -dot(&along, &turned) / determinant];
    (s >= -EDGE && t >= -EDGE && s + t <= 1.0 + EDGE).then_some(share)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line through a triangle crosses it at the constructed point; a line past it does not cross.
    #[test]
    fn a_line_crosses_a_triangle_where_it_is_led_through_it() {
        let corners = [[0.1, 0.2, 0.3], [1.3, -0.1, 0.4], [0.2, 1.1, 0.9]];
        for (s, t, inside) in [(0.2, 0.3, true), (0.7, 0.2, true), (0.6, 0.5, false), (-0.1, 0.4, false)] {
            let at: Point = std::array::from_fn(|c| {
                corners[0][c] + s * (corners[1][c] - corners[0][c]) + t * (corners[2][c] - corners[0][c])
            });
            let from = [0.7, 0.4, -2.0];
            let apart: Point = std::array::from_fn(|c| (at[c] - from[c]) / 0.4);
            let found = of_triangle([&corners[0], &corners[1], &corners[2]], &from, &apart);
            assert_eq!(found.is_some(), inside, "{s}, {t}");
            assert!(found.is_none_or(|share| (share - 0.4).abs() < 1e-12), "{found:?}");
        }
    }

    /// A line through a segment in the plane crosses it at the constructed point; a line past it does not cross.
    #[test]
    fn a_line_crosses_a_segment_where_it_is_led_through_it() {
        let part =
            FlatPiece::new(0, vec![[0.0, 1.0, 0.0], [2.0, 0.5, 0.0]], vec![[0.0; 3], [1.0, 0.0, 0.0]], vec![0, 1]);
        for (s, inside) in [(0.1, true), (0.9, true), (1.2, false), (-0.2, false)] {
            let at = [2.0 * s, 1.0 - 0.5 * s, 0.0];
            let from = [0.3, -1.0, 0.0];
            let apart: Point = std::array::from_fn(|c| (at[c] - from[c]) / 0.7);
            let found = crossing(&part, &from, &apart);
            assert_eq!(found.is_some(), inside, "{s}");
            assert!(found.is_none_or(|share| (share - 0.7).abs() < 1e-12), "{found:?}");
        }
    }
}
