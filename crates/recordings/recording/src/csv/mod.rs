//! CSV: blocks of columns side by side, each with a time column of its own.
//!
//! [`text`] finds characters and delimiter, [`rows`] splits into cells, [`header`] finds names, and with
//! [`clocks`] the clocks, [`table`] turns rows into columns with [`number`] and [`stamp`]. [`part`] reads some rows, by
//! an [`index`] of all.

mod clocks;
mod header;
mod index;
mod number;
mod part;
mod rows;
mod stamp;
mod stamps;
mod table;
mod text;
mod write;

use crate::required::require_names;
use crate::{Catalogue, CsvProblem, Finding, Format, Recording, RecordingError, Selection, Source};
use header::{Head, Header};
pub(crate) use part::Indexed;
use rows::{MAX_QUOTED, Rows};
use table::{Content, Table};
use text::Pieces;
pub(crate) use text::is_text;
use work::Context;
pub use write::{encode_csv, encode_tsv, fits_text, write_csv, write_tsv};

/// Bytes in which the heading is looked for.
const HEAD: usize = 1 << 24;
/// Lines that are enough to find it, and the kinds of columns, for a list.
const LISTED_LINES: usize = 1000;

/// Decodes text; rows without a time column are `row_distance_s` apart, if that is known.
pub(crate) fn decode(
    name: &str,
    source: &dyn Source,
    selection: &Selection,
    row_distance_s: Option<f64>,
    context: &Context,
) -> Result<Recording, RecordingError> {
    let opened = Opened::open(name, source, selection, row_distance_s, false)?;
    let Opened { pieces, text, mut table, place, delimiter, comment, mut findings, .. } = opened;
    table.expect(pieces.lines().unwrap_or(0), pieces.progress().1);
    findings.extend(fill(&mut table, pieces, text, (place, delimiter), context)?);
    table.check()?;
    finished(table, delimiter, comment, findings, selection)
}

/// Lists the channels of text from its beginning. Where more follows, it is not known how many samples there are, and
/// no column is known to hold text that is empty so far.
pub(crate) fn catalogue(
    name: &str,
    source: &dyn Source,
    row_distance_s: Option<f64>,
) -> Result<Catalogue, RecordingError> {
    let Opened { pieces, text, mut table, place, delimiter, comment, mut findings, .. } =
        Opened::open(name, source, &Selection::All, row_distance_s, true)?;
    let is_whole = pieces.is_done();
    let limit = if is_whole { text.len() } else { text.len().saturating_sub(2 * MAX_QUOTED) };
    let filled = table.fill(Rows::resume(&text, delimiter, place), limit, usize::MAX)?;
    if is_whole {
        findings.extend(filled.finding);
        table.check()?;
    }
    let mut catalogue = finished(table, delimiter, comment, findings, &Selection::All)?.catalogue();
    if !is_whole {
        catalogue.rasters.iter_mut().for_each(|raster| raster.samples = None);
    }
    Ok(catalogue)
}

/// Text whose heading is read.
struct Opened<'a> {
    pieces: Pieces<'a>,
    /// Where the text begins in the file.
    begin: u64,
    /// Text that has been read.
    text: String,
    table: Table,
    /// Where in it the samples begin, and in which line.
    place: (usize, u64),
    delimiter: u8,
    comment: Option<String>,
    findings: Vec<Finding>,
}

impl<'a> Opened<'a> {
    fn open(
        name: &'a str,
        source: &'a dyn Source,
        selection: &Selection,
        row_distance_s: Option<f64>,
        is_list: bool,
    ) -> Result<Self, RecordingError> {
        let mut pieces = Pieces::open(name, source, is_list)?;
        let (begin, _) = pieces.progress();
        let mut text = String::new();
        let is_enough = |text: &str| text.len() >= HEAD || (is_list && text.lines().nth(LISTED_LINES).is_some());
        while !pieces.is_done() && !is_enough(&text) {
            pieces.more(&mut text)?;
        }
        let no_delimiter =
            || RecordingError::Csv { file: name.into(), line: 1, column: None, problem: CsvProblem::NoDelimiter };
        let delimiters = text::delimiters(&text, row_distance_s.is_some());
        let headings =
            || delimiters.iter().map(|&delimiter| (delimiter, heading(name, &text, delimiter, row_distance_s)));
        let understood = headings().find(|(_, header)| !is_no_table(header)).or_else(|| headings().next());
        let (delimiter, header) = understood.ok_or_else(no_delimiter)?;
        let header = header?;
        require_names(name, selection, table::names(&header.columns))?;
        let Header { columns, echoes, comment, samples } = header;
        let place = samples.place();
        let table = Table::new(name, columns, selection, delimiter, row_distance_s).with_echoes(echoes);
        let findings = pieces.findings();
        Ok(Self { pieces, begin, text, table, place, delimiter, comment, findings })
    }
}

fn finished(
    table: Table,
    delimiter: u8,
    comment: Option<String>,
    findings: Vec<Finding>,
    selection: &Selection,
) -> Result<Recording, RecordingError> {
    let decimal_comma = table.decimals.sign() == Some(b',');
    let format = Format::Csv { delimiter: char::from(delimiter), decimal_comma };
    Ok(recording(format, comment, findings, table.finish(selection)?))
}

fn recording(format: Format, comment: Option<String>, mut findings: Vec<Finding>, content: Content) -> Recording {
    findings.extend(content.findings);
    Recording {
        format,
        comment,
        start_time: content.start_time,
        rasters: content.rasters,
        channels: content.channels,
        findings,
    }
}

/// Reads the rows from a place in the first piece to the end of the last.
fn fill(
    table: &mut Table,
    mut pieces: Pieces<'_>,
    mut text: String,
    (mut place, delimiter): ((usize, u64), u8),
    context: &Context,
) -> Result<Option<Finding>, RecordingError> {
    loop {
        let (done, all) = pieces.progress();
        context.reach(done, all);
        let is_last = pieces.is_done();
        // Whether a quote ends shows only in what follows.
        let limit = if is_last { text.len() } else { text.len().saturating_sub(2 * MAX_QUOTED) };
        let filled = table.fill(Rows::resume(&text, delimiter, place), limit, usize::MAX)?;
        if is_last {
            return Ok(filled.finding);
        }
        text.drain(..filled.place.0);
        place = (0, filled.place.1);
        pieces.more(&mut text)?;
    }
}

/// The heading with a time column, or one without where rows are a known time apart.
fn heading<'a>(
    name: &'a str,
    text: &'a str,
    delimiter: u8,
    row_distance_s: Option<f64>,
) -> Result<Header<'a>, RecordingError> {
    let head = Head::read(name, Rows::new(text, delimiter));
    match head.timed() {
        header if is_no_table(&header) && row_distance_s.is_some() => head.untimed(),
        header => header,
    }
}

/// Returns true if with this delimiter there is nothing like a heading with a time column, and samples below.
fn is_no_table(header: &Result<Header<'_>, RecordingError>) -> bool {
    use CsvProblem::{NoData, NoHeader, NoTime};
    matches!(header, Err(RecordingError::Csv { problem: NoTime { .. } | NoHeader | NoData, .. }))
}
