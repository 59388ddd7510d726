//! Reductions of values on Γ_C and of weighted values.

use super::Snapshot;
use super::probe_place::Take;
use super::quantity::ContactQuantity;
use crate::contact::Status;
use crate::tensor::Point;

/// The values with nonzero weight; points that face nothing have weight zero. All values if all weights are zero.
pub(super) fn faced<T>(all: impl Iterator<Item = (f64, T)>) -> Vec<(f64, T)> {
    let mut all: Vec<(f64, T)> = all.collect();
    if all.iter().any(|(weight, _)| *weight != 0.0) {
        all.retain(|(weight, _)| *weight != 0.0);
    }
    all
}

/// The value at a contact point, a scalar in the first component; NaN for results of a step at t = 0.
pub(super) fn on_contact(now: &Snapshot, quantity: ContactQuantity, i: usize) -> Point {
    let (surface, state) = (&now.state.surface, now.report.and_then(|report| report.contact.states.get(i)));
    let number = |value: Option<f64>| [value.unwrap_or(f64::NAN), 0.0, 0.0];
    let vector = |value: Option<Point>| value.unwrap_or([f64::NAN; 3]);
    match quantity {
        ContactQuantity::Wear => number(surface.wear.get(i).copied()),
        ContactQuantity::FrictionWork => number(surface.friction_work.get(i).copied()),
        ContactQuantity::Pressure => number(state.map(|state| state.pressure)),
        ContactQuantity::Penetration => number(state.map(|state| state.penetration)),
        ContactQuantity::Touching => number(state.map(|state| f64::from(u8::from(state.status != Status::Open)))),
        ContactQuantity::Traction => vector(state.map(|state| state.q.map(|q| 0.0 - q))),
        ContactQuantity::SlipVelocity => vector(state.map(|state| state.slip)),
    }
}

/// Mean, extreme or integral of weighted values; at a single point its value.
pub(super) fn reduce(take: Option<Take>, values: impl Iterator<Item = (f64, f64)>) -> f64 {
    let sums = |values: &mut dyn Iterator<Item = (f64, f64)>| {
        values.fold((0.0, 0.0), |(w, s), (weight, value)| (w + weight, s + weight * value))
    };
    let (mut values, extreme) = (values, |fold: fn(f64, f64) -> f64, values: &mut dyn Iterator<Item = (f64, f64)>| {
        values
            .map(|(_, value)| value)
            .reduce(|a, b| if a.is_nan() || b.is_nan() { f64::NAN } else { fold(a, b) })
            .unwrap_or(f64::NAN)
    });
    match take {
        None | Some(Take::Integral) => sums(&mut values).1,
        Some(Take::Mean) => {
            let (measure, sum) = sums(&mut values);
            if measure == 0.0 && sum == 0.0 { 0.0 } else { sum / measure }
        }
        Some(Take::Max) => extreme(f64::max, &mut values),
        Some(Take::Min) => extreme(f64::min, &mut values),
    }
}
