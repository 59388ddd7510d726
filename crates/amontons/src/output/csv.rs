//! Tables with one row per step: `history.csv` and `probes.csv`.

use std::fmt::Write as _;
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::PathBuf;

use sha2::{Digest, Sha256};

use super::OutputError;
use super::files::{LONGEST, WrittenFile, hexadecimal, write_atomically};
use crate::machine;

/// Numbers in the shortest form that reads back to the same bits; counts without a decimal point.
pub(super) fn join(values: &[f64]) -> String {
    // No number is longer than -2.2250738585072014e-308.
    let mut row = String::with_capacity(25 * values.len());
    for v in values {
        let comma = if row.is_empty() { "" } else { "," };
        // Writing to a text does not fail.
        let _ =
            if v.fract() == 0.0 && v.abs() < 1e15 { write!(row, "{comma}{v:.0}") } else { write!(row, "{comma}{v:?}") };
    }
    row
}

/// A table with one row per step, as it grows.
#[derive(Debug)]
pub(super) struct StepTable {
    path: PathBuf,
    file: File,
    /// Length and hash of the file so far.
    bytes: u64,
    hash: Sha256,
}

impl StepTable {
    /// A file with a header and no rows.
    pub fn create(path: PathBuf, columns: &[String]) -> Result<StepTable, OutputError> {
        let header = columns.join(",") + "\n";
        StepTable::begin(path, &header)
    }

    /// The file of a run that continues after `steps` steps; later rows are cut off.
    pub fn reopen(path: PathBuf, columns: &[String], steps: usize) -> Result<StepTable, OutputError> {
        let text = machine::read_text(&path, LONGEST).map_err(OutputError::io("read", &path))?;
        let inconsistent =
            |found: String, expected: String| OutputError::Inconsistent { path: path.clone(), found, expected };
        // A line cut short by a crash has no line end; it is after the rows that count, or missing from them.
        let mut lines = text.split_inclusive('\n').filter(|line| line.ends_with('\n'));
        let header = columns.join(",");
        if lines.next().map(str::trim_end) != Some(header.as_str()) {
            return Err(inconsistent("another header".to_owned(), format!("\"{header}\"")));
        }
        let rows: Vec<&str> = lines.take(steps).collect();
        let in_order =
            rows.iter().enumerate().all(|(i, row)| row.split(',').next() == Some((i + 1).to_string().as_str()));
        if rows.len() < steps || !in_order {
            return Err(inconsistent(
                format!("{} rows", rows.len()),
                format!("a row for each of the {steps} steps of the checkpoint"),
            ));
        }
        StepTable::begin(path, &(header + "\n" + &rows.concat()))
    }

    /// A file with this text, to which rows are added.
    fn begin(path: PathBuf, text: &str) -> Result<StepTable, OutputError> {
        write_atomically(&path, |out| out.write_all(text.as_bytes()))?;
        let file = OpenOptions::new().append(true).open(&path).map_err(OutputError::io("open", &path))?;
        Ok(StepTable { path, file, bytes: text.len() as u64, hash: Sha256::new_with_prefix(text) })
    }

    /// Adds the row of a step in one piece.
    pub fn push(&mut self, values: &[f64]) -> Result<(), OutputError> {
        self.push_row(&join(values))
    }

    /// Adds a row that is written already.
    pub fn push_row(&mut self, row: &str) -> Result<(), OutputError> {
        let row = format!("{row}\n");
        self.file.write_all(row.as_bytes()).map_err(OutputError::io("write", &self.path))?;
        self.bytes += row.len() as u64;
        self.hash.update(&row);
        Ok(())
    }

    /// Length and hash of the file so far.
    pub fn written(&self) -> WrittenFile {
        WrittenFile { bytes: self.bytes, sha256: hexadecimal(&self.hash.clone().finalize()) }
    }

    /// Flushes the rows to the disk.
    pub fn sync(&self) -> Result<(), OutputError> {
        self.file.sync_data().map_err(OutputError::io("write", &self.path))
    }

    /// Notes the new path of a file that was moved.
    pub fn moved(&mut self, path: PathBuf) {
        self.path = path;
    }
}
