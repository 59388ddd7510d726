//! Pictures of results folders: what is written, and what it shows.
#![allow(clippy::cast_sign_loss)]

use std::fs;
use std::path::{Path, PathBuf};

use amontons::case::{self, Source};
use amontons::contact::Status;
use amontons::mesh::{Diagonal, Mesh};
use amontons::output::{Folder, FolderOptions};
use amontons::plot::{
    self, ColorMap, ContactRow, ConvergencePlot, DrawnRun, ErrorSeries, HistoryColumns, Options, PictureKind,
    PlaneMesh, PlaneSnapshot, PlotError, RunPanel,
};
use amontons::run;
use amontons::units::Units;
use quick_xml::events::Event;
use tiny_skia::Pixmap;

/// An empty folder for a test.
fn fresh(name: &str) -> PathBuf {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("plot").join(name);
    if dir.exists() {
        fs::remove_dir_all(&dir).expect("the folder of an earlier test");
    }
    fs::create_dir_all(&dir).expect("a folder");
    dir
}

/// The results of the paper's example on a coarse mesh.
pub fn paper(name: &str, overrides: &[&str]) -> PathBuf {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases/paper.toml"))
        .expect("the paper's case");
    solved(name, text, overrides)
}

fn solved(name: &str, text: String, overrides: &[&str]) -> PathBuf {
    let dir = fresh(name);
    let overrides: Vec<String> = ["mesh.n=8", "time.steps=16"].iter().chain(overrides).map(|&o| o.to_owned()).collect();
    let case = case::parse(&Source::new("case.toml", text), &overrides).expect("a valid case");
    let mut folder = Folder::create(&dir, FolderOptions { force: true, ..FolderOptions::new(case.text.clone()) })
        .expect("a results folder");
    run::run(&case.problem, &run::Settings { certificate: false, ..run::Settings::default() }, &mut [&mut folder])
        .expect("a run");
    dir
}

/// A run with a given temperature on a rectangle of n × n cells and nothing else.
fn by_hand(n: usize, temperature: impl Fn(f64, f64) -> f64) -> DrawnRun {
    let mesh = Mesh::rectangle([1.0, 1.0], [n, n], Diagonal::Right).expect("a mesh");
    let snapshot = PlaneSnapshot {
        body: PlaneMesh::of_mesh(&mesh).expect("a plane mesh"),
        displacement: mesh.points.iter().map(|p| [0.1 * (3.0 * p[1]).sin(), 0.1 * (5.0 * p[0]).sin() * p[1]]).collect(),
        temperature: mesh.points.iter().map(|p| temperature(p[0], p[1])).collect(),
        von_mises: (0..mesh.cell_count()).map(|c| (0.001 * c as f64).sin().abs()).collect(),
        nodal_von_mises: Vec::new(),
        regions: Vec::new(),
    };
    DrawnRun { name: "by hand".to_owned(), dimension: 2, t: 0.5, snapshot: Some(snapshot), ..DrawnRun::default() }
}

/// The elements of an SVG document with their attributes; fails if it is not well-formed.
fn elements(svg: &str) -> Vec<(String, Vec<(String, String)>)> {
    let mut reader = quick_xml::Reader::from_str(svg);
    let mut found = Vec::new();
    loop {
        match reader.read_event().expect("well-formed XML") {
            Event::Start(tag) | Event::Empty(tag) => {
                let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("UTF-8");
                let attributes = tag
                    .attributes()
                    .map(|a| a.expect("an attribute"))
                    .map(|a| (text(a.key.as_ref()), a.unescape_value().expect("a value").into_owned()));
                found.push((text(tag.name().as_ref()), attributes.collect()));
            }
            Event::Eof => return found,
            _ => {}
        }
    }
}

fn attribute<'a>(element: &'a (String, Vec<(String, String)>), name: &str) -> Option<&'a str> {
    element.1.iter().find(|(n, _)| n == name).map(|(_, value)| value.as_str())
}

/// The texts that an SVG document shows.
fn texts(svg: &str) -> Vec<String> {
    elements(svg).iter().filter(|e| e.0 == "g").filter_map(|e| attribute(e, "aria-label")).map(str::to_owned).collect()
}

/// Place of the largest image of an SVG document: x, y, width, height.
fn largest_image(svg: &str) -> [f64; 4] {
    let places = elements(svg).into_iter().filter(|e| e.0 == "image");
    let place = |e: (String, Vec<(String, String)>)| {
        ["x", "y", "width", "height"].map(|name| attribute(&e, name).expect("a place").parse().expect("a number"))
    };
    places.map(place).max_by(|a: &[f64; 4], b: &[f64; 4]| (a[2] * a[3]).total_cmp(&(b[2] * b[3]))).expect("an image")
}

pub fn message<T>(result: Result<T, PlotError>) -> String {
    result.err().expect("an error").to_string()
}

#[test]
fn a_results_folder_has_all_pictures_twice() {
    let dir = paper("all", &["contact.heat.foundation_temperature=10"]);
    let paths = plot::folder(&dir, &Options::default()).expect("pictures");
    let names: Vec<String> =
        paths.iter().map(|p| p.strip_prefix(dir.join("plots")).expect("in plots").display().to_string()).collect();
    // Nothing wears: there is no picture of wear.
    let kinds = PictureKind::ALL.into_iter().filter(|kind| *kind != PictureKind::Wear);
    let expected: Vec<String> =
        kinds.flat_map(|k| [format!("{}.svg", k.file_name()), format!("{}.png", k.file_name())]).collect();
    assert_eq!(names, expected);
    for pair in paths.chunks(2) {
        let svg = fs::read_to_string(&pair[0]).expect("an SVG");
        let all = elements(&svg);
        let side = |name: &str| attribute(&all[0], name).expect("a size").parse::<f64>().expect("a number");
        let png = Pixmap::decode_png(&fs::read(&pair[1]).expect("a PNG")).expect("a valid PNG");
        assert_eq!(
            (f64::from(png.width()), f64::from(png.height())),
            (2.0 * side("width"), 2.0 * side("height")),
            "{}",
            pair[1].display()
        );
        assert!(all.iter().all(|e| e.0 != "text"), "no text that needs a font of the system");
        // Images may have any letters.
        let drawn: String = svg
            .split("base64,")
            .enumerate()
            .map(|(i, part)| if i == 0 { part } else { part.split_once('"').map_or("", |p| p.1) })
            .collect();
        assert!(!drawn.contains("NaN") && !drawn.contains("inf"), "{}: a coordinate is not finite", pair[0].display());
        assert!(texts(&svg)[0].starts_with("paper: "), "{:?}", texts(&svg)[0]);
    }
}

#[test]
fn labels_have_units_unless_the_case_has_none() {
    let dir = paper("units", &["units=\"SI\""]);
    let run = DrawnRun::read(&dir).expect("a run");
    let panels = [RunPanel { title: "", run: &run }];
    let labels = |kind: PictureKind, dimensionless: bool| {
        texts(&plot::picture(kind, &panels, &Options { dimensionless, ..Options::default() }).expect("a picture").svg())
    };
    let expected: [(PictureKind, &[&str]); 5] = [
        (PictureKind::Deformed, &["x (m)", "y (m)", "‖u‖ (mm)", "paper: displacement at t = 1 s", "foundation"]),
        (PictureKind::Temperature, &["θ (mK)"]),
        (PictureKind::VonMises, &["σvM (Pa)"]),
        (
            PictureKind::Contact,
            &[
                "paper: contact on \"bottom\" at t = 1 s",
                "pressure p (Pa)",
                "friction cone ‖στ‖ ≤ pτ",
                "slip velocity along s (mm/s)",
                "heat flux q·ν out of the body (mW/m²)",
                "friction work since the start (mJ/m²)",
                "arc length s along ΓC (m)",
                "open",
                "stick",
                "slip",
            ],
        ),
        (
            PictureKind::History,
            &[
                "contact force (N/m)",
                "time t (s)",
                "kinetic",
                "friction",
                "contact points",
                "power of friction (mW/m)",
                "area of contact (m²/m)",
            ],
        ),
    ];
    for (kind, words) in expected {
        let found = labels(kind, false);
        for word in words {
            assert!(found.iter().any(|label| label == word), "{kind:?} has no label {word:?}: {found:?}");
        }
        let bare = labels(kind, true);
        for unit in ["m)", "K)", "Pa)", "m/s)", "W/m)", "N/m)", "J/m)", "m²)", "²/m)", "(s)", "1 s"] {
            assert!(
                !bare.iter().any(|label| label.ends_with(unit)),
                "{kind:?} has the unit {unit} without dimensions: {bare:?}"
            );
        }
    }
}

#[test]
fn a_field_has_the_colours_of_its_values_at_its_places() {
    let f = |x: f64, y: f64| 2.0 * x + y;
    let mut run = by_hand(16, f);
    // Fields are drawn on the body as it stands.
    run.snapshot.iter_mut().for_each(|snapshot| snapshot.displacement.fill([0.0; 2]));
    let picture = plot::picture(PictureKind::Temperature, &[RunPanel { title: "", run: &run }], &Options::default())
        .expect("a picture");
    let [x, y, width, height] = largest_image(&picture.svg());
    assert!((width - height).abs() < 1e-9, "a square body is {width} by {height}");
    let png = Pixmap::decode_png(&picture.png(2.0).expect("a PNG")).expect("a valid PNG");
    // Away from the level lines, which are at multiples of 0.5.
    for (px, py) in [(0.1, 0.15), (0.5, 0.3), (0.77, 0.9), (0.95, 0.35)] {
        let place = [2.0 * (x + px * width), 2.0 * (y + (1.0 - py) * height)];
        let found = png.pixel(place[0] as u32, place[1] as u32).expect("a pixel");
        let expected = ColorMap::Inferno.at(f(px, py) / 3.0);
        let off = [found.red(), found.green(), found.blue()].iter().zip(expected).map(|(a, b)| a.abs_diff(b)).max();
        assert!(off <= Some(3), "at ({px}, {py}): {found:?}, expected {expected:?}");
    }
}

#[test]
fn the_colour_bar_runs_from_the_least_to_the_greatest() {
    let run = by_hand(4, |x, _| 20.0 + 30.0 * x);
    let found = texts(
        &plot::picture(PictureKind::Temperature, &[RunPanel { title: "", run: &run }], &Options::default())
            .expect("a picture")
            .svg(),
    );
    for label in ["20", "25", "30", "35", "40", "45", "50", "min 20, max 50 K at the nodes"] {
        assert!(found.iter().any(|l| l == label), "no {label}: {found:?}");
    }
}

#[test]
fn pictures_of_a_large_mesh_stay_small() {
    let run = by_hand(256, |x, y| (9.0 * x).sin() * (7.0 * y).cos());
    for kind in [PictureKind::Deformed, PictureKind::Temperature, PictureKind::VonMises] {
        let svg =
            plot::picture(kind, &[RunPanel { title: "", run: &run }], &Options::default()).expect("a picture").svg();
        assert!(svg.len() < 2_000_000, "{kind:?}: {} bytes", svg.len());
        elements(&svg);
    }
}

#[test]
fn runs_stand_side_by_side_under_their_titles() {
    let dirs = [paper("left", &[]), paper("right", &["contact.heat.foundation_temperature=10"])];
    let out = fresh("side by side");
    let runs = [("θ_{F} = 0", dirs[0].as_path()), ("θ_{F} = 10", dirs[1].as_path())];
    for kind in PictureKind::ALL.into_iter().filter(|kind| *kind != PictureKind::Wear) {
        let stem = out.join("deeper").join(kind.file_name());
        let [svg, png] = plot::side_by_side(kind, &runs, &stem, &Options::default()).expect("a picture");
        let found = texts(&fs::read_to_string(svg).expect("an SVG"));
        assert!(
            ["θF = 0", "θF = 10"].iter().all(|title| found.iter().any(|label| label == title)),
            "{kind:?}: {found:?}"
        );
        Pixmap::decode_png(&fs::read(png).expect("a PNG")).expect("a valid PNG");
    }
    let read: Vec<DrawnRun> = dirs.iter().map(|dir| DrawnRun::read(dir).expect("a run")).collect();
    let panels = [RunPanel { title: "a", run: &read[0] }, RunPanel { title: "b", run: &read[1] }];
    let numbers = |shared_scale: bool| {
        texts(
            &plot::picture(PictureKind::Temperature, &panels, &Options { shared_scale, ..Options::default() })
                .expect("a picture")
                .svg(),
        )
    };
    // The colder run reaches 0.09: only a scale of its own has such marks.
    assert!(numbers(false).iter().any(|l| l == "0.02") && !numbers(true).iter().any(|l| l == "0.02"));
}

#[test]
fn contact_at_gauss_points_and_runs_without_contact() {
    let dir = paper("gauss", &["contact.quadrature=\"gauss\"", "mesh.diagonal=\"crossed\""]);
    let run = DrawnRun::read(&dir).expect("a run");
    assert_eq!(run.contact.len(), 16);
    assert!(run.contact.iter().all(|row| row.bound.is_some_and(|b| (b - 0.2 * row.pressure).abs() < 1e-15)));
    assert_eq!(plot::folder(&dir, &Options::default()).expect("pictures").len(), 10);

    let text = fs::read_to_string(dir.join("case.toml")).expect("the case");
    let mut case: toml::Table = text.parse().expect("TOML");
    case.remove("contact");
    let dir = solved("without contact", case.to_string(), &[]);
    let paths = plot::folder(&dir, &Options::default()).expect("pictures");
    assert_eq!(paths.len(), 8, "{paths:?}");
    let found = texts(&fs::read_to_string(dir.join("plots/history.svg")).expect("an SVG"));
    assert!(!found.iter().any(|label| label.contains("contact")), "{found:?}");
}

#[test]
fn a_body_on_a_line_has_a_history_only() {
    let dir = paper("line", &[]);
    let vtu = "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\"><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"3\">\
        <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 2 0 0 3 0 0</DataArray></Points>\
        <Cells><DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 1 2 2 3</DataArray>\
        <DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">2 4 6</DataArray>\
        <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">3 3 3</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>";
    fs::write(dir.join("fields/line.vtu"), vtu).expect("a file");
    let pvd = "<VTKFile type=\"Collection\"><Collection><DataSet timestep=\"0\" file=\"none.vtu\"/><DataSet timestep=\"1\" file=\"fields/line.vtu\"/></Collection></VTKFile>";
    fs::write(dir.join("fields.pvd"), pvd).expect("a file");
    let paths = plot::folder(&dir, &Options::default()).expect("pictures");
    assert_eq!(paths, [dir.join("plots/history.svg"), dir.join("plots/history.png")]);
    let run = DrawnRun::read(&dir).expect("a run");
    assert_eq!(run.dimension, 1);
    let message =
        message(plot::picture(PictureKind::Deformed, &[RunPanel { title: "", run: &run }], &Options::default()));
    assert!(message.contains("paper") && message.contains("deformed"), "{message}");
}

#[test]
fn data_that_do_not_fit_are_refused() {
    let picture =
        |run: &DrawnRun| plot::picture(PictureKind::VonMises, &[RunPanel { title: "", run }], &Options::default());
    let mut run = by_hand(2, |x, _| x);
    if let Some(snapshot) = &mut run.snapshot {
        snapshot.von_mises.pop();
    }
    assert!(message(picture(&run)).contains("the von Mises stress has 7 values, expected 8"));
    let mut run = by_hand(2, |x, _| x);
    if let Some(snapshot) = &mut run.snapshot {
        snapshot.temperature[3] = f64::NAN;
    }
    assert!(message(picture(&run)).contains("the temperature has values that are not finite"));
    assert!(message(plot::picture(PictureKind::History, &[], &Options::default())).contains("history"));
    let run = by_hand(2, |x, _| x);
    let picture = picture(&run).expect("a picture");
    for pixels in [0.0, -1.0, 1e6, f64::NAN] {
        assert!(message(picture.png(pixels)).contains("pixels"), "{pixels}");
    }
    let nowhere = fresh("nowhere").join("none").join("picture");
    assert!(message(picture.save(&nowhere, 1.0)).contains("cannot write"));
}

#[test]
fn uniform_fields_and_undeformed_bodies_are_drawn() {
    let mut run = by_hand(3, |_, _| 7.0);
    if let Some(snapshot) = &mut run.snapshot {
        snapshot.displacement.fill([0.0; 2]);
        snapshot.von_mises.fill(0.0);
    }
    for kind in [PictureKind::Deformed, PictureKind::Temperature, PictureKind::VonMises] {
        let picture =
            plot::picture(kind, &[RunPanel { title: "", run: &run }], &Options::default()).expect("a picture");
        assert!(!picture.svg().contains("NaN"));
        picture.png(1.0).expect("a PNG");
    }
}

#[test]
fn scale_factors_are_nice_and_keep_the_displacement_below_a_fifth() {
    for (displacement, size, factor) in [
        (0.0641, 1.0, 2.0),
        (0.02, 1.0, 10.0),
        (1e-6, 3.0, 500_000.0),
        (0.3, 1.0, 1.0),
        (50.0, 1.0, 1.0),
        (0.0, 1.0, 1.0),
        (0.04, 1.0, 5.0),
        (0.0021, 1.0, 50.0),
    ] {
        let found = plot::scale_factor(displacement, size);
        assert!((found - factor).abs() < 1e-9 * factor, "{displacement} on {size}: {found}, expected {factor}");
    }
}

fn study() -> ConvergencePlot {
    let sizes = vec![1.0 / 16.0, 1.0 / 32.0, 1.0 / 64.0];
    let series = |label: &str, order: i32| ErrorSeries {
        label: label.to_owned(),
        errors: sizes.iter().map(|h: &f64| 0.3 * h.powi(order)).collect(),
    };
    let series = vec![series("E^{hk}", 1), series("u", 2)];
    ConvergencePlot {
        title: "θ_{F} = 0".to_owned(),
        sizes,
        x_label: "h = k".to_owned(),
        y_label: "error".to_owned(),
        has_orders: true,
        series,
    }
}

#[test]
fn a_study_shows_levels_orders_and_the_slope() {
    let picture = plot::convergence(&study()).expect("a picture");
    let found = texts(&picture.svg());
    for label in ["Ehk, order 1.00", "u, order 2.00", "1/16", "1/32", "1/64", "h = k", "error", "θF = 0", "10−2", "1"]
    {
        assert!(found.iter().any(|l| l == label), "no {label}: {found:?}");
    }
    picture.png(1.0).expect("a PNG");
    let both = plot::convergence_panels("Errors", &[study(), study()]).expect("a picture");
    assert!((both.size().0 - 2.0 * picture.size().0).abs() < 40.0);
}

#[test]
fn a_study_is_read_from_its_table() {
    let dir = fresh("study");
    let csv = |k: [&str; 2], h: [&str; 2]| {
        format!(
            "level,h,k,error_w,error_u,error_theta,error,order\n8,{},{},1e-2,2e-2,0e0,3e-2,\n16,{},{},5e-3,1e-2,0e0,1.5e-2,1.0\n",
            h[0], k[0], h[1], k[1]
        )
    };
    for (k, h, label) in [
        (["0.125", "0.0625"], ["0.125", "0.0625"], "h = k"),
        (["0.125", "0.0625"], ["0.1", "0.1"], "k (s)"),
        (["0.1", "0.1"], ["0.2", "0.1"], "h (m)"),
    ] {
        fs::write(dir.join("convergence.csv"), csv(k, h)).expect("a file");
        let paths = plot::folder(&dir, &Options::default()).expect("a picture");
        assert_eq!(paths, [dir.join("plots/convergence.svg"), dir.join("plots/convergence.png")]);
        let found = texts(&fs::read_to_string(&paths[0]).expect("an SVG"));
        assert!(found.iter().any(|l| l == label) && found.iter().any(|l| l == "Ehk, order 1.00"), "{found:?}");
    }
    fs::write(dir.join("convergence.csv"), csv(["2", "1"], ["1", "0"])).expect("a file");
    assert!(message(plot::folder(&dir, &Options::default())).contains("expected a positive number"));
}

#[test]
fn studies_that_do_not_fit_are_refused() {
    let mut plot = study();
    plot.series[1].errors.pop();
    assert!(message(plot::convergence(&plot)).contains("u has 2 errors for 3 levels"));
    let mut plot = study();
    plot.series.clear();
    assert!(message(plot::convergence(&plot)).contains("no positive error"));
    let mut plot = study();
    plot.series[0].errors[0] = f64::NAN;
    assert!(message(plot::convergence(&plot)).contains("Ehk"));
}

#[test]
fn names_with_signs_of_xml_are_escaped() {
    let mut run = by_hand(2, |x, _| x);
    run.name = "a<b> & \"c\" \u{7} 漢".to_owned();
    let svg = plot::picture(PictureKind::Temperature, &[RunPanel { title: "", run: &run }], &Options::default())
        .expect("a picture")
        .svg();
    assert!(texts(&svg)[0].starts_with("a<b> & \"c\"  漢: temperature"), "{:?}", texts(&svg)[0]);
}

/// Wear, friction and a warm foundation that a run does not have are not drawn; a power is the slope of the work, a
/// temperature bears its side.
#[test]
fn histories_show_what_there_is() {
    let labels = |history: &[(&str, [f64; 2])]| {
        let history: HistoryColumns =
            history.iter().map(|(name, column)| ((*name).to_owned(), column.to_vec())).collect();
        let run = DrawnRun { history, dimension: 3, snapshot: None, units: Units::SPACE, ..by_hand(1, |x, _| x) };
        texts(
            &plot::picture(PictureKind::History, &[RunPanel { title: "", run: &run }], &Options::default())
                .expect("a picture")
                .svg(),
        )
    };
    let rest = [("t", [1.0, 3.0]), ("slip", [4.0, 4.0]), ("wear_max", [0.0; 2]), ("friction_dissipation", [0.0; 2])];
    let added = [
        "power of friction",
        "temperature of the foundation",
        "largest depth worn off",
        "area of contact",
        "volume worn off",
    ];
    let plain = labels(&rest);
    assert!(!plain.iter().any(|label| added.iter().any(|word| label.starts_with(word))), "{plain:?}");
    // 20 J within 10 ms are 2 kW, those since the start 26 W.
    let worn =
        [("t", [1.0, 1.01]), ("slip", [4.0, 4.0]), ("friction_dissipation", [7.0, 27.0]), ("wear_max", [1.0, 2.0])];
    let found = labels(
        &[
            &worn[..],
            &[
                ("foundation_temperature@left", [5.0, 6.0]),
                ("heat_foundation", [1.0, 2.0]),
                ("heat_contact", [1.0, 2.0]),
            ],
        ]
        .concat(),
    );
    for word in [
        "power of friction (kW)",
        "2.0",
        "temperature of the foundation (K)",
        "left",
        "largest depth worn off (m)",
        "content of the foundation",
    ] {
        assert!(found.iter().any(|label| label == word), "no {word}: {found:?}");
    }
}

/// A run by hand whose points on the bottom are in contact up to a place.
fn in_contact(n: usize, up_to: f64, temperature: impl Fn(f64, f64) -> f64) -> DrawnRun {
    let mut run = by_hand(n, temperature);
    run.snapshot.iter_mut().for_each(|snapshot| snapshot.displacement.fill([0.0; 2]));
    let row = |i: usize| {
        let x = i as f64 / n as f64;
        let closed = x <= up_to;
        ContactRow {
            x: [x, 0.0],
            penetration: 0.0,
            pressure: f64::from(u8::from(closed)),
            point_pressure: f64::from(u8::from(closed)),
            bound: None,
            traction: [0.0; 3],
            slip_velocity: [0.0; 3],
            status: if closed { Status::Stick } else { Status::Open },
            temperature: 0.0,
            opposite_temperature: f64::NAN,
            heat_flux: 0.0,
            wear: 0.0,
            friction_work: 0.0,
            side: 0,
        }
    };
    run.contact = (0..=n).map(row).collect();
    run
}

/// Beside a body stands its contact where this is small: on the same colours, each value at its place.
#[test]
fn a_small_contact_is_enlarged() {
    let f = |x: f64, y: f64| 2.0 * x + y;
    let draw =
        |run: &DrawnRun, kind: PictureKind| plot::picture(kind, &[RunPanel { title: "", run }], &Options::default());
    let run = in_contact(16, 0.125, f);
    for kind in [PictureKind::Deformed, PictureKind::Temperature, PictureKind::VonMises] {
        let found = texts(&draw(&run, kind).expect("a picture").svg());
        assert!(found.iter().any(|label| label == "contact, enlarged × 5.6"), "{kind:?}: {found:?}");
        let large = draw(&in_contact(16, 0.5, f), kind).expect("a picture").svg();
        let open = draw(&in_contact(16, -1.0, f), kind).expect("a picture").svg();
        assert!(!large.contains("enlarged") && !open.contains("enlarged"), "{kind:?}");
    }
    let picture = draw(&run, PictureKind::Temperature).expect("a picture");
    let svg = picture.svg();
    let mut places: Vec<[f64; 4]> = elements(&svg)
        .into_iter()
        .filter(|e| e.0 == "image")
        .map(|e| ["x", "y", "width", "height"].map(|n| attribute(&e, n).expect("a place").parse().expect("a number")))
        .collect();
    places.sort_by(|a, b| (b[2] * b[3]).total_cmp(&(a[2] * a[3])));
    let enlarged = places.iter().take(2).max_by(|a, b| a[0].total_cmp(&b[0])).expect("two bodies");
    // The window of the body is wider than it by 6 % on each side; that of the contact has its shape, and lies within.
    let side = 1.12 / 5.6;
    let (left, bottom) = (0.0625 - 0.5 * side, -0.06);
    let png = Pixmap::decode_png(&picture.png(2.0).expect("a PNG")).expect("a valid PNG");
    for (px, py) in [(0.05, 0.02), (0.11, 0.03), (0.02, 0.09)] {
        let [x, y, width, height] = *enlarged;
        let place = [2.0 * (x + (px - left) / side * width), 2.0 * (y + (1.0 - (py - bottom) / side) * height)];
        let found = png.pixel(place[0] as u32, place[1] as u32).expect("a pixel");
        let expected = ColorMap::Inferno.at(f(px, py) / 3.0);
        let off = [found.red(), found.green(), found.blue()].iter().zip(expected).map(|(a, b)| a.abs_diff(b)).max();
        assert!(off <= Some(4), "at ({px}, {py}): {found:?}, expected {expected:?}");
    }
}

/// Sheets of many times and of many runs are at most 4000 units wide and high, and say how many of them they show.
#[test]
fn no_sheet_in_the_plane_is_longer_than_4000_units() {
    for up_to in [0.125, 0.5] {
        let runs: Vec<DrawnRun> =
            (0..70).map(|i| DrawnRun { t: f64::from(i), ..in_contact(8, up_to, |x, _| x) }).collect();
        let titles: Vec<String> = (0..70).map(|i| format!("t = {i} s")).collect();
        let panels: Vec<RunPanel> = runs.iter().zip(&titles).map(|(run, title)| RunPanel { title, run }).collect();
        for kind in [PictureKind::Deformed, PictureKind::Temperature, PictureKind::Contact] {
            let picture = plot::picture(kind, &panels, &Options::default()).expect("a picture");
            let (width, height) = picture.size();
            assert!(width <= 4000.0 && height <= 4000.0, "{kind:?}: {width} × {height}");
            let found = texts(&picture.svg());
            let shown = (1..70).find(|n| found.contains(&format!("{n} of 70 times shown"))).expect("a note");
            assert_eq!(titles.iter().filter(|title| found.contains(title)).count(), shown, "{kind:?}");
            assert!(found.contains(&"t = 69 s".to_owned()), "{kind:?}");
        }
    }
}

/// A chart of zeros has the number 0 alone, and a field that is the same but for round-off has no scale of its own.
#[test]
fn scales_have_no_numbers_beyond_the_data() {
    let draw = |run: &DrawnRun, kind: PictureKind| {
        let picture = plot::picture(kind, &[RunPanel { title: "", run }], &Options::default()).expect("a picture");
        texts(&picture.svg())
    };
    let found = draw(&in_contact(8, -1.0, |x, _| x), PictureKind::Contact);
    assert!(found.iter().any(|label| label == "0"), "{found:?}");
    assert!(!found.iter().any(|label| label == "−1.0" || label == "−0.5"), "{found:?}");
    let found = draw(&by_hand(8, |x, _| 25.0 + 1e-12 * x), PictureKind::Temperature);
    assert!(found.iter().any(|label| label == "min 25, max 25 K at the nodes"), "{found:?}");
    let marks: Vec<&String> = found.iter().filter(|label| label.starts_with("25.000")).collect();
    assert!(marks.is_empty(), "{marks:?}");
}
