//! `[[side]]`: sides defined by their place.

use super::build::Build;
use super::nearest::meant;
use super::place::At;
use super::raw;
use crate::mesh::{FacetSet, Locus, Mesh};
use crate::tensor::{Point, length};

impl Build<'_> {
    /// Adds the sides defined in the case to the mesh.
    ///
    /// On a placeholder mesh places are unknown: there a side is the whole boundary.
    pub fn name_sides(&mut self, sides: &[raw::Side], mesh: &mut Mesh) {
        let boundary = if sides.is_empty() { FacetSet::default() } else { mesh.boundary() };
        for (i, side) in sides.iter().enumerate() {
            let path = format!("side[{i}]");
            let found = self.named(&path, side, mesh, &boundary);
            // A side with a fault is replaced by the boundary, so that keys that use it cause no further faults.
            let set = found.filter(|set| !set.is_empty()).unwrap_or_else(|| boundary.clone());
            mesh.facets.entry(side.name.clone()).or_insert(set);
        }
    }

    /// The facets of a side, or `None` if it has a fault or places are unknown.
    fn named(&mut self, path: &str, side: &raw::Side, mesh: &Mesh, boundary: &FacetSet) -> Option<FacetSet> {
        if let Some(what) = taken(&side.name, mesh) {
            let found = format!("\"{}\", {what}", side.name);
            self.note(&format!("{path}.name"), At::Value, found, "a name that nothing else has", None);
            return None;
        }
        if side.on.is_none() && side.of.is_empty() && side.region.is_none() {
            let expected =
                "one of them: `on`, places such as { plane = … }, `of`, names of sides, or the name of a `region`";
            self.note(path, At::Value, "neither `on` nor `of` nor `region`", expected, None);
            return None;
        }
        let among = self.among(path, side, mesh, boundary)?;
        let Some(on) = &side.on else { return Some(among) };
        let mut parts = Vec::new();
        for (below, locus) in on.each() {
            let path = format!("{path}.on{below}");
            let loci = self.loci(&path, locus)?;
            let found = mesh.facets_in(&among, &loci);
            if found.is_empty() && self.is_sound {
                self.catches_nothing(&path, &loci, mesh, &among);
                return None;
            }
            parts.push(found);
        }
        Some(Mesh::union(&parts.iter().collect::<Vec<_>>()))
    }

    /// The facets of the sides and the region from which a side is selected.
    fn among(&mut self, path: &str, side: &raw::Side, mesh: &Mesh, boundary: &FacetSet) -> Option<FacetSet> {
        let mut sets = Vec::new();
        for (i, name) in side.of.iter().enumerate() {
            let Some(set) = mesh.facets.get(name) else {
                let known: Vec<&str> = mesh.facets.keys().map(String::as_str).collect();
                let hint = meant(name, &known);
                let expected = format!("one of the sides {}", known.join(", "));
                let found = format!("\"{name}\"");
                self.note(&format!("{path}.of[{i}]"), At::Value, found, expected, hint.as_deref());
                return None;
            };
            sets.push(set);
        }
        let all = if sets.is_empty() { boundary.clone() } else { Mesh::union(&sets) };
        let Some(region) = &side.region else { return Some(all) };
        let Some(number) = mesh.regions.iter().position(|name| name == region) else {
            let known: Vec<&str> = mesh.regions.iter().map(String::as_str).collect();
            let hint = meant(region, &known);
            let expected = format!("one of the regions {}", known.join(", "));
            self.note(&format!("{path}.region"), At::Value, format!("\"{region}\""), expected, hint.as_deref());
            return None;
        };
        let is_of = |cell: Option<(usize, usize)>| {
            cell.and_then(|(block, _)| mesh.blocks.get(block)).is_some_and(|block| block.region == number)
        };
        let mut of_region = FacetSet::default();
        for ((element, nodes), cell) in all.facets().zip(mesh.cells_of(&all)) {
            if is_of(cell) {
                of_region.push(element, nodes.iter().copied());
            }
        }
        if of_region.is_empty() && self.is_sound {
            let found = format!("\"{region}\", which has none of these facets");
            self.note(&format!("{path}.region"), At::Value, found, "a region beside them", None);
            return None;
        }
        Some(of_region)
    }

    /// The places of a table, or `None` if one has a fault.
    fn loci(&mut self, path: &str, raw: &raw::Locus) -> Option<Vec<Locus>> {
        let mut loci = Vec::new();
        if let Some(plane) = &raw.plane {
            let at = format!("{path}.plane");
            let (point, normal) =
                (self.point(&at, "point", &plane.point), self.vector_of(&at, "normal", &plane.normal));
            loci.push(Locus::Plane { point: point?, normal: normal? });
        }
        if let Some(corners) = &raw.within {
            let at = format!("{path}.box");
            let (from, to) = (self.point(&at, "from", &corners.from), self.point(&at, "to", &corners.to));
            loci.push(self.ordered(&at, from?, to?)?);
        }
        if let Some(cylinder) = &raw.cylinder {
            let at = format!("{path}.cylinder");
            let is_at_origin = cylinder.point.is_empty();
            let point = if is_at_origin { Some([0.0; 3]) } else { self.point(&at, "point", &cylinder.point) };
            let axis = self.axis(&at, &cylinder.axis);
            let axis = axis.filter(|axis| self.is_direction(&format!("{at}.axis"), axis));
            loci.push(Locus::Cylinder { point: point?, axis: axis?, radius: cylinder.radius });
        }
        if let Some(sphere) = &raw.sphere {
            let point = self.point(&format!("{path}.sphere"), "center", &sphere.center);
            loci.push(Locus::Sphere { point: point?, radius: sphere.radius });
        }
        if let Some(near) = &raw.near {
            let point = self.point(&format!("{path}.near"), "point", &near.point);
            loci.push(Locus::Near { point: point?, distance: near.distance });
        }
        if let Some(normal) = &raw.normal {
            let direction = self.vector_of(&format!("{path}.normal"), "direction", &normal.direction);
            loci.push(Locus::Normal { direction: direction?, angle: normal.angle });
        }
        if loci.is_empty() {
            let expected = "`plane`, `box`, `cylinder`, `sphere`, `near` or `normal`";
            self.note(path, At::Value, "no place", expected, None);
            return None;
        }
        Some(loci)
    }

    /// A point with one coordinate per dimension.
    pub(super) fn point(&mut self, path: &str, key: &str, components: &[f64]) -> Option<Point> {
        if components.len() != self.dim {
            self.wants_components(&format!("{path}.{key}"), components.len());
            return None;
        }
        Some(std::array::from_fn(|c| components.get(c).copied().unwrap_or_default()))
    }

    /// A nonzero vector.
    fn vector_of(&mut self, path: &str, key: &str, components: &[f64]) -> Option<Point> {
        let vector = self.point(path, key, components)?;
        self.is_direction(&format!("{path}.{key}"), &vector).then_some(vector)
    }

    pub(super) fn is_direction(&mut self, path: &str, vector: &Point) -> bool {
        let is = length(vector).is_normal();
        if !is {
            self.note(path, At::Value, "a vector without a direction", "one that is not zero", None);
        }
        is
    }

    pub(super) fn ordered(&mut self, path: &str, from: Point, to: Point) -> Option<Locus> {
        let Some(wrong) = (0..3).find(|&c| from[c] > to[c]) else { return Some(Locus::Box { from, to }) };
        let found = format!("from {:?} to {:?} along {}", from[wrong], to[wrong], ["x", "y", "z"][wrong]);
        self.note(path, At::Value, found, "`from` below `to` along every axis", Some("exchange these coordinates"));
        None
    }

    /// Notes that no facet lies in all places, with the number of facets in each.
    fn catches_nothing(&mut self, path: &str, loci: &[Locus], mesh: &Mesh, among: &FacetSet) {
        let facets = |count: usize| if count == 1 { "1 facet".to_owned() } else { format!("{count} facets") };
        let each = loci.iter().map(|locus| mesh.facets_in(among, std::slice::from_ref(locus)).len());
        let each: Vec<String> = loci.iter().zip(each).map(|(l, n)| format!("{} of `{}`", facets(n), key(l))).collect();
        let found = if loci.len() == 1 {
            "no facet there".to_owned()
        } else {
            format!("no facet in all of these places: {}", each.join(", "))
        };
        let nodes = among.node_list();
        let range = |d: usize| {
            let along = || nodes.iter().filter_map(|&n| mesh.points.get(n as usize)).map(|x| x[d]);
            let [low, high] = [along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max)];
            format!("{} from {low:?} to {high:?}", ["x", "y", "z"][d])
        };
        let ranges: Vec<String> = (0..mesh.dim.min(3)).map(range).collect();
        let expected = format!("at least one of {}, which have {}", facets(among.len()), ranges.join(", "));
        self.note(path, At::Value, found, expected, Some("a facet counts where all its vertices lie in the place"));
    }
}

/// The existing item with this name, in words.
fn taken(name: &str, mesh: &Mesh) -> Option<&'static str> {
    if name.trim().is_empty() {
        Some("which is no name")
    } else if mesh.facets.contains_key(name) {
        Some("which is a side already")
    } else if mesh.edges.contains_key(name) {
        Some("which is an edge or a set of points of the mesh")
    } else if mesh.regions.iter().any(|region| region == name) {
        Some("which is a region of the mesh")
    } else {
        None
    }
}

/// The key of a place in the case file.
fn key(locus: &Locus) -> &'static str {
    match locus {
        Locus::Plane { .. } => "plane",
        Locus::Box { .. } => "box",
        Locus::Cylinder { .. } => "cylinder",
        Locus::Sphere { .. } => "sphere",
        Locus::Near { .. } => "near",
        Locus::Normal { .. } => "normal",
    }
}
