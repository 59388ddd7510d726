//! Twelve cases of all kinds: every value that a run writes has the same name, unit and size wherever it is shown.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::{FIGURES, Lives, ResultTable, Shown};
use crate::case::{self, Case};
use crate::contact::Contact;
use crate::output::{Folder, FolderOptions, Summary, shown, surface};
use crate::plot::{self, Options, PictureKind};
use crate::run::{Settings, run};
use crate::units::Measure;
use crate::vtu::Grid;

/// Cases in the plane and in space, of revolution, on a line, and a sector; heat, mechanics or both; foundations, pairs
/// and several contacts; linear and quadratic; wear, friction out of the plane, Gauss points.
const CASES: [(&str, &[&str]); 12] = [
    ("cases/paper.toml", &["mesh.n=8", "time.steps=8"]),
    ("cases/clutch.toml", &["time.steps=4"]),
    ("cases/press-fit.toml", &["time.steps=4"]),
    ("cases/o-ring.toml", &["time.steps=20"]),
    ("cases/slab.toml", &["time.steps=8"]),
    ("crates/amontons/benchmarks/contact-heat-sum.toml", &[]),
    ("crates/amontons/benchmarks/wear-pin.toml", &["time.steps=5"]),
    ("crates/amontons/benchmarks/convection-fin.toml", &[]),
    ("crates/amontons/benchmarks/hertz-sphere-space.toml", &[]),
    ("crates/amontons/benchmarks/twisted-sector.toml", &[]),
    ("crates/amontons/benchmarks/pair-three-bodies.toml", &[]),
    ("crates/amontons/benchmarks/pair-patch-space-quadratic.toml", &[]),
];

/// A run with everything it wrote.
struct Ran {
    case: Case,
    summary: Summary,
    folder: PathBuf,
    history: ColumnWords,
    contact: ColumnWords,
    fields: Grid,
    sides: Option<Grid>,
}

/// The columns of a table by name, as text.
type ColumnWords = BTreeMap<String, Vec<String>>;

fn columns(path: &Path) -> ColumnWords {
    let Ok(text) = fs::read_to_string(path) else { return ColumnWords::new() };
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let column = |c: usize| rows.iter().map(|row| row[c].trim_matches('"').to_owned()).collect();
    header.iter().enumerate().map(|(c, name)| ((*name).to_owned(), column(c))).collect()
}

fn numbers(columns: &ColumnWords, name: &str) -> Vec<f64> {
    columns.get(name).into_iter().flatten().map(|text| text.parse().unwrap_or(f64::NAN)).collect()
}

/// The grid of the last moment of a collection.
fn last(folder: &Path, collection: &str) -> Option<Grid> {
    let text = fs::read_to_string(folder.join(collection)).ok()?;
    let file = text.rsplit_once("file=\"")?.1.split('"').next()?.to_owned();
    Some(crate::vtu::parse(&fs::read(folder.join(file)).unwrap(), |_| true).unwrap())
}

fn ran(path: &str, overrides: &[&str]) -> Ran {
    let overrides: Vec<String> = overrides.iter().map(|&text| text.to_owned()).collect();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut case = case::read(&root.join(path), &overrides).unwrap_or_else(|error| panic!("{error}"));
    case.every = case.problem.timeline.steps();
    let name = format!("amontons-shown-{}-{}", std::process::id(), case.problem.name);
    let folder = std::env::temp_dir().join(name);
    let options = FolderOptions { force: true, ..case.folder_options() };
    let mut sink = Folder::create(&folder, options).unwrap();
    let settings = Settings { certificate: false, ..Settings::default() };
    let summary = run(&case.problem, &settings, &mut [&mut sink]).unwrap_or_else(|error| panic!("{path}: {error}"));
    drop(sink);
    Ran {
        summary,
        history: columns(&folder.join("history.csv")),
        contact: columns(&folder.join("contact.csv")),
        fields: last(&folder, "fields.pvd").expect("fields"),
        sides: last(&folder, "contact.pvd"),
        folder,
        case,
    }
}

impl Ran {
    fn near(&self, what: &str, found: f64, expected: f64) {
        let size = found.abs().max(expected.abs());
        assert!((found - expected).abs() <= 1e-12 * size, "{}: {what} {found} {expected}", self.summary.case);
    }

    /// The values of an array over the body, by component.
    fn array(&self, name: &str) -> Vec<Vec<f64>> {
        let of = |grid: &Grid| {
            grid.point_data.get(name).or(grid.cell_data.get(name)).map(|array| {
                (0..array.components)
                    .map(|c| array.values.iter().skip(c).step_by(array.components).copied().collect())
                    .collect()
            })
        };
        of(&self.fields).unwrap_or_default()
    }

    fn figure(&self, key: &str) -> Vec<f64> {
        let figure = FIGURES.iter().find(|figure| figure.key == key).unwrap_or_else(|| panic!("{key}"));
        figure.values(&self.summary.last).into_iter().map(|(_, value)| value).collect()
    }

    /// Every name in the files is known, with the unit that the manifest gives it.
    fn has_its_names(&self, all: &[Shown]) {
        let manifest: serde_json::Value =
            serde_json::from_str(&fs::read_to_string(self.folder.join("manifest.json")).unwrap()).unwrap();
        let check = |table: ResultTable, names: &mut dyn Iterator<Item = &String>| {
            for name in names {
                let of_side = name.split('@').next().unwrap();
                let known = all.iter().find(|value| value.table == table && value.name == of_side);
                let known = known.unwrap_or_else(|| panic!("{}: nobody knows {name}", table.file()));
                let unit = known.measure.map_or("", |measure| self.case.problem.units().of(measure));
                let told = manifest["columns"][table.file()][name].as_str().unwrap_or_default();
                assert_eq!(told, unit, "{} of {}", name, table.file());
                let at_cells = matches!(known.lives, Lives::Cell);
                assert!(table != ResultTable::Fields || at_cells == self.fields.cell_data.contains_key(name), "{name}");
            }
        };
        check(ResultTable::History, &mut self.history.keys());
        check(ResultTable::Contact, &mut self.contact.keys());
        check(ResultTable::Fields, &mut self.fields.point_data.keys().chain(self.fields.cell_data.keys()));
        if let Some(sides) = &self.sides {
            check(ResultTable::Surface, &mut sides.point_data.keys().chain(sides.cell_data.keys()));
        }
    }

    /// A figure of the summary is the extreme of the values in the files at its location.
    fn has_its_extremes(&self, all: &[Shown]) {
        let least = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = |values: &[f64]| values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let lives =
            |table: ResultTable, name: &str| all.iter().find(|v| v.table == table && v.name == name).unwrap().lives;
        let of_body: [(&str, &str, &dyn Fn(&[f64]) -> f64); 6] = [
            ("final.displacement_min", "displacement", &least),
            ("final.displacement_max", "displacement", &most),
            ("final.velocity_max", "velocity", &most),
            ("final.temperature_min", "temperature", &least),
            ("final.temperature_max", "temperature", &most),
            ("final.von_mises_max", "von_mises", &most),
        ];
        for (key, array, take) in of_body {
            let (found, values) = (self.figure(key), self.array(array));
            assert_eq!(found.is_empty(), values.is_empty(), "{key}");
            assert_eq!(lives(ResultTable::Summary, key), lives(ResultTable::Fields, array));
            found.iter().zip(&values).for_each(|(found, values)| self.near(key, *found, take(values)));
        }
        let contact = self.summary.last.contact.as_ref().filter(|_| !self.contact.is_empty());
        let Some(contact) = contact else { return };
        let areas = numbers(&self.contact, "weight");
        let counted =
            |name: &str| numbers(&self.contact, name).into_iter().zip(&areas).filter(|(_, area)| **area > 0.0);
        let largest = |name: &str| counted(name).fold(0.0, |most: f64, (value, _)| most.max(value));
        self.near("pressure", contact.pressure_max, largest("pressure"));
        self.near("penetration", contact.penetration_max, largest("penetration"));
        for (key, column) in [("pressure_max", "pressure"), ("penetration_max", "penetration"), ("wear_max", "wear")] {
            assert_eq!(
                lives(ResultTable::Summary, &format!("final.contact.{key}")),
                lives(ResultTable::Contact, column)
            );
            assert_eq!(lives(ResultTable::History, key), lives(ResultTable::Contact, column));
        }
        let status = &self.contact["status"];
        let number = |name: &str| status.iter().zip(&areas).filter(|(s, area)| *s == name && **area > 0.0).count();
        assert_eq!([contact.open, contact.stick, contact.slip], ["open", "stick", "slip"].map(number));
        let closed = status.iter().zip(&areas).filter(|(status, _)| *status != "open");
        self.near("area", contact.area, closed.map(|(_, area)| area).sum());
    }

    /// The last row of the history has the figures of the summary, of all contacts and of each.
    fn has_its_history(&self) {
        let end = |name: &str| numbers(&self.history, name).last().copied();
        let axes = ["x", "y", "z"];
        let mut contacts: Vec<(String, &crate::output::ContactSummary)> = Vec::new();
        if let Some(contact) = &self.summary.last.contact {
            contacts.push((String::new(), contact));
            contacts.extend(contact.sides.iter().map(|(side, contact)| (format!("@{side}"), contact)));
        }
        let mut compared = 0;
        for (side, contact) in contacts {
            let mut all = vec![
                ("penetration_max".to_owned(), contact.penetration_max),
                ("pressure_max".to_owned(), contact.pressure_max),
                ("contact_area".to_owned(), contact.area),
                ("wear_max".to_owned(), contact.wear_max),
                ("wear_volume".to_owned(), contact.wear_volume),
                ("open".to_owned(), contact.open as f64),
                ("stick".to_owned(), contact.stick as f64),
                ("slip".to_owned(), contact.slip as f64),
            ];
            all.extend(contact.force.iter().zip(axes).map(|(f, axis)| (format!("contact_force_{axis}"), *f)));
            all.extend(contact.center.iter().zip(axes).map(|(x, axis)| (format!("contact_center_{axis}"), *x)));
            all.extend(contact.moment.map(|moment| ("contact_moment".to_owned(), moment)));
            for (name, value) in all {
                if let Some(found) = end(&format!("{name}{side}")) {
                    self.near(&format!("{name}{side}"), found, value);
                    compared += 1;
                }
            }
        }
        assert!(self.summary.last.contact.is_none() || self.contact.is_empty() || compared >= 8, "{compared}");
        let energy = serde_json::to_value(&self.summary.energy).unwrap();
        let mut balanced = 0;
        for (name, value) in energy.as_object().unwrap().iter().filter(|(name, _)| !name.ends_with("closing_error")) {
            // The turnover has no column; heat through pairs has one only if there are pairs.
            let Some(found) = end(name) else { continue };
            self.near(name, found, value.as_f64().unwrap());
            balanced += 1;
        }
        assert!(balanced >= 15, "{balanced}");
    }

    /// On both sides of a contact, nodal areas and pressures have the same sums as the contact points, and every mean
    /// is within the range of the points.
    fn has_its_sums(&self) {
        let Some(grid) = &self.sides else { return };
        let problem = &self.case.problem;
        let [weights, pressures] = ["weight", "pressure"].map(|name| numbers(&self.contact, name));
        let of_array = |name: &str| &grid.point_data[name].values;
        for (number, side) in surface::sides(&problem.contacts).enumerate() {
            let on = |contact: &Contact| contact.sides().any(|name| name == side.name);
            let contact = problem.contacts.iter().find(|contact| on(contact)).expect("a contact");
            let is_of = |row: &usize| self.contact["side"][*row] == contact.bearing();
            if problem.contacts.iter().filter(|contact| on(contact)).count() > 1 {
                continue;
            }
            let rows: Vec<usize> = (0..weights.len()).filter(is_of).collect();
            let points: f64 = rows.iter().map(|&row| weights[row] * pressures[row]).sum();
            let cells = grid.cells().zip(&grid.cell_data["side"].values).filter(|(_, of)| **of as usize == number);
            let nodes: std::collections::BTreeSet<u32> = cells.flat_map(|(nodes, _)| nodes.iter().copied()).collect();
            let sum = |take: &dyn Fn(usize) -> f64| nodes.iter().map(|&node| take(node as usize)).sum::<f64>();
            let pressing = sum(&|node| of_array("weight")[node] * of_array("pressure")[node]);
            assert!((pressing - points).abs() <= 1e-10 * points.abs(), "{}: {pressing} {points}", side.name);
            let range = rows.iter().map(|&row| pressures[row]).fold([0.0f64; 2], |[a, b], p| [a.min(p), b.max(p)]);
            for &node in &nodes {
                let mean = of_array("pressure")[node as usize];
                assert!((range[0]..=range[1] * (1.0 + 1e-12)).contains(&mean), "{}: {mean} {range:?}", side.name);
            }
        }
    }

    /// The printed summary and the report show each figure in its unit with the words of its location.
    fn has_its_words(&self) {
        let rows = self.summary.rows();
        let (last, units) = (&self.summary.last, self.summary.units);
        let said = |name: &str, text: &str| {
            let of_name = rows.iter().filter(|(row, _)| row == name);
            assert!(of_name.clone().any(|(_, told)| told.contains(text)), "{name}: {text} in {rows:?}");
        };
        if let Some(most) = last.von_mises_max {
            said("von Mises stress", &Lives::Cell.after(&format!("up to {}", units.write(most, Measure::Stress))));
        }
        if let (Some(low), Some(high)) = (last.temperature_min, last.temperature_max) {
            let (low, high, unit) = units.range([low, high], Measure::Temperature);
            said("temperature", &Lives::Node.after(format!("{low} … {high} {unit}").trim_end()));
        }
        if let Some(contact) = last.contact.as_ref().filter(|c| c.open + c.stick + c.slip > 0) {
            let most = units.write(contact.pressure_max, Measure::Stress);
            said("contact force", &Lives::Point.after(&format!("pressure up to {most}")));
            said("contact", &units.write(contact.area, Measure::Area));
        }
        if self.case.problem.mesh.dim == 2 {
            self.has_its_pictures();
        }
        let page = fs::read_to_string(plot::report(&self.folder).unwrap()).unwrap();
        let page = page.replace("&quot;", "\"").replace("&#39;", "'").replace("&lt;", "<").replace("&gt;", ">");
        for (_, text) in &rows {
            assert!(page.contains(text.as_str()), "the report lacks {text}");
        }
    }
}

impl Ran {
    /// Extremes of nodal fields named in pictures of a plane body equal those of the files.
    fn has_its_pictures(&self) {
        let options = Options { times: vec![self.summary.time], ..Options::default() };
        let drawn: Vec<PathBuf> = plot::folder(&self.folder, &options).unwrap();
        let text = |kind: PictureKind| {
            let of_kind = drawn.iter().find(|path| path.ends_with(format!("{}.svg", kind.file_name())));
            of_kind.map(|path| fs::read_to_string(path).unwrap())
        };
        let length = |i: usize, u: &[Vec<f64>]| u.iter().map(|u| u[i].powi(2)).sum::<f64>().sqrt();
        let u = self.array("displacement");
        let lengths: Vec<f64> = (0..u.first().map_or(0, Vec::len)).map(|i| length(i, &u)).collect();
        let theta = self.array("temperature").into_iter().next().unwrap_or_default();
        for (kind, values, measure) in
            [(PictureKind::Deformed, lengths, Measure::Length), (PictureKind::Temperature, theta, Measure::Temperature)]
        {
            let Some(picture) = text(kind) else { continue };
            let ends = values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(*v), b.max(*v)]);
            let (low, high, unit) = self.summary.units.range(ends, measure);
            let said = Lives::Node.after(format!("min {low}, max {high} {unit}").trim_end()).replace('-', "−");
            assert!(picture.contains(&said), "{}: {} lacks {said}", self.summary.case, kind.file_name());
        }
    }
}

#[test]
fn one_value_has_one_name_one_unit_and_one_size() {
    let all = shown();
    for (path, overrides) in CASES {
        let ran = ran(path, overrides);
        ran.has_its_names(&all);
        ran.has_its_extremes(&all);
        ran.has_its_history();
        ran.has_its_sums();
        ran.has_its_words();
        fs::remove_dir_all(&ran.folder).unwrap();
    }
}

/// No two values of a table have one name, and each has a meaning.
#[test]
fn every_value_has_a_name_of_its_own_and_a_meaning() {
    let all = shown();
    for value in &all {
        let same = all.iter().filter(|other| (other.table, &other.name) == (value.table, &value.name)).count();
        assert_eq!(same, 1, "{} of {}", value.name, value.table.file());
        assert!(!value.meaning().is_empty(), "{} of {}", value.name, value.table.file());
    }
}
