//! Commands, messages and exit codes.

use std::fs;
use std::path::Path;

use crate::common::{amontons, assert_code, json, lasting, output, paper, read, run_paper, stderr, stdout, summary};
use tempfile::tempdir;

#[test]
fn bad_usage_is_told_apart_from_a_bad_case() {
    for arguments in
        [&["run"][..], &["frobnicate"], &["run", "x.toml", "--threads", "0"], &["run", "x.toml", "--format", "xml"]]
    {
        assert_code(&output(&mut amontons(arguments)), 2);
    }
    assert_code(&output(&mut amontons(&["--help"])), 0);
    assert_code(&output(&mut amontons(&["--version"])), 0);
}

#[test]
fn all_faults_of_a_case_are_shown_with_their_places() {
    let folder = tempdir().expect("a folder");
    let file = folder.path().join("bad.toml");
    fs::write(
        &file,
        read(paper().as_ref()).replace("density = 1.0", "density = -1.0").replace("on = \"top\"", "on = \"topp\""),
    )
    .expect("a file");
    let file = file.display().to_string();
    for command in ["run", "check"] {
        let printed = output(&mut amontons(&[command, &file, "--set", "mesh.m=3"]));
        assert_code(&printed, 2);
        let text = stderr(&printed);
        for part in
            ["material.density", "bad.toml:24:11", "did you mean \"top\"", "--set mesh.m=3", "bad.toml: 3 faults"]
        {
            assert!(text.contains(part), "{part} is not in\n{text}");
        }
        assert!(!text.contains('\u{1b}'), "colours without a terminal");
        assert!(stdout(&printed).is_empty());
    }
    let printed = output(&mut amontons(&["check", &file, "--format", "json"]));
    assert_code(&printed, 2);
    let error = &json(&printed)["error"];
    assert_eq!(error["kind"], "case");
    assert_eq!(error["faults"].as_array().map(Vec::len), Some(2));
    assert_eq!(error["faults"][0]["where"]["line"], 24);
}

#[test]
fn a_bad_mesh_is_a_bad_case() {
    let case = paper();
    let printed = output(&mut amontons(&["check", &case, "--set", "mesh.size=[1.0, 0.0]"]));
    assert_code(&printed, 2);
    assert!(stderr(&printed).contains("mesh.size"));
}

#[test]
fn a_missing_case_cannot_be_read() {
    assert_code(&output(&mut amontons(&["check", "no/such/case.toml"])), 4);
    let printed = output(&mut amontons(&["check", "no/such/case.toml", "--format", "json"]));
    assert_code(&printed, 4);
    assert_eq!(json(&printed)["error"]["kind"], "file");
}

#[test]
fn check_tells_the_sizes() {
    let case = paper();
    let printed = output(&mut amontons(&["check", &case, "--set", "mesh.n=16"]));
    assert_code(&printed, 0);
    assert!(stdout(&printed).contains("case is valid") && stdout(&printed).contains("289 nodes, 512 cells"));
    let printed = output(&mut amontons(&["check", &case, "--set", "mesh.n=16", "--format", "json"]));
    assert_eq!(json(&printed)["nodes"], 289);
}

/// The constants on refined meshes: c_f² → λ/(1 + λ), λ = 5π²/4, from above.
#[test]
fn check_tabulates_the_constants_on_refined_meshes() {
    let case = paper();
    let printed = output(&mut amontons(&["check", &case, "--levels", "4,8,16", "--format", "json"]));
    assert_code(&printed, 0);
    let told = json(&printed);
    let level = |i: usize, name: &str| told["levels"][i]["constants"][name]["value"].as_f64().expect("a number");
    assert_eq!((&told["levels"][2]["level"], &told["levels"][2]["h"]), (&16.into(), &0.0625.into()));
    for name in ["c_k", "c_f", "s1", "s1_normal", "s1_tangential", "s2"] {
        let falls = name.starts_with('c') || name == "s1_normal";
        assert!(
            if falls { level(2, name) <= level(1, name) * (1.0 + 1e-12) } else { level(2, name) > level(1, name) },
            "{name}"
        );
    }
    let lambda = 1.25 * std::f64::consts::PI.powi(2);
    let (exact, limit) = ((lambda / (1.0 + lambda)).sqrt(), &told["limits"]["c_f"]);
    let off = (limit["value"].as_f64().expect("a number") - exact).abs();
    assert!(
        level(2, "c_f") > exact
            && off < 0.1 * (level(2, "c_f") - exact)
            && off <= limit["error"].as_f64().expect("a number")
    );
    assert!(told["levels"][1]["orders"]["c_f"].is_null() && told["levels"][2]["orders"]["c_f"] == limit["order"]);
    assert!(told["limits"]["s1_normal"]["order"].is_null() && told["findings"].is_array());

    let printed = output(&mut amontons(&["check", &case, "--levels", "4,8", "--set", "mesh.n=[4, 2]"]));
    assert_code(&printed, 0);
    assert!(stdout(&printed).contains("s1_tangential") && stdout(&printed).contains("limit"));
    for (levels, message) in [("8,4", "each finer than the one before"), ("0", "positive levels")] {
        let printed = output(&mut amontons(&["check", &case, "--levels", levels]));
        assert_code(&printed, 2);
        assert!(stderr(&printed).contains(message));
    }
}

#[test]
fn the_starter_case_is_written_once_and_runs() {
    let folder = tempdir().expect("a folder");
    let new = || output(amontons(&["new", "starter.toml"]).current_dir(&folder));
    assert_code(&new(), 0);
    let text = read(&folder.path().join("starter.toml"));
    assert_code(&new(), 2);
    assert_eq!(read(&folder.path().join("starter.toml")), text);
    let printed = output(amontons(&["run", "starter.toml"]).current_dir(&folder));
    assert_code(&printed, 0);
    assert_eq!(summary(&folder.path().join("results/starter"))["outcome"], "done");
    assert_code(&output(amontons(&["new", "no/such/folder/case.toml"]).current_dir(&folder)), 4);
}

#[test]
fn the_schema_is_json_and_names_the_tables() {
    let printed = output(&mut amontons(&["schema"]));
    assert_code(&printed, 0);
    let schema = json(&printed);
    assert!(schema["$schema"].is_string());
    for table in ["mesh", "time", "material", "contact", "output"] {
        assert!(schema["properties"][table].is_object(), "{table}");
    }
}

/// What the program prints of a material is a part of a case: the same material.
#[test]
fn materials_are_listed_with_their_sources() {
    let folder = tempdir().expect("a folder");
    let list = output(&mut amontons(&["materials"]));
    assert_code(&list, 0);
    let names: Vec<String> = stdout(&list).lines().take_while(|line| !line.is_empty()).map(first_word).collect();
    assert!(names.len() >= 20 && names.iter().any(|name| name == "steel-s235"), "{names:?}");
    let rest = "name = \"bar\"\nmesh = { kind = \"interval\", size = 1, n = 2 }\ntime = { end = 1, steps = 1 }\n";
    let more = "[[boundary]]\non = \"left\"\ndisplacement = [0]\ntemperature = 1\n";
    for name in &names {
        let printed = output(&mut amontons(&["materials", name]));
        assert_code(&printed, 0);
        assert!(stdout(&printed).contains("# EN "), "{name}");
        let constants = |text: String| {
            fs::write(folder.path().join("bar.toml"), text).expect("a file");
            let checked = output(amontons(&["check", "bar.toml", "--format", "json"]).current_dir(&folder));
            assert_code(&checked, 0);
            json(&checked)["constants"].clone()
        };
        let written = constants(format!("{rest}{}{more}", stdout(&printed)));
        assert_eq!(constants(format!("{rest}material = \"{name}\"\n{more}")), written, "{name}");
    }
    let unknown = output(&mut amontons(&["materials", "mithril"]));
    assert_code(&unknown, 2);
    assert!(stderr(&unknown).contains("found \"mithril\", expected the name of a material"));
}

fn first_word(line: &str) -> String {
    line.split_whitespace().next().unwrap_or_default().to_owned()
}

/// Two squares of an input file in mm, one of them a region of its own: sizes in m, and what was skipped.
#[test]
fn a_mesh_file_is_shown_with_its_sides_and_regions() {
    let folder = tempdir().expect("a folder");
    let deck = "*NODE\n1,0,0\n2,10,0\n3,20,0\n4,0,10\n5,10,10\n6,20,10\n*ELEMENT, TYPE=CPS4, ELSET=pad\n1,1,2,5,4\n\
        *ELEMENT, TYPE=CPS4, ELSET=plate\n2,2,3,6,5\n*SURFACE, NAME=foot\npad, S1\nplate, S1\n*BOUNDARY\nfoot,1\n";
    fs::write(folder.path().join("pad.inp"), deck).expect("a file");
    let printed = output(amontons(&["mesh", "pad.inp", "--scale", "1e-3"]).current_dir(&folder));
    assert_code(&printed, 0);
    for line in [
        "pad.inp: a plane body, 6 nodes",
        "  cells             2 Q1 quadrilateral",
        "  region \"pad\"      1 cell, area 0.0001",
        "  side \"foot\"       2 facets, length 0.02",
        "  in no side        4 facets of the boundary",
        "has 1.0000 (1: regular, 0: flat)",
        "  skipped           *BOUNDARY (line 15)",
    ] {
        assert!(stdout(&printed).contains(line), "{line}\n{}", stdout(&printed));
    }
    let printed = output(amontons(&["mesh", "pad.inp", "--format", "json"]).current_dir(&folder));
    assert_code(&printed, 0);
    let length = json(&printed)["mesh"]["sides"][0]["measure"].as_f64().expect("a number");
    assert!((length - 20.0).abs() < 1e-13, "{length}");
    // A cell that crosses itself is a check that does not hold.
    fs::write(folder.path().join("turned.inp"), deck.replace("1,1,2,5,4", "1,1,2,4,5")).expect("a file");
    let printed = output(amontons(&["mesh", "turned.inp"]).current_dir(&folder));
    assert_code(&printed, 1);
    assert!(stderr(&printed).contains("cell 0") && stderr(&printed).contains("inverted"), "{}", stderr(&printed));
    assert_code(&output(amontons(&["mesh", "none.inp"]).current_dir(&folder)), 4);
    assert_code(&output(amontons(&["mesh", "pad.stl"]).current_dir(&folder)), 2);
    assert_code(&output(amontons(&["mesh", "pad.inp", "--scale", "-1"]).current_dir(&folder)), 2);
}

/// A case on the mesh of an input file runs, and its results are those on the same mesh of Gmsh.
#[test]
fn a_case_runs_on_an_input_file() {
    let meshes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../amontons/tests/meshes");
    let folder = tempdir().expect("a folder");
    let temperatures = ["quarter_ring_meshio.inp", "quarter_ring.msh"].map(|mesh| {
        fs::copy(meshes.join(mesh), folder.path().join(mesh)).expect("a mesh");
        let case = format!(
            "name = \"{mesh}\"\n[mesh]\nfile = \"{mesh}\"\n[time]\nend = 1\nsteps = 2\n[material]\nheat_capacity = 1\nconductivity = 1\n\
             [[boundary]]\non = \"inner\"\ntemperature = 1\n[[boundary]]\non = \"outer\"\nheat_inflow = \"x\"\n"
        );
        fs::write(folder.path().join("ring.toml"), case).expect("a case");
        let printed = output(amontons(&["run", "ring.toml", "--quiet"]).current_dir(&folder));
        assert_code(&printed, 0);
        summary(&folder.path().join("results").join(mesh))["final"]["temperature_max"].as_f64().expect("a number")
    });
    assert!((temperatures[0] - temperatures[1]).abs() <= 1e-13 * temperatures[1], "{temperatures:?}");
}

#[test]
fn there_are_completions_for_the_usual_shells() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let printed = output(&mut amontons(&["completions", shell]));
        assert_code(&printed, 0);
        assert!(stdout(&printed).contains("resume"), "{shell}");
    }
}

/// Each command has a manual page with its arguments; one that does not exist is told with those that do.
#[test]
fn there_are_manual_pages() {
    for (arguments, parts) in [
        (&["man"][..], [".TH amontons 1", "amontons\\-resume(1)", "Exit codes"]),
        (&["man", "run"], [".TH amontons-run 1", "\\-\\-each", "The case file"]),
        (&["man", "converge"], [".TH amontons-converge 1", "\\-\\-levels", "\\-\\-reference"]),
    ] {
        let printed = output(&mut amontons(arguments));
        assert_code(&printed, 0);
        for part in parts {
            assert!(stdout(&printed).contains(part), "{part} is not in\n{}", stdout(&printed));
        }
    }
    let printed = output(&mut amontons(&["man", "rum"]));
    assert_code(&printed, 2);
    assert!(stderr(&printed).contains("found \"rum\", expected one of run, resume"), "{}", stderr(&printed));
}

#[test]
fn a_run_prints_what_it_is_asked_to() {
    let folder = tempdir().expect("a folder");
    let printed = run_paper(&folder.path().join("text"), 4, &[]);
    assert_code(&printed, 0);
    for part in ["paper: done, 4 steps to t = 1 in", "contact", "energy closes to", "results"] {
        assert!(stdout(&printed).contains(part), "{part} is not in\n{}", stdout(&printed));
    }
    let printed = run_paper(&folder.path().join("json"), 4, &["--format", "json"]);
    assert_code(&printed, 0);
    assert_eq!(json(&printed), summary(&folder.path().join("json")));
    let printed = run_paper(&folder.path().join("quiet"), 4, &["--quiet"]);
    assert_code(&printed, 0);
    assert!(stdout(&printed).is_empty() && stderr(&printed).is_empty());
}

/// Each phase has a line of JSON, and so has the last step, with its contact state.
#[test]
fn progress_as_json_names_the_phases() {
    let folder = tempdir().expect("a folder");
    let printed = run_paper(&folder.path().join("run"), 4, &["--progress", "json", "--quiet"]);
    assert_code(&printed, 0);
    let lines: Vec<serde_json::Value> =
        stderr(&printed).lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let phases: Vec<&str> =
        lines.iter().filter_map(|line| line["phase"].as_str()).filter(|phase| *phase != "steps").collect();
    assert_eq!(phases, ["mesh", "assembly", "certificate", "assembly", "factor", "results"]);
    let last = lines.iter().rfind(|line| line["phase"] == "steps").expect("steps");
    assert_eq!((&last["step"], &last["steps"], &last["t"]), (&4.into(), &4.into(), &1.0.into()));
    let count = |status: &str| last["contact"][status].as_u64().expect("a count");
    assert_eq!(count("open") + count("stick") + count("slip"), 9, "nine contact nodes");
    assert!(stderr(&run_paper(&folder.path().join("silent"), 4, &["--progress", "none"])).is_empty());
}

/// The certificate of the same inputs is not computed again: one that was changed in its file comes back.
#[test]
fn the_certificate_is_kept_with_its_inputs() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("run");
    assert_code(&run_paper(&out, 4, &["--quiet"]), 0);
    let findings = summary(&out)["findings"].as_array().expect("findings").len();
    let file = out.join("certificate.json");
    fs::write(&file, read(&file).replace("is strongly monotone", "IS FROM THE FILE")).expect("a file");
    assert_code(&run_paper(&out, 4, &["--quiet", "--force"]), 0);
    assert!(read(&out.join("summary.json")).contains("IS FROM THE FILE"));
    // Other inputs have their own, and without a certificate there is none to keep.
    assert_code(&run_paper(&out, 5, &["--quiet", "--force"]), 0);
    assert!(!read(&out.join("summary.json")).contains("IS FROM THE FILE"));
    assert_code(&run_paper(&out, 5, &["--quiet", "--force", "--no-certificate"]), 0);
    assert!(!file.exists() && summary(&out)["findings"].as_array().expect("findings").len() < findings);
}

#[test]
fn a_step_that_cannot_be_made_ends_the_run_and_keeps_the_steps_before() {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("fails");
    let printed = run_paper(&out, 64, &["--set", "load.heat_source=\"1/(t - 0.5)\"", "--format", "json"]);
    assert_code(&printed, 3);
    let told = json(&printed);
    assert_eq!(told["error"]["kind"], "solver");
    let kept = summary(&out);
    assert_eq!(told["summary"], kept);
    assert_eq!(kept["outcome"], "not converged");
    assert!(kept["error"].as_str().is_some_and(|error| error.contains("step ")));
    let steps = kept["steps"].as_u64().expect("a number of steps") as usize;
    assert!((1..64).contains(&steps));
    assert!(kept["final"]["displacement_max"][0].as_f64().is_some_and(f64::is_finite));
    assert_eq!(read(&out.join("history.csv")).lines().count(), steps + 1);
    assert!(out.join(format!("fields/step_{steps:07}.vtu")).is_file());

    // The case is still one that cannot be gone on with.
    let printed = output(&mut amontons(&["resume", &out.display().to_string()]));
    assert_code(&printed, 3);
    assert!(stderr(&printed).contains(&format!("results up to step {steps}")));
    assert_eq!(lasting(summary(&out)), lasting(kept));
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let folder = tempdir().expect("a folder");
    let file = folder.path().join("file");
    fs::write(&file, "").expect("a file");
    let printed = run_paper(&file.join("results"), 4, &[]);
    assert_code(&printed, 4);
    assert!(stderr(&printed).contains("file/results"));
    let printed = run_paper(&file, 4, &["--format", "json"]);
    assert_code(&printed, 4);
    assert_eq!(json(&printed)["error"]["exit_code"], 4);
}

/// A body that only contact without friction holds against a load along it: the load is named, not round-off.
#[test]
fn a_body_that_slides_without_resistance_is_refused_in_words() {
    let folder = tempdir().expect("a folder");
    let file = folder.path().join("slide.toml");
    let case = "name = \"slide\"\n[mesh]\nkind = \"rectangle\"\nsize = [1.0, 1.0]\nn = 4\n[time]\nend = 1.0\nsteps = 2\n\
        [material]\ndensity = 0\n\
        elasticity = { law = \"isotropic\", young = 10.0, poisson = 0.3, stress_state = \"plane-strain\" }\n\
        [load]\nbody_force = [0.5, -1.0]\n[contact]\non = \"bottom\"\nnormal = { law = \"signorini\" }\n\
        [[boundary]]\non = \"left\"\ndisplacement = [\"free\", 0]\n";
    fs::write(&file, case).expect("a file");
    for solver in ["direct", "iterative"] {
        let (out, set) = (folder.path().join(solver).display().to_string(), format!("solver.solver=\"{solver}\""));
        let printed = output(&mut amontons(&["run", &file.display().to_string(), "--out", &out, "--set", &set]));
        assert_code(&printed, 3);
        assert!(stderr(&printed).contains("the body moves along (1, 0)"), "{}", stderr(&printed));
    }
}

/// The ids of the findings of a run.
fn found(arguments: &[&str]) -> Vec<String> {
    let folder = tempdir().expect("a folder");
    let out = folder.path().join("run");
    let place = out.to_string_lossy().into_owned();
    assert_code(&output(&mut amontons(&[arguments, &["--out", &place, "--quiet"]].concat())), 0);
    let findings = summary(&out)["findings"].as_array().expect("findings").clone();
    findings.iter().map(|finding| finding["id"].as_str().expect("an id").to_owned()).collect()
}

/// Verdicts that need factors of their own are made where they are a small part of the run, or asked for; where they
/// are left out the run says so.
#[test]
fn a_run_makes_the_verdicts_that_it_can_afford() {
    let clutch = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/clutch.toml").display().to_string();
    let (small, short) = (paper(), ["run", &clutch, "--set", "time.steps=1"]);
    for (run, alone) in [(&["run", &small, "--set", "mesh.n=4"][..], true), (&short, false)] {
        for (more, made) in [(&[][..], alone), (&["--certificate"], true), (&["--no-certificate"], false)] {
            let found = found(&[run, more].concat());
            let has = |id: &str| found.iter().any(|one| one == id);
            assert_eq!((has("step-unique"), has("certificate")), (made, !made), "{run:?} {more:?}");
        }
    }
}
