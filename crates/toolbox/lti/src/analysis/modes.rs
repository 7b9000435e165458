//! Natural frequency and damping of poles.

use crate::Complex64;
use crate::error::LtiError;
use crate::state_space::StateSpace;
use crate::transfer_function::TransferFunction;
use crate::zero_pole_gain::ZeroPoleGain;

/// Roots slower than the fastest by this factor count as at rest: rounding puts integrators there.
pub(super) const AT_REST: f64 = 1e-7;

/// A pole by its natural frequency and damping: `s² + 2ζ ω_n s + ω_n²` for a pair.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mode {
    /// The pole of the system, in `s` or in `z`.
    pub pole: Complex64,
    /// `ω_n = |s|`, in rad/s; infinite for a discrete pole at zero.
    pub natural_frequency_rad_s: f64,
    /// `ζ = −Re s/|s|`: 1 for a stable real pole, negative for an unstable one; 1 for a pole at rest too.
    pub damping: f64,
}

impl Mode {
    /// The mode of a pole; one of a discrete system by `s = ln(z)/T`.
    ///
    /// # Example
    /// ```
    /// use lti::{Complex64, Mode};
    /// let mode = Mode::new(Complex64::new(-3.0, 4.0), None);
    /// assert!((mode.natural_frequency_rad_s - 5.0).abs() < 1e-14 && (mode.damping - 0.6).abs() < 1e-15);
    /// ```
    #[must_use]
    pub fn new(pole: Complex64, sample_time_s: Option<f64>) -> Self {
        if sample_time_s.is_some() && pole == Complex64::ZERO {
            return Self { pole, natural_frequency_rad_s: f64::INFINITY, damping: 1.0 };
        }
        let s = continuous_root(pole, sample_time_s);
        let natural_frequency_rad_s = s.norm();
        let damping = if natural_frequency_rad_s == 0.0 { 1.0 } else { -s.re / natural_frequency_rad_s };
        Self { pole, natural_frequency_rad_s, damping }
    }

    /// `1/(ζ ω_n)` in seconds, in which the mode falls to 1/e; negative for one that grows, infinite for one that
    /// stays.
    #[must_use]
    pub fn time_constant_s(&self) -> f64 {
        if self.natural_frequency_rad_s == 0.0 {
            return f64::INFINITY;
        }
        1.0 / (self.damping * self.natural_frequency_rad_s)
    }

    fn table(poles: &[Complex64], sample_time_s: Option<f64>) -> Vec<Self> {
        let mut modes: Vec<Self> = poles.iter().map(|p| Self::new(*p, sample_time_s)).collect();
        modes.sort_by(|a, b| a.natural_frequency_rad_s.total_cmp(&b.natural_frequency_rad_s));
        modes
    }
}

/// A root in `s`; not finite for a discrete one at zero.
pub(super) fn continuous_root(root: Complex64, sample_time_s: Option<f64>) -> Complex64 {
    sample_time_s.map_or(root, |sample_time_s| root.ln() / sample_time_s)
}

impl StateSpace {
    /// The modes of all poles, slowest first.
    ///
    /// # Errors
    /// [`LtiError::NoConvergence`].
    pub fn modes(&self) -> Result<Vec<Mode>, LtiError> {
        Ok(Mode::table(&self.poles()?, self.sample_time_s()))
    }

    /// The mode that grows fastest, `None` where none does: poles at the limit of stability, such as integrators, stay.
    ///
    /// # Errors
    /// [`LtiError::NoConvergence`].
    ///
    /// # Example
    /// ```
    /// use faer::mat;
    /// let runs_away = lti::StateSpace::discrete(mat![[1.0, 0.0], [0.0, -1.5]], mat![[1.0], [1.0]], mat![[1.0, 1.0]], mat![[0.0]], 0.1)?;
    /// assert_eq!(runs_away.growing_mode()?.map(|mode| mode.pole.re), Some(-1.5));
    /// # Ok::<(), lti::LtiError>(())
    /// ```
    pub fn growing_mode(&self) -> Result<Option<Mode>, LtiError> {
        let rate = |mode: &Mode| -mode.damping * mode.natural_frequency_rad_s;
        let modes = self.modes()?;
        let limit = rest_limit(&modes, self.sample_time_s());
        let growing = modes.into_iter().filter(|mode| rate(mode) > limit);
        Ok(growing.max_by(|a, b| rate(a).total_cmp(&rate(b))))
    }

    /// Returns true if a pole is at rest, as that of an integrator is, within rounding beside the fastest.
    ///
    /// # Errors
    /// [`LtiError::NoConvergence`].
    pub fn has_pole_at_rest(&self) -> Result<bool, LtiError> {
        Ok(settled(&self.poles()?, self.sample_time_s()).iter().any(|(_, is_at_rest)| *is_at_rest))
    }
}

/// Below this rate in rad/s a mode is at rest beside the fastest of these.
fn rest_limit(modes: &[Mode], sample_time_s: Option<f64>) -> f64 {
    let sizes = modes.iter().map(|mode| mode.natural_frequency_rad_s).filter(|size| size.is_finite());
    AT_REST * sizes.fold(sample_time_s.map_or(0.0, f64::recip), f64::max)
}

/// Poles of one system, those at rest exactly so: at `s = 0` or `z = 1`; and which these are. Rounding puts the pole of
/// an integrator beside it, where it would have a time constant of a million years.
///
/// # Example
/// ```
/// use lti::Complex64;
/// let found = lti::settled(&[Complex64::new(-6e-15, 0.0), Complex64::new(-8.0, 100.0)], None);
/// assert_eq!(found, [(Complex64::ZERO, true), (Complex64::new(-8.0, 100.0), false)]);
/// ```
#[must_use]
pub fn settled(poles: &[Complex64], sample_time_s: Option<f64>) -> Vec<(Complex64, bool)> {
    let modes: Vec<Mode> = poles.iter().map(|pole| Mode::new(*pole, sample_time_s)).collect();
    let limit = rest_limit(&modes, sample_time_s);
    let rest = if sample_time_s.is_some() { Complex64::ONE } else { Complex64::ZERO };
    let settle = |mode: &Mode| match mode.natural_frequency_rad_s <= limit {
        true => (rest, true),
        false => (mode.pole, false),
    };
    modes.iter().map(settle).collect()
}

impl TransferFunction {
    /// The modes of all poles, slowest first.
    ///
    /// # Errors
    /// [`LtiError::NoConvergence`].
    pub fn modes(&self) -> Result<Vec<Mode>, LtiError> {
        Ok(Mode::table(&self.poles()?, self.sample_time_s()))
    }
}

impl ZeroPoleGain {
    /// The modes of all poles, slowest first.
    #[must_use]
    pub fn modes(&self) -> Vec<Mode> {
        Mode::table(self.poles(), self.sample_time_s())
    }
}
