//! Contact pairs and ties of a deck.

use std::collections::HashMap;

use super::deck::{Card, DeckFault};
use super::mesh::DeckMesh;
use super::notes::{Matter, Notes};
use super::units::{UnitFactors, number, numbers, quoted};

/// Clearance at which the exponential pressure of CalculiX is one per cent of that at contact.
const HUNDRED: f64 = 100.0;

/// The laws of a `*SURFACE INTERACTION`.
#[derive(Clone, Debug, Default)]
struct Interaction {
    normal: Option<PressureOverclosure>,
    friction: Option<DeckFriction>,
    heat: Option<Conductance>,
    /// Fraction of the friction power that enters the slave side.
    share: Option<f64>,
    from: Vec<String>,
}

/// Friction of two sides.
#[derive(Clone, Copy, Debug)]
enum DeckFriction {
    /// A coefficient, and a shear strength if it has one.
    Coulomb(f64, Option<f64>),
    Rough,
}

/// A law of pressure over overclosure.
#[derive(Clone, Debug)]
enum PressureOverclosure {
    Hard,
    Linear(f64),
    /// Clearance at which the pressure begins, and pressure at contact.
    Exponential(f64, f64),
    /// Overclosures and pressures.
    Table(Vec<(f64, f64)>),
    Tied,
}

/// Conductance over pressure or clearance.
#[derive(Clone, Debug)]
struct Conductance {
    /// Pressures or clearances, and conductances.
    rows: Vec<(f64, f64)>,
    over_pressure: bool,
}

/// A pair or a tie.
#[derive(Clone, Debug)]
struct DeckPair {
    from: String,
    slave: String,
    master: String,
    /// Name of the interaction, or `None` for a tie.
    interaction: Option<String>,
    close: bool,
    gap: Option<f64>,
    small: bool,
}

/// All contacts of a deck.
#[derive(Debug, Default)]
pub struct Contacts {
    interactions: HashMap<String, Interaction>,
    present: Option<String>,
    pairs: Vec<DeckPair>,
}

/// Data needed to write contacts.
#[derive(Clone, Copy, Debug)]
pub struct ContactContext {
    pub units: UnitFactors,
    pub heat: bool,
    /// True if the bodies do not move: contacts then transfer heat only.
    pub rests: bool,
    /// True if a step has large displacements.
    pub large: bool,
    /// Conductance of a tie.
    pub tie: f64,
}

impl DeckFriction {
    /// True if there is any friction.
    fn acts(&self) -> bool {
        matches!(self, DeckFriction::Coulomb(coefficient, _) if *coefficient > 0.0)
    }
}

impl Contacts {
    /// Reads a keyword of contact. Returns false for other keywords.
    pub fn take(&mut self, card: &Card, mesh: &DeckMesh, notes: &mut Notes) -> Result<bool, DeckFault> {
        match card.name.as_str() {
            "SURFACE INTERACTION" => {
                let name = card.required("NAME")?.to_uppercase();
                self.interactions.insert(name.clone(), Interaction::default());
                self.present = Some(name);
            }
            "SURFACE BEHAVIOR" | "FRICTION" | "GAP CONDUCTANCE" | "GAP HEAT GENERATION" => self.law(card, notes)?,
            "CONTACT PAIR" => self.pair(card, mesh)?,
            "TIE" => {
                let line = card.first("a slave and a master surface")?;
                self.push(card, line, None, mesh)?;
            }
            "CLEARANCE" => self.clearance(card, notes)?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn law(&mut self, card: &Card, notes: &mut Notes) -> Result<(), DeckFault> {
        let present = self.present.as_ref().and_then(|name| self.interactions.get_mut(name));
        let interaction = present.ok_or_else(|| {
            DeckFault::new(
                &card.place,
                format!("*{} outside of an interaction", card.name),
                "*SURFACE INTERACTION before it",
            )
        })?;
        interaction.from.push(format!("*{} {}", card.name, card.place));
        match card.name.as_str() {
            "SURFACE BEHAVIOR" => {
                interaction.normal = Some(behaviour(card)?);
                if matches!(interaction.normal, Some(PressureOverclosure::Exponential(..))) {
                    let why =
                        "the exponential function of CalculiX is taken; that of Abaqus differs but at zero clearance";
                    notes.add(&card.place, "EXPONENTIAL of *SURFACE BEHAVIOR", why, Matter::Perhaps);
                }
            }
            "FRICTION" if card.has("ROUGH") => {
                let why = "sides of a case that stick do not slip where they are open, either";
                notes.add(&card.place, "ROUGH of *FRICTION", why, Matter::Perhaps);
                interaction.friction = Some(DeckFriction::Rough);
            }
            "FRICTION" => {
                if card.data.len() > 1 {
                    let why = "the first line of the table is taken; see the friction laws `slip-rate`, `pressure`";
                    notes.add(&card.place, "*FRICTION", why, Matter::Answer);
                }
                let coefficient = card.first("a coefficient of friction")?.value(0, "a coefficient of friction")?;
                let cap = match card.parameter("TAUMAX") {
                    Some(text) => Some(text.parse().map_err(|_| {
                        DeckFault::new(&card.place, format!("TAUMAX={}", text.escape_debug()), "a shear strength")
                    })?),
                    None => None,
                };
                interaction.friction = Some(DeckFriction::Coulomb(coefficient, cap));
            }
            "GAP CONDUCTANCE" => interaction.heat = Some(conductance(card)?),
            _ => {
                let line = card.first("a fraction that becomes heat, and the part of the slave side")?;
                let whole = line.value(0, "a fraction that becomes heat")?;
                if (whole - 1.0).abs() > 1e-9 {
                    let why = "in a case all friction power becomes heat";
                    notes.add(&card.place, "*GAP HEAT GENERATION", why, Matter::Answer);
                }
                interaction.share = Some(line.number(1)?.unwrap_or(0.5));
            }
        }
        Ok(())
    }

    fn pair(&mut self, card: &Card, mesh: &DeckMesh) -> Result<(), DeckFault> {
        let name = card.required("INTERACTION")?.to_uppercase();
        if !self.interactions.contains_key(&name) {
            let found = format!("INTERACTION={}", name.escape_debug());
            return Err(DeckFault::new(&card.place, found, "a *SURFACE INTERACTION that the deck defines before"));
        }
        card.first("a slave and a master surface")?;
        for line in &card.data {
            self.push(card, line, Some(name.clone()), mesh)?;
        }
        Ok(())
    }

    fn push(
        &mut self,
        card: &Card,
        line: &super::deck::DataLine,
        interaction: Option<String>,
        mesh: &DeckMesh,
    ) -> Result<(), DeckFault> {
        let expected = "a slave and a master surface";
        let slave = mesh.surface(&line.place, line.need(0, expected)?)?;
        let master = mesh.surface(&line.place, line.need(1, expected)?)?;
        self.pairs.push(DeckPair {
            from: format!("*{} {}", card.name, card.place),
            slave,
            master,
            interaction,
            close: card.has("ADJUST") && card.word("ADJUST").as_deref() != Some("NO"),
            gap: None,
            small: card.has("SMALLSLIDING"),
        });
        Ok(())
    }

    fn clearance(&mut self, card: &Card, notes: &mut Notes) -> Result<(), DeckFault> {
        let value = card.required("VALUE")?;
        let value: f64 = value
            .parse()
            .map_err(|_| DeckFault::new(&card.place, format!("VALUE={}", value.escape_debug()), "a clearance"))?;
        let slave = card.word("SLAVE");
        let own = |pair: &&mut DeckPair| slave.as_ref().is_none_or(|slave| pair.slave.to_uppercase() == *slave);
        match self.pairs.iter_mut().find(own) {
            Some(pair) => pair.gap = Some(value),
            None => notes.add(&card.place, "*CLEARANCE", "it names no contact pair before it", Matter::Answer),
        }
        Ok(())
    }

    /// The contacts of the case.
    pub fn text(&self, scene: &ContactContext) -> String {
        self.pairs.iter().map(|pair| self.one(pair, scene)).collect()
    }

    fn one(&self, pair: &DeckPair, scene: &ContactContext) -> String {
        let UnitFactors { length, .. } = scene.units;
        let mut text = format!(
            "\n[[contact]]                          # {}\non = {}\nwith = {}\n",
            pair.from,
            quoted(&pair.slave),
            quoted(&pair.master)
        );
        let tie = Interaction { normal: Some(PressureOverclosure::Tied), ..Interaction::default() };
        let own = pair.interaction.as_ref().and_then(|name| self.interactions.get(name));
        let Interaction { normal, friction, heat, share, from } = own.unwrap_or(&tie);
        if !from.is_empty() {
            text += &format!("# {}\n", from.join(", "));
        }
        let tied = matches!(normal, Some(PressureOverclosure::Tied));
        let gap = pair.gap.map(|gap| gap * length);
        text += &if scene.rests {
            String::new()
        } else if tied {
            "normal = { law = \"bilateral\" }\nfriction = { law = \"stick\" }\n".to_owned()
        } else {
            format!("normal = {}\n{}", pressure(normal.as_ref(), scene.units), rubbing(friction.as_ref(), scene.units))
        };
        if let Some(gap) = gap {
            text += &format!("gap = {}\n", number(gap));
        } else if pair.close && !tied && !scene.rests {
            text += "close = true                         # ADJUST: overlaps at rest are none\n";
        }
        if !tied && !scene.rests && scene.large && !pair.small {
            text += "geometry = \"updated\"                 # NLGEOM: the sides slide past each other\n";
        }
        if scene.heat {
            let shown = heat.as_ref().map(|heat| conducting(heat, scene));
            let shown = shown.or_else(|| {
                pair.interaction
                    .is_none()
                    .then(|| format!("{{ law = \"constant\", conductance = {} }}", number(scene.tie)))
            });
            text += &shown.map_or_else(String::new, |law| format!("heat = {law}\n"));
            text += &share
                .filter(|_| !tied && !scene.rests)
                .map_or_else(String::new, |f| format!("frictional_heat = {}\n", number(f)));
        }
        text
    }
}

/// `*SURFACE BEHAVIOR`.
fn behaviour(card: &Card) -> Result<PressureOverclosure, DeckFault> {
    let kind = card.word("PRESSURE-OVERCLOSURE").unwrap_or_else(|| "HARD".to_owned());
    match kind.as_str() {
        "HARD" => Ok(PressureOverclosure::Hard),
        "TIED" => Ok(PressureOverclosure::Tied),
        "LINEAR" => {
            let line = card.first("a slope")?;
            let slope = line.value(0, "a slope")?;
            if slope > 0.0 {
                return Ok(PressureOverclosure::Linear(slope));
            }
            Err(DeckFault::new(&line.place, format!("a slope of {}", number(slope)), "a positive slope"))
        }
        "EXPONENTIAL" => {
            let line = card.first("a clearance and a pressure")?;
            let (clearance, pressure) = (line.value(0, "a clearance")?, line.value(1, "a clearance and a pressure")?);
            if clearance > 0.0 && pressure > 0.0 {
                return Ok(PressureOverclosure::Exponential(clearance, pressure));
            }
            Err(DeckFault::new(
                &line.place,
                format!("\"{}\"", line.whole()),
                "a positive clearance and a positive pressure",
            ))
        }
        "TABULAR" => {
            let mut rows: Vec<(f64, f64)> = Vec::new();
            for line in &card.data {
                let row = (line.value(1, "a pressure and an overclosure")?, line.value(0, "a pressure")?);
                if rows.last().is_some_and(|last| last.0 >= row.0 || last.1 > row.1) {
                    let expected = "overclosures that increase, with pressures that do not fall";
                    return Err(DeckFault::new(&line.place, format!("\"{}\"", line.whole()), expected));
                }
                rows.push(row);
            }
            if rows.len() < 2 {
                return Err(DeckFault::new(
                    &card.place,
                    "a table of less than two lines",
                    "pressures and overclosures",
                ));
            }
            if let Some(first) = rows.first().filter(|first| first.1 != 0.0) {
                let found = format!("a table that begins with the pressure {}", number(first.1));
                return Err(DeckFault::new(&card.place, found, "one that begins with the pressure 0"));
            }
            // The sides are apart up to the last row without pressure.
            let first = rows.iter().take_while(|row| row.1 <= 0.0).count().saturating_sub(1);
            Ok(PressureOverclosure::Table(rows.split_off(first)))
        }
        other => {
            let found = format!("PRESSURE-OVERCLOSURE={}", other.escape_debug());
            Err(DeckFault::new(&card.place, found, "HARD, LINEAR, EXPONENTIAL, TABULAR or TIED"))
        }
    }
}

/// The line of friction in the case; empty without friction.
fn rubbing(friction: Option<&DeckFriction>, units: UnitFactors) -> String {
    match friction {
        Some(DeckFriction::Rough) => "friction = { law = \"stick\" }\n".to_owned(),
        Some(friction @ DeckFriction::Coulomb(coefficient, cap)) if friction.acts() => {
            let cap = cap.map_or_else(String::new, |cap| format!(", cap = {}", number(cap * units.stress())));
            format!("friction = {{ law = \"coulomb\", coefficient = {}{cap} }}\n", number(*coefficient))
        }
        _ => String::new(),
    }
}

/// The law of the contact pressure in the case.
fn pressure(normal: Option<&PressureOverclosure>, units: UnitFactors) -> String {
    match normal {
        None | Some(PressureOverclosure::Hard | PressureOverclosure::Tied) => "{ law = \"signorini\" }".to_owned(),
        Some(PressureOverclosure::Linear(slope)) => {
            format!("{{ law = \"compliance\", stiffness = {} }}", number(slope * units.slope()))
        }
        Some(PressureOverclosure::Exponential(clearance, pressure)) => {
            let (c, p) = (clearance * units.length, pressure * units.stress());
            // One per cent of the pressure at contact, at which CalculiX starts the contact, is subtracted.
            let formula = format!("{}*(exp({}*r) - {})", number(p), number(HUNDRED.ln() / c), number(HUNDRED.recip()));
            format!("{{ law = \"expression\", pressure = \"{formula}\", begin = {} }}", number(-c))
        }
        Some(PressureOverclosure::Table(rows)) => {
            // A law of the case starts with zero pressure, in the gap or at closure.
            let closed = rows.first().filter(|row| row.0 > 0.0).map(|_| (0.0, 0.0));
            let rows: Vec<(f64, f64)> = closed.into_iter().chain(rows.iter().copied()).collect();
            let penetration = numbers(rows.iter().map(|row| row.0 * units.length));
            let pressure = numbers(rows.iter().map(|row| row.1 * units.stress()));
            format!("{{ law = \"table\", penetration = {penetration}, pressure = {pressure} }}")
        }
    }
}

/// `*GAP CONDUCTANCE`: over the pressure, or over the clearance as in Abaqus without PRESSURE.
fn conductance(card: &Card) -> Result<Conductance, DeckFault> {
    card.first("a conductance")?;
    let mut rows: Vec<(f64, f64)> = Vec::new();
    for line in &card.data {
        let row = (line.number(1)?.unwrap_or(0.0), line.value(0, "a conductance")?);
        if rows.last().is_some_and(|last| last.0 >= row.0) {
            let expected = "pressures or clearances that increase from line to line";
            return Err(DeckFault::new(&line.place, format!("\"{}\"", line.whole()), expected));
        }
        rows.push(row);
    }
    let falls = rows.first().zip(rows.last()).is_some_and(|(first, last)| last.1 < first.1);
    Ok(Conductance { rows, over_pressure: card.has("PRESSURE") || !falls })
}

/// The law of heat exchange in the case for a conductance.
fn conducting(heat: &Conductance, scene: &ContactContext) -> String {
    let units = scene.units;
    let factor = units.flux();
    let first = heat.rows.first().map_or(0.0, |row| row.1 * factor);
    // Between bodies at rest there is no pressure.
    if heat.rows.len() < 2 || (scene.rests && heat.over_pressure) {
        return format!("{{ law = \"constant\", conductance = {} }}", number(first));
    }
    let (variable, scale) = if heat.over_pressure { ("p", units.stress()) } else { ("-r", units.length) };
    let mut formula = number(first);
    for pair in heat.rows.windows(2) {
        let [(a, from), (b, to)] = pair else { continue };
        let (a, b, rise) = (a * scale, b * scale, (to - from) * factor);
        formula += &format!(
            " + {}*(min(max({variable}, {}), {}) - {})",
            number(rise / (b - a)),
            number(a),
            number(b),
            number(a)
        );
    }
    format!("{{ law = \"expression\", conductance = \"{formula}\" }}")
}
