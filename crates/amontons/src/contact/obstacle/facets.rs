//! Closed surfaces of triangles, and closed lines of segments in the plane.
//!
//! The distance has the sign of n·(x − y), y the nearest point and n the normal of its facet, or the pseudonormal of
//! its edge or vertex: the mean of the normals of the facets there, weighted by their angles at a vertex. The sign is
//! then also right if the nearest point is on an edge or a vertex (Bærentzen, Aanæs 2005).

use std::collections::BTreeMap;

use super::closest::{On, closest};
use super::{Nearest, minus, plus, unit};
use crate::mesh::{Spheres, cross};
use crate::tensor::{Point, dot, length};

/// Vertices closer than this fraction of the size of the surface are merged: four-byte numbers have a relative error of
/// 6e-8.
const SAME: f64 = 1e-6;
/// A direction, of length 1, with which no surface is expected to be aligned.
const ASKEW: Point = [0.439_714_6, 0.561_332_9, 0.701_168_3];
/// Height of a triangle over its longest side below which it has no normal.
const FLAT: f64 = 1e-9;
/// Fraction of the size above which a distance has a direction.
const ROUND_OFF: f64 = 1e-12;
/// Shortening of the mean of equal unit normals by round-off.
const SHORTER: f64 = 1e-12;

/// A closed surface in space, or a closed line in the plane, with outward normals.
#[derive(Clone)]
pub struct ClosedSurface {
    vertices: Vec<Point>,
    all: Vec<SurfaceTriangle>,
    /// Pseudonormals of the vertices: means of the normals there.
    at_vertices: Vec<Point>,
    spheres: Spheres,
    bounds: [Point; 2],
}

/// A triangle or a segment.
#[derive(Clone, Debug)]
struct SurfaceTriangle {
    /// Numbers of the corners; a segment has two.
    corners: Vec<usize>,
    /// Unit normal.
    normal: Point,
    /// Pseudonormals of the edges, each from a corner to the next: means of the normals there.
    at_edges: Vec<Point>,
}

/// Reason why facets bound no solid.
#[derive(Clone, Debug, PartialEq)]
pub enum FacetsFault {
    /// Edges, or ends of segments, that belong to one facet only.
    Open {
        /// Number of such edges.
        count: usize,
        /// The ends of the first of them; twice the same point for a segment.
        first: [Point; 2],
    },
    /// Edges that both facets run through in the same direction.
    Turned {
        /// Number of such edges.
        count: usize,
        /// The ends of the first of them.
        first: [Point; 2],
    },
    /// Edges shared by more than two facets.
    Crowded {
        /// Number of such edges.
        count: usize,
        /// The ends of the first of them.
        first: [Point; 2],
    },
    /// Facets without an area.
    Degenerate {
        /// Number of such facets.
        count: usize,
        /// The number of the first of them, from 0, and its first corner.
        first: (usize, Point),
    },
    /// The surface encloses nothing.
    Empty,
}

impl FacetsFault {
    /// The fault as text that follows the name of the file; `place` formats a point, `dim` is 2 in the plane.
    #[must_use]
    pub fn found(&self, dim: usize, place: &dyn Fn(&Point) -> String) -> String {
        let edges = |count: usize, first: &[Point; 2], what: &str| {
            let (one, many) = if dim == 2 { ("end", "ends") } else { ("edge", "edges") };
            let whole = if count == 1 { one } else { many };
            let at = if dim == 2 {
                format!("at {}", place(&first[0]))
            } else {
                format!("from {} to {}", place(&first[0]), place(&first[1]))
            };
            format!("{count} {whole} {what}, the first {at}")
        };
        match self {
            FacetsFault::Open { count, first } => edges(*count, first, "of one facet alone"),
            FacetsFault::Turned { count, first } => edges(*count, first, "where the normals of two facets disagree"),
            FacetsFault::Crowded { count, first } => edges(*count, first, "of more than two facets"),
            FacetsFault::Degenerate { count, first: (number, x) } => {
                let facets = if *count == 1 { "facet" } else { "facets" };
                format!("{count} {facets} without area, the first number {number} (from 0) at {}", place(x))
            }
            FacetsFault::Empty => "a surface that encloses nothing".to_owned(),
        }
    }

    /// The expectation, and a hint.
    #[must_use]
    pub fn expected(&self) -> [&'static str; 2] {
        match self {
            FacetsFault::Open { .. } => [
                "a closed surface, the boundary of a solid",
                "close the holes where the file was made, or give a solid that is thick enough",
            ],
            FacetsFault::Turned { .. } => {
                ["facets that are all turned the same way", "let the program that made the file unify the normals"]
            }
            FacetsFault::Crowded { .. } => [
                "two facets at every edge",
                "join the solids into one, or write each into a file and an obstacle of its own",
            ],
            FacetsFault::Degenerate { .. } => ["facets with an area", "repair the surface, or mesh it anew"],
            FacetsFault::Empty => ["the boundary of a solid", "check the file"],
        }
    }
}

impl std::fmt::Debug for ClosedSurface {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Facets of {} facets", self.all.len())
    }
}

impl ClosedSurface {
    /// The surface of facets given by their corners in m, three in space and two in the plane (z = 0): in space
    /// anticlockwise seen from outside, in the plane with the matter on the left. If all are oriented the other way,
    /// the surface is reversed.
    ///
    /// # Errors
    /// Fails if the facets bound no solid.
    pub fn new(facets: &[Vec<Point>]) -> Result<ClosedSurface, FacetsFault> {
        let points: Vec<Point> = facets.iter().flatten().copied().collect();
        let bounds = bounds(&points);
        let size = length(&minus(&bounds[1], &bounds[0]));
        let (vertices, numbers) = welded(&points, SAME * size);
        let mut rest = numbers.into_iter();
        let numbered = facets.iter().map(|corners| corners.iter().filter_map(|_| rest.next()).collect());
        let mut all: Vec<(usize, Vec<usize>)> = numbered.enumerate().collect();
        // A facet with two merged corners is only an edge; without it its neighbours are adjacent.
        let is_whole = |corners: &[usize]| (0..corners.len()).all(|i| !corners[..i].contains(&corners[i]));
        all.retain(|(_, corners): &(usize, Vec<usize>)| corners.len() > 1 && is_whole(corners));
        check_area(&vertices, &all)?;
        let mut all: Vec<Vec<usize>> = all.into_iter().map(|(_, corners)| corners).collect();
        check_closed(&vertices, &all)?;
        let middle = plus(&bounds[0], 0.5, &minus(&bounds[1], &bounds[0]));
        let enclosed: f64 = all.iter().map(|corners| content(&vertices, corners, &middle)).sum();
        let size = size.powi(all.first().map_or(3, Vec::len) as i32);
        if enclosed.is_nan() || enclosed.abs() <= ROUND_OFF * size {
            return Err(FacetsFault::Empty);
        }
        if enclosed < 0.0 {
            for corners in &mut all {
                corners.swap(0, 1);
            }
        }
        Ok(ClosedSurface::of(vertices, all, bounds))
    }

    /// The surface with its pseudonormals and its search tree.
    fn of(vertices: Vec<Point>, all: Vec<Vec<usize>>, bounds: [Point; 2]) -> ClosedSurface {
        let normal = |corners: &[usize]| {
            let across = across(&vertices, corners);
            unit(&across).unwrap_or(across)
        };
        let mut facets: Vec<SurfaceTriangle> = all
            .into_iter()
            .map(|corners| SurfaceTriangle { normal: normal(&corners), at_edges: Vec::new(), corners })
            .collect();
        let mut at_vertices = vec![Mean::default(); vertices.len()];
        let mut of_edges: BTreeMap<[usize; 2], Mean> = BTreeMap::new();
        for facet in &facets {
            for (i, &corner) in facet.corners.iter().enumerate() {
                at_vertices[corner].add(angle(&vertices, &facet.corners, i), &facet.normal);
            }
            edges(&facet.corners).for_each(|edge| of_edges.entry(sorted(edge)).or_default().add(1.0, &facet.normal));
        }
        for facet in &mut facets {
            let mean = |edge: [usize; 2]| of_edges.get(&sorted(edge)).map_or(facet.normal, Mean::value);
            facet.at_edges = edges(&facet.corners).map(mean).collect();
        }
        let at_vertices = at_vertices.iter().map(Mean::value).collect();
        let around = |number: usize| {
            let corners = &facets[number].corners;
            let share = 1.0 / corners.len() as f64;
            let centre = corners.iter().fold([0.0; 3], |sum, &corner| plus(&sum, share, &vertices[corner]));
            (centre, corners.iter().map(|&corner| length(&minus(&vertices[corner], &centre))).fold(0.0, f64::max))
        };
        let spheres = Spheres::new(facets.len(), &around);
        ClosedSurface { vertices, all: facets, at_vertices, spheres, bounds }
    }

    /// The least and the largest coordinates, m.
    #[must_use]
    pub fn bounds(&self) -> [Point; 2] {
        self.bounds
    }

    /// Number of facets.
    #[must_use]
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// True if there are no facets.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// The nearest point of the surface.
    #[must_use]
    pub fn nearest(&self, x: &Point) -> Nearest {
        if !x.iter().all(|c| c.is_finite()) {
            return Nearest::NONE;
        }
        let to = |number: usize| {
            let corners = &self.all[number].corners;
            let at = |i: usize| corners.get(i).map_or([0.0; 3], |&corner| self.vertices[corner]);
            closest(x, &[at(0), at(1), at(2)][..corners.len().min(3)])
        };
        let distance = |number: usize| length(&minus(x, &to(number).0));
        let Some(number) = self.spheres.nearest(x, &distance) else { return Nearest::NONE };
        let (facet, (foot, on)) = (&self.all[number], to(number));
        let away = minus(x, &foot);
        let normal = match on {
            On::Inside => return Nearest { distance: dot(&away, &facet.normal), normal: facet.normal },
            On::Edge(edge) => facet.at_edges.get(edge).copied().unwrap_or(facet.normal),
            On::Corner(corner) => facet.corners.get(corner).map_or(facet.normal, |&vertex| self.at_vertices[vertex]),
        };
        let (size, outwards) = (length(&away), dot(&away, &normal));
        // On a plane split into facets the direction is the normal of the plane, however near the point is.
        if length(&normal) > 1.0 - SHORTER {
            return Nearest { distance: dot(&away, &facet.normal), normal: facet.normal };
        }
        let reach = self.bounds.iter().map(length).fold(length(x), f64::max);
        let mean = unit(&normal).unwrap_or(facet.normal);
        if size <= ROUND_OFF * reach {
            return Nearest { distance: dot(&away, &mean), normal: mean };
        }
        let sign = if outwards < 0.0 { -1.0 } else { 1.0 };
        Nearest { distance: sign * size, normal: away.map(|c| sign * c / size) }
    }
}

/// A weighted mean of vectors.
#[derive(Clone, Default)]
struct Mean {
    sum: Point,
    weight: f64,
}

impl Mean {
    fn add(&mut self, weight: f64, vector: &Point) {
        self.sum = plus(&self.sum, weight, vector);
        self.weight += weight;
    }

    fn value(&self) -> Point {
        self.sum.map(|c| c / self.weight)
    }
}

fn sorted([a, b]: [usize; 2]) -> [usize; 2] {
    [a.min(b), a.max(b)]
}

/// The edges of a facet, each from a corner to the next; a segment is one.
fn edges(corners: &[usize]) -> impl Iterator<Item = [usize; 2]> {
    let count = if corners.len() == 2 { 1 } else { corners.len() };
    (0..count).map(move |i| [corners[i], corners[(i + 1) % corners.len()]])
}

/// A vector along the normal of a facet, of twice its area or of its length.
fn across(vertices: &[Point], corners: &[usize]) -> Point {
    match *corners {
        [a, b] => [vertices[b][1] - vertices[a][1], vertices[a][0] - vertices[b][0], 0.0],
        [a, b, c] => cross(&minus(&vertices[b], &vertices[a]), &minus(&vertices[c], &vertices[a])),
        _ => [0.0; 3],
    }
}

/// The signed area or volume between a facet and a point, positive if the normal points away from it.
fn content(vertices: &[Point], corners: &[usize], from: &Point) -> f64 {
    let Some(first) = corners.first() else { return 0.0 };
    let factor = if corners.len() == 2 { 0.5 } else { 1.0 / 6.0 };
    factor * dot(&across(vertices, corners), &minus(&vertices[*first], from))
}

/// The angle of a triangle at a corner; 1 at the end of a segment.
fn angle(vertices: &[Point], corners: &[usize], i: usize) -> f64 {
    let n = corners.len();
    if n < 3 {
        return 1.0;
    }
    let [own, next, last] = [i, i + 1, i + n - 1].map(|k| vertices[corners[k % n]]);
    let (a, b) = (minus(&next, &own), minus(&last, &own));
    length(&cross(&a, &b)).atan2(dot(&a, &b))
}

fn bounds(points: &[Point]) -> [Point; 2] {
    let fold = |start: f64, fold: fn(f64, f64) -> f64| -> Point {
        std::array::from_fn(|c| points.iter().map(|x| x[c]).fold(start, fold))
    };
    [fold(f64::INFINITY, f64::min), fold(f64::NEG_INFINITY, f64::max)]
}

/// Merges points within a distance of each other; returns the merged points and the number of each original one.
fn welded(points: &[Point], within: f64) -> (Vec<Point>, Vec<usize>) {
    let along = |x: &Point| dot(x, &ASKEW);
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_unstable_by(|&a, &b| along(&points[a]).total_cmp(&along(&points[b])).then(a.cmp(&b)));
    let (mut vertices, mut numbers): (Vec<Point>, Vec<usize>) = (Vec::new(), vec![0; points.len()]);
    for i in order {
        let x = &points[i];
        // Vertices are ordered along the direction: earlier ones are too far away.
        let near = vertices.iter().enumerate().rev().take_while(|(_, other)| along(x) - along(other) <= within);
        let same = near.filter(|(_, other)| length(&minus(x, other)) <= within).map(|(number, _)| number).last();
        numbers[i] = same.unwrap_or(vertices.len());
        if same.is_none() {
            vertices.push(*x);
        }
    }
    (vertices, numbers)
}

/// Checks that each facet has a normal.
fn check_area(vertices: &[Point], all: &[(usize, Vec<usize>)]) -> Result<(), FacetsFault> {
    let is_flat = |corners: &[usize]| {
        let longest = edges(corners).map(|[a, b]| length(&minus(&vertices[b], &vertices[a]))).fold(0.0, f64::max);
        corners.len() == 3 && length(&across(vertices, corners)) <= FLAT * longest * longest
    };
    let mut flat = all.iter().filter(|(_, corners)| is_flat(corners));
    let Some((number, corners)) = flat.next() else { return Ok(()) };
    let at = corners.first().map_or([0.0; 3], |corner| vertices[*corner]);
    Err(FacetsFault::Degenerate { count: 1 + flat.count(), first: (*number, at) })
}

/// Checks that two consistently oriented facets meet at each edge, or two segments at each end.
fn check_closed(vertices: &[Point], all: &[Vec<usize>]) -> Result<(), FacetsFault> {
    // Counts how often an edge is traversed from its lower to its higher vertex, and how often back; for segments, how
    // often a vertex is their first and their last.
    let mut seen: BTreeMap<[usize; 2], [usize; 2]> = BTreeMap::new();
    for corners in all {
        if let [a, b] = corners[..] {
            seen.entry([a, a]).or_default()[0] += 1;
            seen.entry([b, b]).or_default()[1] += 1;
            continue;
        }
        for edge in edges(corners) {
            seen.entry(sorted(edge)).or_default()[usize::from(edge[0] > edge[1])] += 1;
        }
    }
    let which = |is: &dyn Fn(usize, usize) -> bool| {
        let mut found = seen.iter().filter(|(_, [there, back])| is(*there, *back)).map(|(edge, _)| edge);
        let first = found.next()?.map(|vertex| vertices[vertex]);
        Some((1 + found.count(), first))
    };
    if let Some((count, first)) = which(&|there, back| there + back == 1) {
        return Err(FacetsFault::Open { count, first });
    }
    if let Some((count, first)) = which(&|there, back| there + back == 2 && there != back) {
        return Err(FacetsFault::Turned { count, first });
    }
    // Two solids that touch along an edge traverse it twice in each direction.
    if let Some((count, first)) = which(&|there, back| there != back) {
        return Err(FacetsFault::Crowded { count, first });
    }
    if all.is_empty() { Err(FacetsFault::Empty) } else { Ok(()) }
}
