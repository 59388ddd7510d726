//! Pictures of results folders with missing and damaged files: what is said of them.

use std::fs;

use super::plot::{message, paper};
use amontons::plot::{self, DrawnRun, Options};

/// What spoils the text of a file.
type Damage = Box<dyn Fn(&str) -> String>;

#[test]
fn missing_files_are_named() {
    for (name, error) in [
        ("case.toml", "cannot read"),
        ("fields.pvd", "cannot read"),
        ("contact.csv", "cannot read"),
        ("history.csv", "cannot read"),
    ] {
        let dir = paper(&format!("missing {name}"), &[]);
        fs::remove_file(dir.join(name)).expect("a file to remove");
        let message = message(plot::folder(&dir, &Options::default()));
        assert!(message.contains(error) && message.contains(name), "{message}");
        assert!(!dir.join("plots").exists(), "a folder for pictures that were not drawn");
    }
}

#[test]
fn damaged_files_are_named_with_what_is_wrong() {
    let dir = paper("damaged", &[]);
    let vtu = fs::read_dir(dir.join("fields")).expect("fields").next().expect("a file").expect("a file").path();
    let vtu = vtu.strip_prefix(&dir).expect("in the folder").display().to_string();
    let replaced =
        |old: &'static str, new: &'static str| -> Damage { Box::new(move |text| text.replacen(old, new, 1)) };
    let faults: Vec<(&str, Damage, &str)> = vec![
        ("contact.csv", replaced("penetration", "depth"), "no column penetration"),
        ("contact.csv", replaced("open", "ajar"), "`ajar`"),
        ("contact.csv", Box::new(|text| text.replacen("\n0,0,0,", "\n0,0,zero,", 1)), "row 1: y is `zero`"),
        ("contact.csv", Box::new(|text| format!("{text}1,2,3\n")), "3 values under"),
        ("contact.csv", Box::new(|text| format!("{}m\n", text.trim_end())), "opposite_temperature is"),
        ("history.csv", replaced("step,t,", "step,time,"), "no column t"),
        ("history.csv", Box::new(|text| text.replace("e-", "e999")), "row 1"),
        ("case.toml", Box::new(|text| format!("{text}\n[[")), "case.toml"),
        ("fields.pvd", replaced("<DataSet", "<Nothing"), "names no DataSet"),
        ("fields.pvd", replaced("timestep=\"", "timestep=\"x"), "no timestep"),
        (&vtu, replaced("Name=\"von_mises\"", "Name=\"mises\""), "no array von_mises"),
        (
            &vtu,
            replaced(
                "Name=\"displacement\" NumberOfComponents=\"3\"",
                "Name=\"displacement\" NumberOfComponents=\"2\"",
            ),
            "displacement",
        ),
        (
            &vtu,
            replaced("NumberOfComponents=\"3\" format=\"binary\"", "NumberOfComponents=\"3\" format=\"appended\""),
            "appended",
        ),
        (
            &vtu,
            replaced("type=\"Float64\" Name=\"temperature\"", "type=\"Float16\" Name=\"temperature\""),
            "the array temperature",
        ),
        (&vtu, replaced("<Points>", "<Dots>"), "well-formed"),
        (&vtu, Box::new(|text| text[..text.len() / 2].to_owned()), ""),
        (&vtu, Box::new(|_| String::new()), "one Piece"),
    ];
    for (name, damage, expected) in &faults {
        let path = dir.join(name);
        let sound = fs::read_to_string(&path).expect("a file");
        let damaged = damage(&sound);
        assert_ne!(damaged, sound, "{name} is not damaged ({expected})");
        fs::write(&path, damaged).expect("a file");
        let message = message(plot::folder(&dir, &Options::default()));
        assert!(message.contains(name) && message.contains(expected), "{name}, {expected}: {message}");
        fs::write(&path, sound).expect("a file");
    }
    plot::folder(&dir, &Options::default()).expect("the folder is sound again");
}

#[test]
fn no_damage_of_a_field_file_is_fatal() {
    let dir = paper("cut", &["mesh.n=2"]);
    let vtu = fs::read_dir(dir.join("fields")).expect("fields").next().expect("a file").expect("a file").path();
    let sound = fs::read(&vtu).expect("a file");
    for i in 0..400 {
        let mut damaged = sound.clone();
        let place = (i * 7919) % sound.len();
        if i % 2 == 0 {
            damaged.truncate(place);
        } else {
            damaged[place] = b"A9<\"/ ="[i % 7];
        }
        fs::write(&vtu, damaged).expect("a file");
        // Whether it is read depends on the place; that it returns is what counts.
        if let Err(error) = DrawnRun::read(&dir) {
            assert!(error.to_string().contains(&vtu.display().to_string()), "{error}");
        }
    }
}
