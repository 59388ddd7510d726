//! Selection of the times of a run that are drawn.

use super::PlotError;
use super::run::HistoryColumns;
use crate::output::columns;

/// Number of frames of a strip without given times.
const FRAMES: usize = 4;
/// A quantity above this fraction of its maximum counts as still present at the end.
const STILL_THERE: f64 = 0.8;

/// At most `most` evenly spaced snapshots, including the first and the last.
pub(super) fn evenly(snapshots: usize, most: usize) -> Vec<usize> {
    if snapshots <= most {
        return (0..snapshots).collect();
    }
    let last = most.max(2) - 1;
    (0..=last).map(|i| (i * (snapshots - 1) + last / 2) / last).collect()
}

/// The snapshots nearest to some times, each once, in the order of time.
pub(super) fn at(times: &[f64], snapshots: &[f64]) -> Result<Vec<usize>, PlotError> {
    let (first, last) = (snapshots.first().copied().unwrap_or_default(), snapshots.last().copied().unwrap_or_default());
    let slack = 1e-9 * first.abs().max(last.abs());
    if let Some(t) = times.iter().find(|t| !(first - slack..=last + slack).contains(*t)) {
        let there = if snapshots.len() == 1 {
            format!("at t = {last} only")
        } else {
            format!("from t = {first} to t = {last}")
        };
        let hint = "`every` under [output] says after how many steps fields are written";
        return Err(PlotError::Data(format!("there is no picture at t = {t}: the run has fields {there}; {hint}")));
    }
    let mut chosen: Vec<usize> = times.iter().filter_map(|t| nearest(*t, snapshots)).collect();
    chosen.sort_unstable();
    chosen.dedup();
    Ok(chosen)
}

fn nearest(t: f64, snapshots: &[f64]) -> Option<usize> {
    (0..snapshots.len()).min_by(|&i, &j| (snapshots[i] - t).abs().total_cmp(&(snapshots[j] - t).abs()))
}

/// The last snapshot only, or a strip of frames with equal amounts of change between them.
///
/// Four quantities count: elastic energy, contact force, friction power and heat content. If each of them is still at
/// least four fifths of its maximum at the end, the last snapshot is enough. Otherwise the change of a run up to a time
/// is the sum of their variations, each divided by its variation over the whole run. The frames are the snapshots
/// nearest to the times at which a quarter, a half and three quarters of it have passed, and the end. A snapshot at t =
/// 0 is not among them.
pub(super) fn choose(history: &HistoryColumns, snapshots: &[f64]) -> Vec<usize> {
    let Some(end) = snapshots.len().checked_sub(1) else { return Vec::new() };
    let times = history.get(columns::TIME.name).map_or(&[][..], Vec::as_slice);
    let series = story(history, times);
    let largest = |values: &[f64]| values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let is_there = |values: &Vec<f64>| values.last().is_none_or(|v| v.abs() >= STILL_THERE * largest(values));
    if series.iter().all(is_there) {
        return vec![end];
    }
    let mut change = vec![0.0; times.len()];
    for values in &series {
        let steps: Vec<f64> =
            (0..values.len()).map(|i| (values[i] - if i > 0 { values[i - 1] } else { 0.0 }).abs()).collect();
        let total: f64 = steps.iter().sum();
        let mut sum = 0.0;
        for (change, step) in change.iter_mut().zip(&steps) {
            sum += step;
            *change += if total > 0.0 { sum / total } else { 0.0 };
        }
    }
    let whole = change.last().copied().unwrap_or_default();
    let reached = |share: f64| change.iter().position(|c| *c >= share * whole).and_then(|i| times.get(i)).copied();
    let start = usize::from(snapshots.len() > 1 && snapshots[0] <= 0.0);
    let wanted = (1..FRAMES).filter_map(|i| reached(i as f64 / FRAMES as f64));
    let mut chosen: Vec<usize> =
        wanted.filter_map(|t| nearest(t, &snapshots[start..])).map(|i| i + start).chain([end]).collect();
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

/// Elastic energy, contact force, friction power and heat content over time, without those that are zero throughout.
fn story(history: &HistoryColumns, times: &[f64]) -> Vec<Vec<f64>> {
    let column = |name: &str| history.get(name).filter(|values| values.len() == times.len());
    let force = (0..times.len()).map(|i| {
        let components = [0, 1, 2].map(|c| columns::CONTACT_FORCE.component(c));
        components.iter().filter_map(|name| column(name)).map(|values| values[i] * values[i]).sum::<f64>().sqrt()
    });
    let work = column(columns::FRICTION_DISSIPATION.name).cloned().unwrap_or_default();
    let rate = |i: usize| {
        let (t, w) = if i > 0 { (times[i - 1], work[i - 1]) } else { (0.0, 0.0) };
        if times[i] > t { (work[i] - w) / (times[i] - t) } else { 0.0 }
    };
    let power: Vec<f64> = (0..work.len()).map(rate).collect();
    let plain =
        [columns::ELASTIC, columns::HEAT_CONTENT].map(|column| column.name).into_iter().filter_map(column).cloned();
    let all = plain.chain([force.collect(), power]);
    all.filter(|values: &Vec<f64>| values.iter().any(|v| *v != 0.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn history(columns: &[(&str, fn(f64) -> f64)]) -> HistoryColumns {
        let times: Vec<f64> = (1..=100).map(|i| 0.01 * f64::from(i)).collect();
        let column = |f: &fn(f64) -> f64| times.iter().map(|t| f(*t)).collect();
        let mut all: HistoryColumns = columns.iter().map(|(name, f)| ((*name).to_owned(), column(f))).collect();
        all.insert("t".to_owned(), times);
        all
    }

    fn snapshots() -> Vec<f64> {
        (0..=20).map(|i| 0.05 * f64::from(i)).collect()
    }

    #[test]
    fn what_grows_to_the_end_is_drawn_there() {
        assert_eq!(choose(&history(&[("elastic", |t| t), ("heat_content", |t| t * t)]), &snapshots()), [20]);
        assert_eq!(choose(&history(&[]), &snapshots()), [20]);
    }

    /// A force that rises linearly until t = 0.4 and is zero from 0.8: quarters of its variation are at 0.2, 0.4 and
    /// 0.6.
    #[test]
    fn a_story_before_the_end_is_a_strip_of_equal_change() {
        let force = |t: f64| if t < 0.4 { t } else { (0.8 - t).max(0.0) };
        assert_eq!(choose(&history(&[("contact_force_y", force)]), &snapshots()), [4, 8, 12, 20]);
        // With two snapshots, one of them at the start, there is no strip.
        assert_eq!(choose(&history(&[("contact_force_y", force)]), &[0.0, 1.0]), [1]);
    }

    #[test]
    fn evenly_spaced_snapshots_have_both_ends() {
        assert_eq!(evenly(5, 5), [0, 1, 2, 3, 4]);
        assert_eq!(evenly(101, 5), [0, 25, 50, 75, 100]);
        assert_eq!(evenly(100, 2), [0, 99]);
    }

    /// Work done within the first tenth: its power is zero at the end, though the work is not.
    #[test]
    fn power_counts_and_not_work() {
        let chosen = choose(&history(&[("friction_dissipation", |t| 10.0 * t.min(0.1))]), &snapshots());
        assert!(chosen.len() > 1 && chosen[0] <= 2, "{chosen:?}");
    }

    #[test]
    fn times_that_are_asked_for_take_the_nearest_snapshot() -> Result<(), PlotError> {
        assert_eq!(at(&[0.52, 0.0, 0.501, 1.0], &snapshots())?, [0, 10, 20]);
        let error = at(&[0.2], &[1.0]).map_err(|e| e.to_string());
        assert!(
            error
                .as_ref()
                .is_err_and(|e| e.contains("t = 0.2") && e.contains("at t = 1 only") && e.contains("`every`")),
            "{error:?}"
        );
        assert!(at(&[f64::NAN], &snapshots()).is_err());
        Ok(())
    }
}
