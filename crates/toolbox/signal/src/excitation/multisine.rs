//! Multisines: phases at random, by formula, or optimised for a low crest factor.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

use super::{Random, Timing, crest_factor};
use crate::error::{SignalError, check_at_least, check_range, check_same_length};
use crate::spectrum::{fft_real, inverse_fft_real};
use crate::{Complex64, Signal};

/// How the phases of a multisine are chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Phases {
    /// Schroeder's formula, which keeps peaks low for many adjacent lines:
    /// `φ_k = φ_1 − 2π Σ_{l<k} (k − l) p_l`, `p` the relative powers; `−π k (k − 1)/F` for equal ones.
    Schroeder,
    /// Independent and uniform: for averages over realisations, which separate nonlinear distortion from the response.
    Random {
        /// Of the random numbers.
        seed: u64,
    },
    /// Optimised for a low crest factor: the signal is clipped, at a level that rises, and the phases of what results
    /// are kept. From Schroeder's phases and four sets at random; the best is taken.
    LowCrest {
        /// Times the signal is clipped from each start; a few hundred serve.
        iterations: usize,
    },
}

/// A sum of cosines at multiples of `1/P`, `P = period · sample_time_s`: `x(t) = Σ_k A_k cos(2π h_k t/P + φ_k)`.
///
/// # Example
/// ```
/// use signal::excitation::{Multisine, Phases, Timing, crest_factor};
/// let timing = Timing { sample_time_s: 1e-3, length: 1000 };
/// let schroeder = Multisine::flat(1000, (1..=30).collect(), 2.0, Phases::Schroeder);
/// let x = schroeder.generate(timing)?;
/// let power = x.samples.iter().map(|v| v * v).sum::<f64>() / 1000.0;
/// assert!((power - 4.0).abs() < 1e-9);
/// assert!(crest_factor(&x.samples)? < 1.8); // 7.7 with equal phases
/// let low = Multisine { phases: Phases::LowCrest { iterations: 300 }, ..schroeder };
/// assert!(crest_factor(&low.generate(timing)?.samples)? < 1.5);
/// # Ok::<(), signal::SignalError>(())
/// ```
///
/// # Source
/// Schroeder, M. R. (1970), IEEE Trans. Inf. Theory 16(1), 85–89; Van der Ouderaa, E., Schoukens, J. and Renneboog, J.
/// (1988), IEEE Trans. Instrum. Meas. 37(1), 145–147.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Multisine {
    /// The period in samples.
    pub period: usize,
    /// The harmonics `h_k`, each once, between 1 and below `period/2`.
    pub harmonics: Vec<usize>,
    /// Amplitudes of the harmonics relative to each other; none for equal ones.
    pub amplitudes: Vec<f64>,
    /// Root mean square over a period.
    pub rms: f64,
    /// The phases.
    pub phases: Phases,
}

impl Multisine {
    /// Equal amplitudes.
    #[must_use]
    pub fn flat(period: usize, harmonics: Vec<usize>, rms: f64, phases: Phases) -> Self {
        Self { period, harmonics, amplitudes: vec![], rms, phases }
    }

    /// The signal, one period after the other.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] for a harmonic, an amplitude or `rms` out of range or a harmonic given twice;
    /// [`SignalError::TooShort`] without a harmonic; [`SignalError::LengthMismatch`] unless there is an amplitude for
    /// each harmonic or none; [`SignalError::Constant`] for amplitudes of zero alone; [`SignalError::SampleTime`].
    pub fn generate(&self, timing: Timing) -> Result<Signal, SignalError> {
        let amplitudes = self.scaled_amplitudes()?;
        let one_period = match self.phases {
            Phases::Schroeder => self.synthesise(&amplitudes, &schroeder(&amplitudes))?,
            Phases::Random { seed } => {
                let mut random = Random::new(seed);
                let phases: Vec<f64> = amplitudes.iter().map(|_| TAU * random.uniform()).collect();
                self.synthesise(&amplitudes, &phases)?
            }
            Phases::LowCrest { iterations } => self.optimise(&amplitudes, iterations)?,
        };
        timing.signal((0..timing.length).map(|t| one_period[t % self.period]).collect())
    }

    /// Amplitudes whose signal has the root mean square asked for.
    fn scaled_amplitudes(&self) -> Result<Vec<f64>, SignalError> {
        check_at_least(1, self.harmonics.len())?;
        check_range("rms", self.rms, 0.0, f64::MAX)?;
        let mut sorted = self.harmonics.clone();
        sorted.sort_unstable();
        for (i, &harmonic) in sorted.iter().enumerate() {
            let lowest = if i > 0 { sorted[i - 1] + 1 } else { 1 };
            check_range("harmonic", harmonic as f64, lowest as f64, (self.period as f64 - 1.0) / 2.0)?;
        }
        if self.amplitudes.is_empty() {
            return Ok(vec![self.rms * (2.0 / self.harmonics.len() as f64).sqrt(); self.harmonics.len()]);
        }
        check_same_length(self.harmonics.len(), self.amplitudes.len())?;
        for &amplitude in &self.amplitudes {
            check_range("amplitudes", amplitude, 0.0, f64::MAX)?;
        }
        let largest = self.amplitudes.iter().fold(0.0_f64, |m, a| m.max(*a));
        if largest == 0.0 {
            return Err(SignalError::Constant);
        }
        let power: f64 = self.amplitudes.iter().map(|a| 0.5 * (a / largest).powi(2)).sum();
        Ok(self.amplitudes.iter().map(|a| self.rms / power.sqrt() * (a / largest)).collect())
    }

    /// One period.
    fn synthesise(&self, amplitudes: &[f64], phases: &[f64]) -> Result<Vec<f64>, SignalError> {
        let mut spectrum = vec![Complex64::ZERO; self.period / 2 + 1];
        for ((&harmonic, amplitude), phase) in self.harmonics.iter().zip(amplitudes).zip(phases) {
            spectrum[harmonic] = Complex64::from_polar(0.5 * self.period as f64 * amplitude, *phase);
        }
        inverse_fft_real(spectrum, self.period)
    }

    /// The best of the signals met while clipping, from Schroeder's phases and from a few at random: those serve where
    /// lines are sparse.
    fn optimise(&self, amplitudes: &[f64], iterations: usize) -> Result<Vec<f64>, SignalError> {
        let start = schroeder(amplitudes);
        let mut best = self.synthesise(amplitudes, &start)?;
        if self.rms == 0.0 {
            return Ok(best);
        }
        let mut lowest = crest_factor(&best)?;
        self.clip(amplitudes, start, iterations, &mut best, &mut lowest)?;
        for seed in 0..RANDOM_STARTS {
            let mut random = Random::new(seed);
            let start = amplitudes.iter().map(|_| TAU * random.uniform()).collect();
            self.clip(amplitudes, start, iterations, &mut best, &mut lowest)?;
        }
        Ok(best)
    }

    /// Clips and keeps the phases, again and again; the crest factor does not fall steadily, so the best is kept.
    fn clip(
        &self,
        amplitudes: &[f64],
        mut phases: Vec<f64>,
        iterations: usize,
        best: &mut [f64],
        lowest: &mut f64,
    ) -> Result<(), SignalError> {
        for i in 0..iterations {
            let mut current = self.synthesise(amplitudes, &phases)?;
            let crest = crest_factor(&current)?;
            if crest < *lowest {
                *lowest = crest;
                best.copy_from_slice(&current);
            }
            // From 0.75 to just below the peak: early clips move the phases far, late ones settle them.
            let level = 0.75 + 0.24 * i as f64 / iterations as f64;
            let peak = current.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            current.iter_mut().for_each(|v| *v = v.clamp(-level * peak, level * peak));
            let clipped = fft_real(&current)?;
            for (phase, harmonic) in phases.iter_mut().zip(&self.harmonics) {
                *phase = clipped[*harmonic].arg();
            }
        }
        Ok(())
    }
}

/// Further starts of the optimisation.
const RANDOM_STARTS: u64 = 4;

/// Schroeder's phases for any powers, `φ_{k+1} − φ_k` less by a turn's share of the power up to `k`.
fn schroeder(amplitudes: &[f64]) -> Vec<f64> {
    let total: f64 = amplitudes.iter().map(|a| a * a).sum::<f64>().max(f64::MIN_POSITIVE);
    let (mut phase, mut slope) = (0.0_f64, 0.0_f64);
    let next = |a: &f64| {
        let now = phase;
        slope -= TAU * a * a / total;
        phase = (phase + slope) % TAU;
        now
    };
    amplitudes.iter().map(next).collect()
}
