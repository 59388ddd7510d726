//! The JSON Schema of the case file, and a view of it that says in words what a key expects.

use schemars::transform::{Transform, transform_subschemas};
use serde_json::{Map, Value};

use super::quantity::{Unit, of_description};
use super::raw;

/// The JSON Schema (2020-12) of the case file. `x-unit` is the SI unit of the numbers of a key.
#[must_use]
pub fn schema() -> Value {
    let mut schema = rules();
    allow_units(&mut schema, None);
    schema
}

/// Allows a text with a unit in place of a number with a unit, and notes the unit. Allows a text in place of a table.
fn allow_units(schema: &mut Value, above: Option<&str>) {
    let Value::Object(node) = schema else { return };
    let named = node.get("description").and_then(Value::as_str).map(|text| of_description(text).map(|(_, unit)| unit));
    let mut unit = named.map_or(above, |unit| unit).map(str::to_owned);
    if let Some(unit) = unit.as_ref().filter(|_| named.is_some()) {
        node.insert(UNIT.to_owned(), Value::from(unit.as_str()));
    }
    if node.contains_key(OF_THE_KEY) {
        // Values of a table have a unit, given by its key.
        unit = Some(String::new());
    }
    if unit.is_some() && node.get("type").and_then(Value::as_str) == Some("number") {
        node.insert("type".to_owned(), Value::from(vec!["number", "string"]));
        node.insert("pattern".to_owned(), Value::from("^[+-]?[0-9.]+"));
    }
    if node.contains_key(SHORT_FOR) {
        node.insert("type".to_owned(), Value::from(vec!["object", "string"]));
    }
    for (keyword, inner) in node.iter_mut() {
        // The keys of a table have their own descriptions.
        let of_this = if matches!(keyword.as_str(), "items" | "anyOf") { unit.as_deref() } else { None };
        match inner {
            Value::Array(all) => all.iter_mut().for_each(|inner| allow_units(inner, of_this)),
            Value::Object(all) if matches!(keyword.as_str(), "properties" | "$defs") => {
                all.values_mut().for_each(|inner| allow_units(inner, None));
            }
            inner => allow_units(inner, of_this),
        }
    }
}

/// The schema that documents are checked against.
pub(super) fn rules() -> Value {
    let mut schema = schemars::schema_for!(raw::Case);
    NoNull.transform(&mut schema);
    Implied.transform(&mut schema);
    LawTags.transform(&mut schema);
    schema.to_value()
}

/// Keyword of a table that is recognized by one of its keys if the tag is left out.
const IMPLIED_BY: &str = "x-implied-by";

/// Keyword of a table that may be replaced by a text: the value of the named key.
const SHORT_FOR: &str = "x-short-for";

/// Keyword of the unit of the numbers of a key.
const UNIT: &str = "x-unit";

/// Keyword of the values of a table, which have the unit of the key of the table.
const OF_THE_KEY: &str = "x-unit-of-the-key";

/// Allows the tag of a table with [`IMPLIED_BY`] to be left out.
struct Implied;

impl Transform for Implied {
    fn transform(&mut self, schema: &mut schemars::Schema) {
        transform_subschemas(self, schema);
        let Some(object) = schema.as_object_mut().filter(|object| object.contains_key(IMPLIED_BY)) else { return };
        let tags: Vec<String> = object
            .get("properties")
            .and_then(Value::as_object)
            .into_iter()
            .flatten()
            .filter(|(_, property)| property.get("const").is_some())
            .map(|(key, _)| key.clone())
            .collect();
        if let Some(Value::Array(required)) = object.get_mut("required") {
            required.retain(|key| key.as_str().is_none_or(|key| !tags.iter().any(|tag| tag == key)));
        }
    }
}

/// Mark of a key that is required in a case without phases.
const WITHOUT_PHASES: &str = "x-required-without-phases";
/// Mark of a key that is required in a table whose analysis is not steady.
const UNLESS_STEADY: &str = "x-required-unless-steady";

/// Gives the tag of a table, such as `law = "coulomb"`, the description of the table that it selects.
struct LawTags;

impl Transform for LawTags {
    fn transform(&mut self, schema: &mut schemars::Schema) {
        transform_subschemas(self, schema);
        let Some(object) = schema.as_object_mut() else { return };
        let Some(description) = object.get("description").cloned() else { return };
        for property in object
            .get_mut("properties")
            .and_then(Value::as_object_mut)
            .into_iter()
            .flatten()
            .map(|(_, property)| property)
        {
            if let Some(tag) = property.as_object_mut().filter(|tag| tag.contains_key("const")) {
                tag.entry("description").or_insert_with(|| description.clone());
            }
        }
    }
}

/// Removes null, which TOML does not have: an optional key is left out.
struct NoNull;

impl Transform for NoNull {
    fn transform(&mut self, schema: &mut schemars::Schema) {
        transform_subschemas(self, schema);
        let Some(object) = schema.as_object_mut() else { return };
        let is_null = |v: &Value| v.as_str() == Some("null") || v.get("type").and_then(Value::as_str) == Some("null");
        for keyword in ["type", "anyOf"] {
            let Some(Value::Array(alternatives)) = object.get_mut(keyword) else { continue };
            alternatives.retain(|v| !is_null(v));
            let [only] = alternatives.as_mut_slice() else { continue };
            let only = only.take();
            match only {
                Value::Object(fields) => {
                    object.remove(keyword);
                    object.extend(fields);
                }
                kind => {
                    object.insert(keyword.to_owned(), kind);
                }
            }
        }
    }
}

/// A place in a schema, references resolved.
#[derive(Clone, Copy)]
pub(super) struct SchemaView<'s> {
    root: &'s Value,
    node: &'s Value,
    /// Description of the nearest key above.
    about: Option<&'s str>,
    /// The description that names the unit of the numbers here: the same, except for values of a table, which take that
    /// of the key of the table.
    measured: Option<&'s str>,
    /// The node with the bounds of the numbers here: the key itself, in addition to a reference to its other forms.
    bounds: &'s Value,
}

/// The keywords that bound a number, with their signs.
const BOUNDS: [(&str, &str); 4] =
    [("minimum", "≥"), ("exclusiveMinimum", ">"), ("maximum", "≤"), ("exclusiveMaximum", "<")];

/// The numbers that a key admits.
#[derive(Clone, Debug)]
pub(super) struct Limits {
    bounds: [Option<f64>; 4],
    /// Expected text of the key for a number.
    pub expected: String,
}

impl Limits {
    /// True if a number is within the limits.
    pub fn admit(&self, number: f64) -> bool {
        let [least, above, most, below] = self.bounds;
        number.is_finite()
            && least.is_none_or(|b| number >= b)
            && above.is_none_or(|b| number > b)
            && most.is_none_or(|b| number <= b)
            && below.is_none_or(|b| number < b)
    }
}

impl<'s> SchemaView<'s> {
    /// The schema as a whole.
    pub fn new(root: &'s Value) -> SchemaView<'s> {
        SchemaView { root, node: root, about: None, measured: None, bounds: root }
    }

    /// A part of this schema, with the description of the whole unless it has its own.
    fn at(&self, node: &'s Value) -> SchemaView<'s> {
        let description = node.get("description").and_then(Value::as_str);
        let about = description.or(self.about);
        let measured = if node.get(OF_THE_KEY).is_some() { self.measured } else { description.or(self.measured) };
        let (mut node, bounds) = (node, node);
        while let Some(target) = node.get("$ref").and_then(Value::as_str) {
            match self.root.pointer(target.trim_start_matches('#')) {
                Some(next) => node = next,
                None => break,
            }
        }
        SchemaView { root: self.root, node, about, measured, bounds }
    }

    /// A form of this value, with the same description.
    fn form(&self, node: &'s Value) -> SchemaView<'s> {
        SchemaView { about: self.about, measured: self.measured, ..self.at(node) }
    }

    fn list(&self, keyword: &str) -> impl Iterator<Item = &'s Value> + use<'s> {
        self.node.get(keyword).and_then(Value::as_array).into_iter().flatten()
    }

    fn properties(&self) -> Option<&'s Map<String, Value>> {
        self.node.get("properties").and_then(Value::as_object)
    }

    /// The keys of a table, in alphabetical order.
    pub fn keys(&self) -> Vec<&'s str> {
        self.properties().into_iter().flat_map(Map::keys).map(String::as_str).collect()
    }

    /// The keys that a table must have in a case without phases.
    pub fn required(&self) -> Vec<&'s str> {
        self.required_with_phases().into_iter().chain(self.marked(WITHOUT_PHASES)).collect()
    }

    /// The keys that a table must have in every case.
    pub fn required_with_phases(&self) -> Vec<&'s str> {
        let not_with_phases: Vec<&str> = self.marked(WITHOUT_PHASES).collect();
        let marked = self.marked(UNLESS_STEADY).filter(|key| !not_with_phases.contains(key));
        self.list("required").filter_map(Value::as_str).chain(marked).collect()
    }

    /// The keys that a table may lack if its analysis is steady.
    pub fn not_in_steady(&self) -> Vec<&'s str> {
        self.marked(UNLESS_STEADY).collect()
    }

    /// The keys with a mark.
    fn marked(&self, mark: &'static str) -> impl Iterator<Item = &'s str> + use<'s> {
        let is_marked = move |property: &Value| property.get(mark).and_then(Value::as_bool) == Some(true);
        let all = self.properties().into_iter().flatten();
        all.filter(move |(_, property)| is_marked(property)).map(|(key, _)| key.as_str())
    }

    /// The schema of a key of a table, or of any key of a table with free keys.
    pub fn property(&self, key: &str) -> Option<SchemaView<'s>> {
        let named = self.properties().and_then(|p| p.get(key));
        named.or_else(|| self.node.get("additionalProperties").filter(|p| p.is_object())).map(|p| self.at(p))
    }

    /// The schema of the entries of an array.
    pub fn items(&self) -> Option<SchemaView<'s>> {
        self.node.get("items").map(|items| self.at(items))
    }

    /// Fewest and most entries of an array.
    pub fn lengths(&self) -> (u64, u64) {
        let bound = |keyword: &str| self.node.get(keyword).and_then(Value::as_u64);
        (bound("minItems").unwrap_or(0), bound("maxItems").unwrap_or(u64::MAX))
    }

    /// The forms that a value may take, such as number or string.
    pub fn alternatives(&self) -> Vec<SchemaView<'s>> {
        let forms = self.list("anyOf").map(|v| self.form(v).bounded(self.bounds));
        // A coefficient among the forms of a tensor has several forms itself.
        forms.flat_map(|form| if form.node.get("anyOf").is_some() { form.alternatives() } else { vec![form] }).collect()
    }

    /// Takes over the bounds of the key above, if that has any.
    fn bounded(self, bounds: &'s Value) -> SchemaView<'s> {
        let has_its_own = BOUNDS.iter().any(|(keyword, _)| self.bounds.get(*keyword).is_some());
        if has_its_own { self } else { SchemaView { bounds, ..self } }
    }

    /// The words that a string may be.
    pub fn words(&self) -> Vec<&'s str> {
        let constants = self.list("oneOf").filter_map(|v| v.get("const").and_then(Value::as_str));
        self.list("enum").filter_map(Value::as_str).chain(constants).collect()
    }

    /// The tables selected by a tag: the key of the tag, and the tables by their tags.
    pub fn variants(&self) -> Option<(&'s str, Vec<(&'s str, SchemaView<'s>)>)> {
        let mut tag = None;
        let mut variants = Vec::new();
        for variant in self.list("oneOf") {
            let (key, name) =
                variant.get("properties").and_then(Value::as_object)?.iter().find_map(|(key, property)| {
                    property.get("const").and_then(Value::as_str).map(|name| (key.as_str(), name))
                })?;
            tag = Some(key);
            variants.push((name, self.form(variant)));
        }
        tag.map(|tag| (tag, variants))
    }

    /// The key whose presence replaces the tag of this table.
    pub fn implied_by(&self) -> Option<&'s str> {
        self.node.get(IMPLIED_BY).and_then(Value::as_str)
    }

    /// The type: `object`, `array`, `string`, `number`, `integer` or `boolean`.
    pub fn kind(&self) -> &'s str {
        match self.node.get("type").and_then(Value::as_str) {
            Some(kind) => kind,
            None if self.variants().is_some() => "object",
            None => "string",
        }
    }

    /// The key of this table that is meant by a text in place of the table.
    pub fn short_for(&self) -> Option<&'s str> {
        self.node.get(SHORT_FOR).and_then(Value::as_str)
    }

    /// The full description.
    pub fn description(&self) -> Option<&'s str> {
        self.about
    }

    /// The expected value in words: `a number ≥ 0`.
    pub fn expects(&self) -> String {
        self.phrase()
    }

    /// The table, or array of tables, among the forms allowed here.
    pub fn table(&self) -> SchemaView<'s> {
        let is_table =
            |form: &SchemaView| form.kind() == "object" || form.items().is_some_and(|items| items.kind() == "object");
        self.one_of_several().or_else(|| self.alternatives().into_iter().find(is_table)).unwrap_or(*self)
    }

    /// True if a number or a text is allowed here as well as a table, other than the name of one.
    pub fn has_scalars(&self) -> bool {
        let is_scalar = |form: &SchemaView| !matches!(form.kind(), "object" | "array");
        self.short_for().is_none() && self.alternatives().iter().any(is_scalar)
    }

    /// The description as part of a sentence.
    pub fn about(&self) -> Option<String> {
        self.about.map(first_paragraph).filter(|about| !about.is_empty())
    }

    /// The SI unit of the numbers here, with its text, or `None` for pure numbers.
    pub fn unit(&self) -> Option<(Unit, &'s str)> {
        of_description(self.measured?)
    }

    /// True if numbers here are per unit of thickness of a plane body.
    pub fn is_per_thickness(&self) -> bool {
        self.measured.is_some_and(|text| text.contains("per unit of thickness"))
    }

    /// True if numbers here are a difference of temperatures.
    pub fn is_difference(&self) -> bool {
        self.measured.is_some_and(|text| text.contains("difference"))
    }

    /// True if a number is within the bounds.
    pub fn admits(&self, number: f64) -> bool {
        self.limits().admit(number)
    }

    /// The limits for numbers here, also if other values than numbers are allowed.
    pub fn limits(&self) -> Limits {
        let bounds = BOUNDS.map(|(keyword, _)| self.bounds.get(keyword).and_then(Value::as_f64));
        let range = self.range();
        let number = if range.is_empty() { "a finite number".to_owned() } else { format!("a number{range}") };
        let about = self.about();
        Limits { bounds, expected: about.map_or_else(|| number.clone(), |about| format!("{number} ({about})")) }
    }

    /// The expected value with its description: `a number ≥ 0 (density ρ in kg/m³; 0: quasistatic)`.
    pub fn expected(&self) -> String {
        let phrase = self.phrase();
        match self.about() {
            Some(about) => format!("{phrase} ({about})"),
            None => phrase,
        }
    }

    /// The expected value in words: `a number ≥ 0`.
    fn phrase(&self) -> String {
        if let Some(title) = self.node.get("title").and_then(Value::as_str) {
            return title.replacen("a number", &format!("a number{}", self.range()), 1);
        }
        let words = self.words();
        if !words.is_empty() {
            return one_of(&words);
        }
        match self.kind() {
            "object" => match self.variants() {
                Some((tag, _)) => format!("a table with `{tag}`"),
                None => "a table".to_owned(),
            },
            "array" => {
                let each = self.items().map_or_else(String::new, |items| format!(", each {}", items.phrase()));
                match self.lengths() {
                    (least, most) if least == most => format!("an array of {least}{each}"),
                    _ => format!("an array{each}"),
                }
            }
            "string" => "a string".to_owned(),
            "boolean" => "true or false".to_owned(),
            kind => {
                let noun = if kind == "integer" { "an integer" } else { "a number" };
                format!("{noun}{}", self.range())
            }
        }
    }

    fn range(&self) -> String {
        let parts: Vec<String> = BOUNDS
            .iter()
            .filter_map(|(keyword, sign)| {
                let bound = self.bounds.get(*keyword).and_then(Value::as_f64)?;
                Some(format!(" {sign} {bound}"))
            })
            .collect();
        parts.join(" and")
    }

    /// A value allowed by the schema, as a placeholder for a faulty one.
    pub fn sample(&self) -> Value {
        if let Some(first) = self.alternatives().first() {
            return first.sample();
        }
        if let Some((tag, variants)) = self.variants() {
            let Some((name, table)) = variants.first() else { return Value::Null };
            let mut sample = table.sample();
            sample[tag] = Value::from(*name);
            return sample;
        }
        match self.kind() {
            "object" => {
                let entries =
                    self.required().into_iter().filter_map(|k| Some((k.to_owned(), self.property(k)?.sample())));
                Value::Object(entries.collect())
            }
            "array" => (0..self.lengths().0).filter_map(|_| self.items().map(|i| i.sample())).collect(),
            "string" => Value::from(self.words().first().copied().unwrap_or_default()),
            "boolean" => Value::from(false),
            "integer" => Value::from(1),
            _ => Value::from(if self.admits(1.0) { 1.0 } else { 0.0 }),
        }
    }

    /// The sections that have this key: `[material]`, `[contact.friction] with law = "coulomb"`.
    pub fn homes(&self, key: &str) -> Vec<String> {
        let mut homes = Vec::new();
        self.collect_homes(key, "", "the beginning of the file, above all tables", &mut homes);
        // Regions repeat [material].
        homes.retain(|home| !home.starts_with("[region.material"));
        homes
    }

    /// Collects the sections with a key in this schema, whose path is `section` and whose header is `header`.
    fn collect_homes(&self, key: &str, section: &str, header: &str, homes: &mut Vec<String>) {
        let Some((tag, variants)) = self.variants() else {
            return self.collect_homes_in_table(key, section, header, homes);
        };
        for (name, table) in &variants {
            let with = if variants.len() > 1 { format!("{header} with {tag} = \"{name}\"") } else { header.to_owned() };
            // A tag is in too many tables to be a hint.
            if key != tag {
                table.collect_homes_in_table(key, section, &with, homes);
            }
        }
    }

    /// The table that may also be given as an array.
    fn one_of_several(&self) -> Option<SchemaView<'s>> {
        let forms = self.alternatives();
        let several = forms.iter().any(|form| form.items().is_some_and(|items| items.kind() == "object"));
        forms.into_iter().find(|form| several && form.kind() == "object")
    }

    fn collect_homes_in_table(&self, key: &str, section: &str, header: &str, homes: &mut Vec<String>) {
        for (name, property) in self.properties().into_iter().flatten() {
            if name == key {
                homes.push(header.to_owned());
            }
            let dotted = if section.is_empty() { name.clone() } else { format!("{section}.{name}") };
            let property = self.at(property);
            let property = property.one_of_several().unwrap_or(property);
            match property.items() {
                Some(items) => items.collect_homes(key, &dotted, &format!("[[{dotted}]]"), homes),
                None => property.collect_homes(key, &dotted, &format!("[{dotted}]"), homes),
            }
        }
    }
}

/// Words in a list: `"right", "left" or "crossed"`.
pub(super) fn one_of(words: &[&str]) -> String {
    let quoted: Vec<String> = words.iter().map(|w| format!("\"{w}\"")).collect();
    match quoted.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => quoted.concat(),
    }
}

/// The first paragraph of a description as part of a sentence.
fn first_paragraph(description: &str) -> String {
    let paragraph = description.split("\n\n").next().unwrap_or_default().replace('\n', " ");
    let text = paragraph.trim_end_matches('.');
    let mut chars = text.chars();
    match (chars.next(), chars.next()) {
        (Some(first), Some(second)) if first.is_ascii_uppercase() && second.is_ascii_lowercase() && !is_name(text) => {
            format!("{}{}", first.to_ascii_lowercase(), text.get(1..).unwrap_or_default())
        }
        _ => text.to_owned(),
    }
}

/// True if a text starts with the name of a person.
fn is_name(text: &str) -> bool {
    ["Young", "Poisson"].iter().any(|name| text.starts_with(name))
}
