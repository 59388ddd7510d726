//! The images of a side in the neighbouring sectors of a cyclic body.

use crate::mesh::{Link, link_of};
use crate::tensor::{Point, dot};

/// Relative difference of two turns that counts as round-off of coordinates.
const SAME: f64 = 1e-6;

/// A power of the turn x ↦ R x + c that maps a sector to the next one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectorImage {
    /// The power: 0 is the sector itself, 1 the next one, −1 the previous one.
    pub power: i8,
    /// R to this power, as the images of the axes.
    turn: [Point; 3],
    /// The shift c of this power, m.
    shift: Point,
}

/// The axes, for no turn.
const AXES: [Point; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl SectorImage {
    /// The identity: the side itself.
    pub const SELF: SectorImage = SectorImage { power: 0, turn: AXES, shift: [0.0; 3] };

    /// The turn that maps the sector of a side with these nodes, at positions `x`, to the next one; `None` if the body
    /// is no sector.
    pub(super) fn next(links: &[Link], x: &[Point], nodes: &[u32]) -> Option<SectorImage> {
        let link = nodes.iter().find_map(|&node| link_of(links, node))?;
        let [node, to] = [link.node, link.to].map(|node| x[node as usize]);
        let image = link.turned(&to);
        Some(SectorImage { power: 1, turn: link.turn, shift: std::array::from_fn(|c| node[c] - image[c]) })
    }

    /// True if two turns are equal up to the round-off of coordinates of this size.
    pub(super) fn is_same(&self, other: &SectorImage, size: f64) -> bool {
        let is_near = |a: &Point, b: &Point, size: f64| (0..3).all(|c| (a[c] - b[c]).abs() <= SAME * size);
        self.turn.iter().zip(&other.turn).all(|(a, b)| is_near(a, b, 1.0)) && is_near(&self.shift, &other.shift, size)
    }

    pub(super) fn inverse(&self) -> SectorImage {
        let turn: [Point; 3] = std::array::from_fn(|c| std::array::from_fn(|d| self.turn[d][c]));
        let back = turned(&turn, &self.shift);
        SectorImage { power: -self.power, turn, shift: back.map(|c| -c) }
    }

    /// The turn applied `times` times, backwards if negative.
    pub(super) fn times(&self, times: i8) -> SectorImage {
        let once = if times < 0 { self.inverse() } else { *self };
        (0..times.unsigned_abs()).fold(SectorImage::SELF, |image, _| SectorImage {
            power: image.power + once.power,
            turn: image.turn.map(|axis| turned(&once.turn, &axis)),
            shift: once.position(&image.shift),
        })
    }

    /// The position of the image of a point of the sector.
    #[must_use]
    pub fn position(&self, x: &Point) -> Point {
        if self.power == 0 {
            return *x;
        }
        let image = self.vector(x);
        std::array::from_fn(|c| image[c] + self.shift[c])
    }

    /// The image of a vector of the sector.
    #[must_use]
    pub fn vector(&self, v: &Point) -> Point {
        turned(&self.turn, v)
    }

    /// R to this power, as the images of the axes.
    #[must_use]
    pub fn turn(&self) -> &[Point; 3] {
        &self.turn
    }

    /// The vector of the sector whose image is `v`.
    #[must_use]
    pub fn back(&self, v: &Point) -> Point {
        self.turn.map(|image| dot(&image, v))
    }
}

/// R v, with R given by the images of the axes.
fn turned(turn: &[Point; 3], v: &Point) -> Point {
    std::array::from_fn(|d| (0..3).map(|c| v[c] * turn[c][d]).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The turn of a link maps the leading node to its follower; the turn and its inverse cancel.
    #[test]
    fn a_sector_turned_forth_and_back_is_where_it_was() {
        let (s, c) = 0.7f64.sin_cos();
        let turn = [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]];
        let link = Link { node: 1, to: 0, turn };
        let about = |x: Point| {
            let from: Point = [x[0] - 0.3, x[1] + 0.2, x[2]];
            let image = link.turned(&from);
            [image[0] + 0.3, image[1] - 0.2, image[2]]
        };
        let x = [[1.0, 2.0, 0.5], about([1.0, 2.0, 0.5])];
        let next = SectorImage::next(&[link], &x, &[0, 1]).expect("a sector");
        let near = |a: Point, b: Point| (0..3).all(|c| (a[c] - b[c]).abs() < 1e-14);
        let point = [0.4, -1.3, 0.8];
        assert!(near(next.position(&x[0]), x[1]) && near(next.position(&point), about(point)));
        assert!(near(next.times(2).position(&point), about(about(point))));
        assert!(near(next.times(-2).position(&about(about(point))), point));
        assert!(near(next.inverse().vector(&next.vector(&point)), point));
    }
}
