//! Pictures of shipped cases are true: the foundation is where the body touches it, scales are equal, and nothing is
//! drawn that a case does not have.
#![allow(clippy::err_expect, clippy::float_cmp, reason = "positions have the same bits")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::common;
use amontons::output::{Folder, FolderOptions};
use amontons::plot::{self, DrawnRun, Film, Options, PictureKind, RunPanel};
use amontons::run::{Settings, run};

/// The results of a shipped case with overrides.
fn solved(name: &str, case: &str, overrides: &[&str]) -> PathBuf {
    filmed(name, case, overrides).0
}

/// The same with the film of the run.
fn filmed(name: &str, case: &str, overrides: &[&str]) -> (PathBuf, Film) {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("plot-truth").join(name);
    if dir.exists() {
        fs::remove_dir_all(&dir).expect("the folder of an earlier test");
    }
    let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
    let case = common::case(case, &overrides);
    let options = FolderOptions {
        force: true,
        every: case.every,
        inputs: case.inputs.clone(),
        ..FolderOptions::new(case.text.clone())
    };
    let mut folder = Folder::create(&dir, options).expect("a results folder");
    let problem = Arc::new(case.problem);
    let mut film = Film::new(&problem, case.every);
    let settings = Settings { certificate: false, ..Settings::default() };
    run(&problem, &settings, &mut [&mut folder, &mut film]).expect("a run");
    (dir, film)
}

/// The points of each path of an SVG document that is drawn with a colour and a width.
fn paths(svg: &str, color: &str, width: &str) -> Vec<Vec<[f64; 2]>> {
    let with = svg.lines().filter(|line| {
        line.starts_with("<path")
            && line.contains(&format!("stroke=\"{color}\""))
            && line.contains(&format!("stroke-width=\"{width}\""))
    });
    let data = with.filter_map(|line| line.split(" d=\"").nth(1)?.split('"').next());
    data.flat_map(|d| d.split('M').skip(1).map(points)).collect()
}

/// The numbers of a path, two by two; letters stand between them.
fn points(d: &str) -> Vec<[f64; 2]> {
    let numbers: Vec<f64> =
        d.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-')).filter_map(|n| n.parse().ok()).collect();
    numbers.chunks_exact(2).map(|p| [p[0], p[1]]).collect()
}

fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], v| [lo.min(v), hi.max(v)])
}

/// Distance from a point to a line of points.
fn distance(p: [f64; 2], line: &[[f64; 2]]) -> f64 {
    let to = |e: &[[f64; 2]]| {
        let (d, q) = ([e[1][0] - e[0][0], e[1][1] - e[0][1]], [p[0] - e[0][0], p[1] - e[0][1]]);
        let s = ((d[0] * q[0] + d[1] * q[1]) / (d[0] * d[0] + d[1] * d[1])).clamp(0.0, 1.0);
        (q[0] - s * d[0]).hypot(q[1] - s * d[1])
    };
    line.windows(2).map(to).fold(f64::INFINITY, f64::min)
}

/// Places in a picture of points of a body, whose displacements are drawn `factor` times, by the outline of the body in
/// the picture; its scales.
fn places(svg: &str, run: &DrawnRun, factor: f64, points: &[[f64; 2]]) -> (Vec<[f64; 2]>, [f64; 2]) {
    // That of the whole body comes before that of an enlargement.
    let outline: Vec<[f64; 2]> = paths(svg, "#222222", "1.2").into_iter().next().expect("an outline");
    let mesh = &run.problem.as_ref().expect("a problem").mesh;
    let snapshot = run.snapshot.as_ref().expect("fields");
    let moved = |d: usize| mesh.points.iter().zip(&snapshot.displacement).map(move |(p, u)| p[d] + factor * u[d]);
    let (drawn, true_) = ([0, 1].map(|d| range(outline.iter().map(|p| p[d]))), [0, 1].map(|d| range(moved(d))));
    let scale = [0, 1].map(|d| (drawn[d][1] - drawn[d][0]) / (true_[d][1] - true_[d][0]));
    // Downwards is positive in the picture.
    let at =
        |p: &[f64; 2]| [drawn[0][0] + scale[0] * (p[0] - true_[0][0]), drawn[1][1] - scale[1] * (p[1] - true_[1][0])];
    (points.iter().map(at).collect(), scale)
}

/// The contact points that press, displaced by `factor` times their displacement.
fn touching(run: &DrawnRun, factor: f64) -> Vec<[f64; 2]> {
    let mesh = &run.problem.as_ref().expect("a problem").mesh;
    let snapshot = run.snapshot.as_ref().expect("fields");
    let node = |x: [f64; 2]| mesh.points.iter().position(|p| p[0] == x[0] && p[1] == x[1]).expect("a node");
    let pressing = run.contact.iter().filter(|row| row.pressure > 0.0);
    pressing.map(|row| [0, 1].map(|d| row.x[d] + factor * snapshot.displacement[node(row.x)][d])).collect()
}

fn picture(kind: PictureKind, run: &DrawnRun) -> String {
    plot::picture(kind, &[RunPanel { title: "", run }], &Options::default()).expect("a picture").svg()
}

/// At three times the points of the ring that press lie on a plate, to a pixel, in every picture of the body; both axes
/// have the same scale.
#[test]
fn plates_are_where_the_ring_touches_them() {
    let dir = solved("o-ring", "cases/o-ring.toml", &["time.steps=8", "output.every=2"]);
    let runs = DrawnRun::frames(&dir, &[0.25, 0.5, 1.0]).expect("three times");
    assert_eq!(runs.iter().map(|run| run.t).collect::<Vec<_>>(), [0.25, 0.5, 1.0]);
    for run in &runs {
        for kind in [PictureKind::Deformed, PictureKind::VonMises] {
            let svg = picture(kind, run);
            // The whole ring with both plates, then the lower contact with its plate, enlarged.
            let mut plates = paths(&svg, "#d55e00", "1.6");
            assert_eq!(plates.len(), 3, "{kind:?}");
            plates.truncate(2);
            let (drawn, [x, y]) = places(&svg, run, 1.0, &touching(run, 1.0));
            assert!(drawn.len() >= 4, "{} points touch", drawn.len());
            assert!((x / y - 1.0).abs() < 2e-3, "scales {x} and {y}");
            for place in drawn {
                let off = plates.iter().map(|plate| distance(place, plate)).fold(f64::INFINITY, f64::min);
                assert!(off < 1.0, "{kind:?}, t = {}: {off} units beside the plates", run.t);
            }
        }
        // The plates have come nearer by 0.4 mm/s.
        let svg = picture(PictureKind::Deformed, run);
        let levels: Vec<f64> = paths(&svg, "#d55e00", "1.6").iter().map(|plate| plate[0][1]).collect();
        let (_, [_, scale]) = places(&svg, run, 1.0, &[]);
        let apart = (levels[0] - levels[1]).abs() / scale;
        assert!((apart - (5.33e-3 - 0.4e-3 * run.t)).abs() < 1.0 / scale, "t = {}: {apart} m apart", run.t);
    }
}

/// Beside a flat foundation at a gap that is the same everywhere, displacement and gap are enlarged alike: what presses
/// lies on the foundation.
#[test]
fn an_enlarged_body_still_touches_its_foundation() {
    let dir = solved("paper", "cases/paper.toml", &["mesh.n=16", "time.steps=16", "contact.gap=-0.02"]);
    let run = DrawnRun::read(&dir).expect("a run");
    let svg = picture(PictureKind::Deformed, &run);
    let factor = (2..=10)
        .map(f64::from)
        .find(|f| svg.contains(&format!("aria-label=\"displacement × {f}\"")))
        .expect("a factor above 1");
    let foundation = paths(&svg, "#d55e00", "1.6");
    assert_eq!(foundation.len(), 1);
    let (drawn, _) = places(&svg, &run, factor, &touching(&run, factor));
    assert!(drawn.len() > 3);
    assert!(drawn.iter().all(|place| distance(*place, &foundation[0]) < 1.0), "{drawn:?}");
    // A gap that varies is drawn to scale.
    let dir = solved("varies", "cases/paper.toml", &["mesh.n=16", "time.steps=16", "contact.gap=\"0.01*x\""]);
    let run = DrawnRun::read(&dir).expect("a run");
    let svg = picture(PictureKind::Deformed, &run);
    assert!(svg.contains("displacement to scale"));
    let foundation = paths(&svg, "#d55e00", "1.6");
    let (drawn, _) = places(&svg, &run, 1.0, &touching(&run, 1.0));
    assert!(drawn.iter().all(|place| distance(*place, &foundation[0]) < 1.0), "{drawn:?}");
}

/// A thin facing of 3 mm on which 6 µm are large beside its thickness, not beside its length, is not turned inside out.
#[test]
fn a_thin_body_keeps_its_orientation() {
    let dir = solved("clutch", "cases/clutch.toml", &["time.steps=4"]);
    let svg = picture(PictureKind::Deformed, &DrawnRun::read(&dir).expect("a run"));
    let after = svg.split("displacement × ").nth(1).expect("a factor");
    let factor: f64 = after.split(|c: char| !c.is_ascii_digit()).next().and_then(|n| n.parse().ok()).expect("a number");
    assert!((2.0..=3e-3 / 6e-6).contains(&factor), "× {factor} of 6 µm on 3 mm");
    // A bar of length stands in the picture.
    assert!(svg.contains("aria-label=\"20 mm\"") || svg.contains("aria-label=\"10 mm\""));
}

/// A ring without heat and wear has no pictures and no charts of them; both sides have their own block with their name
/// and the friction cone.
#[test]
fn only_what_a_case_has_is_drawn() {
    let dir = solved("only", "cases/o-ring.toml", &["time.steps=4"]);
    let paths = plot::folder(&dir, &Options::default()).expect("pictures");
    let names: Vec<&str> = paths
        .iter()
        .filter(|p| p.extension().is_some_and(|e| e == "svg"))
        .filter_map(|p| p.file_stem()?.to_str())
        .collect();
    assert_eq!(names, ["deformed", "von-mises", "contact", "history"]);
    let contact = fs::read_to_string(dir.join("plots/contact.svg")).expect("an SVG");
    let history = fs::read_to_string(dir.join("plots/history.svg")).expect("an SVG");
    for word in ["temperature", "heat", "worn"] {
        assert!(
            !contact.contains(&format!("aria-label=\"{word}")) && !history.contains(&format!("aria-label=\"{word}")),
            "{word}"
        );
    }
    for side in ["upper", "lower"] {
        assert_eq!(contact.matches(&format!("contact on &quot;{side}&quot; at t = 1 s")).count(), 1, "{side}");
    }
    assert_eq!(contact.matches("aria-label=\"friction cone").count(), 2);
}

/// Frames have the times that are asked for, on one scale of values, and a time that the run does not have is refused.
#[test]
fn frames_have_their_times() {
    let dir = solved("frames", "cases/slab.toml", &["time.steps=16", "output.every=4", "mesh.n=[12, 4]"]);
    plot::folder(&dir, &Options { times: vec![0.5, 1.1, 2.0], ..Options::default() }).expect("pictures");
    for kind in [PictureKind::Temperature, PictureKind::Contact] {
        let svg = fs::read_to_string(dir.join("plots").join(kind.file_name()).with_extension("svg")).expect("an SVG");
        for time in ["t = 0.5 s", "t = 1 s", "t = 2 s"] {
            assert!(svg.contains(&format!("aria-label=\"{time}\"")), "{kind:?} has no {time}");
        }
    }
    let error =
        plot::folder(&dir, &Options { times: vec![3.0], ..Options::default() }).err().expect("an error").to_string();
    assert!(error.contains("t = 3") && error.contains("from t = 0 to t = 2"), "{error}");
}

/// The bodies of a pair have their names, each inside it, and one body has none; a gap of round-off is no curve; beside
/// the temperature of a side stands that of what it faces.
#[test]
fn bodies_of_a_pair_have_their_names() {
    let case = "crates/amontons/tests/reference/two-bodies/cases/c-cycle.toml";
    let dir = solved("names", case, &[]);
    plot::folder(&dir, &Options::default()).expect("pictures");
    let svg = |kind: PictureKind| {
        fs::read_to_string(dir.join("plots").join(kind.file_name()).with_extension("svg")).expect("an SVG")
    };
    for kind in [PictureKind::Deformed, PictureKind::Temperature, PictureKind::VonMises] {
        for name in ["upper", "lower"] {
            assert_eq!(svg(kind).matches(&format!("aria-label=\"{name}\"")).count(), 1, "{kind:?} {name}");
        }
    }
    let contact = svg(PictureKind::Contact);
    assert!(contact.contains("aria-label=\"gap g − uν (m)\""), "a gap of round-off");
    assert!(contact.contains("aria-label=\"of what it faces\""), "the temperature of the other body");
    let one = solved("no-names", "cases/slab.toml", &["time.steps=4", "mesh.n=[12, 4]"]);
    plot::folder(&one, &Options::default()).expect("pictures");
    let deformed = fs::read_to_string(one.join("plots/deformed.svg")).expect("an SVG");
    let body = "aria-label=\"body\"";
    assert!(!deformed.contains(body));
}

/// A film has the pictures of the folder that the run writes: linear and quadratic cells, laws without a bound, a pair,
/// heat alone, mechanics alone, a line, a body in space; at the start, on the way and at the end.
#[test]
fn a_film_has_the_pictures_of_the_folder() {
    let benchmark = |name: &str| format!("crates/amontons/benchmarks/{name}.toml");
    let cases = [
        ("cases/paper.toml".to_owned(), &["mesh.n=8", "time.steps=8", "output.every=4"][..]),
        ("cases/paper.toml".to_owned(), &["mesh.n=6", "mesh.elements=\"P2\"", "time.steps=4", "output.every=2"]),
        ("cases/o-ring.toml".to_owned(), &["time.steps=4", "output.every=2"]),
        ("crates/amontons/tests/reference/two-bodies/cases/c-cycle.toml".to_owned(), &[]),
        (benchmark("coulomb-shear-cap"), &[]),
        (benchmark("thermal-wall"), &[]),
        (benchmark("contact-conductance-rod"), &[]),
        ("cases/clutch.toml".to_owned(), &["time.steps=4", "output.every=2"]),
    ];
    let mut drawn = BTreeSet::new();
    for (number, (case, overrides)) in cases.iter().enumerate() {
        let (dir, film) = filmed(&format!("film-{number}"), case, overrides);
        let times = film.times();
        let frames = DrawnRun::frames(&dir, &times).expect("the frames of the folder");
        assert_eq!(frames.len(), times.len());
        for (i, of_folder) in frames.iter().enumerate() {
            let of_film = film.frame(i).expect("a frame");
            for kind in PictureKind::ALL {
                assert_eq!(kind.is_told_by(&of_film), kind.is_told_by(of_folder), "{case} {kind:?} at {}", times[i]);
                if kind.is_told_by(of_folder) && (of_folder.dimension > 1 || kind == PictureKind::History) {
                    assert!(picture(kind, &of_film) == picture(kind, of_folder), "{case} {kind:?} at {}", times[i]);
                    drawn.insert((number, kind.file_name()));
                }
            }
        }
        assert!(film.frame(times.len()).is_err());
    }
    // Each of the cases is drawn, and each kind but wear is that of one.
    assert!((0..cases.len()).all(|number| drawn.iter().any(|(of, _)| *of == number)), "{drawn:?}");
    assert!(
        PictureKind::ALL
            .iter()
            .filter(|k| **k != PictureKind::Wear)
            .all(|k| drawn.iter().any(|(_, of)| *of == k.file_name()))
    );
}

/// A clutch of revolution: the picture has the slip about the axis that the plates turn with, friction up to its bound,
/// and the moment of each pair over time.
#[test]
fn a_clutch_has_its_speed_and_its_moment() {
    let dir = solved("clutch-plates", "cases/clutch-plates.toml", &["output.every=25"]);
    let run = DrawnRun::read(&dir).expect("a run");
    let before = &DrawnRun::frames(&dir, &[0.5]).expect("a frame")[0];
    assert!(before.contact.iter().any(|row| row.traction[2].abs() > 1e3), "nothing rubs");
    let turning: Vec<_> = before.contact.iter().filter(|row| row.slip_velocity[2] != 0.0).collect();
    assert!(turning.len() > 4, "{} points turn", turning.len());
    for row in &turning {
        let expected = 100.0 * row.x[0];
        assert!((row.slip_velocity[2].abs() - expected).abs() < 1e-9 * expected, "{row:?}");
        let (bound, found) = (row.bound.expect("a bound"), row.traction[2].hypot(row.traction[0]));
        assert!((found - bound).abs() <= 1e-6 * bound, "{row:?}");
    }
    let svg = picture(PictureKind::Contact, before);
    for text in ["slip velocity (m/s)", "about the axis", "στ about the axis"] {
        assert!(svg.contains(&format!("aria-label=\"{text}\"")), "{text}");
    }
    let history = picture(PictureKind::History, &run);
    assert!(history.contains("aria-label=\"moment of contact about the axis (N m)\""));
    for side in ["counter_plate-lining_1", "lining_2-pressure_plate", "all contacts"] {
        assert!(history.contains(&format!("aria-label=\"{side}\"")), "{side}");
    }
    // Without rotation there is no such line.
    let plain = solved("no-moment", "cases/slab.toml", &["time.steps=4", "mesh.n=[12, 4]"]);
    let plain = DrawnRun::read(&plain).expect("a run");
    assert!(!picture(PictureKind::History, &plain).contains("moment of contact"));
    assert!(!picture(PictureKind::Contact, &plain).contains("out of the plane"));
}

/// The largest value that a picture names says of what it is the largest, and is that of the summary where this has the
/// same name.
#[test]
fn a_picture_says_what_its_largest_value_is() {
    let (dir, film) = filmed("words", "cases/paper.toml", &["mesh.n=8", "time.steps=8"]);
    let (run, summary) = (DrawnRun::read(&dir).expect("a run"), film.summary().expect("a summary"));
    let largest = summary.rows().into_iter().find(|(name, _)| name == "von Mises stress").expect("a row").1;
    let svg = picture(PictureKind::VonMises, &run);
    assert!(largest.ends_with("at the centre of a cell"), "{largest}");
    assert!(svg.contains(&format!("recovered at the nodes; {largest}\"")), "no {largest}");
    let field = picture(PictureKind::Temperature, &run);
    assert!(field.contains(" at the nodes\"") && !field.contains("centre of a cell"));
}

/// The sector of a clutch in space: the history has the moment of friction about the axis, and that of the summary.
#[test]
fn a_sector_of_a_clutch_has_its_moment_over_time() {
    let (dir, film) = filmed("sector", "cases/clutch.toml", &["time.steps=4"]);
    let run = DrawnRun::read(&dir).expect("a run");
    let contact = &film.summary().expect("a summary").last.contact;
    let moment = contact.as_ref().and_then(|contact| contact.moment_about_origin.clone()).expect("a moment");
    let last = |name: &str| *run.history[name].last().expect("a row");
    let found = ["x", "y", "z"].map(|axis| last(&format!("contact_moment_{axis}")));
    assert_eq!(found.as_slice(), moment.as_slice());
    // Of a uniform pressure: 2/3 μ N (Rₒ³ − Rᵢ³)/(Rₒ² − Rᵢ²).
    let expected =
        2.0 / 3.0 * 0.3 * 1798.70 * (0.12f64.powi(3) - 0.09f64.powi(3)) / (0.12f64.powi(2) - 0.09f64.powi(2));
    assert!((found[2].abs() / expected - 1.0).abs() < 0.01, "{} N m, expected {expected}", found[2]);
    assert!(picture(PictureKind::History, &run).contains("aria-label=\"moment of contact about the origin (N m)\""));
}

/// The picture of the contact of a quadratic pair has a line through all of its points, from end to end.
#[test]
fn contact_of_a_quadratic_pair_is_drawn() {
    for (name, case) in [
        ("template", "crates/amontons-cli/src/templates/press-fit.toml"),
        ("fuel-pin", "crates/amontons/benchmarks/pair-fuel-pin.toml"),
        ("fit", "crates/amontons/benchmarks/pair-press-fit.toml"),
    ] {
        let dir = solved(name, case, &[]);
        let run = DrawnRun::read(&dir).expect("a run");
        assert!(run.contact.len() > 2, "{case}: {} points", run.contact.len());
        let lines = paths(&picture(PictureKind::Contact, &run), "#0072b2", "1.6");
        let longest = lines.iter().map(Vec::len).max().unwrap_or(0);
        assert!(longest >= run.contact.len(), "{case}: {longest} points are drawn of {}", run.contact.len());
        let [left, right] = range(lines.iter().flatten().map(|p| p[0]));
        assert!(right - left > 300.0, "{case}: lines from {left} to {right}");
    }
}
