//! Check of the recordings' clock by the mains: a drive's torque ripples at twice their frequency, which no bench
//! misses by more than some tenths of a per cent.

use std::f64::consts::TAU;

use numerics::order::lower_median;
use rig::{Experiment, Role};
use signal::Signal;
use signal::spectrum::fft_real;

/// Twice the mains, Hz.
const RIPPLES_HZ: [f64; 2] = [100.0, 120.0];
/// Without the engine's pulses a clock is wrong by at most this, ...
const MOST_WRONG: f64 = 0.02;
/// ... and by more than this, since mains stray by up to 0.4 %.
const LEAST_WRONG: f64 = 0.005;
/// The power of the ripple over the median beside it. On 40 recordings of ten simulated benches it is 100 to 10⁵.
const CLEAR: f64 = 300.0;
/// A line this close to a multiple of half the engine's speed may be the engine's, Hz.
const OF_THE_ENGINE_HZ: f64 = 0.8;
/// Recordings of one clock agree within this.
const AGREE: f64 = 1e-3;
/// A recording of another clock is apart by more than this from the others, which agree.
const APART: f64 = 4e-3;
/// The ripple is looked for within this part of where the engine's pulses would have it.
const BY_PULSES: f64 = 0.004;

/// The ripple of one recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ripple {
    /// Its frequency by the time stamps, Hz.
    pub found_hz: f64,
    /// Twice the mains, Hz.
    pub mains_hz: f64,
    /// How often the engine's pulses come over what the speed says, where that is seen.
    pulses: Option<f64>,
}

impl Ripple {
    /// How fast the clock counts, as a part of what the mains say.
    pub fn ratio(&self) -> f64 {
        self.found_hz / self.mains_hz
    }

    /// Tells whether the mains contradict the clock.
    pub fn is_off(&self) -> bool {
        (self.ratio() - 1.0).abs() > LEAST_WRONG
    }

    /// Tells whether the engine's pulses, or the ratios of the other recordings, show that the clock of this one is
    /// wrong.
    pub fn is_certain(&self, others: &[f64]) -> bool {
        let alike = |ratio: &f64, other: f64| (ratio - other).abs() < AGREE;
        let all_alike = !others.is_empty() && others.iter().all(|other| alike(other, self.ratio()));
        let apart = |other: &f64| alike(other, others[0]) && (other - self.ratio()).abs() > APART;
        match self.pulses {
            Some(pulses) => all_alike || (pulses - self.ratio()).abs() < BY_PULSES,
            None => all_alike || others.len() >= 2 && others.iter().all(apart),
        }
    }
}

/// The ripple that moves N_d, and what it would be by the mains: the clearest about twice the mains, and about where a
/// clock would have it that puts the engine's pulses where they are.
///
/// `pulses` is how often the engine's pulses come over what the speed says, where that is seen.
pub fn ripple(experiment: &Experiment, pulses: Option<f64>) -> Option<Ripple> {
    let speed = experiment.signal(Role::DynoSpeed)?;
    let half_turn_hz = 0.5 * speed.mean()?.abs() / TAU;
    let powers = powers(speed)?;
    let by_pulses = pulses.filter(|ratio| (ratio - 1.0).abs() > BY_PULSES);
    let about = RIPPLES_HZ.map(|mains_hz| (mains_hz, mains_hz, MOST_WRONG)).into_iter();
    let about = about.chain(by_pulses.into_iter().flat_map(|ratio| RIPPLES_HZ.map(|hz| (hz, ratio * hz, BY_PULSES))));
    let lines =
        about.filter_map(|(mains_hz, about_hz, within)| Some((line(&powers, speed, about_hz, within)?, mains_hz)));
    let ((found_hz, _), mains_hz) = lines.max_by(|a, b| a.0.1.total_cmp(&b.0.1))?;
    let from_engine_hz = (found_hz - (found_hz / half_turn_hz).round() * half_turn_hz).abs();
    (from_engine_hz > OF_THE_ENGINE_HZ).then_some(Ripple { found_hz, mains_hz, pulses })
}

fn powers(speed: &Signal) -> Option<Vec<f64>> {
    let (count, mean) = (speed.len() as f64, speed.mean()?);
    let window = |k: usize| 1.0 - (TAU * (k as f64 + 0.5) / count).cos();
    let seen: Vec<f64> = speed.samples.iter().enumerate().map(|(k, x)| window(k) * (x - mean)).collect();
    Some(fft_real(&seen).ok()?.iter().map(|line| line.norm_sqr()).collect())
}

/// Frequency of the strongest line about a frequency, Hz, and its power over the median there; none if it is not clear.
fn line(powers: &[f64], speed: &Signal, about_hz: f64, within: f64) -> Option<(f64, f64)> {
    let bin_hz = 1.0 / (speed.len() as f64 * speed.sample_time_s);
    let [first, last] = [1.0 - within, 1.0 + within].map(|share| (share * about_hz / bin_hz) as usize);
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
            let experiment = recorded(rate, mains_hz, 128.8);
            let found = ripple(&experiment, None).unwrap();
            assert!(found.mains_hz == mains_hz && (found.ratio() * rate - 1.0).abs() < 1e-5, "{}", found.found_hz);
        }
        // Ten times half the speed: order 5 of the engine.
        assert!(ripple(&recorded(1.0, 100.0, TAU * 20.0), None).is_none());
    }
}
