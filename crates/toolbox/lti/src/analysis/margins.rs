//! Stability margins.

use std::f64::consts::PI;

use numerics::search;
use serde::{Deserialize, Serialize};

use crate::Complex64;
use crate::error::LtiError;
use crate::transfer_function::TransferFunction;

/// Where a loop's gain is real and negative.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GainMargin {
    /// The frequency, in rad/s.
    pub omega_rad_s: f64,
    /// `−20 log₁₀ |L|`: by how much the gain may grow, or where negative must fall.
    pub gain_db: f64,
}

/// Where a loop's gain is one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PhaseMargin {
    /// The frequency, in rad/s.
    pub omega_rad_s: f64,
    /// How far the phase is from −180°, in −180 ..= 180 degrees.
    pub phase_deg: f64,
    /// The delay that would take up a positive phase margin, in seconds; for a negative one, up to the next turn.
    pub delay_s: f64,
}

/// How far a loop closed with a negative sign is from its stability limit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Margins {
    /// Every crossing of the negative real axis, by rising frequency.
    pub gain: Vec<GainMargin>,
    /// Every crossing of the unit circle, by rising frequency.
    pub phase: Vec<PhaseMargin>,
    /// The largest `|1/(1 + L)|` on the grid: one over the distance from −1.
    pub sensitivity_peak: f64,
}

const GRID_POINTS: usize = 4000;
/// Octaves beyond the grid in which the unit circle is looked for.
const MOST_STEPS: f64 = 200.0;
/// Distance from the real axis, relative to the gain, that is none where a crossing has been found.
const ON_AXIS: f64 = 1e-6;
/// And that is rounding anywhere.
const ROUNDING: f64 = 1e-12;

impl Margins {
    /// The margins of a loop gain given at any frequency, continuous or of this sample time, looked for on a rising
    /// grid in rad/s, and beyond its ends where the gain comes to one there with the slope it has, and refined between
    /// its points; two crossings between neighbouring points are missed. A gain that stays real crosses nothing.
    ///
    /// # Source
    /// Åström, K. J. and Murray, R. M. (2021), *Feedback Systems*, 2nd ed., §10.3.
    #[must_use]
    pub fn new(omega_rad_s: &[f64], sample_time_s: Option<f64>, open_loop: impl Fn(f64) -> Complex64) -> Self {
        let omega_rad_s = &extended(omega_rad_s, sample_time_s.is_none(), &open_loop);
        let values: Vec<Complex64> = omega_rad_s.iter().map(|w| open_loop(*w)).collect();
        let on_axis = |l: Complex64| l.re < 0.0 && l.im.abs() <= ON_AXIS * l.norm();
        let imaginary = |l: Complex64| if l.im.abs() <= ROUNDING * l.norm() { 0.0 } else { l.im };
        let mut real = crossings(omega_rad_s, &values, imaginary, &open_loop);
        // A discrete loop is real at the Nyquist frequency, where no sign changes.
        let nyquist = sample_time_s.map_or(f64::INFINITY, |t| (1.0 - ON_AXIS) * PI / t);
        if let Some(last) = omega_rad_s.last().filter(|last| **last >= nyquist) {
            real.retain(|w| (w - last).abs() > ON_AXIS * last);
            real.push(*last);
        }
        let gain = real.into_iter().map(|w| (w, open_loop(w))).filter(|(_, l)| on_axis(*l));
        let gain = gain.map(|(omega_rad_s, l)| GainMargin { omega_rad_s, gain_db: -20.0 * l.norm().log10() });
        let phase = crossings(omega_rad_s, &values, |l| l.norm() - 1.0, &open_loop).into_iter().map(|omega_rad_s| {
            let phase = (-open_loop(omega_rad_s)).arg();
            let delay_s = phase.rem_euclid(std::f64::consts::TAU) / omega_rad_s;
            PhaseMargin { omega_rad_s, phase_deg: phase.to_degrees(), delay_s }
        });
        let sensitivity = values.iter().map(|l| 1.0 / (l + 1.0).norm()).fold(0.0, f64::max);
        Self { gain: gain.collect(), phase: phase.collect(), sensitivity_peak: sensitivity }
    }
}

/// Where a measure of the loop gain changes sign.
fn crossings(
    omega_rad_s: &[f64],
    values: &[Complex64],
    measure: impl Fn(Complex64) -> f64,
    open_loop: &impl Fn(f64) -> Complex64,
) -> Vec<f64> {
    let mut found = Vec::new();
    for k in 1..values.len() {
        let (before, after) = (measure(values[k - 1]), measure(values[k]));
        let rises = before < 0.0;
        if before.is_nan() || after.is_nan() || rises == (after < 0.0) {
            continue;
        }
        let is_before = |omega: f64| rises == (measure(open_loop(omega)) < 0.0);
        let (low, high) = search::bisect((omega_rad_s[k - 1], omega_rad_s[k]), is_before);
        found.push(0.5 * (low + high));
    }
    found
}

/// A grid with what is beyond its ends until the unit circle, at high frequencies only where there is no Nyquist
/// frequency.
fn extended(grid: &[f64], is_continuous: bool, gain: &impl Fn(f64) -> Complex64) -> Vec<f64> {
    let (Some(first), Some(last)) = (grid.first(), grid.last()) else { return Vec::new() };
    let mut all = beyond(*first, 0.5, gain);
    all.reverse();
    all.extend(grid);
    if is_continuous {
        all.extend(beyond(*last, 2.0, gain));
    }
    all
}

/// Steps of `factor` from the end of a grid until past where the gain, which keeps its slope there, comes to one.
fn beyond(end: f64, factor: f64, gain: &impl Fn(f64) -> Complex64) -> Vec<f64> {
    let (size, next) = (gain(end).norm(), gain(end * factor).norm());
    let steps = -size.ln() / (next / size).ln();
    if !(steps > 0.0 && steps <= MOST_STEPS) {
        return Vec::new();
    }
    (1..=steps.ceil() as i32 + 2).map(|k| end * factor.powi(k)).collect()
}

impl TransferFunction {
    /// The margins of the loop that this open loop closes with a negative sign.
    ///
    /// # Errors
    /// Those of [`TransferFunction::frequency_grid`].
    ///
    /// # Example
    /// ```
    /// // 4/(s + 1)³ is real and negative at √3 rad/s, where it is 1/2.
    /// let margins = lti::TransferFunction::continuous(vec![4.0], vec![1.0, 3.0, 3.0, 1.0])?.margins()?;
    /// assert!((margins.gain[0].omega_rad_s - 3.0_f64.sqrt()).abs() < 1e-9);
    /// assert!((margins.gain[0].gain_db - 20.0 * 2.0_f64.log10()).abs() < 1e-9);
    /// # Ok::<(), lti::LtiError>(())
    /// ```
    pub fn margins(&self) -> Result<Margins, LtiError> {
        let grid = self.frequency_grid(GRID_POINTS)?;
        Ok(Margins::new(&grid, self.sample_time_s(), |w| self.evaluate_at(w)))
    }
}
