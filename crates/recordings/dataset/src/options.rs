//! Options of a dataset, and the adjustments of its channels.

use ident::Intersample;

/// Sample times that differ by less than this share are the same.
pub(super) const SAME_SHARE: f64 = 1e-3;

/// Longest record, in samples of the common clock.
pub(super) const MOST_SAMPLES: f64 = 1e9;

/// Which channels, from when to when, on which clock.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct DatasetOptions {
    /// Channels that act on the system.
    pub inputs: Vec<String>,
    /// Channels that answer.
    pub outputs: Vec<String>,
    /// Start on the recording's clock, s.
    pub from_s: Option<f64>,
    /// End on the recording's clock, s.
    pub to_s: Option<f64>,
    /// The clock of the data.
    pub clock: CommonClock,
    /// Behaviour of the inputs between their own samples: this is how inputs that are slower than the clock are
    /// continued.
    pub intersample: Intersample,
}

/// How a channel gets from its clock to another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Resampling {
    /// Faster than the data: through a low-pass filter without phase shift.
    Filtered,
    /// Slower than the data, or as slow and sampled beside their ticks: each value stays until the next.
    Held,
    /// Slower than the data: on straight lines from value to value.
    Straight,
    /// As slow as the data, but sampled beside their ticks: on straight lines.
    Beside,
    /// Slower than the data: as a signal without content above half its own sample rate.
    BandLimited,
}

/// Change of a channel on its way to the common clock.
#[derive(Debug, Clone, PartialEq)]
pub enum Adjustment {
    /// Values between its samples were found on straight lines, since its time stamps are not on a clock.
    Jitter {
        /// The channel.
        channel: String,
        /// Largest distance of a stamp from the clock, s.
        largest_s: f64,
    },
    /// It takes few different whole values: each stays until the next.
    State {
        /// The channel.
        channel: String,
        /// Its own sample time, s.
        from_s: f64,
    },
    /// It was brought from another sample time.
    Resampled {
        /// The channel.
        channel: String,
        /// Its own sample time, s.
        from_s: f64,
        /// That of the data, s.
        to_s: f64,
        /// How.
        how: Resampling,
    },
    /// An output slower than the data's clock: it is known only where it was measured.
    Sparse {
        /// The channel.
        channel: String,
        /// Its own sample time, s.
        sample_time_s: f64,
    },
    /// Of the inputs one was filtered and is band-limited between samples, and another was not: all are taken for
    /// band-limited.
    Mixed {
        /// The filtered one.
        filtered: String,
        /// The other.
        other: String,
    },
    /// Samples are missing, and marked so.
    Missing {
        /// The channel.
        channel: String,
        /// How many.
        count: usize,
        /// Of how many: on the clock of the data, or on its own for an output that is slower.
        of: usize,
    },
}

/// The clock that channels of several sample times are brought onto.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum CommonClock {
    /// That of the slowest channel of the first recording: every sample of every channel is there.
    #[default]
    Slowest,
    /// That of the fastest channel of the first recording, for methods that see through missing outputs: nothing is
    /// filtered, and outputs are known where they were measured.
    Fastest,
    /// A sample every so many seconds.
    Every(f64),
}
