//! The zero level set of a function.

use super::descent::LevelFunction;
use super::{Nearest, ObstacleShape, ShapeFault, ShapeFaults};
use crate::expression::{Expression, Variable};
use crate::tensor::Point;

/// The matter where φ(x, t) < 0, bounded by the surface φ = 0.
///
/// φ is no distance: the nearest point is searched, see `descent`. If distances to several parts of the surface differ
/// by a few hundredths, the search may return the farther one, which does not occur close to the surface. The surface
/// may have edges; there the normal is the direction in which the distance grows. It has no place: describe motion
/// along it by the velocity of the foundation.
#[derive(Clone, Debug)]
pub struct LevelSet {
    level: Expression,
    /// The axes on which φ depends.
    axes: Vec<usize>,
}

impl LevelSet {
    /// The surface on which `level` is zero; `level` is positive outside the obstacle.
    ///
    /// # Errors
    /// Fails if the level does not depend on space.
    pub fn new(level: Expression) -> Result<LevelSet, ShapeFaults> {
        let axes: Vec<usize> = [Variable::X, Variable::Y, Variable::Z]
            .into_iter()
            .enumerate()
            .filter(|(_, axis)| level.uses(*axis))
            .map(|(axis, _)| axis)
            .collect();
        if axes.is_empty() { Err(ShapeFaults(vec![ShapeFault::Level])) } else { Ok(LevelSet { level, axes }) }
    }
}

impl ObstacleShape for LevelSet {
    fn nearest(&self, x: &Point, t: f64) -> Nearest {
        LevelFunction { of: &self.level, axes: &self.axes, t }.nearest(x).unwrap_or(Nearest::NONE)
    }
    fn depends_on_time(&self) -> bool {
        self.level.depends_on_time()
    }
}
