//! The surface of a body in space: the facets that belong to one cell only.

use std::collections::HashMap;

use super::PlotError;
use crate::element::{self, CellType, Drawing};
use crate::mesh::Mesh;

/// Largest number of vertices of a facet.
const VERTICES: usize = 4;

/// The surface of a body in space.
#[derive(Clone, Debug)]
pub struct Skin {
    /// All nodes of the body, m.
    pub(super) points: Vec<[f64; 3]>,
    /// Triangles oriented outwards; a quadratic facet gives four, six or eight.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The cell of each triangle.
    pub(super) owners: Vec<u32>,
    /// The facets by their nodes, first those around them, and the cell of each.
    pub(super) facets: Vec<(Vec<u32>, u32)>,
    /// Pieces of edges of facets, each once.
    pub(super) edges: Vec<SkinEdge>,
    pub(super) cells: usize,
}

/// A piece of an edge between two facets.
#[derive(Clone, Debug)]
pub(super) struct SkinEdge {
    pub nodes: [u32; 2],
    /// The facets that meet there; twice the same at a rim.
    pub facets: [u32; 2],
}

impl Skin {
    /// The surface of cells given by VTK type and nodes in the order of VTK: those of the element, or of the VTK cell
    /// if that has fewer.
    ///
    /// # Errors
    /// [`PlotError::Data`] if a cell is not one of [`element::ALL`] in space or has a missing node, or a coordinate is
    /// not finite.
    pub fn new<'a>(points: Vec<[f64; 3]>, cells: impl IntoIterator<Item = (u8, &'a [u32])>) -> Result<Skin, PlotError> {
        if let Some(node) = points.iter().position(|p| p.iter().any(|x| !x.is_finite())) {
            return Err(PlotError::Data(format!("the coordinates of node {node} are not finite")));
        }
        let mut surface =
            Skin { points, triangles: Vec::new(), owners: Vec::new(), facets: Vec::new(), edges: Vec::new(), cells: 0 };
        // Facets keep the order in which they came, so that a picture depends on the mesh only.
        let mut found: Vec<Option<(Vec<u32>, u32)>> = Vec::new();
        let mut open: HashMap<[u32; VERTICES], usize> = HashMap::new();
        for (c, (kind, nodes)) in cells.into_iter().enumerate() {
            let Some(element) = element::ALL.iter().find(|e| e.vtk() == kind && e.dim() == 3) else {
                return Err(PlotError::Data(format!(
                    "cell {c} has the VTK type {kind}, expected one of a body in space"
                )));
            };
            if ![element.nodes.len(), element.vtk_nodes()].contains(&nodes.len()) {
                return Err(PlotError::Data(format!(
                    "cell {c} has {} nodes, expected {}",
                    nodes.len(),
                    element.nodes.len()
                )));
            }
            if let Some(node) = nodes.iter().find(|&&n| n as usize >= surface.points.len()) {
                return Err(PlotError::Data(format!(
                    "cell {c} has node {node}, but there are only {} nodes",
                    surface.points.len()
                )));
            }
            for facet in element.facets {
                let own: Vec<u32> = facet.nodes.iter().filter_map(|&i| nodes.get(i).copied()).collect();
                // Facets are matched by vertices: a pyramid of a file lacks the middle node of its base, which its
                // neighbour has.
                let mut key = [u32::MAX; VERTICES];
                key.iter_mut().zip(own.iter().take(facet.element.shape.vertices())).for_each(|(k, n)| *k = *n);
                key.sort_unstable();
                if let Some(other) = open.remove(&key) {
                    found[other] = None;
                } else {
                    open.insert(key, found.len());
                    found.push(Some((own, c as u32)));
                }
            }
            surface.cells = c + 1;
        }
        if surface.cells == 0 {
            return Err(PlotError::Data("the mesh has no cells".to_owned()));
        }
        surface.facets = found.into_iter().flatten().collect();
        surface.divide();
        Ok(surface)
    }

    /// The surface of a mesh of the library.
    ///
    /// # Errors
    /// [`PlotError::Data`] if the mesh is not three-dimensional.
    pub fn of_mesh(mesh: &Mesh) -> Result<Skin, PlotError> {
        if mesh.dim != 3 {
            return Err(PlotError::Data(format!("the mesh is {}-dimensional, expected a body in space", mesh.dim)));
        }
        Skin::new(mesh.points.clone(), mesh.blocks.iter().flat_map(|b| b.cells().map(|cell| (b.element.vtk(), cell))))
    }

    /// Cuts the facets into triangles and finds their edges.
    fn divide(&mut self) {
        let mut places: HashMap<[u32; 2], usize> = HashMap::new();
        for (f, (nodes, cell)) in self.facets.iter().enumerate() {
            let Some(Drawing { outline, triangles: parts }) = CellType::drawing(nodes.len()) else { continue };
            for part in parts {
                self.triangles.push(part.map(|i| nodes[i]));
                self.owners.push(*cell);
            }
            for (i, &a) in outline.iter().enumerate() {
                let (a, b) = (nodes[a], nodes[outline[(i + 1) % outline.len()]]);
                let place = *places.entry([a.min(b), a.max(b)]).or_insert(self.edges.len());
                match self.edges.get_mut(place) {
                    Some(edge) => edge.facets[1] = f as u32,
                    None => self.edges.push(SkinEdge { nodes: [a, b], facets: [f as u32; 2] }),
                }
            }
        }
    }

    /// Number of nodes.
    #[must_use]
    pub fn nodes(&self) -> usize {
        self.points.len()
    }

    /// Number of cells.
    #[must_use]
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// Area of each triangle.
    pub(super) fn areas(&self) -> Vec<f64> {
        self.triangles.iter().map(|triangle| 0.5 * norm(self.across(triangle))).collect()
    }

    /// Twice the outward area vector of a triangle.
    fn across(&self, triangle: &[u32; 3]) -> [f64; 3] {
        across(triangle.map(|n| self.points[n as usize]))
    }

    /// Outward area vector of a facet.
    pub(super) fn normal(&self, facet: usize) -> [f64; 3] {
        let nodes = &self.facets[facet].0;
        let parts = CellType::drawing(nodes.len()).map_or(&[][..], |drawing| drawing.triangles);
        parts.iter().fold([0.0; 3], |sum, part| {
            let n = self.across(&part.map(|i| nodes[i]));
            [0, 1, 2].map(|d| sum[d] + 0.5 * n[d])
        })
    }

    /// The edges at which the surface bends by more than 35°, and those between regions.
    pub(super) fn outline(&self, regions: &[f64]) -> Vec<[u32; 2]> {
        const STRAIGHT: f64 = 0.819;
        let normals: Vec<[f64; 3]> = (0..self.facets.len()).map(|f| self.normal(f)).collect();
        let region = |f: usize| regions.get(self.facets[f].1 as usize).copied().unwrap_or_default();
        let is_outline = |edge: &&SkinEdge| {
            let [f, g] = edge.facets.map(|f| f as usize);
            dot(normals[f], normals[g]) < STRAIGHT * norm(normals[f]) * norm(normals[g])
                || (region(f) - region(g)).abs() > 0.0
        };
        self.edges.iter().filter(is_outline).map(|edge| edge.nodes).collect()
    }
}

/// (b − a) × (c − a).
pub(super) fn across([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let (p, q) = ([0, 1, 2].map(|d| b[d] - a[d]), [0, 1, 2].map(|d| c[d] - a[d]));
    [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Elements;

    type Outcome = Result<(), Box<dyn std::error::Error>>;

    /// By the divergence theorem the surface encloses ⅓ ∫ x·ν = 1·2·3, whatever the cells; its area is 22.
    #[test]
    fn the_surface_of_a_box_encloses_it() -> Outcome {
        for elements in [Elements::P1, Elements::P2, Elements::Q1, Elements::Q2] {
            let mesh = Mesh::box_([1.0, 2.0, 3.0], [2, 3, 2], elements)?;
            let surface = Skin::of_mesh(&mesh)?;
            let flux = |t: &[u32; 3]| dot(surface.points[t[0] as usize], surface.across(t)) / 6.0;
            assert!((surface.triangles.iter().map(flux).sum::<f64>() - 6.0).abs() < 1e-12, "{elements:?}");
            assert!((surface.areas().iter().sum::<f64>() - 22.0).abs() < 1e-12, "{elements:?}");
            // Euler: V − E + F = 2 for a closed surface; here checked by the outlines of its facets.
            assert!(surface.edges.iter().all(|e| e.facets[0] != e.facets[1]), "a closed surface has no rim");
        }
        Ok(())
    }

    /// A pyramid on a cube, and alone, with and without the middle node of its base: volumes 4/3 and 1/3.
    #[test]
    fn the_base_of_a_pyramid_is_a_facet_of_its_neighbour() -> Outcome {
        let mut mesh = Mesh::box_([1.0; 3], [1; 3], Elements::Q2)?;
        let cube = mesh.blocks[0].nodes.clone();
        let base: Vec<u32> = mesh.blocks[0].element.facets[1].nodes.iter().map(|&i| cube[i]).collect();
        let first = mesh.points.len() as u32;
        mesh.points.push([0.5, 0.5, 2.0]);
        for &corner in &base[..4] {
            let [x, y, z] = mesh.points[corner as usize];
            mesh.points.push([0.5 * (x + 0.5), 0.5 * (y + 0.5), 0.5 * (z + 2.0)]);
        }
        let up: Vec<u32> = (first + 1..first + 5).collect();
        let pyramid = [&base[..4], &[first], &base[4..8], &up, &base[8..]].concat();
        for nodes in [13, 14] {
            let alone = (27, &pyramid[..nodes]);
            for (cells, volume) in [(vec![(29, cube.as_slice()), alone], 4.0 / 3.0), (vec![alone], 1.0 / 3.0)] {
                let surface = Skin::new(mesh.points.clone(), cells)?;
                let flux = |t: &[u32; 3]| dot(surface.points[t[0] as usize], surface.across(t)) / 6.0;
                let found: f64 = surface.triangles.iter().map(flux).sum();
                assert!((found - volume).abs() < 1e-14, "{nodes} nodes: {found} instead of {volume}");
                assert!(surface.edges.iter().all(|e| e.facets[0] != e.facets[1]), "a closed surface has no rim");
            }
        }
        Ok(())
    }

    /// The outline of a box are its edges, of length 4 (1 + 2 + 3); a second region adds the line between both.
    #[test]
    fn the_outline_of_a_box_are_its_edges() -> Outcome {
        let mesh = Mesh::box_([1.0, 2.0, 3.0], [2, 2, 2], Elements::Q2)?;
        let surface = Skin::of_mesh(&mesh)?;
        let length = |edges: &[[u32; 2]]| -> f64 {
            let ends = |e: &[u32; 2]| e.map(|n| surface.points[n as usize]);
            edges.iter().map(ends).map(|[a, b]| norm([0, 1, 2].map(|d| b[d] - a[d]))).sum()
        };
        assert!((length(&surface.outline(&[])) - 24.0).abs() < 1e-12);
        let upper: Vec<f64> =
            mesh.blocks[0].cells().map(|cell| f64::from(u8::from(mesh.points[cell[26] as usize][2] > 1.5))).collect();
        assert!((length(&surface.outline(&upper)) - 30.0).abs() < 1e-12);
        Ok(())
    }

    #[test]
    fn cells_that_are_not_in_space_are_named() {
        let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        for (cell, word) in [
            ((5u8, [0u32, 1, 2].as_slice()), "VTK type 5"),
            ((10, &[0, 1, 2]), "3 nodes"),
            ((10, &[0, 1, 2, 9]), "node 9"),
        ] {
            let error = Skin::new(points.clone(), [cell]).map(|_| ()).map_err(|e| e.to_string());
            assert!(error.clone().is_err_and(|e| e.contains(word)), "{error:?}");
        }
    }
}
