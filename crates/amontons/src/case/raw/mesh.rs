//! `[mesh]`.

use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use super::side::InBox;

/// The mesh: generated, or read from a file.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(in crate::case) enum Mesh {
    /// A rectangle with the lower left corner `origin`. Its sides are named left, right, bottom and top.
    Rectangle {
        /// Lengths of the sides in m.
        #[schemars(transform = positive_items)]
        size: [f64; 2],
        /// Cells per side.
        n: Cells2,
        /// Element type of the cells.
        #[serde(default)]
        elements: Elements,
        /// How the squares are cut into triangles.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        diagonal: Option<Diagonal>,
        /// Lower left corner in m; default: (0, 0).
        #[serde(default)]
        origin: [f64; 2],
        /// Whether the mesh is the half section of a body of revolution, x being the distance from the axis.
        #[serde(default)]
        axisymmetric: bool,
        /// Places in which the mesh is finer, in this order.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        refine_where: Vec<RefineWhere>,
        /// File with cells that are refined in rounds, as `amontons run --accuracy` writes it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        refined_cells: Option<String>,
    },
    /// The interval (0, size). Its ends are named left and right.
    Interval {
        /// Length in m.
        #[schemars(extend("exclusiveMinimum" = 0))]
        size: f64,
        /// Number of cells.
        #[schemars(range(min = 1))]
        n: usize,
        /// Element type of the cells.
        #[serde(default)]
        elements: Elements,
        /// Places in which the mesh is finer, in this order.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        refine_where: Vec<RefineWhere>,
        /// File with cells that are refined in rounds, as `amontons run --accuracy` writes it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        refined_cells: Option<String>,
    },
    /// The box (0, size₀) × (0, size₁) × (0, size₂). Its sides are named left, right (x), bottom, top (y), back and
    /// front (z).
    Box {
        /// Lengths of the sides in m.
        #[schemars(transform = positive_items)]
        size: [f64; 3],
        /// Cells per side.
        n: Cells3,
        /// Element type of the cells.
        #[serde(default)]
        elements: Elements,
        /// Places in which the mesh is finer, in this order.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        refine_where: Vec<RefineWhere>,
        /// File with cells that are refined in rounds, as `amontons run --accuracy` writes it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        refined_cells: Option<String>,
    },
    /// A disc around the origin. Its side is named outer.
    Disc {
        /// Radius in m.
        #[schemars(extend("exclusiveMinimum" = 0))]
        radius: f64,
        /// Number of layers around a square in the middle, and number of cells around, a multiple of 4.
        n: Cells2,
        /// Element type of the cells.
        #[serde(default)]
        elements: Elements,
        /// Places in which the mesh is finer, in this order.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        refine_where: Vec<RefineWhere>,
        /// File with cells that are refined in rounds, as `amontons run --accuracy` writes it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        refined_cells: Option<String>,
    },
    /// A ring around the origin, or a sector of it that begins at the x-axis. Its sides are named inner, outer, start
    /// and end.
    Ring {
        /// Inner and outer radius in m.
        #[schemars(transform = positive_items)]
        radii: [f64; 2],
        /// Angle of the sector in rad; default: a whole ring.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        angle: Option<f64>,
        /// Number of layers and number of cells around.
        n: Cells2,
        /// Element type of the cells.
        #[serde(default)]
        elements: Elements,
        /// Places in which the mesh is finer, in this order.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        refine_where: Vec<RefineWhere>,
        /// File with cells that are refined in rounds, as `amontons run --accuracy` writes it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        refined_cells: Option<String>,
    },
    /// A cylinder around the z-axis, 0 < z < height, or a sector of it that begins at the x-axis. Its sides are named
    /// inner, outer, bottom, top, and start and end of a sector.
    Cylinder {
        /// Inner radius, 0 for a solid cylinder, and outer radius in m.
        radii: [f64; 2],
        /// Angle of the sector in rad; default: a whole cylinder.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        angle: Option<f64>,
        /// Height in m.
        #[schemars(extend("exclusiveMinimum" = 0))]
        height: f64,
        /// Number of layers, of cells around, and of cells over the height.
        n: Cells3,
        /// Element type of the cells.
        #[serde(default)]
        elements: Elements,
        /// Places in which the mesh is finer, in this order.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        refine_where: Vec<RefineWhere>,
        /// File with cells that are refined in rounds, as `amontons run --accuracy` writes it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        refined_cells: Option<String>,
    },
    /// Several bodies side by side, each with nodes of its own: intervals, rectangles and rings, or boxes and
    /// cylinders. Each is a region; its sides are named after it: `pad_left`, `pad_top`, `shaft_outer`.
    Blocks {
        /// The bodies.
        #[schemars(length(min = 1))]
        blocks: Vec<Block>,
        /// Whether the mesh is the half section of bodies of revolution, x being the distance from the axis.
        #[serde(default)]
        axisymmetric: bool,
        /// Places in which the mesh is finer, in this order.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        refine_where: Vec<RefineWhere>,
        /// File with cells that are refined in rounds, as `amontons run --accuracy` writes it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        refined_cells: Option<String>,
    },
    /// A mesh file of Gmsh (.msh), Abaqus or CalculiX (.inp), Code_Aster or Salome (.med, .mail), Exodus (.e) or VTK
    /// (.vtu).
    /// Its sides and regions are those of the file.
    #[schemars(extend("x-implied-by" = "file"))]
    File {
        /// Path of the mesh file, relative to the case file.
        file: String,
        /// Factor of the coordinates: 0.001 if the file is in mm.
        #[serde(default = "one")]
        #[schemars(extend("exclusiveMinimum" = 0))]
        scale: f64,
        /// Whether the mesh is the half section of a body of revolution, x being the distance from the axis.
        #[serde(default)]
        axisymmetric: bool,
        /// Uniform refinements: each cuts every edge of the mesh in two.
        #[serde(default)]
        #[schemars(range(max = 8))]
        refine: u32,
        /// Places in which the mesh is finer, in this order.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        refine_where: Vec<RefineWhere>,
        /// File with cells that are refined in rounds, as `amontons run --accuracy` writes it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        refined_cells: Option<String>,
    },
}

impl Mesh {
    /// The mesh file with the factor of its coordinates, or `None` for a generated mesh.
    pub fn file(&self) -> Option<(&str, f64)> {
        match self {
            Mesh::File { file, scale, .. } => Some((file, *scale)),
            _ => None,
        }
    }

    /// The places in which the mesh is finer.
    pub fn refine_where(&self) -> &[RefineWhere] {
        match self {
            Mesh::Rectangle { refine_where, .. }
            | Mesh::Interval { refine_where, .. }
            | Mesh::Box { refine_where, .. }
            | Mesh::Disc { refine_where, .. }
            | Mesh::Ring { refine_where, .. }
            | Mesh::Cylinder { refine_where, .. }
            | Mesh::Blocks { refine_where, .. }
            | Mesh::File { refine_where, .. } => refine_where,
        }
    }

    /// The file with cells that are refined in rounds.
    pub fn refined_cells(&self) -> Option<&str> {
        match self {
            Mesh::Rectangle { refined_cells, .. }
            | Mesh::Interval { refined_cells, .. }
            | Mesh::Box { refined_cells, .. }
            | Mesh::Disc { refined_cells, .. }
            | Mesh::Ring { refined_cells, .. }
            | Mesh::Cylinder { refined_cells, .. }
            | Mesh::Blocks { refined_cells, .. }
            | Mesh::File { refined_cells, .. } => refined_cells.as_deref(),
        }
    }
}

/// Cells of which every edge is cut in two: those in all places that are given. Cells around them are cut as far as a
/// conforming mesh needs, quadrilaterals into triangles, hexahedra and prisms into pyramids and tetrahedra.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct RefineWhere {
    /// Name of a side: cells with a vertex on it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub side: Option<String>,
    /// Name of a region: its cells.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<String>,
    /// A box, in two dimensions a rectangle: cells that reach into it.
    #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
    pub within: Option<InBox>,
    /// Condition in x, y, z, such as "x^2 + y^2 < 0.01": cells in which it holds, or is not 0, at a vertex or in the
    /// centre.
    #[serde(default, rename = "where", skip_serializing_if = "Option::is_none")]
    pub holds: Option<String>,
    /// Number of times, each for the cells that are then in the places.
    #[serde(default = "once")]
    #[schemars(range(min = 1, max = 16))]
    pub times: u32,
}

fn once() -> u32 {
    1
}

/// A body of a mesh of several: an interval, a rectangle or a box by the number of its sizes, a round body with `radii`
/// in the place of `size`: a ring or disc in the plane, a cylinder where it has a `height`, or the mesh of a `file`.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Block {
    /// Name of the body: that of its region, and the first part of the names of its sides.
    pub name: String,
    /// Lengths of the sides in m: one, two or three.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(transform = positive_items)]
    pub size: Vec<f64>,
    /// Inner radius, 0 for a solid body, and outer radius in m of a round body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radii: Option<[f64; 2]>,
    /// Height in m of a cylinder around a line along z.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub height: Option<f64>,
    /// Angle of the sector of a ring or a cylinder in rad; default: all around.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub angle: Option<f64>,
    /// Path of a mesh file, relative to the case file, in place of `size` and `n`.
    ///
    /// Its sides have the name of the body in front of theirs, and so have its regions where it has several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Factor of the coordinates of the file: 0.001 if it is in mm; default: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub scale: Option<f64>,
    /// Cells per side; of a round body layers, cells around, and cells over the height.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(inner(range(min = 1)))]
    pub n: Vec<usize>,
    /// Rotation of the body about its own origin, before it is moved.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turn: Option<Turn>,
    /// Corner with the least coordinates in m, or the centre of a round body, of a cylinder that of its bottom; where
    /// the origin of a file comes to lie; default: the origin.
    #[serde(default)]
    pub origin: Vec<f64>,
    /// Element type of the cells.
    #[serde(default)]
    pub elements: Elements,
    /// How the squares of a rectangle are cut into triangles.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diagonal: Option<Diagonal>,
}

/// A rotation.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct Turn {
    /// Direction of the axis, three entries, by the right-hand rule; not given in two dimensions, where it is z.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub axis: Vec<f64>,
    /// Angle in rad.
    pub angle: f64,
}

/// Numbers of cells in two directions.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "an integer ≥ 1 or two of them, [nx, ny]")]
pub(in crate::case) enum Cells2 {
    /// The same number in both directions.
    Same(#[schemars(range(min = 1))] usize),
    /// One number per direction.
    Each(#[schemars(inner(range(min = 1)))] [usize; 2]),
}

/// Numbers of cells in three directions.
#[derive(Clone, Copy, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "an integer ≥ 1 or three of them, [nx, ny, nz]")]
pub(in crate::case) enum Cells3 {
    /// The same number in all directions.
    Same(#[schemars(range(min = 1))] usize),
    /// One number per direction.
    Each(#[schemars(inner(range(min = 1)))] [usize; 3]),
}

impl Cells2 {
    /// One number per direction.
    pub fn each(self) -> [usize; 2] {
        match self {
            Cells2::Same(n) => [n; 2],
            Cells2::Each(n) => n,
        }
    }
}

impl Cells3 {
    /// One number per direction.
    pub fn each(self) -> [usize; 3] {
        match self {
            Cells3::Same(n) => [n; 3],
            Cells3::Each(n) => n,
        }
    }
}

/// Element type of the cells.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
pub(in crate::case) enum Elements {
    /// Linear segments, triangles, tetrahedra.
    #[default]
    P1,
    /// Quadratic segments, triangles, tetrahedra.
    P2,
    /// Bilinear quadrilaterals, trilinear hexahedra.
    Q1,
    /// Quadrilaterals of 9 and hexahedra of 27 nodes.
    Q2,
}

/// How the squares of a mesh are cut into triangles.
#[derive(Clone, Copy, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum Diagonal {
    /// From lower left to upper right: /.
    #[default]
    Right,
    /// From upper left to lower right: \.
    Left,
    /// Both: ×.
    Crossed,
}

fn one() -> f64 {
    1.0
}

/// Asks for positive entries of an array.
fn positive_items(schema: &mut Schema) {
    if let Some(items) = schema.get_mut("items").and_then(|items| items.as_object_mut()) {
        items.insert("exclusiveMinimum".to_owned(), 0.into());
    }
}
