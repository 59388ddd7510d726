//! A tree of spheres around parts of a mesh or a surface: finds the parts that may meet something, or the one nearest
//! to a point, without testing each part.
//!
//! It serves facets that face each other, triangles of an obstacle, and nodes next to a facet. The cell that contains a
//! point is found by [`Locator`](super::Locator) instead, in a grid whose boxes have the size of a cell: few cells are
//! candidates, and their number does not grow with the mesh.

use crate::tensor::{Point, length, minus};

/// Largest number of parts in a leaf.
const LEAF: usize = 6;
/// Relative round-off of a radius.
const ROUND_OFF: f64 = 1e-9;

/// The tree over numbered parts.
#[derive(Clone, Debug)]
pub(crate) struct Spheres {
    /// Numbers of the parts, grouped by sphere.
    order: Vec<usize>,
    /// The spheres; the root comes first.
    all: Vec<BoundingSphere>,
}

/// A sphere around the parts `from..to` in the order of the tree.
#[derive(Clone, Debug)]
struct BoundingSphere {
    centre: Point,
    radius: f64,
    from: usize,
    to: usize,
    /// The spheres around the two halves of the parts; `None` for a leaf.
    halves: Option<[usize; 2]>,
}

impl Spheres {
    /// The tree over `count` parts; `around` gives the centre and radius of a sphere around each.
    pub fn new(count: usize, around: &dyn Fn(usize) -> (Point, f64)) -> Spheres {
        let mut tree = Spheres { order: (0..count).collect(), all: Vec::new() };
        tree.add(0, count, around);
        tree
    }

    /// Adds the sphere around some parts and, recursively, those of its halves, split along the axis where their
    /// centres are spread the widest.
    fn add(&mut self, from: usize, to: usize, around: &dyn Fn(usize) -> (Point, f64)) -> usize {
        let own = &self.order[from..to];
        let along = |c: usize| own.iter().map(move |&part| around(part).0[c]);
        let bounds: [[f64; 2]; 3] = std::array::from_fn(|c| {
            [along(c).fold(f64::INFINITY, f64::min), along(c).fold(f64::NEG_INFINITY, f64::max)]
        });
        let centre: Point = bounds.map(|[least, most]| 0.5 * (least + most));
        let reach = |part: usize| {
            let (own, radius) = around(part);
            length(&minus(&own, &centre)) + radius
        };
        let radius = own.iter().map(|&part| reach(part)).fold(0.0, f64::max) * (1.0 + ROUND_OFF);
        let place = self.all.len();
        self.all.push(BoundingSphere { centre, radius, from, to, halves: None });
        if to - from > LEAF {
            let spread = |c: usize| bounds[c][1] - bounds[c][0];
            let axis = (0..3).max_by(|&a, &b| spread(a).total_cmp(&spread(b))).unwrap_or(0);
            let middle = (to - from) / 2;
            let coordinate = |part: usize| around(part).0[axis];
            // Equal coordinates are ordered by number, so that the tree is reproducible.
            self.order[from..to]
                .select_nth_unstable_by(middle, |&a, &b| coordinate(a).total_cmp(&coordinate(b)).then(a.cmp(&b)));
            self.all[place].halves = Some([self.add(from, from + middle, around), self.add(from + middle, to, around)]);
        }
        place
    }

    /// The numbers of the parts that may meet something, ascending: parts of the leaves whose sphere `meets` it.
    /// Whatever meets a sphere must meet every sphere around it.
    pub fn met(&self, meets: &dyn Fn(&Point, f64) -> bool, meets_part: &dyn Fn(usize) -> bool) -> Vec<usize> {
        let (mut open, mut found) = (vec![0], Vec::new());
        while let Some(sphere) = open.pop().map(|place: usize| &self.all[place]) {
            if !meets(&sphere.centre, sphere.radius) {
                continue;
            }
            match sphere.halves {
                Some(halves) => open.extend(halves),
                None => {
                    found.extend(self.order[sphere.from..sphere.to].iter().copied().filter(|&part| meets_part(part)));
                }
            }
        }
        found.sort_unstable();
        found
    }

    /// The number of the part nearest to a point, by `distance`; the first of several.
    pub fn nearest(&self, x: &Point, distance: &dyn Fn(usize) -> f64) -> Option<usize> {
        let least = |place: usize| {
            let sphere = &self.all[place];
            length(&minus(x, &sphere.centre)) - sphere.radius
        };
        let (mut open, mut best): (Vec<usize>, Option<(f64, usize)>) = (vec![0], None);
        while let Some(place) = open.pop() {
            if best.is_some_and(|(distance, _)| least(place) > distance) {
                continue;
            }
            let sphere = &self.all[place];
            if let Some([a, b]) = sphere.halves {
                // The nearer half comes last, as it is visited first.
                open.extend(if least(a) < least(b) { [b, a] } else { [a, b] });
                continue;
            }
            for &part in &self.order[sphere.from..sphere.to] {
                let here = distance(part);
                if best.is_none_or(|(distance, number)| here < distance || (here <= distance && part < number)) {
                    best = Some((here, part));
                }
            }
        }
        best.map(|(_, part)| part)
    }
}
