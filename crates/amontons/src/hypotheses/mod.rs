//! Hypotheses of the theory as findings with numbers: reported, never a gate (design decision D6).

mod domain;

pub use domain::{Constant, DomainConstants, domain_constants};

use serde::{Deserialize, Serialize};

use crate::material::Constants;
use crate::problem::Problem;

/// A hypothesis or condition, and whether it holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// `H1` … `H3`, or one of our own such as `energy`.
    pub id: String,
    /// `holds`, `fails` or `not-covered`.
    pub status: String,
    /// The value found, if there is one.
    pub value: Option<f64>,
    /// The value needed, if there is one.
    pub needed: Option<f64>,
    /// What it means.
    pub message: String,
    /// What it is about.
    #[serde(rename = "where")]
    pub place: String,
}

impl Finding {
    /// Whether it fails.
    #[must_use]
    pub fn fails(&self) -> bool {
        self.status == "fails"
    }
}

fn finding(id: &str, holds: bool, value: f64, needed: f64, message: String, place: &str) -> Finding {
    let status = if holds { "holds" } else { "fails" };
    Finding { id: id.to_owned(), status: status.to_owned(), value: Some(value), needed: Some(needed), message, place: place.to_owned() }
}

/// (H1), (H2) and (H3) for the data of a problem: the constants of 𝓥 and 𝓔 on 𝕊^d, the eigenvalues of 𝓚.
#[must_use]
pub fn findings(problem: &Problem) -> Vec<Finding> {
    let material = &problem.material;
    let operator = |id: &str, name: &str, m: &str, constants: Constants, place: &str| {
        let Constants { monotonicity, lipschitz } = constants;
        let message = format!("{name} is strongly monotone with {m} = {monotonicity:.6e} and Lipschitz with constant {lipschitz:.6e}");
        let weak = format!("{name} is not strongly monotone: {m} = {monotonicity:.6e}, expected a positive number");
        let holds = monotonicity > 0.0 && lipschitz.is_finite();
        finding(id, holds, monotonicity, 0.0, if holds { message } else { weak }, place)
    };
    let eigenvalues = material.conductivity.eigenvalues(problem.mesh.dim);
    let (least, largest) = (eigenvalues.first().copied().unwrap_or(0.0), eigenvalues.last().copied().unwrap_or(0.0));
    // Round-off of an eigenvalue is relative to the largest.
    let positive = least > 1e-14 * largest.abs();
    let list = eigenvalues.iter().map(|e| format!("{:.6}", if positive { *e } else { e + 0.0 })).collect::<Vec<_>>().join(", ");
    let conductivity = if positive {
        format!("𝓚 has the eigenvalues {list}")
    } else {
        format!("𝓚 has the eigenvalues {list}: it is not positive definite, heat flows in some directions only and the result depends on the mesh")
    };
    vec![
        operator("H1", "𝓥", "m_b", material.viscosity.constants(), "material.viscosity"),
        operator("H2", "𝓔", "m_a", material.elasticity.constants(), "material.elasticity"),
        finding("H3", positive, if positive { least } else { 0.0f64.max(least) }, 0.0, conductivity, "material.conductivity"),
    ]
}

/// Closing error of an identity of the audit above which round-off does not explain it.
pub const CLOSING: f64 = 1e-10;

/// Whether the energy and heat identities close.
#[must_use]
pub fn audit(energy: f64, heat: f64) -> [Finding; 2] {
    let one = |id: &str, name: &str, error: f64| {
        let holds = error.abs() <= CLOSING;
        let message = if holds {
            format!("the {name} identity closes to {error:.1e} of what was turned over")
        } else {
            format!("the {name} identity closes to {error:.1e} of what was turned over only: round-off has grown, take the results with care")
        };
        finding(id, holds, error.abs(), CLOSING, message, "the audit of every step")
    };
    [one("energy", "energy", energy), one("heat", "heat", heat)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{self, CaseError, Source};

    fn paper(overrides: &[&str]) -> Result<Vec<Finding>, CaseError> {
        let source = Source { name: "paper.toml".to_owned(), text: include_str!("../../../../cases/paper.toml").to_owned() };
        let overrides: Vec<String> = overrides.iter().map(|&o| o.to_owned()).collect();
        Ok(findings(&case::parse(&source, &overrides)?.problem))
    }

    /// m_a = E/(1+ν), m_b = μ₂; the all-ones 𝓚 has the eigenvalues 0 and 2.
    #[test]
    fn the_readings_of_the_paper_are_judged() -> Result<(), CaseError> {
        let default = paper(&[])?;
        assert!(default.iter().all(|f| f.status == "holds"));
        let value = |findings: &[Finding], id: &str| findings.iter().find(|f| f.id == id).and_then(|f| f.value).unwrap_or(f64::NAN);
        assert!((value(&default, "H1") - 10.0).abs() < 1e-13 && (value(&default, "H2") - 2.0 / 1.1).abs() < 1e-14);
        assert!((value(&default, "H3") - 1.0).abs() < 1e-15);
        let literal = paper(&["material.conductivity=[[1, 1], [1, 1]]"])?;
        let h3 = literal.iter().find(|f| f.id == "H3");
        assert!(h3.is_some_and(|f| f.fails() && f.message.contains("0.000000, 2.000000") && f.value == Some(0.0)));
        Ok(())
    }

    #[test]
    fn an_identity_that_does_not_close_is_a_failure() {
        assert!(audit(1e-14, -1e-9)[1].fails() && !audit(1e-14, -1e-9)[0].fails());
        assert!(audit(f64::NAN, 0.0)[0].fails());
    }
}
