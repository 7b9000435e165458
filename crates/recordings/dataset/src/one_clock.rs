//! All channels of a recording on one clock.

use ident::Intersample;
use recording::{Channel, Raster, Recording};

use super::timed::{Clock, Part, Timed};
use crate::error::DatasetError;
use crate::options::{Adjustment, MOST_SAMPLES};

/// Instants are given with as few decimals as leave them this close to the clock, in samples.
const CLOCK_SHARE: f64 = 1e-9;
/// However late the instants are, they stay this close to the clock, in samples.
const LATE_SHARE: f64 = 1e-3;
/// Channels of whole numbers with no more different values than this are states, such as gears and switches.
const MOST_STATES: usize = 16;

/// A recording on one clock, and what that took.
#[derive(Debug, Clone, PartialEq)]
pub struct OnOneClock {
    /// The recording, with one raster.
    pub recording: Recording,
    /// Changes made to its channels.
    pub adjustments: Vec<Adjustment>,
    /// Channels that could not be brought onto the clock, as the reason.
    pub left_out: Vec<DatasetError>,
}

/// Brings all channels onto one clock, which starts with the first time stamp of all and ends with the last.
///
/// Faster channels go through a low-pass filter without phase shift, slower ones are continued as `between` says, and
/// states (few different whole numbers) hold their last value: nothing between two states is one. Where a channel has
/// no sample, before it begins, after it ends and in its gaps, it is NaN.
///
/// # Errors
/// [`DatasetError::SampleTime`] where the clock cannot be used on the recording, why the first channel cannot be
/// brought onto it where no channel can be brought onto it.
pub fn on_one_clock(
    file: &str,
    mut recording: Recording,
    sample_time_s: f64,
    between: Intersample,
) -> Result<OnOneClock, DatasetError> {
    let all = || recording.rasters.iter().flat_map(|r| &r.time_s).copied().filter(|t| t.is_finite());
    let (start_s, end_s) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
    let duration_s = end_s - start_s;
    let is_usable = sample_time_s.is_finite() && sample_time_s > 0.0 && duration_s >= sample_time_s;
    if !is_usable || duration_s / sample_time_s * recording.channels.len() as f64 > MOST_SAMPLES {
        return Err(DatasetError::SampleTime { file: file.to_owned(), sample_time_s, duration_s });
    }
    let clock = Clock::within(start_s, duration_s, sample_time_s);
    let (mut channels, mut adjustments, mut left_out) = (Vec::new(), Vec::new(), Vec::new());
    // What is done is given up, so that no more than one channel is there twice.
    for channel in std::mem::take(&mut recording.channels) {
        let before = adjustments.len();
        match on_clock(file, &recording, &channel, clock, between, &mut adjustments) {
            Ok(samples) => channels.push(Channel { raster: 0, samples, ..channel }),
            Err(reason) => {
                adjustments.truncate(before);
                left_out.push(reason);
            }
        }
    }
    if channels.is_empty() {
        let none = DatasetError::NoneOnClock { file: file.to_owned(), sample_time_s };
        return Err(left_out.into_iter().next().unwrap_or(none));
    }
    let time_s = (0..clock.count).map(|tick| instant_s(start_s, tick, sample_time_s)).collect();
    let recording = Recording { rasters: vec![Raster { time_s, name: None }], channels, ..recording };
    Ok(OnOneClock { recording, adjustments, left_out })
}

fn on_clock(
    file: &str,
    recording: &Recording,
    channel: &Channel,
    clock: Clock,
    between: Intersample,
    log: &mut Vec<Adjustment>,
) -> Result<Vec<f64>, DatasetError> {
    let stamps = recording.time_s(channel).unwrap_or_default();
    let timed = Timed::of(file, channel, stamps, (f64::NEG_INFINITY, f64::INFINITY))?;
    if is_state(&channel.samples) {
        return Ok(timed.state(clock, log));
    }
    timed.on_clock(file, clock, Part::Alone(between), log)
}

/// Returns true if the values are few different whole numbers.
fn is_state(samples: &[f64]) -> bool {
    let mut seen: Vec<f64> = Vec::new();
    samples.iter().filter(|v| v.is_finite()).all(|value| {
        if !seen.contains(value) {
            seen.push(*value);
        }
        value.fract() == 0.0 && seen.len() <= MOST_STATES
    })
}

/// The instant of a tick of a clock, s, as a decimal number that is short and still on the clock.
#[must_use]
pub fn instant_s(start_s: f64, tick: usize, sample_time_s: f64) -> f64 {
    let exact_s = start_s + tick as f64 * sample_time_s;
    let rounding_s = 4.0 * f64::EPSILON * exact_s.abs();
    let tolerance_s = (CLOCK_SHARE * sample_time_s).max(rounding_s.min(LATE_SHARE * sample_time_s));
    let rounded = (0..=15).map(|decimals| {
        let scale = 10_f64.powi(decimals);
        (exact_s * scale).round() / scale
    });
    rounded.into_iter().find(|short_s| (short_s - exact_s).abs() <= tolerance_s).unwrap_or(exact_s)
}
