//! One channel on its way from its own time stamps to the clock of the data.

use ident::Intersample;
use recording::names::closest;
use recording::{Channel, Recording};
use signal::clock::check_clock;
use signal::resample::{Interpolation, band_of_held, band_of_straight, interpolate_at};
use signal::{Signal, SignalError, Sos};

use crate::error::DatasetError;
use crate::options::{Adjustment, DatasetOptions, Resampling, SAME_SHARE};

/// Time stamps further from the clock than this share of the sample time are interpolated.
const JITTER_SHARE: f64 = 0.1;
/// A channel is not filtered where its own clock has more ticks than this for each of its samples.
const MOST_CLOCK_PER_SAMPLE: usize = 100;
/// Samples further from the ticks than this share of the sample time change on the straight lines between them.
const BESIDE_SHARE: f64 = 0.01;
/// A sample is missing where two are further apart than this many sample times and than any two with none between them.
const LONGEST_SHARE: f64 = 1.5;
/// A tick this share of a sample time before a sample has the sample's value.
const NEAR_SHARE: f64 = 1e-4;
/// The last tick may lie this share of a sample time behind the last sample: two clocks that are the same but for the
/// digits of their stamps drift apart over a long recording.
const END_SHARE: f64 = 1e-3;

/// A channel with the samples in the asked-for time that are numbers.
pub(super) struct Timed<'r> {
    pub(super) channel: &'r Channel,
    time_s: Vec<f64>,
    values: Vec<f64>,
    pub(super) sample_time_s: f64,
    /// The longest time from a sample to the next in which none is missing.
    longest_s: f64,
    pub(super) start_s: f64,
    pub(super) end_s: f64,
}

/// Use of a channel.
#[derive(Clone, Copy)]
pub(super) enum Part {
    /// It answers: between its samples nothing is known of it.
    Output,
    /// It acts on the system, and does this between its samples.
    Input(Intersample),
    /// Its samples are wanted on another clock, and it is continued like this.
    Alone(Intersample),
}

/// The clock of the data.
#[derive(Clone, Copy)]
pub(super) struct Clock {
    pub(super) start_s: f64,
    pub(super) sample_time_s: f64,
    pub(super) count: usize,
}

impl Clock {
    /// The ticks from a start on, over a time that ends on one of them or later.
    pub(super) fn within(start_s: f64, duration_s: f64, sample_time_s: f64) -> Self {
        let count = (duration_s / sample_time_s + END_SHARE).floor() as usize + 1;
        Clock { start_s, sample_time_s, count }
    }

    fn at(&self, tick: usize) -> f64 {
        self.start_s + tick as f64 * self.sample_time_s
    }
}

impl<'r> Timed<'r> {
    pub(super) fn new(
        file: &str,
        recording: &'r Recording,
        name: &str,
        options: &DatasetOptions,
    ) -> Result<Self, DatasetError> {
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
        let window = (options.from_s.unwrap_or(f64::NEG_INFINITY), options.to_s.unwrap_or(f64::INFINITY));
        Self::of(file, channel, stamps, window)
    }

    /// A channel with its time stamps, of the window in s.
    pub(super) fn of(
        file: &str,
        channel: &'r Channel,
        stamps: &[f64],
        (from_s, to_s): (f64, f64),
    ) -> Result<Self, DatasetError> {
        let name = &channel.name;
        let in_time = stamps.iter().zip(&channel.samples).filter(|(t, _)| (from_s..=to_s).contains(*t));
        let room = || Vec::with_capacity(stamps.len().min(channel.samples.len()));
        let (mut time_s, mut values): (Vec<f64>, Vec<f64>) = (room(), room());
        in_time.for_each(|(t, v)| {
            time_s.push(*t);
            values.push(*v);
        });
        if let Some(sample) = time_s.windows(2).position(|pair| pair[1] <= pair[0]) {
            let (file, channel) = (file.to_owned(), name.clone());
            return Err(DatasetError::TimeNotRising { file, channel, sample: sample + 1 });
        }
        let nothing = || DatasetError::NothingLeft { file: file.to_owned(), channel: name.clone(), from_s, to_s };
        let check = check_clock(&time_s).map_err(|_| nothing())?;
        let (start_s, end_s) = (time_s[0], time_s[time_s.len() - 1]);
        if values.iter().any(|v| !v.is_finite()) {
            (time_s, values) = time_s.into_iter().zip(values).filter(|(_, v)| v.is_finite()).unzip();
        }
        if time_s.len() < 2 {
            return Err(nothing());
        }
        let intervals = ((end_s - start_s) / check.sample_time_s).round().max(1.0);
        let sample_time_s = without_rounding((end_s - start_s) / intervals);
        let longest_s = (LONGEST_SHARE * sample_time_s).max(check.sample_time_s + check.worst_jitter_s);
        Ok(Timed { channel, time_s, values, sample_time_s, longest_s, start_s, end_s })
    }

    /// Returns true if the channel has to be filtered for this clock.
    pub(super) fn is_faster(&self, clock_s: f64) -> bool {
        self.sample_time_s < clock_s && (self.sample_time_s - clock_s).abs() > SAME_SHARE * clock_s
    }

    /// The channel's values on the clock, NaN where they are missing. An input is continued between its samples, an
    /// output is not.
    pub(super) fn on_clock(
        &self,
        file: &str,
        clock: Clock,
        part: Part,
        log: &mut Vec<Adjustment>,
    ) -> Result<Vec<f64>, DatasetError> {
        let name = || self.channel.name.clone();
        let largest_s = self.largest_deviation();
        if largest_s > JITTER_SHARE * self.sample_time_s {
            log.push(Adjustment::Jitter { channel: name(), largest_s });
        }
        let same = (self.sample_time_s - clock.sample_time_s).abs() <= SAME_SHARE * clock.sample_time_s;
        let how = match part {
            _ if same && !self.is_beside(clock) => None,
            Part::Alone(Intersample::ZeroOrderHold) if same && largest_s <= JITTER_SHARE * self.sample_time_s => {
                Some(Resampling::Held)
            }
            _ if same => Some(Resampling::Beside),
            _ if self.is_faster(clock.sample_time_s) => Some(Resampling::Filtered),
            Part::Output => {
                log.push(Adjustment::Sparse { channel: name(), sample_time_s: self.sample_time_s });
                self.log_missing(self.own_count().saturating_sub(self.values.len()), self.own_count(), log);
                return Ok(self.sparse(clock));
            }
            Part::Input(Intersample::ZeroOrderHold) | Part::Alone(Intersample::ZeroOrderHold) => Some(Resampling::Held),
            Part::Input(Intersample::FirstOrderHold) | Part::Alone(Intersample::FirstOrderHold) => {
                Some(Resampling::Straight)
            }
            Part::Input(Intersample::BandLimited) | Part::Alone(Intersample::BandLimited) => {
                Some(Resampling::BandLimited)
            }
        };
        if let Some(how) = how {
            let (from_s, to_s) = (self.sample_time_s, clock.sample_time_s);
            log.push(Adjustment::Resampled { channel: name(), from_s, to_s, how });
        }
        if matches!(how, Some(Resampling::Filtered | Resampling::BandLimited)) {
            self.check_density(file)?;
        }
        let failed = |source| DatasetError::Signal { file: file.to_owned(), channel: name(), source };
        let column = match how {
            None | Some(Resampling::Straight | Resampling::Beside) => self.straight(clock),
            Some(Resampling::Held) => self.held(clock),
            Some(Resampling::Filtered) => self.resampled(clock, Some(part)).map_err(failed)?,
            Some(Resampling::BandLimited) => self.resampled(clock, None).map_err(failed)?,
        };
        self.log_missing(column.iter().filter(|v| v.is_nan()).count(), column.len(), log);
        Ok(column)
    }

    /// The channel's last value at every tick of the clock, NaN where samples are missing.
    pub(super) fn state(&self, clock: Clock, log: &mut Vec<Adjustment>) -> Vec<f64> {
        if (self.sample_time_s - clock.sample_time_s).abs() > SAME_SHARE * clock.sample_time_s {
            log.push(Adjustment::State { channel: self.channel.name.clone(), from_s: self.sample_time_s });
        }
        let column = self.held(clock);
        self.log_missing(column.iter().filter(|v| v.is_nan()).count(), column.len(), log);
        column
    }

    /// Refuses to fill a clock that the channel has hardly any samples of.
    fn check_density(&self, file: &str) -> Result<(), DatasetError> {
        let (samples, of) = (self.values.len(), self.own_count());
        if of <= MOST_CLOCK_PER_SAMPLE * samples {
            return Ok(());
        }
        Err(DatasetError::MostlyGaps { file: file.to_owned(), channel: self.channel.name.clone(), samples, of })
    }

    fn log_missing(&self, count: usize, of: usize, log: &mut Vec<Adjustment>) {
        if count > 0 {
            log.push(Adjustment::Missing { channel: self.channel.name.clone(), count, of });
        }
    }

    /// Returns true if the samples lie between the ticks of a clock of the same sample time.
    fn is_beside(&self, clock: Clock) -> bool {
        let position = (self.start_s - clock.start_s) / clock.sample_time_s;
        (position - position.round()).abs() > BESIDE_SHARE
    }

    /// Samples that the channel would have on its own clock without gaps.
    fn own_count(&self) -> usize {
        ((self.end_s - self.start_s) / self.sample_time_s).round() as usize + 1
    }

    fn largest_deviation(&self) -> f64 {
        let deviation = |t: &f64| {
            let position = (t - self.start_s) / self.sample_time_s;
            (position - position.round()).abs() * self.sample_time_s
        };
        self.time_s.iter().map(deviation).fold(0.0, f64::max)
    }

    /// Values on straight lines between samples with none missing between them.
    fn straight(&self, clock: Clock) -> Vec<f64> {
        let mut left = 0;
        let value = |k: usize| {
            let time_s = clock.at(k);
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
            if share > 1.0 && time_s - after <= END_SHARE * self.sample_time_s && left + 2 == self.time_s.len() {
                return self.values[left + 1];
            }
            let is_gap = after - before > self.longest_s || !(0.0..=1.0).contains(&share);
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

    /// At each tick the last sample before it, for one own sample time at most: what comes later is in a gap.
    fn held(&self, clock: Clock) -> Vec<f64> {
        let near_s = NEAR_SHARE * clock.sample_time_s;
        let mut next = 0;
        let value = |k: usize| {
            let time_s = clock.at(k) + near_s;
            while next < self.time_s.len() && self.time_s[next] <= time_s {
                next += 1;
            }
            let Some(last) = next.checked_sub(1) else { return f64::NAN };
            let until = self.time_s.get(next).map_or(f64::INFINITY, |after| after - self.time_s[last]);
            let is_gap = until > self.longest_s && time_s - self.time_s[last] >= self.sample_time_s;
            if is_gap { f64::NAN } else { self.values[last] }
        };
        (0..clock.count).map(value).collect()
    }

    /// The channel on its own clock, without gaps, through an anti-alias filter where it is `filtered`, and then as a
    /// band-limited signal at the instants of the data's clock; what lies in a gap is missing. Of an input, what it
    /// does between its samples is filtered, not the samples alone.
    fn resampled(&self, clock: Clock, filtered: Option<Part>) -> Result<Vec<f64>, SignalError> {
        let own = Clock { start_s: self.start_s, sample_time_s: self.sample_time_s, count: self.own_count() };
        let marked = self.straight(own);
        let mut whole = Signal::new(self.start_s, self.sample_time_s, bridged(&marked))?;
        if let Some(part) = filtered {
            whole = match part {
                Part::Input(Intersample::ZeroOrderHold) => band_of_held(&whole)?,
                Part::Input(Intersample::FirstOrderHold) => band_of_straight(&whole)?,
                _ => whole,
            };
            let cutoff_hz = 0.4 / clock.sample_time_s;
            let filter = Sos::butterworth_lowpass(8, cutoff_hz, self.sample_time_s)?;
            whole.samples = filter.filtfilt(&whole.samples)?;
        }
        let times: Vec<f64> = (0..clock.count).map(|k| clock.at(k).clamp(whole.start_s, whole.end_s())).collect();
        let mut values = interpolate_at(&whole, &times, Interpolation::BandLimited)?;
        for (tick, value) in values.iter_mut().enumerate() {
            let is_outside = (clock.at(tick) - times[tick]).abs() > NEAR_SHARE * self.sample_time_s;
            let position = ((times[tick] - self.start_s) / self.sample_time_s).round() as usize;
            if is_outside || marked.get(position).is_none_or(|v| v.is_nan()) {
                *value = f64::NAN;
            }
        }
        Ok(values)
    }
}

/// A sample time without the last digits, which are the rounding of time stamps: over the longest record they amount to
/// less than a thousandth of a sample.
fn without_rounding(sample_time_s: f64) -> f64 {
    format!("{sample_time_s:.11e}").parse().unwrap_or(sample_time_s)
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
