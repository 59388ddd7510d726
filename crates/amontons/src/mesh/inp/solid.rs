//! The element types of Abaqus and CalculiX that fill a body or may lie on it, and their faces.

use crate::element::{CellType, Element};

use super::super::read::{Kind, PlaneState};

/// Families of types whose elements fill a body, with their dimension. The number of nodes follows, then letters for
/// integration, mixed forms and coupled fields, which do not affect the mesh.
const FAMILIES: [(&str, usize); 13] = [
    ("CPEG", 2),
    ("CPS", 2),
    ("CPE", 2),
    ("CGAX", 2),
    ("CAX", 2),
    ("DC1D", 1),
    ("DC2D", 2),
    ("DCAX", 2),
    ("DCC2D", 2),
    ("DC3D", 3),
    ("DCC3D", 3),
    ("AC3D", 3),
    ("C3D", 3),
];

/// Families of half sections of bodies of revolution.
const REVOLUTION: [&str; 3] = ["CGAX", "CAX", "DCAX"];

/// A type of element.
#[derive(Clone, Copy, Debug)]
pub(super) struct InpSolid {
    pub kind: Kind,
    /// True if it belongs to the half section of a body of revolution.
    pub axisymmetric: bool,
    /// Plane stress or strain, for a plane element.
    pub plane: Option<PlaneState>,
    /// True if it fills a body; other elements may be facets of one.
    pub fills: bool,
}

/// The meaning of the name of an element type.
#[derive(Clone, Copy, Debug)]
pub(super) enum InpType {
    /// An element that fills a body, or that may be a facet of one.
    Solid(InpSolid),
    /// An element that fills a body but is not in the library.
    Missing,
    /// A spring, mass or other element that is neither part nor facet of a body.
    Other,
}

/// The type with a name in capitals.
pub(super) fn of(name: &str) -> InpType {
    let family = FAMILIES.iter().filter(|(family, _)| name.starts_with(family)).max_by_key(|(family, _)| family.len());
    let Some(&(family, dim)) = family else { return thin(name) };
    let digits: String = name[family.len()..].chars().take_while(char::is_ascii_digit).collect();
    let Ok(nodes) = digits.parse::<usize>() else { return InpType::Other };
    // Nodes in the middle of faces and cell are missing and added later.
    let Some((element, _)) =
        CellType::find(|element, cell| cell.is_in_abaqus && element.dim() == dim && cell.nodes == nodes)
    else {
        return InpType::Missing;
    };
    let kind = Kind::of(element, nodes);
    InpType::Solid(InpSolid { kind, axisymmetric: REVOLUTION.contains(&family), plane: plane(family), fills: true })
}

/// Families of shells, membranes, surfaces and lines, with their dimension and node counts by the following digit; Gmsh
/// names edges T3D2 and triangles CPS3.
const THIN: [(&str, usize, &[(char, usize)]); 16] = [
    ("STRI", 2, &[('3', 3), ('6', 6)]),
    ("SFM3D", 2, FACES),
    ("M3D", 2, FACES),
    ("DS", 2, FACES),
    ("R3D", 2, FACES),
    ("F3D", 2, FACES),
    ("S", 2, FACES),
    ("T2D", 1, LINES),
    ("T3D", 1, LINES),
    ("R2D", 1, LINES),
    ("B2", 1, BEAMS),
    ("B3", 1, BEAMS),
    ("SAX", 1, ORDERS),
    ("MAX", 1, ORDERS),
    ("SFMAX", 1, ORDERS),
    ("RAX", 1, LINES),
];
const FACES: &[(char, usize)] = &[('3', 3), ('4', 4), ('6', 6), ('8', 8), ('9', 9)];
const LINES: &[(char, usize)] = &[('2', 2), ('3', 3)];
const BEAMS: &[(char, usize)] = &[('1', 2), ('2', 3), ('3', 2)];
const ORDERS: &[(char, usize)] = &[('1', 2), ('2', 3)];

/// The type of an element that fills no body.
fn thin(name: &str) -> InpType {
    let nodes = |(family, dim, counts): &(&str, usize, &[(char, usize)])| {
        let number = name.strip_prefix(family)?.chars().next()?;
        let (_, nodes) = counts.iter().find(|(digit, _)| *digit == number)?;
        Some((*dim, *nodes))
    };
    let Some((dim, nodes)) = THIN.iter().find_map(nodes) else { return InpType::Other };
    let kind = Kind { name: "thin element", dim, nodes, element: None };
    InpType::Solid(InpSolid { kind, axisymmetric: false, plane: None, fills: false })
}

/// The number of vertices of an element below dimension 3 from its number of nodes.
pub(super) fn vertices(kind: &Kind) -> usize {
    match (kind.dim, kind.nodes) {
        (1, _) => 2,
        (2, 3 | 6) => 3,
        _ => 4,
    }
}

/// A type of element that fills a body, derived from its name.
#[derive(Clone, Copy, Debug)]
pub struct SolidType {
    /// The element of the library, which may have more nodes than the file.
    pub element: &'static Element,
    /// Number of nodes in the file.
    pub nodes: usize,
    /// True if it belongs to the half section of a body of revolution.
    pub axisymmetric: bool,
    /// Plane stress or strain, for a plane element.
    pub plane: Option<PlaneState>,
}

/// The type with a name such as `C3D8R`; `None` if its elements fill no body or are not in the library.
pub fn solid_type(name: &str) -> Option<SolidType> {
    let InpType::Solid(InpSolid { kind, axisymmetric, plane, .. }) = of(&name.to_uppercase()) else { return None };
    kind.element.map(|element| SolidType { element, nodes: kind.nodes, axisymmetric, plane })
}

/// Plane stress or strain of a family of elements.
fn plane(family: &str) -> Option<PlaneState> {
    match family {
        "CPS" => Some(PlaneState::Stress),
        "CPE" | "CPEG" => Some(PlaneState::Strain),
        _ => None,
    }
}
