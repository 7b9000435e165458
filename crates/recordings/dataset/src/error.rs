//! Why channels cannot be brought onto one clock.

use ident::IdentError;
use signal::SignalError;

/// Why channels cannot become data.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DatasetError {
    /// A channel that is not there.
    #[error("{file}: there is no channel \"{channel}\"; the closest names are {}", .closest.join(", "))]
    NoChannel {
        /// The file.
        file: String,
        /// The channel asked for.
        channel: String,
        /// Those with the most similar names.
        closest: Vec<String>,
    },
    /// Several channels of one name.
    #[error("{file}: {count} channels are called \"{channel}\"; rename them, so that one can be chosen")]
    Ambiguous {
        /// The file.
        file: String,
        /// The name.
        channel: String,
        /// How many there are.
        count: usize,
    },
    /// Time stamps that do not rise.
    #[error(
        "{file}: the time stamps of \"{channel}\" do not rise at sample {sample}; export the recording again, or cut it before that"
    )]
    TimeNotRising {
        /// The file.
        file: String,
        /// The channel.
        channel: String,
        /// The first stamp not later than the one before, counted from 0.
        sample: usize,
    },
    /// Too little is left.
    #[error("{file}: \"{channel}\" has fewer than two samples that are numbers{}", window(*from_s, *to_s))]
    NothingLeft {
        /// The file.
        file: String,
        /// The channel.
        channel: String,
        /// Start, s.
        from_s: f64,
        /// End, s.
        to_s: f64,
    },
    /// Channels that were never recorded at the same time.
    #[error(
        "{file}: \"{first}\" ends at {end_s} s, and \"{second}\" begins at {start_s} s: they have no time in common. Their clocks have different starts; choose channels of one clock, or export them on one"
    )]
    NoCommonTime {
        /// The file.
        file: String,
        /// The channel that ends first.
        first: String,
        /// Its end, s.
        end_s: f64,
        /// The channel that begins last.
        second: String,
        /// Its beginning, s.
        start_s: f64,
    },
    /// A sample time that makes no sense for the record.
    #[error("{file}: a sample time of {sample_time_s} s cannot be used on {duration_s} s of recording")]
    SampleTime {
        /// The file.
        file: String,
        /// The sample time, s.
        sample_time_s: f64,
        /// The record's length, s.
        duration_s: f64,
    },
    /// Recordings with different sample times.
    #[error(
        "{file}: its sample time is {found_s} s, that of the first recording {expected_s} s; give one for all with --sample-time"
    )]
    SampleTimesDiffer {
        /// The file.
        file: String,
        /// Of this recording, s.
        found_s: f64,
        /// Of the first, s.
        expected_s: f64,
    },
    /// A channel in another unit than in the first recording.
    #[error(
        "{file}: \"{channel}\" is in {found}, in the first recording in {expected}; bring them to one unit before they are used together"
    )]
    UnitsDiffer {
        /// The file.
        file: String,
        /// The channel.
        channel: String,
        /// Its unit in this recording.
        found: String,
        /// That in the first.
        expected: String,
    },
    /// A channel with so few samples for its time that they are no record of it.
    #[error("{file}: \"{channel}\" has only {samples} samples where its clock would have {of}, too few to filter")]
    MostlyGaps {
        /// The file.
        file: String,
        /// The channel.
        channel: String,
        /// Its samples.
        samples: usize,
        /// Samples without gaps.
        of: usize,
    },
    /// Nothing can be brought onto a clock.
    #[error("{file}: no channel can be brought onto a clock of {sample_time_s} s")]
    NoneOnClock {
        /// The file.
        file: String,
        /// The clock's sample time, s.
        sample_time_s: f64,
    },
    /// No recording was given.
    #[error("no recording was given")]
    Empty,
    /// A channel cannot be filtered or interpolated.
    #[error("{file}: \"{channel}\": {source}")]
    Signal {
        /// The file.
        file: String,
        /// The channel.
        channel: String,
        /// Why.
        source: SignalError,
    },
    /// The channels are no data.
    #[error(transparent)]
    Ident(#[from] IdentError),
}

/// The asked-for time, where one was asked for.
fn window(from_s: f64, to_s: f64) -> String {
    match (from_s.is_finite(), to_s.is_finite()) {
        (true, true) => format!(" between {from_s} s and {to_s} s"),
        (true, false) => format!(" from {from_s} s on"),
        (false, true) => format!(" up to {to_s} s"),
        (false, false) => String::new(),
    }
}
