//! `[[mesh.refine_where]]` and `mesh.refined_cells`: where the mesh is finer.

use super::build::Build;
use super::memory::MeshDemand;
use super::mesh::measured;
use super::nearest::meant;
use super::path::Path;
use super::place::At;
use super::raw;
use super::side_names::SideNames;
use crate::expression::{Expression, Variable};
use crate::machine::FreeMemory;
use crate::mesh::{Bisection, FacetSet, Mesh, RefinementRounds, RoundSide, RoundsError};
use crate::tensor::{Point, Rotation};

/// Where the cells to refine are: in all of these places.
#[derive(Default)]
struct Places {
    side: Option<String>,
    region: Option<usize>,
    corners: Option<(Point, Point)>,
    holds: Option<Expression>,
}

impl Build<'_> {
    /// The mesh with finer cells where the case asks for them, or `None` if an entry has a fault.
    pub(super) fn refined_where(
        &mut self,
        raw: &raw::Mesh,
        mesh: Mesh,
        sides: &SideNames,
        available: Option<FreeMemory>,
    ) -> Option<Mesh> {
        let entries = raw.refine_where();
        let paths = (0..entries.len()).map(|i| format!("mesh.refine_where[{i}]"));
        let places: Vec<(String, Option<Places>)> = entries
            .iter()
            .zip(paths)
            .map(|(entry, path)| (path.clone(), self.refine_places(&path, entry, &mesh)))
            .collect();
        if entries.is_empty() || !self.is_sound {
            return Some(mesh);
        }
        let around = |bisection: Bisection, (nodes, side): (Vec<u32>, RoundSide)| bisection.around(&nodes, side);
        let mut bisection = round_sides(raw, &mesh).into_iter().fold(Bisection::new(&mesh), around);
        let mut finer = mesh;
        for (entry, (path, places)) in entries.iter().zip(places) {
            let places = places?;
            for _ in 0..entry.times {
                finer = self.refined_once(&path, &places, &finer, &mut bisection)?;
                let refine = if let raw::Mesh::File { refine, .. } = raw { *refine } else { 0 };
                let size = measured(&finer, &sides.contact, refine);
                let demand = MeshDemand::of(&size, self.solver);
                let what = format!("{} cells", finer.cell_count());
                let hint = "refine a smaller place, or fewer `times`";
                if !self.affordable(&format!("{path}.times"), &what, hint, &demand, available) {
                    return None;
                }
            }
        }
        self.checked("mesh.refine_where", finer)
    }

    /// A mesh whose curved sides got their nodes back: this may have turned cells over.
    fn checked(&mut self, key: &str, mesh: Mesh) -> Option<Mesh> {
        let Err(error) = mesh.check() else { return Some(mesh) };
        let expected = error.expected().unwrap_or_else(|| "a mesh that can be built".to_owned());
        self.note(key, At::Value, error.found(), expected, Some("give the body more cells around"));
        None
    }

    /// The mesh with the cells refined that a file lists by rounds, or `None` if there is a fault.
    pub(super) fn with_refined_cells(
        &mut self,
        raw: &raw::Mesh,
        mesh: Mesh,
        sides: &SideNames,
        available: Option<FreeMemory>,
    ) -> Option<Mesh> {
        const KEY: &str = "mesh.refined_cells";
        let Some(name) = raw.refined_cells() else { return Some(mesh) };
        let bytes = match self.loader.get(&Path::parse(KEY).unwrap_or_default(), name) {
            Ok(bytes) => bytes,
            Err(missing) => {
                self.note(KEY, At::Value, missing.found, missing.expected, missing.hint.as_deref());
                return None;
            }
        };
        if !self.is_sound {
            return Some(mesh);
        }
        let told = |build: &mut Self, RoundsError { place, found, expected }: RoundsError| {
            let hint = "leave the key out, or take the file of a run with --accuracy of the same mesh";
            build.note(KEY, At::Value, format!("{name}: {place}: {found}"), expected, Some(hint));
        };
        let rounds =
            RefinementRounds::parse(&String::from_utf8_lossy(&bytes)).map_err(|error| told(self, error)).ok()?;
        // Halving all cells a few times more would take all memory before the mesh is there to be measured.
        let least = MeshDemand::of(&measured(&mesh, &sides.contact, rounds.halvings()), self.solver);
        if !self.affordable(
            KEY,
            &format!("{} halvings of all cells", rounds.halvings()),
            "take fewer rounds",
            &least,
            available,
        ) {
            return None;
        }
        let made = rounds.refined(&mesh, round_sides(raw, &mesh));
        let finer = made.map_err(|error| told(self, error)).ok()?;
        self.rounds = Some(rounds);
        let demand = MeshDemand::of(&measured(&finer, &sides.contact, 0), self.solver);
        let what = format!("{} cells", finer.cell_count());
        let is_affordable = self.affordable(KEY, &what, "take fewer rounds", &demand, available);
        self.checked(KEY, finer).filter(|_| is_affordable)
    }

    /// Refines the cells in some places once.
    fn refined_once(&mut self, path: &str, places: &Places, mesh: &Mesh, bisection: &mut Bisection) -> Option<Mesh> {
        let marked = places.cells(mesh);
        if marked.is_empty() {
            let range = |d: usize| {
                let along = || mesh.points.iter().map(|x| x[d]);
                let [low, high] = [along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max)];
                format!("{} from {low:?} to {high:?}", ["x", "y", "z"][d])
            };
            let ranges: Vec<String> = (0..mesh.dim.min(3)).map(range).collect();
            let expected = format!("at least one of {} cells, which have {}", mesh.cell_count(), ranges.join(", "));
            let hint = "a cell counts if it is in all places of the entry";
            self.note(path, At::Value, "no cell there", expected, Some(hint));
            return None;
        }
        if let Err(error) = bisection.refine(&marked) {
            let expected = error.expected().unwrap_or_else(|| "a mesh that can be built".to_owned());
            self.note(&format!("{path}.times"), At::Value, error.found(), expected, None);
            return None;
        }
        Some(bisection.mesh())
    }

    /// The places of an entry, or `None` if one has a fault.
    fn refine_places(&mut self, path: &str, raw: &raw::RefineWhere, mesh: &Mesh) -> Option<Places> {
        let mut places = Places::default();
        if raw.side.is_none() && raw.region.is_none() && raw.within.is_none() && raw.holds.is_none() {
            let expected = "one of them: `side`, `region`, `box` or `where`";
            let hint = Some("for finer cells everywhere, give more cells with `n`, or `refine` beside a file");
            self.note(path, At::Value, "no place", expected, hint);
            return None;
        }
        if let Some(side) = &raw.side {
            let known: Vec<&str> = mesh.facets.keys().map(String::as_str).collect();
            self.is_named(&format!("{path}.side"), side, "sides", &known)?;
            places.side = Some(side.clone());
        }
        if let Some(region) = &raw.region {
            let known: Vec<&str> = mesh.regions.iter().map(String::as_str).collect();
            places.region = Some(self.is_named(&format!("{path}.region"), region, "regions", &known)?);
        }
        if let Some(corners) = &raw.within {
            let at = format!("{path}.box");
            let (from, to) = (self.point(&at, "from", &corners.from), self.point(&at, "to", &corners.to));
            let (from, to) = (from?, to?);
            self.ordered(&at, from, to)?;
            places.corners = Some((from, to));
        }
        if let Some(text) = &raw.holds {
            let at = format!("{path}.where");
            let expression = self.expression(&at, text)?;
            if expression.uses(Variable::T) {
                let expected = format!("a condition in {}: the mesh is the same at all times", self.axes());
                self.note(&at, At::Value, "`t` in a condition", expected, None);
                return None;
            }
            places.holds = Some(expression);
        }
        Some(places)
    }

    /// The place of a name among the known ones.
    fn is_named(&mut self, path: &str, name: &str, what: &str, known: &[&str]) -> Option<usize> {
        let place = known.iter().position(|known| *known == name);
        if place.is_none() {
            let expected = format!("one of the {what} {}", known.join(", "));
            self.note(path, At::Value, format!("\"{name}\""), expected, meant(name, known).as_deref());
        }
        place
    }
}

impl Places {
    /// The cells in all places, numbered through the blocks.
    fn cells(&self, mesh: &Mesh) -> Vec<usize> {
        let on_side = self.side.as_ref().map(|side| {
            let mut on = vec![false; mesh.points.len()];
            let nodes = mesh.facets.get(side).map(FacetSet::node_list).unwrap_or_default();
            for node in nodes {
                on[node as usize] = true;
            }
            on
        });
        let (mut marked, mut number) = (Vec::new(), 0);
        for block in &mesh.blocks {
            let is_of_region = self.region.is_none_or(|region| region == block.region);
            let corners = block.element.shape.vertices();
            for cell in block.cells() {
                let vertices = cell.get(..corners).unwrap_or(cell);
                let touches = on_side.as_ref().is_none_or(|on| vertices.iter().any(|&node| on[node as usize]));
                if is_of_region && touches && self.has_points(mesh, vertices) {
                    marked.push(number);
                }
                number += 1;
            }
        }
        marked
    }

    /// True if a cell reaches into the box, and the condition holds at a vertex or in the centre.
    fn has_points(&self, mesh: &Mesh, vertices: &[u32]) -> bool {
        let points = || vertices.iter().map(|&node| &mesh.points[node as usize]);
        let reaches = |(from, to): &(Point, Point)| {
            let along = |d: usize| points().map(move |x| x[d]);
            (0..mesh.dim).all(|d| {
                let (low, high) = (along(d).fold(f64::INFINITY, f64::min), along(d).fold(f64::NEG_INFINITY, f64::max));
                low < to[d] && high > from[d] || from[d] >= low && to[d] <= high
            })
        };
        let centre: Point = std::array::from_fn(|d| points().map(|x| x[d]).sum::<f64>() / vertices.len() as f64);
        // A value that is not a number holds nowhere.
        let is_true = |expression: &Expression| points().chain([&centre]).any(|x| expression.value(x, 0.0).abs() > 0.0);
        self.corners.as_ref().is_none_or(reaches) && self.holds.as_ref().is_none_or(is_true)
    }
}

/// The round sides of a generated mesh, with their nodes.
fn round_sides(raw: &raw::Mesh, mesh: &Mesh) -> Vec<(Vec<u32>, RoundSide)> {
    let nodes = |side: &String| mesh.facets.get(side).map(FacetSet::node_list).unwrap_or_default();
    rounds(raw).into_iter().map(|(side, round)| (nodes(&side), round)).collect()
}

/// The round sides of a generated mesh, with their names.
fn rounds(raw: &raw::Mesh) -> Vec<(String, RoundSide)> {
    let upright = |radius: f64| RoundSide { through: [0.0; 3], axis: [0.0, 0.0, 1.0], radius };
    let both =
        |radii: &[f64; 2]| vec![("inner".to_owned(), upright(radii[0])), ("outer".to_owned(), upright(radii[1]))];
    match raw {
        raw::Mesh::Disc { radius, .. } => vec![("outer".to_owned(), upright(*radius))],
        raw::Mesh::Ring { radii, .. } | raw::Mesh::Cylinder { radii, .. } => both(radii),
        raw::Mesh::Blocks { blocks, .. } => blocks.iter().flat_map(of_block).collect(),
        _ => Vec::new(),
    }
}

/// The round sides of a block where it is placed.
fn of_block(block: &raw::Block) -> Vec<(String, RoundSide)> {
    let through: Point = std::array::from_fn(|d| block.origin.get(d).copied().unwrap_or(0.0));
    let axis = match &block.turn {
        Some(turn) if turn.axis.len() == 3 => {
            let about: Point = std::array::from_fn(|d| turn.axis[d]);
            Rotation::about(&about, turn.angle).vector(&[0.0, 0.0, 1.0])
        }
        _ => [0.0, 0.0, 1.0],
    };
    let side = |name: &str, radius: f64| (format!("{}_{name}", block.name), RoundSide { through, axis, radius });
    block.radii.map_or_else(Vec::new, |[inner, outer]| vec![side("inner", inner), side("outer", outer)])
}
