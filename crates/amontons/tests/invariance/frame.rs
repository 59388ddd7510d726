//! Another way to describe the same body: turned, mirrored, shifted, renumbered, in other units, later in time.

use amontons::element::Element;
use amontons::mesh::{Block, FacetSet, Mesh};
use amontons::quadrature::Shape;
use amontons::tensor::Point;

/// A repeatable random number from 0 to 1 (splitmix64).
pub struct Random(pub u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub fn number(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    fn shuffle<T>(&mut self, all: &mut [T]) {
        (1..all.len()).rev().for_each(|i| all.swap(i, self.below(i + 1)));
    }
}

/// x ↦ length · Q x + shift, t ↦ time · (t + later), and the units of mass and temperature.
#[derive(Clone, Debug)]
pub struct Frame {
    pub q: [[f64; 3]; 3],
    pub shift: Point,
    pub length: f64,
    pub mass: f64,
    pub time: f64,
    pub temperature: f64,
    /// Steps at rest before the case begins.
    pub later: usize,
    /// Seed of the numbering of nodes, cells and vertices; none to keep it.
    pub numbering: Option<u64>,
}

pub const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

impl Frame {
    pub fn same() -> Frame {
        Frame {
            q: IDENTITY,
            shift: [0.0; 3],
            length: 1.0,
            mass: 1.0,
            time: 1.0,
            temperature: 1.0,
            later: 0,
            numbering: None,
        }
    }

    /// Turned by an angle in the plane, by three angles in space.
    pub fn turned(dim: usize, random: &mut Random) -> Frame {
        let mut q = IDENTITY;
        let planes: &[(usize, usize)] = if dim == 2 { &[(0, 1)] } else { &[(0, 1), (1, 2), (0, 2)] };
        for &(i, j) in planes {
            let (s, c) = (std::f64::consts::TAU * random.number()).sin_cos();
            let mut turn = IDENTITY;
            (turn[i][i], turn[i][j], turn[j][i], turn[j][j]) = (c, -s, s, c);
            q = std::array::from_fn(|a| std::array::from_fn(|b| (0..3).map(|k| turn[a][k] * q[k][b]).sum()));
        }
        Frame { q, ..Frame::same() }
    }

    /// Mirrored at a plane that is turned at random; in one dimension and in bodies of revolution along the last axis.
    pub fn mirrored(dim: usize, along_last: bool, random: &mut Random) -> Frame {
        let mut frame = if dim == 1 || along_last { Frame::same() } else { Frame::turned(dim, random) };
        (0..3).for_each(|i| frame.q[i][dim - 1] *= -1.0);
        frame
    }

    pub fn vector(&self, v: &Point) -> Point {
        std::array::from_fn(|i| (0..3).map(|j| self.q[i][j] * v[j]).sum())
    }

    pub fn point(&self, x: &Point) -> Point {
        let turned = self.vector(x);
        std::array::from_fn(|d| self.length * turned[d] + self.shift[d])
    }

    fn is_mirror(&self) -> bool {
        let q = &self.q;
        (0..3)
            .map(|i| q[0][i] * (q[1][(i + 1) % 3] * q[2][(i + 2) % 3] - q[1][(i + 2) % 3] * q[2][(i + 1) % 3]))
            .sum::<f64>()
            < 0.0
    }

    /// The size of a unit: its name in a template.
    pub fn unit(&self, name: &str) -> f64 {
        // Powers of length, mass, time, temperature.
        let powers: [f64; 4] = match name {
            "1" => [0.0; 4],
            "m" => [1.0, 0.0, 0.0, 0.0],
            "s" => [0.0, 0.0, 1.0, 0.0],
            "K" => [0.0, 0.0, 0.0, 1.0],
            "m/s" => [1.0, 0.0, -1.0, 0.0],
            "m/s2" => [1.0, 0.0, -2.0, 0.0],
            "N/m" => [0.0, 1.0, -2.0, 0.0],
            "N" => [1.0, 1.0, -2.0, 0.0],
            "Nm" => [2.0, 1.0, -2.0, 0.0],
            "s/m" => [-1.0, 0.0, 1.0, 0.0],
            "kg/m3" => [-3.0, 1.0, 0.0, 0.0],
            "Pa" => [-1.0, 1.0, -2.0, 0.0],
            "1/Pa" => [1.0, -1.0, 2.0, 0.0],
            "Pas" => [-1.0, 1.0, -1.0, 0.0],
            "Pa/m" => [-2.0, 1.0, -2.0, 0.0],
            "Pa/m1.5" => [-2.5, 1.0, -2.0, 0.0],
            "Pas/m" => [-2.0, 1.0, -1.0, 0.0],
            "Pa/K" => [-1.0, 1.0, -2.0, -1.0],
            "N/m3" => [-2.0, 1.0, -2.0, 0.0],
            "W/m2" => [0.0, 1.0, -3.0, 0.0],
            "W/m3" => [-1.0, 1.0, -3.0, 0.0],
            "J/m3K" => [-1.0, 1.0, -2.0, -1.0],
            "W/mK" => [1.0, 1.0, -3.0, -1.0],
            "W/m2K" => [0.0, 1.0, -3.0, -1.0],
            "W/m3K" => [-1.0, 1.0, -3.0, -1.0],
            "W/m2K/Pa.95" => [0.95, 1.0 - 0.95, -3.0 + 1.9, -1.0],
            _ => panic!("no unit {name}"),
        };
        [self.length, self.mass, self.time, self.temperature]
            .iter()
            .zip(powers)
            .map(|(unit, power)| unit.powf(power))
            .product()
    }

    /// The coordinate X, Y or Z of the case, and its time T, by those of this description.
    fn coordinate(&self, name: char) -> String {
        let axes = ["x", "y", "z"];
        if name == 'T' {
            return format!("max(t/{:?}-{:?}, 0)", self.time, self.later as f64 * STEP);
        }
        let d = (name as u8 - b'X') as usize;
        let term = |i: usize| format!("({:?})*({}-({:?}))", self.q[i][d] / self.length, axes[i], self.shift[i]);
        let terms: Vec<String> = (0..3).filter(|&i| self.q[i][d] != 0.0).map(term).collect();
        format!("({})", terms.join("+"))
    }

    fn expression(&self, text: &str) -> String {
        text.chars().map(|c| if "XYZT".contains(c) { self.coordinate(c) } else { c.to_string() }).collect()
    }

    /// A number times a factor, or an expression.
    fn datum(&self, factors: &[(f64, &str)]) -> String {
        let numbers: Option<Vec<f64>> =
            factors.iter().map(|(factor, text)| Some(factor * text.trim().parse::<f64>().ok()?)).collect();
        if let Some(numbers) = numbers {
            return format!("{:?}", numbers.into_iter().sum::<f64>());
        }
        let terms: Vec<String> = factors
            .iter()
            .filter(|(factor, _)| *factor != 0.0)
            .map(|(factor, text)| format!("({factor:?})*({})", self.expression(text.trim())))
            .collect();
        format!("\"{}\"", terms.join("+"))
    }

    /// A template in this frame. In it `<unit|a>` is a number or an expression in X, Y, Z, T, `<unit|a; b>` a vector,
    /// `<unit|a, b; c, d>` a matrix, `<unit|a, b>` a list, `<v:unit|a>` a vector in one dimension, `<a:unit|a>` the
    /// moment of a plane body, `<a:unit|a; b; c>` one in space, and `<x|a; b>` a place.
    pub fn text(&self, template: &str) -> String {
        let mut out = String::new();
        let mut rest = template;
        while let Some((before, tail)) = rest.split_once('<') {
            let (token, after) = tail.split_once('>').expect("a token that ends");
            let (unit, data) = token.split_once('|').expect("a token with a unit");
            out.push_str(before);
            out.push_str(&self.token(unit, data));
            rest = after;
        }
        out + rest
    }

    fn token(&self, unit: &str, data: &str) -> String {
        if let Some(unit) = unit.strip_prefix("v:") {
            return format!("[{}]", self.datum(&[(self.unit(unit) * self.q[0][0], data)]));
        }
        if let Some(unit) = unit.strip_prefix("a:") {
            // A mirror turns moments round.
            let sense = if self.is_mirror() { -1.0 } else { 1.0 };
            if !data.contains(';') {
                return format!("[{}]", self.datum(&[(sense * self.unit(unit), data)]));
            }
            let parts: Vec<&str> = data.split(';').collect();
            let of = |i: usize, j: usize| sense * self.unit(unit) * self.q[i][j];
            let factors = |i: usize| parts.iter().enumerate().map(|(j, part)| (of(i, j), *part)).collect::<Vec<_>>();
            return format!("[{}]", (0..3).map(|i| self.datum(&factors(i))).collect::<Vec<_>>().join(", "));
        }
        let size = if unit == "x" { self.length } else { self.unit(unit) };
        let rows: Vec<Vec<&str>> = data.split(';').map(|row| row.split(',').collect()).collect();
        let dim = rows.len();
        match (dim, unit, data.contains(',')) {
            (_, "x", _) => {
                let x: Vec<f64> = rows.iter().map(|row| row[0].trim().parse().expect("a number")).collect();
                let image = self.point(&std::array::from_fn(|d| x.get(d).copied().unwrap_or(0.0)));
                format!("[{}]", image[..dim].iter().map(|c| format!("{c:?}")).collect::<Vec<_>>().join(", "))
            }
            // An expression may hold commas within a call: a list has numbers only.
            (1, ..)
                if data.split(',').count() > 1 && data.split(',').all(|item| item.trim().parse::<f64>().is_ok()) =>
            {
                format!("[{}]", data.split(',').map(|item| self.datum(&[(size, item)])).collect::<Vec<_>>().join(", "))
            }
            (1, ..) => self.datum(&[(size, data)]),
            (_, _, true)
                if rows
                    .iter()
                    .all(|row| row.len() == dim && row.iter().all(|item| item.trim().parse::<f64>().is_ok())) =>
            {
                let entry = |i: usize, j: usize| rows[i][j].trim().parse::<f64>().expect("a number");
                let turned = |i: usize, j: usize| -> f64 {
                    let sum = (0..dim)
                        .flat_map(|k| (0..dim).map(move |l| (k, l)))
                        .map(|(k, l)| self.q[i][k] * entry(k, l) * self.q[j][l])
                        .sum::<f64>();
                    size * sum
                };
                // Symmetric to the last bit.
                let row = |i: usize| {
                    (0..dim).map(|j| format!("{:?}", turned(i.min(j), i.max(j)))).collect::<Vec<_>>().join(", ")
                };
                format!("[{}]", (0..dim).map(|i| format!("[{}]", row(i))).collect::<Vec<_>>().join(", "))
            }
            _ => {
                let parts: Vec<&str> = data.split(';').collect();
                let component = |i: usize| {
                    let factors: Vec<(f64, &str)> = parts
                        .iter()
                        .enumerate()
                        .map(|(j, part)| (size * self.q[i][j], *part))
                        .filter(|(f, _)| *f != 0.0)
                        .collect();
                    self.datum(&factors)
                };
                format!("[{}]", (0..dim).map(component).collect::<Vec<_>>().join(", "))
            }
        }
    }

    /// The mesh in this frame.
    pub fn mesh(&self, mesh: &Mesh) -> Mesh {
        let mut out = Mesh { points: mesh.points.iter().map(|x| self.point(x)).collect(), ..mesh.clone() };
        if self.is_mirror() {
            out.blocks
                .iter_mut()
                .for_each(|block| renumber_cells(block.element, &mut block.nodes, |_| mirror(block.element.shape)));
            for set in out.facets.values_mut() {
                set.blocks
                    .iter_mut()
                    .for_each(|block| renumber_cells(block.element, &mut block.nodes, |_| mirror(block.element.shape)));
            }
        }
        if let Some(seed) = self.numbering {
            renumber(&mut out, &mut Random(seed));
        }
        out
    }
}

/// Length of the steps of every case.
pub const STEP: f64 = 1.0 / 16.0;

type Map = fn(&Point) -> Point;

/// A map of a reference cell onto itself that turns it inside out.
fn mirror(shape: Shape) -> Map {
    match shape {
        Shape::Point => |x| *x,
        Shape::Segment => |x| [1.0 - x[0], x[1], x[2]],
        _ => |x| [x[1], x[0], x[2]],
    }
}

/// Maps of a reference cell onto itself that turn it.
fn turns(shape: Shape) -> &'static [Map] {
    match shape {
        Shape::Point | Shape::Segment => &[|x| *x],
        Shape::Triangle => &[|x| *x, |x| [x[1], 1.0 - x[0] - x[1], 0.0], |x| [1.0 - x[0] - x[1], x[0], 0.0]],
        Shape::Quadrilateral => {
            &[|x| *x, |x| [x[1], 1.0 - x[0], 0.0], |x| [1.0 - x[0], 1.0 - x[1], 0.0], |x| [1.0 - x[1], x[0], 0.0]]
        }
        Shape::Tetrahedron => {
            &[|x| *x, |x| [x[1], x[2], x[0]], |x| [x[2], x[0], x[1]], |x| [x[1], 1.0 - x[0] - x[1] - x[2], x[2]]]
        }
        Shape::Hexahedron => {
            &[|x| *x, |x| [x[1], x[2], x[0]], |x| [x[1], 1.0 - x[0], x[2]], |x| [1.0 - x[0], x[1], 1.0 - x[2]]]
        }
        Shape::Prism => &[|x| *x, |x| [x[1], 1.0 - x[0] - x[1], x[2]], |x| [x[1], x[0], 1.0 - x[2]]],
        Shape::Pyramid => &[|x| *x],
    }
}

fn renumber_cells(element: &'static Element, nodes: &mut [u32], mut map: impl FnMut(usize) -> Map) {
    for (c, cell) in nodes.chunks_exact_mut(element.nodes.len()).enumerate() {
        let (old, map) = (cell.to_vec(), map(c));
        for (local, node) in cell.iter_mut().enumerate() {
            let image = map(&element.nodes[local]);
            let near = |x: &Point| (0..3).all(|d| (x[d] - image[d]).abs() < 1e-9);
            *node = old[element.nodes.iter().position(near).expect("the image of a node is a node")];
        }
    }
}

/// Other numbers of nodes, another order of cells, another vertex for each to begin with.
fn renumber(mesh: &mut Mesh, random: &mut Random) {
    let mut numbers: Vec<u32> = (0..mesh.points.len() as u32).collect();
    random.shuffle(&mut numbers);
    let old = mesh.points.clone();
    old.iter().zip(&numbers).for_each(|(x, &number)| mesh.points[number as usize] = *x);
    let sides = mesh
        .facets
        .values_mut()
        .flat_map(|set: &mut FacetSet| set.blocks.iter_mut().map(|block| (block.element, &mut block.nodes)));
    for (element, nodes) in
        mesh.blocks.iter_mut().map(|block: &mut Block| (block.element, &mut block.nodes)).chain(sides)
    {
        for node in nodes.iter_mut() {
            *node = numbers[*node as usize];
        }
        let turns = turns(element.shape);
        renumber_cells(element, nodes, |_| turns[random.below(turns.len())]);
        let mut cells: Vec<Vec<u32>> = nodes.chunks_exact(element.nodes.len()).map(<[u32]>::to_vec).collect();
        random.shuffle(&mut cells);
        *nodes = cells.concat();
    }
}
