//! From named channels of recordings to an [`ident::Dataset`]: one clock, missing samples marked, nothing else changed.
//!
//! This is the way in for data that need no bench: no roles, no conversion of units. What was done to a channel to bring
//! it onto the common clock is said in [`Adjustment`]s.

use faer::Mat;
use ident::{Dataset, Experiment, IdentError, Label};
use recording::{Channel, Recording};
use signal::clock::check_clock;
use signal::resample::{Interpolation, interpolate_at};
use signal::{Signal, SignalError, Sos};

use crate::names::closest;

/// Time stamps further from the clock than this share of the sample time are interpolated.
const JITTER_SHARE: f64 = 0.1;
/// Sample times that differ by less than this share are the same.
const SAME_SHARE: f64 = 1e-3;
/// Longest record, in samples of the common clock.
const MOST_SAMPLES: f64 = 1e9;

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
    /// Sample time of the data, s; that of the slowest channel where it is not given.
    pub sample_time_s: Option<f64>,
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
    /// It was brought from another sample time; faster channels through a low-pass filter without phase shift.
    Resampled {
        /// The channel.
        channel: String,
        /// Its own sample time, s.
        from_s: f64,
        /// That of the data, s.
        to_s: f64,
    },
    /// An output slower than the data's clock: it is known only where it was measured.
    Sparse {
        /// The channel.
        channel: String,
        /// Its own sample time, s.
        sample_time_s: f64,
    },
    /// Samples are missing, and marked so.
    Missing {
        /// The channel.
        channel: String,
        /// How many.
        count: usize,
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
        "{file}: the time stamps of \"{channel}\" do not rise at sample {sample}; export the recording again, or cut it before that with --to"
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
    #[error("{file}: \"{channel}\" has fewer than two samples between {from_s} s and {to_s} s")]
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

/// Channels of several recordings, one experiment a recording.
///
/// A channel on another clock than the data's is interpolated, after a low-pass filter if it is the faster one; missing
/// samples and NaN stay missing. An output that is slower than the data's clock is known only at the instants nearest to its
/// samples, and missing between them: values that were not measured are not made up. Without a sample time in the options the slowest channel of the first recording gives it.
///
/// # Errors
/// [`DatasetError`].
pub fn dataset(
    recordings: &[(&str, &Recording)],
    options: &DatasetOptions,
) -> Result<(Dataset, Vec<Adjustment>), DatasetError> {
    let mut adjustments = Vec::new();
    let mut data: Option<Dataset> = None;
    for (file, recording) in recordings {
        let part = Part::new(file, recording, options)?;
        let sample_time_s = match (&data, options.sample_time_s) {
            (_, Some(given)) => given,
            (Some(before), None) => part.check_against(before.sample_time_s())?,
            (None, None) => part.slowest_s(),
        };
        let experiment = part.experiment(sample_time_s, options.inputs.len(), &mut adjustments)?;
        data = Some(match data {
            Some(before) => before.with_experiment(experiment)?,
            None => first(experiment, sample_time_s, &part)?,
        });
    }
    Ok((data.ok_or(DatasetError::Empty)?, adjustments))
}

fn first(experiment: Experiment, sample_time_s: f64, part: &Part<'_>) -> Result<Dataset, DatasetError> {
    let labels = part.channels.iter().map(|c| Label::new(&c.channel.name, &c.channel.unit));
    let mut labels: Vec<Label> = labels.collect();
    let outputs = labels.split_off(experiment.inputs.ncols());
    let (name, start_s) = (experiment.name.clone(), experiment.start_s);
    let data = Dataset::new(sample_time_s, experiment.inputs, experiment.outputs)?;
    let named = data.map_experiments(|e| Ok(Experiment { name: name.clone(), start_s, ..e.clone() }))?;
    Ok(named.with_labels(labels, outputs)?)
}

/// The channels of one recording, inputs first.
struct Part<'r> {
    file: &'r str,
    channels: Vec<Timed<'r>>,
}

/// A channel with the samples in the asked-for time that are numbers.
struct Timed<'r> {
    channel: &'r Channel,
    time_s: Vec<f64>,
    values: Vec<f64>,
    sample_time_s: f64,
    start_s: f64,
    end_s: f64,
}

impl<'r> Part<'r> {
    fn new(file: &'r str, recording: &'r Recording, options: &DatasetOptions) -> Result<Self, DatasetError> {
        let names = options.inputs.iter().chain(&options.outputs);
        let channels = names.map(|name| Timed::new(file, recording, name, options)).collect::<Result<_, _>>()?;
        Ok(Part { file, channels })
    }

    fn slowest_s(&self) -> f64 {
        self.channels.iter().map(|c| c.sample_time_s).fold(0.0, f64::max)
    }

    fn check_against(&self, expected_s: f64) -> Result<f64, DatasetError> {
        let found_s = self.slowest_s();
        if (found_s - expected_s).abs() <= SAME_SHARE * expected_s {
            return Ok(expected_s);
        }
        Err(DatasetError::SampleTimesDiffer { file: self.file.to_owned(), found_s, expected_s })
    }

    fn experiment(
        &self,
        sample_time_s: f64,
        inputs: usize,
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
        let on_clock = |(index, c): (usize, &Timed<'_>)| c.on_clock(self.file, clock, index >= inputs, adjustments);
        let columns = self.channels.iter().enumerate().map(on_clock);
        let columns: Vec<Vec<f64>> = columns.collect::<Result<_, _>>()?;
        let table = |columns: &[Vec<f64>]| Mat::from_fn(count, columns.len(), |i, j| columns[j][i]);
        let (left, right) = columns.split_at(inputs);
        Ok(Experiment { name: self.file.to_owned(), start_s, inputs: table(left), outputs: table(right) })
    }
}

/// The clock of the data.
#[derive(Clone, Copy)]
struct Clock {
    start_s: f64,
    sample_time_s: f64,
    count: usize,
}

impl<'r> Timed<'r> {
    fn new(file: &str, recording: &'r Recording, name: &str, options: &DatasetOptions) -> Result<Self, DatasetError> {
        let count = recording.channels.iter().filter(|c| c.name == name).count();
        if count > 1 {
            return Err(DatasetError::Ambiguous { file: file.to_owned(), channel: name.to_owned(), count });
        }
        let channel = recording.channel(name).ok_or_else(|| DatasetError::NoChannel {
            file: file.to_owned(),
            channel: name.to_owned(),
            closest: closest(name, recording.channels.iter().map(|c| c.name.as_str()), 3),
        })?;
        let stamps = recording.time_s(channel).unwrap_or_default();
        let (from_s, to_s) = (options.from_s.unwrap_or(f64::NEG_INFINITY), options.to_s.unwrap_or(f64::INFINITY));
        let in_time = stamps.iter().zip(&channel.samples).filter(|(t, _)| (from_s..=to_s).contains(*t));
        let (all_s, all): (Vec<f64>, Vec<f64>) = in_time.map(|(t, v)| (*t, *v)).unzip();
        if let Some(sample) = all_s.windows(2).position(|pair| pair[1] <= pair[0]) {
            let (file, channel) = (file.to_owned(), name.to_owned());
            return Err(DatasetError::TimeNotRising { file, channel, sample: sample + 1 });
        }
        let nothing = || DatasetError::NothingLeft { file: file.to_owned(), channel: name.to_owned(), from_s, to_s };
        let check = check_clock(&all_s).map_err(|_| nothing())?;
        let (start_s, end_s) = (all_s[0], all_s[all_s.len() - 1]);
        let (time_s, values): (Vec<f64>, Vec<f64>) = all_s.into_iter().zip(all).filter(|(_, v)| v.is_finite()).unzip();
        if time_s.len() < 2 {
            return Err(nothing());
        }
        let intervals = ((end_s - start_s) / check.sample_time_s).round().max(1.0);
        let sample_time_s = (end_s - start_s) / intervals;
        Ok(Timed { channel, time_s, values, sample_time_s, start_s, end_s })
    }

    /// The channel's values on the clock, NaN where they are missing.
    fn on_clock(
        &self,
        file: &str,
        clock: Clock,
        is_output: bool,
        log: &mut Vec<Adjustment>,
    ) -> Result<Vec<f64>, DatasetError> {
        let name = || self.channel.name.clone();
        let largest_s = self.largest_deviation();
        if largest_s > JITTER_SHARE * self.sample_time_s {
            log.push(Adjustment::Jitter { channel: name(), largest_s });
        }
        let same = (self.sample_time_s - clock.sample_time_s).abs() <= SAME_SHARE * clock.sample_time_s;
        let is_slower = self.sample_time_s > clock.sample_time_s;
        let column = match same {
            true => self.straight(clock),
            false if is_output && is_slower => {
                log.push(Adjustment::Sparse { channel: name(), sample_time_s: self.sample_time_s });
                return Ok(self.sparse(clock));
            }
            false => {
                let (from_s, to_s) = (self.sample_time_s, clock.sample_time_s);
                log.push(Adjustment::Resampled { channel: name(), from_s, to_s });
                let resampled = self.resampled(clock);
                resampled.map_err(|source| DatasetError::Signal { file: file.to_owned(), channel: name(), source })?
            }
        };
        let count = column.iter().filter(|v| v.is_nan()).count();
        if count > 0 {
            log.push(Adjustment::Missing { channel: name(), count });
        }
        Ok(column)
    }

    fn largest_deviation(&self) -> f64 {
        let deviation = |t: &f64| {
            let position = (t - self.start_s) / self.sample_time_s;
            (position - position.round()).abs() * self.sample_time_s
        };
        self.time_s.iter().map(deviation).fold(0.0, f64::max)
    }

    /// Values on straight lines between samples no further apart than one and a half sample times.
    fn straight(&self, clock: Clock) -> Vec<f64> {
        let mut left = 0;
        let value = |k: usize| {
            let time_s = clock.start_s + k as f64 * clock.sample_time_s;
            while left + 2 < self.time_s.len() && self.time_s[left + 1] <= time_s {
                left += 1;
            }
            let (before, after) = (self.time_s[left], self.time_s[left + 1]);
            let share = (time_s - before) / (after - before);
            let near = 1e-6 * self.sample_time_s / (after - before);
            // On a sample its value, whatever the neighbour.
            if (share - share.round()).abs() <= near && (0.0..=1.0).contains(&share.round()) {
                return self.values[left + share.round() as usize];
            }
            let is_gap = after - before > 1.5 * self.sample_time_s || !(0.0..=1.0).contains(&share);
            if is_gap { f64::NAN } else { self.values[left] + share * (self.values[left + 1] - self.values[left]) }
        };
        (0..clock.count).map(value).collect()
    }

    /// Values at the ticks nearest to the samples, on straight lines between these; NaN at all other ticks.
    fn sparse(&self, clock: Clock) -> Vec<f64> {
        let straight = self.straight(clock);
        let mut values = vec![f64::NAN; clock.count];
        for time_s in &self.time_s {
            let tick = ((time_s - clock.start_s) / clock.sample_time_s).round();
            if tick >= 0.0 && tick < clock.count as f64 {
                values[tick as usize] = straight[tick as usize];
            }
        }
        values
    }

    /// The channel on its own clock, without gaps, through an anti-alias filter if the data's clock is the slower one, and
    /// then at the instants of that clock; what lies in a gap is missing.
    fn resampled(&self, clock: Clock) -> Result<Vec<f64>, SignalError> {
        let count = ((self.end_s - self.start_s) / self.sample_time_s).round() as usize + 1;
        let own = Clock { start_s: self.start_s, sample_time_s: self.sample_time_s, count };
        let marked = self.straight(own);
        let mut whole = Signal::new(self.start_s, self.sample_time_s, bridged(&marked))?;
        let is_slower = clock.sample_time_s > self.sample_time_s;
        if is_slower {
            let cutoff_hz = 0.4 / clock.sample_time_s;
            let filter = Sos::butterworth_lowpass(8, cutoff_hz, self.sample_time_s)?;
            whole.samples = filter.filtfilt(&whole.samples)?;
        }
        let method = if is_slower { Interpolation::BandLimited } else { Interpolation::Linear };
        let times: Vec<f64> = (0..clock.count)
            .map(|k| (clock.start_s + k as f64 * clock.sample_time_s).clamp(whole.start_s, whole.end_s()))
            .collect();
        let mut values = interpolate_at(&whole, &times, method)?;
        for (value, time_s) in values.iter_mut().zip(&times) {
            let position = ((time_s - self.start_s) / self.sample_time_s).round() as usize;
            if marked.get(position).is_none_or(|v| v.is_nan()) {
                *value = f64::NAN;
            }
        }
        Ok(values)
    }
}

/// Missing values on straight lines between their neighbours; the first and last known value beyond them.
fn bridged(values: &[f64]) -> Vec<f64> {
    let known: Vec<usize> = (0..values.len()).filter(|i| !values[*i].is_nan()).collect();
    let mut next = 0;
    let value = |i: usize| {
        while next < known.len() && known[next] < i {
            next += 1;
        }
        match (next.checked_sub(1).map(|n| known[n]), known.get(next)) {
            (_, Some(&b)) if b == i => values[i],
            (Some(a), Some(&b)) => values[a] + (values[b] - values[a]) * (i - a) as f64 / (b - a) as f64,
            (Some(a), None) => values[a],
            (None, Some(&b)) => values[b],
            (None, None) => f64::NAN,
        }
    };
    (0..values.len()).map(value).collect()
}
