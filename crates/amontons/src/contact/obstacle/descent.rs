//! The nearest point of the surface φ = 0: y + μ ∇φ(y) = x, φ(y) = 0.
//!
//! Iterates stay on the surface: a step in the tangent plane, then back along ∇φ. The step is Newton's for the system
//! above, with second derivatives from differences of the exact first ones, or the gradient's of ‖x − y‖²/2 if the
//! second variation is not positive; it is halved until y comes nearer. So the distance decreases at each step. When it
//! no longer does, the point is a local minimum: x − y is normal to the surface, or the point is at an edge. Then φ is
//! sampled on spheres around x within that distance: a sign other than at x reveals a nearer part of the surface, from
//! which the descent starts again.

use super::{Nearest, across, minus, perpendicular, plus};
use crate::expression::Expression;
use crate::tensor::{Point, dot, length};

/// A function of space at one time.
pub(super) struct LevelFunction<'a> {
    pub of: &'a Expression,
    /// The axes on which it depends; along the others the surface does not change.
    pub axes: &'a [usize],
    pub t: f64,
}

/// The value and gradient of the function at a point.
#[derive(Clone, Copy)]
struct LevelPoint {
    y: Point,
    /// φ.
    value: f64,
    /// ‖∇φ‖.
    steepness: f64,
    /// ∇φ/‖∇φ‖.
    normal: Point,
}

impl LevelPoint {
    /// Splits x − y into its component along the normal and the remainder.
    fn split(&self, x: &Point) -> (f64, Point) {
        let gap = minus(x, &self.y);
        (dot(&gap, &self.normal), across(&gap, &self.normal))
    }

    fn distance(&self, x: &Point) -> f64 {
        length(&minus(x, &self.y))
    }

    /// Lengths below this are lost in the rounding of coordinates.
    fn round_off(&self, x: &Point) -> f64 {
        8.0 * f64::EPSILON * largest(x).max(largest(&self.y))
    }
}

fn largest(v: &Point) -> f64 {
    v.iter().fold(0.0, |m, c| m.max(c.abs()))
}

impl LevelFunction<'_> {
    /// The nearest point of the surface to `x`; `None` if the search finds none.
    pub fn nearest(&self, x: &Point) -> Option<Nearest> {
        let value = self.value(x);
        if value.is_nan() {
            return None;
        }
        let outside = value >= 0.0;
        let start = self.onto_surface(x).or_else(|| self.search(x, outside))?;
        let mut foot = self.slide(x, start)?;
        // Each pass comes nearer; few parts of a surface are nearest in turn.
        for _ in 0..50 {
            let distance = foot.distance(x);
            let Some(next) = self
                .crossing(x, outside, &[0.25, 0.5, 0.75, 0.999].map(|part| part * distance))
                .and_then(|y| self.onto_surface(&y))
            else {
                break;
            };
            match self.slide(x, next) {
                Some(next) if next.distance(x) < distance => foot = next,
                _ => break,
            }
        }
        let (along, rest) = foot.split(x);
        let distance = foot.distance(x);
        if length(&rest) <= 1e-6 * distance + foot.round_off(x) {
            return Some(Nearest { distance: along, normal: foot.normal });
        }
        // The nearest point is at an edge.
        let signed = if outside { distance } else { -distance };
        Some(Nearest { distance: signed, normal: minus(x, &foot.y).map(|c| c / signed) })
    }

    fn value(&self, y: &Point) -> f64 {
        self.of.value(y, self.t)
    }

    /// The function at a point; `None` if its gradient has no direction.
    fn at(&self, y: Point) -> Option<LevelPoint> {
        let d = self.of.derivatives(&y, self.t);
        let steepness = length(&d.by_x);
        let normal = d.by_x.map(|c| c / steepness);
        (d.value.is_finite() && steepness.is_finite() && normal.iter().all(|c| c.is_finite())).then_some(LevelPoint {
            y,
            value: d.value,
            steepness,
            normal,
        })
    }

    /// Moves from a point along ∇φ to the surface by Newton's method, halving the step until |φ| decreases.
    fn onto_surface(&self, from: &Point) -> Option<LevelPoint> {
        let mut at = self.at(*from)?;
        for _ in 0..200 {
            let step = -at.value / at.steepness;
            let seen = f64::EPSILON * largest(&at.y);
            if step.abs() <= seen {
                return Some(at);
            }
            let mut parts = (0..40).map(|halvings| 0.5f64.powi(halvings)).take_while(|part| part * step.abs() > seen);
            let shorter = |part: f64| {
                self.at(plus(&at.y, part * step, &at.normal)).filter(|next| next.value.abs() < at.value.abs())
            };
            let Some(next) = parts.find_map(shorter) else { break };
            at = next;
        }
        // |φ| no longer decreases: the zero is within rounding, or there is none.
        let beyond =
            |part: f64| self.value(&plus(&at.y, -part * at.value / at.steepness, &at.normal)) * at.value <= 0.0;
        [1.0, 2.0, 4.0, 8.0].into_iter().any(beyond).then_some(at)
    }

    /// Moves along the surface to the point nearest to `x`.
    fn slide(&self, x: &Point, start: LevelPoint) -> Option<LevelPoint> {
        let mut at = start;
        for _ in 0..500 {
            let (along, rest) = at.split(x);
            if length(&rest) <= at.round_off(x) {
                return Some(at);
            }
            let newton = self.newton(x, &at, along, &rest).and_then(|step| self.nearer(x, &at, &rest, &step));
            match newton.or_else(|| self.nearer(x, &at, &rest, &rest)) {
                Some(next) => at = next,
                None => return Some(at),
            }
        }
        None
    }

    /// A point of the surface nearer to `x`, reached by a step or a fraction of it.
    fn nearer(&self, x: &Point, at: &LevelPoint, rest: &Point, step: &Point) -> Option<LevelPoint> {
        let (before, slope) = (at.distance(x).powi(2), dot(step, rest));
        // Possible rounding error of the squared distance.
        let noise = 1e-12 * before + 4.0 * before.sqrt() * at.round_off(x);
        let close = dot(rest, rest) <= noise;
        let reached = |part: f64| {
            let next = self.onto_surface(&plus(&at.y, part, step))?;
            let after = next.distance(x).powi(2);
            let falls = after < before - 1e-4 * part * slope;
            // Close to the end the distance cannot decide which point is nearer, but the angle can.
            let turns = close && after <= before + noise && length(&next.split(x).1) <= 0.5 * length(rest);
            (falls || turns).then_some(next)
        };
        (0..50).find_map(|halvings| reached(0.5f64.powi(halvings)))
    }

    /// The step s in the tangent plane with s + λ H s = r, r the part of x − y in that plane, λ the part across and H
    /// the tangential part of ∇²φ/‖∇φ‖; `None` if I + λH is not positive.
    fn newton(&self, x: &Point, at: &LevelPoint, along: f64, rest: &Point) -> Option<Point> {
        let h = 1e-5 * largest(x).max(largest(&at.y));
        // One tangent in the plane, two in space.
        let tangents = if self.axes.len() == 2 {
            vec![super::unit(rest)?]
        } else {
            let first = perpendicular(&at.normal);
            let ([a, b, c], [d, e, f]) = (at.normal, first);
            vec![first, [b * f - c * e, c * d - a * f, a * e - b * d]]
        };
        let gradient = |s: f64, e: &Point| self.of.derivatives(&plus(&at.y, s, e), self.t).by_x;
        let images: Vec<Point> = tangents
            .iter()
            .map(|e| plus(e, 0.5 * along / (h * at.steepness), &minus(&gradient(h, e), &gradient(-h, e))))
            .collect();
        let entry = |i: usize, j: usize| 0.5 * (dot(&tangents[i], &images[j]) + dot(&tangents[j], &images[i]));
        let a = entry(0, 0);
        if tangents.len() == 1 {
            return (a > 0.0).then(|| rest.map(|c| c / a));
        }
        let (b, d) = (entry(0, 1), entry(1, 1));
        let determinant = a * d - b * b;
        let [r, s] = [0, 1].map(|i| dot(&tangents[i], rest));
        let along_first = tangents[0].map(|c| c * (d * r - b * s) / determinant);
        (a > 0.0 && determinant > 0.0).then(|| plus(&along_first, (a * s - b * r) / determinant, &tangents[1]))
    }

    /// A point next to the surface on a ray from `x`, found where φ at one of the increasing radii has another sign
    /// than at `x`.
    fn crossing(&self, x: &Point, outside: bool, radii: &[f64]) -> Option<Point> {
        let rays = rays(self.axes);
        let across = |value: f64| if outside { value < 0.0 } else { value > 0.0 };
        let mut values = vec![0.0; rays.len()];
        for &radius in radii {
            let points: Vec<Point> = rays.iter().map(|ray| plus(x, radius, ray)).collect();
            self.of.values(&points, self.t, &mut values);
            let Some(ray) = rays.iter().zip(&values).find(|(_, value)| across(**value)).map(|(ray, _)| ray) else {
                continue;
            };
            let (mut near, mut far) = (0.0, radius);
            // Bisection until the bracket suits Newton's method.
            for _ in 0..30 {
                let middle = 0.5 * (near + far);
                if across(self.value(&plus(x, middle, ray))) {
                    far = middle;
                } else {
                    near = middle;
                }
            }
            return Some(plus(x, far, ray));
        }
        None
    }

    /// A point of the surface, searched over many radii if ∇φ does not lead to one.
    fn search(&self, x: &Point, outside: bool) -> Option<LevelPoint> {
        let size = largest(x);
        let radii = (-40..=40).map(|power| 2f64.powi(power) * if size > 0.0 { size } else { 1.0 });
        let mut crossings = radii.filter_map(|radius| self.crossing(x, outside, &[radius]));
        crossings.find_map(|y| self.onto_surface(&y))
    }
}

/// Unit vectors in the space of some axes, towards the points of a lattice with five points per direction: 16 in a
/// plane and 98 in space.
fn rays(axes: &[usize]) -> Vec<Point> {
    let mut points: Vec<[i8; 3]> = vec![[0; 3]];
    for &axis in axes {
        points = points
            .iter()
            .flat_map(|p| [-2, -1, 0, 1, 2].map(|c| [0, 1, 2].map(|d| if d == axis { c } else { p[d] })))
            .collect();
    }
    // A point with even coordinates is on the ray of another one.
    points.iter().filter(|p| p.iter().any(|c| c % 2 != 0)).filter_map(|p| super::unit(&p.map(f64::from))).collect()
}
