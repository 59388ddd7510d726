//! The tree of spheres around the parts of a side: finds the parts that may meet something without testing each part.

use super::part::FlatPiece;
use crate::mesh::Spheres;
use crate::tensor::Point;

/// The tree over the parts of a side.
pub(super) struct SphereTree<'p> {
    parts: &'p [FlatPiece],
    spheres: Spheres,
}

impl<'p> SphereTree<'p> {
    pub fn new(parts: &'p [FlatPiece]) -> SphereTree<'p> {
        SphereTree { parts, spheres: Spheres::new(parts.len(), &|part| (parts[part].centre, parts[part].radius)) }
    }

    /// The parts whose sphere `meets` something, with their numbers, in ascending order. Whatever meets a sphere must
    /// meet every sphere around it.
    pub fn met(&self, meets: &dyn Fn(&Point, f64) -> bool) -> Vec<(usize, &'p FlatPiece)> {
        let of_part = |part: usize| meets(&self.parts[part].centre, self.parts[part].radius);
        self.spheres.met(meets, &of_part).into_iter().map(|part| (part, &self.parts[part])).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// Triangles on a curved surface, `n` × `n`.
    fn parts(n: usize) -> Vec<FlatPiece> {
        let of = |k: usize| {
            let [i, j] = [(k % n) as f64, (k / n) as f64];
            let corner = |dx: f64, dy: f64| -> Point {
                let [x, y] = [i + dx, j + dy];
                [x + 0.2 * y, 0.9 * y, 0.3 * (0.4 * x).sin() + 0.1 * y]
            };
            let corners = vec![corner(0.0, 0.0), corner(1.0, 0.1), corner(0.2, 0.9)];
            FlatPiece::new(k, corners, vec![[0.0; 3]; 3], vec![0, 1, 2])
        };
        (0..n * n).map(of).collect()
    }

    /// The tree finds the same parts as a test of each part, with few tests.
    #[test]
    fn the_tree_finds_what_a_look_at_each_part_finds() {
        for n in [0, 1, 2, 3, 7, 40] {
            let parts = parts(n);
            let tree = SphereTree::new(&parts);
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
                    // The comparison itself tests each part once.
                    let looks = looks.get() - parts.len();
                    assert!(n < 40 || looks <= 150, "{looks} looks at {} parts", parts.len());
                }
            }
        }
    }
}
