//! The part of a nonmortar facet covered by mortar facets, with quadrature points on both.

use std::sync::OnceLock;

use super::part::{FlatPiece, SideFacets};
use super::sight::{Sight, SightLine};
use super::tree::SphereTree;
use crate::mesh::cross;
use crate::quadrature::{QuadratureRule, Shape, rule};
use crate::tensor::{Point, dot, length};

/// Fraction of a part below which a piece of it is round-off.
const LEAST: f64 = 1e-12;
/// Overlap of two pieces, as a fraction of the part, above which the nearer one counts.
const OVERLAP: f64 = 1e-9;
/// Relative error of the integrals on facets that are no parallelograms.
const ERROR: f64 = 1e-13;
/// Largest number of degrees added to the polynomial degree for these integrals.
const MOST: usize = 40;
/// Upper bound of the degree of a product of shape functions.
const DEGREES: usize = 10;
/// The degree of a hat on a quadrilateral, in both coordinates together.
const HAT_DEGREE: usize = 2;
/// cos 35°: facets face each other only if their normals are closer to opposite than this.
pub(super) const FACING: f64 = 0.819_152_044_288_991_8;

/// A quadrature point on the covered part of a nonmortar part.
#[derive(Clone, Debug)]
pub(super) struct MortarPoint {
    /// Weight in m^(d−1).
    pub weight: f64,
    /// The hats H of the corners of the part.
    pub hats: [f64; 4],
    /// Reference point on the nonmortar facet.
    pub own: Point,
    /// The number of the mortar part that faces it, the hats of its corners, and the reference point on its facet.
    pub other: (usize, [f64; 4], Point),
}

/// The part of a nonmortar part that the mortar side covers.
#[derive(Clone, Debug, Default)]
pub(super) struct Covered {
    /// The quadrature points, exact for products of shape functions on straight facets.
    pub samples: Vec<MortarPoint>,
    /// Vectors from the nonmortar to the mortar side at the ends of the segments (the corners of the polygons), m.
    pub apart: Vec<Point>,
    /// True if something may hide the facing mortar parts: they are not too near for that.
    pub is_far: bool,
}

/// The mortar side in searchable form.
pub(super) struct Opposite<'a> {
    pub facets: &'a SideFacets<'a>,
    /// The tree of its parts.
    pub tree: &'a SphereTree<'a>,
    /// Test for facets that hide parts from each other; `None` if nothing does.
    pub sight: Option<&'a Sight<'a>>,
    /// Largest distance at which parts count, m; `None` without a limit.
    pub distance: Option<f64>,
}

/// Finds the region of a nonmortar part that the mortar side covers, seen along the normal of the part: only facing,
/// visible parts count, and of parts behind each other the nearest.
pub(super) fn covered(nonmortar: &SideFacets, opposite: &Opposite, part: &FlatPiece) -> Covered {
    let is_near =
        |centre: &Point, radius: f64| opposite.distance.is_none_or(|distance| part.is_within(distance, centre, radius));
    let met = opposite.tree.met(&|centre, radius| part.may_cover(centre, radius) && is_near(centre, radius));
    let facing: Vec<(usize, &FlatPiece)> = met.into_iter().filter(|(_, other)| part.faces(other)).collect();
    let mut covered = Covered::default();
    match part.corners.len() {
        1 => nearest(part, &facing, &mut covered),
        2 => segments(nonmortar, opposite, part, &facing, &mut covered),
        _ => polygons(nonmortar, opposite, part, &facing, &mut covered),
    }
    covered
}

/// The integrals of the hats of a part by corner, as if all of it were covered.
pub(super) fn whole(facets: &SideFacets, part: &FlatPiece) -> [f64; 4] {
    let mut sums = [0.0; 4];
    match part.corners.as_slice() {
        [_] => sums[0] = 1.0,
        [a, b] => {
            let length = part.area();
            // ∫ H r of the ends at the radii r_a and r_b.
            let [ra, rb] = [a, b].map(|x| facets.across(x));
            sums[0] = length * (2.0 * ra + rb) / 6.0;
            sums[1] = length * (ra + 2.0 * rb) / 6.0;
        }
        _ => {
            let plane = PiecePlane::new(part);
            let own: Vec<Flat> = part.corners.iter().map(|x| plane.flat(x)).collect();
            let map = Map { corners: &own };
            for triangle in fan(&own) {
                for (at, weight) in placed(&triangle, on_triangles(HAT_DEGREE + map.more_degrees(&triangle))) {
                    let hats = values(own.len(), map.inverse(&at));
                    sums.iter_mut().zip(hats).for_each(|(sum, hat)| *sum += weight * hat);
                }
            }
        }
    }
    sums
}

/// The degree of ψ_i N_j in each coordinate, including that of the radius in a body of revolution.
fn degree(nonmortar: &SideFacets, mortar: &SideFacets, [own, other]: [&FlatPiece; 2]) -> usize {
    let of = |facets: &SideFacets, part: &FlatPiece| {
        let (element, _) = facets.facet(part.facet);
        if element.shape == Shape::Quadrilateral { 2 * element.degree } else { element.degree.max(1) }
    };
    let linear = if own.corners.len() == 4 { 2 } else { 1 };
    linear + of(nonmortar, own).max(of(mortar, other)) + usize::from(nonmortar.is_axisymmetric)
}

/// In one dimension: the nearest facing point.
fn nearest(part: &FlatPiece, facing: &[(usize, &FlatPiece)], covered: &mut Covered) {
    let distance = |other: &FlatPiece| (other.centre[0] - part.centre[0]).abs();
    let nearest = facing.iter().min_by(|(_, a), (_, b)| distance(a).total_cmp(&distance(b)));
    if let Some((number, other)) = nearest {
        let hats = [1.0, 0.0, 0.0, 0.0];
        let other_at = (*number, hats, other.reference[0]);
        covered.samples.push(MortarPoint { weight: 1.0, hats, own: part.reference[0], other: other_at });
        covered.apart.push([other.centre[0] - part.centre[0], 0.0, 0.0]);
    }
}

/// A piece of a segment from its start at 0 to its end at 1, with the mortar part that faces it.
struct SegmentPiece<'p> {
    number: usize,
    other: &'p FlatPiece,
    /// Coordinates of the ends of the mortar part on the segment.
    ends: [f64; 2],
    from: f64,
    to: f64,
    /// Distance in the middle.
    distance: f64,
}

impl SegmentPiece<'_> {
    /// Coordinate on the mortar part of a place on the segment, from 0 at its first corner to 1 at its last.
    fn across(&self, s: f64) -> f64 {
        (s - self.ends[0]) / (self.ends[1] - self.ends[0])
    }
}

fn segments(
    nonmortar: &SideFacets,
    opposite: &Opposite,
    part: &FlatPiece,
    facing: &[(usize, &FlatPiece)],
    covered: &mut Covered,
) {
    let [a, b] = [part.corners[0], part.corners[1]];
    let along: Point = std::array::from_fn(|c| b[c] - a[c]);
    let squared = dot(&along, &along);
    let from_start = |x: &Point| -> Point { std::array::from_fn(|c| x[c] - a[c]) };
    let mut found: Vec<SegmentPiece> = Vec::new();
    for &(number, other) in facing {
        let ends = [0, 1].map(|i| dot(&from_start(&other.corners[i]), &along) / squared);
        let (from, to) = (ends[0].min(ends[1]).max(0.0), ends[0].max(ends[1]).min(1.0));
        if to - from > LEAST {
            let mut piece = SegmentPiece { number, other, ends, from, to, distance: 0.0 };
            let middle = 0.5 * (from + to);
            let at = between(&other.corners, piece.across(middle));
            piece.distance = dot(&from_start(&at), &part.normal);
            let line = SightLine { own: part, other, from: between(&part.corners, middle), to: at };
            covered.is_far |= line.is_long();
            if opposite.sees(&line) {
                found.push(piece);
            }
        }
    }
    found.sort_by(|a, b| a.distance.abs().total_cmp(&b.distance.abs()));
    let mut taken: Vec<[f64; 2]> = Vec::new();
    for piece in found {
        let facet = piece.other.facet;
        for [from, to] in left(&piece, &taken) {
            let rule = rule(Shape::Segment, degree(nonmortar, opposite.facets, [part, piece.other]));
            let at = |s: f64| {
                let t = piece.across(s);
                (s, t, [(part, s), (piece.other, t)].map(|(part, s)| between(&part.reference, s)))
            };
            for (point, weight) in rule.iter() {
                let (s, t, [own, other]) = at(from + (to - from) * point[0]);
                let x: Point = std::array::from_fn(|c| a[c] + s * along[c]);
                let weight = weight * (to - from) * squared.sqrt() * nonmortar.across(&x);
                let [hats, other_hats] = [s, t].map(|s| [1.0 - s, s, 0.0, 0.0]);
                covered.samples.push(MortarPoint { weight, hats, own, other: (piece.number, other_hats, other) });
            }
            for end in [from, to] {
                let (_, _, [own, other]) = at(end);
                covered.apart.push(apart([(nonmortar, part.facet, own), (opposite.facets, facet, other)]));
            }
            taken.push([from, to]);
        }
    }
}

/// Vector from a reference point of one facet to that of another, m.
fn apart(of: [(&SideFacets, usize, Point); 2]) -> Point {
    let [from, to] = of.map(|(facets, facet, at)| facets.position(facet, &at));
    std::array::from_fn(|c| to[c] - from[c])
}

/// The intervals of a piece that nearer pieces leave uncovered.
fn left(piece: &SegmentPiece, taken: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut left = vec![[piece.from, piece.to]];
    for &[from, to] in taken {
        let rest = |&[start, end]: &[f64; 2]| {
            if end.min(to) - start.max(from) <= OVERLAP { vec![[start, end]] } else { vec![[start, from], [to, end]] }
        };
        left = left.iter().flat_map(rest).filter(|[start, end]| end - start > LEAST).collect();
    }
    left
}

fn between(ends: &[Point], share: f64) -> Point {
    std::array::from_fn(|c| ends[0][c] + share * (ends[1][c] - ends[0][c]))
}

/// Coordinates of a point in the plane of a part.
type Flat = [f64; 2];

/// The plane of a part.
struct PiecePlane<'p> {
    origin: Point,
    axes: [Point; 2],
    normal: &'p Point,
}

impl PiecePlane<'_> {
    fn new(part: &FlatPiece) -> PiecePlane<'_> {
        let edge: Point = std::array::from_fn(|c| part.corners[1][c] - part.corners[0][c]);
        let along = dot(&edge, &part.normal);
        let edge: Point = std::array::from_fn(|c| edge[c] - along * part.normal[c]);
        let size = length(&edge);
        let first = edge.map(|c| c / size);
        PiecePlane { origin: part.centre, axes: [first, cross(&part.normal, &first)], normal: &part.normal }
    }

    fn relative(&self, x: &Point) -> Point {
        std::array::from_fn(|c| x[c] - self.origin[c])
    }

    fn flat(&self, x: &Point) -> Flat {
        let from = self.relative(x);
        self.axes.map(|axis| dot(&from, &axis))
    }

    /// The position in space of a point of the plane.
    fn place(&self, [s, t]: &Flat) -> Point {
        std::array::from_fn(|c| self.origin[c] + s * self.axes[0][c] + t * self.axes[1][c])
    }
}

/// A piece of a polygon with the mortar part that faces it.
struct PolygonPiece<'p> {
    number: usize,
    other: &'p FlatPiece,
    /// The corners of the mortar part and of the piece, in the plane of the nonmortar part.
    corners: Vec<Flat>,
    piece: Vec<Flat>,
    /// Distance in the middle.
    distance: f64,
}

fn polygons(
    nonmortar: &SideFacets,
    opposite: &Opposite,
    part: &FlatPiece,
    facing: &[(usize, &FlatPiece)],
    covered: &mut Covered,
) {
    let plane = PiecePlane::new(part);
    let flat = |part: &FlatPiece| -> Vec<Flat> { part.corners.iter().map(|x| plane.flat(x)).collect() };
    let own = flat(part);
    let measure = area(&own);
    let mut found: Vec<PolygonPiece> = Vec::new();
    for &(number, other) in facing {
        let corners = flat(other);
        let piece = clipped(&corners, &own);
        if piece.len() > 2 && area(&piece).abs() > LEAST * measure {
            let middle = centre(&piece);
            let (from, to) = (plane.place(&middle), other.position(&Map { corners: &corners }.inverse(&middle)));
            let distance = dot(&plane.relative(&to), plane.normal).abs();
            let line = SightLine { own: part, other, from, to };
            covered.is_far |= line.is_long();
            if opposite.sees(&line) {
                found.push(PolygonPiece { number, other, corners, piece, distance });
            }
        }
    }
    found.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    let mut taken: Vec<Vec<Flat>> = Vec::new();
    for PolygonPiece { number, other, corners, piece, .. } in found {
        // The nearest of facets behind each other counts.
        let hidden: f64 = taken.iter().map(|nearer| area(&clipped(&piece, nearer)).abs()).sum();
        if hidden > 0.5 * area(&piece).abs() {
            continue;
        }
        let maps = [&own, &corners].map(|corners| Map { corners });
        let exact = degree(nonmortar, opposite.facets, [part, other]);
        let coordinates = |at: &Flat| maps.each_ref().map(|map| map.inverse(at));
        for triangle in fan(&piece) {
            let more = maps.iter().map(|map| map.more_degrees(&triangle)).max().unwrap_or(0);
            for (at, weight) in placed(&triangle, on_triangles(exact + more)) {
                let [own_at, other_at] = coordinates(&at);
                let hats = values(own.len(), own_at);
                let other_at = (number, values(corners.len(), other_at), other.at(&other_at));
                covered.samples.push(MortarPoint { weight, hats, own: part.at(&own_at), other: other_at });
            }
        }
        for corner in &piece {
            let [own_at, other_at] = coordinates(corner);
            let of = [(nonmortar, part.facet, part.at(&own_at)), (opposite.facets, other.facet, other.at(&other_at))];
            covered.apart.push(apart(of));
        }
        taken.push(piece);
    }
}

/// The centroid of a convex polygon.
fn centre(polygon: &[Flat]) -> Flat {
    let (mut sum, mut size) = ([0.0; 2], 0.0);
    for triangle in fan(polygon) {
        let area = area(&triangle);
        size += area;
        (0..2).for_each(|c| sum[c] += area * triangle.iter().map(|x| x[c]).sum::<f64>() / 3.0);
    }
    sum.map(|c| c / size)
}

/// Signed area of a polygon.
fn area(corners: &[Flat]) -> f64 {
    let Some(first) = corners.first() else { return 0.0 };
    let from = |x: &Flat| [x[0] - first[0], x[1] - first[1]];
    let pairs = corners.windows(2).map(|pair| {
        let [a, b] = [from(&pair[0]), from(&pair[1])];
        a[0] * b[1] - a[1] * b[0]
    });
    0.5 * pairs.sum::<f64>()
}

/// The intersection of a polygon with a convex one (Sutherland and Hodgman), in the orientation of the first.
fn clipped(polygon: &[Flat], by: &[Flat]) -> Vec<Flat> {
    let turn = area(by).signum();
    let mut piece = polygon.to_vec();
    for i in 0..by.len() {
        let (a, b) = (by[i], by[(i + 1) % by.len()]);
        let inside = |x: &Flat| turn * ((b[0] - a[0]) * (x[1] - a[1]) - (b[1] - a[1]) * (x[0] - a[0]));
        let mut next = Vec::with_capacity(piece.len() + 1);
        for j in 0..piece.len() {
            let (x, y) = (piece[j], piece[(j + 1) % piece.len()]);
            let (at_x, at_y) = (inside(&x), inside(&y));
            if at_x >= 0.0 {
                next.push(x);
            }
            if (at_x > 0.0 && at_y < 0.0) || (at_x < 0.0 && at_y > 0.0) {
                let share = at_x / (at_x - at_y);
                next.push([x[0] + share * (y[0] - x[0]), x[1] + share * (y[1] - x[1])]);
            }
        }
        piece = next;
    }
    piece
}

/// Splits a convex polygon into triangles about its first corner.
fn fan(polygon: &[Flat]) -> impl Iterator<Item = [Flat; 3]> + use<'_> {
    polygon.windows(2).skip(1).map(|pair| [polygon[0], pair[0], pair[1]]).filter(|triangle| area(triangle) != 0.0)
}

/// The quadrature rule of a degree on triangles, built once.
fn on_triangles(degree: usize) -> &'static QuadratureRule {
    static RULES: [OnceLock<QuadratureRule>; MOST + DEGREES] = [const { OnceLock::new() }; MOST + DEGREES];
    let degree = degree.min(MOST + DEGREES - 1);
    RULES[degree].get_or_init(|| rule(Shape::Triangle, degree))
}

/// The points of a rule on a triangle, with their weights.
fn placed(triangle: &[Flat; 3], rule: &QuadratureRule) -> Vec<(Flat, f64)> {
    let doubled = 2.0 * area(triangle).abs();
    let place = |at: &Point, c: usize| {
        let [from, s, t] = triangle.map(|corner| corner[c]);
        from + at[0] * (s - from) + at[1] * (t - from)
    };
    rule.iter().map(|(at, weight)| ([0, 1].map(|c| place(at, c)), weight * doubled)).collect()
}

/// The map of the unit triangle or square onto a part, given by its corners in a plane.
struct Map<'c> {
    corners: &'c [Flat],
}

impl Map<'_> {
    /// The origin a, the edges b and c from it along both coordinates, and d, the bilinear term of the map.
    fn edges(&self) -> [Flat; 4] {
        let [from, along, across] = [0, 1, self.corners.len() - 1].map(|i| self.corners[i]);
        let [b, c] = [along, across].map(|to| [0, 1].map(|i| to[i] - from[i]));
        let d = match self.corners {
            [_, _, opposite, _] => [0, 1].map(|i| opposite[i] - from[i] - b[i] - c[i]),
            _ => [0.0; 2],
        };
        [from, b, c, d]
    }

    /// The coordinates (s, t) of a point of the plane: x = a + b s + c t + d s t, of which t is a root of (x − a − c t)
    /// × (b + d t) = 0: the root at which the left side has the slope of the orientation.
    fn inverse(&self, x: &Flat) -> Flat {
        let [a, b, c, d] = self.edges();
        let e = [0, 1].map(|i| x[i] - a[i]);
        let [none, once, twice] = [turn(e, b), turn(e, d) + turn(b, c), turn(d, c)];
        let slope = (once * once - 4.0 * none * twice).max(0.0).sqrt().copysign(turn(b, c));
        let t = if once * slope > 0.0 { -2.0 * none / (once + slope) } else { (slope - once) / (2.0 * twice) };
        let (rest, edge) = ([0, 1].map(|i| e[i] - c[i] * t), [0, 1].map(|i| b[i] + d[i] * t));
        [(rest[0] * edge[0] + rest[1] * edge[1]) / (edge[0] * edge[0] + edge[1] * edge[1]), t]
    }

    /// The determinant of the map at coordinates: (b + d t) × (c + d s).
    fn determinant(&self, [s, t]: Flat) -> f64 {
        let [_, b, c, d] = self.edges();
        turn([0, 1].map(|i| b[i] + d[i] * t), [0, 1].map(|i| c[i] + d[i] * s))
    }

    /// The degrees by which a rule on a triangle must exceed that of a polynomial.
    ///
    /// The inverse of a bilinear map is a square root, singular where the determinant of the map is zero. If the
    /// determinant is between 1 − ρ and 1 + ρ times its mean on the triangle, its terms of degree n have the size ρⁿ⁻¹.
    fn more_degrees(&self, triangle: &[Flat; 3]) -> usize {
        let sizes = triangle.map(|corner| self.determinant(self.inverse(&corner)));
        let [least, most] = [f64::min, f64::max].map(|of| sizes.into_iter().fold(sizes[0], of));
        let rho = (most - least) / (most + least).abs();
        match rho {
            _ if rho <= ERROR => 0,
            _ if rho < 1.0 => ((ERROR.ln() / rho.ln()).ceil() as usize - 1).min(MOST),
            // Such a cell is refused; a projected facet may still look so.
            _ => MOST,
        }
    }
}

/// The third component of a × b.
fn turn(a: Flat, b: Flat) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// The linear functions of the corners of the unit triangle or square.
fn values(corners: usize, [s, t]: Flat) -> [f64; 4] {
    if corners == 4 { [(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t] } else { [1.0 - s - t, s, t, 0.0] }
}

impl FlatPiece {
    /// True if the normals of two parts are nearly opposite.
    fn faces(&self, other: &FlatPiece) -> bool {
        dot(&self.normal, &other.normal) < -FACING
    }

    /// The reference point of the facet at given coordinates of the part.
    fn at(&self, at: &Flat) -> Point {
        interpolated(&self.reference, *at)
    }

    /// The position in space at given coordinates of the part.
    fn position(&self, at: &Flat) -> Point {
        interpolated(&self.corners, *at)
    }
}

fn interpolated(corners: &[Point], at: Flat) -> Point {
    let values = values(corners.len(), at);
    std::array::from_fn(|c| corners.iter().zip(values).map(|(corner, n)| n * corner[c]).sum())
}

impl Opposite<'_> {
    /// True if nothing hides two parts from each other along a line.
    fn sees(&self, line: &SightLine) -> bool {
        self.sight.is_none_or(|sight| !line.is_long() || sight.is_clear(line))
    }
}
