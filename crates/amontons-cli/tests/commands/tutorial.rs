//! The tutorials of the guide, step by step as their readers type them; what they show is what the program prints.

use std::fs;
use std::path::Path;

use crate::common::{amontons, assert_code, output, read, stderr, stdout, summary};

/// The blocks of a chapter with their languages, in order.
fn blocks(text: &str) -> Vec<(String, String)> {
    let mut parts = text.split("```");
    parts.next();
    let mut all = Vec::new();
    while let (Some(block), Some(_)) = (parts.next(), parts.next()) {
        let (language, body) = block.split_once('\n').expect("a block of lines");
        all.push((language.to_owned(), body.to_owned()));
    }
    all
}

/// The words of a line in a shell; double quotes hold words together.
fn words(line: &str) -> Vec<String> {
    let pieces = line.split('"').enumerate();
    let of = |(i, piece): (usize, &str)| match i % 2 {
        1 => vec![piece.to_owned()],
        _ => piece.split_whitespace().map(str::to_owned).collect(),
    };
    pieces.flat_map(of).collect()
}

/// A text without what differs between machines: times, what a solver is predicted to take, and the sums of forces
/// that are round-off.
fn lasting(text: &str) -> Vec<String> {
    let line = |line: &str| {
        let own = ["  time  ", "  linear systems  ", "  per step  ", "  energy closes to ", "  defect of moments "];
        match own.iter().find(|start| line.starts_with(**start)) {
            Some(start) => (*start).to_owned(),
            None if line.contains(" pN/m") => line.split(" pN/m").nth(1).unwrap_or_default().to_owned(),
            // Of two places that mirror each other round-off decides which is named.
            None if line.starts_with("Warning (strain)") => {
                line.split(" at (").flat_map(|part| part.split("): ")).take(1).collect()
            }
            None if line.contains(": done, ") => line.split(" in ").next().unwrap_or_default().to_owned(),
            None => line.to_owned(),
        }
    };
    // The time of a run and the times of its phases begin alike.
    text.lines().map(|text| if text.contains("steps of") { text.to_owned() } else { line(text) }).collect()
}

/// Commands of a block in a folder; what they print.
fn typed(commands: &str, folder: &Path) -> String {
    let mut printed = String::new();
    for line in commands.lines() {
        let words = words(line);
        assert_eq!(words[0], "amontons", "{line}");
        let arguments: Vec<&str> = words[1..].iter().map(String::as_str).collect();
        let done = output(amontons(&arguments).current_dir(folder));
        assert_code(&done, 0);
        assert_eq!(stderr(&done), "", "{line}");
        printed += &stdout(&done);
    }
    printed
}

#[test]
fn every_command_of_the_tutorial_prints_what_it_shows() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let chapter = read(&root.join("book/src/tutorial.md"));
    let folder = tempfile::tempdir().expect("a folder");
    fs::copy(root.join("cases/o-ring.inp"), folder.path().join("o-ring.inp")).expect("a mesh");
    let (mut printed, mut commands, mut shown) = (String::new(), 0, 0);
    for (language, body) in blocks(&chapter) {
        match language.as_str() {
            "toml" => fs::write(folder.path().join("seal.toml"), body).expect("a case"),
            "sh" => {
                printed = typed(&body, folder.path());
                commands += 1;
            }
            "text" => {
                assert_eq!(lasting(&printed), lasting(&body), "the program printed:\n{printed}");
                shown += 1;
            }
            other => panic!("a block of {other}"),
        }
    }
    assert_eq!((commands, shown), (6, 5));
    assert!(read(&folder.path().join("results/seal/report.html")).contains("<title>seal</title>"));
    // The figures of the text: the force of Hertz is 3 % more, and half the stroke is less than half the force.
    let force = |name: &str| {
        let summary = summary(&folder.path().join("results").join(name));
        summary["final"]["contact"]["sides"]["lower"]["force"][1].as_f64().expect("a force")
    };
    let (whole, half) = (force("seal"), force("half"));
    assert!((1109.0 / whole - 1.03).abs() < 0.005, "{whole}");
    assert!(half < 0.5 * whole, "{half}");
}

/// A deck becomes a case that has what the page shows of it, and runs as the page shows.
#[test]
fn every_command_of_the_page_on_decks_prints_what_it_shows() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let chapter = read(&root.join("book/src/decks.md"));
    let folder = tempfile::tempdir().expect("a folder");
    fs::copy(root.join("cases/punch.inp"), folder.path().join("punch.inp")).expect("a deck");
    let (mut printed, mut counts) = (String::new(), [0; 3]);
    for (language, body) in blocks(&chapter) {
        match language.as_str() {
            "sh" => {
                printed = typed(&body, folder.path());
                counts[0] += 1;
            }
            "text" => {
                assert_eq!(lasting(&printed), lasting(&body), "the program printed:\n{printed}");
                counts[1] += 1;
            }
            "toml,ignore" => {
                let case = read(&folder.path().join("punch.toml"));
                assert!(case.contains(&body), "{body}\nis not in\n{case}");
                counts[2] += 1;
            }
            other => panic!("a block of {other}"),
        }
    }
    assert_eq!(counts, [2, 2, 2]);
    // The table of the page has the reactions of the run beside those of CalculiX, 1 % apart at most.
    let probes = read(&folder.path().join("results/punch/probes.csv"));
    let rows: Vec<Vec<f64>> = probes
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect())
        .collect();
    let cells = |line: &str| -> Vec<f64> {
        line.split('|').filter_map(|cell| cell.split_whitespace().next()?.parse().ok()).collect()
    };
    let shown: Vec<Vec<f64>> =
        chapter.lines().filter(|line| line.starts_with("| ") && line.contains(" N |")).map(cells).collect();
    assert_eq!(shown.len(), 4);
    for row in shown {
        let run = rows.iter().find(|own| (own[1] - row[0]).abs() < 1e-9).expect("the time");
        assert!((run[3] - row[1]).abs() < 0.006 && (run[2] - row[3]).abs() < 0.006, "{run:?} {row:?}");
        assert!((row[1] / row[2] - 1.0).abs() < 0.01 && (row[3] - row[4]).abs() < 0.1, "{row:?}");
    }
}
