//! An enlargement of a contact that is much smaller than the body.

use std::collections::HashMap;

use super::axes;
use super::picture::Rect;
use super::run::DrawnRun;
use crate::contact::Status;

/// Largest extent of an enlarged contact, relative to the body.
const SMALL: f64 = 0.25;
/// Size of the window relative to the contact.
const ROOM: f64 = 1.6;
/// Least extent of a window, relative to the body: a contact may be a single point.
const LEAST: f64 = 0.025;

/// A contact that is much smaller than the body.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Zone {
    /// Index of its side in the run.
    pub side: usize,
    /// Drawn positions of the points in contact.
    pub points: Vec<[f64; 3]>,
}

/// The bits of a position; adding zero makes −0 equal to 0.
fn key(p: [f64; 3]) -> [u64; 3] {
    p.map(|x| (x + 0.0).to_bits())
}

fn extent(points: &[[f64; 3]]) -> f64 {
    (0..3).filter_map(|d| axes::range(points.iter().map(|p| p[d]))).map(|[lo, hi]| hi - lo).fold(0.0, f64::max)
}

/// The side with the highest pressure whose part in contact is smaller than a quarter of the body, over runs of one
/// body with nodes drawn at `moved`. `None` if no contact is so small, nothing is in contact, or the bodies differ.
pub(super) fn zone(runs: &[&DrawnRun], nodes: &[Vec<[f64; 3]>], moved: &[Vec<[f64; 3]>]) -> Option<Zone> {
    let mut of_sides: HashMap<usize, (f64, Vec<[f64; 3]>, Vec<[f64; 3]>)> = HashMap::new();
    if nodes.windows(2).any(|pair| pair[0] != pair[1]) {
        return None;
    }
    for ((run, nodes), moved) in runs.iter().zip(nodes).zip(moved) {
        let node: HashMap<[u64; 3], usize> = nodes.iter().enumerate().map(|(i, p)| (key(*p), i)).collect();
        let plane = run.contact.iter().map(|row| ([row.x[0], row.x[1], 0.0], row.point_pressure, row.status, row.side));
        let solid = run.solid.iter().flat_map(|solid| &solid.contact);
        let space = solid.map(|row| (row.x, row.point_pressure, row.status, row.side));
        for (x, pressure, _, side) in plane.chain(space).filter(|(.., status, _)| *status != Status::Open) {
            let of_side = of_sides.entry(side).or_default();
            of_side.0 = of_side.0.max(pressure);
            of_side.1.push(x);
            of_side.2.push(node.get(&key(x)).and_then(|&i| moved.get(i)).copied().unwrap_or(x));
        }
    }
    let size = nodes.first().map_or(0.0, |nodes| extent(nodes));
    let small = of_sides.into_iter().filter(|(_, (_, points, _))| extent(points) < SMALL * size);
    let most = small.max_by(|(i, a), (j, b)| a.0.total_cmp(&b.0).then(j.cmp(i)))?;
    let (side, (_, _, points)) = most;
    Some(Zone { side, points })
}

/// The window of an enlargement and its factor. It has the shape of the window of the body and encloses the points in
/// contact with a margin. `None` if the factor is below two.
pub(super) fn window(points: &[[f64; 2]], whole: [[f64; 2]; 2]) -> Option<([[f64; 2]; 2], f64)> {
    let ranges = [0, 1].map(|d| axes::range(points.iter().map(|p| p[d])));
    let [Some(x), Some(y)] = ranges else { return None };
    let length = |r: [f64; 2]| r[1] - r[0];
    let share = |own: [f64; 2], whole: [f64; 2]| length(own) / length(whole);
    let least = ROOM * share(x, whole[0]).max(share(y, whole[1]));
    // The factor is rounded down to two digits: the window becomes larger, never smaller.
    let times = (1.0 / least.max(LEAST)).min(1.0 / LEAST);
    let times = if times < 10.0 { (10.0 * times).floor() / 10.0 } else { times.floor() };
    let part = |own: [f64; 2], whole: [f64; 2]| {
        let half = 0.5 * length(whole) / times;
        let middle = 0.5 * (own[0] + own[1]);
        let middle = middle.clamp(whole[0] + half, (whole[1] - half).max(whole[0] + half));
        [middle - half, middle + half]
    };
    (times >= 2.0).then(|| ([part(x, whole[0]), part(y, whole[1])], times))
}

/// The pieces of a line that lie within a rectangle.
pub(super) fn clipped(points: &[[f64; 2]], rect: Rect) -> Vec<Vec<[f64; 2]>> {
    let mut pieces: Vec<Vec<[f64; 2]>> = Vec::new();
    for pair in points.windows(2) {
        let Some([a, b]) = segment([pair[0], pair[1]], rect) else { continue };
        match pieces.last_mut().filter(|piece| piece.last() == Some(&a)) {
            Some(piece) => piece.push(b),
            None => pieces.push(vec![a, b]),
        }
    }
    pieces
}

/// The part of a segment within a rectangle.
fn segment([a, b]: [[f64; 2]; 2], rect: Rect) -> Option<[[f64; 2]; 2]> {
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for (d, [low, high]) in [[rect.x, rect.right()], [rect.y, rect.bottom()]].into_iter().enumerate() {
        let along = b[d] - a[d];
        if along == 0.0 {
            if a[d] < low || a[d] > high {
                return None;
            }
            continue;
        }
        let ends = [(low - a[d]) / along, (high - a[d]) / along];
        from = from.max(ends[0].min(ends[1]));
        to = to.min(ends[0].max(ends[1]));
    }
    // The ends keep their bits, so that pieces join.
    let at = |s: f64| {
        if s <= 0.0 {
            a
        } else if s >= 1.0 {
            b
        } else {
            [0, 1].map(|d| a[d] + s * (b[d] - a[d]))
        }
    };
    (from < to).then(|| [at(from), at(to)])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp)] // the values are exact

    use super::*;

    #[test]
    fn a_window_encloses_the_contact_and_has_the_shape_of_the_whole() {
        let whole = [[0.0, 8.0], [0.0, 2.0]];
        let found = window(&[[7.0, 0.0], [7.4, 0.1]], whole);
        let (part, times) = found.unwrap_or_default();
        assert!((2.0..=8.0 / (1.6 * 0.4)).contains(&times), "× {times}");
        assert!(part[0][0] < 7.0 && part[0][1] > 7.4 && part[1][0] <= 0.0 && part[1][1] > 0.1, "{part:?}");
        let sizes = part.map(|r| r[1] - r[0]);
        assert!((sizes[0] / sizes[1] - 4.0).abs() < 1e-12, "{sizes:?}");
        // A point is enlarged forty times, half of the body not at all.
        assert_eq!(window(&[[1.0, 1.0]], whole).map(|found| found.1), Some(40.0));
        assert_eq!(window(&[[0.0, 0.0], [4.0, 0.0]], whole), None);
    }

    #[test]
    fn lines_end_at_the_border() {
        let rect = Rect { x: 0.0, y: 0.0, width: 2.0, height: 1.0 };
        let line = [[-1.0, 0.5], [1.0, 0.5], [1.0, 3.0], [1.5, 3.0], [1.5, 0.5]];
        let expected = vec![vec![[0.0, 0.5], [1.0, 0.5], [1.0, 1.0]], vec![[1.5, 1.0], [1.5, 0.5]]];
        assert_eq!(clipped(&line, rect), expected);
        assert!(clipped(&[[-1.0, -1.0], [3.0, -1.0]], rect).is_empty());
    }
}
