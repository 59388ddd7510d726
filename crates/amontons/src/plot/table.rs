//! Reads the tables of a results folder: comma-separated values below a line of names.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::PlotError;
use super::contact::ContactTable;
use crate::machine;
use crate::output::LONGEST;

/// The text of a file.
pub(super) fn text(path: &Path) -> Result<String, PlotError> {
    machine::read_text(path, LONGEST).map_err(|source| PlotError::Read { path: path.to_owned(), source })
}

/// A table with named columns.
#[derive(Clone, Debug)]
pub(super) struct CsvTable {
    path: PathBuf,
    names: Vec<String>,
    rows: Vec<Vec<String>>,
}

/// The cells of a line; a quoted cell may contain commas, and doubled quotes for a quote.
fn cut(line: &str) -> Vec<String> {
    let mut cells = vec![String::new()];
    let (mut quoted, mut chars) = (false, line.chars().peekable());
    while let Some(c) = chars.next() {
        match (c, cells.last_mut()) {
            ('"', Some(cell)) if quoted && chars.peek() == Some(&'"') => cell.extend(chars.next()),
            ('"', _) => quoted = !quoted,
            (',', _) if !quoted => cells.push(String::new()),
            (_, Some(cell)) => cell.push(c),
            (_, None) => {}
        }
    }
    cells.iter().map(|cell| cell.trim().to_owned()).collect()
}

impl CsvTable {
    pub(super) fn read(path: &Path) -> Result<CsvTable, PlotError> {
        let text = text(path)?;
        let mut lines = text.lines();
        let names = lines.next().map(cut).unwrap_or_default();
        let mut table = CsvTable { path: path.to_owned(), names, rows: Vec::new() };
        for line in lines.filter(|line| !line.trim().is_empty()) {
            let row = cut(line);
            if row.len() != table.names.len() {
                let found = format!("{} values under {} names", row.len(), table.names.len());
                return Err(table.fault_of_row(table.rows.len(), &found));
            }
            table.rows.push(row);
        }
        Ok(table)
    }

    pub(super) fn names(&self) -> &[String] {
        &self.names
    }

    /// The cells row by row.
    pub(super) fn cells(&self) -> &[Vec<String>] {
        &self.rows
    }

    fn fault_of_row(&self, row: usize, what: &str) -> PlotError {
        PlotError::Format { path: self.path.clone(), what: format!("row {}: {what}", row + 1) }
    }

    /// The cells of a column.
    pub(super) fn column<T: FromStr>(&self, name: &str) -> Result<Vec<T>, PlotError> {
        let missing = || PlotError::Format { path: self.path.clone(), what: format!("it has no column {name}") };
        let c = self.names.iter().position(|n| n == name).ok_or_else(missing)?;
        let cell = |(r, row): (usize, &Vec<String>)| {
            row[c].parse().map_err(|_| self.fault_of_row(r, &format!("{name} is `{}`", row[c])))
        };
        self.rows.iter().enumerate().map(cell).collect()
    }

    /// A column of finite numbers.
    pub(super) fn numbers(&self, name: &str) -> Result<Vec<f64>, PlotError> {
        let values: Vec<f64> = self.column(name)?;
        match values.iter().position(|v| !v.is_finite()) {
            Some(row) => Err(self.fault_of_row(row, &format!("{name} is {}", values[row]))),
            None => Ok(values),
        }
    }
}

impl ContactTable for CsvTable {
    fn rows(&self) -> usize {
        self.rows.len()
    }
    fn has(&self, name: &str) -> bool {
        self.names.iter().any(|n| n == name)
    }
    fn is_empty(&self, name: &str) -> bool {
        let column = self.names.iter().position(|n| n == name);
        column.is_none_or(|c| !self.rows.is_empty() && self.rows.iter().all(|row| row[c].is_empty()))
    }
    fn numbers(&self, name: &str) -> Result<Vec<f64>, PlotError> {
        CsvTable::numbers(self, name)
    }
    fn optional_numbers(&self, name: &str) -> Result<Vec<f64>, PlotError> {
        if !self.has(name) {
            return Ok(vec![f64::NAN; self.rows()]);
        }
        let words: Vec<String> = self.column(name)?;
        let number = |(row, word): (usize, &String)| match word.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ if word.is_empty() => Ok(f64::NAN),
            _ => Err(self.fault_of_row(row, &format!("{name} is {word}"))),
        };
        words.iter().enumerate().map(number).collect()
    }
    fn words(&self, name: &str) -> Result<Vec<String>, PlotError> {
        self.column(name)
    }
    fn fault(&self, what: String) -> PlotError {
        PlotError::Format { path: self.path.clone(), what }
    }
}
