//! Names, units, and which columns are time.

use ::csv::StringRecord;

use super::text::plain_number;
use super::{Rows, line};
use crate::mdf::some_text;
use crate::{CsvProblem, RecordingError};

/// Lines before the first samples that are looked at.
const MAX_ROWS: usize = 200;

/// What stands above the samples.
pub(super) struct Header {
    pub(super) columns: Vec<Column>,
    pub(super) comment: Option<String>,
    /// Rows above the first samples.
    pub(super) rows: usize,
}

/// A column's heading.
#[derive(Debug, PartialEq)]
pub(super) struct Column {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) is_time: bool,
    /// Seconds per unit as a fraction, if this is time.
    pub(super) factor: (f64, f64),
}

impl Header {
    pub(super) fn find(rows: &Rows<'_>) -> Result<Self, RecordingError> {
        let above = rows_above(rows)?;
        let Some(last) = above.last() else {
            return Err(rows.error(1, None, CsvProblem::NoHeader));
        };
        refuse_numbers(rows, last)?;
        let unit_row = above.len().checked_sub(2).filter(|_| is_unit_row(last));
        let (names, units) = match unit_row {
            Some(names) => (&above[names], Some(last)),
            None => (last, None),
        };
        let before = unit_row.unwrap_or(above.len() - 1);
        let mut columns = headings(rows, names, units)?;
        mark_time(rows, line(names), &mut columns)?;
        Ok(Self { columns, comment: comment(&above[..before]), rows: above.len() })
    }
}

impl Header {
    /// The heading of a table that need not have a time column, nor names: then columns are called by their number.
    pub(super) fn find_untimed(rows: &Rows<'_>) -> Result<Self, RecordingError> {
        let above = rows_above(rows)?;
        let Some(last) = above.last() else {
            let mut first = StringRecord::new();
            rows.next(&mut rows.reader(), &mut first)?;
            let width = (0..first.len()).rfind(|&c| !first[c].trim().is_empty()).map_or(0, |c| c + 1);
            let numbered = |n: usize| Column {
                name: format!("column {n}"),
                unit: String::new(),
                is_time: false,
                factor: (1.0, 1.0),
            };
            return Ok(Self { columns: (1..=width).map(numbered).collect(), comment: None, rows: 0 });
        };
        refuse_numbers(rows, last)?;
        let columns = headings(rows, last, None)?;
        if columns.first().is_some_and(|column| is_time_name(&column.name)) {
            return Self::find(rows);
        }
        Ok(Self { columns, comment: comment(&above[..above.len() - 1]), rows: above.len() })
    }
}

/// The rows above the first that holds only numbers.
fn rows_above(rows: &Rows<'_>) -> Result<Vec<StringRecord>, RecordingError> {
    let mut reader = rows.reader();
    let mut row = StringRecord::new();
    let mut above: Vec<StringRecord> = Vec::new();
    while above.len() < MAX_ROWS && rows.next(&mut reader, &mut row)? {
        if is_numeric(&row) {
            return Ok(above);
        }
        above.push(row.clone());
    }
    let last = above.last().map_or(1, line);
    // A table in which a line mixes numbers and text is better explained by that cell.
    above.iter().skip(1).try_for_each(|row| refuse_numbers(rows, row))?;
    Err(rows.error(last, None, CsvProblem::NoData))
}

fn is_numeric(row: &StringRecord) -> bool {
    let mut filled = row.iter().map(str::trim).filter(|c| !c.is_empty()).peekable();
    filled.peek().is_some() && filled.all(|c| plain_number(c).is_some())
}

/// A row that begins with a number is one of samples, and everything in it has to be a number.
fn refuse_numbers(rows: &Rows<'_>, row: &StringRecord) -> Result<(), RecordingError> {
    let is_text = |c: &str| !c.trim().is_empty() && plain_number(c.trim()).is_none();
    let numbers = row.iter().filter(|c| plain_number(c.trim()).is_some()).count();
    let texts = row.iter().filter(|c| is_text(c)).count();
    let starts = row.get(0).is_some_and(|c| plain_number(c.trim()).is_some());
    let Some(column) = row.iter().position(is_text) else {
        return Ok(());
    };
    if !starts && numbers <= texts {
        return Ok(());
    }
    let text = row[column].trim().to_owned();
    Err(rows.error(line(row), Some(column), CsvProblem::NotANumber { text }))
}

fn is_unit_row(row: &StringRecord) -> bool {
    let first = row.get(0).map(unbracketed).unwrap_or_default();
    seconds(first).is_some() && !first.is_empty()
}

fn headings(
    rows: &Rows<'_>,
    names: &StringRecord,
    units: Option<&StringRecord>,
) -> Result<Vec<Column>, RecordingError> {
    let width = (0..names.len()).rfind(|&c| !names[c].trim().is_empty()).map_or(0, |c| c + 1);
    let heading = |(index, cell): (usize, &str)| {
        let (name, unit) = match units {
            Some(units) => (cell.trim(), unbracketed(units.get(index).unwrap_or_default())),
            None => name_and_unit(cell.trim()),
        };
        if name.is_empty() {
            return Err(rows.error(line(names), Some(index), CsvProblem::NoName));
        }
        Ok(Column { name: name.into(), unit: unit.into(), is_time: false, factor: (1.0, 1.0) })
    };
    names.iter().take(width).enumerate().map(heading).collect()
}

fn mark_time(rows: &Rows<'_>, line: u64, columns: &mut [Column]) -> Result<(), RecordingError> {
    let first = columns.first().map(|c| c.name.clone()).unwrap_or_default();
    for (index, column) in columns.iter_mut().enumerate() {
        let named = is_time_name(&column.name);
        let in_seconds = seconds(&column.unit);
        column.is_time = match index {
            0 => named || (in_seconds.is_some() && !column.unit.is_empty()),
            _ => (named || column.name == first) && in_seconds.is_some(),
        };
        if !column.is_time {
            if index == 0 {
                let name = column.name.clone();
                return Err(rows.error(line, Some(0), CsvProblem::NoTime { name }));
            }
            continue;
        }
        column.factor = in_seconds.ok_or_else(|| {
            let unit = column.unit.clone();
            rows.error(line, Some(index), CsvProblem::TimeUnit { unit })
        })?;
    }
    Ok(())
}

/// `time`, `t`, `Zeit`, `timestamp(s)`, also numbered or with a rate (`time_2`, `time 100 Hz`).
pub(crate) fn is_time_name(name: &str) -> bool {
    let name = name.trim().to_lowercase();
    let words = ["timestamps", "timestamp", "zeitstempel", "time stamp", "time", "zeit", "t"];
    let rest = words.iter().find_map(|w| name.strip_prefix(w));
    let Some(rest) = rest else {
        return false;
    };
    let number = rest.trim_start_matches(['_', ' ', '.', '-', '#']);
    let rate = number.trim_start_matches(|c: char| c.is_ascii_digit());
    rest.is_empty() || (rate.len() < number.len() && matches!(rate.trim(), "" | "hz" | "khz" | "ms" | "us" | "s"))
}

/// Seconds per unit as a fraction; no unit means seconds.
pub(crate) fn seconds(unit: &str) -> Option<(f64, f64)> {
    Some(match unit.trim() {
        "" | "s" | "S" | "sec" | "Sec" | "second" | "seconds" | "Sekunden" => (1.0, 1.0),
        "ms" | "msec" => (1.0, 1e3),
        "us" | "µs" | "μs" | "usec" => (1.0, 1e6),
        "ns" => (1.0, 1e9),
        "min" => (60.0, 1.0),
        "h" => (3600.0, 1.0),
        _ => return None,
    })
}

/// Splits `Name [unit]` and `Name (unit)`.
fn name_and_unit(cell: &str) -> (&str, &str) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        let inner = cell.strip_suffix(close).and_then(|c| c.rsplit_once(open));
        if let Some((name, unit)) = inner
            && !name.trim().is_empty()
        {
            return (name.trim(), unit.trim());
        }
    }
    (cell, "")
}

fn unbracketed(cell: &str) -> &str {
    let cell = cell.trim();
    let inner = |open, close| cell.strip_prefix(open)?.strip_suffix(close);
    inner('[', ']').or_else(|| inner('(', ')')).unwrap_or(cell).trim()
}

/// What stands above the names.
fn comment(rows: &[StringRecord]) -> Option<String> {
    let text = |row: &StringRecord| {
        let cells: Vec<&str> = row.iter().map(str::trim).filter(|c| !c.is_empty()).collect();
        cells.join(" ")
    };
    let lines: Vec<String> = rows.iter().map(text).filter(|l| !l.starts_with("sep=")).collect();
    some_text(&lines.join("\n"))
}
