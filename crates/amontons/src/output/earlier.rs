//! Results of an earlier run of the same inputs in a results folder: its certificate, and its summary if it was done.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::files::{LONGEST, WrittenFile, sha256, write_json};
use super::manifest::Manifest;
use super::names::{CERTIFICATE, SUMMARY};
use super::{Outcome, OutputError, Summary};
use crate::hypotheses::Finding;
use crate::machine;

/// `certificate.json`: the findings on the data, with version and inputs they depend on.
#[derive(Debug, Serialize, Deserialize)]
struct StoredCertificate {
    version: String,
    /// SHA-256 of the inputs, as in `manifest.json`.
    input_sha256: String,
    findings: Vec<Finding>,
}

/// Writes the certificate of a run with these inputs.
pub(super) fn write_certificate(
    folder: &Path,
    fingerprint: &str,
    findings: &[Finding],
) -> Result<WrittenFile, OutputError> {
    let (version, input_sha256) = (env!("CARGO_PKG_VERSION").to_owned(), sha256(fingerprint));
    write_json(&folder.join(CERTIFICATE), &StoredCertificate { version, input_sha256, findings: findings.to_vec() })
}

/// The certificate in a results folder, or `None` if it belongs to other inputs or another version of the program.
///
/// `fingerprint` is [`crate::case::Case::fingerprint`].
#[must_use]
pub fn known_certificate(folder: &Path, fingerprint: &str) -> Option<Vec<Finding>> {
    let text = machine::read_text(&folder.join(CERTIFICATE), LONGEST).ok()?;
    let kept: StoredCertificate = serde_json::from_str(&text).ok()?;
    (kept.version == env!("CARGO_PKG_VERSION") && kept.input_sha256 == sha256(fingerprint)).then_some(kept.findings)
}

/// True if the run in a results folder evaluates all hypotheses, or `None` if there is no run.
#[must_use]
pub fn has_certificate(folder: &Path) -> Option<bool> {
    Manifest::read(folder).ok().map(|manifest| manifest.settings().certificate)
}

/// The summary in a results folder of a finished run with these inputs and this version of the program, if any.
#[must_use]
pub fn finished_run(folder: &Path, fingerprint: &str) -> Option<Summary> {
    let manifest = Manifest::read(folder).ok()?;
    let summary: Summary = serde_json::from_str(&machine::read_text(&folder.join(SUMMARY), LONGEST).ok()?).ok()?;
    (manifest.is_of(fingerprint) && summary.outcome == Outcome::Done).then_some(summary)
}
