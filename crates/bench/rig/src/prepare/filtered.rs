//! Check of a dynamometer speed that was recorded behind a low-pass filter or a moving mean.
//!
//! Above a tenth of its sample rate hardly anything moves N_d by as much as its encoder's noise, which is white. Behind
//! a filter the noise falls, and behind a mean it has zeros. N_e shows no such thing: multiples of the firing frequency
//! are above its noise.

use std::f64::consts::TAU;
use std::ops::Range;

use numerics::order::select;
use signal::Signal;
use signal::spectrum::fft_real;

use crate::bench_file::BenchFile;
use crate::diagnostics::{Finding, Severity};
use crate::experiment::Experiment;
use crate::prepare::log::Log;
use crate::role::Role;

/// Slower rasters do not reach the encoder's noise, s.
const SLOWEST_S: f64 = 1.5e-3;
/// Bands of the spectrum are from here to there, as parts of the sample rate.
const BANDS: Range<f64> = 0.1..0.48;
/// Each of them is so wide.
const BAND_WIDTH: f64 = 0.02;
/// Fewer lines in a band do not show its floor.
const FEWEST: usize = 40;
/// This part of the lines of a band is of the floor: lines of the engine are above it.
const FLOOR: f64 = 0.2;
/// A zero leaves less than this part of the noise at higher frequencies. On 100 recordings of 29 simulated benches the
/// floor never rises from less than 0.04; a mean over three samples leaves 0.001.
const ZERO: f64 = 0.01;
/// Bands from which to which the floor falls, as parts of the sample rate.
const FALLS_BETWEEN: [Range<f64>; 2] = [0.20..0.28, 0.42..0.50];
/// The floor falls to less than this part behind a filter: on these recordings to 0.24 and more; behind a filter of
/// second order to 0.001 at 100 Hz, and 0.03 at 300 Hz.
const FALL: f64 = 0.03;

pub(super) fn check(experiment: &Experiment, bench_file: &BenchFile, log: &mut Log) {
    let role = Role::DynoSpeed;
    let speed = experiment.signal(role).filter(|speed| speed.sample_time_s < SLOWEST_S);
    let Some(floor) = speed.and_then(floor) else { return };
    let found = [(zero(&floor), ZERO), (falls(&floor), FALL)];
    if let Some((ratio, _)) = found.into_iter().find(|(ratio, least)| ratio < least) {
        let channel = bench_file.channels.get(&role).map_or(role.key(), |mapping| mapping.name.as_str());
        log.channel(Severity::Error, channel, None, Finding::SamplesFiltered { ratio });
    }
}

/// The floor of the spectrum in each band: its middle, as a part of the sample rate, and its power.
fn floor(speed: &Signal) -> Option<Vec<(f64, f64)>> {
    let (count, mean) = (speed.len() as f64, speed.mean()?);
    let window = |k: usize| 1.0 - (TAU * (k as f64 + 0.5) / count).cos();
    let seen: Vec<f64> = speed.samples.iter().enumerate().map(|(k, x)| window(k) * (x - mean)).collect();
    let powers: Vec<f64> = fft_real(&seen).ok()?.iter().map(|line| line.norm_sqr()).collect();
    let band = |k: usize| {
        let from = BANDS.start + k as f64 * BAND_WIDTH;
        let [from_line, to_line] = [from, from + BAND_WIDTH].map(|share| (share * count) as usize);
        let mut lines = powers.get(from_line..to_line).filter(|lines| lines.len() >= FEWEST)?.to_vec();
        let place = (FLOOR * lines.len() as f64) as usize;
        Some((from + 0.5 * BAND_WIDTH, select(&mut lines, place)?))
    };
    (0..((BANDS.end - BANDS.start) / BAND_WIDTH).round() as usize).map(band).collect()
}

/// The lowest floor over the highest one at higher frequencies.
fn zero(floor: &[(f64, f64)]) -> f64 {
    let mut highest = 0.0;
    let mut least = f64::INFINITY;
    for (_, power) in floor.iter().rev() {
        if highest > 0.0 {
            least = f64::min(least, power / highest);
        }
        highest = f64::max(highest, *power);
    }
    least
}

/// The floor in the second band over that in the first.
fn falls(floor: &[(f64, f64)]) -> f64 {
    let [low, high] = FALLS_BETWEEN.map(|band| {
        let powers = floor.iter().filter(|(middle, _)| band.contains(middle)).map(|(_, power)| *power);
        let (sum, count) = powers.fold((0.0, 0.0), |(sum, count), power| (sum + power, count + 1.0));
        sum / count
    });
    high / low
}
