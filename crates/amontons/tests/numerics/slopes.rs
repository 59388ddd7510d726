//! Derivatives of eigenvalues by keys of a case against central differences of whole searches, each with its own steady
//! state, and the derivatives of critical speeds.

use std::f64::consts::{PI, TAU};

use amontons::adjoint::Parameter;
use amontons::case::{self, Case, Source};
use amontons::run::{ModeSlopesError, Settings, modes_with};
use amontons::stability::{Mode, ModeKind, Modes, Search};
use faer::c64;

use crate::common::file;

/// A case with the text that its keys are in.
struct KeyedCase {
    source: Source,
    overrides: Vec<String>,
    search: Search,
}

impl KeyedCase {
    fn shipped(path: &str, overrides: &[&str], search: Search) -> KeyedCase {
        let text = std::fs::read_to_string(file(path)).unwrap_or_else(|error| panic!("{path}: {error}"));
        KeyedCase::new(text, overrides, search)
    }

    fn new(text: String, overrides: &[&str], search: Search) -> KeyedCase {
        let overrides = overrides.iter().map(|&of| of.to_owned()).collect();
        KeyedCase { source: Source::new("case.toml", text), overrides, search }
    }

    fn case(&self, more: &[String]) -> Case {
        let all = [&self.overrides[..], more].concat();
        case::parse(&self.source, &all).unwrap_or_else(|error| panic!("{error}"))
    }

    fn with(&self, keys: &[&str]) -> Result<Modes, ModeSlopesError> {
        let parameter = |key: &&str| case::parameter(&self.source, &self.overrides, key).expect("a key");
        let parameters: Vec<Parameter> = keys.iter().map(parameter).collect();
        Ok(modes_with(&self.case(&[]).problem, &self.search, &parameters, &quick(), None)?.modes)
    }

    /// The modes with another number at a key.
    fn at(&self, key: &str, value: f64) -> Modes {
        let case = self.case(&[format!("{key}={value:?}")]);
        let found = modes_with(&case.problem, &self.search, &[], &quick(), None);
        found.unwrap_or_else(|error| panic!("{key}: {error}")).modes
    }

    /// Asserts that derivatives are the limit of central differences of the search, of second order: the largest
    /// difference over all modes, relative to |λ|/|m|, at two steps.
    fn assert_slopes(&self, keys: &[&str], step: f64) -> Modes {
        let found = self.with(keys).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(found.missing(), 0);
        for (k, key) in keys.iter().enumerate() {
            let value = found.parameters[k].1;
            let scale = if value.abs() > 0.0 { value.abs() } else { 1.0 };
            let errors = [1.0, 0.5].map(|part| {
                let h = part * step * scale;
                let [low, high] = [-h, h].map(|h| self.at(key, value + h));
                worst(&found, k, [&low, &high], h, scale)
            });
            let order = (errors[0] / errors[1]).log2();
            let is_round_off = errors[1] < 1e-8;
            assert!(is_round_off || (order - 2.0).abs() < 0.1 && errors[1] < 0.1, "{key}: {errors:?}, order {order}");
        }
        found
    }
}

fn quick() -> Settings {
    Settings { certificate: false, ..Settings::default() }
}

/// The largest difference of the derivatives by parameter `k` and those of the searches at both sides.
fn worst(found: &Modes, k: usize, [low, high]: [&Modes; 2], h: f64, scale: f64) -> f64 {
    let mut worst = 0.0f64;
    for (i, mode) in found.modes.iter().enumerate() {
        let [growth, frequency] = mode.slopes[k].unwrap_or_else(|| panic!("mode {i} has no derivative"));
        // The mode nearest to where the derivative leads.
        let near = |all: &Modes, h: f64| -> [f64; 2] {
            let at = [mode.growth + h * growth, mode.frequency + h * frequency];
            let off = |other: &&Mode| (other.growth - at[0]).hypot(other.frequency - at[1]);
            let same = all.modes.iter().filter(|other| other.waves == mode.waves);
            let nearest = same.min_by(|a, b| off(a).total_cmp(&off(b))).expect("a mode");
            [nearest.growth, nearest.frequency]
        };
        let [low, high] = [near(low, -h), near(high, h)];
        let off = [growth - (high[0] - low[0]) / (2.0 * h), frequency - (high[1] - low[1]) / (2.0 * h)];
        worst = worst.max(off[0].hypot(off[1]) * scale / mode.growth.hypot(mode.frequency));
    }
    worst
}

fn search(kind: ModeKind, count: usize) -> Search {
    Search { kind: Some(kind), count, hertz: None, growth: None, waves: None }
}

fn within(growth: [f64; 2], frequency: [f64; 2], waves: Option<Vec<usize>>) -> Search {
    let hertz = Some(frequency.map(|rate| rate / TAU));
    Search { kind: Some(ModeKind::Squeal), count: 1, hertz, growth: Some(growth), waves }
}

/// A sector of the ring of `benchmarks/squeal-ring.toml` with waves that run in both senses: friction, damping and the
/// radius of the drum, on which normals do not depend but all lengths do.
#[test]
fn a_sector_of_a_ring_has_the_slopes_of_its_differences() {
    let overrides = [
        &format!("mesh.angle={:?}", TAU / 9.0)[..],
        "mesh.n=[3, 2]",
        "mesh.elements=\"Q1\"",
        "cyclic=[{ sides = [\"start\", \"end\"] }]",
    ];
    let ring = "crates/amontons/benchmarks/squeal-ring.toml";
    let sector = KeyedCase::shipped(ring, &overrides, within([0.01, 1.0], [0.0, 5.0], Some(vec![0, 1, 2])));
    let keys = ["contact.friction.coefficient", "material.viscosity.second", "mesh.radii[0]", "material.density"];
    let found = sector.assert_slopes(&keys, 0.01);
    let runs = |sign: i64| found.modes.iter().any(|mode| mode.waves.is_some_and(|waves| sign * waves > 0));
    assert!(found.modes.len() >= 4 && runs(1) && runs(-1), "{:?}", found.counts);
    // The whole ring has each mode twice or as pairs of both senses, with the same derivatives.
    let whole =
        KeyedCase::shipped(ring, &["mesh.n=[3, 18]", "mesh.elements=\"Q1\""], within([0.01, 1.0], [0.0, 5.0], None));
    let of_whole = whole.with(&keys).unwrap_or_else(|error| panic!("{error}"));
    for mode in &found.modes {
        let off = |other: &&Mode| (other.growth - mode.growth).hypot(other.frequency - mode.frequency);
        let same = of_whole.modes.iter().min_by(|a, b| off(a).total_cmp(&off(b))).expect("a mode");
        for (a, b) in mode.slopes.iter().zip(&same.slopes) {
            let (a, b) = (a.expect("a slope"), b.expect("a slope"));
            let scale = a[0].hypot(a[1]);
            assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-7 * scale, "{:?}: {a:?}, {b:?}", mode.waves);
        }
    }
}

/// A ring without friction has its modes in pairs. Poisson's ratio keeps them; a density that grows along one axis
/// parts those of one wave, each by as much.
#[test]
fn pairs_of_a_ring_have_the_slopes_of_their_differences() {
    let overrides = [
        "mesh.n=[2, 8]",
        "mesh.elements=\"Q1\"",
        "contact.friction.coefficient=0",
        "constants.bump=0.0",
        "material.density=\"1 + bump*(x^2 - y^2)\"",
    ];
    let ring = "crates/amontons/benchmarks/squeal-ring.toml";
    let whole = KeyedCase::shipped(ring, &overrides, within([-1.0, 1.0], [0.5, 3.2], None));
    let found = whole.assert_slopes(&["material.elasticity.poisson", "constants.bump"], 0.005);
    let is_pair = |pair: &&[Mode]| (pair[0].frequency - pair[1].frequency).abs() < 1e-9 * pair[0].frequency;
    let pairs: Vec<&[Mode]> = found.modes.windows(2).filter(is_pair).collect();
    assert!(pairs.len() >= 2, "{} modes", found.modes.len());
    let apart = |pair: &&[Mode]| {
        let [a, b] = [0, 1].map(|of| pair[of].slope(1).expect("a slope")[1]);
        (a - b).abs() > 1e-2 && (a + b).abs() < 1e-7
    };
    assert!(pairs.iter().any(apart), "{pairs:?}");
}

/// A block that is turned off the axes, rigid or on a layer: laws, loads, material, the belt and the mesh. The keys
/// change the steady state as well: the drag in space depends on its pressures.
#[test]
fn a_turned_block_has_the_slopes_of_its_differences() {
    for normal in ["{ law = \"damped\", stiffness = 1.5, damping = 0.02 }", "{ law = \"signorini\" }"] {
        let text = format!(
            r#"
name = "turned"
units = "dimensionless"
[constants]
press = 0.05
belt = 0.5
[mesh]
kind = "blocks"
[[mesh.blocks]]
name = "block"
size = [1.0, 0.7, 0.6]
n = [2, 2, 1]
elements = "Q1"
turn = {{ angle = 0.4, axis = [0, 0, 1] }}
[time]
end = 1.0
analysis = "steady"
[material]
density = 1.0
elasticity = {{ law = "isotropic", young = 1.0, poisson = 0.3 }}
viscosity = {{ law = "lame", first = 0.002, second = 0.004 }}
prony = [{{ ratio = 0.02, time = 0.7 }}]
[[boundary]]
on = "block_top"
displacement = ["press*sin(0.4)", "-press*cos(0.4)", 0]
[contact]
on = "block_bottom"
normal = {normal}
friction = {{ law = "static-kinetic", static = 0.6, kinetic = 0.45, decay_speed = 0.3 }}
foundation_velocity = ["belt*cos(0.4)", "belt*sin(0.4)", 0.2]
"#
        );
        let mut search = within([-1.0, 1.0], [0.2, 2.5], None);
        search.count = 4;
        let block = KeyedCase::new(text, &[], search);
        let keys = [
            "constants.press",
            "constants.belt",
            "contact.friction.kinetic",
            "material.elasticity.young",
            "material.prony[0].time",
            "mesh.blocks[0].size[1]",
        ];
        let found = block.assert_slopes(&keys, 0.01);
        assert!(found.modes.len() >= 3, "{normal}: {} modes", found.modes.len());
        // The pressing acts through the steady state alone.
        let most = found.modes.iter().filter_map(|mode| mode.slopes[0]).map(|slope| slope[0].abs());
        assert!(most.fold(0.0, f64::max) > 1e-4, "{normal}");
    }
}

/// Hot spots of a layer, with drag that grows with the pressure of the steady state.
#[test]
fn hot_spots_have_the_slopes_of_their_differences() {
    let overrides = [
        "time.end=1e-12",
        "time.steps=1",
        "initial.temperature=0",
        "constants.press=0.1",
        "boundary[2].displacement=[\"free\", \"-press\"]",
    ];
    let path = "crates/amontons/tests/reference/stability/tei-a-symmetry-rigid-Q1.toml";
    let layer = KeyedCase::shipped(path, &overrides, search(ModeKind::Thermal, 4));
    let keys = [
        "constants.press",
        "contact.friction.coefficient",
        "contact.foundation_velocity[2]",
        "contact.heat.conductance",
        "material.conductivity",
        "material.elasticity.young",
    ];
    let found = layer.assert_slopes(&keys, 0.01);
    assert!(found.modes.iter().all(|mode| mode.slopes.iter().flatten().all(|slope| slope[1].abs() <= 0.0)));
}

/// A key at whose value contact points close or data have a kink is refused with its name; where points close within
/// the step, the step is reduced.
#[test]
fn keys_at_a_change_of_the_contact_are_refused() {
    let path = "crates/amontons/tests/reference/stability/block-a-compliance.toml";
    let block = |more: &[&str]| {
        let first = ["time.analysis=\"steady\"", "time.steps=1"];
        KeyedCase::shipped(path, &[&first[..], more].concat(), search(ModeKind::Squeal, 4))
    };
    let press = "boundary[0].displacement=[0, \"-press\"]";
    let kink = "material.density=\"1 + max(bump, 0)\"";
    for (more, key, told) in [
        ([press, "constants.press=0.0"], "constants.press", "contact points change between open, stick and slip"),
        ([kink, "constants.bump=0.0"], "constants.bump", "have a kink"),
    ] {
        let error = block(&more).with(&[key]).expect_err("a refusal").to_string();
        assert!(error.starts_with(key) && error.contains(told), "{error}");
    }
    // From this friction on a corner opens (squeal.json); a little below it all points are closed.
    let [opens, below] = [0.800_776_423_971_016_7, 0.800_676];
    assert_eq!(block(&[]).at("contact.friction.coefficient", opens - 1e-9).points[0], 0);
    assert!(block(&[]).at("contact.friction.coefficient", opens + 1e-9).points[0] > 0);
    let near = block(&[&format!("contact.friction.coefficient={below:?}")]);
    let found = near.with(&["contact.friction.coefficient"]).unwrap_or_else(|error| panic!("{error}"));
    let h = 2e-5;
    let [low, high] = [-h, h].map(|h| near.at("contact.friction.coefficient", below + h));
    assert!(worst(&found, 0, [&low, &high], h, 1.0) < 1e-5);
}

/// A half-plane (S21), as a layer three wave lengths of two cosine halves deep: cosine hot spots of wave number
/// m = π/width between insulated symmetric sides, on a foundation that slides out of the plane.
fn half_plane(cells: usize) -> KeyedCase {
    let text = format!(
        r#"
name = "half-plane"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.0, 3.0]
n = [{cells}, {}]
elements = "Q2"
[time]
end = 1e-12
steps = 1
[material]
density = 0.0
heat_capacity = 1.0
conductivity = 1.3
expansion_coefficient = 0.7
elasticity = {{ law = "isotropic", young = 2.0, poisson = 0.3, stress_state = "plane-strain" }}
[[boundary]]
on = "left"
displacement = [0, "free"]
[[boundary]]
on = "right"
displacement = [0, "free"]
[[boundary]]
on = "top"
displacement = ["free", -1e-13]
[contact]
on = "bottom"
normal = {{ law = "signorini" }}
friction = {{ law = "coulomb", coefficient = 0.4 }}
foundation_velocity = [0, 0, 1.0]
frictional_heat = 1.0
"#,
        3 * cells
    );
    KeyedCase::new(text, &[], search(ModeKind::Thermal, 3))
}

/// The mode of largest growth that is not uniform, which grows at every speed where nothing cools.
fn cosine(modes: &Modes) -> &Mode {
    let varies = |mode: &&Mode| {
        let of = |at: fn(f64, f64) -> f64| mode.temperature.iter().map(|t| t[0]).fold(0.0, at);
        of(f64::min) < -0.1 * of(f64::max)
    };
    modes.modes.iter().find(varies).expect("a mode that varies")
}

const SPEED: &str = "contact.foundation_velocity[2]";

/// The speed at which the cosine mode of a case neither grows nor decays, by the secant.
fn critical_speed(of: &KeyedCase, mut at: [f64; 2]) -> f64 {
    let growth = |speed: f64| cosine(&of.at(SPEED, speed)).growth;
    let mut values = at.map(growth);
    for _ in 0..20 {
        let next = at[1] - values[1] * (at[1] - at[0]) / (values[1] - values[0]);
        (at, values) = ([at[1], next], [values[1], growth(next)]);
        if (at[1] - at[0]).abs() < 1e-12 * at[1] {
            break;
        }
    }
    at[1]
}

/// The relative derivatives of the critical speed of hot spots (S21, Burton): V_c = 2 k m (1 − ν)/(f α E), so −1 by f,
/// α and E and +1 by k and m. The discrete problem has the first four exactly, and −1 by all lengths together; the one
/// by the width at a fixed depth, −1 of m, with the order of the mesh.
#[test]
fn critical_speeds_of_hot_spots_scale_as_their_formula_says() {
    let exact = 2.0 * 1.3 * PI * 0.7 / (0.4 * 0.7 * 2.0);
    let errors = [2, 4, 8].map(|cells| {
        let of = half_plane(cells);
        let speed = critical_speed(&of, [0.98 * exact, 1.01 * exact]);
        let at = KeyedCase { overrides: vec![format!("{SPEED}={speed:?}")], ..of };
        let keys = [
            SPEED,
            "contact.friction.coefficient",
            "material.expansion_coefficient",
            "material.elasticity.young",
            "material.conductivity",
            "mesh.size[0]",
            "mesh.size[1]",
        ];
        let found = at.with(&keys).unwrap_or_else(|error| panic!("{error}"));
        let by = |k: usize| cosine(&found).slope(k).expect("a slope")[0];
        let relative = |k: usize| -by(k) / by(0) * found.parameters[k].1 / speed;
        for (k, expected) in [(1, -1.0), (2, -1.0), (3, -1.0), (4, 1.0)] {
            assert!((relative(k) - expected).abs() < 1e-9, "{}: {}", keys[k], relative(k));
        }
        let both = relative(5) + relative(6);
        assert!((both + 1.0).abs() < 1e-9, "lengths: {both}");
        [(speed / exact - 1.0).abs(), (relative(5) + 1.0).abs()]
    });
    for error in 0..2 {
        let orders = [0, 1].map(|k| (errors[k][error] / errors[k + 1][error]).log2());
        assert!(orders[1] > 3.5, "{errors:?}: {orders:?}");
    }
}

/// Hot spots of the half-plane with wear (Dow and Burton, Wear 20 (1972) 297), which takes off where they press: with
/// z² = m² + bC/K they grow as
///
/// ```text
/// K z (z + m) (b + G m κV/(1 − ν)) = f V E α m/(1 − ν) b
/// ```
#[test]
fn wear_slows_hot_spots_as_its_formula_says() {
    let (m, k, wear) = (PI, 1.3, 0.02);
    let speed = 2.0 * 2.0 * k * m * 0.7 / (0.4 * 0.7 * 2.0);
    let residual = |b: f64| {
        let z = (m * m + b / k).sqrt();
        let shear = 2.0 / 2.6;
        k * z * (z + m) * (b + shear * m * wear * speed / 0.7) - 0.4 * speed * 2.0 * 0.7 * m / 0.7 * b
    };
    // Without wear b is the root of the same equation with b divided out; with it two roots are positive.
    let (mut low, mut high) = (10.0, 40.0);
    assert!(residual(low) < 0.0 && residual(high) > 0.0);
    while high - low > 1e-13 * high {
        let middle = 0.5 * (low + high);
        *(if residual(middle) < 0.0 { &mut low } else { &mut high }) = middle;
    }
    let errors = [4, 8, 16].map(|cells| {
        let of = half_plane(cells);
        let overrides =
            vec![format!("{SPEED}={speed:?}"), format!("contact.wear={{ law = \"archard\", coefficient = {wear} }}")];
        let found = KeyedCase { overrides, ..of }.with(&["contact.wear.coefficient"]).unwrap_or_else(|e| panic!("{e}"));
        let mode = cosine(&found);
        assert!(mode.slope(0).expect("a slope")[0] < 0.0 && found.missing() == 0);
        (mode.growth - low).abs() / low
    });
    let orders = [0, 1].map(|k| (errors[k] / errors[k + 1]).log2());
    assert!(errors[2] < 1e-4 && (orders[1] - 4.0).abs() < 0.3, "{low}: {errors:?}, {orders:?}");
}

/// A bar that is clamped at one end and pressed on a foundation that slides across it and wears it off: the foundation
/// damps as a dashpot of 1/(κV). With Z = √(Eρ) and a layer of stiffness c, tanh λ = −Z (κV + λ/c) for unit length and
/// wave speed; the error is of second order in the cells.
#[test]
fn a_bar_that_wears_off_is_damped_as_its_formula_says() {
    for (normal, compliance) in [("{ law = \"signorini\" }", 0.0), ("{ law = \"compliance\", stiffness = 4.0 }", 0.25)]
    {
        let (one, wear) = (c64::new(1.0, 0.0), 0.3);
        let residual = |l: c64| l.tanh() + one * wear + l * compliance;
        let root = |mut l: c64| {
            for _ in 0..60 {
                l -= residual(l) / (one - l.tanh() * l.tanh() + compliance);
            }
            assert!(residual(l).norm() < 1e-9, "{l}");
            l
        };
        let errors = [20, 40].map(|n| {
            let text = format!(
                r#"
name = "bar"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1.0, 0.1]
n = [{n}, 1]
elements = "Q1"
[time]
end = 1e-9
analysis = "quasistatic"
steps = 1
[material]
density = 1.0
elasticity = {{ law = "isotropic", young = 1.0, poisson = 0.0, stress_state = "plane-strain" }}
[[boundary]]
on = "left"
displacement = [1e-9, 0]
[contact]
on = "right"
normal = {normal}
friction = {{ law = "coulomb", coefficient = 0.2 }}
foundation_velocity = [0, 0, 1.0]
wear = {{ law = "archard", coefficient = {wear} }}
[[boundary]]
on = "bottom"
displacement = ["free", 0]
[[boundary]]
on = "top"
displacement = ["free", 0]
"#
            );
            let of = KeyedCase::new(text, &[], search(ModeKind::Squeal, 4));
            let found = of.with(&["contact.wear.coefficient"]).unwrap_or_else(|error| panic!("{error}"));
            // Sides that move apart along the face relax too, at a frequency of 0.
            let off = |exact: c64| {
                let off = |mode: &Mode| (c64::new(mode.growth, mode.frequency) - exact).norm() / exact.norm();
                found.modes.iter().map(off).fold(f64::INFINITY, f64::min)
            };
            (0..3).map(|k| off(root(c64::new(-wear, PI * f64::from(k))))).fold(0.0, f64::max)
        });
        let order = (errors[0] / errors[1]).log2();
        assert!(errors[1] < 1e-2 && (order - 2.0).abs() < 0.1, "{normal}: {errors:?}, order {order}");
    }
}
