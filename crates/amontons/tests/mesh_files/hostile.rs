//! Damaged and hostile files: never a panic, no absurd allocation, always an error or a mesh whose nodes exist.

use amontons::mesh::{Elements, Mesh, MeshFileError, defects, gmsh, parse, vtu};
use proptest::prelude::*;

use super::writer::{Format, write};

fn sound() -> Vec<Vec<u8>> {
    let mesh = Mesh::rectangle_of(Elements::P2, [1.0, 1.0], [2, 1], amontons::mesh::Diagonal::Right).expect("a mesh");
    Format::all().into_iter().map(|format| write(&mesh, format)).collect()
}

fn vtu_files() -> Vec<Vec<u8>> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes");
    ["ascii", "base64_zlib", "raw_zlib", "raw_big", "append64"]
        .iter()
        .map(|e| std::fs::read(folder.join(format!("quarter_ring_{e}.vtu"))).expect("a file"))
        .collect()
}

/// What is read has nodes and cells that exist, and its defects can be looked for.
fn look(read: Result<Mesh, MeshFileError>) {
    match read {
        Ok(mesh) => {
            assert!(mesh.cell_count() > 0);
            assert!(
                defects::defects(&mesh)
                    .iter()
                    .flat_map(|d| &d.first)
                    .all(|d| !matches!(d, defects::Defect::UnknownNode { .. } | defects::Defect::Coordinate { .. }))
            );
            assert!(!defects::components(&mesh).is_empty());
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

/// Why a file is refused, if it is.
pub fn refusal(extension: &str, bytes: &[u8]) -> Option<MeshFileError> {
    parse(extension, bytes).err()
}

/// A file with bytes that occur in it replaced wherever they do.
pub fn replaced(bytes: &[u8], old: &[u8], new: &[u8]) -> Vec<u8> {
    let mut all = bytes.to_vec();
    let places: Vec<usize> = (0..=all.len() - old.len()).filter(|&at| all[at..].starts_with(old)).collect();
    assert!(!places.is_empty(), "{old:?} does not occur");
    for at in places {
        all[at..at + old.len()].copy_from_slice(new);
    }
    all
}

/// Numbers that seem random.
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % end
    }
}

/// Files that are cut, and files with random bytes in random places, are read or refused, in the time and the memory of
/// a file. Returns how many are refused.
pub fn spoil_at_random(extension: &str, files: &[&[u8]]) -> usize {
    let mut random = Random(77);
    let mut refused = 0;
    for whole in files {
        for part in 0..40 {
            refused += usize::from(refusal(extension, &whole[..whole.len() * part / 40]).is_some());
        }
        for _ in 0..1500 {
            let mut spoiled = whole.to_vec();
            for _ in 0..3 {
                let at = random.below(whole.len());
                spoiled[at] = random.below(256) as u8;
            }
            if let Ok(read) = parse(extension, &spoiled) {
                let _ = read.mesh.check();
            } else {
                refused += 1;
            }
        }
    }
    refused
}

/// Counts and sizes of any length, in each place of four and of eight bytes and in both orders of bytes: nothing is set
/// aside for what the file does not have.
pub fn spoil_counts(extension: &str, files: &[&[u8]]) {
    for whole in files {
        for at in (0..whole.len() - 8).step_by(4) {
            for count in [1u64 << 33, 1 << 45, u64::MAX - 1] {
                for number in [count.to_le_bytes(), count.to_be_bytes()] {
                    let mut spoiled = whole.to_vec();
                    spoiled[at..at + 8].copy_from_slice(&number);
                    let _ = refusal(extension, &spoiled);
                }
            }
        }
    }
}

#[derive(Debug, Clone)]
enum Damage {
    Truncate(usize),
    Replace(usize, u8),
    Delete(usize, usize),
    Insert(usize, &'static str),
}

fn damage() -> impl Strategy<Value = Damage> {
    let texts = prop_oneof![
        Just("nan"),
        Just("-1"),
        Just("18446744073709551615"),
        Just("1e999"),
        Just("4294967296"),
        Just("$EndNodes\n"),
        Just("\"")
    ];
    prop_oneof![
        any::<usize>().prop_map(Damage::Truncate),
        (any::<usize>(), any::<u8>()).prop_map(|(at, byte)| Damage::Replace(at, byte)),
        (any::<usize>(), 1..40_usize).prop_map(|(at, n)| Damage::Delete(at, n)),
        (any::<usize>(), texts).prop_map(|(at, text)| Damage::Insert(at, text)),
    ]
}

fn apply(mut bytes: Vec<u8>, damages: &[Damage]) -> Vec<u8> {
    for damage in damages {
        let length = bytes.len().max(1);
        match damage {
            Damage::Truncate(at) => bytes.truncate(at % length),
            Damage::Replace(at, byte) => bytes.iter_mut().skip(at % length).take(1).for_each(|b| *b = *byte),
            Damage::Delete(at, n) => {
                drop(bytes.drain((at % length).min(bytes.len())..(at % length + n).min(bytes.len())));
            }
            Damage::Insert(at, text) => {
                drop(bytes.splice((at % length).min(bytes.len())..(at % length).min(bytes.len()), text.bytes()));
            }
        }
    }
    bytes
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn damaged_gmsh_files_are_faults_or_meshes(which in any::<prop::sample::Index>(), damages in prop::collection::vec(damage(), 1..4)) {
        look(gmsh::parse(&apply(which.get(&sound()).clone(), &damages)));
    }

    #[test]
    fn damaged_vtu_files_are_faults_or_meshes(which in any::<prop::sample::Index>(), damages in prop::collection::vec(damage(), 1..4)) {
        look(vtu::parse(&apply(which.get(&vtu_files()).clone(), &damages)));
    }

    #[test]
    fn any_bytes_are_faults(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(gmsh::parse(&bytes).is_err());
        prop_assert!(vtu::parse(&bytes).is_err());
        let headed = [b"$MeshFormat\n4.1 1 8\n\x01\0\0\0\n$EndMeshFormat\n$Nodes\n".as_slice(), &bytes].concat();
        prop_assert!(gmsh::parse(&headed).is_err());
    }
}

#[test]
fn every_truncation_of_a_file_is_a_fault() {
    for bytes in sound() {
        for length in 0..bytes.len() - 2 {
            assert!(gmsh::parse(&bytes[..length]).is_err(), "{length} of {}", bytes.len());
        }
    }
}

/// 500 MB of zeros in a file of 500 kB, with counts that do not allow them and with counts that do.
#[test]
fn compressed_arrays_are_expanded_up_to_the_counts_of_the_file() {
    const ZEROS: usize = 500_000_000;
    let block = miniz_oxide::deflate::compress_to_vec_zlib(&vec![0; ZEROS], 6);
    let header = [1, ZEROS as u64, 0, block.len() as u64].map(u64::to_le_bytes).concat();
    let array = |name: &str| {
        format!("<DataArray type=\"UInt8\" Name=\"{name}\" NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/>")
    };
    for count in [4, 4_000_000_000_u64] {
        let head = format!(
            "<VTKFile type=\"UnstructuredGrid\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\
             <UnstructuredGrid><Piece NumberOfPoints=\"{count}\" NumberOfCells=\"{count}\"><Points>{}</Points><Cells>{}{}{}\
             </Cells></Piece></UnstructuredGrid><AppendedData encoding=\"raw\">_",
            array("Points"),
            array("connectivity"),
            array("offsets"),
            array("types"),
        );
        let bytes = [head.as_bytes(), &header, &block].concat();
        assert!(bytes.len() < 1_000_000);
        let told = vtu::parse(&bytes).expect_err("a fault").to_string();
        assert!(told.contains("the array Points: 500000000 bytes of data are announced"), "{told}");
    }
}

/// Thirty sets of which each names the one before three times have the nodes of the first, and not 3³⁰ of them.
#[test]
fn sets_that_name_sets_are_resolved_once() {
    let mut text = "*NODE\n1,0,0\n2,1,0\n3,1,1\n4,0,1\n*ELEMENT,TYPE=CPE4,ELSET=B\n1,1,2,3,4\n".to_owned();
    for kind in ["NSET", "ELSET"] {
        text += &format!("*{kind},{kind}={kind}0\n1{}\n", if kind == "NSET" { ",2" } else { "" });
        for i in 1..30 {
            let before = format!("{kind}{}", i - 1);
            text += &format!("*{kind},{kind}={kind}{i}\n{before},{before},{before}\n");
        }
    }
    text += "*SURFACE,NAME=LOWER\nELSET29,S1\n";
    let mesh = parse("inp", text.as_bytes()).expect("a mesh").mesh;
    for side in ["NSET29", "LOWER"] {
        assert_eq!(mesh.facets.get(side).expect(side).len(), 1, "{side}");
    }
    // One that names itself ends.
    let circle = text.replace("*NSET,NSET=NSET0\n1,2\n", "*NSET,NSET=NSET0\nNSET0,NSET0,NSET0\n");
    assert!(refusal("inp", circle.as_bytes()).is_some());
}

/// One flat cell beside others: nodes at one place are found without boxes of its size.
#[test]
fn a_flat_cell_hinders_no_search() {
    let flat = 5e-13;
    let mut mesh =
        Mesh::rectangle_of(Elements::P1, [1.0, 1.0], [30, 30], amontons::mesh::Diagonal::Right).expect("a mesh");
    let of_cell = mesh.blocks[0].nodes[..3].to_vec();
    let [a, b] = [of_cell[0], of_cell[1]].map(|node| mesh.points[node as usize]);
    mesh.points[of_cell[1] as usize] = [a[0] + flat, a[1], a[2]];
    mesh.points.push(b);
    mesh.points.push(b);
    let pairs = defects::coincident(&mesh);
    assert!(pairs.contains(&[mesh.points.len() as u32 - 2, mesh.points.len() as u32 - 1]), "{pairs:?}");
}

/// Files of 22 and 26 kB that announce 10⁷ blocks and 1.5·10⁹ coordinates are refused by their counts.
#[test]
fn counts_that_a_packed_file_cannot_hold_are_refused() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/meshes/announced");
    for (name, what) in [("prop-1e7.e", "eb_prop1 announces 10000000 "), ("coordinates-5e8.med", "NOE/COO announces ")]
    {
        let bytes = std::fs::read(folder.join(name)).expect(name);
        let (_, extension) = name.split_once('.').expect("an extension");
        let told = refusal(extension, &bytes).expect(name).to_string();
        assert!(told.contains(what) && told.contains("can hold"), "{name}: {told}");
    }
}
