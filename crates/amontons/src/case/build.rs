//! Builds the [`Problem`] from the raw case and checks conditions that the schema cannot express.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use super::files::{Files, Loader};
use super::nearest::meant;
use super::path::{Doubtful, Path, Segment};
use super::physics::physics;
use super::place::{At, PathFault};
use super::raw;
use super::request::AskedAccuracy;
use super::schema::Limits;
use super::side_facts::SideFacts;
use super::side_names::SideNames;
use super::verify::{Expected, Verify};
use crate::contact::{Contact, Quadrature};
use crate::convergence::Exact;
use crate::expression::NamedConstants;
use crate::field::{Coefficient, Field};
use crate::linalg::{Automatic, Backend, Multigrid, Supernodal, Workload};
use crate::machine::FreeMemory;
use crate::mass::MassMatrix;
use crate::material::Material;
use crate::mesh::{Mesh, PlaneState, RefinementRounds, Skipped};
use crate::output::{CheckpointInterval, FieldsFormat, Input, OutputField, Probe};
use crate::problem::{Choice, Coupling, Initial, Physics, Problem, ProblemData, StartState};
use crate::stability::Search;
use crate::tensor::Point;
use crate::time::{Analysis, ContactRule, FrictionRule, PressureRule, Steps, TimePhase, TimeScheme, Timeline};
use crate::units::{TemperatureScale, UnitSystem};

/// Builds and checks the problem for a machine with this much memory, if known.
///
/// Findings at, below or above the doubtful paths of `notes` are ignored: their values are placeholders. With
/// `has_other_end` an override sets the end of the run, and times of checks may exceed it.
pub(super) fn problem(
    mut raw: raw::Case,
    files: &Files,
    available: Option<FreeMemory>,
    notes: SchemaNotes,
    has_other_end: bool,
) -> (Option<Built>, Vec<PathFault>) {
    let mut build = Build::new(&raw, files, notes, has_other_end);
    build.head(&raw);
    let mut mesh = build.mesh(&raw.mesh, &SideNames::new(&raw), available);
    build.dim = mesh.dim;
    build.thickness(raw.thickness, &mut mesh);
    let (physics, materials) = (physics(&raw, &mut build.findings), build.materials(&raw, &mesh));
    let (region_loads, temperature) = (build.region_loads(&raw, &mesh), build.temperature(&raw, &mesh));
    let (body_force, heat_source) = build.load_of_all(&raw, &mesh);
    let contacts = build.named_pairs(raw.contact.map_or_else(Vec::new, raw::Contacts::all), &mut mesh);
    build.places(&mut raw.boundary, &mut mesh);
    let boundary: Vec<_> = raw.boundary.into_iter().enumerate().map(|(i, b)| build.boundary(i, b, &mesh)).collect();
    let of_sides = SideFacts::new(&mesh, &materials, &boundary);
    let contacts = contacts.into_iter().map(|(path, c)| build.contact(&path, c, &mesh, &of_sides)).collect();
    let exact = raw.exact.map(|exact| build.exact(&exact, physics, &mesh.points));
    let mut data = ProblemData {
        name: raw.name,
        system: system(raw.units),
        temperature_scale: notes.scale,
        timeline: build.timeline.clone(),
        scheme: time_scheme(&raw.time),
        mass: mass(raw.time.mass),
        physics,
        materials,
        body_force,
        heat_source,
        region_loads,
        temperature,
        cyclic: build.cyclic(raw.cyclic),
        rigid: build.rigid(raw.rigid),
        boundary,
        contacts,
        initial: build.initial(&raw.initial, &mesh.points),
        coupling: coupling(raw.scheme.coupling),
        mesh: Arc::new(mesh),
        backend: Arc::new(Supernodal),
        chosen: std::mem::take(&mut build.chosen),
    };
    data.backend = backend(raw.solver.solver, &data);
    let (probes, stability) = (build.probes(&raw.probe, &data), build.stability(raw.stability));
    let accuracy = build.asked_accuracy(raw.accuracy, &probes, &data);
    let verify = raw.verify.map(|raw| build.verify(&raw, &data, exact.is_some()));
    let checked = data.check().map_err(|faults| build.findings.extend(faults.0.into_iter().map(PathFault::from)));
    let (findings, (inputs, references), skipped) = (build.certain(), build.loader.copies(), build.of_file.skipped);
    let rounds = build.rounds;
    let built =
        |problem| Built { problem, probes, accuracy, stability, exact, verify, inputs, references, skipped, rounds };
    (checked.ok().filter(|_| findings.is_empty()).map(built), findings)
}

/// The timeline of a case. A case without phases has both keys of `[time]`.
fn timeline(raw: &raw::Case) -> Timeline {
    let analysis = |raw: raw::PhaseAnalysis| match raw {
        raw::PhaseAnalysis::Dynamic => Analysis::Dynamic,
        raw::PhaseAnalysis::Quasistatic => Analysis::Quasistatic,
        raw::PhaseAnalysis::Steady => Analysis::Steady,
    };
    if raw.phase.is_empty() {
        let end = raw.time.end.unwrap_or(1.0);
        let single = Timeline::single(end, steps(raw.time.steps, raw.time.accuracy));
        return single.with_analysis(analysis(raw.time.analysis.unwrap_or_default()));
    }
    let all = raw.time.accuracy;
    let of = |raw: &raw::RunPhase| TimePhase {
        name: raw.name.clone(),
        end: raw.end,
        steps: steps(raw.steps, raw.accuracy.or(all)),
        analysis: analysis(raw.analysis),
    };
    Timeline::in_phases(raw.phase.iter().map(of).collect())
}

/// The steps of a phase. An accuracy that is missing is reported by [`Build::instants`].
pub(super) fn steps(raw: Option<raw::StepNumber>, accuracy: Option<f64>) -> Steps {
    match raw {
        Some(raw::StepNumber::Chosen(_)) => Steps::Automatic { accuracy: accuracy.unwrap_or(Steps::COARSEST) },
        Some(raw::StepNumber::Equal(steps)) => Steps::Equal(steps),
        None => Steps::Equal(1),
    }
}

fn system(raw: raw::Units) -> UnitSystem {
    match raw {
        raw::Units::Si => UnitSystem::Si,
        raw::Units::Dimensionless => UnitSystem::Dimensionless,
    }
}

fn backend(raw: raw::Backend, problem: &ProblemData) -> Arc<dyn Backend> {
    match raw {
        raw::Backend::Auto => Arc::new(Automatic::for_work(workload(problem))),
        raw::Backend::Direct => Arc::new(Supernodal),
        raw::Backend::Iterative => Arc::new(Multigrid::default()),
    }
}

/// Estimated work of a run. Linear laws need one factorization, others a tangent in each step, and a few if Newton's
/// method over the body is slow.
fn workload(problem: &ProblemData) -> Workload {
    let steps = problem.timeline.steps() as f64;
    let is_linear = problem.materials.iter().all(|m| m.elasticity.is_linear() && m.viscosity.is_linear());
    let joins = |contact: &Contact| contact.pair.is_some() || contact.quadrature != Quadrature::Nodal;
    Workload {
        factorizations: if is_linear { problem.timeline.lengths() as f64 } else { 3.0 * steps },
        steps,
        rubs: problem.contacts.iter().any(|contact| !contact.friction.is_frictionless()),
        joins: problem.contacts.iter().any(joins),
        slenderness: problem.mesh.slenderness(),
        is_plane: problem.mesh.dim < 3,
    }
}

fn mass(raw: raw::MassMatrix) -> MassMatrix {
    match raw {
        raw::MassMatrix::Consistent => MassMatrix::Consistent,
        raw::MassMatrix::Redistributed => MassMatrix::Redistributed,
    }
}

fn time_scheme(raw: &raw::Time) -> TimeScheme {
    match raw.scheme {
        raw::TimeScheme::Euler => TimeScheme::BackwardEuler,
        raw::TimeScheme::Bdf2 => TimeScheme::Bdf2,
        raw::TimeScheme::ContactStabilised => TimeScheme::ContactStabilised,
        raw::TimeScheme::Theta => {
            let contact = ContactRule {
                restitution: raw.restitution.unwrap_or(0.0),
                pressure: match raw.pressure {
                    Some(raw::PressureRule::Plain) => PressureRule::Plain,
                    Some(raw::PressureRule::Gradient) | None => PressureRule::Gradient,
                },
                friction: match raw.friction {
                    Some(raw::FrictionRule::End) => FrictionRule::End,
                    Some(raw::FrictionRule::Mean) | None => FrictionRule::Mean,
                },
            };
            TimeScheme::Theta { level: raw.theta.unwrap_or(0.5), contact }
        }
    }
}

fn coupling(raw: raw::Coupling) -> Coupling {
    match raw {
        raw::Coupling::Staggered => Coupling::Staggered,
        raw::Coupling::Extrapolated => Coupling::Extrapolated,
        raw::Coupling::FixedPoint => Coupling::FixedPoint,
        raw::Coupling::Monolithic => Coupling::Monolithic,
    }
}

/// Everything built from a case.
pub(super) struct Built {
    pub problem: Problem,
    pub probes: Vec<Probe>,
    /// The accuracy that is asked for.
    pub accuracy: Option<AskedAccuracy>,
    pub stability: Search,
    pub exact: Option<Exact>,
    pub verify: Option<Verify>,
    /// Copies of the files that it refers to.
    pub inputs: Vec<Input>,
    /// Keys that name files, with their values in the copied inputs.
    pub references: Vec<(Path, String)>,
    /// Content of the mesh file that is not used.
    pub skipped: Vec<Skipped>,
    /// The cells that `mesh.refined_cells` lists.
    pub rounds: Option<RefinementRounds>,
}

/// Fields of the snapshots, each once.
pub(super) fn fields(raw: &raw::Output) -> Vec<OutputField> {
    let mut fields = Vec::new();
    for field in &raw.fields {
        let field = match field {
            raw::OutputField::Stress => OutputField::Stress,
            raw::OutputField::Strain => OutputField::Strain,
            raw::OutputField::Principal => OutputField::Principal,
            raw::OutputField::HeatFlux => OutputField::HeatFlux,
            raw::OutputField::NodalStress => OutputField::NodalStress,
        };
        if !fields.contains(&field) {
            fields.push(field);
        }
    }
    fields
}

/// Format of the fields of a finished run.
pub(super) fn format(raw: &raw::Output) -> FieldsFormat {
    match raw.format {
        raw::FieldsFormat::Vtu => FieldsFormat::Vtu,
        raw::FieldsFormat::Vtkhdf => FieldsFormat::Vtkhdf,
        raw::FieldsFormat::Both => FieldsFormat::Both,
    }
}

/// The interval between checkpoints.
pub(super) fn checkpoint(raw: &raw::Output) -> CheckpointInterval {
    raw.checkpoint.map_or_else(CheckpointInterval::default, |raw| CheckpointInterval {
        steps: raw.steps,
        time: raw.seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()),
    })
}

/// The expected values of a case.
pub(super) fn expected(raw: &raw::Expected) -> Expected {
    let list = |values: &raw::Values| match values {
        raw::Values::One(value) => vec![*value],
        raw::Values::Several(values) => values.clone(),
    };
    let values = raw.values.iter().map(|(path, values)| (path.clone(), list(values))).collect();
    Expected { tolerance: raw.tolerance, values }
}

/// Results of the walk along the schema that the build needs.
#[derive(Clone, Copy)]
pub(super) struct SchemaNotes<'d> {
    /// Paths of placeholders.
    pub doubtful: &'d Doubtful,
    /// Limits for the values of expressions and tables.
    pub limits: &'d [(Path, Limits)],
    /// The scale of temperatures.
    pub scale: TemperatureScale,
}

/// Content of a mesh file apart from the mesh.
#[derive(Default)]
pub(super) struct OfFile {
    /// Stress state of a plane body, if the elements say it.
    pub plane: Option<PlaneState>,
    /// Content that is not used.
    pub skipped: Vec<Skipped>,
}

/// The state of the build of a problem.
pub(super) struct Build<'d> {
    pub findings: Vec<PathFault>,
    pub doubtful: &'d Doubtful,
    /// The numbers that keys admit.
    pub limits: &'d [(Path, Limits)],
    /// The constants that expressions may mention.
    pub constants: NamedConstants,
    /// The files beside the case.
    pub loader: Loader<'d>,
    /// The mesh file with the factor of its coordinates, or `None` for a generated mesh.
    pub mesh_file: Option<(String, f64)>,
    /// Content of the mesh file apart from the mesh.
    pub of_file: OfFile,
    /// The cells that `mesh.refined_cells` lists.
    pub rounds: Option<RefinementRounds>,
    /// Choices of the program where the case leaves them open.
    pub chosen: Vec<Choice>,
    /// True if there is no mesh, so that sides, regions and dimensions are unknown.
    pub no_mesh: bool,
    /// True if the case has no faults so far.
    pub is_sound: bool,
    /// Spatial dimension d.
    pub dim: usize,
    /// The solver of linear systems.
    pub solver: raw::Backend,
    /// The instants of the run, and true if an override sets T.
    pub timeline: Timeline,
    pub has_other_end: bool,
    /// Effect of densities.
    pub inertia: Inertia,
    /// The densities of the materials by their paths in the case, even if inertia is ignored.
    pub densities: BTreeMap<String, Coefficient<f64>>,
}

/// Effect of the inertia ρü.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Inertia {
    /// Inertia by the densities.
    Acts,
    /// Zero: every density counts as zero.
    Ignored,
}

impl<'d> Build<'d> {
    fn new(raw: &raw::Case, files: &'d Files, notes: SchemaNotes<'d>, has_other_end: bool) -> Build<'d> {
        Build {
            findings: Vec::new(),
            doubtful: notes.doubtful,
            limits: notes.limits,
            constants: raw.constants(),
            loader: Loader::new(files),
            of_file: OfFile::default(),
            rounds: None,
            chosen: Vec::new(),
            no_mesh: false,
            is_sound: notes.doubtful.is_empty(),
            mesh_file: raw.mesh.file().map(|(file, scale)| (file.to_owned(), scale)),
            dim: 2,
            solver: raw.solver.solver,
            timeline: timeline(raw),
            inertia: if raw.time.inertia { Inertia::Acts } else { Inertia::Ignored },
            densities: BTreeMap::new(),
            has_other_end,
        }
    }
}

impl Build<'_> {
    pub fn note(
        &mut self,
        path: &str,
        at: At,
        found: impl Into<String>,
        expected: impl Into<String>,
        hint: Option<&str>,
    ) {
        let path = Path::parse(path).unwrap_or_default();
        self.findings.push(PathFault::new(path, at, found, expected).hint(hint.map(str::to_owned)));
    }

    /// The findings that do not depend on placeholders.
    fn certain(&self) -> Vec<PathFault> {
        self.findings.iter().filter(|finding| !self.is_doubtful(&finding.path)).cloned().collect()
    }

    fn is_doubtful(&self, path: &Path) -> bool {
        if self.no_mesh && !["mesh", "name", "time", "phase"].iter().any(|table| path.is_in(table)) {
            return true;
        }
        // If a side could not be found, its placeholder is no side of the case.
        let of_sides = ["contact", "boundary", "cyclic", "rigid"].iter().any(|table| path.is_in(table));
        if of_sides && self.findings.iter().any(|finding| finding.path.is_in("side")) {
            return true;
        }
        let ends_with = |path: &Path, key: &str| path.0.last() == Some(&Segment::Key(key.to_owned()));
        // The supports of a body are unknown while a side of its contacts is unknown.
        let is_unknown_side = |finding: &PathFault| {
            finding.path.is_in("contact") && ["on", "with", "distance"].iter().any(|key| ends_with(&finding.path, key))
        };
        if path.0 == [Segment::Key("boundary".to_owned())] && self.findings.iter().any(is_unknown_side) {
            return true;
        }
        // A side cannot be looked up in an unknown mesh.
        (ends_with(path, "on") && self.doubtful.mesh_unknown) || self.doubtful.is_related(path)
    }

    /// The name and the steps.
    fn head(&mut self, raw: &raw::Case) {
        self.name(&raw.name);
        self.instants(raw);
        self.scheme_keys(&raw.time);
        self.constant_names(&raw.constants);
    }

    /// Notes names that no constant may have.
    fn constant_names(&mut self, raw: &BTreeMap<String, f64>) {
        for (name, value) in raw {
            if let Err(expected) = NamedConstants::default().add(name, *value) {
                self.note(&format!("constants.{name}"), At::Key, format!("`{name}`"), expected, None);
            }
        }
    }

    /// Checks the name, which also names a folder.
    fn name(&mut self, name: &str) {
        const LONGEST: usize = 100;
        const REFUSED: [char; 9] = ['/', '\\', ':', '*', '?', '"', '<', '>', '|'];
        let quoted = format!("\"{}\"", name.escape_debug());
        let found = if name.trim().is_empty() {
            "an empty name".to_owned()
        } else if let Some(c) = name.chars().find(|c| c.is_control() || REFUSED.contains(c)) {
            format!("`{}` in {quoted}", c.escape_debug())
        } else if name.starts_with('.') {
            format!("a dot before {quoted}")
        } else if name.ends_with([' ', '.']) || name.starts_with(' ') {
            format!("a blank or a dot at an end of {quoted}")
        } else if name.len() > LONGEST {
            format!("a name of {} bytes", name.len())
        } else {
            return;
        };
        let expected = "a name that a folder can have: letters, digits, `-`, `_`";
        self.note("name", At::Value, found, expected, Some("choose another name: results go to results/<name>"));
    }

    /// Sets the thickness of a plane body; other bodies cannot have one.
    fn thickness(&mut self, given: Option<f64>, mesh: &mut Mesh) {
        let (true, Some(_)) = (mesh.dim != 2 || mesh.axisymmetric, given) else {
            mesh.thickness = given;
            return;
        };
        let found = match mesh.dim {
            1 => "the thickness of a line",
            2 => "the thickness of a body of revolution",
            _ => "the thickness of a body in space",
        };
        self.note("thickness", At::Value, found, "one of a plane body", Some("remove it"));
    }

    /// Checks that the keys of a scheme stand beside it.
    fn scheme_keys(&mut self, time: &raw::Time) {
        if time.mass == raw::MassMatrix::Redistributed {
            // Other values are refused with the problem.
            let by_default = [
                ("restitution", time.restitution.is_some_and(|e| e.abs() <= 0.0), "0.0"),
                ("pressure", time.pressure == Some(raw::PressureRule::Gradient), "\"gradient\""),
                ("friction", time.friction == Some(raw::FrictionRule::Mean), "\"mean\""),
            ];
            for (key, _, found) in by_default.into_iter().filter(|(_, is, _)| *is) {
                let (path, found) = (format!("time.{key}"), format!("{found} with mass = \"redistributed\""));
                let expected = "no such key: the laws of contact hold at the end of the step";
                self.note(&path, At::Value, found, expected, Some(&format!("remove `{key}`")));
            }
        }
        if time.scheme != raw::TimeScheme::Theta {
            let given = [
                ("theta", time.theta.map(|theta| format!("{theta:?}"))),
                ("restitution", time.restitution.map(|e| format!("{e:?}"))),
                ("pressure", time.pressure.map(|word| word.quoted().to_owned())),
                ("friction", time.friction.map(|word| word.quoted().to_owned())),
            ];
            for (key, found) in given.iter().filter_map(|(key, found)| Some((*key, found.as_ref()?))) {
                let (path, hint) = (format!("time.{key}"), format!("add `scheme = \"theta\"`, or remove `{key}`"));
                let found = format!("{found} with the scheme {}", time.scheme.quoted());
                self.note(&path, At::Value, found, "a key of the scheme \"theta\"", Some(&hint));
            }
        }
    }

    /// The materials by region: its own, else that of `[material]`.
    fn materials(&mut self, raw: &raw::Case, mesh: &Mesh) -> Vec<Material> {
        let number = |on: &str| mesh.regions.iter().position(|name| name == on);
        let with_own = raw.region.iter().filter(|region| region.material.is_some());
        let taken: Vec<usize> = with_own.filter_map(|region| number(&region.on)).collect();
        let shared: Vec<usize> = (0..mesh.regions.len().max(1)).filter(|region| !taken.contains(region)).collect();
        let common = self.material(&raw.material, "material", mesh, &shared);
        let mut own: Vec<Option<Material>> = vec![None; mesh.regions.len().max(1)];
        let mut seen = vec![false; own.len()];
        for (i, region) in raw.region.iter().enumerate() {
            let prefix = format!("region[{i}].material");
            let regions: Vec<usize> = number(&region.on).into_iter().collect();
            let material = region.material.as_ref().map(|raw| self.material(raw, &prefix, mesh, &regions));
            let has_load = !region.body_force.is_empty()
                || !super::physics::is_zero_datum(&region.heat_source)
                || region.temperature.is_some();
            if region.material.is_none() && !has_load {
                let expected = "`material`, `body_force`, `heat_source` or `temperature`";
                self.note(&prefix, At::Missing, "no such key", expected, None);
            }
            let on = format!("region[{i}].on");
            match mesh.regions.iter().position(|name| *name == region.on) {
                None => {
                    let known: Vec<&str> = mesh.regions.iter().map(String::as_str).collect();
                    let hint = meant(&region.on, &known);
                    self.note(
                        &on,
                        At::Value,
                        format!("\"{}\"", region.on),
                        format!("one of the regions {}", known.join(", ")),
                        hint.as_deref(),
                    );
                }
                Some(number) if seen[number] => {
                    self.note(
                        &on,
                        At::Value,
                        format!("\"{}\" again", region.on),
                        "each region in one [[region]] entry",
                        None,
                    );
                }
                Some(number) => (own[number], seen[number]) = (material, true),
            }
        }
        // One material for all if no region has its own.
        if own.iter().all(Option::is_none) {
            return vec![common];
        }
        own.into_iter().map(|own| own.unwrap_or_else(|| common.clone())).collect()
    }

    fn exact(&mut self, raw: &raw::Exact, physics: Physics, points: &[Point]) -> Exact {
        if physics.has_mechanics() && raw.displacement.len() != self.dim {
            let found = format!("{} components", raw.displacement.len());
            self.note("exact.displacement", At::Value, found, format!("{} components", self.dim), None);
        }
        if physics.has_heat() && raw.temperature.is_none() {
            self.note(
                "exact.temperature",
                At::Missing,
                "no such key",
                "a number or an expression in x, y, z, t (temperature in K)",
                None,
            );
        }
        let mut displacement = self.scalars("exact.displacement", &raw.displacement, points);
        displacement.resize(self.dim, Field::ZERO);
        Exact {
            displacement,
            temperature: raw
                .temperature
                .as_ref()
                .map_or(Field::ZERO, |scalar| self.scalar("exact.temperature", scalar, points)),
        }
    }

    fn initial(&mut self, raw: &raw::Initial, points: &[Point]) -> Initial {
        let mut steady = |path: &str, scalar: &raw::Scalar| self.steady(path, scalar, points, "it holds at t = 0");
        let mut vector = |path: &str, all: &[raw::Scalar]| {
            all.iter().enumerate().map(|(c, scalar)| steady(&format!("{path}[{c}]"), scalar)).collect()
        };
        Initial {
            displacement: vector("initial.displacement", &raw.displacement),
            velocity: vector("initial.velocity", &raw.velocity),
            temperature: steady("initial.temperature", &raw.temperature),
            state: match raw.state {
                raw::Starting::Given => StartState::Given,
                raw::Starting::Equilibrium => StartState::Equilibrium,
            },
        }
    }
}

/// The nodes of a side, an edge or points; empty for a missing set, which is reported elsewhere.
pub(super) fn side(mesh: &Mesh, name: &str) -> Vec<Point> {
    let nodes = mesh.named(name).map(crate::mesh::FacetSet::node_list).unwrap_or_default();
    nodes.iter().filter_map(|&n| mesh.points.get(n as usize).copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mesh_that_does_not_fit_into_memory_is_refused() -> Result<(), toml::de::Error> {
        let raw: raw::Case = toml::from_str(crate::case::STARTER)?;
        let (doubtful, memory) = (Doubtful::default(), FreeMemory { bytes: 2e6, limit: None });
        let notes = SchemaNotes { doubtful: &doubtful, limits: &[], scale: TemperatureScale::Kelvin };
        let (problem, findings) = problem(raw, &Files::None, Some(memory), notes, false);
        let said: Vec<String> = findings.iter().map(|f| format!("{}: {}, {}", f.path, f.found, f.expected)).collect();
        let expected = "mesh.n: 32 × 16 cells: 1683 unknowns, which need about 2.21 MB, a mesh for the 2.00 MB of memory that are free";
        assert_eq!(said, [expected]);
        assert!(problem.is_none());
        Ok(())
    }
}
