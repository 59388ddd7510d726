//! Loads of the whole body: gravity, centrifugal force, force and heat per volume.

use super::conditions::Volume;
use super::deck::{DeckFault, DeckPlace};
use super::model::DeckModel;
use super::notes::{Matter, Notes};
use super::time::DeckAmplitude;
use super::units::{UnitFactors, number};

/// A term of a body force: its value over time, and its factor in space by component.
struct ForceTerm {
    history: DeckAmplitude,
    factors: [Option<(f64, Option<String>)>; 3],
}

/// The table `[load]` of the case, with the given temperature; empty without loads.
pub fn load(
    model: &DeckModel,
    units: UnitFactors,
    (dim, temperature): (usize, Option<String>),
    notes: &mut Notes,
) -> Result<String, DeckFault> {
    let mut terms = Vec::new();
    let (mut heat, mut from) = (None, Vec::new());
    for (volume, track, source) in &model.conditions.volume {
        let history = model.time.history(track, &model.amplitudes, (0.0, true));
        from.push(source.clone());
        let of = |axis: usize| (axis < dim).then_some(axis);
        let factors: [Option<(f64, Option<String>)>; 3] = match volume {
            Volume::Heat => {
                heat = Some(history.mapped(units.per_volume(units.flux()), 0.0));
                continue;
            }
            Volume::Force(axis) => {
                let size = units.per_volume(units.stress());
                std::array::from_fn(|d| (d == *axis).then_some((size, None)))
            }
            Volume::Gravity(along) => {
                let size = density(model, notes)? * units.density() * units.acceleration();
                std::array::from_fn(|d| of(d).filter(|&d| along[d] != 0.0).map(|d| (size * along[d], None)))
            }
            Volume::Centrifugal(point, along) => {
                let size = density(model, notes)? * units.density() / (units.time * units.time);
                let point = point.map(|x| x * units.length);
                std::array::from_fn(|d| of(d).map(|d| (size, Some(away(&point, along, (d, dim))))))
            }
        };
        terms.push(ForceTerm { history, factors });
    }
    let mut text = String::new();
    if !terms.is_empty() {
        let components = (0..dim).map(|d| component(&terms, d, units.time)).collect::<Result<Vec<_>, _>>()?;
        text += &format!("body_force = [{}]\n", components.join(", "));
    }
    if let Some(heat) = heat {
        text += &format!("heat_source = {}\n", heat.text(units.time, None));
    }
    text += &temperature.unwrap_or_default();
    let comment =
        if from.is_empty() { String::new() } else { format!("                               # {}", from.join(", ")) };
    let head = format!("\n[load]{comment}\n");
    Ok(if text.is_empty() { text } else { head + &text })
}

/// The density of all materials of the deck.
fn density(model: &DeckModel, notes: &mut Notes) -> Result<f64, DeckFault> {
    let used = model
        .materials
        .iter()
        .filter(|material| model.sections.iter().any(|section| section.material.eq_ignore_ascii_case(&material.name)));
    let mut densities = Vec::new();
    for material in used {
        let found = format!("the material {} without *DENSITY", material.name.escape_debug());
        let missing = || DeckFault::new(&material.place, found, "*DENSITY below *MATERIAL, which *DLOAD needs");
        densities.push((material.density().ok_or_else(missing)?, &material.place));
    }
    let first = densities.first().map_or(0.0, |first| first.0);
    if let Some((_, place)) = densities.iter().find(|(other, _)| other.total_cmp(&first).is_ne()) {
        let why = "a case has one body force: that of the first material is taken for all";
        notes.add(place, "*DENSITY", why, Matter::Answer);
    }
    Ok(first)
}

/// A component of the vector from an axis to a point of the body, as an expression.
fn away(point: &[f64; 3], along: &[f64; 3], (d, dim): (usize, usize)) -> String {
    let from = |e: usize| match (e < dim, point[e]) {
        (true, 0.0) => ["x", "y", "z"][e].to_owned(),
        (true, at) => format!("({} - ({}))", ["x", "y", "z"][e], number(at)),
        (false, at) => format!("({})", number(-at)),
    };
    let mut text = from(d);
    for e in (0..3).filter(|&e| along[d] * along[e] != 0.0) {
        text += &format!(" - ({})*{}", number(along[d] * along[e]), from(e));
    }
    text
}

/// A component of the sum of all terms.
fn component(terms: &[ForceTerm], d: usize, time: f64) -> Result<String, DeckFault> {
    let own: Vec<(&DeckAmplitude, f64, Option<&String>)> = terms
        .iter()
        .filter_map(|term| term.factors[d].as_ref().map(|(size, space)| (&term.history, *size, space.as_ref())))
        .collect();
    let largest = |history: &DeckAmplitude| history.0.iter().map(|p| p.1).max_by(|a, b| a.abs().total_cmp(&b.abs()));
    let Some((first, ..)) = own.first() else { return Ok("0.0".to_owned()) };
    let peak = largest(first).filter(|peak| *peak != 0.0).unwrap_or(1.0);
    let shape = first.mapped(1.0 / peak, 0.0);
    let (mut constant, mut varies) = (0.0, String::new());
    for (history, size, space) in &own {
        let peak = largest(history).filter(|peak| *peak != 0.0).unwrap_or(1.0);
        let alike = history.0.len() == shape.0.len()
            && history
                .0
                .iter()
                .zip(&shape.0)
                .all(|(a, b)| a.0.total_cmp(&b.0).is_eq() && (a.1 / peak - b.1).abs() < 1e-12);
        if !alike {
            let found = "loads of the whole body that vary in time in different ways";
            return Err(DeckFault::new(&DeckPlace::start(), found, "loads of the body with one amplitude"));
        }
        match space {
            None => constant += size * peak,
            Some(space) => varies += &format!(" + {}*({space})", number(size * peak)),
        }
    }
    if varies.is_empty() {
        return Ok(shape.mapped(constant, 0.0).text(time, None));
    }
    let all = if constant == 0.0 { varies[3..].to_owned() } else { format!("{}{varies}", number(constant)) };
    Ok(match shape.constant() {
        Some(_) => format!("\"{all}\""),
        None => shape.text(time, Some(&all)),
    })
}
