//! Times and values from a file of separated values.

use super::nearest::meant;
use super::raw::Column;
use crate::separated::{self, SeparatedFault, SeparatedValues};

/// The reason why a file gives no times and values: the key of the case concerned, and the message.
#[derive(Debug, PartialEq)]
pub(super) struct TableRefusal {
    pub key: &'static str,
    pub found: String,
    pub expected: String,
    pub hint: Option<String>,
}

fn refuse<T>(
    key: &'static str,
    found: String,
    expected: impl Into<String>,
    hint: Option<String>,
) -> Result<T, TableRefusal> {
    Err(TableRefusal { key, found, expected: expected.into(), hint })
}

/// Two columns of the file `name`: increasing times, and values.
///
/// # Errors
/// The line of the file, the text found there and the expected one.
pub(super) fn read(
    name: &str,
    bytes: &[u8],
    time: Option<&Column>,
    value: Option<&Column>,
) -> Result<(Vec<f64>, Vec<f64>), TableRefusal> {
    let SeparatedValues { headers, width, rows } = separated::read(name, bytes)?;
    if width == 0 {
        return refuse("table", format!("no rows in {name}"), "a time and a value per row", None);
    }
    let headers = headers.as_deref();
    let time = find(name, "time", time, 1, headers, width)?;
    let value = find(name, "column", value, 2, headers, width)?;
    let title = |column: usize| {
        headers
            .map_or_else(|| format!("column {}", column + 1), |headers| format!("the column \"{}\"", headers[column]))
    };
    let (mut times, mut values) = (Vec::new(), Vec::new());
    for (number, row) in rows {
        for (column, into) in [(time, &mut times), (value, &mut values)] {
            let place = format!("in line {number} of {name}");
            into.push(separated::number(&row[column], &place, || title(column))?);
        }
        if let [.., before, last] = times.as_slice()
            && last <= before
        {
            return refuse(
                "table",
                format!("the time {last:?} after {before:?} in line {number} of {name}"),
                "times that increase",
                None,
            );
        }
    }
    if times.is_empty() {
        return refuse("table", format!("no rows in {name}"), "a time and a value per row", None);
    }
    Ok((times, values))
}

impl From<SeparatedFault> for TableRefusal {
    fn from(fault: SeparatedFault) -> TableRefusal {
        let SeparatedFault { found, expected, hint } = fault;
        TableRefusal { key: "table", found, expected, hint }
    }
}

/// The index of a column given by header or number.
fn find(
    name: &str,
    key: &'static str,
    column: Option<&Column>,
    otherwise: usize,
    headers: Option<&[String]>,
    count: usize,
) -> Result<usize, TableRefusal> {
    let number = match column {
        Some(Column::Name(wanted)) => {
            let Some(headers) = headers else {
                let found = format!("\"{wanted}\", but {name} has no header");
                return refuse(key, found, format!("the number of a column from 1 to {count}"), None);
            };
            let Some(index) = headers.iter().position(|header| header == wanted) else {
                let known: Vec<&str> = headers.iter().map(String::as_str).collect();
                let hint = meant(wanted, &known);
                return refuse(
                    key,
                    format!("\"{wanted}\""),
                    format!("one of the columns {} of {name}", known.join(", ")),
                    hint,
                );
            };
            return Ok(index);
        }
        Some(Column::Number(number)) => *number,
        None => otherwise,
    };
    if (1..=count).contains(&number) {
        return Ok(number - 1);
    }
    // A fault of a default column concerns the file.
    let key = if column.is_some() { key } else { "table" };
    refuse(key, format!("{count} columns in {name}"), format!("at least {number}"), None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn separators_headers_comments_and_blanks() {
        let expected = Ok((vec![0.0, 1.5], vec![2.0, -3e2]));
        for text in [
            "t,f\n0,2\n1.5,-3e2\n",
            "0;2\n1.5;-3e2",
            "# a force\n\nt\tf\r\n0\t2\r\n1.5\t-300.0\r\n",
            "\u{feff}\"t\" , \"f\"\n 0 , 2 \n1.5,-300",
            "0  2\n 1.5   -300",
        ] {
            assert_eq!(read("f.csv", text.as_bytes(), None, None), expected, "{text}");
        }
        let by =
            |column| read("f.csv", b"f,x,t\n2,9,0\n-300,9,1.5", Some(&Column::Name("t".to_owned())), Some(&column));
        assert_eq!(by(Column::Number(1)), expected);
        assert_eq!(by(Column::Name("f".to_owned())), expected);
    }
}
