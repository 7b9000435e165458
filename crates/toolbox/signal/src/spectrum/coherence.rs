//! How far to trust coherences and cross spectra: their distribution for Gaussian noise.

use std::f64::consts::PI;

use numerics::search;

use super::CrossSpectrum;
use crate::distributions::{chi_squared_quantile, student_t_quantile};
use crate::error::{SignalError, check_range};

/// Sums are scaled down beyond this.
const LARGE: f64 = 1e200;

impl CrossSpectrum {
    /// The interval that holds the coherence at each frequency with probability `confidence`, exact for Gaussian noise
    /// whose spectra are even within the resolution: the coherences γ² under which the estimate is neither among the
    /// `(1 − p)/2` smallest nor the `(1 − p)/2` largest. Averages count as ν/2 independent ones, rounded down. At rest
    /// and at half the sample rate, where transforms are real, it is `[0, 1]`, and so with fewer than two averages.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] unless `0 < confidence < 1`.
    ///
    /// # Example
    /// ```
    /// use signal::excitation::Random;
    /// use signal::spectrum::{Welch, cross_spectrum};
    /// let mut random = Random::new(1);
    /// let x: Vec<f64> = (0..20_000).map(|_| random.normal()).collect();
    /// let y: Vec<f64> = x.iter().map(|x| x + random.normal()).collect();
    /// let cross = cross_spectrum(&x, &y, 1.0, Welch::half_overlapping(200))?;
    /// let inside = cross.coherence_interval(0.95)?[1..100].iter().filter(|[low, high]| *low < 0.5 && 0.5 < *high).count();
    /// assert!(inside >= 89); // 95 of 99 expected
    /// # Ok::<(), signal::SignalError>(())
    /// ```
    ///
    /// # Source
    /// Distribution: Carter, G. C. (1987), Proc. IEEE 75(2), 236–255, eq. 31.
    pub fn coherence_interval(&self, confidence: f64) -> Result<Vec<[f64; 2]>, SignalError> {
        check_confidence(confidence)?;
        let averages = self.whole_averages();
        let tail = 0.5 * (1.0 - confidence);
        let interval = |k: usize, found: f64| {
            if averages < 2 || self.is_real(k) {
                return [0.0, 1.0];
            }
            // The probability of less than was found falls as the true coherence rises.
            [coherence_where(found, averages, 1.0 - tail), coherence_where(found, averages, tail).max(found).min(1.0)]
        };
        Ok(work::checked(self.coherence()).enumerate().map(|(k, found)| interval(k, found)).collect())
    }

    /// The interval that holds the magnitude of the cross density at each frequency with probability `confidence`. With
    /// γ² the coherence, the relative variance of `|P̂xy|` is `(1 + 1/γ²)/ν`; χ² of the degrees of freedom that have
    /// it, `2ν/(1 + 1/γ²)`, gives the ends, which is exact at γ² = 1. Where the coherence is weak the interval of the
    /// coherence leads: the lower end is what its lower end makes of the powers, and where that is zero, so is the
    /// upper one. At rest and at half the sample rate it is `[0, ∞]`.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] unless `0 < confidence < 1`.
    ///
    /// # Source
    /// Variance: Brillinger, D. R. (1981), *Time Series*, theorem 7.6.2; Bendat and Piersol (2010), *Random Data*,
    /// §9.1.
    pub fn magnitude_interval(&self, confidence: f64) -> Result<Vec<[f64; 2]>, SignalError> {
        let known = self.coherence_interval(confidence)?;
        let averages = 0.5 * self.degrees_of_freedom;
        let tail = 0.5 * (1.0 - confidence);
        let power_end = self.degrees_of_freedom / chi_squared_quantile(tail, self.degrees_of_freedom);
        let interval = |k: usize, coherence: f64| {
            if self.whole_averages() < 2 || self.is_real(k) {
                return [0.0, f64::INFINITY];
            }
            let magnitude = self.pxy[k].norm();
            let [low, high] = known[k].map(|coherence| (self.pxx[k] * self.pyy[k] * coherence).sqrt());
            if low == 0.0 {
                return [0.0, high * power_end];
            }
            // Less what chance adds to it.
            let coherence = ((averages * coherence - 1.0) / (averages - 1.0)).max(known[k][0]);
            let freedom = 2.0 * self.degrees_of_freedom / (1.0 + 1.0 / coherence);
            let end = |probability: f64| magnitude * freedom / chi_squared_quantile(probability, freedom);
            [end(1.0 - tail).min(low), end(tail)]
        };
        Ok(work::checked(self.coherence()).enumerate().map(|(k, coherence)| interval(k, coherence)).collect())
    }

    /// The interval in radians that holds the phase of the cross density, and of the frequency response, at each
    /// frequency with probability `confidence`: `φ̂ ± arcsin(t √((1 − γ²)/(γ² (ν − 2))))`, t being Student's with ν − 2
    /// degrees of freedom. Its ends may lie beyond ±π; it is the whole circle where the signals may be unrelated, and
    /// at rest and at half the sample rate.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] unless `0 < confidence < 1`.
    ///
    /// # Source
    /// Priestley, M. B. (1981), *Spectral Analysis and Time Series*, eq. 9.5.17.
    pub fn phase_interval(&self, confidence: f64) -> Result<Vec<[f64; 2]>, SignalError> {
        check_confidence(confidence)?;
        let freedom = self.degrees_of_freedom - 2.0;
        let t = student_t_quantile(0.5 * (1.0 + confidence), freedom);
        let reach = |k: usize, coherence: f64| {
            let sine = t * ((1.0 - coherence).max(0.0) / (coherence * freedom)).sqrt();
            let is_known = freedom > 0.0 && !self.is_real(k) && sine < 1.0;
            if is_known { sine.asin() } else { PI }
        };
        let phases = self.pxy.iter().map(|p| p.arg());
        let reaches = work::checked(self.coherence()).enumerate().map(|(k, coherence)| reach(k, coherence));
        Ok(phases.zip(reaches).map(|(phase, reach)| [phase - reach, phase + reach]).collect())
    }

    /// Independent averages, rounded down.
    fn whole_averages(&self) -> usize {
        (0.5 * self.degrees_of_freedom) as usize
    }

    /// Returns true if transforms are real at this frequency.
    fn is_real(&self, k: usize) -> bool {
        k == 0 || (self.has_even_segments && k + 1 == self.freq_hz.len())
    }
}

fn check_confidence(confidence: f64) -> Result<(), SignalError> {
    check_range("confidence", confidence, f64::MIN_POSITIVE, 1.0 - f64::EPSILON)
}

/// The true coherence under which an estimate of at most `found` has this probability; 0 where it has less under any.
fn coherence_where(found: f64, averages: usize, probability: f64) -> f64 {
    let (low, high) = search::bisect((0.0, 1.0), |coherence| coherence_cdf(found, coherence, averages) > probability);
    if high < 1e-12 { 0.0 } else { 0.5 * (low + high) }
}

/// The probability that the coherence estimated from n averages is at most x where the true one is c:
/// `x ((1 − c)/(1 − cx))ⁿ Σ_{k=0}^{n−2} ((1 − x)/(1 − cx))ᵏ ₂F₁(−k, 1 − n; 1; cx)`.
///
/// The polynomials follow from Gauss' relation between neighbours in their first parameter; all terms are positive.
///
/// # Source
/// Carter (1987), eq. 31; Abramowitz and Stegun, 15.2.10.
fn coherence_cdf(x: f64, c: f64, n: usize) -> f64 {
    if x >= 1.0 {
        return 1.0;
    }
    if x <= 0.0 {
        return 0.0;
    }
    let z = c * x;
    let ratio = (1.0 - x) / (1.0 - z);
    let (mut before, mut term, mut sum, mut log_scale) = (0.0, 1.0, 0.0, 0.0);
    for k in 0..n - 1 {
        sum += term;
        let (order, rest) = (k as f64, (n - 1 - k) as f64);
        let next = ratio * ((2.0 * order + 1.0 + rest * z) * term - ratio * order * (1.0 - z) * before) / (order + 1.0);
        (before, term) = (term, next);
        if sum > LARGE {
            (before, term, sum) = (before / LARGE, term / LARGE, sum / LARGE);
            log_scale += LARGE.ln();
        }
    }
    (x * (n as f64 * ((1.0 - c) / (1.0 - z)).ln() + sum.ln() + log_scale).exp()).min(1.0)
}
