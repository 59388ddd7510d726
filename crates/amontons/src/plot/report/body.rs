//! The body over the snapshots: surface, fields, foundation.

use std::collections::HashMap;

use serde_json::{Value, json};

use super::field::{PageField, reading};
use super::pack::Pack;
use super::thin::ReducedMesh;
use crate::plot::body::{PlaneMesh, window};
use crate::plot::field::{DrawnQuantity, shown};
use crate::plot::folder::Results;
use crate::plot::run::DrawnRun;
use crate::plot::surface::norm;
use crate::plot::{Options, PictureKind, PlotError, axes, ground, plane, sheet};
use crate::problem::Problem;
use crate::units::{Extent, Measure, Units};

/// Largest number of vertices of the body.
pub(super) const VERTICES: usize = 20_000;
/// Largest number of points of a foundation in space.
const FOUNDATION: usize = 4_000;

/// The surface of a body, or a plane body, with the origin of its vertices.
struct PageSurface {
    shape: ReducedMesh,
    /// The node of each vertex, and one of its triangle corners in the body: three times the triangle plus 0 to 2.
    nodes: Vec<u32>,
    corners: Vec<usize>,
    /// Triangles of the body.
    triangles: usize,
    /// Number of vertices before coarsening.
    before: usize,
}

impl PageSurface {
    /// The surface of a run, with one vertex per node and region, because stresses jump between regions.
    fn of(run: &DrawnRun) -> Option<PageSurface> {
        let (points, triangles, owners, regions): (Vec<[f64; 3]>, &[[u32; 3]], &[u32], &[f64]) =
            match (&run.snapshot, &run.solid) {
                (Some(s), _) => {
                    let points = s.body.points.iter().map(|p| [p[0], p[1], 0.0]).collect();
                    (points, &s.body.triangles, &s.body.owners, &s.regions)
                }
                (_, Some(s)) => (s.surface.points.clone(), &s.surface.triangles, &s.surface.owners, &s.regions),
                _ => return None,
            };
        let (mut shape, mut nodes, mut corners) = (ReducedMesh::default(), Vec::new(), Vec::new());
        let mut known: HashMap<(u32, u64), u32> = HashMap::new();
        let mut of_node: HashMap<u32, u32> = HashMap::new();
        for (t, triangle) in triangles.iter().enumerate() {
            let region = owners.get(t).and_then(|&cell| regions.get(cell as usize)).map_or(0, |r| r.to_bits());
            let mut corner = 0;
            let own = triangle.map(|node| {
                let next = shape.vertices.len() as u32;
                let vertex = *known.entry((node, region)).or_insert(next);
                if vertex == next {
                    shape.vertices.push((points[node as usize], region));
                    nodes.push(node);
                    corners.push(3 * t + corner);
                }
                of_node.entry(node).or_insert(vertex);
                corner += 1;
                vertex
            });
            shape.triangles.push(own);
        }
        let between = |pairs: &mut dyn Iterator<Item = [u32; 2]>| -> Vec<[u32; 2]> {
            pairs.filter_map(|[a, b]| Some([*of_node.get(&a)?, *of_node.get(&b)?])).collect()
        };
        if let Some(s) = &run.snapshot {
            shape.outline = between(&mut s.body.boundary.iter().copied());
            shape.mesh = between(&mut s.body.lines().iter().flat_map(|line| line.windows(2).map(|p| [p[0], p[1]])));
        } else if let Some(s) = &run.solid {
            shape.outline = between(&mut s.surface.outline(&s.regions).into_iter());
            shape.mesh = between(&mut s.surface.edges.iter().map(|edge| edge.nodes));
        }
        let (before, triangles) = (shape.vertices.len(), shape.triangles.len());
        let (shape, kept) = shape.thinned(VERTICES);
        let (nodes, corners) = (kept.iter().map(|&i| nodes[i]).collect(), kept.iter().map(|&i| corners[i]).collect());
        Some(PageSurface { shape, nodes, corners, triangles, before })
    }

    /// Values of a field of a run at the vertices.
    fn values(&self, kind: PictureKind, run: &DrawnRun) -> (Vec<f64>, [f64; 2]) {
        let (all, areas) = match (&run.snapshot, &run.solid) {
            (Some(s), _) => (s.corners(kind), s.body.areas()),
            (_, Some(s)) => (s.corners(kind), s.surface.areas()),
            _ => return (Vec::new(), [0.0; 2]),
        };
        let extent = axes::range(all.iter().flatten().copied()).unwrap_or([0.0, 0.0]);
        let range = if kind == PictureKind::VonMises { shown(&all, &areas, extent) } else { extent };
        (self.corners.iter().map(|&c| all[c / 3][c % 3]).collect(), range)
    }
}

/// The displacements of all nodes.
fn displacement(run: &DrawnRun) -> Vec<[f64; 3]> {
    let plane = run.snapshot.iter().flat_map(|s| s.displacement.iter().map(|u| [u[0], u[1], 0.0]));
    plane.chain(run.solid.iter().flat_map(|s| s.displacement.iter().copied())).collect()
}

/// Data collected while the snapshots are read.
struct KeptSnapshots {
    surface: PageSurface,
    /// The body, if it is plane.
    body: Option<PlaneMesh>,
    problem: Option<std::sync::Arc<Problem>>,
    factor: f64,
    times: Vec<f64>,
    displacements: Vec<Vec<[f64; 3]>>,
    fields: Vec<PageField>,
    has_moved: bool,
}

/// The size of a body along its longest axis.
fn size(points: &mut dyn Iterator<Item = [f64; 3]>) -> f64 {
    let all: Vec<[f64; 3]> = points.collect();
    (0..3).filter_map(|d| axes::range(all.iter().map(|p| p[d]))).map(|[lo, hi]| hi - lo).fold(0.0, f64::max)
}

fn empty(kind: PictureKind) -> PageField {
    let quantity = DrawnQuantity::of(kind);
    PageField {
        name: quantity.name.to_owned(),
        symbol: quantity.symbol,
        measure: quantity.measure,
        map: quantity.map,
        components: vec![Vec::new()],
        shown: None,
    }
}

impl KeptSnapshots {
    /// An empty collection for the body of a run, or `None` for a body on a line.
    fn new(run: &DrawnRun) -> Option<KeptSnapshots> {
        Some(KeptSnapshots {
            surface: PageSurface::of(run)?,
            body: run.snapshot.as_ref().map(|s| s.body.clone()),
            problem: run.problem.clone(),
            factor: f64::INFINITY,
            times: Vec::new(),
            displacements: Vec::new(),
            fields: vec![empty(PictureKind::VonMises), empty(PictureKind::Temperature)],
            has_moved: false,
        })
    }

    fn add(&mut self, run: &DrawnRun) -> Result<(), PlotError> {
        let u = displacement(run);
        let triangles = run.snapshot.iter().map(|s| s.body.triangles.len());
        let triangles: usize = triangles.chain(run.solid.iter().map(|s| s.surface.triangles.len())).sum();
        if triangles != self.surface.triangles || self.surface.nodes.iter().any(|&node| node as usize >= u.len()) {
            let t = run.t;
            return Err(PlotError::Data(format!("the snapshot at t = {t} is of another mesh than the first")));
        }
        let largest = u.iter().map(|u| norm(*u)).fold(0.0, f64::max);
        let sizes = [(largest, size(&mut self.surface.shape.vertices.iter().map(|v| v.0)))];
        self.factor =
            self.factor.min(plane::factor(PictureKind::Deformed, &[run], sizes.into_iter(), &Options::default()));
        self.has_moved |= largest > 0.0;
        self.times.push(run.t);
        self.displacements.push(u);
        for (field, kind) in self.fields.iter_mut().zip([PictureKind::VonMises, PictureKind::Temperature]) {
            if kind.is_in(run) {
                let (values, range) = self.surface.values(kind, run);
                field.components[0].push(values);
                field.shown = axes::range(field.shown.into_iter().flatten().chain(range));
            }
        }
        Ok(())
    }

    fn displacement(&self) -> PageField {
        let of = |d: usize| {
            self.displacements.iter().map(|u| self.surface.nodes.iter().map(|&n| u[n as usize][d]).collect()).collect()
        };
        let dim = if self.body.is_some() { 2 } else { 3 };
        PageField { components: (0..dim).map(of).collect(), ..empty(PictureKind::Deformed) }
    }

    /// The window that holds the body at all times and the foundation near to it.
    fn window(&self, body: &PlaneMesh) -> [[f64; 2]; 2] {
        let mut points = body.points.clone();
        for (t, u) in self.times.iter().zip(&self.displacements) {
            let moved: Vec<[f64; 2]> =
                body.points.iter().zip(u).map(|(p, u)| [0, 1].map(|d| p[d] + self.factor * u[d])).collect();
            if let Some(problem) = &self.problem {
                points.extend(ground::feet(problem, body, &moved, *t, self.factor));
            }
            points.extend(moved);
        }
        sheet::widened(window(&points), 0.06)
    }

    /// The foundation at each time: lines in the plane, triangles in space.
    fn foundation(&self, pack: &mut Pack) -> (Option<[[f64; 2]; 2]>, Vec<Value>) {
        let window = self.body.as_ref().map(|body| self.window(body));
        let Some(problem) = &self.problem else { return (window, Vec::new()) };
        let at = self.times.iter().zip(&self.displacements);
        let frames = at.map(|(&t, u)| {
            if let (Some(body), Some(window)) = (&self.body, window) {
                let all = ground::grounds(problem, body, t, self.factor, window);
                let lines = all.iter().flat_map(|ground| &ground.lines);
                return lines.map(|line| json!(pack.reals(line.as_flattened().iter().copied()))).collect();
            }
            let patches = ground::patches(problem, u, t, self.factor);
            let few = patches.iter().map(|patch| patch.points.len()).sum::<usize>() <= FOUNDATION;
            let written = patches.iter().filter(|_| few).map(|patch| {
                json!({
                    "points": pack.reals(patch.points.as_flattened().iter().copied()),
                    "triangles": pack.counts(patch.triangles.as_flattened()),
                    "rim": pack.counts(ground::rim(&patch.triangles).as_flattened()),
                    "normal": patch.normal,
                })
            });
            written.collect()
        });
        (window, frames.collect())
    }

    fn write(self, units: Units, pack: &mut Pack) -> Value {
        let (window, foundation) = self.foundation(pack);
        let vertices = &self.surface.shape.vertices;
        let mut fields = Vec::new();
        if self.has_moved {
            fields.push(self.displacement().write(units, pack));
        }
        let has_displacement = !fields.is_empty();
        fields.extend(self.fields.iter().filter(|field| field.is_told()).map(|field| field.write(units, pack)));
        let (unit, factor) = reading(units, size(&mut vertices.iter().map(|v| v.0)), Measure::Length);
        let shape = &self.surface.shape;
        let points: Vec<[f64; 3]> = vertices.iter().map(|(p, _)| *p).collect();
        json!({
            "dimension": if self.body.is_some() { 2 } else { 3 },
            "axes": match units.extent { Extent::Revolution => ["r", "z", ""], _ => ["x", "y", "z"] },
            "isTurned": units.extent == Extent::Revolution,
            "points": pack.reals(points.as_flattened().iter().copied()),
            "triangles": pack.counts(shape.triangles.as_flattened()),
            "outline": pack.counts(shape.outline.as_flattened()),
            "mesh": pack.counts(shape.mesh.as_flattened()),
            "length": { "unit": unit, "factor": factor },
            "window": window,
            "moves": has_displacement,
            "factor": self.factor,
            "scale": plane::times(self.factor),
            "foundation": foundation,
            "fields": fields,
            "vertices": [vertices.len(), self.surface.before],
        })
    }
}

/// The body at some snapshots, for the page; null for a body on a line.
pub(super) fn write(results: &Results, chosen: &[usize], units: Units, pack: &mut Pack) -> Result<Value, PlotError> {
    let mut gathered: Option<KeptSnapshots> = None;
    for &i in chosen {
        let run = results.run(i)?;
        if gathered.is_none() {
            gathered = KeptSnapshots::new(&run);
        }
        let Some(all) = &mut gathered else { return Ok(Value::Null) };
        all.add(&run)?;
    }
    Ok(gathered.map_or(Value::Null, |all| all.write(units, pack)))
}

/// The fields of a body on a line at some snapshots, for the page; null for others.
pub(super) fn rod(results: &Results, chosen: &[usize], units: Units, pack: &mut Pack) -> Result<Value, PlotError> {
    let mut fields = [empty(PictureKind::Deformed), empty(PictureKind::Temperature)];
    fields[0].symbol = "u";
    let mut x = Vec::new();
    for &i in chosen {
        let Some(rod) = results.run(i)?.rod else { return Ok(Value::Null) };
        fields[0].components[0].push(rod.displacement);
        fields[1].components[0].push(rod.temperature);
        x = rod.x;
    }
    let (unit, factor) = reading(units, x.iter().fold(0.0, |m, v| v.abs().max(m)), Measure::Length);
    let told = fields.iter().filter(|field| field.is_told());
    Ok(json!({
        "s": pack.reals(x.iter().map(|v| v * factor)),
        "unit": unit,
        "fields": told.map(|field| field.write(units, pack)).collect::<Vec<_>>(),
    }))
}
