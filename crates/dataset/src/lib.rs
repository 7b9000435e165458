//! From named channels of recordings to an [`ident::Dataset`]: one clock, missing samples marked, nothing else changed.
//!
//! This is the way in for data that need no bench: no roles, no conversion of units. What was done to a channel to bring
//! it onto the common clock is said in [`Adjustment`]s.

mod one_clock;
mod timed;

use faer::Mat;
use ident::{Dataset, Experiment, IdentError, Intersample, Label};
use recording::Recording;
use signal::SignalError;
use units::may_be_same;

pub use one_clock::{OnOneClock, instant_s, on_one_clock};
use timed::{Clock, Part, Timed};

/// Sample times that differ by less than this share are the same.
const SAME_SHARE: f64 = 1e-3;
/// Longest record, in samples of the common clock.
const MOST_SAMPLES: f64 = 1e9;

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
    /// What the inputs do between their own samples: this is how inputs that are slower than the clock are continued.
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

/// What was done to a channel on its way to the common clock.
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

/// Channels of several recordings, one experiment a recording.
///
/// A channel that is faster than the data's clock is interpolated after a low-pass filter: of an input, what it does
/// between its own samples is filtered, and between those of the data it is band-limited, as they then say
/// ([`Dataset::intersample`]). Samples of an output hold besides what images of a held input above half of its own sample
/// rate leave: on a clock only twice as long this moved the pole of a lag at 0.06 of its rate by 0.7 %, and on one five
/// times as long by 0.01 %. An input that is slower is
/// continued as the options say inputs behave between samples; an output that is slower is known only at the instants
/// nearest to its samples, and missing between them: values that were not measured are not made up. Missing samples and
/// NaN stay missing.
///
/// # Errors
/// [`DatasetError`].
pub fn dataset(
    recordings: &[(&str, &Recording)],
    options: &DatasetOptions,
) -> Result<(Dataset, Vec<Adjustment>), DatasetError> {
    let mut adjustments = Vec::new();
    let mut data: Option<Dataset> = None;
    let (mut filtered, mut others) = (Vec::new(), Vec::new());
    for (file, recording) in recordings {
        let part = Taken::new(file, recording, options)?;
        let sample_time_s = match (&data, options.clock) {
            (_, CommonClock::Every(given_s)) => given_s,
            (Some(before), clock) => part.check_against(before.sample_time_s(), clock)?,
            (None, clock) => part.sample_time_s(clock),
        };
        if let Some(before) = &data {
            part.check_units(before)?;
        }
        let experiment = part.experiment(sample_time_s, options, &mut adjustments)?;
        for input in part.channels.iter().take(options.inputs.len()) {
            let name = (input.channel.name.clone(), *file);
            if input.is_faster(sample_time_s) { filtered.push(name) } else { others.push(name) }
        }
        data = Some(match data {
            Some(before) => before.with_experiment(experiment)?,
            None => first(experiment, sample_time_s, &part)?,
        });
    }
    if let (Some((one, in_file)), Some((other, in_other))) = (filtered.first(), others.first())
        && options.intersample != Intersample::BandLimited
    {
        let name =
            |name: &str, file: &str| if in_file == in_other { name.to_owned() } else { format!("{name}, {file}") };
        adjustments.push(Adjustment::Mixed { filtered: name(one, in_file), other: name(other, in_other) });
    }
    let intersample = if filtered.is_empty() { options.intersample } else { Intersample::BandLimited };
    Ok((data.ok_or(DatasetError::Empty)?.with_intersample(intersample), adjustments))
}

fn first(experiment: Experiment, sample_time_s: f64, part: &Taken<'_>) -> Result<Dataset, DatasetError> {
    let labels = part.channels.iter().map(|c| Label::new(&c.channel.name, &c.channel.unit));
    let mut labels: Vec<Label> = labels.collect();
    let outputs = labels.split_off(experiment.inputs.ncols());
    let (name, start_s) = (experiment.name.clone(), experiment.start_s);
    let data = Dataset::new(sample_time_s, experiment.inputs, experiment.outputs)?;
    let named = data.map_experiments(|e| Ok(Experiment { name: name.clone(), start_s, ..e.clone() }))?;
    Ok(named.with_labels(labels, outputs)?)
}

/// The channels of one recording, inputs first.
struct Taken<'r> {
    file: &'r str,
    channels: Vec<Timed<'r>>,
}

impl<'r> Taken<'r> {
    fn new(file: &'r str, recording: &'r Recording, options: &DatasetOptions) -> Result<Self, DatasetError> {
        let names = options.inputs.iter().chain(&options.outputs);
        let channels = names.map(|name| Timed::new(file, recording, name, options)).collect::<Result<_, _>>()?;
        Ok(Taken { file, channels })
    }

    fn check_units(&self, before: &Dataset) -> Result<(), DatasetError> {
        let labels = before.input_labels().iter().chain(before.output_labels());
        let mut pairs = self.channels.iter().map(|c| c.channel).zip(labels);
        match pairs.find(|(channel, label)| !may_be_same(&channel.unit, &label.unit)) {
            None => Ok(()),
            Some((channel, label)) => Err(DatasetError::UnitsDiffer {
                file: self.file.to_owned(),
                channel: channel.name.clone(),
                found: channel.unit.clone(),
                expected: label.unit.clone(),
            }),
        }
    }

    fn sample_time_s(&self, clock: CommonClock) -> f64 {
        let all = self.channels.iter().map(|c| c.sample_time_s);
        match clock {
            CommonClock::Every(given_s) => given_s,
            CommonClock::Slowest => all.fold(0.0, f64::max),
            CommonClock::Fastest => all.fold(f64::INFINITY, f64::min),
        }
    }

    fn check_against(&self, expected_s: f64, clock: CommonClock) -> Result<f64, DatasetError> {
        let found_s = self.sample_time_s(clock);
        if (found_s - expected_s).abs() <= SAME_SHARE * expected_s {
            return Ok(expected_s);
        }
        Err(DatasetError::SampleTimesDiffer { file: self.file.to_owned(), found_s, expected_s })
    }

    fn experiment(
        &self,
        sample_time_s: f64,
        options: &DatasetOptions,
        adjustments: &mut Vec<Adjustment>,
    ) -> Result<Experiment, DatasetError> {
        let start_s = self.channels.iter().map(|c| c.start_s).fold(f64::NEG_INFINITY, f64::max);
        let end_s = self.channels.iter().map(|c| c.end_s).fold(f64::INFINITY, f64::min);
        let duration_s = end_s - start_s;
        let usable = sample_time_s.is_finite() && sample_time_s > 0.0 && duration_s >= sample_time_s;
        if !usable || duration_s / sample_time_s > MOST_SAMPLES {
            return Err(DatasetError::SampleTime { file: self.file.to_owned(), sample_time_s, duration_s });
        }
        let count = (duration_s / sample_time_s + 1e-6).floor() as usize + 1;
        let clock = Clock { start_s, sample_time_s, count };
        let inputs = options.inputs.len();
        let on_clock = |(index, c): (usize, &Timed<'_>)| {
            let part = if index < inputs { Part::Input(options.intersample) } else { Part::Output };
            c.on_clock(self.file, clock, part, adjustments)
        };
        let columns = self.channels.iter().enumerate().map(on_clock);
        let columns: Vec<Vec<f64>> = columns.collect::<Result<_, _>>()?;
        let table = |columns: &[Vec<f64>]| Mat::from_fn(count, columns.len(), |i, j| columns[j][i]);
        let (left, right) = columns.split_at(inputs);
        Ok(Experiment { name: self.file.to_owned(), start_s, inputs: table(left), outputs: table(right) })
    }
}
