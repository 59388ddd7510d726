//! Data that vary: numbers, expressions, tables.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A number or an expression.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "a number or an expression in x, y, z, t")]
pub(in crate::case) enum Scalar {
    /// The same value everywhere and always.
    Number(f64),
    /// An expression in x, y, z, t, such as "sin(pi*x)*exp(-t)".
    Expression(String),
}

impl Default for Scalar {
    fn default() -> Scalar {
        Scalar::Number(0.0)
    }
}

/// A number, an expression or a table.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "a number, an expression in x, y, z, t or a table in time")]
pub(in crate::case) enum Datum {
    /// The same value everywhere and always.
    Number(f64),
    /// An expression in x, y, z, t, such as "sin(pi*x)*exp(-t)".
    Expression(String),
    /// Values at times, linear between them.
    Table(Box<TableData>),
}

impl Default for Datum {
    fn default() -> Datum {
        Datum::Number(0.0)
    }
}

/// A coefficient of the body that is the same at all times and temperatures.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "a number, an expression in x, y, z or data of a mesh file")]
pub(in crate::case) enum Steady {
    /// The same value everywhere.
    Number(f64),
    /// An expression in x, y, z, such as "1 + x".
    Expression(String),
    /// Values of the cells or nodes of a mesh file.
    Table(Box<TableData>),
}

impl From<Steady> for Coefficient {
    fn from(steady: Steady) -> Coefficient {
        match steady {
            Steady::Number(value) => Coefficient::Number(value),
            Steady::Expression(text) => Coefficient::Expression(text),
            Steady::Table(table) => Coefficient::Table(table),
        }
    }
}

/// A coefficient of the body that is the same at all times.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "a number, an expression in x, y, z, data of a mesh file or a table over the temperature")]
pub(in crate::case) enum Coefficient {
    /// The same value everywhere.
    Number(f64),
    /// An expression in x, y, z, such as "1 + x".
    Expression(String),
    /// Values of the cells or nodes of a mesh file, or at temperatures.
    Table(Box<TableData>),
}

impl Default for Coefficient {
    fn default() -> Coefficient {
        Coefficient::Number(0.0)
    }
}

impl From<Coefficient> for Datum {
    fn from(coefficient: Coefficient) -> Datum {
        match coefficient {
            Coefficient::Number(value) => Datum::Number(value),
            Coefficient::Expression(text) => Datum::Expression(text),
            Coefficient::Table(table) => Datum::Table(table),
        }
    }
}

impl From<Scalar> for Datum {
    fn from(scalar: Scalar) -> Datum {
        match scalar {
            Scalar::Number(value) => Datum::Number(value),
            Scalar::Expression(text) => Datum::Expression(text),
        }
    }
}

/// A component of a prescribed vector.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "a number, an expression in x, y, z, t, a table in time or \"free\"")]
pub(in crate::case) enum Component {
    /// The same value everywhere and always.
    Number(f64),
    /// An expression in x, y, z, t, or the word "free" for a component that is not prescribed.
    Expression(String),
    /// Values at times, linear between them.
    Table(Box<TableData>),
}

impl Component {
    /// The value that is prescribed, if any.
    pub fn prescribed(self) -> Option<Datum> {
        match self {
            Component::Number(value) => Some(Datum::Number(value)),
            Component::Expression(word) if word.trim() == "free" => None,
            Component::Expression(text) => Some(Datum::Expression(text)),
            Component::Table(table) => Some(Datum::Table(table)),
        }
    }
}

/// Values at times, linear between them: those of a file, or `times` and `values`; values in space, the `data` of a
/// mesh file; or values of a coefficient of a material at temperatures.
#[derive(Clone, Debug, Default, Deserialize, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(in crate::case) struct TableData {
    // This field is first: a matrix would be read as the fields of this table in their order, which a text refuses.
    /// Name of data of the cells or the nodes of a mesh file, instead of a table in time: VTU data, or `$ElementData`
    /// and `$NodeData` of Gmsh.
    ///
    /// Values of cells are constant in them; where cells meet, their mean holds. Values of nodes are interpolated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub data: Option<String>,
    /// Path of the mesh file that has the data, relative to the case file; default: `mesh.file`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Path of a file of comma-separated values, relative to the case file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<String>,
    /// Column of the values, by header or by number from 1; default: the second.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub column: Option<Column>,
    /// Column of the times in s, by header or by number from 1; default: the first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<Column>,
    /// Times in s in increasing order, instead of a file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub times: Option<Vec<f64>>,
    /// Values, one per time, instead of a file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit-of-the-key" = true))]
    pub values: Option<Vec<f64>>,
    /// Temperatures in K in increasing order, with `value`.
    ///
    /// For a coefficient of a material that depends on the temperature; `factor` may vary in space. Values are linear
    /// between the temperatures. A step with a temperature that the table does not cover ends the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub temperature: Option<Vec<f64>>,
    /// Values of the coefficient, one per temperature.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("x-unit-of-the-key" = true))]
    pub value: Option<Vec<f64>>,
    /// Factor of the values.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub factor: Option<Scalar>,
    /// Extrapolation outside the times.
    #[serde(default)]
    pub extend: Extend,
}

/// A column of a file.
#[derive(Clone, Debug, Deserialize, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(title = "the name of a column or its number from 1")]
pub(in crate::case) enum Column {
    /// By number, from 1.
    Number(#[schemars(range(min = 1))] usize),
    /// By header.
    Name(String),
}

/// Extrapolation outside the times of a table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub(in crate::case) enum Extend {
    /// None: the times must cover those of the run.
    #[default]
    None,
    /// Constant: the first value before, the last value after.
    Hold,
}
