//! The readers, each with its valid inputs.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use amontons::case::{self, Case, Files, Source};
use amontons::expression::Expression;
use amontons::mesh::{self, MeshFile, MeshFileError, exodus, gmsh, mail, med, vtu};
use amontons::output::{Checkpoint, Folder, FolderOptions};
use amontons::plot;
use amontons::run::{self, Settings};
use amontons::verify::{BENCHMARKS, recompute};
use sha2::{Digest, Sha256};

/// A case that runs within moments.
const SMALL: &str = r#"
name = "small"
[mesh]
kind = "rectangle"
size = [1.0, 1.0]
n = 2
[time]
end = 1.0
steps = 3
[material]
density = 1
heat_capacity = 1
expansion = 0.1
coupling = 0.1
conductivity = 1
elasticity = { law = "isotropic", young = 10.0, poisson = 0.2, stress_state = "plane-stress" }
viscosity = { law = "lame", first = 1, second = 1 }
[load]
body_force = [0.3, -1]
heat_source = 1
[[boundary]]
on = "top"
displacement = [0, 0]
temperature = 0
[contact]
on = "bottom"
normal = { law = "compliance", stiffness = 100.0 }
friction = { law = "coulomb", coefficient = 0.2 }
heat = { law = "ramp", conductance = 1.0, width = 1e-3, foundation_temperature = 0.0 }
[output]
every = 1
"#;

/// A model of two turned instances of a part, with sets and surfaces of every kind.
const MODEL: &str = "\
*HEADING
two bars
*PART, NAME=BAR
*NODE, NSET=ALL
1, 0., 0.
2, 1., 0.
3, 1., 1.
4, 0., 1.
5, 2., 0.
6, 2., 1.
*ELEMENT, TYPE=CPE4, ELSET=BODY
1, 1, 2, 3, 4
2, 2, 5, 6, 3
*NSET, NSET=LOW, GENERATE
1, 2, 1
*ELSET, ELSET=ENDS
1, 2
*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL
*END PART
*ASSEMBLY, NAME=BOTH
*INSTANCE, NAME=A, PART=BAR
*END INSTANCE
*INSTANCE, NAME=B, PART=BAR
0., 3., 0.
0., 3., 0., 0., 3., 1., 90.
*END INSTANCE
*NSET, NSET=HELD, INSTANCE=A
LOW, 5
*SURFACE, NAME=TOP, TYPE=ELEMENT
A.BODY, S3
B.1, S1
*SURFACE, NAME=POINTS, TYPE=NODE
A.LOW,
*END ASSEMBLY
*STEP
*STATIC
*END STEP
";

/// Number of bytes before and after the body of a checkpoint.
const HEADER: usize = 16 + 4 + 32 + 8;
const HASH: usize = 32;

/// Names of the readers.
pub fn names() -> Vec<&'static str> {
    vec![
        "case",
        "override",
        "expression",
        "table",
        "rounds",
        "gmsh",
        "inp",
        "contents",
        "vtu",
        "med",
        "mail",
        "exodus",
        "checkpoint",
        "results",
        "vtkhdf",
    ]
}

/// A reader with its data.
pub struct Target {
    kind: Kind,
    corpus: Vec<Vec<u8>>,
}

enum Kind {
    Case,
    Override,
    Expression,
    Table,
    /// Cells that are refined in rounds.
    Rounds,
    Gmsh,
    Inp,
    /// Mesh files under another ending.
    Contents,
    Vtu,
    Med,
    Mail,
    Exodus,
    Checkpoint {
        case: Box<Case>,
        folder: PathBuf,
    },
    /// A results folder with the names of its files, or only of the one with the fields: the first byte of an input
    /// chooses one of them.
    Results {
        folder: PathBuf,
        files: Vec<PathBuf>,
        sound: Vec<Vec<u8>>,
    },
}

impl Target {
    /// The reader with this name.
    pub fn new(name: &str) -> Option<Target> {
        let cases = || -> Vec<Vec<u8>> {
            let texts = BENCHMARKS.iter().map(|(_, text)| *text).chain([SMALL, case::STARTER]);
            texts.filter(|text| text.len() < 6000).map(|text| text.as_bytes().to_vec()).collect()
        };
        let texts = |all: &[&str]| all.iter().map(|text| text.as_bytes().to_vec()).collect::<Vec<_>>();
        let (kind, corpus) = match name {
            "case" => (Kind::Case, cases()),
            "override" => (
                Kind::Override,
                texts(&["mesh.n=4", "contact.gap=\"x\"", "boundary[0].displacement=[0, 0]", "load.body_force=[1, 2]"]),
            ),
            "expression" => (
                Kind::Expression,
                texts(&["sin(pi*x)*exp(-t)", "if(x < 0.5, 1, y^2)", "-(1 + 2)*max(x, y, z)/3e-2", "abs(t)^-2"]),
            ),
            "table" => (Kind::Table, texts(&["t,f\n0,1\n1,2\n", "0;1\n1;2", "# c\n\"t\"\tf\n0\t1\n", "0 1\n1 2\n"])),
            "rounds" => (Kind::Rounds, texts(&["cells 8\n0 3\n1\n", "# a\ncells 8\n\n7\n0 1 2\n"])),
            "gmsh" => (Kind::Gmsh, meshes("msh")),
            "inp" => (Kind::Inp, [meshes("inp"), texts(&[MODEL])].concat()),
            "contents" => (Kind::Contents, ["inp", "msh", "vtu"].into_iter().flat_map(meshes).collect()),
            "vtu" => (Kind::Vtu, meshes("vtu")),
            "med" => (Kind::Med, meshes("med")),
            "mail" => (Kind::Mail, meshes("mail")),
            "exodus" => (Kind::Exodus, meshes("e")),
            "checkpoint" => {
                let (folder, case) = small_run(name, SMALL)?;
                let sound = fs::read(folder.join("checkpoint/state.bin")).ok()?;
                (Kind::Checkpoint { case: Box::new(case), folder }, vec![sound])
            }
            "results" | "vtkhdf" => {
                let format = if name == "vtkhdf" { "format = \"vtkhdf\"\n" } else { "" };
                let (folder, _) = small_run(name, &format!("{SMALL}{format}"))?;
                let mut files: Vec<PathBuf> = files(&folder);
                if name == "vtkhdf" {
                    files.retain(|file| file.ends_with("fields.vtkhdf"));
                }
                let sound: Vec<Vec<u8>> = files.iter().filter_map(|file| fs::read(file).ok()).collect();
                let corpus = sound.iter().enumerate().map(|(i, bytes)| [&[i as u8][..], bytes].concat()).collect();
                (Kind::Results { folder, files, sound }, corpus)
            }
            _ => return None,
        };
        Some(Target { kind, corpus })
    }

    /// The initial inputs.
    pub fn corpus(&self) -> Vec<Vec<u8>> {
        self.corpus.clone()
    }

    /// Number of valid inputs.
    pub fn sound(&self) -> usize {
        self.corpus.len()
    }

    /// Words to insert: those of the schema, of the mesh formats, and of expressions.
    pub fn words(&self) -> Vec<String> {
        let mut words: Vec<String> = match self.kind {
            Kind::Gmsh => [
                "$Nodes\n",
                "$EndNodes\n",
                "$Elements\n",
                "$Entities\n",
                "$PartitionedEntities\n",
                "$PhysicalNames\n",
                "4.1 1 8\n",
            ]
            .map(str::to_owned)
            .to_vec(),
            Kind::Inp | Kind::Contents => [
                "*NODE\n",
                "*ELEMENT, TYPE=C3D20\n",
                "*ELEMENT, TYPE=S8R, ELSET=",
                "*INCLUDE, INPUT=a\n",
                "*SOLID SECTION, ELSET=",
                "*SURFACE, NAME=",
                "*NSET, NSET=",
                "*ELSET, ELSET=",
                ", GENERATE\n",
                ", INSTANCE=A",
                "S6\n",
            ]
            .map(str::to_owned)
            .to_vec(),
            Kind::Med => {
                ["ENS_MAA\0", "NOE\0", "COO\0", "GRO\0", "H20\0", "TREE", "SNOD", "HEAP"].map(str::to_owned).to_vec()
            }
            Kind::Mail => ["FINSF\n", "FIN\n", "COOR_3D\n", "HEXA27\n", "GROUP_MA NOM=", "NBLIGE=9", "%", " = "]
                .map(str::to_owned)
                .to_vec(),
            Kind::Exodus => {
                ["CDF\x01", "CDF\x05", "coordx\0", "eb_prop1", "connect1", "side_ss1", "elem_type", "HEX20\0"]
                    .map(str::to_owned)
                    .to_vec()
            }
            Kind::Vtu => [
                "<DataArray type=\"UInt8\" format=\"appended\" offset=\"0\">",
                "NumberOfPoints=\"4294967295\"",
                "NumberOfComponents=\"64\"",
                "compressor=\"vtkZLibDataCompressor\"",
                "header_type=\"UInt64\"",
                "<InformationKey>",
            ]
            .map(str::to_owned)
            .to_vec(),
            _ => [
                "(", ")", "^", "\"", "'''", "[[", "]]", "{", "}", "=", "\n[", "\u{feff}", "#", ",", ";", "if(", "sqrt(",
            ]
            .map(str::to_owned)
            .to_vec(),
        };
        if matches!(self.kind, Kind::Case | Kind::Override) {
            collect(&case::schema(), &mut words);
        }
        words
    }

    /// Reads an input; returns the outcome in words.
    pub fn read(&mut self, bytes: &[u8]) -> String {
        let text = || String::from_utf8_lossy(bytes).into_owned();
        match &self.kind {
            Kind::Case => {
                told(case::parse(&Source::new("case", text()), &[]).map(|case| !case.folder_options().text.is_empty()))
            }
            Kind::Override => told(case::parse(&Source::new("case", SMALL), &[text()])),
            Kind::Expression => told(Expression::parse(&text())),
            Kind::Table => {
                let files = BTreeMap::from([("f.csv".to_owned(), Arc::from(bytes))]);
                let case = SMALL.replace("heat_source = 1", "heat_source = { table = \"f.csv\" }");
                told(case::parse(&Source { files: Files::Memory(files), ..Source::new("case", case) }, &[]))
            }
            Kind::Rounds => {
                let files = BTreeMap::from([("cells.txt".to_owned(), Arc::from(bytes))]);
                let case = SMALL.replace("n = 2", "n = 2\nrefined_cells = \"cells.txt\"");
                told(case::parse(&Source { files: Files::Memory(files), ..Source::new("case", case) }, &[]))
            }
            Kind::Gmsh => told(gmsh::parse(bytes).map(|mesh| mesh.cell_count())),
            Kind::Inp => told(including("mesh.inp", bytes).map(|read| read.mesh.cell_count())),
            Kind::Contents => told(including("mesh.dat", bytes).map(|read| read.mesh.cell_count())),
            Kind::Vtu => told(vtu::parse(bytes).map(|mesh| mesh.cell_count())),
            Kind::Med => told(med::parse(bytes).map(|mesh| mesh.cell_count())),
            Kind::Mail => told(mail::parse(bytes).map(|mesh| mesh.cell_count())),
            Kind::Exodus => told(exodus::parse(bytes).map(|mesh| mesh.cell_count())),
            Kind::Checkpoint { case, folder } => checkpoint(case, folder, bytes),
            Kind::Results { folder, files, sound } => results(folder, files, sound, bytes),
        }
    }
}

/// The text of an error; all successful results give the same text.
fn told<T, E: ToString>(result: Result<T, E>) -> String {
    result.map_or_else(|error| error.to_string(), |_| String::new())
}

/// Resumes from a checkpoint with a valid checksum and any body.
fn checkpoint(case: &Case, folder: &Path, bytes: &[u8]) -> String {
    let mut sealed = bytes.to_vec();
    if let Some(body) = sealed.len().checked_sub(HEADER + HASH) {
        sealed[HEADER - 8..HEADER].copy_from_slice(&(body as u64).to_le_bytes());
        let end = sealed.len() - HASH;
        let sum = Sha256::digest(&sealed[..end]);
        sealed[end..].copy_from_slice(&sum);
    }
    if let Err(error) = fs::write(folder.join("checkpoint/state.bin"), sealed) {
        return error.to_string();
    }
    match Checkpoint::read(folder, &case.identity()) {
        Ok(Some(checkpoint)) => {
            let settings = Settings { certificate: false, ..Settings::default() };
            told(run::resume(&case.problem, checkpoint, &settings, &mut []))
        }
        Ok(None) => "none".to_owned(),
        Err(error) => error.to_string(),
    }
}

/// Verifies a results folder with one file replaced, and reads it for pictures.
fn results(folder: &Path, files: &[PathBuf], sound: &[Vec<u8>], bytes: &[u8]) -> String {
    let Some((first, rest)) = bytes.split_first() else { return String::new() };
    let which = usize::from(*first) % files.len().max(1);
    let (Some(file), Some(before)) = (files.get(which), sound.get(which)) else { return String::new() };
    if let Err(error) = fs::write(file, rest) {
        return error.to_string();
    }
    let found = match recompute(folder) {
        Ok(found) => [found.faults, found.unchecked].concat().join(" "),
        Err(error) => error.to_string(),
    };
    let drawn = told(plot::DrawnRun::read(folder));
    let restored = told(fs::write(file, before));
    found + &drawn + &restored
}

/// A separate results folder with the run of a case.
fn small_run(name: &str, text: &str) -> Option<(PathBuf, Case)> {
    let folder = std::env::temp_dir().join(format!("amontons-fuzz-{name}-{}", std::process::id()));
    let case = case::parse(&Source::new("small.toml", text), &[]).ok()?;
    let options = FolderOptions { certificate: false, ..case.folder_options() };
    let settings = Settings { certificate: false, ..Settings::default() };
    let mut results = Folder::create(&folder, options).ok()?;
    run::run(&case.problem, &settings, &mut [&mut results]).ok()?;
    fs::remove_file(folder.join("checkpoint/previous.bin")).ok()?;
    Some((folder, case))
}

impl Drop for Target {
    fn drop(&mut self) {
        if let Kind::Checkpoint { folder, .. } | Kind::Results { folder, .. } = &self.kind {
            // Remaining files are in the folder for temporary files.
            let _ = fs::remove_dir_all(folder);
        }
    }
}

/// The files in a folder and its subfolders.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() { found.extend(files(&path)) } else { found.push(path) }
    }
    found.retain(|path| path.file_name().is_some_and(|name| name != ".amontons.lock"));
    found.sort();
    found
}

/// Parses a mesh file in which every included file is the file itself without its first line.
fn including(name: &str, bytes: &[u8]) -> Result<MeshFile, MeshFileError> {
    let rest: Arc<[u8]> = bytes.iter().position(|byte| *byte == b'\n').map_or(&[][..], |at| &bytes[at + 1..]).into();
    mesh::parse_file(name, bytes, Some(&mut |_: &str| Ok(Arc::clone(&rest))))
}

/// The mesh files of the tests with this ending.
fn meshes(ending: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/amontons/tests/meshes");
    let all = files(&folder).into_iter().filter(|path| path.extension().is_some_and(|e| e == ending));
    all.filter_map(|path| fs::read(path).ok()).filter(|bytes| bytes.len() < 200_000).collect()
}

/// Keys and words of a schema.
fn collect(schema: &serde_json::Value, words: &mut Vec<String>) {
    match schema {
        serde_json::Value::Object(all) => {
            for (key, value) in all {
                if key == "properties" {
                    words.extend(value.as_object().into_iter().flatten().map(|(name, _)| format!("{name} = ")));
                }
                if let (true, Some(word)) = (key == "const", value.as_str()) {
                    words.push(format!("\"{word}\""));
                }
                collect(value, words);
            }
        }
        serde_json::Value::Array(all) => all.iter().for_each(|value| collect(value, words)),
        _ => {}
    }
}
