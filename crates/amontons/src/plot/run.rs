//! The data of the pictures of a run.

use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;

use super::body::PlaneMesh;
use super::surface::{Skin, norm};
use super::{PictureKind, PlotError};
use crate::contact::Status;
use crate::output::columns;
use crate::problem::Problem;
use crate::units::Units;

/// A run at one time, with everything that can be drawn.
#[derive(Clone, Debug, Default)]
pub struct DrawnRun {
    /// Name of the case.
    pub name: String,
    /// Dimension of the body.
    pub dimension: usize,
    /// Time of the fields and of the contact points, s.
    pub t: f64,
    /// The fields, of a plane body.
    pub snapshot: Option<PlaneSnapshot>,
    /// The contact points of a plane body, in any order; empty without contact.
    pub contact: Vec<ContactRow>,
    /// The fields and contact points of a body in space.
    pub solid: Option<SpaceSnapshot>,
    /// The fields of a body on a line.
    pub rod: Option<Rod>,
    /// History with one row per step.
    pub history: HistoryColumns,
    /// Names of the contact sides.
    pub sides: Vec<String>,
    /// The solved problem; without it the foundation is not drawn.
    pub problem: Option<Arc<Problem>>,
    /// The units of all numbers.
    pub units: Units,
}

/// Fields of a plane body at a time.
#[derive(Clone, Debug)]
pub struct PlaneSnapshot {
    /// The mesh.
    pub body: PlaneMesh,
    /// Displacement of each node, m.
    pub displacement: Vec<[f64; 2]>,
    /// Temperature of each node, K; empty in a run without heat.
    pub temperature: Vec<f64>,
    /// Von Mises stress in each cell, Pa; empty in a run without mechanics.
    pub von_mises: Vec<f64>,
    /// Recovered von Mises stress at each node, Pa; empty if unknown.
    pub nodal_von_mises: Vec<f64>,
    /// Region of each cell; empty if unknown.
    pub regions: Vec<f64>,
}

/// Fields of a body on a line at a time, its nodes in the order of x.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rod {
    /// Coordinate of each node, m.
    pub x: Vec<f64>,
    /// Displacement of each node, m.
    pub displacement: Vec<f64>,
    /// Temperature of each node, K; empty in a run without heat.
    pub temperature: Vec<f64>,
}

impl DrawnRun {
    /// Returns `[temperature, stress]`: true if the fields include it.
    pub(super) fn fields(&self) -> [bool; 2] {
        let plane = self.snapshot.iter().map(|fields| [&fields.temperature, &fields.von_mises]);
        let solid = self.solid.iter().map(|fields| [&fields.temperature, &fields.von_mises]);
        plane.chain(solid).next().map_or([false; 2], |fields| fields.map(|values| !values.is_empty()))
    }

    /// Returns `[wear, friction work]`: true if a contact point has some.
    pub(super) fn worn(&self) -> [bool; 2] {
        let solid = self.solid.iter().flat_map(|solid| &solid.contact).map(|row| [row.wear, row.friction_work]);
        let all: Vec<[f64; 2]> = self.contact.iter().map(|row| [row.wear, row.friction_work]).chain(solid).collect();
        [0, 1].map(|i| all.iter().any(|values| values[i] != 0.0))
    }

    fn temperatures(&self) -> &[f64] {
        let solid = self.solid.as_ref().map(|s| &s.temperature).or(self.rod.as_ref().map(|rod| &rod.temperature));
        self.snapshot.as_ref().map(|s| &s.temperature).or(solid).map_or(&[], Vec::as_slice)
    }

    /// True if there is heat: different temperatures, or a heat flow since the start.
    pub(super) fn has_heat(&self) -> bool {
        let theta = self.temperatures();
        let first = theta.first().copied().unwrap_or_default();
        let flows = [columns::HEAT_CONTACT, columns::HEAT_PRESCRIBED, columns::HEAT_SUPPLIED, columns::HEAT_COUPLING];
        theta.iter().any(|v| (v - first).abs() > 1e-9 * first.abs()) || flows.iter().any(|column| self.has(column.name))
    }

    /// True if the case solves for displacements, or is unknown.
    pub(super) fn has_mechanics(&self) -> bool {
        self.problem.as_ref().is_none_or(|problem| problem.physics.has_mechanics())
    }

    /// True if a node has moved.
    pub(super) fn has_moved(&self) -> bool {
        let plane = self.snapshot.iter().flat_map(|s| s.displacement.iter().flatten());
        let space = self.solid.iter().flat_map(|s| s.displacement.iter().flatten());
        plane.chain(space).any(|u| *u != 0.0)
    }

    /// True if a cell has a stress.
    pub(super) fn has_stress(&self) -> bool {
        let cells = self.snapshot.iter().flat_map(|s| &s.von_mises).chain(self.solid.iter().flat_map(|s| &s.von_mises));
        cells.into_iter().any(|v| *v != 0.0)
    }

    /// True if a column of the history has values other than zero.
    pub(super) fn has(&self, column: &str) -> bool {
        self.history.get(column).is_some_and(|values| values.iter().any(|v| *v != 0.0))
    }

    /// The body reduced to the boundary edges that bear the points of a pair, whose two sides may coincide; for a
    /// foundation with all boundary edges.
    pub(super) fn bearing<'a>(&self, body: &'a PlaneMesh, side: usize) -> Cow<'a, PlaneMesh> {
        let of_pair = || {
            let problem = self.problem.as_ref()?;
            let contact = problem.contacts.get(side).filter(|contact| contact.pair.is_some())?;
            Some(problem.mesh.facets.get(contact.bearing())?.node_list())
        };
        let Some(nodes) = of_pair() else { return Cow::Borrowed(body) };
        let mut of_side = body.clone();
        of_side.boundary.retain(|edge| edge.iter().all(|node| nodes.binary_search(node).is_ok()));
        Cow::Owned(of_side)
    }

    /// Name of a side in quotes; empty if it has none.
    pub(super) fn side(&self, side: usize) -> String {
        self.sides.get(side).filter(|name| !name.is_empty()).map_or_else(String::new, |name| format!(" on \"{name}\""))
    }
}

/// Values at the corners of triangles: the nodal values, except at nodes between regions. There stresses jump, and a
/// corner takes the mean of the cells of its own region.
pub(super) fn at_corners(
    triangles: &[[u32; 3]],
    owners: &[u32],
    nodal: &[f64],
    cells: &[f64],
    regions: &[f64],
) -> Vec<[f64; 3]> {
    let cell = |t: usize| owners.get(t).and_then(|&c| cells.get(c as usize)).copied().unwrap_or(f64::NAN);
    if nodal.is_empty() {
        return (0..triangles.len()).map(|t| [cell(t); 3]).collect();
    }
    let region = |t: usize| owners.get(t).and_then(|&c| regions.get(c as usize)).map_or(0, |r| r.to_bits());
    let mut sums: HashMap<(u32, u64), (f64, f64)> = HashMap::new();
    let mut count: HashMap<u32, HashSet<u64>> = HashMap::new();
    if regions.windows(2).any(|pair| pair[0].to_bits() != pair[1].to_bits()) {
        for (t, nodes) in triangles.iter().enumerate() {
            for &n in nodes {
                count.entry(n).or_default().insert(region(t));
                let sum = sums.entry((n, region(t))).or_default();
                *sum = (sum.0 + cell(t), sum.1 + 1.0);
            }
        }
    }
    let value = |t: usize, n: u32| match sums.get(&(n, region(t))) {
        Some((sum, number)) if count.get(&n).is_some_and(|all| all.len() > 1) => sum / number,
        _ => nodal.get(n as usize).copied().unwrap_or(f64::NAN),
    };
    triangles.iter().enumerate().map(|(t, nodes)| nodes.map(|n| value(t, n))).collect()
}

impl PlaneSnapshot {
    /// The field of a picture at the corners of the triangles.
    pub(super) fn corners(&self, kind: PictureKind) -> Vec<[f64; 3]> {
        let at = |nodal: &[f64], cells: &[f64], regions: &[f64]| {
            at_corners(&self.body.triangles, &self.body.owners, nodal, cells, regions)
        };
        match kind {
            PictureKind::VonMises => at(&self.nodal_von_mises, &self.von_mises, &self.regions),
            PictureKind::Deformed => {
                at(&self.displacement.iter().map(|u| u[0].hypot(u[1])).collect::<Vec<_>>(), &[], &[])
            }
            _ => at(&self.temperature, &[], &[]),
        }
    }

    /// Checks that there is a finite value per node and per cell.
    ///
    /// # Errors
    /// [`PlotError::Data`] names the field with the fault.
    pub fn check(&self) -> Result<(), PlotError> {
        let nodes = self.body.nodes();
        counted("displacement", self.displacement.len(), nodes)?;
        finite("displacement", self.displacement.as_flattened())?;
        fits_if_any("temperature", &self.temperature, nodes)?;
        fits_if_any("von Mises stress", &self.von_mises, self.body.cells())?;
        fits_if_any("von Mises stress at the nodes", &self.nodal_von_mises, nodes)
    }
}

/// Fields and contact points of a body in space at a time.
#[derive(Clone, Debug)]
pub struct SpaceSnapshot {
    /// The surface of the body.
    pub surface: Skin,
    /// Displacement of each node, m.
    pub displacement: Vec<[f64; 3]>,
    /// Temperature of each node, K; empty in a run without heat.
    pub temperature: Vec<f64>,
    /// Von Mises stress in each cell, Pa; empty in a run without mechanics.
    pub von_mises: Vec<f64>,
    /// Recovered von Mises stress at each node, Pa; empty if unknown.
    pub nodal_von_mises: Vec<f64>,
    /// Region of each cell; empty if unknown.
    pub regions: Vec<f64>,
    /// The contact points, in any order; empty without contact.
    pub contact: Vec<SolidContact>,
}

/// A point of Γ_C of a body in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidContact {
    /// Position on the undeformed boundary, m.
    pub x: [f64; 3],
    /// p_ν in Pa; on quadratic facets the mean of neighbouring points.
    pub pressure: f64,
    /// p_ν at the point itself, Pa.
    pub point_pressure: f64,
    /// Open, stick or slip.
    pub status: Status,
    /// Slip velocity of the body against the foundation, m/s.
    pub slip_velocity: [f64; 3],
    /// Depth of wear, m.
    pub wear: f64,
    /// Work of friction since the start, J/m².
    pub friction_work: f64,
    /// Index of its side in the run.
    pub side: usize,
}

impl SpaceSnapshot {
    /// The field of a picture at the corners of the surface triangles.
    pub(super) fn corners(&self, kind: PictureKind) -> Vec<[f64; 3]> {
        let at = |nodal: &[f64], cells: &[f64], regions: &[f64]| {
            at_corners(&self.surface.triangles, &self.surface.owners, nodal, cells, regions)
        };
        match kind {
            PictureKind::VonMises => at(&self.nodal_von_mises, &self.von_mises, &self.regions),
            PictureKind::Deformed => at(&self.displacement.iter().map(|u| norm(*u)).collect::<Vec<_>>(), &[], &[]),
            _ => at(&self.temperature, &[], &[]),
        }
    }

    /// Checks that there is a finite value per node and per cell.
    ///
    /// # Errors
    /// [`PlotError::Data`] names the field with the fault.
    pub fn check(&self) -> Result<(), PlotError> {
        let nodes = self.surface.nodes();
        fits("displacement", self.displacement.as_flattened(), 3 * nodes)?;
        fits_if_any("temperature", &self.temperature, nodes)?;
        fits_if_any("von Mises stress", &self.von_mises, self.surface.cells())?;
        fits_if_any("von Mises stress at the nodes", &self.nodal_von_mises, nodes)?;
        let of = |value: fn(&SolidContact) -> f64| self.contact.iter().map(value).collect::<Vec<f64>>();
        let places: Vec<f64> = self.contact.iter().flat_map(|row| row.x).collect();
        fits("place of the contact points", &places, 3 * self.contact.len())?;
        fits("contact pressure", &of(|row| row.pressure), self.contact.len())?;
        fits("contact pressure at a point", &of(|row| row.point_pressure), self.contact.len())?;
        fits("wear", &of(|row| row.wear), self.contact.len())?;
        fits("friction work", &of(|row| row.friction_work), self.contact.len())
    }
}

/// Checks that there are `expected` values.
fn counted(name: &str, found: usize, expected: usize) -> Result<(), PlotError> {
    let message = || format!("the {name} has {found} values, expected {expected}");
    if found == expected { Ok(()) } else { Err(PlotError::Data(message())) }
}

/// Checks that values are finite.
fn finite(name: &str, values: &[f64]) -> Result<(), PlotError> {
    let message = || format!("the {name} has values that are not finite");
    if values.iter().all(|v| v.is_finite()) { Ok(()) } else { Err(PlotError::Data(message())) }
}

/// Checks that there are `expected` finite values.
fn fits(name: &str, values: &[f64], expected: usize) -> Result<(), PlotError> {
    counted(name, values.len(), expected)?;
    finite(name, values)
}

/// Checks that there are `expected` finite values, or none.
fn fits_if_any(name: &str, values: &[f64], expected: usize) -> Result<(), PlotError> {
    if values.is_empty() { Ok(()) } else { fits(name, values, expected) }
}

/// A point of Γ_C at a time: a row of `contact.csv`.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactRow {
    /// Position on the undeformed boundary, m.
    pub x: [f64; 2],
    /// u_ν − g in m.
    pub penetration: f64,
    /// p_ν in Pa; on quadratic facets the mean of neighbouring points.
    pub pressure: f64,
    /// p_ν at the point itself, Pa.
    pub point_pressure: f64,
    /// Friction bound p_τ in Pa, if known.
    pub bound: Option<f64>,
    /// Friction traction σ_τ in Pa: two components in the plane, and one out of it or about the axis of revolution.
    pub traction: [f64; 3],
    /// Slip velocity in m/s, by the same components.
    pub slip_velocity: [f64; 3],
    /// Open, stick or slip.
    pub status: Status,
    /// Temperature of the body, K; NaN in a run without heat.
    pub temperature: f64,
    /// Temperature of the opposite surface, K; NaN if the point faces nothing or it is unknown.
    pub opposite_temperature: f64,
    /// q·ν in W/m²; NaN in a run without heat.
    pub heat_flux: f64,
    /// Depth of wear, m.
    pub wear: f64,
    /// Work of friction since the start, J/m².
    pub friction_work: f64,
    /// Index of its side in the run.
    pub side: usize,
}

/// Columns of numbers by the names of `history.csv`, one row per step.
pub type HistoryColumns = BTreeMap<String, Vec<f64>>;

/// A contact point with its arc length along Γ_C.
#[derive(Clone, Debug)]
pub(super) struct PathPoint<'a> {
    /// Arc length.
    pub s: f64,
    /// Unit tangent in the direction of growing arc length.
    pub tangent: [f64; 2],
    pub row: &'a ContactRow,
}

/// A connected part of Γ_C.
#[derive(Clone, Debug)]
pub(super) struct ContactPart<'a> {
    /// Arc length at both ends; it continues from part to part.
    pub s: [f64; 2],
    /// The contact points in order.
    pub stops: Vec<PathPoint<'a>>,
}

/// A contact point on an edge of the boundary: position from 0 to 1, and row.
type OnEdge = (f64, usize);

/// Orders the contact points along Γ_C; they may come in any order.
///
/// A part that is not closed runs to the right, or upwards if it is steeper than 45°.
pub(super) fn along<'a>(body: &PlaneMesh, rows: &[&'a ContactRow]) -> Result<Vec<ContactPart<'a>>, PlotError> {
    const NEAR: f64 = 1e-6;
    let p = |n: u32| body.points[n as usize];
    // The body is on the left of its boundary edges: they run around it, and one leaves each node.
    let mut inside: HashMap<u32, Vec<OnEdge>> = HashMap::new();
    let mut at_node: HashMap<u32, usize> = HashMap::new();
    for (r, row) in rows.iter().enumerate() {
        let mut found = false;
        for &[a, b] in &body.boundary {
            let (d, e) = ([p(b)[0] - p(a)[0], p(b)[1] - p(a)[1]], [row.x[0] - p(a)[0], row.x[1] - p(a)[1]]);
            let square = d[0] * d[0] + d[1] * d[1];
            let (place, off) = ((d[0] * e[0] + d[1] * e[1]) / square, (d[0] * e[1] - d[1] * e[0]) / square);
            if off.abs() > NEAR || !(-NEAR..=1.0 + NEAR).contains(&place) {
                continue;
            }
            found = true;
            if place < NEAR {
                at_node.insert(a, r);
            } else if place > 1.0 - NEAR {
                at_node.insert(b, r);
            } else {
                inside.entry(a).or_default().push((place, r));
            }
        }
        if !found {
            return Err(PlotError::Data(format!(
                "the contact point ({}, {}) is not on the boundary of the body",
                row.x[0], row.x[1]
            )));
        }
    }
    let is_contact = |[a, b]: &[u32; 2]| inside.contains_key(a) || (at_node.contains_key(a) && at_node.contains_key(b));
    let mut next: HashMap<u32, u32> =
        body.boundary.iter().filter(|edge| is_contact(edge)).map(|&[a, b]| (a, b)).collect();
    let entered: HashSet<u32> = next.values().copied().collect();
    let mut starts: Vec<u32> = next.keys().copied().collect();
    // Ends first, so that only closed parts remain.
    starts.sort_unstable_by_key(|n| (entered.contains(n), *n));
    let mut parts = Vec::new();
    let mut s = 0.0;
    for start in starts {
        let mut chain = vec![start];
        let mut at = start;
        while let Some(b) = next.remove(&at) {
            chain.push(b);
            at = b;
        }
        if chain.len() < 2 {
            continue;
        }
        let edges: Vec<[u32; 2]> = chain.windows(2).map(|e| [e[0], e[1]]).collect();
        let part = follow(body, rows, &edges, &inside, &at_node, s);
        s = part.s[1];
        parts.push(part);
    }
    Ok(parts)
}

/// The part of Γ_C that consists of these edges, with arc length starting at `begin`.
fn follow<'a>(
    body: &PlaneMesh,
    rows: &[&'a ContactRow],
    edges: &[[u32; 2]],
    inside: &HashMap<u32, Vec<OnEdge>>,
    at_node: &HashMap<u32, usize>,
    begin: f64,
) -> ContactPart<'a> {
    let p = |n: u32| body.points[n as usize];
    let along = |[a, b]: [u32; 2]| [p(b)[0] - p(a)[0], p(b)[1] - p(a)[1]];
    let across = edges.iter().fold([0.0; 2], |sum, &e| [sum[0] + along(e)[0], sum[1] + along(e)[1]]);
    let backwards = if across[0].abs() >= across[1].abs() { across[0] < 0.0 } else { across[1] < 0.0 };
    let total: f64 = edges.iter().map(|&e| length(along(e))).sum();
    let mut stops = Vec::new();
    let mut stop = |s: f64, direction: [f64; 2], r: usize| {
        let t = unit(direction);
        let (s, tangent) = if backwards { (total - s, [-t[0], -t[1]]) } else { (s, t) };
        stops.push(PathPoint { s: begin + s, tangent, row: rows[r] });
    };
    let mut s = 0.0;
    for (i, &edge) in edges.iter().enumerate() {
        let direction = unit(along(edge));
        if let Some(&r) = at_node.get(&edge[0]) {
            let before = i.checked_sub(1).map_or(direction, |i| unit(along(edges[i])));
            stop(s, [before[0] + direction[0], before[1] + direction[1]], r);
        }
        let mut points = inside.get(&edge[0]).cloned().unwrap_or_default();
        points.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        for (place, r) in points {
            stop(s + place * length(along(edge)), direction, r);
        }
        s += length(along(edge));
        if let (true, Some(&r)) = (i + 1 == edges.len(), at_node.get(&edge[1])) {
            stop(s, direction, r);
        }
    }
    if backwards {
        stops.reverse();
    }
    ContactPart { s: [begin, begin + total], stops }
}

fn length(v: [f64; 2]) -> f64 {
    v[0].hypot(v[1])
}

fn unit(v: [f64; 2]) -> [f64; 2] {
    let length = length(v);
    if length > 0.0 { v.map(|c| c / length) } else { v }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp)] // the values are exact

    use super::*;
    use crate::contact::{ContactBoundary, Quadrature};
    use crate::mesh::{Diagonal, Mesh};

    type Outcome = Result<(), Box<dyn std::error::Error>>;

    fn row(x: [f64; 2]) -> ContactRow {
        ContactRow {
            x,
            penetration: 0.0,
            pressure: 0.0,
            point_pressure: 0.0,
            bound: None,
            traction: [0.0; 3],
            slip_velocity: [0.0; 3],
            status: Status::Open,
            temperature: 0.0,
            opposite_temperature: f64::NAN,
            heat_flux: 0.0,
            wear: 0.0,
            friction_work: 0.0,
            side: 0,
        }
    }

    fn side(name: &str, quadrature: Quadrature) -> Result<(PlaneMesh, Vec<ContactRow>), Box<dyn std::error::Error>> {
        let mesh = Mesh::rectangle([2.0, 1.0], [4, 4], Diagonal::Left)?;
        let boundary = ContactBoundary::new(&mesh, &mesh.facets[name], quadrature);
        // Reversed, to test that the order of the side is restored.
        let rows = boundary.points.iter().rev().map(|p| row([p.x[0], p.x[1]])).collect();
        Ok((PlaneMesh::of_mesh(&mesh)?, rows))
    }

    #[test]
    fn sides_run_to_the_right_and_upwards() -> Outcome {
        let sides = [("bottom", [1.0, 0.0]), ("top", [1.0, 0.0]), ("left", [0.0, 1.0]), ("right", [0.0, 1.0])];
        for (quadrature, count) in [(Quadrature::Nodal, 5), (Quadrature::Gauss, 8)] {
            for (name, tangent) in sides {
                let (body, rows) = side(name, quadrature)?;
                let parts = along(&body, &rows.iter().collect::<Vec<_>>())?;
                assert_eq!((parts.len(), parts[0].stops.len()), (1, count), "{name}");
                assert_eq!(parts[0].s, [0.0, if tangent[0] == 1.0 { 2.0 } else { 1.0 }]);
                for stop in &parts[0].stops {
                    assert!(length([stop.tangent[0] - tangent[0], stop.tangent[1] - tangent[1]]) < 1e-12, "{name}");
                    let place = stop.row.x[0] * tangent[0] + stop.row.x[1] * tangent[1];
                    assert!((stop.s - place).abs() < 1e-12, "{name}: {} at {place}", stop.s);
                }
                assert!(parts[0].stops.windows(2).all(|w| w[1].s > w[0].s), "{name}");
            }
        }
        Ok(())
    }

    #[test]
    fn parts_are_told_apart_and_a_closed_one_is_found() -> Outcome {
        let (body, mut rows) = side("bottom", Quadrature::Nodal)?;
        rows.remove(2);
        // The middle node is gone: two parts of one edge each.
        let parts = along(&body, &rows.iter().collect::<Vec<_>>())?;
        assert_eq!(parts.iter().map(|p| p.stops.len()).collect::<Vec<_>>(), [2, 2]);
        let around: Vec<ContactRow> = body.boundary.iter().map(|e| row(body.points[e[0] as usize])).collect();
        let parts = along(&body, &around.iter().collect::<Vec<_>>())?;
        assert_eq!((parts.len(), parts[0].stops.len(), parts[0].s), (1, 17, [0.0, 6.0]));
        Ok(())
    }

    #[test]
    fn a_point_off_the_boundary_is_named() -> Outcome {
        let (body, _) = side("bottom", Quadrature::Nodal)?;
        let message = along(&body, &[&row([0.25, 0.75])]).map(|_| ()).map_err(|e| e.to_string());
        assert!(message.is_err_and(|m| m.contains("(0.25, 0.75)")));
        Ok(())
    }
}
