//! Frequencies at which a response shows all it has.

use std::f64::consts::PI;

use super::modes::{AT_REST, continuous_root};
use crate::Complex64;
use crate::error::LtiError;
use crate::state_space::StateSpace;
use crate::transfer_function::TransferFunction;
use crate::zero_pole_gain::ZeroPoleGain;

/// Damping below which a root gets points of its own, and where these lie, in half widths from its frequency.
const LIGHT: f64 = 0.3;
const AROUND: [f64; 13] = [-8.0, -4.0, -2.0, -1.0, -0.5, -0.2, 0.0, 0.2, 0.5, 1.0, 2.0, 4.0, 8.0];
/// Beside the lowest and the highest root.
const DECADE: f64 = 10.0;
/// Decades below the Nyquist frequency that are shown of a discrete system whose roots are all at rest or at zero.
const FEW_DECADES: f64 = 1e3;

/// At least `points` frequencies in rad/s, rising, evenly spaced in their logarithm from a decade below the slowest
/// root to a decade above the fastest, or to the Nyquist frequency and no further; more of them about lightly damped
/// roots.
pub(crate) fn grid(roots: &[Complex64], sample_time_s: Option<f64>, points: usize) -> Vec<f64> {
    let roots: Vec<Complex64> = roots.iter().map(|r| continuous_root(*r, sample_time_s)).collect();
    between(span(&roots, sample_time_s), &roots, points)
}

/// From where to where roots in `s` shape a response.
fn span(roots: &[Complex64], sample_time_s: Option<f64>) -> (f64, f64) {
    let nyquist = sample_time_s.map_or(f64::INFINITY, |sample_time_s| PI / sample_time_s);
    // What lies beyond the Nyquist frequency, a discrete root at zero among it, shapes the band but has no place in it.
    let sizes = || roots.iter().map(|s| s.norm()).filter(|w| *w < nyquist);
    let fastest = sizes().fold(0.0, f64::max);
    let slowest = sizes().filter(|w| *w > AT_REST * fastest).fold(f64::INFINITY, f64::min);
    match (fastest > 0.0, nyquist.is_finite()) {
        (true, false) => (slowest / DECADE, fastest * DECADE),
        (true, true) => ((slowest / DECADE).min(nyquist / FEW_DECADES), nyquist),
        (false, true) => (nyquist / FEW_DECADES, nyquist),
        (false, false) => (1.0 / FEW_DECADES, FEW_DECADES),
    }
}

fn between((low, high): (f64, f64), roots: &[Complex64], points: usize) -> Vec<f64> {
    let intervals = points.max(2) - 1;
    let ratio = (high / low).ln() / intervals as f64;
    let mut all: Vec<f64> = (0..intervals).map(|i| low * (ratio * i as f64).exp()).collect();
    all.push(high);
    for s in roots.iter().filter(|s| s.im > 0.0 && s.re.abs() < LIGHT * s.norm()) {
        let half_width = s.re.abs().max(1e-9 * s.norm());
        all.extend(AROUND.iter().map(|k| s.im + k * half_width).filter(|w| *w > low && *w < high));
    }
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

/// Frequencies for one Bode plot of several systems, from where the first begins to where the last ends, the Nyquist
/// frequency of each discrete one among them; see [`ZeroPoleGain::frequency_grid`]. A discrete system has no response
/// beyond its own.
///
/// # Errors
/// [`LtiError::NoConvergence`].
pub fn common_frequency_grid(systems: &[StateSpace], points: usize) -> Result<Vec<f64>, LtiError> {
    let (mut low, mut high) = (f64::INFINITY, 0.0_f64);
    let (mut roots, mut ends) = (Vec::new(), Vec::new());
    for system in systems {
        let time = system.sample_time_s();
        let own: Vec<Complex64> = system.poles()?.into_iter().map(|r| continuous_root(r, time)).collect();
        let (from, to) = span(&own, time);
        (low, high) = (low.min(from), high.max(to));
        ends.extend(time.map(|sample_time_s| PI / sample_time_s));
        roots.extend(own);
    }
    if systems.is_empty() {
        return Ok(Vec::new());
    }
    let mut all = between((low, high), &roots, points);
    all.extend(ends);
    all.sort_by(f64::total_cmp);
    all.dedup();
    Ok(all)
}

impl ZeroPoleGain {
    /// At least `points` frequencies in rad/s for a Bode plot: from a decade below the slowest root to a decade above
    /// the fastest, or to the Nyquist frequency, denser about lightly damped poles and zeros.
    #[must_use]
    pub fn frequency_grid(&self, points: usize) -> Vec<f64> {
        let mut roots = [self.poles(), self.zeros()].concat();
        if self.sample_time_s().is_none() && self.delay_s() > 0.0 {
            // Where the delay turns the phase.
            roots.push(Complex64::from(-1.0 / self.delay_s()));
        }
        grid(&roots, self.sample_time_s(), points)
    }
}

impl TransferFunction {
    /// Frequencies for a Bode plot; see [`ZeroPoleGain::frequency_grid`].
    ///
    /// # Errors
    /// Those of [`TransferFunction::to_zero_pole_gain`].
    ///
    /// # Example
    /// ```
    /// let sampled = lti::TransferFunction::discrete(vec![1.0], vec![1.0, -0.9], 0.1)?;
    /// let grid = sampled.frequency_grid(100)?;
    /// assert_eq!((grid.len(), grid[99]), (100, std::f64::consts::PI / 0.1));
    /// # Ok::<(), lti::LtiError>(())
    /// ```
    pub fn frequency_grid(&self, points: usize) -> Result<Vec<f64>, LtiError> {
        Ok(self.to_zero_pole_gain()?.frequency_grid(points))
    }
}

impl StateSpace {
    /// Frequencies for a Bode plot, by the poles alone; see [`ZeroPoleGain::frequency_grid`].
    ///
    /// # Errors
    /// [`LtiError::NoConvergence`].
    pub fn frequency_grid(&self, points: usize) -> Result<Vec<f64>, LtiError> {
        Ok(grid(&self.poles()?, self.sample_time_s(), points))
    }
}
