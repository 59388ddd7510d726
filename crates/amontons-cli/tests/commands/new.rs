//! `amontons new`: cases to start from.

use std::fs;
use std::path::Path;

use crate::common::{amontons, assert_code, output, read, stderr, summary};
use serde_json::Value;
use tempfile::tempdir;

/// Runs a case that `new` writes with some arguments; no warning is printed.
fn made(folder: &Path, arguments: &[&str]) -> Value {
    let new = output(amontons(&[&["new", "made.toml"], arguments].concat()).current_dir(folder));
    assert_code(&new, 0);
    let run = output(amontons(&["run", "made.toml", "--out", "results"]).current_dir(folder));
    assert_code(&run, 0);
    assert!(!stderr(&run).contains("Warning"), "{arguments:?}: {}", stderr(&run));
    summary(&folder.join("results"))
}

/// The last value of a probe.
fn last(folder: &Path) -> f64 {
    let probes = read(&folder.join("results/probes.csv"));
    let value = probes.lines().last().and_then(|row| row.rsplit(',').next()).expect("a row");
    value.parse().expect("a number")
}

fn number(summary: &Value, pointer: &str) -> f64 {
    summary.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer} in {summary}"))
}

/// Lamé's pressure in a joint of rings of 20, 40 and 60 mm: p = E δ (b² − a²)(c² − b²)/(2 b³ (c² − a²)).
#[test]
fn the_press_fit_has_the_pressure_of_lame() {
    let folder = tempdir().expect("a folder");
    made(folder.path(), &["--template", "press-fit"]);
    let [a, b, c]: [f64; 3] = [0.01, 0.02, 0.03];
    let between = (b * b - a * a) * (c * c - b * b) / (2.0 * b.powi(3) * (c * c - a * a));
    let lame = 210e9 * 10e-6 * between;
    let found = last(folder.path());
    assert!((found / lame - 1.0).abs() < 0.02, "{found:e} {lame:e}");
}

/// All points slide at the end: friction is μ times the pressing force; wear and heat are those of its power.
#[test]
fn the_brake_slides_and_warms_up() {
    let folder = tempdir().expect("a folder");
    let summary = made(folder.path(), &["--template", "brake"]);
    let [x, y] = [0, 1].map(|c| number(&summary, &format!("/final/contact/force/{c}")));
    assert!((y / (2e6 * 0.06) - 1.0).abs() < 1e-6, "{y}");
    assert!((x / y - 0.36).abs() < 1e-9, "{x} {y}");
    assert!(last(folder.path()) > 20.0 && number(&summary, "/final/contact/wear_max") > 0.0);
}

/// Both flanges bear the same force, which is that of a strip that is squeezed between rough plates and more than that
/// of one between smooth ones.
#[test]
fn the_seal_is_squeezed_between_its_flanges() {
    let folder = tempdir().expect("a folder");
    let summary = made(folder.path(), &["--template", "seal"]);
    let [above, below] =
        ["top", "bottom"].map(|side| number(&summary, &format!("/final/contact/sides/{side}/force/1")));
    let smooth = 6e6 / (1.0 - 0.49 * 0.49) * 0.02 * 0.005;
    assert!((above + below).abs() < 1e-9 * below, "{above} {below}");
    assert!(below > 1.02 * smooth && below < 2.0 * smooth, "{below} {smooth}");
}

#[test]
fn the_paper_is_a_template() {
    let folder = tempdir().expect("a folder");
    let new = output(amontons(&["new", "made.toml", "--template", "paper"]).current_dir(&folder));
    assert_code(&new, 0);
    assert_eq!(read(&folder.path().join("made.toml")), include_str!("../../src/paper.toml"));
}

/// The sides and regions of a mesh file, whose unit is mm.
#[test]
fn a_mesh_file_becomes_a_case() {
    let folder = tempdir().expect("a folder");
    let deck = "*NODE\n1,0,0\n2,10,0\n3,20,0\n4,0,10\n5,10,10\n6,20,10\n*ELEMENT, TYPE=CPE4, ELSET=pad\n1,1,2,5,4\n\
        *ELEMENT, TYPE=CPE4, ELSET=plate\n2,2,3,6,5\n*SURFACE, NAME=end \"A\"\nplate, S2\n*SURFACE, NAME=foot\npad, S4\n";
    fs::create_dir(folder.path().join("meshes")).expect("a folder");
    for file in ["pad.inp", "meshes/pad.inp"] {
        fs::write(folder.path().join(file), deck).expect("a file");
        let new =
            output(amontons(&["new", "made.toml", "--template", "from-mesh", "--mesh", file]).current_dir(&folder));
        assert_code(&new, 0);
        let text = read(&folder.path().join("made.toml"));
        for part in ["20 × 10", "on = \"foot\"", "on = \"plate\"", "pad.inp\""] {
            assert!(text.contains(part), "{part}: {text}");
        }
        let run = output(amontons(&["run", "made.toml", "--set", "mesh.scale=1e-3"]).current_dir(&folder));
        assert_code(&run, 0);
        fs::remove_file(folder.path().join("made.toml")).expect("a file");
        fs::remove_dir_all(folder.path().join("results")).expect("a folder");
    }
    for (arguments, message) in [
        (&["--template", "from-mesh"][..], "--mesh <MESH>"),
        (&["--template", "from-mesh", "--mesh", "none.msh"], "none.msh"),
        (&["--template", "valve"], "possible values"),
    ] {
        let new = output(amontons(&[&["new", "made.toml"], arguments].concat()).current_dir(&folder));
        assert!(!new.status.success() && stderr(&new).contains(message), "{message}: {}", stderr(&new));
        assert!(!folder.path().join("made.toml").exists());
    }
}

/// Two blocks of one cell each that touch, beside each other along an axis: the case that is written has them as a
/// pair, presses them, and runs.
#[test]
fn a_case_of_two_bodies_has_their_pair() {
    for (swap, down) in [(false, "[0, -0.002]"), (true, "[-0.002, 0]")] {
        let folder = tempdir().expect("a folder");
        let at = |x: f64, y: f64| if swap { format!("{y},{x}") } else { format!("{x},{y}") };
        let places = [(0., 0.), (2., 0.), (2., 1.), (0., 1.), (0., 1.), (2., 1.), (2., 2.), (0., 2.)];
        let nodes: String = (1..).zip(places).map(|(number, (x, y))| format!("{number},{}\n", at(x, y))).collect();
        let stack = format!(
            "*NODE\n{nodes}*ELEMENT,TYPE=CPE4,ELSET=LOWER\n1,1,2,3,4\n*ELEMENT,TYPE=CPE4,ELSET=UPPER\n2,5,6,7,8\n\
             *SOLID SECTION,ELSET=LOWER\n*SOLID SECTION,ELSET=UPPER\n*SURFACE,NAME=HEAD\n2,S3\n*SURFACE,NAME=FOOT\n\
             1,S1\n*SURFACE,NAME=UNDER\n1,S3\n*SURFACE,NAME=OVER\n2,S1\n"
        );
        fs::write(folder.path().join("stack.inp"), stack).expect("a file");
        let run = |arguments: &[&str]| output(amontons(arguments).current_dir(&folder));
        assert_code(&run(&["new", "c.toml", "--template", "from-mesh", "--mesh", "stack.inp"]), 0);
        let text = read(&folder.path().join("c.toml"));
        let pressed = format!("on = \"HEAD\"\ndisplacement = {down}");
        for part in ["on = \"UNDER\"\nwith = \"OVER\"", "on = \"FOOT\"\ndisplacement = [0, 0]", &pressed] {
            assert!(text.contains(part), "{part} is not in\n{text}");
        }
        assert_code(&run(&["check", "c.toml"]), 0);
        assert_code(&run(&["run", "c.toml", "--quiet"]), 0);
        // Plane strain of two blocks of height 1: σ = −E/(1 − ν²) · 0.002/2 without friction across, a little more with
        // it.
        let contact = &summary(&folder.path().join("results/c"))["final"]["contact"];
        let force = contact["force"][usize::from(!swap)].as_f64().expect("a force").abs();
        let free = 210e9 / (1.0 - 0.3f64.powi(2)) * 1e-3 * 2.0;
        assert!(force > 0.99 * free && force < 1.4 * free, "{force} beside {free}");
    }
}
