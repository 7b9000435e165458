//! Drift between the clocks of a recording, by channels of one quantity on two of them.

use std::collections::BTreeMap;

use recording::{Channel, Recording};
use serde::{Deserialize, Serialize};
use signal::SignalView;
use signal::clock::{check_clock, fitted_clock};
use signal::drift::{Drift, relative_drift};
use units::parse_unit;

/// Channels that two clocks are compared by, at most: each takes a fraction of a second.
const MOST_PAIRS: usize = 3;
/// Samples that the fewest may have of two that are compared; fewer show too little.
const FEWEST_SAMPLES: usize = 1024;
/// A drift must exceed its standard error by this factor, as in a study.
const SIGNIFICANCE: f64 = 5.0;
/// A drift must add up to this share of the shorter sample time.
const SHARE_OF_SAMPLE_TIME: f64 = 0.05;

/// A clock that runs apart from that of another raster.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Apart {
    /// The other raster.
    pub raster: usize,
    /// The channels that show it: one of this raster, and one of that.
    pub shown_by: [String; 2],
    /// This clock counts so many seconds too much for each of the other's.
    pub rate: f64,
    /// Standard error of the rate.
    pub standard_error: f64,
    /// Difference that the rate adds up to over the recording, s.
    pub apart_s: f64,
}

/// For each raster how its clock runs apart from the one with the shortest sample time, if that can be seen.
pub(super) fn check(recording: &Recording) -> BTreeMap<usize, Apart> {
    if recording.rasters.len() < 2 {
        return BTreeMap::new();
    }
    let clocks: Vec<(usize, Clock)> = recording
        .rasters
        .iter()
        .map(|r| Clock::of(&r.time_s))
        .enumerate()
        .filter_map(|(index, clock)| Some((index, clock?)))
        .collect();
    let shortest = clocks.iter().min_by(|a, b| a.1.sample_time_s.total_cmp(&b.1.sample_time_s));
    let Some(&(reference, fast)) = shortest else { return BTreeMap::new() };
    let others = clocks.iter().filter(|(index, _)| *index != reference);
    others.filter_map(|&(index, clock)| Some((index, apart(recording, reference, fast, index, clock)?))).collect()
}

/// A clock that is even enough to compare signals on it.
#[derive(Debug, Clone, Copy)]
struct Clock {
    start_s: f64,
    sample_time_s: f64,
    samples: usize,
    /// How well its stamps, which jitter, give its rate.
    rate_error: f64,
}

impl Clock {
    fn of(time_s: &[f64]) -> Option<Self> {
        let check = check_clock(time_s).ok().filter(|_| time_s.len() >= FEWEST_SAMPLES)?;
        let is_even =
            check.gaps.is_empty() && check.non_monotonic.is_empty() && check.worst_jitter_s < check.sample_time_s;
        let rough = (time_s[0], check.sample_time_s);
        let (start_s, sample_time_s) = fitted_clock(time_s, rough).filter(|_| is_even)?;
        // Of a line through stamps that are off independently, each by σ: √12 σ/(T √N). Intervals are off by √2 σ.
        let samples = time_s.len();
        let stamp_s = check.jitter_s / 2.0_f64.sqrt();
        let rate_error = 12.0_f64.sqrt() * stamp_s / (sample_time_s * (samples as f64).powf(1.5));
        Some(Self { start_s, sample_time_s, samples, rate_error })
    }

    fn signal(self, channel: &Channel) -> Option<SignalView<'_>> {
        SignalView::new(self.start_s, self.sample_time_s, &channel.samples).ok()
    }

    fn end_s(self) -> f64 {
        self.start_s + self.sample_time_s * (self.samples - 1) as f64
    }
}

fn apart(recording: &Recording, reference: usize, fast: Clock, own: usize, clock: Clock) -> Option<Apart> {
    let pairs = pairs(recording, reference, own);
    let drifts = pairs.into_iter().filter_map(|(there, here)| {
        let drift = relative_drift(fast.signal(there)?, clock.signal(here)?).ok()?;
        Some((there, here, drift))
    });
    let (there, here, drift) = drifts.min_by(|a, b| a.2.standard_error.total_cmp(&b.2.standard_error))?;
    let Drift { rate, standard_error } = drift;
    let standard_error = standard_error.hypot(fast.rate_error).hypot(clock.rate_error);
    let apart_s = rate * (fast.end_s().min(clock.end_s()) - fast.start_s.max(clock.start_s));
    let counts =
        rate.abs() > SIGNIFICANCE * standard_error && apart_s.abs() > SHARE_OF_SAMPLE_TIME * fast.sample_time_s;
    let shown_by = [here.name.clone(), there.name.clone()];
    counts.then_some(Apart { raster: reference, shown_by, rate, standard_error, apart_s })
}

/// Channels of two rasters that measure the same quantity, those of the same name first.
fn pairs(recording: &Recording, first: usize, second: usize) -> Vec<(&Channel, &Channel)> {
    let of = |raster: usize| recording.channels.iter().filter(move |channel| channel.raster == raster);
    let quantity = |channel: &Channel| parse_unit(&channel.unit).ok().map(|unit| unit.quantity);
    let is_same = |a: &Channel, b: &Channel| a.name == b.name || quantity(a).is_some_and(|q| quantity(b) == Some(q));
    let all =
        of(second).flat_map(|here| of(first).filter(move |there| is_same(there, here)).map(move |there| (there, here)));
    let mut found: Vec<_> = all.take(1 << 12).collect();
    found.sort_by_key(|(there, here)| there.name != here.name);
    found.truncate(MOST_PAIRS);
    found
}
