//! CSV: blocks of columns side by side, each with a time column of its own.

mod header;
mod text;
mod write;

use ::csv::{ReaderBuilder, StringRecord};

use crate::error::require_names;
use crate::{Channel, CsvProblem, Finding, Format, Raster, Recording, RecordingError, Selection};
use header::Header;
pub(crate) use header::{is_time_name, seconds};
pub(crate) use text::is_text;
use text::{Text, number};
pub use write::encode_csv;

pub(crate) fn decode(name: &str, bytes: &[u8], selection: &Selection) -> Result<Recording, RecordingError> {
    decode_with(name, bytes, selection, None)
}

/// Decodes text; rows without a time column are `row_distance_s` apart, if that is known.
pub(crate) fn decode_with(
    name: &str,
    bytes: &[u8],
    selection: &Selection,
    row_distance_s: Option<f64>,
) -> Result<Recording, RecordingError> {
    let mut text = Text::decode(bytes);
    if row_distance_s.is_some() {
        text.separate_by_tabs();
    }
    let rows = Rows::new(name, &text.content)?;
    let header = match row_distance_s {
        None => Header::find(&rows)?,
        Some(_) => Header::find_untimed(&rows)?,
    };
    let mut table = Table::new(&header, row_distance_s);
    let mut findings = Vec::new();
    if text.assumed_latin1 {
        findings.push(Finding::AssumedLatin1);
    }
    findings.extend(table.fill(&rows, &header)?);
    require_names(name, selection, header.columns.iter().filter(|c| !c.is_time).map(|c| c.name.as_str()))?;
    let (rasters, channels) = table.finish(header.columns, selection);
    Ok(Recording {
        format: Format::Csv { delimiter: char::from(rows.delimiter), decimal_comma: table.decimal == Some(',') },
        comment: header.comment,
        start_time: None,
        rasters,
        channels,
        findings,
    })
}

/// The text, ready to be split into lines and cells.
pub(crate) struct Rows<'a> {
    file: &'a str,
    content: &'a str,
    delimiter: u8,
}

impl<'a> Rows<'a> {
    fn new(file: &'a str, content: &'a str) -> Result<Self, RecordingError> {
        let delimiter = text::delimiter(content).ok_or_else(|| RecordingError::Csv {
            file: file.into(),
            line: 1,
            column: None,
            problem: CsvProblem::NoDelimiter,
        })?;
        Ok(Self { file, content, delimiter })
    }

    fn reader(&self) -> ::csv::Reader<&'a [u8]> {
        ReaderBuilder::new()
            .delimiter(self.delimiter)
            .has_headers(false)
            .flexible(true)
            .from_reader(self.content.as_bytes())
    }

    /// Reads the next row; false at the end.
    fn next(&self, reader: &mut ::csv::Reader<&[u8]>, row: &mut StringRecord) -> Result<bool, RecordingError> {
        reader.read_record(row).map_err(|error| {
            let line = error.position().map_or(1, ::csv::Position::line);
            let detail = error.to_string();
            self.error(line, None, CsvProblem::Unreadable { detail })
        })
    }

    fn error(&self, line: u64, column: Option<usize>, problem: CsvProblem) -> RecordingError {
        RecordingError::Csv { file: self.file.into(), line, column: column.map(|c| c + 1), problem }
    }
}

/// Line number of a row, from 1.
fn line(row: &StringRecord) -> u64 {
    row.position().map_or(1, ::csv::Position::line)
}

/// Columns under construction.
struct Table {
    columns: Vec<Vec<f64>>,
    /// For each time column: the column after its block, and whether the block has ended.
    blocks: Vec<(usize, usize, bool)>,
    decimal: Option<char>,
    /// Time from row to row, s, where no column holds time.
    row_distance_s: Option<f64>,
}

impl Table {
    fn new(header: &Header, row_distance_s: Option<f64>) -> Self {
        let width = header.columns.len();
        let starts = (0..width).filter(|&c| header.columns[c].is_time);
        let mut blocks: Vec<_> = starts.map(|start| (start, width, false)).collect();
        for b in 1..blocks.len() {
            blocks[b - 1].1 = blocks[b].0;
        }
        let row_distance_s = row_distance_s.filter(|_| blocks.is_empty());
        if row_distance_s.is_some() {
            blocks.push((0, width, false));
        }
        Self { columns: vec![Vec::new(); width], blocks, decimal: None, row_distance_s }
    }

    fn fill(&mut self, rows: &Rows<'_>, header: &Header) -> Result<Option<Finding>, RecordingError> {
        let mut reader = rows.reader();
        let mut row = StringRecord::new();
        for _ in 0..header.rows {
            rows.next(&mut reader, &mut row)?;
        }
        let ends_in_line_end = rows.content.ends_with(['\n', '\r']);
        let mut last = 1;
        while rows.next(&mut reader, &mut row)? {
            last = line(&row);
            let at_end = reader.is_done() || reader.position().byte() >= rows.content.len() as u64;
            let cut = at_end && !ends_in_line_end;
            if cut && row.len() < self.columns.len() {
                return Ok(Some(Finding::IncompleteLastLine { line: last }));
            }
            self.row(rows, &row)?;
        }
        Ok((!ends_in_line_end).then_some(Finding::NoFinalLineEnd { line: last }))
    }

    fn row(&mut self, rows: &Rows<'_>, row: &StringRecord) -> Result<(), RecordingError> {
        let expected = self.columns.len();
        let blank_end = (expected..row.len()).all(|c| row[c].trim().is_empty());
        if row.len() == 1 && row[0].trim().is_empty() {
            return Ok(());
        }
        if row.len() < expected || !blank_end {
            let found = row.len();
            let problem = CsvProblem::ColumnCount { found, expected };
            return Err(rows.error(line(row), None, problem));
        }
        for block in 0..self.blocks.len() {
            self.block(rows, row, block)?;
        }
        Ok(())
    }

    /// Takes over one line of one block of columns.
    fn block(&mut self, rows: &Rows<'_>, row: &StringRecord, block: usize) -> Result<(), RecordingError> {
        let (start, end, has_ended) = self.blocks[block];
        let filled = (start..end).find(|&c| !row[c].trim().is_empty());
        let Some(filled) = filled else {
            self.blocks[block].2 = true;
            return Ok(());
        };
        if has_ended {
            return Err(rows.error(line(row), Some(filled), CsvProblem::Gap));
        }
        if filled != start && self.row_distance_s.is_none() {
            return Err(rows.error(line(row), Some(start), CsvProblem::NoTimeStamp));
        }
        for column in start..end {
            let value = number(&row[column], &mut self.decimal)
                .map_err(|problem| rows.error(line(row), Some(column), problem))?;
            self.columns[column].push(value);
        }
        Ok(())
    }

    fn finish(&mut self, header: Vec<header::Column>, selection: &Selection) -> (Vec<Raster>, Vec<Channel>) {
        let (mut rasters, mut channels) = (Vec::new(), Vec::new());
        let counted = |distance_s: f64| {
            let rows = self.columns.first().map_or(0, Vec::len);
            Raster { time_s: (0..rows).map(|row| row as f64 * distance_s).collect(), name: None }
        };
        let mut time: Option<Raster> = self.row_distance_s.map(counted);
        for (column, samples) in header.into_iter().zip(std::mem::take(&mut self.columns)) {
            if column.is_time {
                let time_s = samples.into_iter().map(|t| t * column.factor.0 / column.factor.1);
                time = Some(Raster { time_s: time_s.collect(), name: None });
            } else if selection.takes(&column.name) {
                // The first channel of a block brings its clock along.
                rasters.extend(time.take());
                channels.push(Channel {
                    name: column.name,
                    unit: column.unit,
                    comment: String::new(),
                    raster: rasters.len().saturating_sub(1),
                    samples,
                });
            }
        }
        (rasters, channels)
    }
}
