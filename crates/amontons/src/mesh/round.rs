//! Meshes of discs, rings, sectors and cylinders. The middle nodes of quadratic elements lie on the circle.

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, TAU};

use super::generate::{body, check};
use super::{Elements, FacetSet, Mesh, MeshError};
use crate::element::{P1_SEGMENT, Q1_QUADRILATERAL};
use crate::tensor::Point;

/// A plane section of bilinear quadrilaterals.
struct CrossSection {
    mesh: Mesh,
    /// From this node on, nodes lie on circles around the origin, and so do the middles between two of them.
    curved: usize,
}

/// The unit vector at an angle; exact on the axes.
fn unit(angle: f64) -> [f64; 2] {
    let exact = |c: f64| if c.abs() < 4.0 * f64::EPSILON { 0.0 } else { c };
    [exact(angle.cos()), exact(angle.sin())]
}

/// The point at the mean distance from the z-axis, in the mean direction and at the mean height.
fn polar_mean(points: &[Point]) -> Point {
    let (mut radius, mut direction, mut z) = (0.0, [0.0; 2], 0.0);
    for p in points {
        let r = p[0].hypot(p[1]);
        radius += r / points.len() as f64;
        z += p[2] / points.len() as f64;
        direction = [direction[0] + p[0] / r, direction[1] + p[1] / r];
    }
    let length = direction[0].hypot(direction[1]);
    [radius * direction[0] / length, radius * direction[1] / length, z]
}

/// Checks the radii: both finite, 0 ≤ inner < outer.
fn check_radii(inner: f64, outer: f64) -> Result<(), MeshError> {
    if !(inner.is_finite() && inner >= 0.0) {
        return Err(MeshError::Size { direction: 0, found: inner });
    }
    if !(outer.is_finite() && outer > 0.0) {
        return Err(MeshError::Size { direction: 0, found: outer });
    }
    if inner < outer { Ok(()) } else { Err(MeshError::Radii { inner, outer }) }
}

/// A ring, or a sector of it starting at the angle 0.
fn ring([inner, outer]: [f64; 2], sector: Option<f64>, [radial, around]: [usize; 2]) -> CrossSection {
    let steps = if sector.is_some() { around + 1 } else { around };
    let at = |i: usize, j: usize| ((j % steps) * (radial + 1) + i) as u32;
    let mut points = Vec::with_capacity(steps * (radial + 1));
    for j in 0..steps {
        let [c, s] = unit(sector.unwrap_or(TAU) * (j as f64 / around as f64));
        for i in 0..=radial {
            let r = inner + (outer - inner) * (i as f64 / radial as f64);
            points.push([r * c, r * s, 0.0]);
        }
    }
    let cells = (0..around)
        .flat_map(|j| (0..radial).flat_map(move |i| [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]))
        .collect();
    let side = |nodes: Vec<u32>| FacetSet::of(&P1_SEGMENT, nodes);
    let mut facets = BTreeMap::from([
        ("outer".to_owned(), side((0..around).flat_map(|j| [at(radial, j), at(radial, j + 1)]).collect())),
        ("inner".to_owned(), side((0..around).flat_map(|j| [at(0, j + 1), at(0, j)]).collect())),
    ]);
    if sector.is_some() {
        facets.insert("start".to_owned(), side((0..radial).flat_map(|i| [at(i, 0), at(i + 1, 0)]).collect()));
        facets.insert("end".to_owned(), side((0..radial).flat_map(|i| [at(i + 1, around), at(i, around)]).collect()));
    }
    CrossSection { mesh: body(&Q1_QUADRILATERAL, points, cells, facets), curved: 0 }
}

/// A disc: a square of n × n cells in the middle, n = around/4, and layers between it and the circle.
fn disc(radius: f64, [radial, around]: [usize; 2]) -> CrossSection {
    /// Half the side of the square over the radius: makes cells at its sides and corners about equal.
    const SQUARE: f64 = 0.45;
    let n = around / 4;
    let half = SQUARE * radius;
    let inside = |i: usize| half * (2.0 * (i as f64 / n as f64) - 1.0);
    let mut points: Vec<Point> = (0..=n).flat_map(|j| (0..=n).map(move |i| [inside(i), inside(j), 0.0])).collect();
    // Nodes around the square from its lower right corner, anticlockwise.
    let on_square = |p: usize| {
        let i = p % n;
        let (x, y) = [(n, i), (n - i, n), (0, n - i), (i, 0)][p / n];
        y * (n + 1) + x
    };
    let at = |l: usize, p: usize| {
        (if l == 0 { on_square(p % around) } else { (n + 1) * (n + 1) + (l - 1) * around + p % around }) as u32
    };
    for l in 1..=radial {
        for p in 0..around {
            let [c, s] = unit(FRAC_PI_2 * (p as f64 / n as f64) - FRAC_PI_4);
            let (share, from) = (l as f64 / radial as f64, points[on_square(p)]);
            points.push([
                from[0] * (1.0 - share) + radius * c * share,
                from[1] * (1.0 - share) + radius * s * share,
                0.0,
            ]);
        }
    }
    let cell = |i: usize, j: usize| {
        [j * (n + 1) + i, j * (n + 1) + i + 1, (j + 1) * (n + 1) + i + 1, (j + 1) * (n + 1) + i].map(|n| n as u32)
    };
    let mut cells: Vec<u32> = (0..n).flat_map(|j| (0..n).flat_map(move |i| cell(i, j))).collect();
    cells.extend(
        (0..radial)
            .flat_map(|l| (0..around).flat_map(move |p| [at(l, p), at(l + 1, p), at(l + 1, p + 1), at(l, p + 1)])),
    );
    let outer = FacetSet::of(&P1_SEGMENT, (0..around).flat_map(|p| [at(radial, p), at(radial, p + 1)]).collect());
    let curved = points.len() - around;
    CrossSection { mesh: body(&Q1_QUADRILATERAL, points, cells, BTreeMap::from([("outer".to_owned(), outer)])), curved }
}

impl CrossSection {
    /// The section, or the body swept from it in layers, with the requested elements.
    fn into_mesh(self, elements: Elements, sweep: Option<(f64, usize)>) -> Result<Mesh, MeshError> {
        let (size, curved) = (self.mesh.points.len(), self.curved);
        let mut mesh = if elements.are_simplices() { self.mesh.simplices()? } else { self.mesh };
        if let Some((height, layers)) = sweep {
            mesh = mesh.extruded(height, layers, ["bottom", "top"])?;
            if elements.are_simplices() {
                mesh = mesh.simplices()?;
            }
        }
        if elements.degree() == 1 {
            return Ok(mesh);
        }
        mesh.quadratic_by(|nodes, points| {
            let round = nodes.iter().all(|&n| n as usize % size >= curved);
            if round {
                polar_mean(points)
            } else {
                std::array::from_fn(|d| points.iter().map(|p| p[d]).sum::<f64>() / points.len() as f64)
            }
        })
    }
}

/// Checks the number of cells around a disc or a ring.
fn check_around(around: usize, solid: bool) -> Result<(), MeshError> {
    if solid && !around.is_multiple_of(4) {
        return Err(MeshError::Around { found: around, expected: "a multiple of 4, for the square in the middle" });
    }
    if around < 3 { Err(MeshError::Around { found: around, expected: "at least 3" }) } else { Ok(()) }
}

/// Checks the angle of a sector, or the number of cells around.
fn check_sector(sector: Option<f64>, around: usize, solid: bool) -> Result<(), MeshError> {
    match sector {
        Some(angle) if !(angle > 0.0 && angle < TAU) => Err(MeshError::Angle { found: angle }),
        Some(_) => Ok(()),
        None => check_around(around, solid),
    }
}

impl Mesh {
    /// The disc of a radius around the origin with `[radial, around]` cells: a square of (around/4)² cells in the
    /// middle and `radial` layers of `around` cells; facet set `outer`.
    ///
    /// # Errors
    /// Fails if the radius is not positive and finite, a number of cells is zero, `around` is not a multiple of 4, or
    /// the mesh is too large.
    pub fn disc(radius: f64, cells: [usize; 2], elements: Elements) -> Result<Mesh, MeshError> {
        check(&[radius, radius], &cells, plane_nodes(cells, true, elements))?;
        check_around(cells[1], true)?;
        disc(radius, cells).into_mesh(elements, None)
    }

    /// The ring between two radii `[inner, outer]` around the origin with `[radial, around]` cells, or a sector of it
    /// from the x-axis over an angle in rad; facet sets `inner`, `outer`, and `start`, `end` for a sector.
    ///
    /// # Errors
    /// Fails if 0 < inner < outer does not hold, the angle is not in (0, 2π), a number of cells is zero, or the mesh
    /// too large.
    pub fn ring(
        radii: [f64; 2],
        sector: Option<f64>,
        cells: [usize; 2],
        elements: Elements,
    ) -> Result<Mesh, MeshError> {
        check_radii(radii[0], radii[1])?;
        check(&radii, &cells, plane_nodes(cells, false, elements))?;
        check_sector(sector, cells[1], false)?;
        ring(radii, sector, cells).into_mesh(elements, None)
    }

    /// The cylinder between the radii `[inner, outer]` around the z-axis, 0 < z < height, with
    /// `[radial, around, axial]` cells, or a sector of it from the x-axis over an angle in rad; solid if the inner
    /// radius is 0, with cells as in [`Mesh::disc`]; facet sets `outer`, `inner` if it is hollow, `bottom`, `top`, and
    /// `start`, `end` for a sector.
    ///
    /// # Errors
    /// Fails like [`Mesh::disc`] and [`Mesh::ring`], and if the height is not positive and finite.
    pub fn cylinder(
        radii: [f64; 2],
        sector: Option<f64>,
        height: f64,
        cells: [usize; 3],
        elements: Elements,
    ) -> Result<Mesh, MeshError> {
        let [inner, outer] = radii;
        let solid = inner == 0.0 && sector.is_none();
        check_radii(inner, outer)?;
        if sector.is_some() {
            check(&radii, &[cells[0], cells[1]], 0.0)?;
        }
        let across = [cells[0], cells[1]];
        check(
            &[outer, outer, height],
            &cells,
            plane_nodes(across, solid, elements) * (cells[2] as f64 * elements.degree() as f64 + 1.0),
        )?;
        check_sector(sector, cells[1], solid)?;
        let section = if solid { disc(outer, across) } else { ring(radii, sector, across) };
        section.into_mesh(elements, Some((height, cells[2])))
    }
}

/// An upper bound of the number of nodes of a disc or ring.
fn plane_nodes([radial, around]: [usize; 2], solid: bool, elements: Elements) -> f64 {
    let degree = elements.degree() as f64;
    let (radial, around) = (degree * radial as f64 + 1.0, degree * around as f64 + 1.0);
    radial * around + if solid { (0.25 * around + 1.0).powi(2) } else { 0.0 }
}
