//! Rows of samples to columns.

use std::ops::Range;

use super::header::{Column, Echo, Role};
use super::number::{Decimals, Number};
use super::rows::{Row, Rows};
use super::stamps::Stamps;
use crate::finding::are_rounded;
use crate::heading::clock_and_unit;
use crate::part::Series;
use crate::unstated;
use crate::{Channel, CsvProblem, Finding, Raster, RecordingError, Selection, SkipReason, StartTime};

/// Share of a time by which its spellings in two units may differ.
const ROUNDING: f64 = 1e-15;

/// A problem in a column of a row.
type Fault = (Option<usize>, CsvProblem);

/// Rows that were read.
pub(super) struct Filled {
    /// Where the next one begins.
    pub(super) place: (usize, u64),
    /// How many there are.
    pub(super) rows: usize,
    /// Finding on the last.
    pub(super) finding: Option<Finding>,
}

/// Columns under construction.
#[derive(Clone)]
pub(super) struct Table {
    file: String,
    pub(super) headings: Vec<Column>,
    columns: Vec<Sink>,
    blocks: Vec<Block>,
    echoes: Vec<Echo>,
    pub(super) decimals: Decimals,
    pub(super) stamps: Stamps,
    is_clock_first: bool,
    /// False where text was passed over that might have decided about decimal signs, had its column not been selected.
    pub(super) is_of_any_selection: bool,
    /// Time from row to row, s, where no column holds time.
    row_distance_s: Option<f64>,
}

/// Where a column's cells go.
#[derive(Clone)]
enum Sink {
    Samples {
        values: Vec<f64>,
        /// True if there was a number.
        is_numeric: bool,
        /// True if there was an integer that is too large to be exact.
        is_rounded: bool,
    },
    Text,
    /// Not selected, or the day of a time stamp.
    Unread,
    /// Without a name; it has to stay empty.
    Nameless,
    /// The first, without a name; it has to stay empty, or to count the rows: the last number that it held.
    RowNumbers(Option<u64>),
}

/// Columns side by side that share a clock.
#[derive(Clone)]
struct Block {
    columns: Range<usize>,
    clock: Option<usize>,
    has_ended: bool,
    /// Rows before those that are kept.
    before: usize,
    time_s: Vec<f64>,
    /// The last time stamp and the midnight before it, where the day is not known.
    last: Option<(i64, i64)>,
}

/// State between two rows.
#[derive(Debug, Clone, Default)]
pub(super) struct State {
    /// For each block the last time stamp and the midnight before it; nothing where all days are known.
    lasts: Vec<Option<(i64, i64)>>,
    row_number: Option<u64>,
}

impl Table {
    pub(super) fn new(
        file: &str,
        columns: Vec<Column>,
        selection: &Selection,
        delimiter: u8,
        row_distance_s: Option<f64>,
    ) -> Self {
        let clocks: Vec<usize> = (0..columns.len()).filter(|&c| columns[c].role.is_clock()).collect();
        let sink = |(index, column): (usize, &Column)| match column.role {
            Role::Samples if column.name.is_empty() && index == 0 => Sink::RowNumbers(None),
            Role::Samples if column.name.is_empty() => Sink::Nameless,
            Role::Samples if selection.takes(&column.name) => {
                Sink::Samples { values: Vec::new(), is_numeric: false, is_rounded: false }
            }
            _ => Sink::Unread,
        };
        Self {
            file: file.to_owned(),
            columns: columns.iter().enumerate().map(sink).collect(),
            blocks: blocks(&clocks, &columns),
            is_clock_first: clocks.first() == Some(&0),
            is_of_any_selection: true,
            headings: columns,
            echoes: Vec::new(),
            decimals: Decimals::new(delimiter),
            stamps: Stamps::default(),
            row_distance_s,
        }
    }

    /// Channels that have to go on as their clock does.
    pub(super) fn with_echoes(self, echoes: Vec<Echo>) -> Self {
        Self { echoes, ..self }
    }

    /// Takes the memory for `lines` of a text of `size` bytes at once, for what grows is copied, and leaves holes.
    pub(super) fn expect(&mut self, lines: usize, size: u64) {
        // Every cell takes a byte at least.
        let most = usize::try_from(size / self.columns.len().max(1) as u64).unwrap_or(usize::MAX);
        let rows = lines.min(most.saturating_add(1));
        let samples = self.columns.iter_mut().filter_map(|sink| match sink {
            Sink::Samples { values, .. } => Some(values),
            _ => None,
        });
        let times = self.blocks.iter_mut().map(|block| &mut block.time_s);
        // If there is not so much, it shows when the numbers are there.
        samples.chain(times).for_each(|column| drop(column.try_reserve_exact(rows)));
    }

    /// Reads the rows that end before `limit`, as many as `most`.
    pub(super) fn fill(&mut self, mut rows: Rows<'_>, limit: usize, most: usize) -> Result<Filled, RecordingError> {
        let mut row = Row::default();
        let mut filled = Filled { place: rows.place(), rows: 0, finding: None };
        while filled.rows < most && rows.next(&mut row) && rows.place().0 <= limit {
            filled.place = rows.place();
            if self.is_comment(&row) || row.width() == 0 && row.cells.len() == 1 {
                continue;
            }
            if !row.is_ended && row.cells.len() < self.columns.len() {
                filled.finding = Some(Finding::IncompleteLastLine { line: row.line });
                return Ok(filled);
            }
            if let Err((column, problem)) = self.row(&row) {
                let (file, column) = (self.file.clone(), column.map(|c| c + 1));
                return Err(RecordingError::Csv { file, line: row.line, column, problem });
            }
            filled.rows += 1;
            filled.finding = (!row.is_ended).then_some(Finding::NoFinalLineEnd { line: row.line });
        }
        Ok(filled)
    }

    /// Hands on the numbers that are kept, by block and by channel, and keeps them no longer.
    pub(super) fn hand_on(&mut self, each: &mut dyn FnMut(Series, usize, &[f64])) {
        let mut channels = 0;
        for (clock, block) in self.blocks.iter_mut().enumerate() {
            each(Series::Clock(clock), block.before, &block.time_s);
            for sink in self.columns.get_mut(block.columns.clone()).unwrap_or_default() {
                if let Sink::Samples { values, .. } = sink {
                    each(Series::Channel(channels), block.before, values);
                    values.clear();
                    channels += 1;
                }
            }
            block.before += block.time_s.len();
            block.time_s.clear();
        }
    }

    /// The state from which rows are read on.
    pub(super) fn state(&self) -> State {
        let are_known = self.blocks.iter().all(|block| block.last.is_none());
        let lasts = if are_known { Vec::new() } else { self.blocks.iter().map(|block| block.last).collect() };
        let row_number = self.columns.iter().find_map(|sink| match sink {
            Sink::RowNumbers(last) => *last,
            _ => None,
        });
        State { lasts, row_number }
    }

    /// The same for a selection, as its columns have turned out.
    pub(super) fn narrowed(&self, selection: &Selection) -> Self {
        let mut narrowed = self.clone();
        for (sink, heading) in narrowed.columns.iter_mut().zip(&self.headings) {
            if matches!(sink, Sink::Samples { .. } | Sink::Text) && !selection.takes(&heading.name) {
                *sink = Sink::Unread;
            }
        }
        narrowed
    }

    /// The blocks of which there are channels.
    pub(super) fn filled_blocks(&self) -> Vec<usize> {
        let is_channel = |sink: &Sink| matches!(sink, Sink::Samples { .. });
        let is_filled = |block: &usize| {
            self.columns.get(self.blocks[*block].columns.clone()).unwrap_or_default().iter().any(is_channel)
        };
        (0..self.blocks.len()).filter(is_filled).collect()
    }

    /// The same for some of the blocks, to read rows on from this one; `samples` says how many rows each block has.
    pub(super) fn resumed(&self, blocks: &[usize], row: usize, state: &State, samples: &[usize]) -> Self {
        let mut resumed = self.clone();
        for sink in &mut resumed.columns {
            if let Sink::RowNumbers(last) = sink {
                *last = state.row_number;
            }
        }
        // The file was read to its end before: what read like a clock was found to be none.
        resumed.echoes.clear();
        let block = |&block: &usize| Block {
            has_ended: row > samples[block],
            before: row.min(samples[block]),
            last: state.lasts.get(block).copied().flatten(),
            ..self.blocks[block].clone()
        };
        resumed.blocks = blocks.iter().map(block).collect();
        resumed
    }

    /// The name of the clock of each block that is one of numbers without a unit.
    pub(super) fn unitless(&self) -> Vec<Option<String>> {
        let heading = |block: &Block| block.clock.and_then(|clock| self.headings.get(clock));
        let name = |block| heading(block).filter(|clock| clock.is_unitless()).map(|clock| clock.name.clone());
        self.blocks.iter().map(name).collect()
    }

    /// Fails where numbers can be read in two ways.
    pub(super) fn check(&self) -> Result<(), RecordingError> {
        let Some((line, column, text)) = self.decimals.undecided() else { return Ok(()) };
        let (file, problem) = (self.file.clone(), CsvProblem::AmbiguousSign { text: text.clone() });
        Err(RecordingError::Csv { file, line: *line, column: Some(column + 1), problem })
    }

    /// Returns true if a line is a comment: where the first column is not the clock, a full line may be samples all the
    /// same.
    fn is_comment(&self, row: &Row<'_>) -> bool {
        row.is_comment() && (self.is_clock_first || row.cells.len() < self.columns.len())
    }

    fn row(&mut self, row: &Row<'_>) -> Result<(), Fault> {
        let expected = self.columns.len();
        if row.cells.len() < expected || row.cells[expected..].iter().any(|cell| !cell.text.is_empty()) {
            return Err((None, CsvProblem::ColumnCount { found: row.cells.len(), expected }));
        }
        (0..self.blocks.len()).try_for_each(|block| self.block(row, block))
    }

    /// Takes over one line of one block of columns.
    fn block(&mut self, row: &Row<'_>, block: usize) -> Result<(), Fault> {
        let Block { columns, clock, has_ended, .. } = &mut self.blocks[block];
        let has_time = clock.is_some_and(|clock| !row.cells[clock].text.is_empty());
        if !has_time {
            let Some(filled) = columns.clone().find(|&c| !row.cells[c].text.is_empty()) else {
                *has_ended = true;
                return Ok(());
            };
            if clock.is_some() && !*has_ended {
                return Err((*clock, CsvProblem::NoTimeStamp));
            }
            if *has_ended {
                return Err((Some(filled), CsvProblem::Gap));
            }
        } else if *has_ended {
            return Err((*clock, CsvProblem::Gap));
        }
        let columns = columns.clone();
        self.time(row, block)?;
        self.refuse_other_time(row, block)?;
        for column in columns {
            self.cell(row, column).map_err(|problem| (Some(column), problem))?;
        }
        Ok(())
    }

    fn time(&mut self, row: &Row<'_>, block: usize) -> Result<(), Fault> {
        let Block { clock, time_s, last, before, .. } = &mut self.blocks[block];
        let Some(clock) = *clock else {
            time_s.push((*before + time_s.len()) as f64 * self.row_distance_s.unwrap_or(1.0));
            return Ok(());
        };
        let cell = row.cells[clock].text;
        let stamps = &mut self.stamps;
        let time = match self.headings[clock].role {
            Role::Time(factor) => number(&mut self.decimals, cell, row.line, clock).map(|t| t * factor.0 / factor.1),
            Role::SpreadsheetDays => {
                number(&mut self.decimals, cell, row.line, clock).and_then(|days| stamps.spreadsheet(days, cell))
            }
            Role::Stamps(date) => {
                let time = stamps.time_s(cell, date.map(|date| row.cells[date].text), last);
                if let Some(sign) = stamps.sign.take() {
                    self.decimals.seen(sign);
                }
                time
            }
            Role::Samples | Role::Date | Role::CoarseTime => Ok(f64::NAN),
        };
        time_s.push(time.map_err(|problem| (Some(clock), problem))?);
        Ok(())
    }

    /// Refuses a column that read like the clock so far and goes on otherwise: it may be the clock of the columns
    /// behind it.
    fn refuse_other_time(&self, row: &Row<'_>, block: usize) -> Result<(), Fault> {
        let Block { columns, clock: Some(clock), time_s, .. } = &self.blocks[block] else { return Ok(()) };
        let time_s = time_s.last().copied().unwrap_or(f64::NAN);
        let goes_on = |echo: &&Echo| {
            let read = self.decimals.clone().read(row.text(echo.column), row.line, echo.column);
            let told_s = match read {
                Ok(Number::Value(told)) => told * echo.factor.0 / echo.factor.1,
                _ => f64::NAN,
            };
            (told_s - time_s).abs() <= echo.tolerance_s.max(ROUNDING * time_s.abs())
        };
        match self.echoes.iter().filter(|echo| columns.contains(&echo.column)).find(|echo| !goes_on(echo)) {
            None => Ok(()),
            Some(Echo { column, .. }) => {
                let name = |column: usize| self.headings[column].name.clone();
                let problem = CsvProblem::ClockOrChannel { name: name(*column), clock: name(*clock) };
                Err((Some(*column), problem))
            }
        }
    }

    #[inline]
    fn cell(&mut self, row: &Row<'_>, column: usize) -> Result<(), CsvProblem> {
        let text = row.cells[column].text;
        match &mut self.columns[column] {
            Sink::Samples { values, is_numeric, is_rounded } => match self.decimals.read(text, row.line, column)? {
                Number::Value(value) => {
                    *is_numeric = true;
                    *is_rounded |= are_rounded(&[value]) && is_integer(text);
                    values.push(value);
                }
                Number::Missing => values.push(f64::NAN),
                Number::Text if *is_numeric => return Err(CsvProblem::NotANumber { text: text.into() }),
                Number::Text => self.columns[column] = Sink::Text,
            },
            Sink::Unread if self.headings[column].role == Role::Samples => {
                self.decimals.observe(text, row.line, column)?;
            }
            Sink::Text => self.is_of_any_selection &= !self.decimals.may_decide(text),
            Sink::Nameless if !text.is_empty() => return Err(CsvProblem::NoName),
            Sink::RowNumbers(last) if !text.is_empty() => *last = Some(next_number(*last, text)?),
            Sink::Unread | Sink::Nameless | Sink::RowNumbers(_) => {}
        }
        Ok(())
    }

    /// The recording's parts, and what was left out.
    pub(super) fn finish(self, selection: &Selection) -> Result<Content, RecordingError> {
        let clocks = self.unitless().into_iter().zip(&self.blocks);
        let doubtful = clocks.map(|(name, block)| unstated::finding(&name?, &block.time_s)).collect();
        self.finish_with(selection, doubtful)
    }

    /// The same with the findings on the blocks' clocks.
    pub(super) fn finish_with(
        self,
        selection: &Selection,
        doubtful: Vec<Option<Finding>>,
    ) -> Result<Content, RecordingError> {
        let mut content = Content { start_time: self.stamps.start(), ..Content::default() };
        let mut columns: Vec<_> = self.headings.into_iter().zip(self.columns).map(Some).collect();
        for (block, doubtful) in self.blocks.into_iter().zip(doubtful) {
            let is_channel = |column: &Option<(Column, Sink)>| {
                column.as_ref().is_some_and(|(heading, _)| heading.role == Role::Samples && !heading.name.is_empty())
            };
            let is_lonely = !columns.get(block.columns.clone()).unwrap_or_default().iter().any(is_channel);
            let before = content.channels.len();
            for place in columns.get_mut(block.columns).unwrap_or_default() {
                match place.take() {
                    Some((Column { name, unit, comment, .. }, Sink::Samples { values: samples, is_rounded, .. })) => {
                        let raster = content.rasters.len();
                        if is_rounded {
                            content.findings.push(Finding::RoundedIntegers { channel: name.clone() });
                        }
                        content.channels.push(Channel { name, unit, comment, raster, samples: exactly(samples) });
                    }
                    Some((Column { name, .. }, Sink::Text)) => {
                        let reason = SkipReason::NotNumeric { kind: "text".into() };
                        if selection.insists_on(&name) {
                            let (file, channel) = (self.file, name);
                            return Err(RecordingError::UnusableChannel { file, channel, reason });
                        }
                        content.findings.push(Finding::SkippedChannel { channel: name, reason });
                    }
                    Some((Column { name, role: Role::CoarseTime, .. }, _)) => {
                        let reason = SkipReason::CoarseTime;
                        content.findings.push(Finding::SkippedChannel { channel: name, reason });
                    }
                    Some((Column { name, role, .. }, _)) if is_lonely && role.is_clock() => {
                        let reason = SkipReason::NoChannels;
                        content.findings.push(Finding::SkippedChannel { channel: name, reason });
                    }
                    Some((_, Sink::RowNumbers(Some(_)))) => {
                        let (channel, reason) = ("column 1".into(), SkipReason::RowNumbers);
                        content.findings.push(Finding::SkippedChannel { channel, reason });
                    }
                    _ => {}
                }
            }
            if content.channels.len() > before {
                content.findings.extend(doubtful);
                content.rasters.push(Raster { time_s: exactly(block.time_s), name: None });
            }
        }
        Ok(content)
    }
}

/// The number of a row, which is more than that of the row before.
fn next_number(last: Option<u64>, text: &str) -> Result<u64, CsvProblem> {
    let number = text.parse().ok().filter(|number| last.is_none_or(|last| last < *number));
    number.ok_or(CsvProblem::NoName)
}

/// Returns true if a number is written without fraction and exponent.
fn is_integer(text: &str) -> bool {
    text.trim().trim_start_matches(['-', '+']).bytes().all(|b| b.is_ascii_digit())
}

/// Gives back what was expected and did not come.
fn exactly(mut samples: Vec<f64>) -> Vec<f64> {
    samples.shrink_to_fit();
    samples
}

/// Content of a table that was read.
#[derive(Default)]
pub(super) struct Content {
    pub(super) start_time: Option<StartTime>,
    pub(super) rasters: Vec<Raster>,
    pub(super) channels: Vec<Channel>,
    pub(super) findings: Vec<Finding>,
}

impl Column {
    /// Tells whether it is a clock of numbers that no unit is stated for.
    fn is_unitless(&self) -> bool {
        matches!(self.role, Role::Time(_)) && self.unit.is_empty() && clock_and_unit(&self.name).1.is_empty()
    }
}

/// The names of the channels among columns.
pub(super) fn names(columns: &[Column]) -> impl Iterator<Item = &str> + Clone {
    columns.iter().filter(|c| c.role == Role::Samples && !c.name.is_empty()).map(|c| c.name.as_str())
}

/// Each clock's columns go on to the next clock, or its date; what stands before the first clock is its too.
fn blocks(clocks: &[usize], columns: &[Column]) -> Vec<Block> {
    let start = |&clock: &usize| match columns[clock].role {
        Role::Stamps(Some(date)) => date.min(clock),
        _ => clock,
    };
    let block = |columns, clock| Block { columns, clock, has_ended: false, before: 0, time_s: Vec::new(), last: None };
    if clocks.is_empty() {
        return vec![block(0..columns.len(), None)];
    }
    let ends = clocks.iter().skip(1).map(start).chain([columns.len()]);
    let mut begin = 0;
    let range = |(&clock, end): (&usize, usize)| {
        let columns = begin..end;
        begin = end;
        block(columns, Some(clock))
    };
    clocks.iter().zip(ends).map(range).collect()
}

/// A time stamp that is a number; only `NaN` stands for a missing one.
fn number(decimals: &mut Decimals, cell: &str, line: u64, column: usize) -> Result<f64, CsvProblem> {
    match decimals.read(cell, line, column)? {
        Number::Value(value) => Ok(value),
        Number::Missing => Err(CsvProblem::NoTimeStamp),
        Number::Text => Err(CsvProblem::NotANumber { text: cell.into() }),
    }
}
