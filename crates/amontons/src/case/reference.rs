//! Every word of the program with what it means: keys of the case file, quantities of probes, columns of the tables and
//! findings. The chapter "Reference" of the guide and `amontons explain` are made of it.

use serde_json::Value;

use super::schema::{View, schema};
use crate::hypotheses::FindingId;
use crate::output::columns::all_measures;
use crate::output::quantities;
use crate::units::{Measure, Units};

/// What a word is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Word {
    /// A key of the case file.
    Key,
    /// A quantity of a probe.
    Quantity,
    /// A column of `history.csv` or `contact.csv`.
    Column,
    /// The id of a finding.
    Finding,
}

/// A word with what it means.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// What it is.
    pub word: Word,
    /// Where it stands: of a key the table, `[contact.friction] with law = "coulomb"`.
    pub place: String,
    /// Its name.
    pub name: String,
    /// What it means; of a key in the sentences of the schema.
    pub meaning: String,
    /// What is expected of a key, such as `a number ≥ 0`; the unit of others.
    pub expected: String,
    /// Whether a key is required in its table.
    pub is_required: bool,
}

/// Where keys of tables of values stand.
const VALUES: &str = "a table in the place of a value";

/// What the columns of the tables are, by the names without components.
const COLUMNS: [(&str, &str); 58] = [
    ("step", "number of the step"),
    ("t", "time"),
    ("kinetic", "kinetic energy at t"),
    ("elastic", "elastic energy at t, of relaxing springs, too"),
    ("viscous_dissipation", "dissipated by viscosity since the start"),
    ("friction_dissipation", "dissipated by friction since the start"),
    ("contact_energy", "energy of compliant contact at t"),
    ("load_work", "work of loads and prescribed displacements since the start"),
    ("thermal_work", "work of thermal stress since the start"),
    ("scheme_dissipation", "what the time-stepping scheme itself took since the start"),
    ("closing_error", "error of the energy balance"),
    ("heat_content", "heat of the body at t, above that at the start"),
    ("heat_contact", "heat that has come through contact since the start"),
    ("contact_force", "resultant of σν on Γ_C, of all contacts or of one"),
    (
        "contact_moment",
        "moment of σν: in space about the origin, of bodies of revolution about the axis where a foundation turns about it",
    ),
    ("penetration_max", "largest penetration of a contact point"),
    ("open", "contact points without traction"),
    ("stick", "contact points that stick"),
    ("slip", "contact points that slip"),
    ("newton_mechanics", "Newton iterations of the mechanical step"),
    ("newton_heat", "Newton iterations of the heat step"),
    ("heat_prescribed", "heat from prescribed temperatures since the start"),
    ("heat_supplied", "heat of sources, inflows and convection since the start"),
    ("heat_coupling", "heat of strain (𝓡) since the start"),
    ("heat_closing_error", "error of the heat balance"),
    ("passes", "passes over both half-steps"),
    ("contraction", "mean contraction factor of the fixed-point coupling; 0 without one"),
    ("contact_area", "area in contact"),
    ("wear_max", "largest depth worn off"),
    ("wear_volume", "volume worn off"),
    ("wear_dissipation", "energy of what has worn off"),
    ("heat_friction", "heat of friction in the body since the start"),
    ("heat_foundation", "heat of foundations with a heat capacity at t"),
    ("heat_surroundings", "heat that foundations have given to their surroundings"),
    ("parts", "parts that the step was made in: 1, or more of a halved one"),
    ("contact_center", "where the pressure acts, Σ ω p x/Σ ω p"),
    ("foundation_temperature", "θ_F of a foundation with a heat capacity"),
    ("modulus_work", "work of moduli and contact stiffnesses that change with time or temperature"),
    ("heat_pairs", "heat that has crossed pairs since the start"),
    ("heat_flow", "∫ q·ν over a side"),
    ("pressure_max", "largest pressure of a contact point"),
    ("node", "number of the node; of Gauss points the number of the point"),
    ("x", "position at rest"),
    ("y", "position at rest"),
    ("z", "position at rest"),
    ("penetration", "r: how far the body is beyond the gap; negative where it is open"),
    ("pressure", "p_ν, the contact pressure"),
    ("traction", "σ_τ, what friction does to the body"),
    ("slip_velocity", "w_τ − v_F, of the body against what it faces"),
    ("status", "open, stick or slip"),
    ("temperature", "θ of the side"),
    ("heat_flux", "q·ν, heat that leaves the body"),
    ("weight", "area ω of a contact point"),
    ("wear", "depth worn off; of a pair off both bodies where they face each other now"),
    ("friction_work", "work of friction on the area since the start"),
    ("side", "name of the side that bears the points"),
    ("bound", "friction bound s"),
    ("opposite_temperature", "θ_F of the foundation, or θ of the other body of a pair"),
];

/// What a column is; those of a vector end with an axis.
fn of_column(name: &str) -> &'static str {
    let of = |name: &str| COLUMNS.iter().find(|(known, _)| *known == name).map(|(_, meaning)| *meaning);
    let axes = ["_x", "_y", "_z"];
    let vector = || axes.iter().find_map(|axis| of(name.strip_suffix(axis)?));
    of(name).or_else(vector).unwrap_or_default()
}

/// All words: keys in the order of their tables, then quantities, columns and findings.
#[must_use]
pub fn reference() -> Vec<Entry> {
    let schema = schema();
    let mut all = Vec::new();
    keys(&View::new(&schema), "", "above all tables", &mut all);
    // Tables of values come last; a region repeats [material].
    all.sort_by_key(|entry| entry.place == VALUES);
    all.retain(|entry| !entry.place.starts_with("[region.material"));
    let unit =
        |measure: Option<Measure>| measure.map_or_else(String::new, |measure| Units::SPACE.of(measure).to_owned());
    let other = |word: Word, place: &str, name: String, meaning: String, expected: String| Entry {
        word,
        place: place.to_owned(),
        name,
        meaning,
        expected,
        is_required: false,
    };
    all.extend(quantities().into_iter().map(|(name, meaning, measure)| {
        other(Word::Quantity, "quantity of a [[probe]]", name, meaning, unit(Some(measure)))
    }));
    let columns = all_measures().into_iter();
    let mut columns: Vec<Entry> = columns
        .map(|(name, measure)| {
            let meaning = of_column(&name).to_owned();
            other(Word::Column, "column of history.csv or contact.csv", name, meaning, unit(measure))
        })
        .collect();
    let mut known = std::collections::BTreeSet::new();
    columns.retain(|entry| known.insert((entry.name.clone(), entry.expected.clone())));
    all.extend(columns);
    all.extend(
        FindingId::ALL
            .iter()
            .map(|id| other(Word::Finding, "finding", id.as_str().to_owned(), id.meaning().to_owned(), String::new())),
    );
    all
}

/// The entries of a word: a name, a path such as `contact.friction.coefficient`, or the end of one.
#[must_use]
pub fn explain(word: &str) -> Vec<Entry> {
    let place = |entry: &Entry| {
        let header = entry.place.split(']').next().unwrap_or_default();
        header.trim_start_matches('[').to_owned()
    };
    let is_meant = |entry: &Entry| {
        let path = format!(".{}.{}", place(entry), entry.name);
        entry.name == word || (entry.word == Word::Key && path.ends_with(&format!(".{word}")))
    };
    reference().into_iter().filter(is_meant).collect()
}

/// Collects the keys of a table that is called `header`, with those of the tables in it.
fn keys(table: &View, section: &str, header: &str, all: &mut Vec<Entry>) {
    let Some((tag, variants)) = table.variants() else {
        return keys_of(table, section, header, all);
    };
    for (name, variant) in &variants {
        keys_of(variant, section, &format!("{header} with {tag} = \"{name}\""), all);
    }
}

fn keys_of(table: &View, section: &str, header: &str, all: &mut Vec<Entry>) {
    let required = table.required();
    let properties: Vec<(&str, View)> =
        table.keys().into_iter().filter_map(|name| Some((name, table.property(name)?))).collect();
    all.extend(properties.iter().map(|(name, property)| Entry {
        word: Word::Key,
        place: header.to_owned(),
        name: (*name).to_owned(),
        meaning: property.description().unwrap_or_default().replace('\n', " "),
        expected: property.expects(),
        is_required: required.contains(name),
    }));
    for (name, property) in properties {
        let dotted = if section.is_empty() { name.to_owned() } else { format!("{section}.{name}") };
        let inner = property.table();
        if property.has_scalars() {
            // A table of values, wherever a number may stand; of which kind there are few.
            let mut values = Vec::new();
            keys(&inner, "", VALUES, &mut values);
            values.retain(|entry| !all.contains(entry));
            all.extend(values);
            continue;
        }
        match inner.items() {
            Some(items) => keys(&items.table(), &dotted, &format!("[[{dotted}]]"), all),
            None => keys(&inner, &dotted, &format!("[{dotted}]"), all),
        }
    }
}

/// The words of a kind as a chapter of the guide, Markdown.
#[must_use]
pub fn markdown() -> String {
    let all = reference();
    let mut text = String::from(
        "# Reference\n\nEvery key of the case file, quantity of a probe, column and finding. `amontons explain WORD` prints the entry of one; \
         `amontons schema` prints the keys as a JSON Schema. Keys marked with * are required in their table.\n",
    );
    let cell = |text: &str| text.replace('|', "\\|").replace('<', "&lt;");
    let mut place = "";
    for entry in &all {
        if entry.place != place {
            place = &entry.place;
            let title = match entry.word {
                Word::Key if place.starts_with('[') => format!("`{place}`"),
                Word::Key if place == VALUES => "A table in the place of a value".to_owned(),
                Word::Key => "Above all tables".to_owned(),
                Word::Quantity => "Quantities of probes".to_owned(),
                Word::Column => "Columns of `history.csv` and `contact.csv`".to_owned(),
                Word::Finding => "Findings".to_owned(),
            };
            let head = if entry.word == Word::Key { "key | expected" } else { "name | unit" };
            text += &format!("\n## {title}\n\n| {head} | meaning |\n|---|---|---|\n");
        }
        let star = if entry.is_required { " *" } else { "" };
        text += &format!("| `{}`{star} | {} | {} |\n", entry.name, cell(&entry.expected), cell(&entry.meaning));
    }
    text
}

/// The words that are nearest to one that there is not.
#[must_use]
pub fn similar(word: &str) -> Option<String> {
    let all = reference();
    let names: Vec<&str> = all.iter().map(|entry| entry.name.as_str()).collect();
    super::nearest::nearest(word.rsplit('.').next().unwrap_or(word), &names).map(str::to_owned)
}

/// The entries for programs.
#[must_use]
pub fn json(entries: &[Entry]) -> Value {
    let of = |entry: &Entry| {
        let Entry { word, place, name, meaning, expected, is_required } = entry;
        let word = match word {
            Word::Key => "key",
            Word::Quantity => "quantity",
            Word::Column => "column",
            Word::Finding => "finding",
        };
        serde_json::json!({ "word": word, "place": place, "name": name, "meaning": meaning, "expected": expected, "required": is_required })
    };
    entries.iter().map(of).collect()
}
