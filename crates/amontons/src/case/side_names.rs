//! The sides named in a case, before there is a mesh.

use super::raw;

/// The sides of a case.
pub(super) struct SideNames<'c> {
    /// The sides of contacts.
    pub contact: Vec<&'c str>,
    /// The sides named by conditions, contacts and other sides.
    pub used: Vec<&'c str>,
    /// The sides defined by their place.
    pub named: &'c [raw::Side],
}

impl SideNames<'_> {
    /// The sides of a case.
    pub fn new(raw: &raw::Case) -> SideNames<'_> {
        let contact: Vec<&str> = raw.contact.as_ref().map_or_else(Vec::new, raw::Contacts::sides);
        let of_boundary = raw.boundary.iter().map(|b| b.on.as_str());
        let of_sides = raw.side.iter().flat_map(|side| side.of.iter().map(String::as_str));
        let of_places = raw.mesh.refine_where().iter().filter_map(|entry| entry.side.as_deref());
        let used = of_boundary.chain(of_sides).chain(of_places).chain(contact.iter().copied()).collect();
        SideNames { contact, used, named: &raw.side }
    }
}
