//! Sectors that are repeated about an axis.

use super::boundary::unknown;
use super::temperature::entries;
use super::{Fault, ProblemData};
use crate::mesh::{Cyclic, Link, Links, NotCyclic};
use crate::space::Prescription;
use crate::tensor::{Point, dot, length};

/// Number of times at which data on both sides of a sector are compared, and the relative tolerance for typed digits.
const TIMES: u32 = 8;
const GIVEN: f64 = 1e-6;
/// Tolerance of a position relative to the distance of the compared points: the tolerance of the angle.
const PLACE: f64 = 1e-3;

impl ProblemData {
    /// The links from nodes to the nodes they follow. A sector whose sides do not match has none; the check reports it.
    #[must_use]
    pub fn links(&self) -> Links {
        let of_each = self.cyclic.iter().filter_map(|cyclic| Some(cyclic.links(&self.mesh).ok()?.0));
        of_each.fold(Links::default(), |all, links| all.clone().and(links).unwrap_or(all))
    }

    /// Checks that the sides of sectors exist, bear nothing else, and turn into each other.
    pub(super) fn check_cyclic(&self, faults: &mut Vec<Fault>) {
        let mut all = Links::default();
        for (i, cyclic) in self.cyclic.iter().enumerate() {
            let path = format!("cyclic[{i}]");
            let known = faults.len();
            self.check_sides_of(cyclic, &path, faults);
            if faults.len() > known {
                continue;
            }
            match cyclic.links(&self.mesh) {
                Ok((links, _)) => match all.clone().and(links) {
                    Some(both) => {
                        self.check_seam(&both.nodes, faults);
                        all = both;
                    }
                    None => faults.push(
                        Fault::new(
                            format!("{path}.sides"),
                            "sides that another entry has joined already",
                            "the sides of one sector",
                        )
                        .hint("give each pair of sides in one entry, and no side of two sectors about different axes"),
                    ),
                },
                Err(why) => faults.push(self.unmatched(cyclic, &path, &why)),
            }
        }
    }

    /// Checks the names, the axis and the other conditions on the sides.
    fn check_sides_of(&self, cyclic: &Cyclic, path: &str, faults: &mut Vec<Fault>) {
        if self.mesh.dim == 1 || self.mesh.axisymmetric {
            let found = if self.mesh.axisymmetric { "a body of revolution" } else { "a body in one dimension" };
            faults.push(Fault::new(path, found, "a body in the plane or in space"));
            return;
        }
        let size = length(&cyclic.axis);
        if !(size.is_finite() && size > 0.0) {
            faults.push(Fault::new(
                format!("{path}.axis"),
                format!("{:?}", cyclic.axis),
                "a direction that is not zero",
            ));
        }
        for (k, side) in cyclic.sides.iter().enumerate() {
            let at = format!("{path}.sides[{k}]");
            if !self.mesh.facets.contains_key(side) {
                let known: Vec<&str> = self.mesh.facets.keys().map(String::as_str).collect();
                faults.push(unknown(at, side, "facet sets", &known));
                continue;
            }
            if let Some(entry) = self.boundary.iter().position(|b| b.on == *side && !b.is_empty()) {
                let found = format!("\"{side}\", which has conditions in boundary[{entry}]");
                let hint = "the body goes on behind this side: remove the conditions; a plane of symmetry takes `normal_displacement = 0` instead of cyclic symmetry";
                faults.push(Fault::new(at, found, "a side without conditions").hint(hint));
            } else if let Some(entry) = self.contacts.iter().position(|contact| contact.sides().any(|s| s == side)) {
                let found = format!("\"{side}\", which is in {}", self.contact_path(entry));
                faults.push(Fault::new(at, found, "a side without contact"));
            }
        }
        if cyclic.sides[0] == cyclic.sides[1] {
            faults.push(Fault::new(format!("{path}.sides"), "one side twice", "the two sides of a sector"));
        }
    }

    /// Checks that conditions on both sides of a sector are the same, rotated.
    fn check_seam(&self, links: &[Link], faults: &mut Vec<Fault>) {
        for (i, b) in self.boundary.iter().enumerate() {
            let Some(set) = self.mesh.named(&b.on) else { continue };
            let nodes = set.node_list();
            let both = |link: &&Link| [link.node, link.to].iter().all(|node| nodes.binary_search(node).is_ok());
            let given = b.prescriptions(&self.mesh);
            let axis = [1.0, 0.0, 0.0];
            let heat: Vec<_> =
                b.temperature.iter().map(|field| Prescription { on: &b.on, direction: axis, field }).collect();
            for (key, given, is_vector) in [("displacement", given, true), ("temperature", heat, false)] {
                let clash = links.iter().filter(both).find(|link| self.clashes(&given, link, is_vector));
                faults.extend(clash.map(|link| self.clash(format!("boundary[{i}].{key}"), link)));
            }
        }
        self.check_temperature_on(links, faults);
        let initial = &self.initial;
        let temperature = std::slice::from_ref(&initial.temperature);
        for (key, fields, is_vector) in [
            ("displacement", initial.displacement.as_slice(), true),
            ("velocity", &initial.velocity, true),
            ("temperature", temperature, false),
        ] {
            let axes: [Point; 3] = std::array::from_fn(|c| std::array::from_fn(|d| f64::from(u8::from(c == d))));
            let given: Vec<_> =
                fields.iter().zip(axes).map(|(field, direction)| Prescription { on: "", direction, field }).collect();
            let clash = links.iter().find(|link| self.clashes(&given, link, is_vector));
            faults.extend(clash.map(|link| self.clash(format!("initial.{key}"), link)));
        }
    }

    /// Checks that a given temperature is the same on both sides of a sector.
    fn check_temperature_on(&self, links: &[Link], faults: &mut Vec<Fault>) {
        let of = entries(&self.mesh, &self.temperature);
        let entry = |node: u32| of.get(node as usize).copied().flatten();
        let clash = links.iter().find_map(|link| {
            let Some(number) = entry(link.node) else { return Some((entry(link.to)?, link)) };
            let field = &self.temperature.get(number)?.field;
            let given = [Prescription { on: "", direction: [1.0, 0.0, 0.0], field }];
            let clashes = entry(link.to) != Some(number) || self.clashes(&given, link, false);
            clashes.then_some((number, link))
        });
        let key = |number: usize| self.temperature.get(number).map(|given| given.key.clone()).unwrap_or_default();
        faults.extend(clash.map(|(number, link)| self.clash(key(number), link)));
    }

    /// True if prescriptions at a follower differ at some time from the rotated ones of its leader, in direction or
    /// value. A value may differ as much as the offset between the two positions explains.
    fn clashes(&self, given: &[Prescription], link: &Link, is_vector: bool) -> bool {
        let x = |node: u32| self.mesh.points[node as usize];
        let place = x(link.node);
        let off = PLACE * (0..3).map(|c| (place[c] - x(link.to)[c]).abs()).fold(0.0, f64::max);
        (0..=TIMES).any(|n| {
            let t = self.timeline.end() * f64::from(n) / f64::from(TIMES);
            let values = |x: &Point| given.iter().map(|given| given.field.value(x, t)).collect::<Vec<f64>>();
            let [own, followed] = [link.node, link.to].map(|node| values(&x(node)));
            let beside = |d: usize, by: f64| values(&std::array::from_fn(|c| place[c] + if c == d { by } else { 0.0 }));
            let moved: Vec<Vec<f64>> = (0..self.mesh.dim).flat_map(|d| [beside(d, off), beside(d, -off)]).collect();
            let changes = moved.iter().flat_map(|values| values.iter().zip(&own).map(|(there, here)| there - here));
            let allowed = changes.chain(own.iter().chain(&followed).map(|value| GIVEN * value));
            let allowed = allowed.fold(0.0f64, |most, change| most.max(change.abs()));
            given.iter().zip(&own).any(|(given_here, value)| {
                let here = if is_vector { link.back(&given_here.direction) } else { given_here.direction };
                let shares: Vec<f64> = given.iter().map(|given| dot(&here, &given.direction)).collect();
                let there: f64 = shares.iter().zip(&followed).map(|(share, value)| share * value).sum();
                // The directions of an entry are axes, or one normal.
                let length: f64 = shares.iter().map(|share| share * share).sum();
                length < 1.0 - GIVEN || (value - there).abs() > allowed
            })
        })
    }

    fn clash(&self, path: String, link: &Link) -> Fault {
        let [here, there] = [link.node, link.to].map(|node| self.mesh.place(&self.mesh.points[node as usize]));
        let found = format!("a value at {here} that is not the one at {there}, turned");
        let hint = "the body is repeated about its axis: what is given in one sector is given in every other, turned";
        Fault::new(path, found, "the same on both sides of the sector").hint(hint)
    }

    /// The fault of sides that do not turn into each other.
    fn unmatched(&self, cyclic: &Cyclic, path: &str, why: &NotCyclic) -> Fault {
        let path = format!("{path}.sides");
        let [first, second] = &cyclic.sides;
        match why {
            NotCyclic::Count([a, b]) => {
                let found = format!("{a} nodes on \"{first}\" and {b} on \"{second}\"");
                let hint = "mesh both sides alike: in Gmsh with `Periodic Curve` or `Periodic Surface`";
                Fault::new(path, found, "two sides with the same mesh, one turned").hint(hint)
            }
            NotCyclic::Angle(angle) => {
                let found = format!("an angle of {angle:.4}° from \"{first}\" to \"{second}\"");
                let hint = "check `center` and `axis`, and whether the sides are those along which the sector meets its neighbours";
                Fault::new(path, found, "360° divided by a whole number").hint(hint)
            }
            NotCyclic::Cut(x) => {
                let found = format!(
                    "a facet of \"{first}\" at {} that is turned onto no facet of \"{second}\"",
                    self.mesh.place(x)
                );
                let hint = "the nodes match, the facets are cut differently: mesh both sides alike, in Gmsh with `Periodic Surface`";
                Fault::new(path, found, "two sides with the same mesh, one turned").hint(hint)
            }
            NotCyclic::Apart(x, distance) => {
                let place = self.mesh.place(x);
                let found = format!(
                    "no node of \"{second}\" at {place}, to where one of \"{first}\" is turned; the nearest is {distance:.3e} m away"
                );
                let hint = "mesh both sides alike: in Gmsh with `Periodic Curve` or `Periodic Surface`; check `center` and `axis`";
                Fault::new(path, found, "two sides with the same mesh, one turned").hint(hint)
            }
        }
    }
}
