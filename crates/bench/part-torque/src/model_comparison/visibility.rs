//! At which rate and with which demand the rest of the torque control becomes visible.

use std::ops::RangeInclusive;

use ident::distributions::normal_quantile;
use numerics::null::{infinite_if_null, nan_if_null};
use rig::random::Source;
use serde::{Deserialize, Serialize};
use signal::Signal;

use super::record::{Record, rms};
use crate::torque_control::{CRITICALLY_DAMPED, HeldDemand, SecondOrder, distance_from_lag, lag_errors, term_error};

/// Rates of T_d,calc looked at, Hz.
const RATES_HZ: [f64; 5] = [250.0, 500.0, 1000.0, 2000.0, 4000.0];
/// Times for which a demand is held that are looked at, s. With 250 Hz, 9 ms meets every millisecond of the response,
/// 10 ms every second one, 4 ms always the same.
const HOLDS_S: [f64; 4] = [10e-3, 9e-3, 4e-3, 1e-3];
/// A recording of this length is looked at, s.
pub const RECORDING_S: f64 = 60.0;
/// Part of it that is computed, s; the rest is alike.
const COMPUTED_S: f64 = 4.0;
/// The demand's own raster, s.
const UPDATE_S: f64 = 1e-3;
/// Level of the test of κ = 0.
const LEVEL: f64 = 0.99;
/// Probability with which the test is to find the loop.
const POWER: f64 = 0.95;
/// κ between which the least that is found is searched, and steps of the search: each halves the ratio that is left.
const TERMS: RangeInclusive<f64> = 0.01..=2.0;
const STEPS: usize = 7;
/// Seed of the demands.
const SEED: u64 = 1;

/// Power of recordings of other rates and demands to show more than delay and lag.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Visibility {
    /// Delay and lag that it is computed at, s and rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub control: (f64, f64),
    /// Standard deviation of the demand, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub demand_nm: f64,
    /// Standard deviation of what is left of each sample of T_d,calc, Nm. It is taken as white and as large at every
    /// rate.
    #[serde(deserialize_with = "nan_if_null")]
    pub noise_nm: f64,
    /// Length of the recording, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub recording_s: f64,
    /// κ of the loop to be separated from a lag.
    #[serde(deserialize_with = "nan_if_null")]
    pub term: f64,
    /// One entry a rate and hold.
    pub cases: Vec<VisibilityCase>,
}

/// Power of a recording of one rate and one hold. Errors shrink with the root of the recording's length, and with the
/// demand's standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct VisibilityCase {
    /// Rate of T_d,calc, Hz.
    #[serde(deserialize_with = "nan_if_null")]
    pub rate_hz: f64,
    /// For how long a demand is held, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub hold_s: f64,
    /// Standard error of τ beside a, s.
    #[serde(deserialize_with = "infinite_if_null")]
    pub delay_s: f64,
    /// Standard error of a beside τ, rad/s.
    #[serde(deserialize_with = "infinite_if_null")]
    pub lag_rad_s: f64,
    /// Standard error of κ beside both, for the loop of second order.
    #[serde(deserialize_with = "infinite_if_null")]
    pub term: f64,
    /// Shortest recording in which that loop is separated from a lag, s.
    #[serde(deserialize_with = "infinite_if_null")]
    pub needed_s: f64,
    /// Standard deviation of the demand with which it is found in the recording looked at, Nm.
    #[serde(deserialize_with = "infinite_if_null")]
    pub needed_nm: f64,
    /// Least κ that is separated from a lag in the recording looked at; infinite where 2 is not.
    #[serde(deserialize_with = "infinite_if_null")]
    pub least_term: f64,
}

impl Visibility {
    /// The lowest rate, and at it the longest hold, at which the loop is found in the recording looked at.
    #[must_use]
    pub fn first(&self) -> Option<&VisibilityCase> {
        self.cases.iter().find(|case| case.needed_s <= self.recording_s)
    }

    /// None without a lag: there is nothing to compute at.
    pub(super) fn of(record: &Record) -> Option<Self> {
        let model = &record.control.model;
        let noise_nm = model.residual.standard_deviation_nm;
        let visible = || visibility((model.delay_s, model.lag_rad_s), rms(&record.demand), noise_nm, CRITICALLY_DAMPED);
        record.control.has_lag().then(visible)
    }
}

/// Power of other rates and holds to show delay and lag `control` (s, rad/s), and a loop of second order with both and
/// this κ. The demand and the noise are white, with these standard deviations, Nm.
#[must_use]
pub fn visibility(control: (f64, f64), demand_nm: f64, noise_nm: f64, term: f64) -> Visibility {
    let pairs = RATES_HZ.iter().flat_map(|rate_hz| HOLDS_S.iter().map(move |hold_s| (*rate_hz, *hold_s)));
    let truth = SecondOrder { delay_s: control.0, lag_rad_s: control.1, term };
    let cases = pairs.map(|(rate_hz, hold_s)| case(truth, rate_hz, hold_s, demand_nm, noise_nm)).collect();
    Visibility { control, demand_nm, noise_nm, recording_s: RECORDING_S, term, cases }
}

/// Computed for a demand of standard deviation one, noise of one, and the shorter recording.
fn case(truth: SecondOrder, rate_hz: f64, hold_s: f64, demand_nm: f64, noise_nm: f64) -> VisibilityCase {
    let held = white_demand(hold_s);
    let times_s: Vec<f64> = (0..(COMPUTED_S * rate_hz) as usize).map(|i| i as f64 / rate_hz).collect();
    // What the samples do not tell has no bound.
    let (delay_s, lag_rad_s) =
        lag_errors(&held, &times_s, truth.delay_s, truth.lag_rad_s).unwrap_or((f64::INFINITY, f64::INFINITY));
    let term = term_error(&held, &times_s, truth).unwrap_or(f64::INFINITY);
    let distance = |term: f64| distance_from_lag(&held, &times_s, SecondOrder { term, ..truth }).unwrap_or(0.0);
    let scale = (COMPUTED_S / RECORDING_S).sqrt() * noise_nm / demand_nm;
    let wanted = scale * (normal_quantile(0.5 + 0.5 * LEVEL) + normal_quantile(POWER));
    let short_of = wanted / distance(truth.term);
    VisibilityCase {
        rate_hz,
        hold_s,
        delay_s: scale * delay_s,
        lag_rad_s: scale * lag_rad_s,
        term: scale * term,
        needed_s: RECORDING_S * short_of * short_of,
        needed_nm: demand_nm * short_of,
        least_term: least_term(|term| distance(term) >= wanted),
    }
}

/// The least κ that is found, to a few per cent.
fn least_term(is_seen: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = TERMS.into_inner();
    if !is_seen(high) {
        return f64::INFINITY;
    }
    for _ in 0..STEPS {
        let middle = (low * high).sqrt();
        (low, high) = if is_seen(middle) { (low, middle) } else { (middle, high) };
    }
    high
}

fn white_demand(hold_s: f64) -> HeldDemand {
    let held_for = (hold_s / UPDATE_S).round() as usize;
    let count = (COMPUTED_S / UPDATE_S) as usize;
    let mut random = Source::DynoTorque.stream(SEED);
    let levels: Vec<f64> = (0..=count / held_for).map(|_| random.normal()).collect();
    let samples = (0..count).map(|i| levels[i / held_for]).collect();
    HeldDemand::new(&Signal { start_s: 0.0, sample_time_s: UPDATE_S, samples }, None)
}
