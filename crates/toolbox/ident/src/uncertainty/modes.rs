//! Natural frequency, damping and time constant of poles and zeros, with their intervals.

use lti::{Complex64, Mode};

use super::UncertainRoot;
use crate::distributions::interval;

/// A pole or a zero as people read it, with its uncertainty to first order.
#[derive(Debug, Clone, PartialEq)]
pub struct UncertainMode {
    /// Frequency, damping and time constant at the estimate.
    pub mode: Mode,
    /// The root in `s`: `ln(z)/T` for a discrete one.
    s: Complex64,
    /// Covariance of the parts of `s`.
    covariance: [[f64; 2]; 2],
    root: UncertainRoot,
    sample_time_s: Option<f64>,
}

impl UncertainRoot {
    /// Natural frequency, damping and time constant of the root of a system with this sample time, `None` for a
    /// continuous one.
    ///
    /// `s = ln(z)/T`, hence `∂s = ∂z/(zT)`; `∂ω_n = (σ ∂σ + ω ∂ω)/|s|` and `∂ζ = (σω ∂ω − ω² ∂σ)/|s|³` with
    /// `s = σ + jω`.
    ///
    /// # Source
    /// Ljung 1999, §9.6, for the delta method.
    #[must_use]
    pub fn mode(&self, sample_time_s: Option<f64>) -> UncertainMode {
        let mode = Mode::new(self.value, sample_time_s);
        let (s, slope) = match sample_time_s {
            Some(t) => (self.value.ln() / t, (self.value * t).inv()),
            None => (self.value, Complex64::ONE),
        };
        let (a, b) = (slope.re, slope.im);
        let [[rr, ri], [_, ii]] = self.covariance;
        let covariance = [
            [a * a * rr - 2.0 * a * b * ri + b * b * ii, a * b * (rr - ii) + (a * a - b * b) * ri],
            [a * b * (rr - ii) + (a * a - b * b) * ri, b * b * rr + 2.0 * a * b * ri + a * a * ii],
        ];
        UncertainMode { mode, s, covariance, root: self.clone(), sample_time_s }
    }
}

impl UncertainMode {
    /// The interval of the natural frequency in rad/s; `None` without uncertainty, and where the root lies so near
    /// another that it means nothing.
    #[must_use]
    pub fn natural_frequency_rad_s(&self, level: f64) -> Option<(f64, f64)> {
        if self.is_monotonic() {
            let (low, high) = self.rate(level)?;
            let nearest = if low * high > 0.0 { low.abs().min(high.abs()) } else { 0.0 };
            return Some((nearest, low.abs().max(high.abs())));
        }
        let size = self.s.norm();
        let (low, high) = self.along((self.s.re / size, self.s.im / size), size, level)?;
        Some((low.max(0.0), high))
    }

    /// The interval of the damping; `None` as for the frequency, and for a real root, whose damping is 1 or −1 by
    /// definition.
    #[must_use]
    pub fn damping(&self, level: f64) -> Option<(f64, f64)> {
        if self.root.value.im == 0.0 {
            return None;
        }
        let cube = self.s.norm().powi(3);
        let gradient = (-self.s.im * self.s.im / cube, self.s.re * self.s.im / cube);
        let (low, high) = self.along(gradient, self.mode.damping, level)?;
        Some((low.max(-1.0), high.min(1.0)))
    }

    /// The interval of the time constant in seconds, that of the rate `−σ` turned over; infinite at one end where the
    /// rate may be zero.
    #[must_use]
    pub fn time_constant_s(&self, level: f64) -> Option<(f64, f64)> {
        let (low, high) = self.rate(level)?;
        Some(match self.s.re <= 0.0 {
            true if low <= 0.0 => (high.recip(), f64::INFINITY),
            false if high >= 0.0 => (f64::NEG_INFINITY, low.recip()),
            _ => (high.recip(), low.recip()),
        })
    }

    /// A real root whose way to `s` is monotonic, so that its own interval can be taken there.
    fn is_monotonic(&self) -> bool {
        self.root.value.im == 0.0 && (self.sample_time_s.is_none() || self.root.value.re > 0.0)
    }

    /// The interval of `−σ`.
    fn rate(&self, level: f64) -> Option<(f64, f64)> {
        if !self.is_monotonic() {
            return self.along((-1.0, 0.0), -self.s.re, level);
        }
        let (low, high) = self.of(self.root.value.re, self.root.covariance[0][0], level)?;
        let rate = |root: f64| match self.sample_time_s {
            Some(t) => -root.max(0.0).ln() / t,
            None => -root,
        };
        Some((rate(high), rate(low)))
    }

    /// The interval of a value that changes so with the parts of `s`.
    fn along(&self, (x, y): (f64, f64), value: f64, level: f64) -> Option<(f64, f64)> {
        let c = self.covariance;
        self.of(value, x * x * c[0][0] + 2.0 * x * y * c[0][1] + y * y * c[1][1], level)
    }

    fn of(&self, value: f64, variance: f64, level: f64) -> Option<(f64, f64)> {
        let is_known = variance.is_finite() && variance > 0.0 && value.is_finite() && !self.root.near_multiple;
        is_known.then(|| interval(value, variance.sqrt(), self.root.degrees_of_freedom, level))
    }
}
