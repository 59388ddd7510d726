//! Files of separated values: a header, if there is one, and rows of as many entries.

/// The content of a file of separated values.
pub(crate) struct SeparatedValues {
    /// The titles of the columns; `None` if the first line holds numbers only.
    pub headers: Option<Vec<String>>,
    /// Number of columns.
    pub width: usize,
    /// The rows, with the number of the line of each from 1.
    pub rows: Vec<(usize, Vec<String>)>,
}

/// The reason why a file or an entry cannot be read.
#[derive(Debug, PartialEq)]
pub(crate) struct SeparatedFault {
    /// The text found, with its place.
    pub found: String,
    /// The text expected there.
    pub expected: String,
    /// What to write instead.
    pub hint: Option<String>,
}

impl SeparatedFault {
    /// A fault without a hint.
    pub fn new(found: String, expected: impl Into<String>) -> SeparatedFault {
        SeparatedFault { found, expected: expected.into(), hint: None }
    }
}

/// Reads the file `name`.
///
/// Values are separated by the first of `,` `;` and tab in the first line, else by blanks. The first line is a header
/// unless it holds numbers only. Empty lines and lines that begin with `#` are skipped.
///
/// # Errors
/// The line of the file, the text found there and the expected one.
pub(crate) fn read(name: &str, bytes: &[u8]) -> Result<SeparatedValues, SeparatedFault> {
    let text = text(name, bytes)?;
    let lines = text.lines().enumerate().map(|(i, line)| (i + 1, line.trim()));
    let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#')).peekable();
    let Some(&(first, line)) = lines.peek() else {
        return Ok(SeparatedValues { headers: None, width: 0, rows: Vec::new() });
    };
    let separator = [',', ';', '\t'].into_iter().find(|c| line.contains(*c));
    let fields = |line: &str| -> Vec<String> {
        let clean = |field: &str| field.trim().trim_matches('"').to_owned();
        match separator {
            Some(separator) => line.split(separator).map(clean).collect(),
            None => line.split_whitespace().map(clean).collect(),
        }
    };
    let head = fields(line);
    let width = head.len();
    let headers = if head.iter().any(|field| field.parse::<f64>().is_err()) {
        lines.next();
        Some(head)
    } else {
        None
    };
    let row = |(number, line): (usize, &str)| {
        let row = fields(line);
        if row.len() == width {
            return Ok((number, row));
        }
        let found = format!("{} entries in line {number} of {name}", row.len());
        Err(SeparatedFault::new(found, format!("{width}, as in line {first}")))
    };
    let rows = lines.map(row).collect::<Result<_, _>>()?;
    Ok(SeparatedValues { headers, width, rows })
}

fn text<'a>(name: &str, bytes: &'a [u8]) -> Result<&'a str, SeparatedFault> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.trim_start_matches('\u{feff}')),
        Err(error) => {
            let line = bytes.iter().take(error.valid_up_to()).filter(|b| **b == b'\n').count() + 1;
            let found = format!("bytes in line {line} of {name} that are no text");
            Err(SeparatedFault::new(found, "a table saved as UTF-8 text"))
        }
    }
}

/// The number in an entry of the column `title`.
///
/// # Errors
/// The entry with its place, if it is no finite number.
pub(crate) fn number(entry: &str, place: &str, title: impl Fn() -> String) -> Result<f64, SeparatedFault> {
    match entry.parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => {
            let hint = entry.contains(',').then(|| "decimals stand behind a point".to_owned());
            let fault = SeparatedFault::new(format!("\"{entry}\" {place}"), format!("a number in {}", title()));
            Err(SeparatedFault { hint, ..fault })
        }
    }
}
