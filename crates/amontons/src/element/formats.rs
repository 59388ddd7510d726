//! What mesh formats call the cells of an element, and in which order they list its nodes and facets.

use super::{ALL, Element};

/// A type of cells in files: the name and number of it in each format that has it.
///
/// The cells have all nodes of an element, or the leading ones: a quadrilateral of 8 nodes lacks the centre of the one
/// of 9, which is added when a file is read.
#[derive(Clone, Copy, Debug)]
pub struct CellType {
    /// Name used in messages, e.g. `8-node quadrilateral`.
    pub name: &'static str,
    /// Number of leading nodes of the element that a cell has.
    pub nodes: usize,
    /// Number in the VTK file formats.
    pub vtk: Option<u8>,
    /// Number in the Gmsh file formats.
    pub gmsh: Option<u32>,
    /// Name in MED files.
    pub med: Option<&'static str>,
    /// Name in `.mail` files of Code_Aster.
    pub mail: Option<&'static str>,
    /// True if input files of Abaqus and CalculiX may have it; there the dimension and the number of nodes name it.
    pub is_in_abaqus: bool,
    /// How a plane cell is drawn.
    pub drawing: Option<Drawing>,
}

/// What pictures draw of a plane cell or a facet of a cell in space.
#[derive(Clone, Copy, Debug)]
pub struct Drawing {
    /// The nodes around the cell.
    pub outline: &'static [usize],
    /// Triangles that cover it.
    pub triangles: &'static [[usize; 3]],
}

impl CellType {
    /// A type that no format has but Exodus, where the shape and the number of nodes name it.
    #[must_use]
    pub const fn new(name: &'static str, nodes: usize) -> CellType {
        CellType { name, nodes, vtk: None, gmsh: None, med: None, mail: None, is_in_abaqus: false, drawing: None }
    }

    /// The type with its number in the VTK file formats.
    #[must_use]
    pub const fn vtk(self, number: u8) -> CellType {
        CellType { vtk: Some(number), ..self }
    }

    /// The type with its number in the Gmsh file formats.
    #[must_use]
    pub const fn gmsh(self, number: u32) -> CellType {
        CellType { gmsh: Some(number), ..self }
    }

    /// The type with its names in both formats of Code_Aster, MED and `.mail`.
    #[must_use]
    pub const fn aster(self, med: &'static str, mail: &'static str) -> CellType {
        CellType { med: Some(med), mail: Some(mail), ..self }
    }

    /// The type as one of Abaqus and CalculiX, too.
    #[must_use]
    pub const fn abaqus(self) -> CellType {
        CellType { is_in_abaqus: true, ..self }
    }

    /// The type with the nodes around a plane cell and the triangles that draw it.
    #[must_use]
    pub const fn drawn(self, outline: &'static [usize], triangles: &'static [[usize; 3]]) -> CellType {
        CellType { drawing: Some(Drawing { outline, triangles }), ..self }
    }

    /// How plane cells with a number of nodes are drawn.
    #[must_use]
    pub fn drawing(nodes: usize) -> Option<Drawing> {
        all().find_map(|(_, cell)| cell.drawing.filter(|_| cell.nodes == nodes))
    }

    /// The first type that fulfils a condition, with its element.
    pub fn find(is: impl Fn(&Element, &CellType) -> bool) -> Option<(&'static Element, &'static CellType)> {
        all().find(|(element, cell)| is(element, cell))
    }

    /// The numbers of nodes of cells whose element fulfils a condition, as messages list them: `4, 8 or 9`.
    #[must_use]
    pub fn node_counts(is: impl Fn(&Element) -> bool) -> String {
        let mut counts: Vec<usize> = all().filter(|(element, _)| is(element)).map(|(_, cell)| cell.nodes).collect();
        counts.sort_unstable();
        counts.dedup();
        let counts: Vec<String> = counts.iter().map(usize::to_string).collect();
        match counts.split_last() {
            Some((last, others)) if !others.is_empty() => format!("{} or {last}", others.join(", ")),
            _ => counts.concat(),
        }
    }

    /// The names of all types that a format has, by dimension, number of vertices and number of nodes, as messages list
    /// them.
    #[must_use]
    pub fn names(of: impl Fn(&CellType) -> Option<&'static str>) -> String {
        let mut sorted: Vec<_> = all().collect();
        sorted.sort_by_key(|(element, cell)| (element.dim(), element.shape.vertices(), cell.nodes));
        let mut names: Vec<&str> = sorted.into_iter().filter_map(|(_, cell)| of(cell)).collect();
        names.dedup();
        names.join(", ")
    }
}

fn all() -> impl Iterator<Item = (&'static Element, &'static CellType)> {
    ALL.into_iter().flat_map(|element| element.types.iter().map(move |cell| (element, cell)))
}

/// The order in which a format lists the nodes or facets of a cell: the local number at each position.
///
/// Beyond the end of the list the format has the order of the library. Cells with the leading nodes of an element list
/// them at the leading positions.
#[derive(Clone, Copy, Debug)]
pub struct FileOrder(pub &'static [usize]);

impl FileOrder {
    /// The order of the library.
    pub const SAME: FileOrder = FileOrder(&[]);

    /// The local number at a position.
    #[must_use]
    pub fn local(self, position: usize) -> usize {
        self.0.get(position).copied().unwrap_or(position)
    }

    /// The position of each of the first `count` local numbers.
    #[must_use]
    pub fn positions(self, count: usize) -> Vec<usize> {
        (0..count).map(|local| (0..count).find(|at| self.local(*at) == local).unwrap_or(local)).collect()
    }
}

/// The orders of the nodes and facets of an element in the formats that do not have the order of VTK.
#[derive(Clone, Copy, Debug)]
pub struct FileOrders {
    /// Nodes in Gmsh.
    pub gmsh: FileOrder,
    /// Nodes in MED.
    pub med: FileOrder,
    /// Nodes in `.mail` files.
    pub mail: FileOrder,
    /// Nodes in Exodus.
    pub exodus: FileOrder,
    /// Sides in Exodus: indices in [`Element::facets`], whose order is that of the faces of Abaqus.
    pub exodus_sides: FileOrder,
}

impl FileOrders {
    /// The order of the library in every format.
    pub const SAME: FileOrders = FileOrders {
        gmsh: FileOrder::SAME,
        med: FileOrder::SAME,
        mail: FileOrder::SAME,
        exodus: FileOrder::SAME,
        exodus_sides: FileOrder::SAME,
    };
}
