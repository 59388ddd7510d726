//! Checks the document against the schema of the case file and collects all departures.
//!
//! The walk returns the document as JSON with placeholders for faulty values, so that it can be read into
//! [`super::raw::Case`] and conditions on several values can be checked as well.

use serde_json::{Map, Value};
use toml::de::{DeArray, DeTable, DeValue};

use super::nearest::{meant, nearest};
use super::path::Path;
use super::place::{At, PathFault};
use super::quantity::{NumberText, NumberWithUnit, read};
use super::schema::{Limits, SchemaView, one_of};
use crate::units::TemperatureScale;

/// Number of faults up to which misplaced keys are searched for in all tables.
const HINTED: usize = 500;

/// Result of the walk.
pub(super) struct Checked {
    /// The document, with placeholders for values that depart from the schema.
    pub value: Value,
    /// The departures.
    pub findings: Vec<PathFault>,
    /// Paths of placeholders. Ignore later findings there.
    pub doubtful: Vec<Path>,
    /// Limits for the values of expressions and tables, by the keys that have bounds.
    pub limits: Vec<(Path, Limits)>,
    /// The scale of temperatures.
    pub scale: TemperatureScale,
}

/// Walks a document along a schema.
pub(super) fn check(schema: &Value, document: &DeTable<'_>) -> Checked {
    let units = document.get("units").and_then(|units| units.get_ref().as_str());
    let phases = document.get("phase").and_then(|phases| phases.get_ref().as_array());
    let has_phases = phases.is_some_and(|phases| !phases.is_empty());
    let mut walk = Walk {
        all: SchemaView::new(schema),
        findings: Vec::new(),
        doubtful: Vec::new(),
        limits: Vec::new(),
        has_units: units != Some("dimensionless"),
        required: if has_phases { SchemaView::required_with_phases } else { SchemaView::required },
        has_thickness: document.contains_key("thickness"),
        is_told: false,
        scales: [None, None],
    };
    let value = walk.table(walk.all, &Path::default(), document);
    let scale = if walk.scales[1].is_some() { TemperatureScale::Celsius } else { TemperatureScale::Kelvin };
    Checked { value, findings: walk.findings, doubtful: walk.doubtful, limits: walk.limits, scale }
}

struct Walk<'s> {
    all: SchemaView<'s>,
    findings: Vec<PathFault>,
    doubtful: Vec<Path>,
    limits: Vec<(Path, Limits)>,
    /// True if numbers may have units.
    has_units: bool,
    /// The keys that a table must have: without those of the end and the steps if the case has phases.
    required: fn(&SchemaView<'s>) -> Vec<&'s str>,
    /// True if forces and the like are those of a whole plane body, and never per metre of its thickness.
    has_thickness: bool,
    /// True if the use of two temperature scales has been reported.
    is_told: bool,
    /// The first temperatures in K and in °C.
    scales: [Option<Path>; 2],
}

impl<'s> Walk<'s> {
    fn value(&mut self, schema: SchemaView<'s>, path: &Path, found: &DeValue<'_>) -> Value {
        let alternatives = schema.alternatives();
        if let Some(value) = self.measured(schema, path, found) {
            return value;
        }
        if !alternatives.is_empty() {
            if let Some(form) = alternatives.iter().find(|form| takes(form.kind(), found)) {
                if matches!(found, DeValue::String(_) | DeValue::Table(_)) {
                    self.limits.push((path.clone(), schema.limits()));
                }
                return self.value(*form, path, found);
            }
            let hint = alternatives.iter().find_map(|form| hint_for_kind(*form, path, found));
            return self.mismatch(schema, path, found, hint);
        }
        if let (Some(key), Some(text)) = (schema.short_for(), found.as_str()) {
            return Value::Object(Map::from_iter([(key.to_owned(), Value::from(text))]));
        }
        match found {
            _ if !takes(schema.kind(), found) => self.mismatch(schema, path, found, hint_for_kind(schema, path, found)),
            DeValue::Table(table) => self.table(schema, path, table),
            DeValue::Array(array) => self.array(schema, path, array),
            DeValue::String(word) => self.word(schema, path, found, word),
            DeValue::Integer(_) | DeValue::Float(_) => self.number(schema, path, found),
            DeValue::Boolean(value) => Value::from(*value),
            DeValue::Datetime(_) => self.mismatch(schema, path, found, None),
        }
    }

    /// The number in a text such as `"210 GPa"` where a number is allowed, or `None` for another text.
    fn measured(&mut self, schema: SchemaView<'s>, path: &Path, found: &DeValue<'_>) -> Option<Value> {
        let text = found.as_str()?;
        let number = |form: &SchemaView<'s>| form.kind() == "number";
        let form = Some(schema).filter(number).or_else(|| schema.alternatives().into_iter().find(number))?;
        let unit = schema.unit();
        let about = schema.about().map(|about| format!(" ({about})")).unwrap_or_default();
        let (expected, hint) = match (read(text)?, unit) {
            (NumberText::Unknown(_), None) => return None,
            (_, _) if !self.has_units => {
                (format!("a number without a unit, as the key `units` of the case says{about}"), None)
            }
            (NumberText::Quantity(quantity), unit)
                if unit.map_or(quantity.unit.is_number(), |(unit, _)| {
                    quantity.unit.is_like(&unit, schema.is_per_thickness() && !self.has_thickness)
                }) =>
            {
                if !form.admits(quantity.number) {
                    return Some(self.mismatch(schema, path, found, None));
                }
                self.on_a_scale(schema, path, &quantity);
                return Some(Value::from(quantity.number));
            }
            (NumberText::Unknown(word), Some((_, si))) => {
                let hint =
                    format!("the unit `{}` is not known; units are written as in \"W/(m K)\"", word.escape_debug());
                (format!("a quantity in {si} or in a unit that converts to it{about}"), Some(hint))
            }
            (_, Some((_, si))) => (format!("a quantity in {si} or in a unit that converts to it{about}"), None),
            (_, None) => (format!("a number without a unit{about}"), None),
        };
        self.findings.push(PathFault::new(path.clone(), At::Value, describe(found), expected).hint(hint));
        self.doubtful.push(path.clone());
        Some(schema.sample())
    }

    /// Notes the scale of a temperature and reports a second scale.
    fn on_a_scale(&mut self, schema: SchemaView<'s>, path: &Path, quantity: &NumberWithUnit) {
        if !quantity.unit.is_temperature() || schema.is_difference() {
            return;
        }
        let [kelvin, celsius] = &mut self.scales;
        let (own, other) = if quantity.unit.is_celsius() { (celsius, kelvin) } else { (kelvin, celsius) };
        own.get_or_insert_with(|| path.clone());
        if let Some(other) = other
            && !std::mem::replace(&mut self.is_told, true)
        {
            let [this, that] = if quantity.unit.is_celsius() { ["°C", "K"] } else { ["K", "°C"] };
            let found = format!("a temperature in {this} beside one in {that}, {other}");
            let hint = "thermal stress is zero at the temperature 0 on the scale of the case";
            let expected = "all temperatures of a case on one scale";
            self.findings.push(PathFault::new(path.clone(), At::Value, found, expected).hint(Some(hint.to_owned())));
        }
    }

    /// Notes a value that departs from the schema, and returns a placeholder.
    fn mismatch(&mut self, schema: SchemaView<'s>, path: &Path, found: &DeValue<'_>, hint: Option<String>) -> Value {
        self.findings.push(PathFault::new(path.clone(), At::Value, describe(found), schema.expected()).hint(hint));
        self.doubtful.push(path.clone());
        schema.sample()
    }

    fn number(&mut self, schema: SchemaView<'s>, path: &Path, found: &DeValue<'_>) -> Value {
        let integer = integer(found);
        let Some(number) = number(found).filter(|n| n.is_finite()) else {
            let hint = match found {
                DeValue::Integer(_) => {
                    Some("an integer has at most 19 digits; write a larger number as 1e20".to_owned())
                }
                _ => None,
            };
            return self.mismatch(schema, path, found, hint);
        };
        if !schema.admits(number) {
            return self.mismatch(schema, path, found, None);
        }
        match integer {
            Some(integer) => Value::from(integer),
            None => Value::from(number),
        }
    }

    fn word(&mut self, schema: SchemaView<'s>, path: &Path, found: &DeValue<'_>, word: &str) -> Value {
        let words = schema.words();
        if words.is_empty() || words.contains(&word) {
            return Value::from(word);
        }
        let hint = meant(word, &words);
        self.mismatch(schema, path, found, hint)
    }

    fn array(&mut self, schema: SchemaView<'s>, path: &Path, array: &DeArray<'_>) -> Value {
        let (least, most) = schema.lengths();
        let count = array.len() as u64;
        if count < least || count > most {
            let found = format!("an array of {count}");
            self.findings.push(PathFault::new(path.clone(), At::Value, found, schema.expected()));
            self.doubtful.push(path.clone());
            return schema.sample();
        }
        let Some(items) = schema.items() else { return Value::Array(Vec::new()) };
        array.iter().enumerate().map(|(i, entry)| self.value(items, &path.index(i), entry.get_ref())).collect()
    }

    fn table(&mut self, schema: SchemaView<'s>, path: &Path, table: &DeTable<'_>) -> Value {
        let Some((tag, variants)) = schema.variants() else {
            return Value::Object(self.entries(schema, path, table));
        };
        let names: Vec<&str> =
            variants.iter().filter(|(_, variant)| variant.implied_by().is_none()).map(|(name, _)| *name).collect();
        let implied = variants.iter().filter_map(|(name, variant)| Some((*name, *variant, variant.implied_by()?)));
        let expected = implied.clone().fold(one_of(&names), |text, (_, _, key)| format!("{text}, or the key `{key}`"));
        if table.get(tag).is_none()
            && let Some((name, variant, _)) = implied.clone().find(|(_, _, key)| table.get(*key).is_some())
        {
            let mut entries = self.entries(variant, path, table);
            entries.insert(tag.to_owned(), Value::from(name));
            return Value::Object(entries);
        }
        let found = table.iter().find(|(key, _)| key.get_ref() == tag).map(|(_, value)| value.get_ref());
        let chosen = found.and_then(DeValue::as_str).and_then(|word| variants.iter().find(|(name, _)| *name == word));
        if let Some((_, variant)) = chosen {
            return Value::Object(self.entries(*variant, path, table));
        }
        let finding = match found {
            Some(value) => PathFault::new(path.key(tag), At::Value, describe(value), expected)
                .hint(value.as_str().and_then(|word| meant(word, &names))),
            None => PathFault::new(path.key(tag), At::Missing, "no such key", expected),
        };
        self.findings.push(finding);
        self.doubtful.push(path.clone());
        schema.sample()
    }

    /// Walks the known keys of a table, and notes unknown and missing ones.
    fn entries(&mut self, schema: SchemaView<'s>, path: &Path, table: &DeTable<'_>) -> Map<String, Value> {
        let mut entries = Map::new();
        let mut meant = Vec::new();
        for (key, value) in table {
            let key = key.get_ref();
            let at = path.key(key);
            match schema.property(key) {
                Some(property) => {
                    let value = self.value(property, &at, value.get_ref());
                    entries.insert(key.to_string(), value);
                }
                None => meant.extend(self.unknown_key(schema, at, key, table)),
            }
        }
        // A key under a wrong name is not a missing key.
        self.doubtful.extend(meant.iter().map(|key| path.key(key)));
        let is_steady = entries.get("analysis").and_then(Value::as_str) == Some("steady");
        let optional = if is_steady { schema.not_in_steady() } else { Vec::new() };
        for key in (self.required)(&schema) {
            if entries.contains_key(key) || optional.contains(&key) {
                continue;
            }
            let (Some(property), at) = (schema.property(key), path.key(key)) else { continue };
            if !meant.contains(&key) {
                self.findings.push(PathFault::new(at.clone(), At::Missing, "no such key", property.expected()));
            }
            self.doubtful.push(at);
            entries.insert(key.to_owned(), property.sample());
        }
        entries
    }

    /// Notes an unknown key. Returns the key of this table that was probably meant, if any.
    fn unknown_key(&mut self, schema: SchemaView<'s>, at: Path, key: &str, table: &DeTable<'_>) -> Option<&'s str> {
        let keys = schema.keys();
        let absent: Vec<&str> = keys.iter().copied().filter(|k| table.get(*k).is_none()).collect();
        let meant = nearest(key, &absent).or_else(|| nearest(key, &keys)).or_else(|| synonym(key, &keys));
        let hint = match meant {
            Some(meant) => Some(format!("did you mean `{meant}`?")),
            // The search through all tables takes time, and only the first of many faults are shown.
            None if self.findings.len() < HINTED => self.home_of(key, &at),
            None => None,
        };
        let expected = match keys.as_slice() {
            [] => "no key here".to_owned(),
            [only] => format!("`{only}` alone"),
            _ => format!("one of {}", keys.join(", ")),
        };
        self.doubtful.push(at.clone());
        self.findings.push(PathFault::new(at, At::Key, "an unknown key", expected).hint(hint));
        meant
    }

    /// The tables to which a misplaced key belongs: this one with another law, if there is one, else others.
    fn home_of(&self, key: &str, at: &Path) -> Option<String> {
        let homes = self.all.homes(key);
        let table = at.to_string();
        let here: Vec<String> = table.rsplit_once('.').map(|(table, _)| format!("[{table}] ")).into_iter().collect();
        let near: Vec<String> =
            homes.iter().filter(|home| here.iter().any(|here| home.starts_with(here.as_str()))).cloned().collect();
        let homes = if near.is_empty() { homes } else { near };
        (!homes.is_empty()).then(|| format!("`{key}` belongs to {}", homes.join(" or ")))
    }
}

/// True if a value has the type named by the schema.
fn takes(kind: &str, found: &DeValue<'_>) -> bool {
    match found {
        DeValue::String(_) => kind == "string",
        DeValue::Integer(_) => matches!(kind, "integer" | "number"),
        DeValue::Float(_) => kind == "number",
        DeValue::Boolean(_) => kind == "boolean",
        DeValue::Datetime(_) => false,
        DeValue::Array(_) => kind == "array",
        DeValue::Table(_) => kind == "object",
    }
}

fn integer(found: &DeValue<'_>) -> Option<i64> {
    let integer = found.as_integer()?;
    i64::from_str_radix(integer.as_str(), integer.radix()).ok()
}

fn number(found: &DeValue<'_>) -> Option<f64> {
    match found {
        DeValue::Float(float) => float.as_str().parse().ok(),
        _ => integer(found).map(|i| i as f64),
    }
}

/// Correction of a value of wrong type, if its meaning is clear.
fn hint_for_kind(schema: SchemaView<'_>, path: &Path, found: &DeValue<'_>) -> Option<String> {
    match (schema.kind(), found) {
        ("number" | "integer", DeValue::String(text)) if text.trim().parse::<f64>().is_ok() => {
            Some(format!("write {} without quotes", text.trim()))
        }
        ("integer", DeValue::Float(_)) => {
            let whole = number(found).filter(|n| n.fract() == 0.0 && n.abs() < 1e15)?;
            Some(format!("write {whole}"))
        }
        ("array", DeValue::Table(_)) => {
            schema.items().filter(|items| items.kind() == "object").map(|_| format!("write [[{path}]]"))
        }
        _ => None,
    }
}

/// A value as shown in a message.
fn describe(found: &DeValue<'_>) -> String {
    const LONGEST: usize = 40;
    match found {
        DeValue::String(text) if text.chars().count() > LONGEST => {
            format!("\"{}…\"", text.chars().take(LONGEST).collect::<String>().escape_debug())
        }
        DeValue::String(text) => format!("\"{}\"", text.escape_debug()),
        DeValue::Integer(integer) => integer.to_string(),
        DeValue::Float(float) => float.to_string(),
        DeValue::Boolean(value) => value.to_string(),
        DeValue::Datetime(date) => format!("the date {date}"),
        DeValue::Array(array) => format!("an array of {}", array.len()),
        DeValue::Table(_) => "a table".to_owned(),
    }
}

/// Synonyms of keys, from other programs and textbooks.
const SYNONYMS: [(&str, &[&str]); 26] = [
    ("on", &["side", "sides", "facets", "facet_set", "where", "part", "surface", "name"]),
    ("n", &["cells", "elements", "divisions", "resolution", "subdivisions", "nx"]),
    ("size", &["lengths", "dimensions", "extent", "width", "length"]),
    ("kind", &["type", "shape"]),
    ("law", &["type", "model", "kind"]),
    ("end", &["t", "t_end", "final", "final_time", "duration", "stop"]),
    ("steps", &["n", "dt", "k", "step", "time_step", "number_of_steps"]),
    ("density", &["rho", "ρ", "mass_density"]),
    ("heat_capacity", &["c", "cp", "c_p", "specific_heat", "capacity"]),
    ("expansion", &["m", "alpha", "thermal_expansion", "𝓜"]),
    ("coupling", &["r", "𝓡", "thermal_coupling"]),
    ("conductivity", &["k", "kappa", "𝓚", "thermal_conductivity"]),
    ("young", &["e", "youngs_modulus", "young_modulus", "modulus"]),
    ("poisson", &["nu", "ν", "poissons_ratio", "poisson_ratio"]),
    ("first", &["lambda", "mu1", "mu_1", "bulk"]),
    ("second", &["mu", "mu2", "mu_2", "shear"]),
    ("body_force", &["force", "f", "f0", "f_0", "gravity", "volume_force"]),
    ("heat_source", &["q", "q0", "q_0", "source", "heat"]),
    ("displacement", &["u", "u0", "u_0", "dirichlet", "fixed", "clamped"]),
    ("velocity", &["v", "w", "v0", "u1", "u_1"]),
    ("traction", &["f1", "f_1", "force", "pressure", "stress", "neumann"]),
    ("temperature", &["theta", "theta0", "theta_0", "θ", "t"]),
    ("heat_inflow", &["flux", "heat_flux", "q"]),
    ("stiffness", &["c", "c_nu", "penalty"]),
    ("coefficient", &["mu", "μ", "mu_tau", "friction"]),
    ("foundation_temperature", &["theta_f", "temperature", "ambient"]),
];

/// The key of a table with this synonym.
fn synonym<'k>(word: &str, keys: &[&'k str]) -> Option<&'k str> {
    let word = word.to_lowercase().replace('-', "_");
    let ours = SYNONYMS.iter().filter(|(_, others)| others.contains(&word.as_str())).map(|(ours, _)| *ours);
    ours.into_iter().find_map(|ours| keys.iter().copied().find(|key| *key == ours))
}
