//! Decks in several files: what is skipped is told, and a change of a part is noticed.

use std::fs;
use std::path::Path;

use crate::common::{amontons, assert_code, json, output, stderr, stdout};
use tempfile::tempdir;

const NODES: &str = "*NODE, NSET=Nall\n1,0,0\n2,3,0\n3,3,2\n4,0,2\n*MATERIAL, NAME=M\n";
const DECK: &str = "*INCLUDE, INPUT=parts/nodes.nam\n*ELEMENT, TYPE=CPS4, ELSET=E\n1,1,2,3,4\n*SURFACE, NAME=LOW\n1,S1\n\
    *SURFACE, NAME=HIGH\n1,S3\n*ELEMENT, TYPE=MASS, ELSET=TIP\n7,3\n8,4\n*STEP\n*STATIC\n*END STEP\n";
const CASE: &str = "name = \"plate\"\n[mesh]\nfile = \"main.inp\"\n[time]\nend = 1\nsteps = 2\n[material]\nheat_capacity = 1\n\
    conductivity = 1\n[[boundary]]\non = \"LOW\"\ntemperature = 1\n[[boundary]]\non = \"HIGH\"\nheat_inflow = 3\n";

fn plate(folder: &Path) {
    fs::create_dir_all(folder.join("parts")).expect("a folder");
    for (name, text) in [("parts/nodes.nam", NODES), ("main.inp", DECK), ("plate.toml", CASE)] {
        fs::write(folder.join(name), text).expect("a file");
    }
}

#[test]
fn a_deck_in_parts_is_shown() {
    let folder = tempdir().expect("a folder");
    plate(folder.path());
    let printed = output(amontons(&["mesh", "main.inp", "--confine"]).current_dir(&folder));
    assert_code(&printed, 0);
    for line in [
        "  side \"HIGH\"       1 facet, length 3\n",
        "  side \"Nall\"       4 facets, length 10, the whole boundary\n",
        "  skipped           *MATERIAL (parts/nodes.nam, line 6)\n",
        "  skipped           elements of type MASS (line 8, 2 of them)\n",
    ] {
        assert!(stdout(&printed).contains(line), "{line}\n{}", stdout(&printed));
    }
    let shown = json(&output(amontons(&["mesh", "main.inp", "--format", "json"]).current_dir(&folder)));
    let sides = shown["mesh"]["sides"].as_array().expect("sides");
    let whole: Vec<_> =
        sides.iter().filter(|side| side["is_whole_boundary"] == true).map(|side| &side["name"]).collect();
    assert_eq!(whole, ["Nall"]);
    fs::rename(folder.path().join("main.inp"), folder.path().join("parts/main.inp")).expect("a file");
    fs::write(folder.path().join("parts/main.inp"), DECK.replace("parts/", "../")).expect("a file");
    fs::write(folder.path().join("nodes.nam"), NODES).expect("a file");
    assert_code(&output(amontons(&["mesh", "parts/main.inp"]).current_dir(&folder)), 0);
    let printed = output(amontons(&["mesh", "parts/main.inp", "--confine"]).current_dir(&folder));
    assert_code(&printed, 2);
    assert!(stderr(&printed).contains("line 1: found *INCLUDE of \"../nodes.nam\""), "{}", stderr(&printed));
}

/// `check` and `run` say in one line what the mesh file has besides, and `check` gives it as data.
#[test]
fn what_was_skipped_is_repeated() {
    let folder = tempdir().expect("a folder");
    plate(folder.path());
    let line = "*MATERIAL; elements of type MASS (2); element sets without a cell of the body: \"TIP\"; *STEP; and 2 more, which `amontons mesh FILE` lists";
    let printed = output(amontons(&["check", "plate.toml"]).current_dir(&folder));
    assert_code(&printed, 0);
    assert!(stdout(&printed).contains(&format!("  not of the mesh   {line}\n")), "{}", stdout(&printed));
    let checked = json(&output(amontons(&["check", "plate.toml", "--format", "json"]).current_dir(&folder)));
    assert_eq!(checked["skipped"].as_array().map(Vec::len), Some(6));
    assert_eq!(
        (&checked["skipped"][0]["file"], &checked["skipped"][0]["line"]),
        (&"parts/nodes.nam".into(), &6.into())
    );
    assert_eq!(
        (&checked["skipped"][1]["count"], &checked["skipped"][1]["file"]),
        (&2.into(), &serde_json::Value::Null)
    );
    let printed = output(amontons(&["run", "plate.toml"]).current_dir(&folder));
    assert_code(&printed, 0);
    assert!(stdout(&printed).contains(&format!("  not of the mesh   {line}\n")), "{}", stdout(&printed));
    assert!(stderr(&output(amontons(&["run", "plate.toml", "--quiet", "--force"]).current_dir(&folder))).is_empty());
}

/// The results keep the mesh with its parts. A run goes on from them without the files of the case, and not with
/// another mesh.
#[test]
fn results_keep_the_parts_of_a_deck() {
    let folder = tempdir().expect("a folder");
    plate(folder.path());
    assert_code(&output(amontons(&["run", "plate.toml", "--quiet"]).current_dir(&folder)), 0);
    fs::remove_file(folder.path().join("parts/nodes.nam")).expect("a file");
    let results = folder.path().join("results/plate");
    let longer = ["resume", "results/plate", "--quiet", "--set", "time.end=2", "--set", "time.steps=4"];
    assert_code(&output(amontons(&longer).current_dir(&folder)), 0);
    let copy = results.join("inputs/main.inp");
    let text = fs::read_to_string(&copy).expect("a copy");
    assert!(text.contains("3,3,2\n") && text.contains("** *INCLUDE of parts/nodes.nam"), "{text}");
    fs::write(&copy, text.replace("3,3,2\n", "3,3,2.5\n")).expect("a copy");
    let further = ["resume", "results/plate", "--quiet", "--set", "time.end=3", "--set", "time.steps=6"];
    let printed = output(amontons(&further).current_dir(&folder));
    assert_code(&printed, 2);
    assert!(stderr(&printed).contains("another case"), "{}", stderr(&printed));
}
