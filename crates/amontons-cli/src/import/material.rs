//! Materials of a deck, as tables of the case.

use super::deck::{Card, DeckFault, DeckPlace};
use super::notes::{Matter, Notes};
use super::time::DeckPhysics;
use super::units::{UnitFactors, number, numbers};

/// The material of a set of elements.
#[derive(Clone, Debug)]
pub struct DeckSection {
    pub place: DeckPlace,
    /// The regions, one per instance.
    pub regions: Vec<String>,
    pub material: String,
    pub orientation: Option<String>,
    pub thickness: f64,
}

/// Temperature interval in K by which tables of the case extend those of the deck, with constant values.
const BEYOND: f64 = 1e4;
/// Number of parts of an interval when a table of expansion is converted to another reference temperature.
const PARTS: usize = 8;
/// Relative tolerance for equal ratios of shear and volume, which come from typed digits.
const ALIKE: f64 = 1e-6;

/// Rows of a table over the temperature: the values and the temperature.
#[derive(Clone, Debug)]
struct TemperatureRows {
    place: DeckPlace,
    kind: String,
    rows: Vec<(Vec<f64>, f64)>,
}

/// Relaxing branches.
#[derive(Clone, Debug)]
struct DeckProny {
    place: DeckPlace,
    branches: Vec<DeckBranch>,
    /// Long-term moduli of shear and volume divided by the instantaneous ones.
    left: [f64; 2],
}

#[derive(Clone, Copy, Debug)]
struct DeckBranch {
    /// Modulus divided by the long-term modulus.
    ratio: f64,
    time: f64,
    /// True if only shear relaxes.
    of_shear: bool,
}

impl DeckProny {
    /// True if shear and volume relax alike.
    fn is_alike(&self) -> bool {
        self.branches.iter().all(|branch| !branch.of_shear)
    }
}

/// A material of the deck.
#[derive(Clone, Debug)]
pub struct DeckMaterial {
    pub name: String,
    pub place: DeckPlace,
    elastic: Option<TemperatureRows>,
    density: Option<TemperatureRows>,
    expansion: Option<TemperatureRows>,
    zero: f64,
    conductivity: Option<TemperatureRows>,
    specific_heat: Option<TemperatureRows>,
    prony: Option<DeckProny>,
    /// True if its moduli are instantaneous.
    instantaneous: bool,
}

/// Data of the case that its materials depend on.
#[derive(Clone, Copy, Debug)]
pub struct Context {
    pub units: UnitFactors,
    pub physics: DeckPhysics,
    /// True if temperatures are given by `*TEMPERATURE` only, without a heat equation.
    pub warmed: bool,
    pub inertia: bool,
    pub stress_state: Option<&'static str>,
    pub dim: usize,
    /// The temperature that is zero in the case.
    pub shift: f64,
    /// The initial temperature.
    pub initial: f64,
}

/// Entries of a material, each with the place of its keyword.
pub type CardEntries = Vec<(String, String, Option<DeckPlace>)>;

impl DeckMaterial {
    pub fn of(card: &Card) -> Result<DeckMaterial, DeckFault> {
        Ok(DeckMaterial {
            name: card.required("NAME")?.to_owned(),
            place: card.place.clone(),
            elastic: None,
            density: None,
            expansion: None,
            zero: 0.0,
            conductivity: None,
            specific_heat: None,
            prony: None,
            instantaneous: false,
        })
    }

    /// Reads a keyword below `*MATERIAL`. Returns false for keywords that a case cannot express.
    pub fn take(&mut self, card: &Card, notes: &mut Notes) -> Result<bool, DeckFault> {
        match card.name.as_str() {
            "ELASTIC" => {
                self.elastic = Some(elastic(card)?);
                self.instantaneous = card.word("MODULI").as_deref() == Some("INSTANTANEOUS");
            }
            "DENSITY" => {
                let density = table(card, "ISO", 1)?;
                if density.rows.len() > 1 {
                    let why = "the density of a case does not depend on the temperature: the first one is taken";
                    notes.add(&card.place, "*DENSITY", why, Matter::Answer);
                }
                self.density = Some(density);
            }
            "EXPANSION" => {
                let kind = card.word("TYPE").unwrap_or_else(|| "ISO".to_owned());
                self.zero = match card.parameter("ZERO") {
                    Some(text) => text.parse().ok().filter(|zero: &f64| zero.is_finite()).ok_or_else(|| {
                        DeckFault::new(&card.place, format!("ZERO={}", text.escape_debug()), "a temperature")
                    })?,
                    None => 0.0,
                };
                self.expansion = Some(table(card, &kind, if kind == "ORTHO" { 3 } else { 1 })?);
            }
            "CONDUCTIVITY" => {
                let kind = card.word("TYPE").unwrap_or_else(|| "ISO".to_owned());
                self.conductivity = Some(table(card, &kind, if kind == "ORTHO" { 3 } else { 1 })?);
            }
            "SPECIFIC HEAT" => self.specific_heat = Some(table(card, "ISO", 1)?),
            "VISCOELASTIC" => return self.viscoelastic(card, notes),
            "DEPVAR" => notes.add(&card.place, "*DEPVAR", "output only", Matter::Nothing),
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Reads branches of a Prony series; g and k are fractions of the instantaneous moduli of shear and volume. A
    /// branch of a case relaxes both alike, or only shear.
    fn viscoelastic(&mut self, card: &Card, notes: &mut Notes) -> Result<bool, DeckFault> {
        let mut rows = Vec::new();
        for line in &card.data {
            rows.push([line.number(0)?.unwrap_or(0.0), line.number(1)?.unwrap_or(0.0), line.value(2, "a time")?]);
        }
        let [shear, volume] = [0, 1].map(|which| rows.iter().map(|row| row[which]).sum::<f64>());
        // Relative to the long-term moduli, as in a case.
        let ratios = |[g, k, time]: &[f64; 3]| [g / (1.0 - shear), k / (1.0 - volume), *time];
        let is_sound = |row: &[f64; 3]| {
            let [g, k, time] = ratios(row);
            time > 0.0 && k >= 0.0 && g > 0.0 && k - g <= ALIKE * g
        };
        let sums = shear < 1.0 && volume < 1.0;
        if card.word("TIME").as_deref() != Some("PRONY") || rows.is_empty() || !sums || !rows.iter().all(is_sound) {
            let why = "taken are branches whose shear relaxes at least as the volume does, TIME=PRONY with g and k ≤ g";
            notes.add(&card.place, "*VISCOELASTIC", why, Matter::Answer);
            return Ok(true);
        }
        let mut branches = Vec::new();
        for [g, k, time] in rows.iter().map(ratios) {
            if (g - k).abs() <= ALIKE * g {
                branches.push(DeckBranch { ratio: g, time, of_shear: false });
                continue;
            }
            branches.extend((k > 0.0).then_some(DeckBranch { ratio: k, time, of_shear: false }));
            branches.push(DeckBranch { ratio: g - k, time, of_shear: true });
        }
        self.prony = Some(DeckProny { place: card.place.clone(), branches, left: [1.0 - shear, 1.0 - volume] });
        Ok(true)
    }

    /// True if it relaxes.
    pub fn relaxes(&self) -> bool {
        self.prony.is_some()
    }

    /// The reason why a case cannot have such branches, with their line, or `None` if it can.
    pub fn unfit(&self, context: &Context) -> Option<(&DeckPlace, &'static str)> {
        let prony = self.prony.as_ref().filter(|prony| prony.branches.iter().any(|branch| branch.of_shear))?;
        let is_isotropic = self.elastic.as_ref().is_none_or(|elastic| elastic.kind == "ISO");
        let why = if context.stress_state == Some("plane-stress") {
            "a case has no branch of shear alone in plane stress: its body does not relax"
        } else if !is_isotropic {
            "a case has branches of shear alone for isotropic moduli: its body does not relax"
        } else {
            return None;
        };
        Some((&prony.place, why))
    }

    /// The long-term moduli, as used by a case.
    fn long_term(&self, elastic: &TemperatureRows) -> TemperatureRows {
        let mut table = elastic.clone();
        let Some(prony) = self.prony.as_ref().filter(|_| self.instantaneous) else { return table };
        let [shear, volume] = prony.left;
        for (row, _) in &mut table.rows {
            match row.as_mut_slice() {
                [young, poisson] => {
                    // G/K in the long term; ν = (3 − 2 G/K)/(6 + 2 G/K).
                    let modulus = *young / (2.0 * (1.0 + *poisson)) * shear;
                    let ratio = 1.5 * (1.0 - 2.0 * *poisson) / (1.0 + *poisson) * shear / volume;
                    *poisson = if prony.is_alike() { *poisson } else { (3.0 - 2.0 * ratio) / (6.0 + 2.0 * ratio) };
                    *young = 2.0 * modulus * (1.0 + *poisson);
                }
                row => {
                    // Poisson's ratios are unchanged.
                    let is_modulus = |column: &usize| elastic.kind != "ENGINEERING" || !(3..6).contains(column);
                    let moduli = row.iter_mut().enumerate().filter(|(column, _)| is_modulus(column));
                    moduli.for_each(|(_, value)| *value *= shear);
                }
            }
        }
        table
    }

    /// The density, in the units of the deck.
    pub fn density(&self) -> Option<f64> {
        self.density.as_ref().and_then(|table| table.rows.first()).and_then(|row| row.0.first()).copied()
    }

    pub fn expands(&self) -> bool {
        self.expansion.as_ref().is_some_and(|table| table.rows.iter().any(|row| row.0.iter().any(|a| *a != 0.0)))
    }

    /// True if its mechanics depends on the temperature: it expands, or its moduli are tables over the temperature.
    pub fn sees_temperature(&self) -> bool {
        self.expands() || self.elastic.as_ref().is_some_and(|table| table.rows.len() > 1)
    }

    /// Conductivity, in the units of the deck.
    pub fn conducts(&self) -> Option<f64> {
        self.conductivity.as_ref().and_then(|table| table.rows.first()).and_then(|row| row.0.first()).copied()
    }

    /// The entries of the table of the case.
    pub fn entries(&self, context: &Context, angle: Option<&str>) -> Result<CardEntries, DeckFault> {
        let mut entries = CardEntries::new();
        let missing = |what: &str| {
            let found = format!("the material {} without *{what}", self.name.escape_debug());
            DeckFault::new(&self.place, found, format!("*{what} below *MATERIAL, which the steps of the deck need"))
        };
        if context.physics.mechanics {
            if context.inertia {
                let density = self.density.as_ref().ok_or_else(|| missing("DENSITY"))?;
                entries.push(one("density", density, context, context.units.density()));
            }
            let elastic = self.elastic.as_ref().ok_or_else(|| missing("ELASTIC"))?;
            let text = elasticity(&self.long_term(elastic), context, angle);
            entries.push(("elasticity".into(), text, Some(elastic.place.clone())));
            let branch = |branch: &DeckBranch| {
                let alone = if branch.of_shear { ", deviatoric = true" } else { "" };
                let time = number(branch.time * context.units.time);
                format!("{{ ratio = {}, time = {time}{alone} }}", number(branch.ratio))
            };
            if let Some(prony) = self.prony.as_ref().filter(|_| self.unfit(context).is_none()) {
                let branches: Vec<String> = prony.branches.iter().map(branch).collect();
                entries.push(("prony".into(), format!("[{}]", branches.join(", ")), Some(prony.place.clone())));
            }
        }
        if context.physics.mechanics
            && (context.physics.heat || context.warmed)
            && let Some(expansion) = &self.expansion
        {
            entries.push((
                "expansion_coefficient".into(),
                self.expanding(expansion, context),
                Some(expansion.place.clone()),
            ));
        }
        if context.physics.heat {
            self.heat(context, &mut entries, missing)?;
        }
        Ok(entries)
    }

    fn heat(
        &self,
        context: &Context,
        entries: &mut CardEntries,
        missing: impl Fn(&str) -> DeckFault,
    ) -> Result<(), DeckFault> {
        if context.physics.stores {
            let heat = self.specific_heat.as_ref().ok_or_else(|| missing("SPECIFIC HEAT"))?;
            let density = self.density().ok_or_else(|| missing("DENSITY"))?;
            let factor = density * context.units.density() * context.units.specific_heat();
            entries.push(one("heat_capacity", heat, context, factor));
        } else {
            entries.push(("heat_capacity".into(), "0.0".into(), None));
        }
        let factor = context.units.conductivity();
        match &self.conductivity {
            Some(table) if table.kind == "ORTHO" => {
                let of = |d: usize| coefficient(table, d, context, factor);
                let row = |r: usize| {
                    let entries: Vec<String> =
                        (0..context.dim).map(|c| if c == r { of(r) } else { "0.0".to_owned() }).collect();
                    format!("[{}]", entries.join(", "))
                };
                let rows: Vec<String> = (0..context.dim).map(row).collect();
                entries.push(("conductivity".into(), format!("[{}]", rows.join(", ")), Some(table.place.clone())));
            }
            Some(table) => entries.push(one("conductivity", table, context, factor)),
            None => return Err(missing("CONDUCTIVITY")),
        }
        Ok(())
    }

    /// Coefficients of expansion from the initial temperature, at which the body is stress-free in the deck.
    fn expanding(&self, table: &TemperatureRows, context: &Context) -> String {
        let along = |d: usize| {
            let points = points(table, d);
            if points.len() < 2 || (self.zero - context.initial).abs() < 1e-9 {
                return coefficient(table, d, context, 1.0);
            }
            let strain = |t: f64| at(&points, t) * (t - self.zero);
            let start = strain(context.initial);
            let secant = |t: f64| {
                let theta = t - context.initial;
                let h = 1e-4;
                if theta.abs() < h {
                    (strain(context.initial + h) - strain(context.initial - h)) / (2.0 * h)
                } else {
                    (strain(t) - start) / theta
                }
            };
            let mut finer: Vec<(f64, f64)> = Vec::new();
            for pair in points.windows(2) {
                let [a, b] = pair else { continue };
                let part = |i: usize| a.0 + (b.0 - a.0) * i as f64 / PARTS as f64;
                finer.extend((0..PARTS).map(part).map(|t| (t, secant(t))));
            }
            finer.extend(points.last().map(|last| (last.0, secant(last.0))));
            over_temperature(&finer, context.shift)
        };
        if table.kind == "ORTHO" { format!("[{}, {}, {}]", along(0), along(1), along(2)) } else { along(0) }
    }
}

/// An entry with one coefficient.
fn one(key: &str, table: &TemperatureRows, context: &Context, factor: f64) -> (String, String, Option<DeckPlace>) {
    (key.to_owned(), coefficient(table, 0, context, factor), Some(table.place.clone()))
}

/// Rows with `values` values and a temperature.
fn table(card: &Card, kind: &str, values: usize) -> Result<TemperatureRows, DeckFault> {
    if !["ISO", "ISOTROPIC", "ORTHO"].contains(&kind) {
        let found = format!("*{}, TYPE={}", card.name, kind.escape_debug());
        return Err(DeckFault::new(&card.place, found, "TYPE=ISO or TYPE=ORTHO"));
    }
    card.first("a value")?;
    let mut rows = Vec::new();
    for line in &card.data {
        let row = (0..values).map(|i| line.value(i, "a value")).collect::<Result<Vec<_>, _>>()?;
        rows.push((row, line.number(values)?.unwrap_or(0.0)));
    }
    sorted(card, kind, rows)
}

/// `*ELASTIC`: isotropic, by engineering constants, or by an orthotropic stiffness.
fn elastic(card: &Card) -> Result<TemperatureRows, DeckFault> {
    let kind = card.word("TYPE").unwrap_or_else(|| "ISO".to_owned());
    let (kind, values) = match kind.as_str() {
        "ISO" | "ISOTROPIC" => ("ISO", 2),
        "ENGINEERING CONSTANTS" | "ENGINEERINGCONSTANTS" => ("ENGINEERING", 9),
        "ORTHO" | "ORTHOTROPIC" => ("ORTHO", 9),
        other => {
            let expected = "TYPE=ISO, ENGINEERING CONSTANTS or ORTHO";
            return Err(DeckFault::new(&card.place, format!("*ELASTIC, TYPE={}", other.escape_debug()), expected));
        }
    };
    card.first("Young's modulus and Poisson's ratio")?;
    let mut rows = Vec::new();
    if values == 2 {
        for line in &card.data {
            let row = vec![line.value(0, "Young's modulus")?, line.value(1, "Young's modulus and Poisson's ratio")?];
            rows.push((row, line.number(2)?.unwrap_or(0.0)));
        }
        return sorted(card, kind, rows);
    }
    for pair in card.data.chunks(2) {
        let [first, second] = pair else {
            return Err(DeckFault::new(
                &card.place,
                "an odd number of lines",
                "nine constants in two lines per temperature",
            ));
        };
        let mut row = (0..8).map(|i| first.value(i, "eight constants")).collect::<Result<Vec<_>, _>>()?;
        row.push(second.value(0, "the ninth constant")?);
        rows.push((row, second.number(1)?.unwrap_or(0.0)));
    }
    sorted(card, kind, rows)
}

fn sorted(card: &Card, kind: &str, rows: Vec<(Vec<f64>, f64)>) -> Result<TemperatureRows, DeckFault> {
    if let Some(pair) = rows.windows(2).find(|pair| matches!(pair, [a, b] if a.1 >= b.1)) {
        let found = format!("the temperature {} after {}", number(pair[1].1), number(pair[0].1));
        return Err(DeckFault::new(&card.place, found, "temperatures that increase from line to line"));
    }
    Ok(TemperatureRows { place: card.place.clone(), kind: kind.to_owned(), rows })
}

/// Temperatures and values of a column.
fn points(table: &TemperatureRows, column: usize) -> Vec<(f64, f64)> {
    table.rows.iter().map(|row| (row.1, row.0.get(column).copied().unwrap_or(0.0))).collect()
}

/// The value at a temperature, constant beyond the table.
fn at(points: &[(f64, f64)], t: f64) -> f64 {
    let after = points.partition_point(|point| point.0 <= t);
    match (after.checked_sub(1).and_then(|before| points.get(before)), points.get(after)) {
        (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (t - a.0) / (b.0 - a.0),
        (Some(only), None) | (None, Some(only)) => only.1,
        (None, None) => 0.0,
    }
}

/// A column as a coefficient of the case.
fn coefficient(table: &TemperatureRows, column: usize, context: &Context, factor: f64) -> String {
    let points: Vec<(f64, f64)> = points(table, column).into_iter().map(|(t, value)| (t, value * factor)).collect();
    let first = points.first().map_or(0.0, |point| point.1);
    if points.iter().all(|point| point.1.total_cmp(&first).is_eq()) {
        return number(first);
    }
    if !context.physics.heat && !context.warmed {
        return number(at(&points, context.initial));
    }
    over_temperature(&points, context.shift)
}

/// A table over the temperature, extended by constant values as in the deck.
fn over_temperature(points: &[(f64, f64)], shift: f64) -> String {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return "0.0".to_owned() };
    let ends = ([(first.0 - BEYOND, first.1)], [(last.0 + BEYOND, last.1)]);
    let all: Vec<(f64, f64)> = ends.0.into_iter().chain(points.iter().copied()).chain(ends.1).collect();
    let temperature = numbers(all.iter().map(|point| point.0 - shift));
    format!("{{ temperature = {temperature}, value = {} }}", numbers(all.iter().map(|point| point.1)))
}

fn elasticity(table: &TemperatureRows, context: &Context, angle: Option<&str>) -> String {
    let stress = context.units.stress();
    let of = |column: usize, factor: f64| coefficient(table, column, context, factor);
    let state = context.stress_state.map_or_else(String::new, |state| format!(", stress_state = \"{state}\""));
    let turned = angle.map_or_else(String::new, |angle| format!(", orientation = {angle}"));
    match table.kind.as_str() {
        "ISO" => {
            format!("{{ law = \"isotropic\", young = {}, poisson = {}{state} }}", of(0, stress), of(1, 1.0))
        }
        "ENGINEERING" => {
            let three =
                |columns: [usize; 3], factor: f64| format!("[{}]", columns.map(|column| of(column, factor)).join(", "));
            let (young, poisson, shear) = (three([0, 1, 2], stress), three([3, 4, 5], 1.0), three([6, 7, 8], stress));
            format!("{{ law = \"orthotropic\", young = {young}, poisson = {poisson}, shear = {shear}{turned}{state} }}")
        }
        _ => {
            // D1111, D1122, D2222, D1133, D2233, D3333, D1212, D1313, D2323 in the order 11 22 33 23 13 12.
            let places = [[Some(0), Some(1), Some(3)], [Some(1), Some(2), Some(4)], [Some(3), Some(4), Some(5)]];
            let mut rows: Vec<String> = Vec::new();
            for row in places {
                let row = row.into_iter().chain([None; 3]);
                rows.push(voigt(row, &of, stress));
            }
            for (place, column) in [(3, 8), (4, 7), (5, 6)] {
                rows.push(voigt((0..6).map(|c| (c == place).then_some(column)), &of, stress));
            }
            format!("{{ law = \"anisotropic\", voigt = [{}]{turned}{state} }}", rows.join(", "))
        }
    }
}

/// A row of a stiffness.
fn voigt(columns: impl Iterator<Item = Option<usize>>, of: &impl Fn(usize, f64) -> String, stress: f64) -> String {
    let entries: Vec<String> =
        columns.map(|column| column.map_or_else(|| "0.0".to_owned(), |column| of(column, stress))).collect();
    format!("[{}]", entries.join(", "))
}
