//! Piecewise linear functions given by points.

/// A piecewise linear function of one number.
#[derive(Clone, Debug, PartialEq)]
pub struct PiecewiseLinear {
    points: Vec<(f64, f64)>,
}

/// Reason why points define no function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TableFault {
    /// The lists do not have the same length.
    Lengths {
        /// Number of arguments.
        arguments: usize,
        /// Number of values.
        values: usize,
    },
    /// There are too few points.
    Few {
        /// Number of points.
        found: usize,
    },
    /// The arguments do not increase.
    Order {
        /// An argument.
        before: f64,
        /// The one after it.
        next: f64,
    },
}

impl TableFault {
    /// The value found, for messages.
    #[must_use]
    pub fn found(&self) -> String {
        match self {
            TableFault::Lengths { arguments, values } => format!("{arguments} arguments and {values} values"),
            TableFault::Few { found } => format!("{found} points"),
            TableFault::Order { before, next } => format!("{next:?} after {before:?}"),
        }
    }

    /// The value expected, for messages.
    #[must_use]
    pub fn expected(&self) -> &'static str {
        match self {
            TableFault::Lengths { .. } => "as many",
            TableFault::Few { .. } => "two at the least",
            TableFault::Order { .. } => "larger and larger arguments",
        }
    }
}

impl std::fmt::Display for TableFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}, expected {}", self.found(), self.expected())
    }
}

impl std::error::Error for TableFault {}

impl PiecewiseLinear {
    /// The function through the points (arguments, values).
    ///
    /// # Errors
    /// Fails if there are less than two points, or the arguments do not grow.
    pub fn new(arguments: &[f64], values: &[f64]) -> Result<PiecewiseLinear, TableFault> {
        if arguments.len() != values.len() {
            return Err(TableFault::Lengths { arguments: arguments.len(), values: values.len() });
        }
        if arguments.len() < 2 {
            return Err(TableFault::Few { found: arguments.len() });
        }
        // A NaN is not larger, either.
        if let Some(pair) = arguments
            .windows(2)
            .find(|pair| !matches!(pair[1].partial_cmp(&pair[0]), Some(std::cmp::Ordering::Greater)))
        {
            return Err(TableFault::Order { before: pair[0], next: pair[1] });
        }
        Ok(PiecewiseLinear { points: arguments.iter().copied().zip(values.iter().copied()).collect() })
    }

    /// The points.
    #[must_use]
    pub fn points(&self) -> &[(f64, f64)] {
        &self.points
    }

    /// Value and slope, with the first and the last piece extended beyond the points.
    #[must_use]
    pub fn extended(&self, at: f64) -> (f64, f64) {
        let above = self.points.partition_point(|&(x, _)| x <= at).clamp(1, self.points.len() - 1);
        let ((x0, y0), (x1, y1)) = (self.points[above - 1], self.points[above]);
        let slope = (y1 - y0) / (x1 - x0);
        (y0 + slope * (at - x0), slope)
    }

    /// Value and slope, constant beyond the first and the last point.
    #[must_use]
    pub fn held(&self, at: f64) -> (f64, f64) {
        let (first, last) = (self.points[0], self.points[self.points.len() - 1]);
        if at < first.0 {
            (first.1, 0.0)
        } else if at >= last.0 {
            (last.1, 0.0)
        } else {
            self.extended(at)
        }
    }

    /// Largest value.
    #[must_use]
    pub fn largest(&self) -> f64 {
        self.points.iter().fold(f64::NEG_INFINITY, |m, p| m.max(p.1))
    }

    /// Slopes of the pieces.
    pub fn slopes(&self) -> impl Iterator<Item = f64> + '_ {
        self.points.windows(2).map(|pair| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_slopes_and_faults() -> Result<(), TableFault> {
        let f = PiecewiseLinear::new(&[0.0, 1.0, 3.0], &[1.0, 2.0, -2.0])?;
        assert_eq!(
            [f.held(-1.0), f.held(0.25), f.held(2.0), f.held(3.0)],
            [(1.0, 0.0), (1.25, 1.0), (0.0, -2.0), (-2.0, 0.0)]
        );
        assert_eq!([f.extended(-1.0), f.extended(4.0)], [(0.0, 1.0), (-4.0, -2.0)]);
        assert_eq!((f.largest(), f.slopes().collect::<Vec<_>>()), (2.0, vec![1.0, -2.0]));
        assert_eq!(PiecewiseLinear::new(&[0.0], &[0.0]), Err(TableFault::Few { found: 1 }));
        assert_eq!(PiecewiseLinear::new(&[0.0, 1.0], &[0.0]), Err(TableFault::Lengths { arguments: 2, values: 1 }));
        assert_eq!(PiecewiseLinear::new(&[1.0, 1.0], &[0.0, 1.0]), Err(TableFault::Order { before: 1.0, next: 1.0 }));
        Ok(())
    }
}
