//! `amontons report`: what the page holds, for every kind of case, without a browser.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::{self, amontons, assert_code, output, read, run_paper, stderr, stdout, summary};
use serde_json::Value;

/// Runs a case into a folder, and makes its report; the page.
fn page(case: &Path, folder: &Path, further: &[&str]) -> String {
    let (case, out) = (case.display().to_string(), folder.display().to_string());
    let mut arguments = vec!["run", &case, "--out", &out, "--no-certificate", "--report", "--quiet"];
    arguments.extend(further);
    assert_code(&output(&mut amontons(&arguments)), 0);
    read(&folder.join("report.html"))
}

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(name)
}

/// The data that the page draws.
fn data(page: &str) -> Value {
    let start = "<script type=\"application/json\" id=\"data\">";
    let text = page.split(start).nth(1).and_then(|rest| rest.split("</script>").next()).expect("data");
    serde_json::from_str(text).expect("JSON")
}

/// The text of a page without tags and with its signs.
fn text(page: &str) -> String {
    let body = page.split("<script type").next().unwrap_or_default();
    let mut inside = false;
    let kept = body.chars().filter(|&c| {
        inside = (inside || c == '<') && c != '>';
        !inside && c != '>'
    });
    let kept: String = kept.collect();
    kept.replace("&quot;", "\"").replace("&#39;", "'").replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")
}

fn names(of: &Value) -> Vec<&str> {
    of.as_array().into_iter().flatten().filter_map(|one| one["name"].as_str()).collect()
}

#[test]
fn the_page_says_what_the_program_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let results = folder.path().join("results");
    let printed = stdout(&run_paper(&results, 6, &["--report"]));
    let page = read(&results.join("report.html"));
    let text = text(&page);
    let mut lines = printed.lines();
    assert!(text.contains(lines.next().expect("a headline")), "{printed}");
    let mut rows = 0;
    for line in lines.take_while(|line| !line.starts_with("  results")) {
        let (name, value) = line.trim_start().split_at(17.min(line.trim_start().len()));
        assert!(text.contains(name.trim()) && text.contains(value.trim()), "{line}");
        rows += 1;
    }
    assert!(rows > 10, "{printed}");
    // Every finding with its message, and the case.
    let findings = summary(&results)["findings"].as_array().expect("findings").clone();
    assert!(findings.len() > 10);
    for finding in findings {
        let message = finding["message"].as_str().expect("a message");
        assert!(text.contains(message), "{message}");
    }
    assert!(text.contains(&read(&results.join("case.toml"))));
    let data = data(&page);
    assert_eq!(names(&data["body"]["fields"]), ["displacement", "von Mises stress", "temperature"]);
    assert_eq!(data["body"]["dimension"], 2);
    // t = 0 and every third of six steps; contact is known after the first step.
    assert_eq!(data["t"], serde_json::json!([0.0, 0.5, 1.0]));
    assert_eq!(data["contact"]["at"], serde_json::json!([1, 2]));
    assert_eq!(names(&data["contact"]["sides"]), ["bottom"]);
}

/// No date, no path and nothing that changes from one time to the next.
#[test]
fn the_same_folder_gives_the_same_bits() {
    let folder = tempfile::tempdir().expect("a folder");
    let (here, there) = (folder.path().join("here"), folder.path().join("elsewhere").join("far"));
    assert_code(&run_paper(&here, 6, &["--report", "--quiet"]), 0);
    let first = fs::read(here.join("report.html")).expect("a page");
    fs::create_dir_all(there.parent().expect("a folder")).expect("a folder");
    fs::rename(&here, &there).expect("a move");
    let printed = output(&mut amontons(&["report", &there.display().to_string()]));
    assert_code(&printed, 0);
    assert_eq!(stdout(&printed).trim(), there.join("report.html").display().to_string());
    assert_eq!(first, fs::read(there.join("report.html")).expect("a page"));
    let page = String::from_utf8(first).expect("text");
    let name = folder.path().file_name().expect("a name").to_string_lossy().into_owned();
    let year = &read(&there.join("manifest.json")).split("\"start\": \"").nth(1).expect("a start")[..10].to_owned();
    assert!(!page.contains(&name) && !page.contains(year.as_str()));
    assert!(page.len() < 300_000, "{}", page.len());
}

/// Nothing on the page is loaded from anywhere, and the browser is told so.
#[test]
fn the_page_asks_for_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let page = page(&shipped("cases/slab.toml"), &folder.path().join("slab"), &[]);
    for sign in ["<link rel=\"stylesheet", "<script src", "@import", "url(", "fetch(", "XMLHttpRequest", "import("] {
        assert!(!page.contains(sign), "{sign}");
    }
    // The name of a namespace is no address that is asked for.
    assert!(!page.replace("http://www.w3.org/2000/svg", "").contains("://"));
    let policy = page.split("Content-Security-Policy\" content=\"").nth(1).and_then(|rest| rest.split('"').next());
    let policy = policy.expect("a policy");
    assert!(policy.starts_with("default-src 'none'; img-src data:; style-src 'sha256-"), "{policy}");
    assert!(!policy.contains("unsafe"), "{policy}");
}

/// Names and comments of a case stay text, wherever they are shown.
#[test]
fn a_hostile_case_injects_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let evil = "</script><img src=x onerror=alert(1)>";
    let case = read(&shipped("cases/o-ring.toml"))
        .replace("name = \"o-ring\"", &format!("# {evil}\nname = \"a&b'c\""))
        .replace("on = \"upper\"", "on = '</script><b onclick=alert(2)>'")
        .replace("every = 10", "every = 20\n[[probe]]\nname = \"p\" # <!--\nquantity = \"displacement\"\nat = [0, 0]")
        .replace("final.contact.sides.upper.force", "final.contact.force");
    let case = case.split("[expected]").next().expect("a case").to_owned();
    let mesh = read(&shipped("cases/o-ring.msh")).replace("\"upper\"", "\"</script><b onclick=alert(2)>\"");
    fs::write(folder.path().join("o-ring.msh"), mesh).expect("a mesh");
    fs::write(folder.path().join("evil.toml"), case).expect("a case");
    let page = page(&folder.path().join("evil.toml"), &folder.path().join("out"), &["--set", "time.steps=20"]);
    // One script that runs and two blocks of data, as on every page; no tag of the case. Its name can have none.
    assert_eq!(page.matches("<script").count(), 3);
    assert_eq!(page.matches("</script").count(), 3);
    for tag in ["<img", "<b ", "<!--", "</title><"] {
        assert!(!page.contains(tag), "{tag}");
    }
    assert!(page.contains("<title>a&amp;b&#39;c</title>"));
    // The data still has the names.
    let data = data(&page);
    assert!(names(&data["contact"]["sides"]).contains(&"</script><b onclick=alert(2)>"));
    assert_eq!(names(&data["probes"]["charts"]), ["p"]);
}

/// Every dimension and physics has what it has, and nothing else.
#[test]
fn every_kind_of_case_has_a_report() {
    let folder = tempfile::tempdir().expect("a folder");
    let benchmark = |name: &str| shipped(&format!("crates/amontons/benchmarks/{name}.toml"));
    let cases = [
        // Case, dimension, fields, sides of contact.
        (shipped("cases/o-ring.toml"), 2, vec!["displacement", "von Mises stress"], vec!["upper", "lower"]),
        (shipped("cases/clutch.toml"), 3, vec!["displacement", "von Mises stress", "temperature"], vec!["facing"]),
        (benchmark("lame-cylinder-space"), 3, vec!["displacement", "von Mises stress"], vec![]),
        (benchmark("graded-cylinder-heat"), 2, vec!["temperature"], vec![]),
        (benchmark("bouncing-bar-signorini"), 1, vec!["displacement"], vec!["left"]),
        (benchmark("thermal-wall"), 1, vec!["temperature"], vec![]),
    ];
    for (i, (case, dimension, fields, sides)) in cases.into_iter().enumerate() {
        let page = page(&case, &folder.path().join(i.to_string()), &[]);
        let data = data(&page);
        let name = case.display();
        let body = if dimension == 1 { &data["rod"] } else { &data["body"] };
        assert_eq!(names(&body["fields"]), fields, "{name}");
        assert!(dimension == 1 || data["body"]["dimension"] == dimension, "{name}");
        assert_eq!(names(&data["contact"]["sides"]), sides, "{name}");
        assert!(!names(&data["history"]["charts"]).is_empty(), "{name}");
        assert!(page.len() < 400_000, "{name}: {}", page.len());
    }
}

/// Of a pair of bodies both sides are there; a body of revolution has the axes r and z.
#[test]
fn pairs_and_revolution() {
    let folder = tempfile::tempdir().expect("a folder");
    let case = folder.path().join("fit.toml");
    let name = case.display().to_string();
    assert_code(&output(&mut amontons(&["new", &name, "--template", "press-fit"])), 0);
    let data = data(&page(&case, &folder.path().join("fit"), &[]));
    assert_eq!(data["body"]["axes"], serde_json::json!(["r", "z", ""]));
    assert_eq!(names(&data["contact"]["sides"]).len(), 2);
}

/// A study has its table and its picture, and no run.
#[test]
fn a_study_has_a_report() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().display().to_string();
    let paper = common::paper();
    let study = ["converge", &paper, "--levels", "2,4", "--reference", "8", "--out", &out, "--force", "--quiet"];
    assert_code(&output(&mut amontons(&study)), 0);
    assert_code(&output(&mut amontons(&["report", &out])), 0);
    let page = read(&folder.path().join("report.html"));
    assert!(page.contains("<h2>Convergence</h2>") && page.contains("data:image/svg+xml;base64,"));
    for line in read(&folder.path().join("convergence.csv")).lines() {
        let first = line.split(',').next().expect("a cell");
        assert!(page.contains(&format!(">{first}</t")), "{line}");
    }
    assert!(page.contains("<h3>At the end</h3>") && page.contains("<th scope=\"row\">elastic</th>"));
    assert!(!page.contains("<h2>Summary</h2>"));
}

/// A run of a sweep has a report; the sweep says where they are.
#[test]
fn every_run_of_a_sweep_has_a_report() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("sweep").display().to_string();
    let slab = shipped("cases/slab.toml").display().to_string();
    let each = ["--each", "contact[0].friction.coefficient=0.1,0.2", "--set", "time.steps=4", "--report", "--quiet"];
    let start = ["run", &slab, "--out", &out, "--no-certificate"];
    assert_code(&output(&mut amontons(&[&start[..], &each[..]].concat())), 0);
    for run in ["coefficient=0.1", "coefficient=0.2"] {
        assert!(read(&Path::new(&out).join(run).join("report.html")).contains("<h2>Summary</h2>"));
    }
    let refused = output(&mut amontons(&["report", &out]));
    assert_code(&refused, 4);
    assert!(stderr(&refused).contains("make the report of one of its runs"), "{}", stderr(&refused));
}

#[test]
fn missing_and_damaged_files_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    assert_code(&run_paper(folder.path(), 3, &["--quiet"]), 0);
    let dir = folder.path().display().to_string();
    let snapshot = fs::read_dir(folder.path().join("contact")).expect("a folder").flatten();
    let snapshot = snapshot.map(|e| e.path()).find(|p| p.extension().is_some_and(|e| e == "vtu")).expect("a snapshot");
    let snapshot = snapshot.strip_prefix(folder.path()).expect("a name").display().to_string();
    for name in ["case.toml", "summary.json", "fields.pvd", "history.csv", "contact.csv", &snapshot] {
        let path = folder.path().join(name);
        let whole = fs::read(&path).expect("a file");
        fs::remove_file(&path).expect("a file");
        let missing = output(&mut amontons(&["report", &dir]));
        let file = Path::new(name).file_name().expect("a name").to_string_lossy().into_owned();
        assert_code(&missing, 4);
        assert!(stderr(&missing).contains(&file), "{}", stderr(&missing));
        fs::write(&path, &whole[..whole.len() / 2]).expect("a file");
        let damaged = output(&mut amontons(&["report", &dir]));
        // Half a case or a table may still be one.
        if !matches!(name, "case.toml" | "history.csv" | "contact.csv") {
            assert_code(&damaged, 4);
            assert!(stderr(&damaged).contains(&file), "{}", stderr(&damaged));
        }
        fs::write(&path, &whole).expect("a file");
    }
    let nothing = output(&mut amontons(&["report", &folder.path().join("nothing").display().to_string()]));
    assert_code(&nothing, 4);
    assert!(stderr(&nothing).contains("case.toml"), "{}", stderr(&nothing));
}

/// The animation is a GIF of a frame per snapshot, all of one size.
#[test]
fn an_animation_has_a_frame_per_snapshot() {
    let folder = tempfile::tempdir().expect("a folder");
    assert_code(&run_paper(folder.path(), 6, &["--quiet"]), 0);
    let dir = folder.path().display().to_string();
    for (argument, file) in [
        ("--animate", "deformed.gif"),
        ("--animate=von-mises", "von-mises.gif"),
        ("--animate=temperature", "temperature.gif"),
    ] {
        let printed = output(&mut amontons(&["plot", &dir, argument]));
        assert_code(&printed, 0);
        let path = folder.path().join("plots").join(file);
        assert_eq!(stdout(&printed).trim(), path.display().to_string());
        let bytes = fs::read(&path).expect("a picture");
        assert_eq!(&bytes[..6], b"GIF89a");
        assert_eq!(frames(&bytes), 3, "{file}");
        assert_code(&output(&mut amontons(&["plot", &dir, argument])), 0);
        assert_eq!(bytes, fs::read(&path).expect("a picture"), "the same folder gives the same bits");
    }
    let rod = folder.path().join("rod");
    page(&shipped("crates/amontons/benchmarks/thermal-wall.toml"), &rod, &[]);
    let refused = output(&mut amontons(&["plot", &rod.display().to_string(), "--animate=temperature"]));
    assert_code(&refused, 4);
    assert!(stderr(&refused).contains("temperature"), "{}", stderr(&refused));
}

/// The images of a GIF, block by block as its standard says; panics if the blocks do not end with the file.
fn frames(bytes: &[u8]) -> usize {
    let colors = |flags: u8| if flags & 0x80 == 0 { 0 } else { 3 << ((flags & 7) + 1) };
    let (mut at, mut count) = (13 + colors(bytes[10]), 0);
    let blocks = |mut at: usize| {
        while bytes[at] != 0 {
            at += 1 + usize::from(bytes[at]);
        }
        at + 1
    };
    loop {
        match bytes[at] {
            0x21 => at = blocks(at + 2),
            0x2C => {
                let edge = |i: usize| usize::from(u16::from_le_bytes([bytes[at + i], bytes[at + i + 1]]));
                let size = |i: usize| usize::from(u16::from_le_bytes([bytes[i], bytes[i + 1]]));
                assert!(edge(1) + edge(5) <= size(6) && edge(3) + edge(7) <= size(8), "a frame outside the picture");
                count += 1;
                at = blocks(at + 10 + colors(bytes[at + 9]) + 1);
            }
            0x3B => return count,
            other => panic!("the block {other:#x} at {at}"),
        }
    }
}

/// A ball that a force presses on, and one that is moved as the first was found to move: pictures, tables and the
/// report show both at the same places.
#[test]
fn pictures_have_an_obstacle_where_its_load_has_moved_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = |center: &str, load: &str| {
        format!(
            r#"name = "ball"
units = "dimensionless"
[mesh]
kind = "rectangle"
size = [1, 0.5]
n = [12, 6]
[time]
end = 2
steps = 2
[material]
density = 0
elasticity = {{ law = "isotropic", young = 1000, poisson = 0.3, stress_state = "plane-strain" }}
[[boundary]]
on = "bottom"
displacement = [0, 0]
[contact]
on = "top"
normal = {{ law = "signorini" }}
[contact.obstacle]
shape = "sphere"
center = [0.4, {center}]
radius = 0.2
{load}"#
        )
    };
    let drawn = |name: &str, text: &str| {
        let (case, out) = (folder.path().join(format!("{name}.toml")), folder.path().join(name));
        fs::write(&case, text).expect("a case");
        let [case, out] = [&case, &out].map(|path| path.display().to_string());
        assert_code(&output(&mut amontons(&["run", &case, "--out", &out, "--quiet"])), 0);
        assert_code(&output(&mut amontons(&["plot", &out])), 0);
        (
            read(&folder.path().join(name).join("plots/deformed.svg")),
            read(&folder.path().join(name).join("history.csv")),
        )
    };
    let (pressed, history) = drawn("pressed", &text("0.9", "load = { force = \"4*t\", direction = [0, -1] }"));
    let mut rows = history.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let column = rows.next().and_then(|names| names.iter().position(|name| *name == "obstacle_displacement"));
    let column = column.expect("a column");
    let places: Vec<f64> = rows.map(|row| 0.9 - row[column].parse::<f64>().expect("a number")).collect();
    let [first, second] = places[..] else { panic!("{places:?}") };
    let center = format!("{{ times = [0, 1, 2], values = [0.9, {first:?}, {second:?}] }}");
    let (prescribed, _) = drawn("prescribed", &text(&center, ""));
    assert!(pressed == prescribed);
}
