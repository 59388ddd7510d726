//! `obstacle-size`: warns about an obstacle from a file in another unit than the body.

use super::super::{Finding, FindingId};
use super::warning;
use crate::problem::Problem;
use crate::tensor::{Point, length};
use crate::units::Measure;

/// Largest ratios of obstacle to body size and of body to obstacle size: files in millimetres are read a thousand times
/// too large; tools may be a few times larger than the body, tips a hundred times smaller.
const LARGER: f64 = 100.0;
const SMALLER: f64 = 1000.0;

/// Obstacles of finite size.
pub(super) fn of_obstacles(problem: &Problem) -> Vec<Finding> {
    (0..problem.contacts.len()).filter_map(|contact| of_obstacle(problem, contact)).collect()
}

fn of_obstacle(problem: &Problem, number: usize) -> Option<Finding> {
    let [low, high] = problem.contacts.get(number)?.obstacle.as_ref()?.shape.bounds(0.0)?;
    let extent = |low: &Point, high: &Point| length(&std::array::from_fn(|c| high[c] - low[c]));
    let points = &problem.mesh.points;
    let reach = |start: f64, fold: fn(f64, f64) -> f64| -> Point {
        std::array::from_fn(|c| points.iter().map(|x| x[c]).fold(start, fold))
    };
    let own = extent(&low, &high);
    let body = extent(&reach(f64::INFINITY, f64::min), &reach(f64::NEG_INFINITY, f64::max));
    let ratio = own / body;
    let (times, how, limit) = if ratio > LARGER {
        (ratio, "larger", LARGER)
    } else if ratio < 1.0 / SMALLER {
        (1.0 / ratio, "smaller", SMALLER)
    } else {
        return None;
    };
    let write = |value: f64| problem.units().write(value, Measure::Length);
    let message = format!(
        "the obstacle from a file is {} across, {times:.0} times {how} than the body, which is {} across",
        write(own),
        write(body)
    );
    let repair =
        "give the factor of its coordinates: `scale = 0.001` if the file is in mm; leave it if the size is meant";
    let place = format!("{}.obstacle", problem.contact_path(number));
    Some(warning(FindingId::ObstacleSize, &place, [times, limit], message, repair))
}
