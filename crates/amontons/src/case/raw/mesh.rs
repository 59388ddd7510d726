//! `[mesh]`.

use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

/// The mesh by its kind.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(in crate::case) enum Mesh {
    /// The rectangle (0, size₀) × (0, size₁) of squares cut into triangles; its sides are named
    /// left, right, bottom and top.
    Rectangle {
        /// Lengths of the sides in m.
        #[schemars(transform = positive_items)]
        size: [f64; 2],
        /// Cells per side.
        n: Cells,
        /// How the squares are cut.
        #[serde(default)]
        diagonal: Diagonal,
    },
}

/// Numbers of cells.
#[derive(Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "an integer ≥ 1 or two of them, [nx, ny]")]
pub(in crate::case) enum Cells {
    /// The same number in both directions.
    Same(#[schemars(range(min = 1))] usize),
    /// A number a direction.
    Each(#[schemars(inner(range(min = 1)))] [usize; 2]),
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

/// Asks for positive entries of an array.
fn positive_items(schema: &mut Schema) {
    if let Some(items) = schema.get_mut("items").and_then(|items| items.as_object_mut()) {
        items.insert("exclusiveMinimum".to_owned(), 0.into());
    }
}
