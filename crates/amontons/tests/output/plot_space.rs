//! Pictures of bodies in space: what is written, that it is the same every time, and what it shows.
#![allow(clippy::err_expect, reason = "a test fails by panicking")]

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use amontons::case::{self, Source};
use amontons::contact::Status;
use amontons::mesh::{Elements, Mesh};
use amontons::output::{Folder, FolderOptions};
use amontons::plot::{self, ColorMap, DrawnRun, Options, PictureKind, RunPanel, Skin, SolidContact, SpaceSnapshot};
use amontons::run;
use amontons::units::Units;
use tiny_skia::Pixmap;

/// A block that is pressed on a warm foundation.
const BLOCK: &str = r#"
name = "block"
[mesh]
kind = "box"
size = [0.2, 0.1, 0.1]
n = [4, 2, 2]
elements = "P2"
[time]
end = 1.0
steps = 2
[material]
density = 1000.0
heat_capacity = 1e4
expansion = 1e4
coupling = 0.0
conductivity = 10.0
elasticity = { law = "isotropic", young = 1e9, poisson = 0.3 }
viscosity = { law = "lame", first = 0.0, second = 1e6 }
[[boundary]]
on = "front"
displacement = [0, 0, -1e-4]
[contact]
on = "back"
normal = { law = "compliance", stiffness = 1e11 }
friction = { law = "coulomb", coefficient = 0.3 }
heat = { law = "ramp", conductance = 1e3, width = 1e-6, foundation_temperature = 50.0 }
"#;

/// A results folder of the block.
fn solved(name: &str) -> PathBuf {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("plot-space").join(name);
    if dir.exists() {
        fs::remove_dir_all(&dir).expect("the folder of an earlier test");
    }
    fs::create_dir_all(&dir).expect("a folder");
    let case = case::parse(&Source::new("block.toml", BLOCK), &[]).expect("a valid case");
    let mut folder = Folder::create(&dir, FolderOptions { force: true, ..FolderOptions::new(case.text.clone()) })
        .expect("a results folder");
    run::run(&case.problem, &run::Settings { certificate: false, ..run::Settings::default() }, &mut [&mut folder])
        .expect("a run");
    dir
}

fn has_text(svg: &str, text: &str) -> bool {
    svg.contains(&format!("aria-label=\"{text}"))
}

#[test]
fn a_body_in_space_has_all_pictures_and_the_same_every_time() {
    let dir = solved("block");
    let paths = plot::folder(&dir, &Options::default()).expect("pictures");
    let names: Vec<String> =
        paths.iter().map(|p| p.strip_prefix(dir.join("plots")).expect("in plots").display().to_string()).collect();
    let expected: Vec<String> = PictureKind::ALL
        .iter()
        .filter(|k| **k != PictureKind::Wear)
        .flat_map(|k| [format!("{}.svg", k.file_name()), format!("{}.png", k.file_name())])
        .collect();
    assert_eq!(names, expected);
    let first: Vec<Vec<u8>> = paths.iter().map(|p| fs::read(p).expect("a picture")).collect();
    for path in plot::folder(&dir, &Options::default()).expect("pictures").iter().zip(&first) {
        assert_eq!(&fs::read(path.0).expect("a picture"), path.1, "{} differs", path.0.display());
    }
    let svg = |kind: PictureKind| {
        fs::read_to_string(dir.join("plots").join(kind.file_name()).with_extension("svg")).expect("an SVG")
    };
    for (kind, what) in [
        (PictureKind::Temperature, "block: temperature"),
        (PictureKind::VonMises, "block: von Mises stress"),
        (PictureKind::Deformed, "block: displacement"),
    ] {
        let svg = svg(kind);
        assert!(has_text(&svg, what) && has_text(&svg, "from above") && has_text(&svg, "from below"), "{what}");
    }
    let svg = svg(PictureKind::Contact);
    assert!(
        has_text(&svg, "on &quot;back&quot;: pressure")
            && has_text(&svg, "on &quot;back&quot;: state and direction of slip")
            && has_text(&svg, "0 open")
    );
}

/// A unit cube whose faces z = 1 and z = 0 have temperatures of their own.
fn cube() -> DrawnRun {
    let mesh = Mesh::box_([1.0; 3], [2; 3], Elements::Q1).expect("a mesh");
    let surface = Skin::of_mesh(&mesh).expect("a surface");
    let contact = mesh
        .points
        .iter()
        .filter(|p| p[2] == 0.0)
        .map(|p| SolidContact {
            x: *p,
            pressure: 1.0 + p[0],
            point_pressure: 1.0 + p[0],
            status: Status::Stick,
            slip_velocity: [0.0; 3],
            wear: 3.0 * p[1],
            friction_work: 0.0,
            side: 0,
        })
        .collect();
    let solid = SpaceSnapshot {
        surface,
        displacement: vec![[0.0; 3]; mesh.points.len()],
        temperature: mesh.points.iter().map(|p| p[2]).collect(),
        von_mises: vec![1.0; mesh.cell_count()],
        nodal_von_mises: Vec::new(),
        regions: Vec::new(),
        contact,
    };
    DrawnRun { dimension: 3, solid: Some(solid), units: Units::SPACE, ..DrawnRun::default() }
}

/// The hot top is seen from above, the cold bottom from below, each in the half of the picture that is so named, and
/// never the other one.
#[test]
fn the_top_is_seen_from_above_and_the_bottom_from_below() {
    let run = cube();
    let picture = plot::picture(PictureKind::Temperature, &[RunPanel { title: "", run: &run }], &Options::default())
        .expect("a picture");
    let image = Pixmap::decode_png(&picture.png(1.0).expect("a PNG")).expect("a valid PNG");
    // A face of one value keeps the hue of its colour and is darkened by at most a third.
    let count = |value: f64, half: usize| {
        let full = ColorMap::Inferno.at(value).map(f64::from);
        let is = |p: &tiny_skia::PremultipliedColorU8| {
            let found = [p.red(), p.green(), p.blue()].map(f64::from);
            let share = found[0] / full[0];
            (0.65..=1.0).contains(&share) && (0..3).all(|c| (found[c] - share * full[c]).abs() < 2.0)
        };
        let width = image.width() as usize;
        image.pixels().iter().enumerate().filter(|(i, p)| (i % width) * 2 / width == half && is(p)).count()
    };
    // The bar of colours beside the right half shows both ends, on a few pixels.
    assert!(count(1.0, 0) > 10_000, "{}", count(1.0, 0));
    assert!(count(1.0, 1) < 500, "{}", count(1.0, 1));
}

#[test]
fn contact_points_are_drawn_where_they_are() {
    let run = cube();
    let picture = plot::picture(PictureKind::Contact, &[RunPanel { title: "", run: &run }], &Options::default())
        .expect("a picture");
    let svg = picture.svg();
    assert!(has_text(&svg, "0 open, 9 stick, 0 slip") && has_text(&svg, "min 1, max 2 Pa at a contact point"));
}

/// Wear has a picture of its own where there is some; friction work is a panel of the contact, where there is some.
#[test]
fn wear_and_friction_work_are_drawn_where_there_are_some() {
    let svg = |kind: PictureKind, run: &DrawnRun| {
        plot::picture(kind, &[RunPanel { title: "", run }], &Options::default()).expect("a picture").svg()
    };
    let mut run = cube();
    assert!(PictureKind::Wear.is_in(&run));
    let worn = svg(PictureKind::Wear, &run);
    assert!(has_text(&worn, "depth worn off") && has_text(&worn, "min 0, max 3 m at a contact point"), "wear");
    assert!(!has_text(&svg(PictureKind::Contact, &run), "friction work"), "no friction work");
    let change = |run: &mut DrawnRun, f: fn(&mut SolidContact)| {
        run.solid.iter_mut().flat_map(|solid| &mut solid.contact).for_each(f);
    };
    change(&mut run, |row| row.friction_work = 5.0 + row.x[0]);
    let both = svg(PictureKind::Contact, &run);
    assert!(
        has_text(&both, "friction work since the start") && has_text(&both, "min 5, max 6 J/m² at a contact point")
    );
    change(&mut run, |row| row.wear = 0.0);
    assert!(!PictureKind::Wear.is_in(&run));
    let error = plot::picture(PictureKind::Wear, &[RunPanel { title: "", run: &run }], &Options::default())
        .err()
        .expect("an error");
    assert!(error.to_string().contains("`wear`"), "{error}");
}

/// The bottom z = 0 is seen from below: with y upwards x runs to the left, so the higher pressure, at x = 1, is on the
/// left. The top is seen from above.
#[test]
fn a_side_is_seen_from_its_own_side() {
    let end = |run: &DrawnRun| -> [u32; 2] {
        let picture = plot::picture(PictureKind::Contact, &[RunPanel { title: "", run }], &Options::default())
            .expect("a picture");
        let image = Pixmap::decode_png(&picture.png(1.0).expect("a PNG")).expect("a valid PNG");
        let column = |value: f64| {
            let full = ColorMap::Viridis.at(value);
            let is = |p: &tiny_skia::PremultipliedColorU8| {
                [p.red(), p.green(), p.blue()].iter().zip(full).all(|(a, b)| a.abs_diff(b) <= 4)
            };
            // Of the field, which is the left third of the picture; its bar of colours is farther to the right.
            let width = image.width() as usize;
            let found = image.pixels().iter().enumerate().filter(|(_, p)| is(p)).map(|(i, _)| (i % width) as u32);
            found.min().expect("a pixel of this value")
        };
        [column(0.02), column(0.98)]
    };
    let mut run = cube();
    let [low, high] = end(&run);
    assert!(high < low, "from below: pressure 2 at {high}, 1 at {low}");
    if let Some(solid) = &mut run.solid {
        solid.contact.iter_mut().for_each(|row| row.x[2] = 1.0);
    }
    let [low, high] = end(&run);
    assert!(low < high, "from above: pressure 1 at {low}, 2 at {high}");
}

/// Arrows say where the body slips to, and none where it sticks.
#[test]
fn slip_has_a_direction() {
    let draw = |run: &DrawnRun| {
        plot::picture(PictureKind::Contact, &[RunPanel { title: "", run }], &Options::default())
            .expect("a picture")
            .svg()
    };
    let mut run = cube();
    let stuck = draw(&run);
    if let Some(solid) = &mut run.solid {
        solid.contact.iter_mut().for_each(|row| (row.status, row.slip_velocity) = (Status::Slip, [2e-3, 0.0, 0.0]));
    }
    let slipping = draw(&run);
    assert!(
        has_text(&slipping, "0 open, 0 stick, 9 slip; slip up to 2 mm/s at a contact point")
            && !stuck.contains("slip up to")
    );
    // An arrow is a line and a head.
    let paths = |svg: &str| svg.matches("<path").count();
    assert!(paths(&slipping) >= paths(&stuck) + 2 * 9, "{} paths, {} without slip", paths(&slipping), paths(&stuck));
}

#[test]
fn data_that_do_not_fit_are_refused() {
    let mut short = cube();
    if let Some(solid) = &mut short.solid {
        solid.temperature.pop();
    }
    let mut broken = cube();
    if let Some(solid) = &mut broken.solid {
        solid.von_mises[3] = f64::NAN;
    }
    for (run, words) in [
        (short, "the temperature has 26 values, expected 27"),
        (broken, "the von Mises stress has values that are not finite"),
    ] {
        let error = plot::picture(PictureKind::Temperature, &[RunPanel { title: "", run: &run }], &Options::default())
            .err()
            .expect("an error");
        assert_eq!(error.to_string(), words);
    }
    let plane = DrawnRun { solid: None, dimension: 1, ..cube() };
    let error = plot::picture(PictureKind::Deformed, &[RunPanel { title: "", run: &plane }], &Options::default())
        .err()
        .expect("an error");
    assert!(error.to_string().contains("d = 1"), "{error}");
}

/// Pixels of the hot end of the colours in the left and in the right half of a picture, but for those that a bar has.
fn hot(picture: &plot::Picture) -> [usize; 2] {
    let image = Pixmap::decode_png(&picture.png(1.0).expect("a PNG")).expect("a valid PNG");
    let full = ColorMap::Inferno.at(1.0).map(f64::from);
    let is = |p: &tiny_skia::PremultipliedColorU8| {
        let found = [p.red(), p.green(), p.blue()].map(f64::from);
        let share = found[0] / full[0];
        (0.65..=1.0).contains(&share) && (0..3).all(|c| (found[c] - share * full[c]).abs() < 2.0)
    };
    let width = image.width() as usize;
    let of_half = |half: usize| {
        let all = image.pixels().iter().enumerate();
        all.filter(|(i, p)| (i % width) * 2 / width == half && is(p)).count()
    };
    [0, 1].map(of_half)
}

/// The cube as the case says that has contact on one of its faces, which is hot.
fn on_face(face: &str) -> DrawnRun {
    let text = format!(
        r#"
name = "cube"
[mesh]
kind = "box"
size = [1, 1, 1]
n = [2, 2, 2]
elements = "Q1"
[time]
end = 1.0
steps = 1
[material]
density = 1000.0
heat_capacity = 1e4
conductivity = 10.0
elasticity = {{ law = "isotropic", young = 1e9, poisson = 0.3 }}
[contact]
on = "{face}"
normal = {{ law = "compliance", stiffness = 1e11 }}
"#
    );
    let case = case::parse(&Source::new("cube.toml", text), &[]).expect("a valid case");
    let problem = Arc::new(case.problem);
    let nodes = problem.mesh.facets[face].node_list();
    let mut run = cube();
    let solid = run.solid.as_mut().expect("a solid");
    solid.surface = Skin::of_mesh(&problem.mesh).expect("a surface");
    let is_hot = |n: usize| f64::from(u8::from(nodes.contains(&(n as u32))));
    solid.temperature = (0..problem.mesh.points.len()).map(is_hot).collect();
    solid.contact.clear();
    run.problem = Some(problem);
    run
}

/// The first view is onto the contact, whichever face it is on; the other one shows what lies behind.
#[test]
fn a_body_is_seen_from_the_side_of_its_contact() {
    for face in ["left", "right", "bottom", "top", "front", "back"] {
        let run = on_face(face);
        let draw = |panels: &[RunPanel]| {
            plot::picture(PictureKind::Temperature, panels, &Options::default()).expect("a picture")
        };
        let panel = RunPanel { title: "", run: &run };
        let picture = draw(std::slice::from_ref(&panel));
        let [seen, behind] = hot(&picture);
        assert!(seen > 8_000 && behind < 500, "{face}: {seen} pixels of the contact, {behind} on the other view");
        assert!(picture.svg().contains(", on the contact\""), "{face}: no heading says so");
        // At several times the view on the contact alone.
        let later = DrawnRun { t: 1.0, ..run.clone() };
        let both = draw(&[panel, RunPanel { title: "", run: &later }]);
        assert!(hot(&both).iter().all(|seen| *seen > 8_000), "{face}: {:?}", hot(&both));
    }
}

/// The bodies of a pair are opened: each is alone in a view from the side of its contact.
#[test]
fn bodies_of_a_pair_are_opened() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("benchmarks/pair-patch-space.toml");
    let problem = Arc::new(case::read(&path, &[]).expect("a valid case").problem);
    let sides: Vec<u32> =
        ["upper_bottom", "lower_top"].iter().flat_map(|side| problem.mesh.facets[*side].node_list()).collect();
    let mut run = cube();
    let solid = run.solid.as_mut().expect("a solid");
    solid.surface = Skin::of_mesh(&problem.mesh).expect("a surface");
    let nodes = problem.mesh.points.len();
    solid.temperature = (0..nodes).map(|n| f64::from(u8::from(sides.contains(&(n as u32))))).collect();
    solid.displacement = vec![[0.0; 3]; nodes];
    solid.von_mises = vec![1.0; problem.mesh.cell_count()];
    solid.contact.clear();
    run.problem = Some(problem);
    let later = DrawnRun { t: 1.0, ..run.clone() };
    let panels = [RunPanel { title: "", run: &run }, RunPanel { title: "later", run: &later }];
    let picture = plot::picture(PictureKind::Temperature, &panels, &Options::default()).expect("a picture");
    let svg = picture.svg();
    for body in ["lower", "upper"] {
        assert_eq!(svg.matches(&format!("&quot;{body}&quot; from ")).count(), 2, "{body} at two times");
        assert_eq!(svg.matches(&format!("&quot;{body}&quot; from above, on its contact")).count(), 2, "{body}");
    }
    // Seen together both faces would be hidden.
    assert!(hot(&picture).iter().all(|seen| *seen > 8_000), "{:?}", hot(&picture));
}

/// A sheet of many times is at most 4000 units wide and high, and says how many it shows; a file has at most 4000
/// pixels.
#[test]
fn no_sheet_is_longer_than_4000_pixels() {
    let runs: Vec<DrawnRun> = (0..60).map(|i| DrawnRun { t: f64::from(i), ..cube() }).collect();
    let titles: Vec<String> = (0..60).map(|i| format!("t = {i} s")).collect();
    let panels: Vec<RunPanel> = runs.iter().zip(&titles).map(|(run, title)| RunPanel { title, run }).collect();
    for kind in [PictureKind::Deformed, PictureKind::Temperature, PictureKind::VonMises, PictureKind::Contact] {
        let picture = plot::picture(kind, &panels, &Options::default()).expect("a picture");
        let (width, height) = picture.size();
        assert!(width <= 4000.0 && height <= 4000.0, "{kind:?}: {width} × {height}");
        let svg = picture.svg();
        let shown = (1..60).find(|n| has_text(&svg, &format!("{n} of 60 times shown"))).expect("a note");
        let drawn = titles.iter().filter(|title| svg.contains(&format!("aria-label=\"{title}"))).count();
        assert_eq!(drawn, shown, "{kind:?}");
        // The last one is always there.
        assert!(has_text(&svg, "t = 59 s"), "{kind:?}");
    }
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("plot-space");
    fs::create_dir_all(&dir).expect("a folder");
    let picture = plot::picture(PictureKind::Contact, &panels[..2], &Options::default()).expect("a picture");
    let [_, png] = picture.save(&dir.join("sheet"), 9.0).expect("files");
    let image = Pixmap::decode_png(&fs::read(png).expect("a PNG")).expect("a valid PNG");
    assert_eq!(image.width().max(image.height()), 4000);
}

/// Slip that is round-off of the displacement is neither named nor drawn.
#[test]
fn slip_of_round_off_is_none() {
    let mut run = DrawnRun { t: 1.0, ..cube() };
    let draw = |run: &DrawnRun| {
        plot::picture(PictureKind::Contact, &[RunPanel { title: "", run }], &Options::default())
            .expect("a picture")
            .svg()
    };
    let still = draw(&run).matches("<path").count();
    for (speed, is_slip) in [(1e-17, false), (1e-6, true)] {
        let solid = run.solid.as_mut().expect("a solid");
        solid.displacement.fill([1e-3, 0.0, 0.0]);
        solid.contact.iter_mut().for_each(|row| (row.status, row.slip_velocity) = (Status::Slip, [speed, 0.0, 0.0]));
        let svg = draw(&run);
        assert_eq!(svg.contains("slip up to"), is_slip, "{speed} m/s");
        assert_eq!(svg.matches("<path").count() > still + 8, is_slip, "{speed} m/s");
    }
}
