//! Findings of two kinds: warnings to act on, with place and repair, and one line on the limits of the theory.

use amontons::hypotheses::{Finding, Kind};

/// Warnings in full, and a line on the theory.
pub fn of_run(findings: &[Finding]) -> Vec<String> {
    let mut lines: Vec<String> = findings.iter().filter(|f| f.warns()).flat_map(warning).collect();
    lines.extend(not_covered(findings));
    lines
}

/// A warning with its place and repair: `Warning (strain): …`.
fn warning(finding: &Finding) -> Vec<String> {
    let mut lines = vec![format!("Warning ({}): {} ({})", finding.id, finding.message, finding.place)];
    lines.extend(finding.repair.iter().map(|repair| format!("  to repair it: {repair}")));
    lines
}

/// The ids of the hypotheses of the theory that do not hold.
fn not_covered(findings: &[Finding]) -> Option<String> {
    let ids: Vec<&str> =
        findings.iter().filter(|f| f.kind == Kind::Theory && !f.holds()).map(|f| f.id.as_str()).collect();
    (!ids.is_empty()).then(|| format!("Not covered by the theory: {}; see `amontons check`", ids.join(", ")))
}
