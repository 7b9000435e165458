//! Index of a text: where its rows are, and what all of them say about its columns.

use std::ops::Range;

use work::Context;

use super::rows::{MAX_QUOTED, Rows};
use super::table::{Content, State, Table};
use super::text::{Encoding, PIECE, Pieces};
use super::{Opened, recording};
use crate::part::Series;
use crate::{Finding, Format, Recording, RecordingError, Selection, Source, unstated};

/// Rows from one whose place is kept to the next.
pub(super) const EVERY: usize = 256;

/// Index of a text for a selection of its columns.
pub(super) struct Index {
    delimiter: u8,
    encoding: Encoding,
    /// Where the text ends, in bytes.
    end: u64,
    /// The columns, as all rows have shown them, without their numbers.
    table: Table,
    comment: Option<String>,
    findings: Vec<Finding>,
    /// The places of the first row and each [`EVERY`] rows later.
    places: Vec<Place>,
    pub(super) clocks: Vec<Clock>,
}

/// A place between two rows.
struct Place {
    byte: u64,
    line: u64,
    state: State,
}

/// Facts about the clock of a block.
pub(super) struct Clock {
    pub(super) samples: usize,
    pub(super) is_sorted: bool,
    /// The first stamp that is finite.
    pub(super) first_s: Option<f64>,
    last_s: f64,
    doubtful: Option<Finding>,
}

impl Index {
    /// Goes through a text once.
    pub(super) fn new(
        name: &str,
        source: &dyn Source,
        selection: &Selection,
        row_distance_s: Option<f64>,
        context: &Context,
    ) -> Result<Self, RecordingError> {
        let opened = Opened::open(name, source, selection, row_distance_s, false)?;
        let (delimiter, encoding) = (opened.delimiter, opened.pieces.encoding());
        let (_, end) = opened.pieces.progress();
        let (comment, mut findings) = (opened.comment, opened.findings);
        let mut pass = Pass {
            places: Vec::new(),
            clocks: opened.table.unitless().into_iter().map(Watched::new).collect(),
            table: opened.table,
            rows: 0,
            byte: opened.begin,
            noted: 0,
            encoding,
        };
        findings.extend(pass.all(opened.pieces, opened.text, (opened.place, delimiter), context)?);
        pass.table.check()?;
        let Pass { table, places, clocks, .. } = pass;
        let clocks = clocks.into_iter().map(Watched::finish).collect();
        Ok(Self { delimiter, encoding, end, table, comment, findings, places, clocks })
    }

    /// Tells whether it holds for any selection, where it was made for all columns.
    pub(super) fn is_of_any_selection(&self) -> bool {
        self.table.is_of_any_selection
    }

    /// Bytes of memory that it takes, about.
    pub(super) fn bytes(&self) -> usize {
        self.places.len() * (size_of::<Place>() + self.clocks.len() * size_of::<Option<(i64, i64)>>())
    }

    /// The columns of a selection.
    pub(super) fn table(&self, selection: &Selection) -> Table {
        self.table.narrowed(selection)
    }

    /// The recording without numbers.
    pub(super) fn without_numbers(&self, table: Table, selection: &Selection) -> Result<Recording, RecordingError> {
        let decimal_comma = table.decimals.sign() == Some(b',');
        let format = Format::Csv { delimiter: char::from(self.delimiter), decimal_comma };
        let doubtful = self.clocks.iter().map(|clock| clock.doubtful.clone()).collect();
        let content: Content = table.finish_with(selection, doubtful)?;
        Ok(recording(format, self.comment.clone(), self.findings.clone(), content))
    }

    /// Reads rows of some blocks of a table, and hands on their numbers, from up to [`EVERY`] rows before the first on.
    pub(super) fn read(
        &self,
        (name, source): (&str, &dyn Source),
        (table, blocks): (&Table, &[usize]),
        rows: Range<usize>,
        each: &mut dyn FnMut(Series, usize, &[f64]),
    ) -> Result<(), RecordingError> {
        let samples: Vec<usize> = self.clocks.iter().map(|clock| clock.samples).collect();
        let mut at = rows.start / EVERY;
        let Some(place) = self.places.get(at).filter(|_| rows.start < rows.end) else { return Ok(()) };
        let mut table = table.resumed(blocks, at * EVERY, &place.state, &samples);
        while let Some(place) = self.places.get(at).filter(|_| at * EVERY < rows.end) {
            work::checkpoint();
            let next = self.next(at, rows.end);
            let end = self.places.get(next).map_or(self.end, |place| place.byte);
            let text = Pieces::between(name, source, self.encoding, place.byte..end)?;
            let read = Rows::resume(&text, self.delimiter, (0, place.line));
            table.fill(read, text.len(), rows.end - at * EVERY)?;
            table.hand_on(each);
            at = next;
        }
        Ok(())
    }

    /// The place up to which text is read at once, from a place on, for rows up to this one.
    fn next(&self, at: usize, row: usize) -> usize {
        let begin = self.places[at].byte;
        let is_near = |next: &usize| self.places.get(*next).is_some_and(|place| place.byte - begin <= PIECE);
        (at + 2..).take_while(|next| is_near(next) && (next - 1) * EVERY < row).last().unwrap_or(at + 1)
    }
}

/// Passage through all rows.
struct Pass {
    table: Table,
    places: Vec<Place>,
    clocks: Vec<Watched>,
    /// Rows since the last place that was noted.
    rows: usize,
    /// Where in the file the text goes on behind its first `noted` bytes.
    byte: u64,
    noted: usize,
    encoding: Encoding,
}

impl Pass {
    fn all(
        &mut self,
        mut pieces: Pieces<'_>,
        mut text: String,
        (mut place, delimiter): ((usize, u64), u8),
        context: &Context,
    ) -> Result<Option<Finding>, RecordingError> {
        self.note(&text, place);
        let mut finding = None;
        loop {
            let (done, all) = pieces.progress();
            context.reach(done, all);
            let is_last = pieces.is_done();
            // Whether a quote ends shows only in what follows.
            let limit = if is_last { text.len() } else { text.len().saturating_sub(2 * MAX_QUOTED) };
            loop {
                let rows = Rows::resume(&text, delimiter, place);
                let filled = self.table.fill(rows, limit, EVERY - self.rows)?;
                place = filled.place;
                self.rows += filled.rows;
                self.watch();
                // One on the last row stays where nothing follows.
                finding = filled.finding.or(finding);
                if self.rows < EVERY {
                    break;
                }
                self.note(&text, place);
            }
            if is_last {
                return Ok(finding);
            }
            self.pass_over(&text, place.0);
            text.drain(..place.0);
            (self.noted, place) = (0, (0, place.1));
            pieces.more(&mut text)?;
        }
    }

    /// Notes a place between two rows.
    fn note(&mut self, text: &str, (at, line): (usize, u64)) {
        self.pass_over(text, at);
        self.places.push(Place { byte: self.byte, line, state: self.table.state() });
        self.rows = 0;
    }

    fn pass_over(&mut self, text: &str, at: usize) {
        self.byte += self.encoding.bytes(&text[self.noted..at]);
        self.noted = at;
    }

    /// Takes the stamps out of the table, and lets the samples go.
    fn watch(&mut self) {
        let clocks = &mut self.clocks;
        self.table.hand_on(&mut |series, _, numbers| {
            if let Series::Clock(clock) = series {
                clocks[clock].add(numbers);
            }
        });
    }
}

/// A clock whose stamps pass by.
struct Watched {
    clock: Clock,
    /// The name of one without a unit, of which all stamps are kept, for they show whether they can be seconds.
    unitless: Option<String>,
    time_s: Vec<f64>,
}

impl Watched {
    fn new(unitless: Option<String>) -> Self {
        let clock = Clock { samples: 0, is_sorted: true, first_s: None, last_s: f64::NEG_INFINITY, doubtful: None };
        Self { clock, unitless, time_s: Vec::new() }
    }

    fn add(&mut self, time_s: &[f64]) {
        let clock = &mut self.clock;
        clock.samples += time_s.len();
        for &stamp_s in time_s {
            clock.is_sorted &= clock.last_s <= stamp_s;
            clock.last_s = stamp_s;
        }
        clock.first_s = clock.first_s.or_else(|| time_s.iter().copied().find(|t| t.is_finite()));
        if self.unitless.is_some() {
            self.time_s.extend_from_slice(time_s);
        }
    }

    fn finish(self) -> Clock {
        let doubtful = self.unitless.and_then(|name| unstated::finding(&name, &self.time_s));
        Clock { doubtful, ..self.clock }
    }
}
