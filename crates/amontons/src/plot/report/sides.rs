//! The sides of contact over the snapshots: the content of `contact.pvd`, along a line in the plane, on a surface in
//! space.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use serde_json::{Value, json};

use super::field::{PageField, reading};
use super::pack::Pack;
use super::thin::ReducedMesh;
use crate::element::{CellType, Drawing};
use crate::output::names::SIDES;
use crate::output::{surface_measures, surface_sides};
use crate::plot::PlotError;
use crate::plot::color::ColorMap;
use crate::plot::folder::Results;
use crate::plot::surface::norm;
use crate::plot::vtu::{self, Grid};
use crate::units::{Measure, Units};

/// Largest number of vertices of a side.
pub(super) const VERTICES: usize = 4_000;
/// Arrays that the page does not show as fields of a side.
const LEFT_OUT: [&str; 2] = ["displacement", "weight"];

/// A side as drawn.
struct PageSide {
    name: String,
    number: usize,
    /// The node of each vertex in the grid.
    nodes: Vec<usize>,
    /// Arc length of each vertex; the vertices are ordered along the line.
    along: Vec<f64>,
    /// Pieces of the line: the first vertex of each.
    pieces: Vec<usize>,
    /// A surface in space.
    shape: ReducedMesh,
    normal: [f64; 3],
    /// Number of vertices before coarsening.
    before: usize,
    fields: Vec<PageField>,
}

/// The nodes of the cells of a side, cell by cell.
fn cells(grid: &Grid, number: usize) -> Vec<Vec<u32>> {
    let sides = grid.cell_data.get("side").map_or(&[][..], |array| &array.values);
    let of_side = grid.cells().zip(sides).filter(|(_, side)| (**side - number as f64).abs() < 0.5);
    of_side.map(|(cell, _)| cell.to_vec()).collect()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    norm([0, 1, 2].map(|d| b[d] - a[d]))
}

/// The nodes of lines in order, piece by piece, each from its left or lower end.
fn chains(points: &[[f64; 3]], cells: &[Vec<u32>]) -> Vec<Vec<usize>> {
    let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for cell in cells {
        // The middle node of a quadratic line is last.
        let ordered: Vec<u32> = match cell[..] {
            [a, b, middle] => vec![a, middle, b],
            _ => cell.clone(),
        };
        // A side of a body on a line is a point.
        for &node in cell {
            next.entry(node).or_default();
        }
        for pair in ordered.windows(2) {
            next.entry(pair[0]).or_default().push(pair[1]);
            next.entry(pair[1]).or_default().push(pair[0]);
        }
    }
    let place = |n: u32| points[n as usize];
    let first = |a: &u32, b: &u32| {
        let (p, q) = (place(*a), place(*b));
        p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])).then(a.cmp(b))
    };
    let mut left: Vec<u32> = next.keys().copied().collect();
    left.sort_by(first);
    // Ends come first; other nodes start closed lines only.
    left.sort_by_key(|n| next[n].len() != 1);
    let (mut done, mut all) = (std::collections::BTreeSet::new(), Vec::new());
    for start in left {
        let (mut at, mut chain) = (start, Vec::new());
        while done.insert(at) {
            chain.push(at as usize);
            let Some(&then) = next[&at].iter().find(|n| !done.contains(*n)) else { break };
            at = then;
        }
        if !chain.is_empty() {
            all.push(chain);
        }
    }
    all
}

impl PageSide {
    fn new(grid: &Grid, name: &str, number: usize) -> PageSide {
        let mut side = PageSide {
            name: name.to_owned(),
            number,
            nodes: Vec::new(),
            along: Vec::new(),
            pieces: Vec::new(),
            shape: ReducedMesh::default(),
            normal: [0.0; 3],
            before: 0,
            fields: Vec::new(),
        };
        let cells = cells(grid, number);
        let is_surface = grid.types.iter().any(|kind| ![1, 3, 21].contains(kind));
        if is_surface {
            side.surface(grid, &cells);
        } else {
            side.line(grid, &cells);
        }
        let has = |(name, measure): (String, Measure)| {
            let components = grid.point_data.get(&name).filter(|_| !LEFT_OUT.contains(&name.as_str()))?.components;
            Some(PageField {
                name: if components == 3 { format!("{name} (magnitude)") } else { name }.replace('_', " "),
                symbol: "",
                measure,
                map: if measure == Measure::Temperature { ColorMap::Inferno } else { ColorMap::Viridis },
                components: vec![Vec::new()],
                shown: None,
            })
        };
        side.fields = surface_measures().into_iter().filter_map(has).collect();
        side
    }

    fn line(&mut self, grid: &Grid, cells: &[Vec<u32>]) {
        let mut s = 0.0;
        for chain in chains(&grid.points, cells) {
            self.pieces.push(self.nodes.len());
            for (i, &node) in chain.iter().enumerate() {
                s += if i > 0 { distance(grid.points[chain[i - 1]], grid.points[node]) } else { 0.0 };
                self.nodes.push(node);
                self.along.push(s);
            }
        }
        self.before = self.nodes.len();
        // Every second, third … vertex of a long line, and its ends.
        let each = self.nodes.len().div_ceil(VERTICES);
        if each > 1 {
            let last = self.nodes.len() - 1;
            let kept: Vec<usize> = (0..=last)
                .filter(|i| i % each == 0 || *i == last || self.pieces.contains(i) || self.pieces.contains(&(i + 1)))
                .collect();
            self.pieces = self.pieces.iter().map(|p| kept.partition_point(|i| i < p)).collect();
            (self.nodes, self.along) = kept.iter().map(|&i| (self.nodes[i], self.along[i])).unzip();
        }
    }

    fn surface(&mut self, grid: &Grid, cells: &[Vec<u32>]) {
        let mut vertex: HashMap<u32, u32> = HashMap::new();
        let mut nodes = Vec::new();
        for cell in cells {
            let Some(Drawing { outline, triangles: parts }) = CellType::drawing(cell.len()) else { continue };
            let own: Vec<u32> = cell
                .iter()
                .map(|&node| {
                    *vertex.entry(node).or_insert_with(|| {
                        self.shape.vertices.push((grid.points[node as usize], 0));
                        nodes.push(node as usize);
                        nodes.len() as u32 - 1
                    })
                })
                .collect();
            for part in parts {
                let triangle = part.map(|i| own[i]);
                let n = crate::plot::surface::across(triangle.map(|v| self.shape.vertices[v as usize].0));
                self.normal = [0, 1, 2].map(|d| self.normal[d] + n[d]);
                self.shape.triangles.push(triangle);
            }
            let edges = (0..outline.len()).map(|i| [own[outline[i]], own[outline[(i + 1) % outline.len()]]]);
            self.shape.mesh.extend(edges.filter(|[a, b]| a < b));
        }
        self.shape.outline = crate::plot::ground::rim(&self.shape.triangles);
        self.before = nodes.len();
        let (shape, kept) = std::mem::take(&mut self.shape).thinned(VERTICES);
        (self.shape, self.nodes) = (shape, kept.iter().map(|&i| nodes[i]).collect());
    }

    fn add(&mut self, grid: &Grid, path: &Path) -> Result<(), PlotError> {
        let fault = |what: String| PlotError::Format { path: path.to_owned(), what };
        if self.nodes.iter().any(|&node| node >= grid.points.len()) {
            return Err(fault("it is of another mesh than the snapshots before".to_owned()));
        }
        let measures = surface_measures();
        let names = measures.iter().map(|(name, _)| name).filter(|name| !LEFT_OUT.contains(&name.as_str()));
        let arrays = names.filter_map(|name| grid.point_data.get(name));
        if arrays.clone().count() != self.fields.len() {
            return Err(fault("its arrays are not those of the snapshots before".to_owned()));
        }
        for (field, array) in self.fields.iter_mut().zip(arrays) {
            let c = array.components;
            let value = |&node: &usize| {
                let own = &array.values[c * node..c * (node + 1)];
                if c == 1 { own[0] } else { own.iter().map(|v| v * v).sum::<f64>().sqrt() }
            };
            field.components[0].push(self.nodes.iter().map(value).collect());
        }
        Ok(())
    }

    fn write(&self, dim: usize, units: Units, pack: &mut Pack) -> Value {
        let points: Vec<[f64; 3]> = self.shape.vertices.iter().map(|(p, _)| *p).collect();
        let far = points.iter().flatten().chain(&self.along).fold(0.0f64, |m, v| m.max(v.abs()));
        let (unit, factor) = reading(units, far, Measure::Length);
        let told = self.fields.iter().filter(|field| field.name == "status" || field.is_told());
        json!({
            "name": self.name,
            "number": self.number,
            "dimension": dim,
            "s": pack.reals(self.along.iter().map(|s| s * factor)),
            "pieces": self.pieces,
            "points": pack.reals(points.as_flattened().iter().copied()),
            "triangles": pack.counts(self.shape.triangles.as_flattened()),
            "outline": pack.counts(self.shape.outline.as_flattened()),
            "mesh": pack.counts(self.shape.mesh.as_flattened()),
            "normal": self.normal,
            "length": { "unit": unit, "factor": factor },
            "fields": told.map(|field| field.write(units, pack)).collect::<Vec<_>>(),
            "vertices": [self.nodes.len(), self.before],
        })
    }
}

/// The sides at those of the snapshots that have contact, for the page; null without contact.
pub(super) fn write(
    dir: &Path,
    results: &Results,
    chosen: &[usize],
    units: Units,
    pack: &mut Pack,
) -> Result<Value, PlotError> {
    let file = dir.join(SIDES);
    if results.problem.contacts.is_empty() || !file.exists() {
        return Ok(Value::Null);
    }
    let all = vtu::snapshots(&file)?;
    let (mut sides, mut at): (Vec<PageSide>, Vec<usize>) = (Vec::new(), Vec::new());
    for (place, &i) in chosen.iter().enumerate() {
        let t = results.snapshots[i].0;
        let Some((_, name)) = all.iter().find(|(own, _)| (own - t).abs() <= 1e-12 * t.abs()) else { continue };
        let path = dir.join(name);
        let grid = vtu::read(&path)?;
        if at.is_empty() {
            let names = surface_sides(&results.problem.contacts).enumerate();
            sides = names.map(|(number, side)| PageSide::new(&grid, &side.name, number)).collect();
        }
        at.push(place);
        sides.iter_mut().try_for_each(|side| side.add(&grid, &path))?;
    }
    let dim = results.problem.mesh.dim;
    let written: Vec<Value> =
        sides.iter().filter(|side| !side.nodes.is_empty()).map(|side| side.write(dim, units, pack)).collect();
    Ok(json!({ "at": at, "sides": written }))
}
