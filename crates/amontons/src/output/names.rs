//! The names of the files and folders in a results folder.

/// The case as it was run, and the folder with copies of the files that it refers to.
pub(crate) const CASE: &str = "case.toml";
/// Folder of the copies in a results folder.
pub const INPUTS: &str = "inputs";
/// Program, inputs and settings.
pub(super) const MANIFEST: &str = "manifest.json";
/// The findings on the data.
pub(super) const CERTIFICATE: &str = "certificate.json";
/// The summary of the run.
pub(crate) const SUMMARY: &str = "summary.json";
/// One row per step.
pub(crate) const HISTORY: &str = "history.csv";
/// The bounds of the discretization error, one row per snapshot.
pub(crate) const ERROR: &str = "error.csv";
/// The meshes of a run for an accuracy, and the bars of its numbers.
pub const ACCURACY: &str = "accuracy.csv";
/// See [`ACCURACY`].
pub const BARS: &str = "bars.csv";
/// The values of the probes, one row per step.
pub(crate) const PROBES: &str = "probes.csv";
/// One row per contact point after the last step.
pub(crate) const CONTACT: &str = "contact.csv";
/// The lists of the snapshots of the fields and of the sides of contact.
pub(crate) const FIELDS: &str = "fields.pvd";
pub(crate) const SIDES: &str = "contact.pvd";
/// The fields of all snapshots in one file.
pub(crate) const PACKED: &str = "fields.vtkhdf";
/// The newest checkpoint, the one before, and the name under which a checkpoint is written before it is the newest.
pub(super) const CHECKPOINT: &str = "checkpoint/state.bin";
pub(super) const PREVIOUS_CHECKPOINT: &str = "checkpoint/previous.bin";
pub(super) const NEWER_CHECKPOINT: &str = "checkpoint/newer.bin";

/// Folders of the field snapshots, of the contact points at their times, and of the checkpoints.
pub(super) const FIELDS_FOLDER: &str = "fields";
pub(super) const CONTACT_FOLDER: &str = "contact";
pub(super) const CHECKPOINT_FOLDER: &str = "checkpoint";

/// The files that a run may write, except copies of inputs and snapshots.
pub(super) const FILES: [&str; 16] = [
    CASE,
    CERTIFICATE,
    HISTORY,
    PROBES,
    ERROR,
    ACCURACY,
    BARS,
    CONTACT,
    SIDES,
    FIELDS,
    PACKED,
    SUMMARY,
    CHECKPOINT,
    PREVIOUS_CHECKPOINT,
    NEWER_CHECKPOINT,
    MANIFEST,
];
/// The folders that a run may make.
pub(super) const FOLDERS: [&str; 4] = [FIELDS_FOLDER, CONTACT_FOLDER, CHECKPOINT_FOLDER, INPUTS];
/// The folders of the snapshots, and the endings of the files in each.
pub(super) const SNAPSHOTS: [(&str, &str); 3] =
    [(FIELDS_FOLDER, "vtu"), (CONTACT_FOLDER, "csv"), (CONTACT_FOLDER, "vtu")];

/// Path of the fields at a step.
pub(crate) fn fields_file(step: usize) -> String {
    format!("{FIELDS_FOLDER}/step_{step:07}.vtu")
}

/// Path of the contact points at a step.
pub(crate) fn contact_file(step: usize) -> String {
    format!("{CONTACT_FOLDER}/step_{step:07}.csv")
}

/// Path of the sides of contact at a step.
pub(super) fn sides_file(step: usize) -> String {
    format!("{CONTACT_FOLDER}/step_{step:07}.vtu")
}

/// The step of a snapshot by its name: 3 of `step_0000003.vtu`.
pub(super) fn step_of(name: &str, ending: &str) -> Option<usize> {
    let digits = name.strip_prefix("step_")?.strip_suffix(ending)?.strip_suffix('.')?;
    (digits.len() >= 7 && digits.bytes().all(|b| b.is_ascii_digit())).then(|| digits.parse().ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn snapshots_are_told_by_their_names() {
        assert_eq!(step_of("step_0000003.vtu", "vtu"), Some(3));
        assert_eq!(step_of("step_12345678.csv", "csv"), Some(12_345_678));
        for other in ["step_3.vtu", "step_0000003.csv", "step_000000a.vtu", "my_step_0000003.vtu", "step_0000003vtu"] {
            assert_eq!(step_of(other, "vtu"), None, "{other}");
        }
    }
}
