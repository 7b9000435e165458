//! CSV: blocks of columns side by side, each with a time column of its own.
//!
//! [`text`] finds characters and delimiter, [`rows`] splits into cells, [`header`] finds names and clocks, [`table`]
//! turns rows into columns with [`number`] and [`stamp`].

mod header;
mod number;
mod rows;
mod stamp;
mod table;
mod text;
mod write;

use crate::error::require_names;
use crate::{CsvProblem, Finding, Format, Recording, RecordingError, Selection};
use header::{Head, Header};
use rows::Rows;
use table::Table;
use text::Text;
pub(crate) use text::is_text;
pub use write::encode_csv;

/// Decodes text; rows without a time column are `row_distance_s` apart, if that is known.
pub(crate) fn decode(
    name: &str,
    bytes: &[u8],
    selection: &Selection,
    row_distance_s: Option<f64>,
) -> Result<Recording, RecordingError> {
    let text = Text::decode(bytes);
    let delimiter = text::delimiter(&text.content, row_distance_s.is_some());
    let no_delimiter =
        || RecordingError::Csv { file: name.into(), line: 1, column: None, problem: CsvProblem::NoDelimiter };
    let delimiter = delimiter.ok_or_else(no_delimiter)?;
    let head = Head::read(name, Rows::new(&text.content, delimiter));
    let header = heading(&head, row_distance_s)?;
    let names = header.names();
    require_names(name, selection, names.iter().map(String::as_str))?;
    let Header { columns, comment, samples } = header;
    let mut table = Table::new(name, columns, selection, delimiter, row_distance_s);
    let mut findings: Vec<Finding> = text.assumed_latin1.then_some(Finding::AssumedLatin1).into_iter().collect();
    findings.extend(table.fill(samples)?);
    let decimal_comma = table.decimals.sign() == Some(b',');
    let content = table.finish(selection)?;
    findings.extend(content.findings);
    Ok(Recording {
        format: Format::Csv { delimiter: char::from(delimiter), decimal_comma },
        comment,
        start_time: content.start_time,
        rasters: content.rasters,
        channels: content.channels,
        findings,
    })
}

/// The heading with a time column, or one without where rows are a known time apart.
fn heading<'a>(head: &Head<'a>, row_distance_s: Option<f64>) -> Result<Header<'a>, RecordingError> {
    use CsvProblem::{NoData, NoHeader, NoTime};
    match (head.timed(), row_distance_s) {
        (Err(RecordingError::Csv { problem: NoTime { .. } | NoHeader | NoData, .. }), Some(_)) => head.untimed(),
        (header, _) => header,
    }
}
