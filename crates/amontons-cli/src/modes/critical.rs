//! The value of a key at which a mode begins to grow.
//!
//! Between a value without growth and one with growth the largest growth is followed. Where modes decay on the one side
//! it changes its sign, and the root is that of the secant. Where modes without damping meet, growth is zero on the one
//! side and rises like a square root on the other, so that its square is followed. Either way the bracket is kept and
//! halved where the secant does not shorten it.

use crate::status::CommandFailure;
use crate::variants::Variant;

use super::{NEUTRAL, Seeker};

/// Part of the range to which the value is found.
const ACCURACY: f64 = 1e-9;
/// Part of the range beyond a value at which two modes meet where the ratio of their derivatives is taken.
const BESIDE: f64 = 1e-7;
/// Most runs.
const RUNS: usize = 60;

/// The value at which growth begins.
pub struct Critical {
    key: String,
    value: f64,
    /// The bracket that is left.
    between: [f64; 2],
    /// Frequency there of the mode that begins to grow, Hz.
    hertz: f64,
    runs: usize,
    slopes: Vec<CriticalSlope>,
}

/// Derivative of the critical value by another key.
struct CriticalSlope {
    key: String,
    /// Value of the other key.
    at: f64,
    /// The derivative; `None` if the mode has none, or if its growth does not depend on the key of the critical value.
    slope: Option<f64>,
    /// Relative change of the critical value per relative change of the other key.
    relative: Option<f64>,
}

impl Critical {
    /// As text.
    pub fn text(&self) -> String {
        let mut text = format!(
            "  growth begins at {} = {:.9e} (between {:.9e} and {:.9e}), at {:.7e} Hz, after {} runs\n",
            self.key, self.value, self.between[0], self.between[1], self.hertz, self.runs
        );
        for CriticalSlope { key, at, slope, relative } in &self.slopes {
            let told = |slope: &Option<f64>| slope.map_or_else(|| "none".to_owned(), |slope| format!("{slope:.7e}"));
            let (slope, relative) = (told(slope), told(relative));
            text += &format!("  its derivative by {key} at {at:?} is {slope}, relative to both values {relative}\n");
        }
        text
    }

    /// As JSON.
    pub fn json(&self) -> serde_json::Value {
        let Critical { key, value, between, hertz, runs, slopes } = self;
        let mut all =
            serde_json::json!({ "key": key, "value": value, "between": between, "frequency": hertz, "runs": runs });
        if !slopes.is_empty() {
            let of = |CriticalSlope { key, slope, relative, .. }: &CriticalSlope| {
                (key.clone(), serde_json::json!({ "derivative": slope, "relative": relative }))
            };
            all["by"] = slopes.iter().map(of).collect();
        }
        all
    }
}

/// A value with the largest growth relative to |λ| there.
#[derive(Clone, Copy)]
struct TriedValue {
    at: f64,
    growth: f64,
    grows: bool,
    hertz: f64,
}

/// Finds the value in a range `KEY=FROM,TO`.
pub fn find(seeker: &Seeker, range: &str) -> Result<Critical, CommandFailure> {
    let usage = |found: &str| CommandFailure::Usage(format!("--critical {range}: {found}"));
    let (key, values) = range.split_once('=').ok_or_else(|| usage("expected KEY=FROM,TO"))?;
    let ends: Option<Vec<f64>> = values.split(',').map(|value| value.trim().parse().ok()).collect();
    let Some([from, to]) = ends.as_deref().and_then(|ends| <[f64; 2]>::try_from(ends).ok()) else {
        return Err(usage("expected two numbers, KEY=FROM,TO"));
    };
    let mut runs = 0;
    let mut at = |at: f64| -> Result<TriedValue, CommandFailure> {
        runs += 1;
        let variant = Variant { folder: String::new(), values: vec![(key.trim().to_owned(), format!("{at:?}"))] };
        let found = seeker.find((&variant, &seeker.case(&variant)?), &format!("{key} = {at:.6e}"), &[])?;
        let fastest = found.modes.modes.iter().max_by(|a, b| a.growth.total_cmp(&b.growth));
        let (growth, size, hertz) = fastest.map_or((f64::NEG_INFINITY, 1.0, 0.0), |mode| {
            (mode.growth, mode.growth.hypot(mode.frequency), mode.hertz())
        });
        Ok(TriedValue { at, growth, grows: growth > NEUTRAL * size, hertz })
    };
    let [mut quiet, mut loud] = [at(from)?, at(to)?];
    if quiet.grows == loud.grows {
        let both = if quiet.grows { "modes grow" } else { "no mode grows" };
        return Err(usage(&format!("found that {both} at both ends, expected growth at one of them")));
    }
    if quiet.grows {
        std::mem::swap(&mut quiet, &mut loud);
    }
    let mut before = None;
    let width = (to - from).abs();
    for turn in 0..RUNS {
        if (loud.at - quiet.at).abs() <= ACCURACY * width {
            break;
        }
        let guess = next(quiet, loud, before).filter(|_| turn % 4 != 3);
        let middle = 0.5 * (quiet.at + loud.at);
        let tried = at(guess.unwrap_or(middle))?;
        if tried.grows {
            before = Some(loud);
            loud = tried;
        } else {
            quiet = tried;
        }
    }
    // Where growth rises like a root, its end is beyond the last value that grows by as much as the secant says.
    let value = next(quiet, loud, before).unwrap_or(loud.at);
    let key = key.trim();
    let slopes = if seeker.with.is_empty() {
        Vec::new()
    } else {
        // Where two modes meet the derivatives of both are infinite, but not their ratio.
        let off = if decays(quiet, loud) { 0.0 } else { BESIDE * width * (loud.at - quiet.at).signum() };
        slopes(seeker, (key, value), value + off)?
    };
    Ok(Critical { key: key.to_owned(), value, between: [quiet.at, loud.at], hertz: loud.hertz, runs, slopes })
}

/// The derivatives of a critical value V by other keys m from those of the growth of the mode that begins to grow:
/// dV/dm = −(∂ Re λ/∂m)/(∂ Re λ/∂V).
fn slopes(seeker: &Seeker, (key, value): (&str, f64), at: f64) -> Result<Vec<CriticalSlope>, CommandFailure> {
    let others = seeker.with.iter().filter(|other| *other != key).cloned();
    let keys: Vec<String> = std::iter::once(key.to_owned()).chain(others).collect();
    let variant = Variant { folder: String::new(), values: vec![(key.to_owned(), format!("{at:?}"))] };
    let found = seeker.find((&variant, &seeker.case(&variant)?), &format!("derivatives at {at:.6e}"), &keys)?.modes;
    let fastest = found.modes.iter().max_by(|a, b| a.growth.total_cmp(&b.growth));
    let growth = |k: usize| Some(fastest?.slope(k)?[0]);
    let of = |(k, (name, at)): (usize, &(String, f64))| {
        let slope = growth(k).zip(growth(0)).map(|(other, own)| -other / own).filter(|slope| slope.is_finite());
        let relative = slope.map(|slope| slope * at / value).filter(|slope| slope.is_finite());
        CriticalSlope { key: name.clone(), at: *at, slope, relative }
    };
    Ok(found.parameters.iter().enumerate().skip(1).map(of).collect())
}

/// True if modes decay on the quiet side: the growth changes its sign.
fn decays(quiet: TriedValue, loud: TriedValue) -> bool {
    quiet.growth.is_finite() && quiet.growth < -NEUTRAL * loud.growth.abs()
}

/// The root of a secant within the bracket: of growth if modes decay on the quiet side, otherwise of its square.
fn next(quiet: TriedValue, loud: TriedValue, before: Option<TriedValue>) -> Option<f64> {
    let within = |at: f64| (at - quiet.at) * (at - loud.at) < 0.0;
    let root = |[a, b]: [[f64; 2]; 2]| a[0] - a[1] * (b[0] - a[0]) / (b[1] - a[1]);
    let at = if decays(quiet, loud) {
        root([[quiet.at, quiet.growth], [loud.at, loud.growth]])
    } else {
        let before = before?;
        root([[loud.at, loud.growth.powi(2)], [before.at, before.growth.powi(2)]])
    };
    Some(at).filter(|at| at.is_finite() && within(*at))
}
