//! Whether the clock of the recordings is right, by the mains: a drive's torque ripples at twice their frequency, which no bench
//! misses by more than some tenths of a per cent.

use std::f64::consts::TAU;

use numerics::order::{lower_median, median};
use rig::{Experiment, Finding, Role};
use signal::Signal;
use signal::spectrum::fft_real;

use crate::findings::Findings;

/// Twice the mains, Hz.
const RIPPLES_HZ: [f64; 2] = [100.0, 120.0];
/// A clock is wrong by at most this, and by more than this: mains stray by up to 0.4 %.
const WRONG: (f64, f64) = (0.02, 0.005);
/// The power of the ripple over the median beside it. On 40 recordings of ten simulated benches it is 100 to 10⁵.
const CLEAR: f64 = 300.0;
/// A line this close to a multiple of half the engine's speed may be the engine's, Hz.
const OF_THE_ENGINE_HZ: f64 = 0.8;
/// Recordings that have to agree, and by how much.
const AGREE: (usize, f64) = (2, 1e-3);

/// Doubts the clock where the ripple of all recordings is equally far from twice the mains.
pub(super) fn doubt(findings: &mut Findings<'_>) {
    let seen: Vec<(&str, f64, f64)> = findings
        .experiments
        .iter()
        .filter_map(|e| ripple(e).map(|(found_hz, mains_hz)| (e.file.as_str(), found_hz, mains_hz)))
        .collect();
    let mut ratios: Vec<f64> = seen.iter().map(|(_, found_hz, mains_hz)| found_hz / mains_hz).collect();
    let Some(ratio) = median(&mut ratios) else { return };
    let agrees = ratios.len() >= AGREE.0 && ratios.iter().all(|other| (other - ratio).abs() < AGREE.1);
    if let Some((file, found_hz, mains_hz)) = seen.first().filter(|_| agrees && (ratio - 1.0).abs() > WRONG.1) {
        let finding = Finding::ClockRate { found_hz: *found_hz, mains_hz: *mains_hz };
        findings.doubt_channel(file, Role::DynoSpeed, finding);
    }
}

/// The ripple that moves N_d, and what it would be by the mains, Hz: the clearer of both.
fn ripple(experiment: &Experiment) -> Option<(f64, f64)> {
    let speed = experiment.signal(Role::DynoSpeed)?;
    let half_turn_hz = 0.5 * speed.mean()?.abs() / TAU;
    let powers = powers(speed)?;
    let lines = RIPPLES_HZ.iter().filter_map(|mains_hz| Some((line(&powers, speed, *mains_hz)?, *mains_hz)));
    let ((found_hz, _), mains_hz) = lines.max_by(|a, b| a.0.1.total_cmp(&b.0.1))?;
    let from_engine_hz = (found_hz - (found_hz / half_turn_hz).round() * half_turn_hz).abs();
    (from_engine_hz > OF_THE_ENGINE_HZ).then_some((found_hz, mains_hz))
}

fn powers(speed: &Signal) -> Option<Vec<f64>> {
    let (count, mean) = (speed.len() as f64, speed.mean()?);
    let window = |k: usize| 1.0 - (TAU * (k as f64 + 0.5) / count).cos();
    let seen: Vec<f64> = speed.samples.iter().enumerate().map(|(k, x)| window(k) * (x - mean)).collect();
    Some(fft_real(&seen).ok()?.iter().map(|line| line.norm_sqr()).collect())
}

/// Frequency of the strongest line about a frequency, Hz, and its power over the median there; none if it is not clear.
fn line(powers: &[f64], speed: &Signal, about_hz: f64) -> Option<(f64, f64)> {
    let bin_hz = 1.0 / (speed.len() as f64 * speed.sample_time_s);
    let [first, last] = [1.0 - WRONG.0, 1.0 + WRONG.0].map(|share| (share * about_hz / bin_hz) as usize);
    let about = powers.get(first..=last)?;
    let strongest = (1..about.len().checked_sub(1)?).max_by(|a, b| about[*a].total_cmp(&about[*b]))?;
    let clear = about[strongest] / lower_median(&mut about.to_vec())?;
    // A parabola through the logarithms about the peak.
    let [before, peak, after] = [strongest - 1, strongest, strongest + 1].map(|k| about[k].ln());
    let beside = 0.5 * (before - after) / (before - 2.0 * peak + after);
    (clear > CLEAR && beside.abs() <= 1.0).then_some(((first + strongest) as f64 * bin_hz + beside * bin_hz, clear))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use rig::ExperimentLabel;
    use signal::excitation::Random;

    use super::*;

    #[test]
    fn exact_the_ripple_dates_the_clock() {
        let recorded = |rate: f64, mains_hz: f64, mean: f64| {
            let mut random = Random::new(4);
            let value = |k: usize| mean + 0.01 * (TAU * mains_hz * 1e-3 * k as f64).sin() + 0.01 * random.normal();
            let speed = Signal::new(0.0, 1e-3 * rate, (0..20_000).map(value).collect()).unwrap();
            let signals = BTreeMap::from([(Role::DynoSpeed, speed)]);
            Experiment { file: "x".to_owned(), label: ExperimentLabel::BS_T_NT, signals }
        };
        for (rate, mains_hz) in [(1.0, 100.0), (1.01, 100.0), (0.99, 120.0), (1.0, 120.0)] {
            let (found_hz, named_hz) = ripple(&recorded(rate, mains_hz, 128.8)).unwrap();
            assert!(named_hz == mains_hz && (found_hz * rate / mains_hz - 1.0).abs() < 1e-5, "{found_hz}, {named_hz}");
        }
        // Ten times half the speed: order 5 of the engine.
        assert_eq!(ripple(&recorded(1.0, 100.0, TAU * 20.0)), None);
    }
}
