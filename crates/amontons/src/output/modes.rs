//! The results folder of a search for modes: `modes.csv`, `modes.json`, and the shapes for ParaView.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::OutputError;
use super::claimed::{ClaimedFolder, MODES};
use super::csv::join;
use super::files::{create_folder, remove_folder, write_atomically, write_json};
use super::inputs::{Input, write_inputs};
use super::names::CASE;
use super::vtu::{connectivity, write_collection};
use crate::contact::names;
use crate::problem::Problem;
use crate::stability::{Mode, ModeCount, ModeRegion, Modes};
use crate::tensor::Point;
use crate::vtu::write::{Cells, WrittenArray as Array, write};

/// Folder of the shapes.
const SHAPES: &str = "modes";

/// A results folder that holds modes.
#[derive(Debug)]
pub struct ModesFolder(ClaimedFolder);

/// The modes of one set of values of keys.
#[derive(Clone, Debug)]
pub struct ModesOf {
    /// Keys with their values; empty if the case was taken as it is.
    pub values: Vec<(String, String)>,
    /// The modes.
    pub modes: Modes,
}

impl ModesFolder {
    /// A folder for modes, created if it does not exist.
    ///
    /// # Errors
    /// The folder holds other results, or modes and `force` is false; another process writes into it; or it cannot
    /// be created.
    pub fn create(path: impl Into<PathBuf>, force: bool) -> Result<ModesFolder, OutputError> {
        let folder = ClaimedFolder::create(path.into(), MODES, force)?;
        // Shapes of an earlier search are those of other modes.
        remove_folder(&folder.path().join(SHAPES))?;
        Ok(ModesFolder(folder))
    }

    /// The folder.
    #[must_use]
    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// Writes the shapes of the modes of a case, of sectors over the whole body, `modes/NAME-1.vtu` and so on, and
    /// their list `modes/NAME.pvd`, whose times are the numbers of the modes.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn shapes(&self, name: &str, problem: &Problem, modes: &Modes) -> Result<(), OutputError> {
        let folder = self.path().join(SHAPES);
        create_folder(&folder)?;
        let mut list = Vec::new();
        for (number, mode) in (1..).zip(&modes.modes) {
            let file = format!("{name}-{number}.vtu");
            shape(&folder.join(&file), problem, mode, modes.sectors)?;
            list.push((f64::from(number), file));
        }
        write_collection(&folder.join(format!("{name}.pvd")), &list).map(|_| ())
    }

    /// Writes the tables: `modes.csv` with a row per mode, `modes.json`, and the case with the files that it refers to.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn finish(
        &self,
        (text, inputs): (&str, &[Input]),
        problem: &Problem,
        all: &[ModesOf],
        json: &serde_json::Value,
    ) -> Result<(), OutputError> {
        write_atomically(&self.path().join(CASE), |out| out.write_all(text.as_bytes()))?;
        write_json(&self.path().join("modes.json"), json)?;
        write_inputs(self.path(), inputs)?;
        write_atomically(&self.path().join(MODES), |out| {
            writeln!(out, "{}", columns(problem, all).join(","))?;
            for ModesOf { values, modes } in all {
                for (number, mode) in modes.modes.iter().enumerate() {
                    let values = values.iter().map(|(_, value)| quoted(value) + ",").collect::<String>();
                    writeln!(out, "{values}{}{}", join(&row(number + 1, mode)), slopes(mode))?;
                }
            }
            Ok(())
        })
        .map(|_| ())
    }
}

/// Text of a field that may hold commas.
fn quoted(value: &str) -> String {
    if value.contains([',', '"', '\n']) { format!("\"{}\"", value.replace('"', "\"\"")) } else { value.to_owned() }
}

/// Names of the columns: keys, then those of a mode.
fn columns(problem: &Problem, all: &[ModesOf]) -> Vec<String> {
    let keys = all.first().map_or(&[][..], |first| &first.values).iter().map(|(key, _)| quoted(key));
    let is_sector = all.iter().any(|of| of.modes.sectors > 1);
    let own = ["mode", "waves", "frequency", "growth", "damping_ratio", "residual"];
    let own = own.into_iter().filter(|name| is_sector || *name != "waves").map(str::to_owned);
    let contacts = names(&problem.contacts).into_iter().map(|name| quoted(&format!("growth_{name}")));
    let bodies = all.first().map_or(&[][..], |first| &first.modes.bodies);
    let bodies = bodies.iter().map(|name| quoted(&format!("share_{name}")));
    let parameters = all.first().map_or(&[][..], |first| &first.modes.parameters);
    let slopes = parameters.iter().flat_map(|(name, _)| [format!("frequency_by_{name}"), format!("growth_by_{name}")]);
    keys.chain(own).chain(contacts).chain(bodies).chain(slopes.map(|name| quoted(&name))).collect()
}

/// The derivatives of a mode, each after a comma; empty fields where it has none.
fn slopes(mode: &Mode) -> String {
    let of = |k: usize| match mode.slope(k) {
        Some([growth, frequency]) => format!(",{}", join(&[frequency, growth])),
        None => ",,".to_owned(),
    };
    (0..mode.slopes.len()).map(of).collect()
}

/// The numbers of a mode.
fn row(number: usize, mode: &Mode) -> Vec<f64> {
    let own = [mode.hertz(), mode.growth, mode.damping_ratio(), mode.residual];
    let first = [number as f64].into_iter().chain(mode.waves.map(|waves| waves as f64));
    first.chain(own).chain(mode.by_contact.iter().copied()).chain(mode.by_body.iter().copied()).collect()
}

/// A mode as `modes.json` has it.
fn mode_json(contacts: &[String], modes: &Modes, mode: &Mode) -> serde_json::Value {
    let mut one = serde_json::json!({
        "frequency": mode.hertz(),
        "growth": mode.growth,
        "damping_ratio": mode.damping_ratio(),
        "residual": mode.residual,
        "growth_by_contact": contacts.iter().zip(&mode.by_contact).collect::<std::collections::BTreeMap<_, _>>(),
        "share_by_body": modes.bodies.iter().zip(&mode.by_body).collect::<std::collections::BTreeMap<_, _>>(),
    });
    if let Some((waves, object)) = mode.waves.zip(one.as_object_mut()) {
        object.insert("waves".to_owned(), waves.into());
    }
    if !modes.parameters.is_empty() {
        let of = |(k, (name, _)): (usize, &(String, f64))| {
            let slope = mode.slope(k);
            let [growth, frequency] = [0, 1].map(|part| slope.map(|slope| slope[part]));
            (name.clone(), serde_json::json!({ "frequency": frequency, "growth": growth }))
        };
        one["by"] = modes.parameters.iter().enumerate().map(of).collect();
    }
    one
}

/// The searches as `modes.json` has them: modes with their shares, regions, counts.
#[must_use]
pub fn modes_json(problem: &Problem, all: &[ModesOf]) -> serde_json::Value {
    let hertz = |range: [f64; 2]| range.map(|rate| rate / std::f64::consts::TAU);
    let contacts = names(&problem.contacts);
    let one = |ModesOf { values, modes }: &ModesOf| {
        let of = |mode: &Mode| mode_json(&contacts, modes, mode);
        let region =
            |region: &ModeRegion| serde_json::json!({ "frequency": hertz(region.frequency), "growth": region.growth });
        let mut found = serde_json::json!({
            "missing": modes.missing(),
            "unknowns": modes.unknowns,
            "factorizations": modes.factorizations,
            "dimension": modes.dimension,
        });
        if modes.sectors == 1 {
            found["region"] = modes.counts.first().map_or(serde_json::Value::Null, |count| region(&count.region));
        } else {
            let count = |count: &ModeCount| {
                serde_json::json!({
                    "waves": count.waves,
                    "region": region(&count.region),
                    "modes": count.modes,
                    "missing": count.missing,
                })
            };
            found["sectors"] = modes.sectors.into();
            found["counts"] = modes.counts.iter().map(count).collect();
        }
        let [open, stick, slip] = modes.points;
        let mut one = serde_json::json!({
            "set": values.iter().map(|(key, value)| format!("{key}={value}")).collect::<Vec<_>>(),
            "kind": modes.kind.name(),
            "modes": modes.modes.iter().map(of).collect::<Vec<_>>(),
            "points": { "open": open, "stick": stick, "slip": slip },
            "unsteady": modes.unsteady,
        });
        if !modes.parameters.is_empty() {
            let value = |(name, value): &(String, f64)| (name.clone(), serde_json::Value::from(*value));
            one["parameters"] = modes.parameters.iter().map(value).collect();
        }
        if let (Some(all), serde_json::Value::Object(found)) = (one.as_object_mut(), found) {
            all.extend(found);
        }
        one
    };
    serde_json::json!({ "modes": all.iter().map(one).collect::<Vec<_>>() })
}

/// Writes real and imaginary part of a mode of the whole body: a quarter of a period later the imaginary part is seen
/// with the opposite sign. The nodes of the cuts between sectors are written for each of them.
fn shape(path: &Path, problem: &Problem, mode: &Mode, sectors: usize) -> Result<(), OutputError> {
    let mesh = &problem.mesh;
    let turned = |v: &Point, place: usize| match problem.cyclic.first() {
        Some(cyclic) => cyclic.vector(v, [place, sectors]),
        None => *v,
    };
    let mut arrays = Vec::new();
    for (at, name) in ["real", "imaginary"].into_iter().enumerate() {
        let of =
            move |[re, im]: [f64; 2], [cosine, sine]: [f64; 2]| [re * cosine - im * sine, re * sine + im * cosine][at];
        if mode.displacement.len() == mesh.points.len() * mesh.dim {
            let values = (0..sectors).flat_map(|place| {
                let phase = mode.phase(place, sectors);
                mode.displacement.chunks_exact(mesh.dim).flat_map(move |node| {
                    turned(&std::array::from_fn(|c| node.get(c).map_or(0.0, |value| of(*value, phase))), place)
                })
            });
            arrays.push(Array::reals(format!("displacement_{name}"), 3, values.collect::<Vec<f64>>()));
        }
        if mode.temperature.len() == mesh.points.len() {
            let values = (0..sectors).flat_map(|place| {
                let phase = mode.phase(place, sectors);
                mode.temperature.iter().map(move |value| of(*value, phase))
            });
            arrays.push(Array::reals(format!("temperature_{name}"), 1, values.collect::<Vec<f64>>()));
        }
    }
    let position =
        |x: &Point, place: usize| problem.cyclic.first().map_or(*x, |cyclic| cyclic.position(x, [place, sectors]));
    let points: Vec<Point> =
        (0..sectors).flat_map(|place| mesh.points.iter().map(move |x| position(x, place))).collect();
    let cells = repeated(connectivity(problem), mesh.points.len(), sectors);
    write_atomically(path, |out| write(out, &points, cells, &arrays, &[])).map(|_| ())
}

/// Cells once per sector, whose nodes follow those of the sector before.
fn repeated(cells: Cells, nodes: usize, sectors: usize) -> Cells {
    if sectors == 1 {
        return cells;
    }
    let each = |of: &[i64], by: usize| -> Vec<i64> {
        (0..sectors).flat_map(|place| of.iter().map(move |entry| entry + (place * by) as i64)).collect()
    };
    Cells {
        ends: each(&cells.ends, cells.connectivity.len()),
        connectivity: each(&cells.connectivity, nodes),
        types: cells.types.repeat(sectors),
    }
}
