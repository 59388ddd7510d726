//! `check --levels`: the constants of (2.12)–(2.15) on refined meshes, and their limits.

use std::path::Path;

use amontons::case;
use amontons::convergence::{ConstantsTable, Limit};
use amontons::hypotheses::{Constant, DomainConstants, domain_constants};
use serde_json::{Map, Value, json};

use crate::arguments::Common;
use crate::status::CommandFailure;

/// Computes the constants on each of the meshes, or returns `None` without levels.
pub fn table(file: &Path, levels: &[usize], common: &Common) -> Result<Option<ConstantsTable>, CommandFailure> {
    if levels.is_empty() {
        return Ok(None);
    }
    let levels = case::meshes(&common.source(file)?, &common.set, levels)?;
    let meshes = levels
        .iter()
        .map(|level| Ok((level.level, level.problem.mesh.spacing(), domain_constants(&level.problem)?)))
        .collect::<Result<Vec<_>, CommandFailure>>()?;
    Ok(Some(ConstantsTable::new(&meshes)))
}

/// The table as text.
pub fn text(table: &ConstantsTable) -> String {
    let names = DomainConstants::default().named().map(|(name, _)| name);
    let line = |first: &str, second: &str, cells: [String; 6]| {
        let cells: String = cells.iter().map(|cell| format!(" {cell:>16}")).collect();
        format!("  {first:>6} {second:>11}{cells}\n")
    };
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| format!("{v:.9e}"));
    let of_limits =
        |show: &dyn Fn(&Limit) -> String| table.limits.map(|limit| limit.as_ref().map_or_else(|| "-".to_owned(), show));
    let mut text =
        "  constants on refined meshes; on the domain c_k and c_f are not larger, s1 … s2 not smaller\n".to_owned();
    text += &line("level", "h", names.map(str::to_owned));
    for row in &table.rows {
        let values = row.constants.named().map(|(_, constant)| number(constant.map(|c| c.value)));
        text += &line(&row.level.to_string(), &format!("{:.5e}", row.h), values);
    }
    text += &line("order", "", of_limits(&|limit| limit.order.map_or_else(|| "-".to_owned(), |p| format!("{p:.3}"))));
    text += &line("limit", "", of_limits(&|limit| number(Some(limit.value))));
    text + &line("error", "", of_limits(&|limit| format!("{:.1e}", limit.error)))
}

/// Adds the table to JSON: `levels` with one row per mesh, and `limits`.
pub fn add_json(table: &ConstantsTable, value: &mut Value) {
    let names = DomainConstants::default().named().map(|(name, _)| name);
    let by_name = |values: [Value; 6]| names.iter().map(|&name| name.to_owned()).zip(values).collect::<Map<_, _>>();
    let rows = table.rows.iter().map(|row| {
        let constants = by_name(row.constants.named().map(|(_, constant): (_, Option<Constant>)| json!(constant)));
        json!({ "level": row.level, "h": row.h, "constants": constants, "orders": by_name(row.orders.map(|p| json!(p))) })
    });
    value["levels"] = rows.collect();
    value["limits"] = by_name(table.limits.map(|limit| json!(limit))).into();
}
