//! The element types of Exodus: names, node order, and sides.

use super::super::read::{Kind, completed};
use crate::element;
use crate::quadrature::Shape;

/// The supported types, as the end of the message about an unsupported one.
pub(super) const KNOWN: &str = "expected bars of 2 or 3 nodes, triangles of 3 or 6, quadrilaterals of 4, 8 or 9, tetrahedra of 4 or 10, pyramids of 5, 13 or 14, wedges of 6, 15 or 18, or hexahedra of 8, 20 or 27";

/// Prefixes of the names of types.
const SHAPES: [(&str, Shape); 16] = [
    ("SPHERE", Shape::Point),
    ("CIRCLE", Shape::Point),
    ("POINT", Shape::Point),
    ("BAR", Shape::Segment),
    ("BEAM", Shape::Segment),
    ("TRUSS", Shape::Segment),
    ("EDGE", Shape::Segment),
    ("LINE", Shape::Segment),
    ("ROD", Shape::Segment),
    ("TRI", Shape::Triangle),
    ("QUAD", Shape::Quadrilateral),
    ("SHELL", Shape::Quadrilateral),
    ("TET", Shape::Tetrahedron),
    ("PYR", Shape::Pyramid),
    ("WED", Shape::Prism),
    ("HEX", Shape::Hexahedron),
];

/// A type of element.
#[derive(Clone, Debug)]
pub(super) struct ExodusType {
    pub kind: Kind,
    pub shape: Shape,
    /// Position in the file of each node in the order of the library, which is VTK's.
    pub order: Vec<usize>,
    /// True for a shell type.
    pub is_shell: bool,
}

impl ExodusType {
    /// The type with a name and number of nodes.
    pub fn of(name: &str, nodes: usize) -> Option<ExodusType> {
        let name = name.to_ascii_uppercase();
        let shape = match SHAPES.iter().find(|(start, _)| name.starts_with(start))?.1 {
            Shape::Quadrilateral if nodes == 3 || nodes == 6 => Shape::Triangle,
            shape => shape,
        };
        let whole = element::ALL.iter().copied().find(|e| e.shape == shape && e.nodes.len() == nodes);
        let element = whole.or_else(|| completed(shape, nodes))?;
        let kind = Kind { name: element.name, dim: element.dim(), nodes, element: Some(element) };
        Some(ExodusType { kind, shape, order: order(shape, nodes), is_shell: name.contains("SHELL") })
    }
}

/// Node order of Exodus: nodes on vertical edges of hexahedra and wedges come before those of the top, and the node
/// inside a hexahedron before those of its faces, of which bottom and top are the first.
fn order(shape: Shape, nodes: usize) -> Vec<usize> {
    match (shape, nodes) {
        (Shape::Hexahedron, 20) => (0..12).chain(16..20).chain(12..16).collect(),
        (Shape::Hexahedron, 27) => (0..12).chain(16..20).chain(12..16).chain([23, 24, 25, 26, 21, 22, 20]).collect(),
        (Shape::Prism, 15 | 18) => (0..9).chain(12..15).chain(9..12).chain(15..nodes).collect(),
        _ => (0..nodes).collect(),
    }
}

/// The vertices of side 1, 2, … of an element, numbered from 0.
pub(super) fn side(shape: Shape, number: f64) -> Option<&'static [usize]> {
    let sides: &[&[usize]] = match shape {
        Shape::Segment => &[&[0], &[1]],
        Shape::Triangle => &[&[0, 1], &[1, 2], &[2, 0]],
        Shape::Quadrilateral => &[&[0, 1], &[1, 2], &[2, 3], &[3, 0]],
        Shape::Tetrahedron => &[&[0, 1, 3], &[1, 2, 3], &[0, 3, 2], &[0, 2, 1]],
        Shape::Pyramid => &[&[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[0, 4, 3], &[0, 3, 2, 1]],
        Shape::Prism => &[&[0, 1, 4, 3], &[1, 2, 5, 4], &[0, 3, 5, 2], &[0, 2, 1], &[3, 4, 5]],
        Shape::Hexahedron => {
            &[&[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[0, 4, 7, 3], &[0, 3, 2, 1], &[4, 5, 6, 7]]
        }
        Shape::Point => &[],
    };
    let at = super::place(number, sides.len())?;
    sides.get(at).copied()
}
