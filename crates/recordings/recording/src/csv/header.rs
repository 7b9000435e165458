//! Names, units and comments, which columns are time, and where the samples begin.

use super::clocks::{self, Candidate, Clocks, Doubt, Likeness, Track};
use super::number::{Decimals, Number, is_number};
use super::rows::{Row, Rows};
use super::stamp::Stamp;
use super::stamps::Stamps;
use std::collections::BTreeSet;

use crate::heading::{clock_and_unit, mentions_time, name_and_unit, seconds, time_word, unbracketed};
use crate::mdf::some_text;
use crate::{CsvProblem, RecordingError};

/// Lines before the first samples that are looked at.
const MAX_ROWS: usize = 200;
/// Cells beyond which no more lines are looked at.
const MAX_CELLS: usize = 1 << 20;
/// Characters of a unit, as in `kg·m²/rad`.
const MAX_UNIT: usize = 10;
/// Lines of a heading: names, units, comments.
const MAX_HEADING: usize = 3;

/// Content above the samples.
pub(super) struct Header<'a> {
    pub(super) columns: Vec<Column>,
    /// Channels that have to go on as the first clock does.
    pub(super) echoes: Vec<Echo>,
    pub(super) comment: Option<String>,
    /// Where the samples begin.
    pub(super) samples: Rows<'a>,
}

/// A channel that reads the same as the clock in the first rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Echo {
    pub(super) column: usize,
    /// Seconds per unit as a fraction.
    pub(super) factor: (f64, f64),
    /// Up to this it is the same, s.
    pub(super) tolerance_s: f64,
}

/// A column's heading.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Column {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) comment: String,
    pub(super) role: Role,
}

/// Use of a column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Role {
    Samples,
    /// The day of the time of day beside it.
    Date,
    /// Time as numbers, with seconds per unit as a fraction.
    Time((f64, f64)),
    /// Time as dates and times of day, the date in its own column where there is one.
    Stamps(Option<usize>),
    /// Days since 1899-12-30, as spreadsheets count.
    SpreadsheetDays,
    /// Time to a lower resolution than the clock beside it.
    CoarseTime,
}

impl Role {
    pub(super) fn is_clock(self) -> bool {
        matches!(self, Self::Time(_) | Self::Stamps(_) | Self::SpreadsheetDays)
    }
}

/// The first rows of a file that are not blank, each with its place.
pub(super) struct Head<'a> {
    file: &'a str,
    rows: Vec<(Rows<'a>, Row<'a>)>,
}

impl<'a> Head<'a> {
    pub(super) fn read(file: &'a str, mut rows: Rows<'a>) -> Self {
        let mut found = Vec::new();
        let (mut row, mut cells) = (Row::default(), 0);
        while found.len() < MAX_ROWS && cells < MAX_CELLS {
            let place = rows.clone();
            if !rows.next(&mut row) {
                break;
            }
            if row.width() > 0 {
                cells += row.cells.len();
                found.push((place, row.clone()));
            }
        }
        Self { file, rows: found }
    }

    fn row(&self, index: usize) -> Option<&Row<'a>> {
        self.rows.get(index).map(|(_, row)| row)
    }

    fn error(&self, line: u64, column: Option<usize>, problem: CsvProblem) -> RecordingError {
        RecordingError::Csv { file: self.file.into(), line, column: column.map(|c| c + 1), problem }
    }

    /// The heading of a table with a time column.
    pub(super) fn timed(&self) -> Result<Header<'a>, RecordingError> {
        for names in 0..self.rows.len() {
            let Some(clock) = self.first_clock(names) else { continue };
            let begins = |&row: &usize| self.row(row).is_some_and(|row| !row.is_comment() && is_time(row, clock));
            let Some(samples) = (names + 1..=names + MAX_HEADING).find(begins) else { continue };
            (names + 1..samples).try_for_each(|row| self.refuse_samples(row, clock))?;
            let names = self.fullest(names, samples);
            return self.header(names, samples);
        }
        Err(self.no_heading())
    }

    /// Numbers alone in a row of the heading are samples whose time stamp is missing or no time.
    fn refuse_samples(&self, row: usize, clock: usize) -> Result<(), RecordingError> {
        let Some(row) = self.row(row) else { return Ok(()) };
        let time = row.text(clock);
        let mut others = (0..row.cells.len()).filter(|&c| c != clock && !row.text(c).is_empty()).peekable();
        let are_units = !time.is_empty() && seconds(unbracketed(time)).is_some();
        if are_units || others.peek().is_none() || !others.all(|c| is_number(row.text(c))) {
            return Ok(());
        }
        let is_missing = matches!(Decimals::default().read(time, 0, 0), Ok(Number::Missing));
        let text = time.to_owned();
        let problem = if is_missing { CsvProblem::NoTimeStamp } else { CsvProblem::NotATime { text } };
        Err(self.error(row.line, Some(clock), problem))
    }

    /// Of the rows above the samples that may hold the names: the first that names every column, or the first.
    fn fullest(&self, first: usize, samples: usize) -> usize {
        let width = self.row(samples).map_or(0, Row::width);
        let is_full = |row: &usize| {
            let labels = self.labels(*row);
            labels.len() >= width && labels.iter().take(width).all(|label| !label.is_empty())
        };
        (first..samples).filter(|&row| self.first_clock(row).is_some()).find(is_full).unwrap_or(first)
    }

    /// The cells of a row as headings; a comment's without its sign.
    fn labels(&self, index: usize) -> Vec<String> {
        let Some(row) = self.row(index) else { return Vec::new() };
        let mut labels: Vec<String> = row.cells.iter().map(|cell| cell.label().trim().to_owned()).collect();
        if row.is_comment() {
            labels[0] = labels[0].trim_start_matches(['#', '%']).trim_start().to_owned();
        }
        labels
    }

    /// The first column named as time in a row that may hold the names; none where it holds none.
    fn first_clock(&self, index: usize) -> Option<usize> {
        let row = self.row(index)?;
        if row.filled().count() < 2 || row.filled().any(|cell| !matches!(Stamp::read(cell), Ok(None))) {
            return None;
        }
        let labels = self.labels(index);
        let headings: Vec<(&str, &str)> = labels.iter().map(|label| clock_and_unit(label)).collect();
        let is_unit = |unit: &str| !unit.is_empty() && seconds(unit).is_some();
        let unit_below = self.row(index + 1).map_or("", |row| unbracketed(row.text(0)));
        let is_named = |&(column, &(name, unit)): &(usize, &(&str, &str))| match (column, time_word(name)) {
            (0, Some(_)) => true,
            (_, Some("t")) => is_unit(unit),
            (_, Some(_)) => seconds(unit).is_some(),
            (_, None) => false,
        };
        let named = || headings.iter().enumerate().find(is_named).map(|(column, _)| column);
        let dated = || headings.iter().position(|(name, _)| is_date_name(name));
        let &(name, unit) = headings.first()?;
        let is_measured = is_unit(unit) || (is_unit(unit_below) && !is_number(name) && !name.is_empty());
        is_measured.then_some(0).or_else(named).or_else(dated)
    }

    fn header(&self, names: usize, samples: usize) -> Result<Header<'a>, RecordingError> {
        let first = self.first_clock(names).unwrap_or(0);
        let units = (names + 1..samples).find(|&row| self.row(row).is_some_and(|row| is_unit_row(row, first)));
        let mut columns = self.columns(names, units, samples);
        let clocks = self.clocks(names, samples, &columns, first)?;
        for &column in &clocks.columns {
            let role = self.role(names, samples, &columns, column)?;
            if let Role::Stamps(Some(date)) = role {
                columns[date].role = Role::Date;
            }
            columns[column].role = role;
        }
        if let Some(column) = clocks.passed_over {
            columns[column].role = Role::CoarseTime;
        }
        let comment = self.comment(names);
        let echo = |&column: &usize| match self.role(names, samples, &columns, column) {
            Ok(Role::Time(factor)) => Some(Echo { column, factor, tolerance_s: clocks.same_s }),
            _ => None,
        };
        let echoes = clocks.echoes.iter().filter_map(echo).collect();
        Ok(Header { columns, echoes, comment, samples: self.rows[samples].0.clone() })
    }

    /// The clocks among the columns that are named as time.
    fn clocks(&self, names: usize, samples: usize, columns: &[Column], first: usize) -> Result<Clocks, RecordingError> {
        let labels = self.labels(names);
        let heading = |column: usize| {
            let (name, unit) = labels.get(column).map_or(("", ""), |label| clock_and_unit(label));
            let below = columns.get(column).map_or("", |column| column.unit.as_str());
            (name, if below.is_empty() { unit } else { below })
        };
        let candidate = |column: usize| {
            let role = self.role(names, samples, columns, column)?;
            let likeness = likeness(heading(first), heading(column));
            Ok(Candidate { column, likeness, track: self.track(samples, role, column) })
        };
        let may_be = |&column: &usize| {
            let (name, unit) = heading(column);
            column == first || ((name == heading(first).0 || mentions_time(name)) && seconds(unit).is_some())
        };
        let candidates = (first..columns.len()).filter(may_be).map(candidate).collect::<Result<Vec<_>, _>>()?;
        clocks::choose(candidates, columns.len()).map_err(|Doubt { column, clock }| {
            let label = |column: usize| labels.get(column).cloned().unwrap_or_default();
            let problem = CsvProblem::ClockOrChannel { name: label(column), clock: label(clock) };
            self.error(self.row(names).map_or(1, |row| row.line), Some(column), problem)
        })
    }

    /// How a column of time begins, up to the first cell that is none.
    fn track(&self, samples: usize, role: Role, column: usize) -> Track {
        let (mut stamps, mut last) = (Stamps::default(), None);
        let number = |cell: &str| match Decimals::default().read(cell, 0, 0) {
            Ok(Number::Value(value)) => Some(value),
            _ => None,
        };
        let rows = self.rows.iter().skip(samples).map(|(_, row)| row).filter(|row| !row.is_comment());
        let times = rows.map_while(|row| {
            let cell = row.text(column);
            match role {
                Role::Time((scale, divisor)) => number(cell).map(|value| value * scale / divisor),
                Role::SpreadsheetDays => number(cell).map(|days| days * 86_400.0),
                Role::Stamps(date) => stamps.time_s(cell, date.map(|date| row.text(date)), &mut last).ok(),
                _ => None,
            }
        });
        let times_s: Vec<f64> = times.collect();
        let (frame, start_s) = match stamps.first() {
            Some(first) => (Some(first.frame), first.nanoseconds as f64 / 1e9),
            None => (None, times_s.first().copied().unwrap_or(0.0)),
        };
        Track { times_s, frame, start_s }
    }

    /// Names with units, and the other rows of the heading as comments.
    fn columns(&self, names: usize, units: Option<usize>, samples: usize) -> Vec<Column> {
        let labels = self.labels(names);
        let width = labels.iter().rposition(|label| !label.is_empty()).map_or(0, |last| last + 1);
        let units_below = units.map(|row| self.labels(row));
        let others: Vec<_> =
            (names + 1..samples).filter(|row| Some(*row) != units).map(|row| self.labels(row)).collect();
        let column = |(index, label): (usize, &String)| {
            let (name, unit) = match &units_below {
                Some(units) => (label.as_str(), unbracketed(units.get(index).map_or("", String::as_str))),
                None => name_and_unit(label),
            };
            let texts = others.iter().filter_map(|row| row.get(index)).filter(|text| !text.is_empty());
            let comment = texts.map(String::as_str).collect::<Vec<_>>().join(" ");
            Column { name: name.into(), unit: unit.into(), comment, role: Role::Samples }
        };
        labels.iter().take(width).enumerate().map(column).collect()
    }

    /// Finds out how time is written in a column.
    fn role(&self, names: usize, samples: usize, columns: &[Column], column: usize) -> Result<Role, RecordingError> {
        let (Some(row), Some(below)) = (self.row(samples), columns.get(column)) else { return Ok(Role::Samples) };
        let fails = |problem| Err(self.error(self.row(names).map_or(1, |row| row.line), Some(column), problem));
        let label = self.labels(names).get(column).cloned().unwrap_or_default();
        let (_, unit_of_name) = clock_and_unit(&label);
        let unit = if below.unit.is_empty() { unit_of_name.to_owned() } else { below.unit.clone() };
        let beside = [column.wrapping_sub(1), column + 1].into_iter().find(|&date| {
            let is_date = columns.get(date).is_some_and(|c| is_date_name(&c.name));
            is_date && !matches!(Stamp::read_pair(row.text(date), row.text(column)), Ok(None))
        });
        let is_empty = row.text(column).is_empty();
        let may_be_number = is_number(row.text(column)) || (is_empty && seconds(&unit).is_some());
        if !may_be_number {
            return Ok(Role::Stamps(beside.filter(|_| !is_empty)));
        }
        match seconds(&unit) {
            Some(_) if !unit_of_name.is_empty() && seconds(unit_of_name) != seconds(&unit) => {
                fails(CsvProblem::TwoTimeUnits { name: unit_of_name.into(), below: unit })
            }
            Some(factor) => Ok(Role::Time(factor)),
            None if unit.to_lowercase().contains("excel") => Ok(Role::SpreadsheetDays),
            None => fails(CsvProblem::TimeUnit { unit }),
        }
    }

    /// Text above the names.
    fn comment(&self, names: usize) -> Option<String> {
        let text = |(_, row): &(Rows<'_>, Row<'_>)| row.filled().collect::<Vec<_>>().join(" ");
        let lines: Vec<String> = self.rows[..names].iter().map(text).filter(|l| !l.starts_with("sep=")).collect();
        some_text(&lines.join("\n"))
    }

    /// Why there is no heading with a time column.
    fn no_heading(&self) -> RecordingError {
        let named = (0..self.rows.len()).find_map(|row| Some((row, self.first_clock(row)?)));
        if let Some((names, clock)) = named {
            let row = |index| self.row(index).map_or((1, ""), |row| (row.line, row.text(clock)));
            return match self.row(names + 1) {
                None => self.error(row(names).0, None, CsvProblem::NoData),
                Some(_) => {
                    let (line, text) = row(names + 1);
                    self.error(line, Some(clock), CsvProblem::NotATime { text: text.into() })
                }
            };
        }
        let samples = self.rows.iter().position(|(_, row)| begins_with_number(row));
        match samples.map(|index| index.checked_sub(1).and_then(|above| self.row(above))) {
            None => self.error(self.rows.last().map_or(1, |(_, row)| row.line), None, CsvProblem::NoData),
            Some(None) => self.error(1, None, CsvProblem::NoHeader),
            Some(Some(above)) => {
                let name = above.filled().next().unwrap_or_default().to_owned();
                self.error(above.line, Some(0), CsvProblem::NoTime { name })
            }
        }
    }

    /// The row of names above samples without a time column: the next above, or, where that may hold units, the one
    /// above it that has a name for each column, and none twice.
    fn names_above(&self, samples: usize) -> Option<usize> {
        let is_heading = |row: &usize| self.row(*row).is_some_and(|row| !row.is_comment());
        let next = samples.checked_sub(1).filter(is_heading)?;
        let width = self.row(samples).map_or(0, Row::width);
        let names_all = |row: &usize| {
            let labels: BTreeSet<String> = self.labels(*row).into_iter().filter(|label| !is_number(label)).collect();
            labels.len() == width && !labels.contains("")
        };
        let has_units = width > 1 && self.row(next).is_some_and(may_be_units);
        let above = next.checked_sub(1).filter(|row| has_units && is_heading(row) && names_all(row));
        above.or(Some(next))
    }

    /// The heading of a table without a time column, which need not have names: then columns are called by their
    /// number.
    pub(super) fn untimed(&self) -> Result<Header<'a>, RecordingError> {
        let is_text = |row: &Row<'_>| row.filled().count() > 1 && row.filled().all(|cell| !is_number(cell));
        let is_sample = |&row: &usize| {
            let (this, next) = (self.row(row), self.row(row + 1));
            this.is_some_and(begins_with_number) && !next.is_some_and(|next| is_text(next) && !next.is_comment())
        };
        let Some(samples) = (0..self.rows.len()).find(is_sample) else { return Err(self.no_heading()) };
        let names = self.names_above(samples);
        let columns = match names {
            Some(names) => self.columns(names, (names + 1 < samples).then_some(names + 1), samples),
            None => (1..=self.rows[samples].1.width()).map(numbered).collect(),
        };
        let comment = self.comment(names.unwrap_or(samples));
        Ok(Header { columns, echoes: Vec::new(), comment, samples: self.rows[samples].0.clone() })
    }
}

/// Returns true if text is a unit, and no name: in brackets, with signs that names lack, or one that benches write.
fn is_unit(cell: &str) -> bool {
    let unit = unbracketed(cell);
    let is_common =
        matches!(unit, "-" | "N" | "kN" | "m" | "mm" | "kg" | "g" | "rad" | "Hz" | "kHz" | "V" | "A" | "W" | "kW")
            || matches!(
                unit,
                "K" | "Pa" | "hPa" | "kPa" | "bar" | "mbar" | "J" | "Nm" | "mNm" | "kNm" | "rpm" | "RPM" | "deg"
            );
    unit != cell || is_common || unit.contains(['/', '°', '%', '²', '·', '^']) || seconds(unit).is_some()
}

/// Returns true if a row below names may hold their units, and nothing else.
fn may_be_units(row: &Row<'_>) -> bool {
    row.filled().all(|cell| !is_number(cell) && cell.chars().count() <= MAX_UNIT && is_unit(cell))
}

fn numbered(number: usize) -> Column {
    let name = format!("column {number}");
    Column { name, unit: String::new(), comment: String::new(), role: Role::Samples }
}

/// How name and unit of a column of time are like those of the first. A `t` with a number and without a unit may be a
/// temperature.
fn likeness((first, unit_of_first): (&str, &str), (name, unit): (&str, &str)) -> Likeness {
    let same = match (seconds(unit_of_first), seconds(unit)) {
        (Some(a), Some(b)) if a != b && !unit.is_empty() && !unit_of_first.is_empty() => Likeness::OtherUnit,
        _ => Likeness::Same,
    };
    match time_word(name) {
        _ if name == first => same,
        Some(word) if Some(word) != time_word(first) => Likeness::Other,
        Some("t") if unit.is_empty() => Likeness::SameLetter,
        Some(_) => same,
        None => Likeness::Other,
    }
}

fn is_date_name(name: &str) -> bool {
    matches!(name.trim().to_lowercase().as_str(), "date" | "datum")
}

/// Returns true if the cell of the clock is a time, as it is in rows of samples.
fn is_time(row: &Row<'_>, clock: usize) -> bool {
    let cell = row.text(clock);
    is_number(cell) || !matches!(Stamp::read(cell), Ok(None))
}

fn begins_with_number(row: &Row<'_>) -> bool {
    !row.is_comment() && row.filled().next().is_some_and(is_number)
}

/// Returns true if a row below the names holds units: it has one of time, or something as short, or nothing, in that
/// column.
fn is_unit_row(row: &Row<'_>, clock: usize) -> bool {
    let cell = row.text(clock);
    let unit = unbracketed(cell);
    let lower = unit.to_lowercase();
    let is_layout = ["hh", "yyyy", "jjjj", "mm:ss"].iter().any(|part| lower.contains(part));
    seconds(unit).is_some() || is_layout || unit.chars().count() <= 4 && time_word(unit).is_none() || cell != unit
}
