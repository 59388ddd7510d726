//! The element types of Exodus.

use super::super::read::Kind;
use crate::element::CellType;
use crate::quadrature::Shape;

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
        let (element, _) = CellType::find(|element, cell| element.shape == shape && cell.nodes == nodes)?;
        let order = element.orders.exodus.positions(nodes);
        Some(ExodusType { kind: Kind::of(element, nodes), order, is_shell: name.contains("SHELL") })
    }
}

/// The supported types, as the end of the message about an unsupported one.
pub(super) fn known() -> String {
    let of = |shape: Shape| CellType::node_counts(|element| element.shape == shape);
    let [bars, triangles, quadrilaterals] = [Shape::Segment, Shape::Triangle, Shape::Quadrilateral].map(of);
    let [tetrahedra, pyramids, wedges] = [Shape::Tetrahedron, Shape::Pyramid, Shape::Prism].map(of);
    let hexahedra = of(Shape::Hexahedron);
    format!(
        "expected bars of {bars} nodes, triangles of {triangles}, quadrilaterals of {quadrilaterals}, tetrahedra of \
         {tetrahedra}, pyramids of {pyramids}, wedges of {wedges}, or hexahedra of {hexahedra}"
    )
}
