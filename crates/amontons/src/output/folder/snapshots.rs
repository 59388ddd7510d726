//! The snapshots of a run: written, kept when it continues, and packed when it has ended.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::Path;

use super::super::columns::{contact_measures, contact_rows};
use super::super::files::LONGEST;
use super::super::files::{WrittenFile, create_folder, remove_empty_folder, remove_file, write_atomically};
use super::super::names::HISTORY;
use super::super::names::{
    CONTACT_FOLDER, ERROR, FIELDS, FIELDS_FOLDER, PACKED, SIDES, contact_file, fields_file, sides_file,
};
use super::super::packed::{self, FieldsFormat, Packed};
use super::super::vtu::{write_collection, write_fields};
use super::super::{OutputError, Snapshot, StressRecovery, owned, surface};
use super::Folder;
use crate::machine;
use crate::problem::Problem;

/// True if a snapshot is due at a step: every so many steps, and at the end of each phase.
pub(super) fn is_due(every: usize, ends: &[usize], step: usize) -> bool {
    every > 0 && step.is_multiple_of(every) || ends.contains(&step)
}

/// Writes the contact points, one row per point.
pub(super) fn write_contact(path: &Path, now: &Snapshot) -> Result<WrittenFile, OutputError> {
    let names: Vec<String> = contact_measures(now.problem).into_iter().map(|(name, _)| name).collect();
    write_atomically(path, |out| {
        writeln!(out, "{}", names.join(","))?;
        contact_rows(now).iter().try_for_each(|row| writeln!(out, "{row}"))
    })
}

impl Folder {
    pub(super) fn write_fields(&mut self, now: &Snapshot) -> Result<(), OutputError> {
        let root = self.root();
        let file = fields_file(now.state.step);
        if self.recovery.is_none() && now.problem.physics.has_mechanics() {
            self.recovery = Some(StressRecovery::new(&now.problem.mesh));
        }
        let found = if self.options.error { self.errors.take(now) } else { None };
        let (fields, recovery) = (&self.options.fields, self.recovery.as_ref());
        let written = write_fields(&root.join(&file), now, fields, recovery, found.as_ref())?;
        self.manifest.list(&file, Some(written));
        if found.is_some() {
            let written = self.errors.write(&root.join(ERROR))?;
            self.manifest.list(ERROR, Some(written));
        }
        if let Some(report) = now.report.filter(|_| !now.problem.contacts.is_empty()) {
            create_folder(&root.join(CONTACT_FOLDER))?;
            let (table, sides) = (contact_file(now.state.step), sides_file(now.state.step));
            let written = write_contact(&root.join(&table), now)?;
            self.manifest.list(&table, Some(written));
            let written = surface::write(&root.join(&sides), now, &report.contact)?;
            self.manifest.list(&sides, Some(written));
            self.surfaces.push((now.state.t, sides));
        }
        self.snapshots.push((now.state.step, now.state.t));
        self.write_collections()
    }

    /// Writes the fields of the last step unless they are there.
    pub(super) fn write_last_fields(&mut self, last: &Snapshot) -> Result<(), OutputError> {
        let is_there = self.snapshots.last().is_some_and(|(newest, _)| *newest == last.state.step);
        if is_there { Ok(()) } else { self.write_fields(last) }
    }

    fn write_collections(&mut self) -> Result<(), OutputError> {
        let fields: Vec<(f64, String)> = self.snapshots.iter().map(|&(step, t)| (t, fields_file(step))).collect();
        for (name, files) in [(FIELDS, &fields), (SIDES, &self.surfaces)] {
            if name != FIELDS && files.is_empty() {
                remove_file(&self.root().join(name))?;
            } else {
                let written = write_collection(&self.root().join(name), files)?;
                self.manifest.list(name, Some(written));
            }
        }
        Ok(())
    }

    /// Keeps the snapshots up to a step and removes the others. Packed snapshots become separate files; the packed file
    /// stays.
    ///
    /// Snapshots that were due or are listed as written are kept, but not one written only because the run ended.
    pub(super) fn keep_snapshots(&mut self, problem: &Problem, step: usize) -> Result<(), OutputError> {
        let (every, passing) = (self.manifest.settings().every, self.manifest.passing());
        let (before, ends) = (self.manifest.clone(), self.phase_ends.clone());
        let listed: Vec<(&str, Option<&WrittenFile>)> = before.outputs();
        let counts = |n: usize, name: &str| {
            let is_kept = || is_due(every, &ends, n) || listed.iter().any(|(other, _)| *other == name);
            n <= step && passing != Some(n) && is_kept()
        };
        // A run killed while packing has not listed the packed file with a hash.
        let is_packed = listed.iter().any(|(name, written)| *name == PACKED && written.is_some());
        let was_packed = |n: usize| is_packed && n <= step && passing != Some(n);
        create_folder(&self.path.join(FIELDS_FOLDER))?;
        let unpacked: BTreeSet<usize> =
            packed::unpack(&self.path, |n| was_packed(n) || counts(n, &fields_file(n)))?.into_iter().collect();
        let snapshot =
            |name: &str| [FIELDS_FOLDER, CONTACT_FOLDER].iter().any(|folder| name.starts_with(&format!("{folder}/")));
        // The packed file is removed when the manifest lists its snapshots.
        self.manifest.retain(|name| !snapshot(name) && name != PACKED);
        let times = self.times(problem)?;
        let time = |n: usize| times.get(n).copied().unwrap_or_else(|| problem.timeline.time(n));
        for (n, name) in owned::snapshots(&self.path) {
            let path = self.path.join(&name);
            let is_unpacked = name == fields_file(n) && unpacked.contains(&n);
            if !is_unpacked && !counts(n, &name) {
                remove_file(&path)?;
                continue;
            }
            let written = match listed.iter().find(|(other, _)| *other == name) {
                Some((_, Some(written))) => (*written).clone(),
                _ => WrittenFile::read(&path).map_err(OutputError::io("read", &path))?,
            };
            self.manifest.list(&name, Some(written));
            if name == fields_file(n) {
                self.snapshots.push((n, time(n)));
            } else if name == sides_file(n) {
                self.surfaces.push((time(n), name));
            }
        }
        let due = (0..=step).filter(|&n| is_due(every, &ends, n) && passing != Some(n));
        for n in due.filter(|n| !self.snapshots.iter().any(|(other, _)| other == n)) {
            let name = fields_file(n);
            self.notes.push(format!("{name} of the run before is gone; {FIELDS} leaves it out"));
            self.manifest.list(&name, None);
        }
        self.write_collections()
    }

    /// The times of the steps in `history.csv`, t = 0 first, if the steps are chosen; else none.
    fn times(&self, problem: &Problem) -> Result<Vec<f64>, OutputError> {
        if !problem.timeline.is_automatic() {
            return Ok(Vec::new());
        }
        let path = self.path.join(HISTORY);
        let text = machine::read_text(&path, LONGEST).map_err(OutputError::io("read", &path))?;
        let mut rows = text.lines().map(|line| line.split(','));
        let column = rows.next().and_then(|mut names| names.position(|name| name == "t")).unwrap_or(0);
        let times = rows.map_while(|mut row| row.nth(column)?.parse().ok());
        Ok(std::iter::once(0.0).chain(times).collect())
    }

    /// Packs the snapshots of a finished run if requested. Snapshots that do not form one series stay, with a note.
    ///
    /// The files of the snapshots are removed after the packed file is on the disk under its name.
    pub(super) fn pack(&mut self) -> Result<(), OutputError> {
        let format = self.options.format;
        if format == FieldsFormat::Vtu || self.snapshots.is_empty() {
            return Ok(());
        }
        match packed::pack(&self.path, &self.snapshots, self.manifest.units_of(FIELDS))? {
            Packed::Written(written) => self.manifest.list(PACKED, Some(written)),
            Packed::Refused(why) => {
                self.notes.push(format!("{PACKED} is not written: {why}; the fields are in {FIELDS}"));
                return Ok(());
            }
        }
        if format == FieldsFormat::Vtkhdf {
            remove_file(&self.path.join(FIELDS))?;
            for &(step, _) in &self.snapshots {
                remove_file(&self.path.join(fields_file(step)))?;
            }
            remove_empty_folder(&self.path.join(FIELDS_FOLDER));
            let packed: Vec<String> = self.snapshots.iter().map(|&(step, _)| fields_file(step)).collect();
            self.manifest.retain(|name| name != FIELDS && !packed.iter().any(|file| file == name));
        }
        Ok(())
    }
}
