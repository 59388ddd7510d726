//! Projection of a point onto a surface in space or a line in the plane.

use super::Mesh;
use super::locator::{CellBoxes, CellPlace, OUTSIDE};
use crate::element::{Element, MAX_NODES};
use crate::tensor::{Point, dot, length, minus};

/// Distance up to which a point belongs to a surface, as a fraction of the largest cell: two meshes of a curved side
/// differ.
const NEAR: f64 = 0.25;
/// Depth outside every reference cell up to which a point still belongs to it: above a convex edge it is above no cell.
const BESIDE: f64 = -0.1;

/// The cells of a mesh of one dimension less than its space.
#[derive(Debug)]
pub(super) struct SurfaceLocator {
    grid: CellBoxes,
    /// Distance up to which points belong to it, m.
    near: f64,
}

impl SurfaceLocator {
    /// Sorts the cells of a mesh.
    pub fn new(mesh: &Mesh) -> SurfaceLocator {
        let mut largest: f64 = 0.0;
        for block in &mesh.blocks {
            for cell in block.cells() {
                let first = &mesh.points[cell[0] as usize];
                let to = |&node: &u32| length(&minus(&mesh.points[node as usize], first));
                largest = cell.iter().map(to).fold(largest, f64::max);
            }
        }
        SurfaceLocator { grid: CellBoxes::of(mesh, mesh.dim + 1), near: NEAR * largest }
    }

    /// The cells below a point, with the reference coordinates: the nearest one, and others that meet it there.
    pub fn below(&self, mesh: &Mesh, p: &Point) -> Vec<(CellPlace, Point)> {
        let corners = [-self.near, self.near].map(|by| p.map(|x| x + by));
        let mut seen: Vec<CellPlace> = self.grid.near(corners.iter()).collect();
        seen.sort_unstable();
        seen.dedup();
        let project = |at: CellPlace| {
            let (element, nodes) = mesh.cell_at(at);
            let (x, distance) = project(mesh, element, nodes, p, 1e-12)?;
            Some((at, x, distance, element.shape.depth(&x))).filter(|_| distance <= self.near)
        };
        let found: Vec<_> = seen.into_iter().filter_map(project).collect();
        let inside = found.iter().filter(|(.., depth)| *depth > OUTSIDE);
        let least = inside.clone().map(|(.., distance, _)| *distance).fold(f64::INFINITY, f64::min);
        if least.is_finite() {
            let meets = |distance: f64| distance <= least + 1e-9 * self.near;
            return inside.filter(|(.., distance, _)| meets(*distance)).map(|(at, x, ..)| (*at, *x)).collect();
        }
        let deepest = found.iter().filter(|(.., depth)| *depth > BESIDE).max_by(|a, b| a.3.total_cmp(&b.3));
        deepest.map(|(at, x, ..)| (*at, *x)).into_iter().collect()
    }
}

/// The reference coordinates at which a cell or facet, extended beyond its sides, is nearest to a point, and the
/// distance in m, by Gauss–Newton iteration up to a step of size `small`.
pub(super) fn project(mesh: &Mesh, element: &Element, nodes: &[u32], p: &Point, small: f64) -> Option<(Point, f64)> {
    const MOST: usize = 50;
    const FAR: f64 = 10.0;
    let (mut values, mut gradients) = ([0.0; MAX_NODES], [[0.0; 3]; MAX_NODES]);
    let mut x = element.centre();
    for _ in 0..MOST {
        (element.shape_functions)(&x, &mut values[..nodes.len()]);
        (element.gradients)(&x, &mut gradients[..nodes.len()]);
        let (mut rest, mut tangents) = ([0.0; 3], [[0.0; 3]; 2]);
        for (n, &node) in nodes.iter().enumerate() {
            let at = minus(&mesh.points[node as usize], p);
            for c in 0..3 {
                rest[c] += values[n] * at[c];
                tangents[0][c] += gradients[n][0] * at[c];
                tangents[1][c] += gradients[n][1] * at[c];
            }
        }
        let [s, t] = &tangents;
        let (ss, right) = (dot(s, s), [-dot(s, &rest), -dot(t, &rest)]);
        let step = if element.dim() == 1 {
            [right[0] / ss, 0.0]
        } else {
            let (st, tt) = (dot(s, t), dot(t, t));
            let determinant = ss * tt - st * st;
            [(right[0] * tt - right[1] * st) / determinant, (right[1] * ss - right[0] * st) / determinant]
        };
        (x[0], x[1]) = (x[0] + step[0], x[1] + step[1]);
        let size = step[0].abs().max(step[1].abs());
        if size.is_nan() || x.iter().any(|c| c.abs() > FAR) {
            return None;
        }
        if size < small {
            return Some((x, length(&rest)));
        }
    }
    None
}

#[cfg(test)]
#[allow(clippy::expect_used, reason = "a test fails by panicking")]
mod tests {
    use std::fmt::Write;

    use crate::mesh::MeshData;
    use crate::tensor::Point;

    /// A grid file with these points and cells, with the number of each cell and a value of each point.
    fn file(points: &[Point], cells: &[Vec<usize>], code: u8, value: impl Fn(&Point) -> f64) -> String {
        let array = |kind: &str, name: &str, more: &str, values: Vec<String>| {
            let values = values.join(" ");
            format!("<DataArray type=\"{kind}\" Name=\"{name}\" format=\"ascii\"{more}>{values}</DataArray>\n")
        };
        let (mut out, n, count) = (String::new(), points.len(), cells.len());
        let _ = writeln!(out, "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\">");
        let _ = writeln!(out, "<UnstructuredGrid><Piece NumberOfPoints=\"{n}\" NumberOfCells=\"{count}\"><Points>");
        let coordinates = points.iter().flatten().map(|x| format!("{x:?}")).collect();
        out += &array("Float64", "Points", " NumberOfComponents=\"3\"", coordinates);
        out += "</Points><Cells>";
        out += &array("Int64", "connectivity", "", cells.iter().flatten().map(ToString::to_string).collect());
        let size = cells[0].len();
        out += &array("Int64", "offsets", "", (1..=count).map(|i| (i * size).to_string()).collect());
        out += &array("UInt8", "types", "", vec![code.to_string(); count]);
        out += "</Cells><CellData>";
        out += &array("Float64", "number", "", (0..count).map(|i| i.to_string()).collect());
        out += "</CellData><PointData>";
        out += &array("Float64", "value", "", points.iter().map(|x| format!("{:?}", value(x))).collect());
        out + "</PointData></Piece></UnstructuredGrid></VTKFile>\n"
    }

    fn data(file: &str, name: &str) -> MeshData {
        MeshData::read("map.vtu", file.as_bytes(), name, 1.0).expect("data").on_surface()
    }

    /// Triangles of an oblique plane: a linear function is exact on it, and above it has the value of the point below.
    #[test]
    fn a_plane_in_space_has_the_value_of_the_point_below() {
        let [e, f, g]: [Point; 3] = [[0.6, 0.0, 0.8], [0.64, 0.6, -0.48], [-0.48, 0.8, 0.36]];
        let at = |a: f64, b: f64, c: f64| -> Point { std::array::from_fn(|i| a * e[i] + b * f[i] + c * g[i]) };
        let n = 8;
        let node = |i: usize, j: usize| j * (n + 1) + i;
        let points: Vec<Point> =
            (0..=n).flat_map(|j| (0..=n).map(move |i| (i, j))).map(|(i, j)| at(i as f64, j as f64, 0.0)).collect();
        let halves = |(i, j): (usize, usize)| {
            let corners = [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)];
            [vec![corners[0], corners[1], corners[2]], vec![corners[0], corners[2], corners[3]]]
        };
        let cells: Vec<Vec<usize>> = (0..n).flat_map(|j| (0..n).map(move |i| (i, j))).flat_map(halves).collect();
        let linear = |x: &Point| 2.0 + x[0] - 3.0 * x[1] + 0.5 * x[2];
        let text = file(&points, &cells, 5, linear);
        let (by_node, by_cell) = (data(&text, "value"), data(&text, "number"));
        for (a, b) in [(0.0, 0.0), (3.3, 4.1), (7.9, 0.2), (8.0, 8.0), (2.0, 5.0)] {
            for c in [0.0, 0.2, -0.3] {
                let error = by_node.value(&at(a, b, c)) - linear(&at(a, b, 0.0));
                assert!(error.abs() < 1e-12, "{a} {b} {c}: {error:e}");
            }
        }
        // Square (3, 4) holds the cells 2 (4·8 + 3) and one more; their common edge has the mean of both.
        let square = 2.0 * (4.0 * 8.0 + 3.0);
        for (a, b, expected) in [(3.7, 4.2, square), (3.2, 4.7, square + 1.0), (3.5, 4.5, square + 0.5)] {
            assert!((by_cell.value(&at(a, b, 0.1)) - expected).abs() < 1e-12, "{a} {b}");
        }
        assert!(by_node.value(&at(3.0, 4.0, 2.0)).is_nan() && by_node.value(&at(9.0, 4.0, 0.0)).is_nan());
    }

    /// A polygon of chords of a circle: a point of the circle is above one chord, at most by its sagitta.
    #[test]
    fn a_circle_in_the_plane_is_above_its_chords() {
        let n = 24;
        let angle = |i: f64| std::f64::consts::TAU * i / f64::from(n);
        let on = |i: f64| -> Point { [angle(i).cos(), angle(i).sin(), 0.0] };
        let points: Vec<Point> = (0..n).map(|i| on(f64::from(i))).collect();
        let cells: Vec<Vec<usize>> = (0..n as usize).map(|i| vec![i, (i + 1) % n as usize]).collect();
        let text = file(&points, &cells, 3, |x| x[1].atan2(x[0]));
        let (number, value) = (data(&text, "number"), data(&text, "value"));
        for i in 0..n {
            assert!((number.value(&on(f64::from(i) + 0.4)) - f64::from(i)).abs() < 1e-12, "{i}");
        }
        // The value in the middle of a chord is the mean of those at its ends.
        assert!((value.value(&on(2.5)) - 0.5 * (angle(2.0) + angle(3.0))).abs() < 1e-12);
    }
}
