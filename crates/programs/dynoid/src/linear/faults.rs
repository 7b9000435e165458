//! Data from which nothing can be computed.

use ident::{Channel, Dataset};
use page::decimal::scientific;

use super::loaded::{Loaded, named};
use crate::error::Error;

/// Beyond these sizes, products of a few values leave the range of numbers.
const SIZES: std::ops::RangeInclusive<f64> = 1e-50..=1e50;
/// Below this part of a channel's size what is left of it is rounding.
const ROUNDING: f64 = 1e-14;

fn channels(data: &Dataset) -> impl Iterator<Item = Channel> + use<> {
    (0..data.inputs()).map(Channel::Input).chain((0..data.outputs()).map(Channel::Output))
}

/// The largest value of a channel, sign aside.
fn size(data: &Dataset, channel: Channel) -> f64 {
    let known = data.experiments().iter().flat_map(|e| e.channel(channel)).filter(|v| !v.is_nan());
    known.fold(0.0, |size, v| size.max(v.abs()))
}

fn name(data: &Dataset, channel: Channel) -> String {
    match channel {
        Channel::Input(k) => data.input_labels()[k].name.clone(),
        Channel::Output(i) => data.output_labels()[i].name.clone(),
    }
}

/// Refuses channels of sizes at which squares overflow or vanish: no number computed from them would be right.
pub(super) fn check_sizes(data: &Dataset, files: &str) -> Result<(), Error> {
    for channel in channels(data) {
        let size = size(data, channel);
        if size > 0.0 && !SIZES.contains(&size) {
            let channel = name(data, channel);
            return Err(Error::UnusableChannel {
                data: files.to_owned(),
                channel,
                fault: format!(
                    "its largest value is {}, which cannot be computed with; bring it to another unit",
                    scientific(size, 1)
                ),
            });
        }
    }
    Ok(())
}

/// Refuses to estimate from outputs that do not vary, and from inputs of which nothing is left without their trend.
///
/// # Errors
/// Such a channel.
pub fn check_variation(loaded: &Loaded) -> Result<(), Error> {
    refuse_still(loaded, |channel, [low, high, whole]| match channel {
        // Without a trend taken off, an input that is switched on before the record begins may tell something.
        Channel::Input(_) => low.abs().max(high.abs()) <= ROUNDING * whole,
        Channel::Output(_) => high - low <= ROUNDING * whole.max(high.abs()),
    })
}

/// Refuses channels that do not move: no answer begins there.
///
/// # Errors
/// Such a channel.
pub fn check_movement(loaded: &Loaded) -> Result<(), Error> {
    refuse_still(loaded, |_, [low, high, whole]| high - low <= ROUNDING * whole.max(high.abs()))
}

/// Refuses a channel that is still by its smallest and its largest value and the level that was taken off.
fn refuse_still(loaded: &Loaded, is_still: impl Fn(Channel, [f64; 3]) -> bool) -> Result<(), Error> {
    let data = &loaded.data;
    let still = |channel: &Channel| {
        let known = || data.experiments().iter().flat_map(|e| e.channel(*channel)).copied().filter(|v| !v.is_nan());
        let (low, high) = known().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let whole = match (&loaded.trend, channel) {
            (Some(trend), Channel::Input(k)) => trend.inputs(0).get(*k).map_or(0.0, |line| line.level.abs()),
            (Some(trend), Channel::Output(i)) => trend.outputs(0).get(*i).map_or(0.0, |line| line.level.abs()),
            _ => 0.0,
        };
        is_still(*channel, [low, high, whole])
    };
    match channels(data).find(still) {
        None => Ok(()),
        Some(channel) => Err(Error::StillChannel { data: named(data, &loaded.sources), channel: name(data, channel) }),
    }
}
