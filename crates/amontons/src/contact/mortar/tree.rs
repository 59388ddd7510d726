//! A tree of spheres around the parts of a side: those that may meet something are found without a look at each part.

use super::part::Part;
use crate::tensor::{Point, length};

/// Parts in a leaf at the most.
const LEAF: usize = 6;
/// Relative round-off of a radius.
const ROUND_OFF: f64 = 1e-9;

/// The tree over the parts of a side.
pub(super) struct Tree<'p> {
    parts: &'p [Part],
    /// Numbers of the parts, those of each sphere together.
    order: Vec<usize>,
    /// The whole first.
    spheres: Vec<Sphere>,
}

/// A sphere around the parts `from..to` in the order of the tree.
struct Sphere {
    centre: Point,
    radius: f64,
    from: usize,
    to: usize,
    /// The spheres around either half of the parts; none for a leaf.
    halves: Option<[usize; 2]>,
}

impl<'p> Tree<'p> {
    pub fn new(parts: &'p [Part]) -> Tree<'p> {
        let mut tree = Tree { parts, order: (0..parts.len()).collect(), spheres: Vec::new() };
        tree.add(0, parts.len());
        tree
    }

    /// Adds the sphere around some parts and those in it, halved where their centres are spread the widest.
    fn add(&mut self, from: usize, to: usize) -> usize {
        let (own, parts) = (&self.order[from..to], self.parts);
        let along = |c: usize| own.iter().map(move |&part| parts[part].centre[c]);
        let bounds: [[f64; 2]; 3] = std::array::from_fn(|c| {
            [along(c).fold(f64::INFINITY, f64::min), along(c).fold(f64::NEG_INFINITY, f64::max)]
        });
        let centre: Point = bounds.map(|[least, most]| 0.5 * (least + most));
        let reach = |part: &Part| length(&std::array::from_fn(|c| part.centre[c] - centre[c])) + part.radius;
        let radius = own.iter().map(|&part| reach(&parts[part])).fold(0.0, f64::max) * (1.0 + ROUND_OFF);
        let place = self.spheres.len();
        self.spheres.push(Sphere { centre, radius, from, to, halves: None });
        if to - from > LEAF {
            let spread = |c: usize| bounds[c][1] - bounds[c][0];
            let axis = (0..3).max_by(|&a, &b| spread(a).total_cmp(&spread(b))).unwrap_or(0);
            let middle = (to - from) / 2;
            let coordinate = |part: usize| parts[part].centre[axis];
            // Equal coordinates by number, so that the tree is the same always.
            self.order[from..to]
                .select_nth_unstable_by(middle, |&a, &b| coordinate(a).total_cmp(&coordinate(b)).then(a.cmp(&b)));
            self.spheres[place].halves = Some([self.add(from, from + middle), self.add(from + middle, to)]);
        }
        place
    }

    /// The parts whose sphere `meets` something, with their numbers, in their order. What meets a sphere must meet
    /// every sphere around it.
    pub fn met(&self, meets: &dyn Fn(&Point, f64) -> bool) -> Vec<(usize, &'p Part)> {
        let (mut open, mut found) = (vec![0], Vec::new());
        while let Some(sphere) = open.pop().map(|place: usize| &self.spheres[place]) {
            if !meets(&sphere.centre, sphere.radius) {
                continue;
            }
            match sphere.halves {
                Some(halves) => open.extend(halves),
                None => found.extend(self.order[sphere.from..sphere.to].iter().copied().filter(|&part| {
                    let part = &self.parts[part];
                    meets(&part.centre, part.radius)
                })),
            }
        }
        found.sort_unstable();
        found.into_iter().map(|part| (part, &self.parts[part])).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// Triangles on a surface that is not flat, `n` × `n`.
    fn parts(n: usize) -> Vec<Part> {
        let of = |k: usize| {
            let [i, j] = [(k % n) as f64, (k / n) as f64];
            let corner = |dx: f64, dy: f64| -> Point {
                let [x, y] = [i + dx, j + dy];
                [x + 0.2 * y, 0.9 * y, 0.3 * (0.4 * x).sin() + 0.1 * y]
            };
            let corners = vec![corner(0.0, 0.0), corner(1.0, 0.1), corner(0.2, 0.9)];
            Part::new(k, corners, vec![[0.0; 3]; 3], vec![0, 1, 2])
        };
        (0..n * n).map(of).collect()
    }

    /// The tree finds what a look at each part finds, and looks at few.
    #[test]
    fn the_tree_finds_what_a_look_at_each_part_finds() {
        for n in [0, 1, 2, 3, 7, 40] {
            let parts = parts(n);
            let tree = Tree::new(&parts);
            for part in parts.iter().step_by(13) {
                for distance in [0.0, 0.7, 5.0] {
                    let looks = Cell::new(0);
                    let covers = |centre: &Point, radius: f64| {
                        looks.set(looks.get() + 1);
                        part.may_cover(centre, radius)
                    };
                    let near = |centre: &Point, radius: f64| part.is_within(distance, centre, radius);
                    let queries: [(&dyn Fn(&Point, f64) -> bool, &str); 2] = [(&covers, "covers"), (&near, "near")];
                    for (meets, name) in queries {
                        let found: Vec<usize> = tree.met(meets).iter().map(|(_, part)| part.facet).collect();
                        let all = parts.iter().filter(|other| meets(&other.centre, other.radius));
                        assert_eq!(found, all.map(|other| other.facet).collect::<Vec<usize>>(), "{name}, {n}");
                        assert!(!found.is_empty());
                    }
                    // One look at each part is that of the comparison.
                    let looks = looks.get() - parts.len();
                    assert!(n < 40 || looks <= 150, "{looks} looks at {} parts", parts.len());
                }
            }
        }
    }
}
