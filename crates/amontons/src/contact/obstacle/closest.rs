//! The point of a triangle or a segment that is nearest to a point.

use super::{minus, plus};
use crate::tensor::{Point, dot};

/// The position of a point on a facet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum On {
    /// Between its edges.
    Inside,
    /// On the edge from the corner of this number to the next.
    Edge(usize),
    /// At the corner of this number.
    Corner(usize),
}

/// The nearest point of a facet with these corners, and its position on the facet.
pub(super) fn closest(x: &Point, corners: &[Point]) -> (Point, On) {
    match corners {
        [a, b] => of_segment(x, a, b),
        [a, b, c] => of_triangle(x, a, b, c),
        _ => ([f64::NAN; 3], On::Inside),
    }
}

fn of_segment(x: &Point, a: &Point, b: &Point) -> (Point, On) {
    let (along, from) = (minus(b, a), minus(x, a));
    let share = dot(&along, &from) / dot(&along, &along);
    if share <= 0.0 {
        (*a, On::Corner(0))
    } else if share >= 1.0 {
        (*b, On::Corner(1))
    } else {
        (plus(a, share, &along), On::Inside)
    }
}

/// Selects the region of the plane of the triangle that contains the foot of the perpendicular (Ericson, Real-Time
/// Collision Detection, 2005, 5.1.5).
fn of_triangle(x: &Point, a: &Point, b: &Point, c: &Point) -> (Point, On) {
    let (ab, ac) = (minus(b, a), minus(c, a));
    let [from_a, from_b, from_c] = [a, b, c].map(|corner| minus(x, corner));
    let (d1, d2) = (dot(&ab, &from_a), dot(&ac, &from_a));
    if d1 <= 0.0 && d2 <= 0.0 {
        return (*a, On::Corner(0));
    }
    let (d3, d4) = (dot(&ab, &from_b), dot(&ac, &from_b));
    if d3 >= 0.0 && d4 <= d3 {
        return (*b, On::Corner(1));
    }
    let (d5, d6) = (dot(&ab, &from_c), dot(&ac, &from_c));
    if d6 >= 0.0 && d5 <= d6 {
        return (*c, On::Corner(2));
    }
    let on_ab = d1 * d4 - d3 * d2;
    if on_ab <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return (plus(a, d1 / (d1 - d3), &ab), On::Edge(0));
    }
    let on_ca = d5 * d2 - d1 * d6;
    if on_ca <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return (plus(a, d2 / (d2 - d6), &ac), On::Edge(2));
    }
    let on_bc = d3 * d6 - d5 * d4;
    if on_bc <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let share = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return (plus(b, share, &minus(c, b)), On::Edge(1));
    }
    let sum = on_ab + on_bc + on_ca;
    (plus(&plus(a, on_ca / sum, &ab), on_ab / sum, &ac), On::Inside)
}
