//! A plane mesh prepared for pictures: triangles, edges, boundary, grid lines.

use std::collections::HashMap;

use super::PlotError;
use super::axes;
use crate::element::{CellType, Drawing};
use crate::mesh::Mesh;

/// A mesh in the plane.
#[derive(Clone, Debug)]
pub struct PlaneMesh {
    pub(super) points: Vec<[f64; 2]>,
    /// Triangles: two per cell of four nodes, four or eight per quadratic cell.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The cell of each triangle.
    pub(super) owners: Vec<u32>,
    /// Edges of the cells, each once.
    pub(super) edges: Vec<[u32; 2]>,
    /// Edges of one cell only, with the body on their left.
    pub(super) boundary: Vec<[u32; 2]>,
    pub(super) cells: usize,
}

impl PlaneMesh {
    /// A body of triangles and quadrilaterals, linear or quadratic, given by nodes in the order of VTK.
    ///
    /// # Errors
    /// [`PlotError::Data`] if a cell has another number of nodes or a missing node, or a coordinate is not finite.
    pub fn new<'a>(points: Vec<[f64; 2]>, cells: impl IntoIterator<Item = &'a [u32]>) -> Result<PlaneMesh, PlotError> {
        if let Some(node) = points.iter().position(|p| !(p[0].is_finite() && p[1].is_finite())) {
            return Err(PlotError::Data(format!("the coordinates of node {node} are not finite")));
        }
        let mut body = PlaneMesh {
            points,
            triangles: Vec::new(),
            owners: Vec::new(),
            edges: Vec::new(),
            boundary: Vec::new(),
            cells: 0,
        };
        let mut sides: HashMap<[u32; 2], ([u32; 2], usize)> = HashMap::new();
        let mut order = Vec::new();
        for (c, cell) in cells.into_iter().enumerate() {
            let Some(Drawing { outline, triangles }) = CellType::drawing(cell.len()) else {
                let expected = CellType::node_counts(|element| element.dim() == 2);
                return Err(PlotError::Data(format!("cell {c} has {} nodes, expected {expected}", cell.len())));
            };
            if let Some(node) = cell.iter().find(|&&n| n as usize >= body.points.len()) {
                return Err(PlotError::Data(format!(
                    "cell {c} has node {node}, but there are only {} nodes",
                    body.points.len()
                )));
            }
            let mut around: Vec<u32> = outline.iter().map(|&i| cell[i]).collect();
            let is_mirrored = body.signed_area(&around) < 0.0;
            if is_mirrored {
                around.reverse();
            }
            for part in triangles {
                let [a, b, d] = part.map(|i| cell[i]);
                body.triangles.push(if is_mirrored { [d, b, a] } else { [a, b, d] });
                body.owners.push(c as u32);
            }
            for (i, &a) in around.iter().enumerate() {
                let b = around[(i + 1) % around.len()];
                let key = [a.min(b), a.max(b)];
                let side = sides.entry(key).or_insert_with(|| {
                    order.push(key);
                    ([a, b], 0)
                });
                side.1 += 1;
            }
            body.cells = c + 1;
        }
        if body.cells == 0 {
            return Err(PlotError::Data("the mesh has no cells".to_owned()));
        }
        // Edges keep the order in which they came, so that a picture depends on the mesh only.
        body.boundary =
            order.iter().filter_map(|key| sides.get(key)).filter(|side| side.1 == 1).map(|side| side.0).collect();
        body.edges = order;
        Ok(body)
    }

    /// The body of a mesh of the library.
    ///
    /// # Errors
    /// [`PlotError::Data`] if the mesh is not two-dimensional.
    pub fn of_mesh(mesh: &Mesh) -> Result<PlaneMesh, PlotError> {
        if mesh.dim != 2 {
            return Err(PlotError::Data(format!("the mesh is {}-dimensional, expected a plane one", mesh.dim)));
        }
        let points = mesh.points.iter().map(|p| [p[0], p[1]]).collect();
        PlaneMesh::new(points, mesh.blocks.iter().flat_map(crate::mesh::Block::cells))
    }

    fn signed_area(&self, around: &[u32]) -> f64 {
        let p = |i: usize| self.points[around[i % around.len()] as usize];
        (0..around.len()).map(|i| p(i)[0] * p(i + 1)[1] - p(i + 1)[0] * p(i)[1]).sum::<f64>() * 0.5
    }

    /// The body with its nodes at other positions.
    pub(super) fn moved(&self, points: Vec<[f64; 2]>) -> PlaneMesh {
        PlaneMesh { points, ..self.clone() }
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
        self.triangles.iter().map(|triangle| self.signed_area(triangle)).collect()
    }

    /// Ranges of x and y.
    pub(super) fn window(&self) -> [[f64; 2]; 2] {
        window(&self.points)
    }

    /// Lines of nodes that show the mesh: a selection of grid lines if the nodes lie on a grid, else all edges, or the
    /// boundary alone if there are too many edges to distinguish.
    pub(super) fn lines(&self) -> Vec<Vec<u32>> {
        const MOST_EDGES: usize = 30_000;
        self.grid_lines().unwrap_or_else(|| {
            let edges = if self.edges.len() > MOST_EDGES { &self.boundary } else { &self.edges };
            edges.iter().map(|e| e.to_vec()).collect()
        })
    }

    /// Rows and columns of the grid of the nodes, thinned evenly, or `None` if the nodes lie on no grid.
    fn grid_lines(&self) -> Option<Vec<Vec<u32>>> {
        let [wx, wy] = self.window();
        let near = 1e-9 * (wx[1] - wx[0]).max(wy[1] - wy[0]);
        let (xs, ys) =
            (distinct(self.points.iter().map(|p| p[0]), near), distinct(self.points.iter().map(|p| p[1]), near));
        if xs.len() * ys.len() > 4 * self.points.len() + 4 {
            return None;
        }
        let place = |values: &[f64], v: f64| values.partition_point(|&w| w < v - near);
        let mut rows = vec![Vec::new(); ys.len()];
        let mut columns = vec![Vec::new(); xs.len()];
        for (n, p) in self.points.iter().enumerate() {
            let (i, j) = (place(&xs, p[0]), place(&ys, p[1]));
            rows[j].push((i, n as u32));
            columns[i].push((j, n as u32));
        }
        let is_edge: std::collections::HashSet<[u32; 2]> = self.edges.iter().copied().collect();
        let mut lines = Vec::new();
        for (family, last) in [(rows, xs.len() - 1), (columns, ys.len() - 1)] {
            let mut whole = Vec::new();
            for mut line in family {
                line.sort_unstable();
                // Centres of crossed cells form lines that are not grid lines.
                if line.first().is_some_and(|f| f.0 == 0) && line.last().is_some_and(|l| l.0 == last) {
                    let nodes: Vec<u32> = line.into_iter().map(|(_, n)| n).collect();
                    if !nodes.windows(2).all(|p| is_edge.contains(&[p[0].min(p[1]), p[0].max(p[1])])) {
                        return None;
                    }
                    whole.push(nodes);
                }
            }
            if whole.len() < 2 {
                return None;
            }
            lines.extend(selection(whole.len()).into_iter().map(|i| std::mem::take(&mut whole[i])));
        }
        Some(lines)
    }
}

/// Ranges of x and y of some points.
pub(super) fn window(points: &[[f64; 2]]) -> [[f64; 2]; 2] {
    [0, 1].map(|d| axes::range(points.iter().map(|p| p[d])).unwrap_or([0.0, 1.0]))
}

fn distinct(values: impl Iterator<Item = f64>, near: f64) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    values.dedup_by(|b, a| *b - *a <= near);
    values
}

/// The drawn ones of `count` grid lines: at most 33, evenly spaced if the number allows it, including the first and the
/// last.
fn selection(count: usize) -> Vec<usize> {
    const MOST: usize = 32;
    let intervals = count - 1;
    let least = intervals.div_ceil(MOST).max(1);
    let stride = (least..=2 * least).find(|s| intervals.is_multiple_of(*s)).unwrap_or(least);
    let mut chosen: Vec<usize> = (0..count).step_by(stride).collect();
    if chosen.last() != Some(&intervals) {
        chosen.push(intervals);
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Diagonal, Elements};

    fn rectangle(n: usize, diagonal: Diagonal) -> Result<PlaneMesh, Box<dyn std::error::Error>> {
        Ok(PlaneMesh::of_mesh(&Mesh::rectangle([2.0, 1.0], [2 * n, n], diagonal)?)?)
    }

    #[test]
    fn edges_and_boundary_of_a_rectangle() -> Result<(), Box<dyn std::error::Error>> {
        let body = rectangle(4, Diagonal::Right)?;
        // Euler: V − E + F = 1.
        assert_eq!(body.nodes() + body.cells(), body.edges.len() + 1);
        assert_eq!(body.boundary.len(), 24);
        for [a, b] in &body.boundary {
            let (p, q) = (body.points[*a as usize], body.points[*b as usize]);
            let left = [0.5 * (p[0] + q[0]) - (q[1] - p[1]), 0.5 * (p[1] + q[1]) + (q[0] - p[0])];
            assert!(
                left[0] > 0.0 && left[0] < 2.0 && left[1] > 0.0 && left[1] < 1.0,
                "the body is not on the left of {p:?} → {q:?}"
            );
        }
        Ok(())
    }

    #[test]
    fn grid_lines_of_every_diagonal() -> Result<(), Box<dyn std::error::Error>> {
        for diagonal in [Diagonal::Right, Diagonal::Left, Diagonal::Crossed] {
            let lines = rectangle(4, diagonal)?.grid_lines().ok_or("no grid found")?;
            assert_eq!(lines.len(), 5 + 9, "{diagonal:?}");
            assert!(lines.iter().all(|l| l.len() == 9 || l.len() == 5));
        }
        let lines = rectangle(64, Diagonal::Right)?.lines();
        assert_eq!(lines.len(), 33 + 33);
        Ok(())
    }

    #[test]
    fn a_mesh_off_a_grid_shows_its_edges() -> Result<(), PlotError> {
        let points = vec![[0.0, 0.0], [1.0, 0.1], [0.9, 1.0], [0.1, 0.9], [0.45, 0.55]];
        let cells: [&[u32]; 4] = [&[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]];
        let body = PlaneMesh::new(points, cells)?;
        assert_eq!(body.lines().len(), 8);
        assert_eq!(body.boundary.len(), 4);
        Ok(())
    }

    #[test]
    fn quadrilaterals_are_two_triangles() -> Result<(), PlotError> {
        let points = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        // Clockwise, to test that the orientation is corrected.
        let body = PlaneMesh::new(points, [[0u32, 3, 2, 1].as_slice()])?;
        assert_eq!(
            (body.triangles.len(), body.owners.as_slice(), body.edges.len(), body.boundary.len()),
            (2, [0u32, 0].as_slice(), 4, 4)
        );
        assert!(body.triangles.iter().all(|t| body.signed_area(t) > 0.0));
        Ok(())
    }

    /// The triangles of quadratic cells cover them, along their curved sides.
    #[test]
    fn quadratic_cells_are_covered() -> Result<(), Box<dyn std::error::Error>> {
        for elements in [Elements::P2, Elements::Q2] {
            let body = PlaneMesh::of_mesh(&Mesh::disc(1.0, [4, 32], elements)?)?;
            assert_eq!(body.areas().len(), body.triangles.len());
            // The polygon through the 64 nodes on the circle.
            let expected = 32.0 * (std::f64::consts::TAU / 64.0).sin();
            assert!((body.areas().iter().sum::<f64>() - expected).abs() < 1e-12);
            assert_eq!(body.boundary.len(), 64);
        }
        Ok(())
    }

    #[test]
    fn bad_cells_are_named() {
        let points = vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        for (cell, word) in [([0u32, 1].as_slice(), "2 nodes"), ([0, 1, 7].as_slice(), "node 7")] {
            let error = PlaneMesh::new(points.clone(), [cell]).map(|_| ()).map_err(|e| e.to_string());
            assert!(error.clone().is_err_and(|e| e.contains(word)), "{error:?}");
        }
    }

    #[test]
    fn selections_keep_both_ends() {
        for count in 2..300 {
            let chosen = selection(count);
            assert!(
                chosen.first() == Some(&0)
                    && chosen.last() == Some(&(count - 1))
                    && chosen.len() <= 34
                    && chosen.len() >= count.min(12)
            );
        }
        assert_eq!(selection(257).len(), 33);
    }
}
