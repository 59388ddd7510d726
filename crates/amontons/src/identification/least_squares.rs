//! Least squares within bounds: Gauss–Newton, damped as by Levenberg and Marquardt where it does not descend.

use super::singular::{SingularValues, product};

/// A linear model r − J δ of residuals about a place, in relative changes of the parameters.
#[derive(Clone, Debug)]
pub(super) struct LinearModel {
    /// The residuals, over their standard deviations.
    pub residuals: Vec<f64>,
    /// The columns of J: derivatives of the model over the same deviations.
    pub columns: Vec<Vec<f64>>,
}

/// A change of the parameters.
#[derive(Clone, Debug)]
pub(super) struct Change {
    /// δ.
    pub delta: Vec<f64>,
    /// By how much |r − J δ|² is smaller than |r|².
    pub gain: f64,
}

impl Change {
    /// True if no parameter changes by more than a part of it.
    pub fn is_below(&self, part: f64) -> bool {
        self.delta.iter().all(|delta| delta.abs() <= part)
    }
}

/// Part of the largest singular value below which one is the rounding of zero, as derivatives are as exact.
pub(super) const ROUNDED: f64 = 1e-8;

impl LinearModel {
    /// |r|².
    pub fn sum(&self) -> f64 {
        product(&self.residuals, &self.residuals)
    }

    /// The largest singular value of J, squared.
    pub fn largest(&self) -> f64 {
        SingularValues::new(self.columns.clone()).values.first().map_or(0.0, |value| value * value)
    }

    /// The smallest |r − J δ|² + λ|δ|² with δ between `room`, of all such δ the shortest one.
    ///
    /// Changes that would leave their room are held at its end, and let go where that makes the sum smaller, until
    /// neither happens. In exact arithmetic no set of held changes comes twice (Lawson and Hanson 1974, chapter 23).
    pub fn change(&self, lambda: f64, room: &[[f64; 2]]) -> Change {
        let p = self.columns.len();
        let mut held: Vec<Option<f64>> = room.iter().map(|[low, high]| (low >= high).then_some(*low)).collect();
        let mut delta = vec![0.0; p];
        for _ in 0..=3 * p {
            delta = self.free_change(lambda, &held);
            let beyond = |j: usize| (room[j][0] - delta[j]).max(delta[j] - room[j][1]);
            let worst = (0..p).filter(|&j| held[j].is_none()).max_by(|&a, &b| beyond(a).total_cmp(&beyond(b)));
            if let Some(j) = worst.filter(|&j| beyond(j) > 0.0) {
                held[j] = Some(delta[j].clamp(room[j][0], room[j][1]));
                continue;
            }
            let rest = self.rest(&delta);
            let inward = |j: usize| {
                let slope = product(&self.columns[j], &rest) - lambda * delta[j];
                let is_low = delta[j] <= room[j][0];
                if is_low { slope } else { 0.0 - slope }
            };
            let rounded = ROUNDED * self.sum().sqrt();
            let is_pulled = |&j: &usize| {
                let scale = product(&self.columns[j], &self.columns[j]).sqrt();
                held[j].is_some() && room[j][0] < room[j][1] && inward(j) > rounded * scale
            };
            match (0..p).filter(is_pulled).max_by(|&a, &b| inward(a).total_cmp(&inward(b))) {
                Some(j) => held[j] = None,
                None => break,
            }
        }
        for (delta, [low, high]) in delta.iter_mut().zip(room) {
            *delta = delta.max(*low).min(*high);
        }
        let rest = self.rest(&delta);
        Change { gain: self.sum() - product(&rest, &rest), delta }
    }

    /// r − J δ.
    fn rest(&self, delta: &[f64]) -> Vec<f64> {
        let mut rest = self.residuals.clone();
        for (column, delta) in self.columns.iter().zip(delta) {
            rest.iter_mut().zip(column).for_each(|(rest, slope)| *rest -= slope * delta);
        }
        rest
    }

    /// The change without room for those that are held.
    fn free_change(&self, lambda: f64, held: &[Option<f64>]) -> Vec<f64> {
        let mut delta: Vec<f64> = held.iter().map(|held| held.unwrap_or(0.0)).collect();
        let rest = self.rest(&delta);
        let free: Vec<usize> = (0..delta.len()).filter(|&j| held[j].is_none()).collect();
        let singular = SingularValues::new(free.iter().map(|&j| self.columns[j].clone()).collect());
        let rounded = ROUNDED * singular.values.first().copied().unwrap_or(0.0);
        for ((scaled, right), s) in singular.scaled.iter().zip(&singular.right).zip(&singular.values) {
            if *s <= rounded {
                continue;
            }
            let along = product(scaled, &rest) / (s * s + lambda);
            free.iter().zip(right).for_each(|(&j, right)| delta[j] += along * right);
        }
        delta
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn model(rows: &[[f64; 2]], residuals: &[f64]) -> LinearModel {
        let column = |j: usize| rows.iter().map(|row| row[j]).collect();
        LinearModel { residuals: residuals.to_vec(), columns: vec![column(0), column(1)] }
    }

    /// Without bounds the normal equations hold; with them the conditions of Karush, Kuhn and Tucker, on random models.
    #[test]
    fn bounded_changes_are_optimal() {
        let mut seed = 7u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 53) as f64 * 2.0 - 1.0
        };
        for _ in 0..300 {
            let rows: Vec<[f64; 2]> = (0..5).map(|_| [random(), random()]).collect();
            let residuals: Vec<f64> = (0..5).map(|_| 3.0 * random()).collect();
            let model = model(&rows, &residuals);
            let (low, high) = ([random().min(0.0), random().min(0.0)], [random().max(0.0), random().max(0.0)]);
            let lambda = if random() > 0.0 { 0.0 } else { 0.3 };
            let Change { delta, gain } = model.change(lambda, &[[low[0], high[0]], [low[1], high[1]]]);
            let rest = model.rest(&delta);
            for j in 0..2 {
                let slope = product(&model.columns[j], &rest) - lambda * delta[j];
                let [at_low, at_high] = [delta[j] <= low[j], delta[j] >= high[j]];
                assert!((at_low || slope > -1e-7) && (at_high || slope < 1e-7), "{slope} {delta:?} {low:?} {high:?}");
                assert!((low[j]..=high[j]).contains(&delta[j]));
            }
            assert!(gain >= 0.0, "{gain}");
        }
    }

    /// Of two parameters that only their sum matters of, each takes half of the change.
    #[test]
    fn what_data_do_not_determine_stays() {
        let model = model(&[[1.0, 1.0], [2.0, 2.0]], &[1.0, 2.0]);
        let Change { delta, .. } = model.change(0.0, &[[-9.0, 9.0]; 2]);
        assert!(delta.iter().all(|delta| (delta - 0.5).abs() < 1e-14), "{delta:?}");
    }
}
