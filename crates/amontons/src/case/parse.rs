//! Reads a case from its text, through the four gates.

use toml::de::DeTable;

use super::fault::{CaseError, Lines, Source};
use super::files::Files;
use super::identity::identity;
use super::overrides::Applied;
use super::path::Doubtful;
use super::place::{At, CaseOrigin, PathFault};
use super::request::AskedAccuracy;
use super::schema::rules;
use super::text::text as file_text;
use super::verify::{Expected, Verify};
use super::{build, check, library, mesh, overrides, path, raw, syntax};
use crate::convergence::Exact;
use crate::machine;
use crate::mesh::{RefinementRounds, Skipped};
use crate::output::{
    CheckpointInterval, FieldsFormat, FolderOptions, Identity, Input, OutputField, Probe, fingerprint,
};
use crate::problem::Problem;
use crate::stability::Search;

/// A case, ready to run.
#[derive(Clone, Debug)]
pub struct Case {
    /// The problem.
    pub problem: Problem,
    /// Steps between field snapshots; 0: only the last.
    pub every: usize,
    /// Fields of the snapshots in addition to the standard ones.
    pub fields: Vec<OutputField>,
    /// True if the discretization error is bounded at each snapshot.
    pub error: bool,
    /// Format of the fields of a finished run.
    pub format: FieldsFormat,
    /// The interval between checkpoints.
    pub checkpoint: CheckpointInterval,
    /// Values recorded after every step.
    pub probes: Vec<Probe>,
    /// Values that a run must reproduce.
    pub expected: Option<Expected>,
    /// The accuracy up to which `amontons run` refines cells and steps.
    pub accuracy: Option<AskedAccuracy>,
    /// The search for modes of the state at the end.
    pub stability: Search,
    /// The exact solution in closed form.
    pub exact: Option<Exact>,
    /// Reference values of a benchmark.
    pub verify: Option<Verify>,
    /// Cells per direction of a generated mesh; for a mesh file the parts of each edge.
    pub cells: Vec<usize>,
    /// Cells per direction of each of several blocks.
    pub blocks: Vec<Vec<usize>>,
    /// True if the mesh is read from a file.
    pub has_mesh_file: bool,
    /// Content of the mesh file that is not used.
    pub skipped: Vec<Skipped>,
    /// The text of the case as run: overrides applied, files referred to by the names in `inputs`.
    pub text: String,
    /// The files that the case refers to.
    pub inputs: Vec<Input>,
    /// The cells that `mesh.refined_cells` lists.
    pub rounds: Option<RefinementRounds>,
    /// The overrides that were applied.
    pub overrides: Vec<String>,
}

impl Case {
    /// Identifies the case by its text and the content of its files.
    #[must_use]
    pub fn fingerprint(&self) -> String {
        fingerprint(&self.text, &self.inputs)
    }

    /// The data that the states of a run of the case depend on.
    #[must_use]
    pub fn identity(&self) -> Identity {
        identity(&self.text, &self.inputs)
    }

    /// Options for writing the results of the case into a folder.
    #[must_use]
    pub fn folder_options(&self) -> FolderOptions {
        FolderOptions {
            inputs: self.inputs.clone(),
            identity: self.identity(),
            every: self.every,
            fields: self.fields.clone(),
            format: self.format,
            error: self.error,
            probes: self.probes.clone(),
            checkpoint: self.checkpoint,
            overrides: self.overrides.clone(),
            ..FolderOptions::new(&self.text)
        }
    }
}

/// Reads a case file; overrides are given as `KEY=VALUE`.
///
/// # Errors
/// [`CaseError::Read`] if the file cannot be read, [`CaseError::Faults`] if it or an override has faults.
pub fn read(path: &std::path::Path, overrides: &[String]) -> Result<Case, CaseError> {
    parse(&source(path)?, overrides)
}

/// The text of a case file with its name and its folder, to which names of files are relative.
///
/// # Errors
/// [`CaseError::Read`] if the file cannot be read.
pub fn source(path: &std::path::Path) -> Result<Source, CaseError> {
    let text = file_text(path).map_err(|source| CaseError::Read { path: path.to_owned(), source })?;
    let folder = path.parent().map(std::path::Path::to_owned).unwrap_or_default();
    Ok(Source { files: Files::Folder(folder), ..Source::new(path.display().to_string(), text) })
}

/// Reads a case from its text; overrides are given as `KEY=VALUE`.
///
/// # Errors
/// [`CaseError::Faults`] with all faults of the text and of the overrides.
pub fn parse(source: &Source, overrides: &[String]) -> Result<Case, CaseError> {
    let (document, errors) = DeTable::parse_recoverable(&source.text);
    if !errors.is_empty() {
        let errors = errors.iter().map(|e| (e.message().to_owned(), e.span())).collect();
        let syntax::SyntaxFaults { mut faults, only_duplicates } = syntax::faults(&source.text, errors);
        faults.extend(overrides::faults(overrides));
        // A text whose only faults are duplicate keys can be checked further, unless overrides could change it.
        if overrides.is_empty() && only_duplicates {
            let origin = CaseOrigin { lines: Lines::of(&source.text), document: document.get_ref(), overrides: &[] };
            faults.extend(
                build_case(document.get_ref(), &source.files, false)
                    .1
                    .into_iter()
                    .map(|finding| origin.locate(finding)),
            );
        }
        return Err(CaseError::faults(source, faults));
    }
    let applied = overrides::apply(&source.text, overrides)
        .map_err(|error| CaseError::faults(source, syntax::faults(&source.text, vec![error]).faults))?;
    let Applied { text, set, mut faults } = applied;
    let origin = CaseOrigin { lines: Lines::of(&source.text), document: document.get_ref(), overrides: &set };
    // An override may end the run before the times of checks in the file; `verify` reports those that it lacks.
    let has_other_end =
        set.iter().any(|(path, _)| matches!(path.to_string().as_str(), "time" | "time.end") || path.is_in("phase"));
    let (mut case, findings) = match DeTable::parse(&text) {
        Ok(changed) => build_case(changed.get_ref(), &source.files, has_other_end),
        Err(error) => (None, vec![whole(error.message())]),
    };
    faults.extend(findings.into_iter().map(|finding| origin.locate(finding)));
    if let (Some((case, _)), Some(backend)) = (&mut case, source.backend.get()) {
        case.problem = case.problem.solved_by(backend);
    }
    match case {
        Some((mut case, references)) if faults.is_empty() => {
            case.overrides = overrides.to_vec();
            case.text = overrides::refer(&text, &references)
                .map_err(|error| CaseError::faults(source, syntax::faults(&source.text, vec![error]).faults))?;
            Ok(case)
        }
        _ => Err(CaseError::faults(source, faults)),
    }
}

/// A finding about the file as a whole.
fn whole(found: impl Into<String>) -> PathFault {
    PathFault::new(path::Path::default(), At::Value, found, "a case file")
}

/// Keys of a case that name files, with their values for the copies.
type References = Vec<(path::Path, String)>;

/// Checks and builds the case of a document with overrides applied. Without a case there are findings.
fn build_case(
    document: &DeTable<'_>,
    files: &Files,
    has_other_end: bool,
) -> (Option<(Case, References)>, Vec<PathFault>) {
    let check::Checked { value, mut findings, doubtful, limits, scale } = check::check(&rules(), document);
    let mut raw: raw::Case = match serde_json::from_value(value) {
        Ok(raw) => raw,
        Err(error) => {
            // Schema and types are derived from one source, so this error shows a gap between them.
            findings.push(whole(error.to_string()));
            return (None, findings);
        }
    };
    library::fill(&mut raw, &mut findings);
    let (every, fields, format) = (raw.output.every, build::fields(&raw.output), build::format(&raw.output));
    let (error, checkpoint) = (raw.output.error, build::checkpoint(&raw.output));
    let expected = raw.expected.as_ref().map(build::expected);
    let (cells, has_mesh_file) = (mesh::cells(&raw.mesh), matches!(raw.mesh, raw::Mesh::File { .. }));
    let blocks = mesh::blocks(&raw.mesh);
    let doubtful = Doubtful::new(doubtful);
    let notes = build::SchemaNotes { doubtful: &doubtful, limits: &limits, scale };
    let (built, later) = build::problem(raw, files, machine::memory(), notes, has_other_end);
    findings.extend(later);
    let case = built.map(
        |build::Built { problem, probes, accuracy, stability, exact, verify, inputs, references, skipped, rounds }| {
            (
                Case {
                    problem,
                    every,
                    fields,
                    format,
                    error,
                    checkpoint,
                    probes,
                    expected,
                    accuracy,
                    stability,
                    exact,
                    verify,
                    cells,
                    blocks,
                    has_mesh_file,
                    skipped,
                    rounds,
                    text: String::new(),
                    inputs,
                    overrides: Vec::new(),
                },
                references,
            )
        },
    );
    (case, findings)
}
