//! Phases that keep the peaks of several responses low.

use std::f64::consts::TAU;

use signal::excitation::Random;
use signal::spectrum::{fft_real, inverse_fft_real};
use signal::{Complex64, SignalError};

/// Samples in a period of the highest line at least.
const SAMPLES_PER_PERIOD: usize = 10;
/// Times the responses are clipped from each start.
const ROUNDS: usize = 300;
/// Starts at random, beside Schroeder's phases.
const RANDOM_STARTS: u64 = 3;
/// The first clip, as a part of the largest peak: early ones move phases far, late ones settle them.
const FIRST_CLIP: f64 = 0.75;
/// The last clip, as a part of the largest peak.
const LAST_CLIP: f64 = 0.99;

/// A periodic excitation whose phases are sought, with what it makes of the limited quantities.
#[derive(Debug, Clone)]
pub(super) struct Responses {
    /// Harmonics of one over the period.
    pub(super) harmonics: Vec<usize>,
    /// Amplitudes of the demand.
    pub(super) amplitudes: Vec<f64>,
    /// Of each limited quantity, its gain at each harmonic over its limit.
    pub(super) gains: Vec<Vec<Complex64>>,
}

/// Phases, and the largest peak of any response over its limit.
#[derive(Debug, Clone)]
pub(super) struct Phases {
    pub(super) phases_rad: Vec<f64>,
    pub(super) peak: f64,
}

impl Responses {
    /// Clips all responses at one level, takes the phases of the excitation whose responses are nearest to the clipped
    /// ones in the sum of squares, φ_k = arg Σ_j G_jk* Y_jk, and does so again at a level that rises; from Schroeder's
    /// phases for the response with the highest peaks and from a few at random. The best of all is kept.
    ///
    /// # Source
    /// Van der Ouderaa, Schoukens & Renneboog, IEEE Trans. Instrum. Meas. 37 (1988) 145; several responses at once:
    /// Guillaume, Schoukens, Pintelon & Kollár, IEEE Trans. Instrum. Meas. 40 (1991) 982.
    pub(super) fn optimise(&self) -> Result<Phases, SignalError> {
        let mut best = Phases { phases_rad: self.schroeder(), peak: f64::INFINITY };
        self.clip(best.phases_rad.clone(), &mut best)?;
        for seed in 0..RANDOM_STARTS {
            let mut random = Random::new(seed);
            let start = self.harmonics.iter().map(|_| TAU * random.uniform()).collect();
            self.clip(start, &mut best)?;
        }
        Ok(best)
    }

    fn clip(&self, mut phases: Vec<f64>, best: &mut Phases) -> Result<(), SignalError> {
        let length = self.length();
        for round in 0..ROUNDS {
            let mut responses = self.over_time(&phases, length)?;
            let peak = responses.iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
            if peak < best.peak {
                *best = Phases { phases_rad: phases.clone(), peak };
            }
            let level = peak * (FIRST_CLIP + (LAST_CLIP - FIRST_CLIP) * round as f64 / ROUNDS as f64);
            let mut nearest = vec![Complex64::ZERO; phases.len()];
            for (response, gains) in responses.iter_mut().zip(&self.gains) {
                response.iter_mut().for_each(|v| *v = v.clamp(-level, level));
                let clipped = fft_real(response)?;
                for ((sum, gain), harmonic) in nearest.iter_mut().zip(gains).zip(&self.harmonics) {
                    *sum += gain.conj() * clipped[*harmonic];
                }
            }
            phases.iter_mut().zip(&nearest).for_each(|(phase, target)| *phase = target.arg());
        }
        Ok(())
    }

    /// Every response over a period of `length` samples, over its limit.
    pub(super) fn over_time(&self, phases: &[f64], length: usize) -> Result<Vec<Vec<f64>>, SignalError> {
        let of = |gains: &Vec<Complex64>| {
            let mut spectrum = vec![Complex64::ZERO; length / 2 + 1];
            for (((harmonic, amplitude), phase), gain) in
                self.harmonics.iter().zip(&self.amplitudes).zip(phases).zip(gains)
            {
                spectrum[*harmonic] = Complex64::from_polar(0.5 * length as f64 * amplitude, *phase) * gain;
            }
            inverse_fft_real(spectrum, length)
        };
        self.gains.iter().map(of).collect()
    }

    /// An even number of samples with small prime factors.
    fn length(&self) -> usize {
        let highest = self.harmonics.iter().copied().max().unwrap_or(1);
        let least = (SAMPLES_PER_PERIOD * highest).max(16);
        (least..).find(|n| n % 2 == 0 && is_smooth(*n)).unwrap_or(least)
    }

    /// Schroeder's phases for the response of the highest power over its limit: a sweep of constant amplitude that
    /// spends as much time at a frequency as it has power there.
    fn schroeder(&self) -> Vec<f64> {
        let power = |gains: &Vec<Complex64>| {
            gains.iter().zip(&self.amplitudes).map(|(g, a)| g.norm_sqr() * a * a).collect::<Vec<f64>>()
        };
        let total = |powers: &Vec<f64>| powers.iter().sum::<f64>();
        let powers: Vec<Vec<f64>> = self.gains.iter().map(power).collect();
        let Some(largest) = (0..powers.len()).max_by(|a, b| total(&powers[*a]).total_cmp(&total(&powers[*b]))) else {
            return vec![0.0; self.harmonics.len()];
        };
        let (powers, gains) = (&powers[largest], &self.gains[largest]);
        let all = total(powers).max(f64::MIN_POSITIVE);
        // dφ/dk = −2π · (share of power below k): group delay as a part of the period.
        let (mut phase, mut below, mut last) = (0.0_f64, 0.0_f64, None);
        let next = |((harmonic, power), gain): ((&usize, &f64), &Complex64)| {
            let steps = last.map_or(0, |l: usize| harmonic - l);
            last = Some(*harmonic);
            phase = (phase - TAU * steps as f64 * below / all) % TAU;
            below += power;
            phase - gain.arg()
        };
        self.harmonics.iter().zip(powers).zip(gains).map(next).collect()
    }
}

fn is_smooth(mut n: usize) -> bool {
    for prime in [2, 3, 5] {
        while n.is_multiple_of(prime) {
            n /= prime;
        }
    }
    n == 1
}
