//! A run with a tool that is read from a file: it goes on without it.

use std::fs;
use std::path::Path;
use std::time::Duration;

use amontons::case;
use amontons::run::{self, Settings};
use tempfile::tempdir;

use crate::common::{assert_code, assert_same_results, summary};
use crate::resume::{folder_of, interrupted, resume};

/// A block under a punch that is read from a file, comes down and turns.
const PUNCH: &str = r#"
name = "punch"
[mesh]
kind = "box"
size = [1.0, 0.5, 0.8]
n = [4, 2, 3]
elements = "Q1"
[time]
end = 1
steps = 8
[material]
density = 1
elasticity = { law = "isotropic", young = 20.0, poisson = 0.2 }
viscosity = { law = "lame", first = 1, second = 1 }
[[boundary]]
on = "bottom"
displacement = [0, 0, 0]
[contact]
on = "top"
obstacle = { shape = "file", file = "../tools/punch.stl", scale = 1e-3, origin = [0.2, "0.51 - 0.05*t", 0.2], geometry = "updated", turning = { angle = "0.3*t^2", axis = [0, 1, 0], about = [0.5, 0, 0.4] } }
normal = { law = "compliance", stiffness = 1e3 }
friction = { law = "coulomb", coefficient = 0.3 }
wear = { law = "archard", coefficient = 1e-3 }
"#;

/// A box in mm as a text of STL, twelve triangles.
fn box_of_triangles(size: [f64; 3]) -> String {
    let at = |corner: usize| [0, 1, 2].map(|c| if corner >> c & 1 == 1 { size[c] } else { 0.0 });
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let facet = |corners: [usize; 3]| {
        let vertices =
            corners.map(|corner| format!("vertex {}\n", at(corner).map(|x| x.to_string()).join(" "))).concat();
        format!("facet normal 0 0 0\nouter loop\n{vertices}endloop\nendfacet\n")
    };
    let facets = quads.map(|[a, b, c, d]| facet([a, b, c]) + &facet([a, c, d]));
    format!("solid punch\n{}endsolid punch\n", facets.concat())
}

/// The file of an obstacle is kept with the results: a run goes on to the same bits without it, and the case read back
/// from its results is the case that was run.
#[test]
fn an_obstacle_from_a_file_goes_on_to_the_same_bits() {
    let folder = tempdir().expect("a folder");
    let (cases, tools) = (folder.path().join("cases"), folder.path().join("tools"));
    fs::create_dir_all(&cases).expect("a folder");
    fs::create_dir_all(&tools).expect("a folder");
    fs::write(cases.join("punch.toml"), PUNCH).expect("a case");
    fs::write(tools.join("punch.stl"), box_of_triangles([600.0, 300.0, 400.0])).expect("a file");
    let case = case::read(&cases.join("punch.toml"), &[]).unwrap_or_else(|error| panic!("{error}"));
    let (whole, broken, again) =
        (folder.path().join("whole"), folder.path().join("broken"), folder.path().join("again"));
    let mut sink = folder_of(&case, &whole, Duration::from_mins(1));
    run::run(&case.problem, &Settings::default(), &mut [&mut sink]).expect("a run");
    drop(sink);
    interrupted(&case, &broken, 3);
    fs::remove_dir_all(&tools).expect("no tools any more");
    assert_code(&resume(&broken, &[]), 0);
    assert_same_results(&whole, &broken);
    assert!(whole.join("inputs/punch.stl").exists());
    let back = case::read(&whole.join("case.toml"), &[]).unwrap_or_else(|error| panic!("{error}"));
    let mut sink = folder_of(&back, &again, Duration::from_mins(1));
    run::run(&back.problem, &Settings::default(), &mut [&mut sink]).expect("a run");
    drop(sink);
    let history = |path: &Path| fs::read_to_string(path.join("history.csv")).expect("a history");
    assert_eq!(history(&whole), history(&again));
    let contact = &summary(&broken)["final"]["contact"];
    assert!(contact["wear_max"].as_f64().expect("a depth") > 1e-6 && contact["slip"].as_u64().expect("a number") > 0);
}
