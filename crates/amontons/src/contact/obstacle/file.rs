//! A closed surface from a file.

use std::sync::Arc;

use super::{Checks, ClosedSurface, Nearest, ObstacleShape, Point3, ShapeFaults, at, keyed, minus, plus};
use crate::field::Field;
use crate::tensor::Point;

const ORIGIN: [&str; 3] = ["origin[0]", "origin[1]", "origin[2]"];

/// The solid within a surface of facets, or the matter around such a cavity; it moves with its origin.
#[derive(Clone, Debug)]
pub struct FacetedSolid {
    surface: Arc<ClosedSurface>,
    origin: Point3,
    inside: bool,
}

impl FacetedSolid {
    /// The solid within a surface whose origin is at `origin`; with `inside` the surface is a cavity around the body.
    ///
    /// # Errors
    /// Fails if the origin depends on space.
    pub fn new(surface: Arc<ClosedSurface>, origin: Point3, inside: bool) -> Result<FacetedSolid, ShapeFaults> {
        let mut checks = Checks::default();
        let file = FacetedSolid { surface, origin: checks.moving(ORIGIN, origin), inside };
        checks.result(file)
    }
}

impl ObstacleShape for FacetedSolid {
    fn nearest(&self, x: &Point, t: f64) -> Nearest {
        let Nearest { distance, normal } = self.surface.nearest(&minus(x, &self.place(t)));
        if self.inside {
            return Nearest { distance: -distance, normal: normal.map(|c| -c) };
        }
        Nearest { distance, normal }
    }
    fn place(&self, t: f64) -> Point {
        at(&self.origin, t)
    }
    fn fields(&self) -> Vec<(&'static str, &Field)> {
        keyed(ORIGIN, &self.origin)
    }
    fn bounds(&self, t: f64) -> Option<[Point; 2]> {
        let place = self.place(t);
        Some(self.surface.bounds().map(|corner| plus(&corner, 1.0, &place)))
    }
}
