//! Measured values over time, from a file.

use crate::problem::Fault;
use crate::separated::{self, SeparatedFault};

/// Ending of the title of a column with standard deviations of another one.
const DEVIATION: &str = "_sigma";
/// Titles of the column of times.
const TIMES: [&str; 2] = ["t", "time"];

/// Values of outputs of a run that were measured.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredTable {
    /// The name of the file.
    pub name: String,
    /// The outputs, in the order of their columns.
    pub series: Vec<MeasuredSeries>,
}

/// The values of an output.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredSeries {
    /// The title of the column, which names the output.
    pub name: String,
    /// The values, as they come in the file.
    pub points: Vec<Measurement>,
}

/// A value of an output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement {
    /// Time, s.
    pub t: f64,
    /// The value, in the unit of the output.
    pub value: f64,
    /// Its standard deviation in the same unit; `None` if the file does not state it.
    pub deviation: Option<f64>,
}

impl MeasuredTable {
    /// Reads the file `name`: a column `t` with times, a column per output under its name, and beside it its standard
    /// deviation under the name with `_sigma`, for all outputs or for none. An entry may be empty where an output was
    /// not measured. Times may repeat and need not be in order.
    ///
    /// # Errors
    /// The line and column of what cannot be read, with what is expected there.
    pub fn parse(name: &str, bytes: &[u8]) -> Result<MeasuredTable, Fault> {
        let told = |fault: SeparatedFault| located(name, fault);
        let values = separated::read(name, bytes).map_err(told)?;
        let Some(headers) = values.headers else {
            let found = if values.width == 0 { "no rows" } else { "a first line of numbers" };
            return Err(Fault::new(name, found, "a header with `t` and the names of outputs"));
        };
        let time = time_column(name, &headers)?;
        let outputs = output_columns(name, &headers, time)?;
        let entry = |row: &[String], line: usize, column: usize| -> Result<Option<f64>, Fault> {
            let text = row.get(column).map_or("", String::as_str);
            if text.is_empty() {
                return Ok(None);
            }
            let title = || format!("the column \"{}\"", headers[column]);
            separated::number(text, &format!("in line {line}"), title).map(Some).map_err(told)
        };
        let mut series = Vec::new();
        for (column, deviations) in outputs {
            let mut points = Vec::new();
            for (line, row) in &values.rows {
                let Some(value) = entry(row, *line, column)? else { continue };
                let missing = |what: &str| {
                    let found = format!("no {what} in line {line}");
                    Fault::new(name, found, format!("a {what} for each value of {}", headers[column]))
                };
                let t = entry(row, *line, time)?.ok_or_else(|| missing("time"))?;
                let deviation = match deviations {
                    Some(of) => Some(entry(row, *line, of)?.ok_or_else(|| missing("standard deviation"))?),
                    None => None,
                };
                if let Some(deviation) = deviation.filter(|deviation| *deviation <= 0.0) {
                    let found = format!("the standard deviation {deviation:?} in line {line}");
                    return Err(Fault::new(name, found, "positive standard deviations"));
                }
                points.push(Measurement { t, value, deviation });
            }
            if points.is_empty() {
                let found = format!("no value in the column \"{}\"", headers[column]);
                return Err(Fault::new(name, found, "at least one").hint("remove the column"));
            }
            series.push(MeasuredSeries { name: headers[column].clone(), points });
        }
        Ok(MeasuredTable { name: name.to_owned(), series })
    }

    /// Number of values.
    #[must_use]
    pub fn count(&self) -> usize {
        self.series.iter().map(|series| series.points.len()).sum()
    }

    /// All values with the number of the series of each, series by series.
    pub fn all(&self) -> impl Iterator<Item = (usize, &Measurement)> {
        self.series.iter().enumerate().flat_map(|(i, series)| series.points.iter().map(move |point| (i, point)))
    }

    /// True if the file states how much its values spread.
    #[must_use]
    pub fn states_deviations(&self) -> bool {
        self.all().all(|(_, point)| point.deviation.is_some())
    }
}

fn located(name: &str, SeparatedFault { found, expected, hint }: SeparatedFault) -> Fault {
    let fault = Fault::new(name, found, expected);
    match hint {
        Some(hint) => fault.hint(hint),
        None => fault,
    }
}

fn time_column(name: &str, headers: &[String]) -> Result<usize, Fault> {
    let times: Vec<usize> = (0..headers.len()).filter(|&i| TIMES.contains(&headers[i].as_str())).collect();
    match times.as_slice() {
        [time] => Ok(*time),
        [] => {
            let found = format!("the columns {}", headers.join(", "));
            Err(Fault::new(name, found, "a column `t` with times in s, counted as in the run"))
        }
        _ => Err(Fault::new(name, "several columns of times", "one column `t`")),
    }
}

/// The columns of outputs, each with that of its standard deviations.
fn output_columns(name: &str, headers: &[String], time: usize) -> Result<Vec<(usize, Option<usize>)>, Fault> {
    let position = |title: &str| headers.iter().position(|header| header == title);
    let is_deviation = |title: &str| title.strip_suffix(DEVIATION).is_some_and(|of| position(of).is_some());
    let twice = (0..headers.len()).find(|&i| position(&headers[i]) != Some(i));
    if let Some(i) = twice {
        return Err(Fault::new(name, format!("two columns \"{}\"", headers[i]), "columns with different names"));
    }
    let outputs = (0..headers.len()).filter(|&i| i != time && !is_deviation(&headers[i]));
    let outputs: Vec<_> = outputs.map(|i| (i, position(&format!("{}{DEVIATION}", headers[i])))).collect();
    if outputs.is_empty() {
        return Err(Fault::new(name, "no column beside the times", "a column per output, under its name"));
    }
    let without = outputs.iter().find(|(_, deviations)| deviations.is_none());
    if let Some((i, _)) = without.filter(|_| outputs.iter().any(|(_, deviations)| deviations.is_some())) {
        let found = format!("no column \"{}{DEVIATION}\"", headers[*i]);
        return Err(Fault::new(name, found, "standard deviations of all outputs, or of none"));
    }
    Ok(outputs)
}
