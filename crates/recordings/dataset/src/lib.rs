//! From named channels of recordings to an [`ident::Dataset`]: one clock, missing samples marked, nothing else changed.
//!
//! This is the way in for data that need no bench: no roles, no conversion of units. What was done to a channel to
//! bring it onto the common clock is said in [`Adjustment`]s.

mod error;
pub mod inspection;
mod one_clock;
mod options;
mod timed;

use faer::Mat;
use ident::{Dataset, Experiment, Intersample, Label};
use recording::Recording;
use units::may_be_same;

pub use error::DatasetError;
pub use one_clock::{OnOneClock, instant_s, on_one_clock};
pub use options::CommonClock;
pub use options::{Adjustment, DatasetOptions, Resampling};
use options::{MOST_SAMPLES, SAME_SHARE};
use timed::{Clock, Part, Timed};

/// Channels of several recordings, one experiment a recording.
///
/// A channel that is faster than the data's clock is interpolated after a low-pass filter: of an input, what it does
/// between its own samples is filtered, and between those of the data it is band-limited, as they then say
/// ([`Dataset::intersample`]). Samples of an output hold besides what images of a held input above half of its own
/// sample rate leave: on a clock only twice as long this moved the pole of a lag at 0.06 of its rate by 0.7 %, and on
/// one five times as long by 0.01 %. An input that is slower is continued as the options say inputs behave between
/// samples; an output that is slower is known only at the instants nearest to its samples, and missing between them:
/// values that were not measured are not made up. Missing samples and NaN stay missing.
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

    /// Beginning and length of the time in which all channels were recorded, s.
    fn common_time(&self) -> Result<(f64, f64), DatasetError> {
        let last = self.channels.iter().max_by(|a, b| a.start_s.total_cmp(&b.start_s));
        let first = self.channels.iter().min_by(|a, b| a.end_s.total_cmp(&b.end_s));
        let (Some(last), Some(first)) = (last, first) else { return Ok((0.0, 0.0)) };
        if last.start_s > first.end_s {
            return Err(DatasetError::NoCommonTime {
                file: self.file.to_owned(),
                first: first.channel.name.clone(),
                end_s: first.end_s,
                second: last.channel.name.clone(),
                start_s: last.start_s,
            });
        }
        Ok((last.start_s, first.end_s - last.start_s))
    }

    fn experiment(
        &self,
        sample_time_s: f64,
        options: &DatasetOptions,
        adjustments: &mut Vec<Adjustment>,
    ) -> Result<Experiment, DatasetError> {
        let (start_s, duration_s) = self.common_time()?;
        let usable = sample_time_s.is_finite() && sample_time_s > 0.0 && duration_s >= sample_time_s;
        if !usable || duration_s / sample_time_s > MOST_SAMPLES {
            return Err(DatasetError::SampleTime { file: self.file.to_owned(), sample_time_s, duration_s });
        }
        let clock = Clock::within(start_s, duration_s, sample_time_s);
        let count = clock.count;
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
