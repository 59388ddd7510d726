//! Names of contacts in results; a side may bear several contacts.

use std::collections::BTreeSet;

use super::Contact;

/// A unique name for each contact: the given one, else its side `on`, numbered from the second contact of that name on.
#[must_use]
pub fn names(contacts: &[Contact]) -> Vec<String> {
    let mut taken: BTreeSet<String> = contacts.iter().map(|contact| contact.name.clone()).collect();
    let mut all = Vec::with_capacity(contacts.len());
    for contact in contacts {
        if !contact.name.is_empty() {
            all.push(contact.name.clone());
            continue;
        }
        let numbered = (2..).map(|number| format!("{}-{number}", contact.on));
        let mut candidates = std::iter::once(contact.on.clone()).chain(numbered);
        let name = candidates.find(|name| !taken.contains(name)).unwrap_or_default();
        taken.insert(name.clone());
        all.push(name);
    }
    all
}

/// Names for the points of each contact: the bearing side, or the names of the contacts if a side bears points of
/// several.
#[must_use]
pub fn names_of_points(contacts: &[Contact]) -> Vec<String> {
    let sides: Vec<String> = contacts.iter().map(|contact| contact.bearing().to_owned()).collect();
    let different: BTreeSet<&String> = sides.iter().collect();
    if different.len() == sides.len() { sides } else { names(contacts) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Pair, Signorini};

    fn on(side: &str, name: &str) -> Contact {
        Contact { name: name.to_owned(), ..Contact::new(side, Signorini) }
    }

    #[test]
    fn no_name_is_given_twice() {
        let contacts = [on("a", ""), on("b", ""), on("a", ""), on("a", "a-2"), on("a", "left"), on("b", "")];
        assert_eq!(names(&contacts), ["a", "b", "a-3", "a-2", "left", "b-2"]);
        assert_eq!(names_of_points(&contacts), names(&contacts));
        assert!(names(&[]).is_empty());
    }

    /// If every side bears one contact, its points are named by it, also for a pair whose points are on `with`.
    #[test]
    fn points_are_named_by_their_side() {
        let pair = Contact::new("a", Signorini).with(Pair { on_is_mortar: true, ..Pair::new("b") });
        let both = [pair.clone(), on("a", "below")];
        assert_eq!(names_of_points(&both), ["b", "a"]);
        assert_eq!(names(&both), ["a", "below"]);
        assert_eq!(names_of_points(&[pair, on("b", "below")]), ["a", "below"]);
    }
}
