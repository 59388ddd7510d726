//! `run --accuracy`: meshes that are refined until the error is as small as asked.
#![allow(clippy::too_many_lines, reason = "a test is one list of cases")]

use std::fs;
use std::path::Path;
use std::process::Command;

use super::studies::{amontons, paper, text};

const PRESSED: &str = r#"
name = "pressed"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [2.0, 1.0]
n = [4, 2]
elements = "ELEMENTS"
[time]
end = 1.0
steps = 2
[material]
density = 0.0
elasticity = { law = "isotropic", young = 1.0, poisson = 0.3, stress_state = "plane-strain" }
[[boundary]]
on = "top"
displacement = [0.0, "-0.1*t"]
[contact]
on = "bottom"
gap = "0.05*x"
normal = { law = "signorini" }
"#;

/// A block that is pressed on a wedge: the mesh becomes finer at the contact edge and at the corners until the bound is
/// small. The last run is an ordinary one, which its own case repeats and refines further.
#[test]
fn run_refines_until_the_error_is_as_small_as_asked() {
    let folder = tempfile::tempdir().expect("a folder");
    for (elements, asked) in [("P2", "0.02"), ("Q1", "0.06")] {
        let case = folder.path().join("pressed.toml");
        fs::write(&case, PRESSED.replace("ELEMENTS", elements)).expect("a case");
        let [out, again, finer] =
            ["out", "again", "finer"].map(|name| folder.path().join(format!("{name}-{elements}")));
        let run = |case: &Path, out: &Path, more: &[&str]| {
            let (case, out) = (case.display().to_string(), out.display().to_string());
            let done = amontons(&[&["run", &case, "--out", &out], more].concat());
            assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
            String::from_utf8_lossy(&done.stdout).into_owned()
        };
        let told = run(&case, &out, &["--accuracy", asked]);
        let history = |out: &Path| -> Vec<Vec<f64>> {
            let rows = text(&out.join("accuracy.csv"));
            rows.lines().skip(1).map(|row| row.split(',').map(|n| n.parse().expect("a number")).collect()).collect()
        };
        let rows = history(&out);
        println!("{told}\n{rows:?}");
        let (first, last, asked) = (&rows[0], &rows[rows.len() - 1], asked.parse::<f64>().expect("a number"));
        assert!(rows.len() > 3 && last[3] <= asked && rows[rows.len() - 2][3] > asked, "{rows:?}");
        assert!(rows.windows(2).all(|pair| pair[1][1] > pair[0][1]) && first[5] > 0.0, "{rows:?}");
        // Uniform cells would be far more: the error of the corners falls with the root of the size.
        let uniform = first[1] * (first[3] / asked).powi(2);
        assert!(elements == "Q1" || last[1] < 0.5 * uniform, "{} cells, uniform {uniform}", last[1]);
        let kept = text(&out.join("case.toml"));
        assert!(kept.contains("refined_cells = \"inputs/refined-cells.txt\""), "{kept}");
        run(&out.join("case.toml"), &again, &[]);
        assert_eq!(text(&out.join("history.csv")), text(&again.join("history.csv")));
        run(&out.join("case.toml"), &finer, &["--accuracy", &(0.7 * asked).to_string()]);
        let more = history(&finer);
        assert!(more[0][1..] == last[1..] && more.len() > 1, "{more:?}");
    }
    // Before the mesh is found there is nothing to keep: Ctrl-C ends the program at once, between two meshes, too.
    #[cfg(unix)]
    {
        let case = folder.path().join("endless.toml");
        fs::write(&case, PRESSED.replace("ELEMENTS", "P2")).expect("a case");
        let [case, out] = [&case, &folder.path().join("endless")].map(|path| path.display().to_string());
        let mut run = Command::new(env!("CARGO_BIN_EXE_amontons"));
        run.args(["run", &case, "--accuracy", "1e-12", "--out", &out, "--progress", "none"]);
        let mut run =
            run.stdout(std::process::Stdio::piped()).stderr(std::process::Stdio::piped()).spawn().expect("a run");
        let mut line = String::new();
        let mut told = std::io::BufReader::new(run.stdout.take().expect("a pipe"));
        // A number of meshes is done.
        while !line.starts_with("    6 ") {
            line.clear();
            assert!(std::io::BufRead::read_line(&mut told, &mut line).expect("a line") > 0, "it ended by itself");
        }
        Command::new("kill").args(["-INT", &run.id().to_string()]).status().expect("kill");
        assert_eq!(run.wait().expect("an end").code(), Some(130));
        assert!(!Path::new(&out).exists());
    }
    // Without a bound there is a reason and a way out.
    let out = folder.path().join("none").display().to_string();
    let done = amontons(&["run", &paper(), "--set", "mesh.n=4", "--accuracy", "0.1", "--out", &out]);
    let told = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(
        done.status.code() == Some(2) && told.contains("no bound here: ") && told.contains("(--of with a probe)"),
        "{told}"
    );
    let done = amontons(&["run", &paper(), "--accuracy", "5", "--out", &out]);
    assert!(String::from_utf8_lossy(&done.stderr).contains("between 0 and 1"));
    assert!(!folder.path().join("none").exists());
}

/// The same block: numbers with their bars, on meshes and with steps that are as fine as they need. The last run is an
/// ordinary one, which its own case repeats.
#[test]
fn run_refines_until_numbers_are_as_accurate_as_asked() {
    let folder = tempfile::tempdir().expect("a folder");
    let case = folder.path().join("pressed.toml");
    let probe = "[[probe]]\nname = \"p\"\nquantity = \"pressure\"\nat = [0.3, 0.0]\n";
    fs::write(&case, PRESSED.replace("ELEMENTS", "P1") + probe).expect("a case");
    let [out, again] = ["out", "again"].map(|name| folder.path().join(name));
    let run = |case: &Path, out: &Path, more: &[&str]| {
        let (case, out) = (case.display().to_string(), out.display().to_string());
        amontons(&[&["run", &case, "--out", &out], more].concat())
    };
    let done = run(&case, &out, &["--accuracy", "0.01", "--of", "p,elastic"]);
    let told = String::from_utf8_lossy(&done.stdout).into_owned();
    assert_eq!(done.status.code(), Some(0), "{told}{}", String::from_utf8_lossy(&done.stderr));
    assert!(
        told.contains("these numbers have no gradients (output elastic: found no number with derivatives)"),
        "{told}"
    );
    let rows = text(&out.join("accuracy.csv"));
    println!("{told}\n{rows}");
    assert!(rows.starts_with("mesh,cells,nodes,steps,quantity,value,bar,mesh_part,steps_part,relative\n0,"), "{rows}");
    let last: Vec<&str> = rows.lines().rev().nth(1).expect("a row").split(',').collect();
    assert!(last[4] == "p" && last[9].parse::<f64>().is_ok_and(|bar| bar <= 0.01), "{rows}");
    // The bars of all numbers at the instants of the steps of the case, and the value of the results themselves.
    let bars = text(&out.join("bars.csv"));
    assert!(bars.starts_with("t,quantity,value,bar,mesh,steps\n") && bars.contains("\n0.5,p,"), "{bars}");
    let probes = text(&out.join("probes.csv"));
    assert_eq!(probes.lines().last().and_then(|row| row.split(',').nth(2)), Some(last[5]), "{probes}");
    assert!(text(&out.join("inputs/refined-cells.txt")).ends_with("\nall\n"));
    assert_eq!(run(&out.join("case.toml"), &again, &[]).status.code(), Some(0));
    assert_eq!(text(&out.join("history.csv")), text(&again.join("history.csv")));
    // A folder that may not be replaced is refused before the first mesh.
    let done = run(&case, &out, &["--accuracy", "0.01", "--of", "p"]);
    let told = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(done.status.code() == Some(2) && done.stdout.is_empty() && told.contains("--force"), "{told}");
    // What is not there is named, with what is, before any result.
    let none = folder.path().join("none");
    let told = |more: &[&str]| {
        let done = run(&case, &none, more);
        (done.status.code(), String::from_utf8_lossy(&done.stderr).into_owned())
    };
    let (code, unknown) = told(&["--accuracy", "0.01", "--of", "q"]);
    assert!(code == Some(2) && unknown.contains("--of: q: found no such number, expected one of p, "), "{unknown}");
    let (code, alone) = told(&["--of", "p"]);
    assert!(code == Some(2) && alone.contains("--accuracy"), "{alone}");
    assert!(!none.exists());
}

/// A case that asks for an accuracy itself: its results are those of the refined case, which runs as it is, with
/// another number of threads, too. They go with its tables when another run takes the folder.
#[test]
fn a_case_asks_for_the_accuracy_of_its_numbers() {
    let folder = tempfile::tempdir().expect("a folder");
    let [case, plain, out, again] =
        ["asking.toml", "plain.toml", "out", "again"].map(|name| folder.path().join(name).display().to_string());
    let asked = "[accuracy]\nof = [\"contact_force_y\"]\nrelative = 0.01\n";
    fs::write(&plain, PRESSED.replace("ELEMENTS", "P2")).expect("a case");
    fs::write(&case, PRESSED.replace("ELEMENTS", "P2") + asked).expect("a case");
    let run = |arguments: &[&str]| {
        let done = amontons(&[&["run"], arguments].concat());
        assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
        String::from_utf8_lossy(&done.stdout).into_owned()
    };
    let told = run(&[&case, "--out", &out, "--plot", "--report", "--threads", "1"]);
    assert!(told.contains("contact_force_y ") && told.contains(" +- "), "{told}");
    let at = |name: &str| Path::new(&out).join(name);
    assert!(text(&at("case.toml")).contains("refined = true"), "{}", text(&at("case.toml")));
    assert!(at("plots/accuracy.svg").exists() && text(&at("report.html")).contains("Errors on the meshes"));
    let of_case = at("case.toml").display().to_string();
    let told = run(&[&of_case, "--out", &again, "--threads", "2"]);
    assert!(!told.contains("+-"), "{told}");
    assert_eq!(text(&at("history.csv")), text(&Path::new(&again).join("history.csv")));
    assert!(at("accuracy.csv").exists() && at("bars.csv").exists());
    run(&[&plain, "--out", &out, "--force"]);
    assert!(!at("accuracy.csv").exists() && !at("bars.csv").exists());
    let sweep = folder.path().join("sweep").display().to_string();
    let done = amontons(&["run", &case, "--each", "contact.gap=0,0.01", "--out", &sweep]);
    assert!(done.status.success() && String::from_utf8_lossy(&done.stderr).contains("[accuracy] is for single runs"));
}
