//! Which of the columns that are named as time are clocks.
//!
//! A name does not decide: `injection time [ms]` and a temperature `t2` are channels, `Uhrzeit` beside `Zeit [s]` is
//! another reading of the same clock, `time_slow [s]` is the clock of the columns that follow it. The numbers decide.

use super::stamp::Frame;

/// Stamps written to the second are that far off.
const STAMP_S: f64 = 1.0;
/// Shares of a step, and of all that was read, within which two clocks show the same time.
const SAME_STEP: f64 = 1e-6;
const SAME_RATE: f64 = 0.1;

/// A column that is named as time.
pub(super) struct Candidate {
    pub(super) column: usize,
    pub(super) likeness: Likeness,
    pub(super) track: Track,
}

/// How a name is like that of the first clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Likeness {
    /// Certainly a clock's: the same, apart from a number.
    Same,
    /// The same, apart from a number, in another unit: another reading of the clock, or that of a block.
    OtherUnit,
    /// The same letter apart from a number, and no unit: `t1` and `t2` may be temperatures.
    SameLetter,
    /// Another.
    Other,
}

/// How a column of time begins.
pub(super) struct Track {
    /// Seconds.
    pub(super) times_s: Vec<f64>,
    /// Of written stamps, what they say beside the time of day.
    pub(super) frame: Option<Frame>,
    /// The first stamp, s.
    pub(super) start_s: f64,
}

impl Track {
    fn steps(&self) -> impl Iterator<Item = f64> {
        self.times_s.windows(2).map(|pair| pair[1] - pair[0])
    }

    /// Returns true if it rises from row to row, as a clock does.
    fn rises_always(&self) -> bool {
        !self.times_s.is_empty() && self.steps().all(|step| step > 0.0)
    }

    /// Returns true if it never falls, and is not the same all the time.
    fn rises(&self) -> bool {
        self.rises_always() || (self.repeats() && self.span_s() > 0.0)
    }

    /// Returns true if it never falls, and stays in places.
    fn repeats(&self) -> bool {
        self.steps().all(|step| step >= 0.0) && self.steps().any(|step| step == 0.0)
    }

    /// True where it is the same in all rows.
    fn stands(&self) -> bool {
        self.times_s.len() > 1 && self.steps().all(|step| step == 0.0)
    }

    fn span_s(&self) -> f64 {
        self.times_s.last().zip(self.times_s.first()).map_or(0.0, |(last, first)| last - first)
    }

    fn step_s(&self) -> f64 {
        self.span_s() / self.times_s.len().saturating_sub(1).max(1) as f64
    }

    /// How far off its stamps may be where they repeat: a step, and a second where they are written as times of day.
    fn resolution_s(&self) -> f64 {
        let least = if self.frame.is_some() { STAMP_S } else { 0.0 };
        self.steps().fold(least, f64::max)
    }

    /// Returns true if both go on alike, wherever they count from.
    fn runs_with(&self, other: &Self) -> bool {
        let tolerance = match (self.rises_always(), other.rises_always()) {
            (true, true) => {
                let span = self.span_s().min(other.span_s());
                self.step_s().min(other.step_s()).min(SAME_RATE * span)
            }
            (true, false) => other.resolution_s(),
            (false, true) => self.resolution_s(),
            (false, false) => self.resolution_s().max(other.resolution_s()),
        };
        self.differences(other).all(|difference| difference.abs() <= tolerance)
    }

    /// By how much the other has gone on further since its first stamp, row by row.
    fn differences(&self, other: &Self) -> impl Iterator<Item = f64> {
        let first = |track: &Self| track.times_s.first().copied().unwrap_or(0.0);
        let (own, others) = (first(self), first(other));
        self.times_s.iter().zip(&other.times_s).map(move |(a, b)| (b - others) - (a - own))
    }

    /// Returns true if both begin at about the same time.
    fn begins_with(&self, other: &Self) -> bool {
        let reach = 2.0 * self.step_s().max(other.step_s());
        self.frame == other.frame && (self.start_s - other.start_s).abs() <= reach
    }

    /// Returns true if the other is another reading of this clock: the same numbers, or numbers that count from
    /// elsewhere.
    fn is_told_by(&self, other: &Self) -> bool {
        if !self.begins_with(other) {
            return self.runs_with(other);
        }
        self.is_echoed_by(other)
    }

    /// Returns true if the other has the same numbers.
    fn is_echoed_by(&self, other: &Self) -> bool {
        let apart = (self.start_s - other.start_s).abs();
        self.frame == other.frame && self.differences(other).all(|difference| apart + difference.abs() <= self.same_s())
    }

    /// Up to this, times are the same, s.
    fn same_s(&self) -> f64 {
        SAME_STEP * self.step_s()
    }
}

/// The clocks of a table.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Clocks {
    pub(super) columns: Vec<usize>,
    /// Column that could have been the first.
    pub(super) passed_over: Option<usize>,
    /// Channels with the same numbers as the first clock, which have to go on so, up to `same_s`.
    pub(super) echoes: Vec<usize>,
    pub(super) same_s: f64,
}

/// A column that may be a clock or a channel, and the clock before it.
#[derive(Debug, PartialEq)]
pub(super) struct Doubt {
    pub(super) column: usize,
    pub(super) clock: usize,
}

/// Which of the candidates, the first of which is named as the table's clock, are clocks, in a table of so many
/// columns.
///
/// The first is, unless it repeats itself and another shows the same time and rises with every row. Another is a clock
/// if it is between channels, and either is named as the first, or rises with every row from about the same time as the
/// first, but faster or slower. It is a channel where it falls or stays, where no channel follows it, or where it is
/// another reading of the first, as it may be by the same name in another unit. What is in all rows is never a
/// clock. All else may be either.
pub(super) fn choose(mut candidates: Vec<Candidate>, width: usize) -> Result<Clocks, Doubt> {
    let mut is_first = true;
    candidates.retain(|candidate| {
        std::mem::take(&mut is_first) || candidate.likeness == Likeness::Same || candidate.track.rises()
    });
    let Some(first) = candidates.first() else { return Ok(Clocks::default()) };
    let is_finer = |other: &&Candidate| {
        let is_block = other.likeness == Likeness::Same && Place::of(other.column, &candidates, width).is_after_channel;
        !is_block && first.track.repeats() && other.track.rises_always() && first.track.runs_with(&other.track)
    };
    let finer = candidates.iter().find(is_finer);
    let main = finer.unwrap_or(first);
    let passed_over = finer.map(|_| first.column);
    let mut clocks = Clocks { passed_over, same_s: main.track.same_s(), ..Clocks::default() };
    for candidate in &candidates {
        let place = Place::of(candidate.column, &candidates, width);
        let column = candidate.column;
        let is_passed_over = passed_over == Some(column);
        if column == main.column || (!is_passed_over && is_clock(candidate, main, &place)?) {
            clocks.columns.push(column);
        } else if !is_passed_over && place.has_channels && main.track.is_echoed_by(&candidate.track) {
            clocks.echoes.push(column);
        }
    }
    Ok(clocks)
}

/// Neighbours of a candidate.
struct Place {
    is_after_channel: bool,
    is_before_channel: bool,
    /// True if a channel follows, maybe after other candidates.
    has_channels: bool,
}

impl Place {
    fn of(column: usize, candidates: &[Candidate], width: usize) -> Self {
        let is_channel = |column: usize| column < width && candidates.iter().all(|other| other.column != column);
        let mut behind = (column + 1..width).skip_while(|&column| !is_channel(column));
        Self {
            is_after_channel: column.checked_sub(1).is_some_and(is_channel),
            is_before_channel: is_channel(column + 1),
            has_channels: behind.next().is_some(),
        }
    }
}

fn is_clock(candidate: &Candidate, main: &Candidate, place: &Place) -> Result<bool, Doubt> {
    let track = &candidate.track;
    if candidate.likeness == Likeness::Same && place.is_after_channel {
        return Ok(!track.stands());
    }
    let is_between = place.is_after_channel && place.is_before_channel;
    let is_like_clock = is_between && track.rises_always() && main.track.begins_with(track);
    match place.has_channels && track.rises() {
        true if is_like_clock && candidate.likeness == Likeness::SameLetter => Ok(true),
        true if main.track.is_told_by(track) => Ok(false),
        true if is_like_clock && !main.track.runs_with(track) => Ok(true),
        true if candidate.likeness == Likeness::OtherUnit && place.is_after_channel => Ok(track.rises_always()),
        true => Err(Doubt { column: candidate.column, clock: main.column }),
        false => Ok(false),
    }
}
