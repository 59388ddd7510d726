//! The probes of a case, including those of its `[verify]` block.

use super::build::Build;
use super::nearest::meant;
use super::place::At;
use super::raw;
use crate::output::{Probe, ProbeError, ProbePlace, ProbeSet, Quantity, Take};
use crate::problem::ProblemData;
use crate::tensor::Point;

/// The place of a raw probe, and the path of its table.
struct ProbeTarget<'r> {
    path: String,
    at: Option<&'r Vec<f64>>,
    on: Option<&'r String>,
    contact: Option<&'r String>,
    region: Option<&'r String>,
    take: Option<raw::Over>,
    about: Option<&'r Vec<f64>>,
}

impl Build<'_> {
    /// The probes of `[[probe]]`.
    pub fn probes(&mut self, raw: &[raw::Probe], problem: &ProblemData) -> Vec<Probe> {
        let mut probes: Vec<Probe> = Vec::new();
        for (i, probe) in raw.iter().enumerate() {
            let path = format!("probe[{i}]");
            let is_word = !probe.name.is_empty()
                && probe.name.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '-' | '.'));
            if !is_word {
                let found = format!("\"{}\"", probe.name.escape_debug());
                self.note(
                    &format!("{path}.name"),
                    At::Value,
                    found,
                    "a name of letters, digits, `_`, `-` and `.`",
                    None,
                );
            } else if probes.iter().any(|other| other.name == probe.name) || matches!(probe.name.as_str(), "step" | "t")
            {
                let found = format!("\"{}\" again", probe.name);
                self.note(
                    &format!("{path}.name"),
                    At::Value,
                    found,
                    "a name of its own for each column of probes.csv, which begin with step and t",
                    None,
                );
            }
            let target = ProbeTarget {
                path,
                at: probe.at.as_ref(),
                on: probe.on.as_ref(),
                contact: probe.contact.as_ref(),
                region: probe.region.as_ref(),
                take: probe.take,
                about: probe.about.as_ref(),
            };
            if let Some(place) = self.probe_place(&target, problem)
                && let Some(quantity) = Quantity::parse(&probe.quantity)
                && let Ok(about) = self.probe_about(&target, problem.mesh.dim)
            {
                let read = Probe { name: probe.name.clone(), quantity, place, about };
                self.check_probe(&target, "quantity", problem, &read);
                probes.push(read);
            }
        }
        probes
    }

    /// The probe of a check of `[verify]`, or `None` if it has faults.
    pub fn checked_probe(&mut self, i: usize, check: &raw::Check, problem: &ProblemData) -> Option<Probe> {
        let raw::Check::Probe { field, at, on, contact, region, take, about, .. } = check else { return None };
        let target = ProbeTarget {
            path: format!("verify.check[{i}]"),
            at: at.as_ref(),
            on: on.as_ref(),
            contact: contact.as_ref(),
            region: region.as_ref(),
            take: *take,
            about: about.as_ref(),
        };
        let (place, quantity) = (self.probe_place(&target, problem)?, Quantity::parse(field)?);
        let about = self.probe_about(&target, problem.mesh.dim).ok()?;
        let probe = Probe { name: describe(field, &place, problem.mesh.dim), quantity, place, about };
        self.check_probe(&target, "field", problem, &probe);
        Some(probe)
    }

    fn probe_place(&mut self, target: &ProbeTarget, problem: &ProblemData) -> Option<ProbePlace> {
        let path = &target.path;
        let take = target.take.map(|take| match take {
            raw::Over::Mean => Take::Mean,
            raw::Over::Max => Take::Max,
            raw::Over::Min => Take::Min,
            raw::Over::Integral => Take::Integral,
        });
        let keys = [
            ("at", target.at.is_some()),
            ("on", target.on.is_some()),
            ("contact", target.contact.is_some()),
            ("region", target.region.is_some()),
        ];
        let given: Vec<&str> = keys.iter().filter(|(_, is)| *is).map(|(key, _)| *key).collect();
        match (given.as_slice(), take) {
            (["at"] | ["at", "contact"], None) => self.probe_point(target, problem.mesh.dim),
            (["at"] | ["at", "contact"], Some(_)) => {
                let expected = "`take` with `on`, `contact` or `region`";
                self.note(&format!("{path}.take"), At::Key, "`take` of the value at a point", expected, None);
                None
            }
            (["on"], Some(take)) => Some(ProbePlace::On(target.on?.clone(), take)),
            (["contact"], Some(take)) => Some(ProbePlace::Contact(target.contact?.clone(), take)),
            (["region"], Some(take)) => Some(ProbePlace::Region(target.region?.clone(), take)),
            (["on" | "contact" | "region"], None) => {
                let expected = "\"mean\", \"max\", \"min\" or \"integral\" (what is taken of the values)";
                self.note(&format!("{path}.take"), At::Missing, "no such key", expected, None);
                None
            }
            (given, _) => {
                let found = if given.is_empty() {
                    "no place".to_owned()
                } else {
                    given.iter().map(|key| format!("`{key}`")).collect::<Vec<_>>().join(" and ")
                };
                self.note(path, At::Value, found, "one of `at`, `on`, `contact` and `region`", None);
                None
            }
        }
    }

    /// A point of the body, or of a contact.
    fn probe_point(&mut self, target: &ProbeTarget, dim: usize) -> Option<ProbePlace> {
        let point = self.probe_coordinates(&format!("{}.at", target.path), target.at?, dim)?;
        Some(target.contact.map_or(ProbePlace::At(point), |name| ProbePlace::AtContact(point, name.clone())))
    }

    /// The reference point of a moment, if given.
    fn probe_about(&mut self, target: &ProbeTarget, dim: usize) -> Result<Option<Point>, ()> {
        let Some(about) = target.about else { return Ok(None) };
        self.probe_coordinates(&format!("{}.about", target.path), about, dim).map(Some).ok_or(())
    }

    /// A point with as many coordinates as the body has dimensions.
    fn probe_coordinates(&mut self, path: &str, given: &[f64], dim: usize) -> Option<Point> {
        if given.len() != dim {
            let found = format!("{} coordinates", given.len());
            self.note(path, At::Value, found, format!("{dim} coordinates"), None);
            return None;
        }
        Some(std::array::from_fn(|c| given.get(c).copied().unwrap_or_default()))
    }

    /// Notes the reason why a probe cannot be read; `quantity` is the key of the quantity.
    fn check_probe(&mut self, target: &ProbeTarget, quantity: &str, problem: &ProblemData, probe: &Probe) {
        // On a mesh with faults points outside are unknown.
        let mesh_unknown = self.findings.iter().any(|finding| finding.path.is_in("mesh"));
        let Err(error) = ProbeSet::check(problem, probe) else { return };
        let path = |key: &str| format!("{}.{key}", target.path);
        let among = |name: Option<&String>, known: &[String]| {
            let name = name.map_or("", |name| name);
            let words: Vec<&str> = known.iter().map(String::as_str).collect();
            (format!("\"{name}\""), words.join(", "), meant(name, &words))
        };
        match error {
            _ if mesh_unknown => {}
            ProbeError::Outside { low, high } => {
                let at: Vec<f64> = target.at.cloned().unwrap_or_default();
                let expected = format!("a point of the body, which reaches from {} to {}", point(&low), point(&high));
                self.note(&path("at"), At::Value, format!("{}, outside the body", point(&at)), expected, None);
            }
            ProbeError::Side(known) => {
                let (found, known, hint) = among(target.on, &known);
                self.note(&path("on"), At::Value, found, format!("one of the facet sets {known}"), hint.as_deref());
            }
            ProbeError::Region(known) => {
                let (found, known, hint) = among(target.region, &known);
                self.note(&path("region"), At::Value, found, format!("one of the regions {known}"), hint.as_deref());
            }
            ProbeError::NoContact(known) => {
                let (found, known, hint) = among(target.contact, &known);
                self.note(&path("contact"), At::Value, found, format!("one of the contacts {known}"), hint.as_deref());
            }
            ProbeError::Several(known) => {
                let expected = format!("`contact` besides `at`: one of {}", known.join(", "));
                let found = format!("a point of {} contacts of one side", known.len());
                self.note(&path("at"), At::Value, found, expected, None);
            }
            error @ ProbeError::Resultant(_) => {
                self.note(&path("take"), At::Value, error.to_string(), "\"integral\": the sum over the nodes", None);
            }
            error @ ProbeError::OnlyMean(_) => {
                let expected = "\"mean\": the rotation of the side or region as a whole";
                self.note(&path("take"), At::Value, error.to_string(), expected, None);
            }
            error @ ProbeError::About(_) => {
                let expected = "`about` of reaction_moment or total_moment";
                self.note(&path("about"), At::Key, error.to_string(), expected, None);
            }
            error @ (ProbeError::Component { .. }
            | ProbeError::Normal(_)
            | ProbeError::Contact(_)
            | ProbeError::OfBody(_)
            | ProbeError::Free(..)
            | ProbeError::Absent(_)
            | ProbeError::Still(..)
            | ProbeError::Alone(_)
            | ProbeError::Whole(_)
            | ProbeError::Hoop) => {
                self.note(&path(quantity), At::Value, error.to_string(), "a quantity that exists there", None);
            }
        }
    }
}

/// Text of a probe: `displacement_x at (0.5, 1)`.
fn describe(field: &str, place: &ProbePlace, dim: usize) -> String {
    let over = |take: Take, name: &str| {
        let take = match take {
            Take::Mean => "mean",
            Take::Max => "largest",
            Take::Min => "smallest",
            Take::Integral => "integral of",
        };
        format!("{take} {field}, {name}")
    };
    match place {
        ProbePlace::At(at) => format!("{field} at {}", point(&coordinates(at, dim))),
        ProbePlace::AtContact(at, name) => format!("{field} at {}, {name}", point(&coordinates(at, dim))),
        ProbePlace::On(name, take) | ProbePlace::Region(name, take) | ProbePlace::Contact(name, take) => {
            over(*take, name)
        }
    }
}

fn coordinates(at: &Point, dim: usize) -> Vec<f64> {
    at.iter().take(dim).copied().collect()
}

/// Text of a point: `(0.5, 1)`.
fn point(coordinates: &[f64]) -> String {
    format!("({})", coordinates.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "))
}
