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
}

impl Critical {
    /// As text.
    pub fn text(&self) -> String {
        format!(
            "  growth begins at {} = {:.9e} (between {:.9e} and {:.9e}), at {:.7e} Hz, after {} runs\n",
            self.key, self.value, self.between[0], self.between[1], self.hertz, self.runs
        )
    }

    /// As JSON.
    pub fn json(&self) -> serde_json::Value {
        let Critical { key, value, between, hertz, runs } = self;
        serde_json::json!({ "key": key, "value": value, "between": between, "frequency": hertz, "runs": runs })
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
        let found = seeker.find(&seeker.case(&variant)?, &format!("{key} = {at:.6e}"))?;
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
    Ok(Critical { key: key.trim().to_owned(), value, between: [quiet.at, loud.at], hertz: loud.hertz, runs })
}

/// The root of a secant within the bracket: of growth if modes decay on the quiet side, otherwise of its square.
fn next(quiet: TriedValue, loud: TriedValue, before: Option<TriedValue>) -> Option<f64> {
    let within = |at: f64| (at - quiet.at) * (at - loud.at) < 0.0;
    let root = |[a, b]: [[f64; 2]; 2]| a[0] - a[1] * (b[0] - a[0]) / (b[1] - a[1]);
    let decays = quiet.growth.is_finite() && quiet.growth < -NEUTRAL * loud.growth.abs();
    let at = if decays {
        root([[quiet.at, quiet.growth], [loud.at, loud.growth]])
    } else {
        let before = before?;
        root([[loud.at, loud.growth.powi(2)], [before.at, before.growth.powi(2)]])
    };
    Some(at).filter(|at| at.is_finite() && within(*at))
}
