//! Conditions at points given by coordinates.

use super::build::Build;
use super::place::At;
use super::raw::Boundary;
use crate::element::POINT_LEFT;
use crate::mesh::{FacetSet, Mesh};
use crate::tensor::{Point, length};

impl Build<'_> {
    /// Adds the points of `at` to the mesh under a name, and puts the name into the entries.
    pub fn places(&mut self, conditions: &mut [Boundary], mesh: &mut Mesh) {
        for (i, condition) in conditions.iter_mut().enumerate() {
            let path = format!("boundary[{i}]");
            let everywhere = || (0..mesh.points.len() as u32).collect::<Vec<u32>>();
            let (name, nodes) = match (&condition.at, condition.on.is_empty()) {
                (None, false) => continue,
                (Some(at), true) => {
                    let Some(nodes) = self.nodes_at(&format!("{path}.at"), at, mesh) else { continue };
                    let at = at.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ");
                    (format!("point ({at})"), nodes)
                }
                (given, _) => {
                    let found = if given.is_some() { "`on` and `at`" } else { "neither `on` nor `at`" };
                    let expected = "one of both: `on`, the name of a side, or `at`, the coordinates of a node";
                    self.note(&path, At::Value, found, expected, None);
                    // The place of the condition is unknown, but its other faults can still be found.
                    (String::new(), everywhere())
                }
            };
            mesh.edges.insert(name.clone(), FacetSet::of(&POINT_LEFT, nodes));
            condition.on = name;
        }
    }

    /// The node at these coordinates; on a placeholder mesh all nodes.
    fn nodes_at(&mut self, path: &str, at: &[f64], mesh: &Mesh) -> Option<Vec<u32>> {
        let all = || Some((0..mesh.points.len() as u32).collect());
        if self.no_mesh || !self.is_sound {
            return all();
        }
        if at.len() != mesh.dim {
            let expected = format!("{} coordinates", mesh.dim);
            self.note(path, At::Value, format!("{} coordinates", at.len()), expected, None);
            return all();
        }
        let at: Point = std::array::from_fn(|d| at.get(d).copied().unwrap_or_default());
        let distance = |x: &Point| length(&std::array::from_fn(|d| x[d] - at[d]));
        let nodes = mesh.nodes_at(&at);
        let nearest = mesh.points.iter().min_by(|x, y| distance(x).total_cmp(&distance(y)));
        match (nodes.len(), nearest) {
            (1, _) | (_, None) => Some(nodes),
            (0, Some(nearest)) => {
                let found = "no node at these coordinates";
                let expected = format!("those of a node; the nearest one is at {}", self.place(nearest));
                self.note(
                    path,
                    At::Value,
                    found,
                    expected,
                    Some("a mesh with a node there has a vertex of a cell at it"),
                );
                all()
            }
            (several, Some(_)) => {
                let found = format!("{several} nodes at these coordinates");
                let hint = "bodies that touch each have a node there; hold one of them by a side, or by points that the mesh file names";
                self.note(path, At::Value, found, "one node", Some(hint));
                all()
            }
        }
    }
}
