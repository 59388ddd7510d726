//! Bodies at rest in given displacements and temperatures, and folders for their results.
#![allow(dead_code, reason = "each test uses a part")]

use std::fs;
use std::path::{Path, PathBuf};

use amontons::case::{self, Case, Source};
use amontons::material::StressState;
use amontons::output::{FolderOptions, OutputError, Probe, ProbePlace, ProbeSet, Quantity, RunStart, Sink};
use amontons::run::{Settings, run};
use amontons::tensor::Sym;

pub const YOUNG: f64 = 2.0;
pub const POISSON: f64 = 0.3;
pub const EXPANSION: f64 = 0.5;
pub const CONDUCTIVITY: f64 = 2.0;

/// A body at rest in the displacement and temperature given, nothing else.
pub fn text(mesh: &str, state: &str, displacement: &str, temperature: &str, more: &str) -> String {
    format!(
        "name = \"body\"\n[mesh]\n{mesh}\n[time]\nend = 1.0\nsteps = 1\n[material]\ndensity = 1.0\nheat_capacity = 1.0\nexpansion = {EXPANSION}\n\
         coupling = 0\nconductivity = {CONDUCTIVITY}\nelasticity = {{ law = \"isotropic\", young = {YOUNG}, poisson = {POISSON}{state} }}\n\
         viscosity = {{ law = \"lame\", first = 0.0, second = 0.0 }}\n[initial]\ndisplacement = {displacement}\ntemperature = {temperature}\n{more}"
    )
}

pub const PLANE_STRAIN: &str = ", stress_state = \"plane-strain\"";
pub const PLANE_STRESS: &str = ", stress_state = \"plane-stress\"";

pub fn parse(text: &str) -> Case {
    case::parse(&Source::new("body.toml", text), &[]).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

pub fn settings() -> Settings {
    Settings { certificate: false, ..Settings::default() }
}

/// A folder for the results of a test.
pub fn folder(name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("at_rest").join(name);
    let _ = fs::remove_dir_all(&path);
    path
}

pub fn options(case: &Case) -> FolderOptions {
    FolderOptions { every: 0, ..case.folder_options() }
}

/// A probe with the name of its quantity.
pub fn probe(quantity: &str, place: ProbePlace) -> Probe {
    Probe { name: quantity.to_owned(), quantity: Quantity::parse(quantity).unwrap(), place, about: None }
}

/// Probes read at t = 0.
pub fn read(case: &Case, probes: &[Probe]) -> Vec<f64> {
    struct Start(ProbeSet, Vec<f64>);
    impl Sink for Start {
        fn start(&mut self, start: &RunStart) -> Result<(), OutputError> {
            self.1 = self.0.values(&start.from);
            Ok(())
        }
    }
    let mut sink = Start(ProbeSet::new(&case.problem, probes).unwrap(), Vec::new());
    run(&case.problem, &settings(), &mut [&mut sink]).unwrap();
    assert_eq!(sink.1.len(), sink.0.columns().len());
    sink.1
}

pub fn hooke(dim: usize, plane: StressState, strain: &Sym, theta: f64) -> Sym {
    let shear = YOUNG / (2.0 * (1.0 + POISSON));
    let lambda = YOUNG * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON));
    if dim == 3 || plane == StressState::PlaneStrain {
        return (lambda * strain.trace() - EXPANSION * theta) * Sym::identity(3) + 2.0 * shear * *strain;
    }
    let in_plane = if dim == 1 { 0.0 } else { YOUNG * POISSON / (1.0 - POISSON * POISSON) };
    let factor = if dim == 1 { YOUNG } else { 2.0 * shear };
    (in_plane * strain.trace() - EXPANSION * theta) * Sym::identity(dim) + factor * *strain
}
