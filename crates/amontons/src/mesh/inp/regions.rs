//! Regions of an input file: the sets of its sections, or else of its elements.

use std::collections::{BTreeSet, HashMap};

use super::super::read::{Loose, MeshFileError};
use super::model::{InpCell, SetKind};
use super::sets::{CellOf, Sets};
use super::told::Left;

/// Name of the region of elements without a set.
const BODY: &str = "body";

/// Names of regions in the order of occurrence.
#[derive(Default)]
struct RegionNames {
    names: Vec<String>,
    numbers: HashMap<String, i64>,
}

impl RegionNames {
    fn number(&mut self, name: String) -> i64 {
        let next = self.names.len() as i64;
        *self.numbers.entry(name).or_insert_with_key(|name| {
            self.names.push(name.clone());
            next
        })
    }
}

/// The regions of each cell.
type OfCells = HashMap<CellOf, BTreeSet<i64>>;

impl Sets {
    /// Adds the cells with their regions.
    pub(super) fn regions(&self, loose: &mut Loose) -> Result<(), MeshFileError> {
        let mut groups = RegionNames::default();
        let mut of_cell = self.of_sections(&mut groups)?;
        if groups.names.is_empty() {
            of_cell = self.of_elements(&mut groups)?;
        }
        if !groups.names.is_empty() {
            for cell in self.body_cells().filter(|cell| !of_cell.contains_key(cell)).collect::<Vec<_>>() {
                of_cell.entry(cell).or_default().insert(groups.number(BODY.to_owned()));
            }
        }
        let used: BTreeSet<i64> = of_cell.values().flatten().copied().collect();
        self.unnamed(&groups, &used)?;
        for (number, name) in groups.names.into_iter().enumerate() {
            loose.names.insert((self.dim, number as i64), name);
        }
        for (body, cell) in self.body_cells() {
            let InpCell { solid, line, .. } = self.cell(body, cell);
            let groups = of_cell.remove(&(body, cell)).unwrap_or_default();
            loose.push(solid.kind, &groups, *line, &self.nodes(body, cell)?);
        }
        Ok(())
    }

    /// Regions from the sections; the last section that names a cell counts.
    fn of_sections(&self, groups: &mut RegionNames) -> Result<OfCells, MeshFileError> {
        let mut of_cell = HashMap::new();
        let mut met: HashMap<(Option<usize>, String), usize> = HashMap::new();
        for (body, _, name) in self.order.iter().filter(|(_, has, _)| *has == SetKind::Section) {
            let times = met.entry((*body, name.to_uppercase())).or_insert(0);
            let line = self.lines(*body, SetKind::Section, name).nth(*times).unwrap_or(0);
            *times += 1;
            let cells = self.elements(*body, SetKind::Section, name, 0)?;
            let cells: Vec<CellOf> = cells.into_iter().filter(|cell| self.is_of_body(*cell)).collect();
            let outside = self.outside(*body, &self.spelling(*body, SetKind::Elements, name));
            if cells.is_empty() {
                self.told.note(Left::Sections, line, &outside, 1);
                continue;
            }
            let number = groups.number(outside);
            for cell in cells {
                let before = of_cell.insert(cell, BTreeSet::from([number]));
                let before = before.and_then(|before| before.first().copied()).filter(|before| *before != number);
                if let Some(name) = before.and_then(|before| groups.names.get(usize::try_from(before).ok()?)) {
                    self.told.note(Left::Taken, line, name, 1);
                }
            }
        }
        Ok(of_cell)
    }

    /// Regions from the sets named by element keywords; in a file of Gmsh its groups come first.
    fn of_elements(&self, groups: &mut RegionNames) -> Result<OfCells, MeshFileError> {
        let mut of_cell = HashMap::new();
        if self.is_of_gmsh() {
            for (body, _, name) in
                self.order.iter().filter(|(_, has, name)| *has == SetKind::Elements && !is_entity(name))
            {
                let cells = self.elements(*body, SetKind::Elements, name, 0)?;
                let cells: Vec<CellOf> = cells.into_iter().filter(|cell| self.is_of_body(*cell)).collect();
                let number = (!cells.is_empty()).then(|| groups.number(self.outside(*body, name)));
                for cell in cells {
                    of_cell.entry(cell).or_insert_with(BTreeSet::new).extend(number);
                }
            }
        }
        let mut last: Option<(usize, &str, i64)> = None;
        for (body, cell) in self.body_cells().filter(|cell| !of_cell.contains_key(cell)).collect::<Vec<_>>() {
            let Some(set) = self.cell(body, cell).set.as_deref() else { continue };
            let number = match last {
                Some((same_body, same, number)) if (same_body, same) == (body, set) => number,
                _ => groups.number(self.outside(Some(body), &self.spelling(Some(body), SetKind::Elements, set))),
            };
            last = Some((body, set, number));
            of_cell.insert((body, cell), BTreeSet::from([number]));
        }
        Ok(of_cell)
    }

    /// True if Gmsh wrote the elements, in sets per volume, surface and curve.
    fn is_of_gmsh(&self) -> bool {
        self.body_cells().all(|(body, cell)| self.cell(body, cell).set.as_deref().is_some_and(is_entity))
    }

    /// Records the cell sets that are no regions, except those of Gmsh's volumes and the internal sets of
    /// preprocessors, whose names begin with an underscore.
    fn unnamed(&self, groups: &RegionNames, used: &BTreeSet<i64>) -> Result<(), MeshFileError> {
        let regions: BTreeSet<String> = groups
            .names
            .iter()
            .zip(0..)
            .filter(|(_, at)| used.contains(at))
            .map(|(name, _)| name.to_uppercase())
            .collect();
        let is_region = |body: Option<usize>, name: &str| regions.contains(&self.outside(body, name).to_uppercase());
        for (body, _, name) in self.order.iter().filter(|(_, has, _)| *has == SetKind::Elements) {
            if is_region(*body, name) || is_entity(name) || name.starts_with('_') {
                continue;
            }
            let line = self.line(*body, SetKind::Elements, name);
            if self.elements(*body, SetKind::Elements, name, 0)?.into_iter().any(|cell| self.is_of_body(cell)) {
                self.told.note(Left::Unnamed, line, &self.outside(*body, name), 1);
            }
        }
        Ok(())
    }
}

/// True for the name of a set that Gmsh creates for a volume, a surface or a curve.
fn is_entity(name: &str) -> bool {
    let number = ["Volume", "Surface", "Line"].iter().find_map(|entity| name.strip_prefix(entity));
    number.is_some_and(|number| !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit()))
}
