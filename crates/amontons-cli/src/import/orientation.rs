//! `*ORIENTATION`: axes of a material, as angles of the case.

use std::cmp::Ordering;

use super::deck::{Card, DeckFault};
use super::notes::{Matter, Notes};
use super::transform::axes;
use super::units::number;

/// Axes of a material.
#[derive(Clone, Debug)]
pub struct Orientation {
    pub name: String,
    axes: Axes,
}

#[derive(Clone, Copy, Debug)]
enum Axes {
    Rectangular([[f64; 3]; 3]),
    /// A point of an axis along z, in the units of the deck.
    AboutZ([f64; 3]),
}

impl Orientation {
    pub fn of(card: &Card, notes: &mut Notes) -> Result<Orientation, DeckFault> {
        let name = card.required("NAME")?.to_uppercase();
        let line = card.first("two points, six numbers")?;
        let numbers = line.numbers()?;
        let [a, b, c, d, e, f, ..] = numbers[..] else {
            return Err(DeckFault::new(
                &line.place,
                format!("\"{}\"", line.whole().escape_debug()),
                "two points, six numbers",
            ));
        };
        let (a, b) = ([a, b, c], [d, e, f]);
        let turned = card.data.get(1).map(|line| line.number(1)).transpose()?.flatten();
        if turned.is_some_and(|angle| angle != 0.0) {
            let why = "the additional rotation of its second line is not taken";
            notes.add(&card.place, "*ORIENTATION", why, Matter::Answer);
        }
        let system = card.word("SYSTEM").unwrap_or_else(|| "RECTANGULAR".to_owned());
        let axes = match system.as_str() {
            "RECTANGULAR" => axes(a, b).map(Axes::Rectangular),
            "CYLINDRICAL" if (a[0], a[1]).partial_cmp(&(b[0], b[1])).is_some_and(Ordering::is_eq) && b[2] > a[2] => {
                Some(Axes::AboutZ(a))
            }
            _ => None,
        };
        let axes = axes.ok_or_else(|| {
            let expected =
                "RECTANGULAR axes from two points off one line, or CYLINDRICAL ones about the direction of z";
            DeckFault::new(&line.place, format!("SYSTEM={} by \"{}\"", system.escape_debug(), line.whole()), expected)
        })?;
        Ok(Orientation { name, axes })
    }

    /// The text of the case: an angle, or Bunge's Euler angles.
    pub fn text(&self, dim: usize, length: f64) -> String {
        match &self.axes {
            Axes::AboutZ(point) => {
                let [x, y, _] = point.map(|c| number(c * length));
                let angle = format!("\"atan2(y - {y}, x - {x})\"");
                if dim == 3 { format!("[{angle}, 0.0, 0.0]") } else { angle }
            }
            Axes::Rectangular(g) if dim < 3 => number(g[0][1].atan2(g[0][0])),
            Axes::Rectangular(g) => {
                let tilt = g[2][2].clamp(-1.0, 1.0).acos();
                let flat = tilt.sin().abs() < 1e-9;
                let first = if flat { g[0][1].atan2(g[0][0]) } else { g[2][0].atan2(-g[2][1]) };
                let last = if flat { 0.0 } else { g[0][2].atan2(g[1][2]) };
                format!("[{}, {}, {}]", number(first), number(tilt), number(last))
            }
        }
    }
}
