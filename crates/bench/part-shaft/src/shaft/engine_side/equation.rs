//! The engine's side of the shaft: s T_shaft + J_e s² ω_e + (P s + I) h(s) ω_e = s T_e.
//!
//! P and I are the engine's own speed control, which acts upon its next firing and holds until the one after, h(s) = (1
//! − e^{−2sτ})/(2sτ) with 2τ about the time between; what pulses make of it otherwise is part of the uncertainty. T_e
//! is the rest of the engine's torque, recorded nowhere, which moves both speeds.

use std::f64::consts::TAU;

use signal::Complex64;

use crate::shaft::response::{EngineSide, engine_side};
use crate::shaft::spectra::Spectra;

/// J_e, P, I and τ.
pub(super) const UNKNOWNS: usize = 4;
pub(super) const DELAY: usize = 3;
pub(super) type Unknowns = [f64; UNKNOWNS];
/// |2sτ| below which the hold is its series: the next term is 1e-9.
const SMALL_HOLD: f64 = 1e-4;
/// The spectrum of s T_e is a mean over so many Hz: wide against the resolution, narrow against what is between firing
/// lines.
const SMOOTHED_HZ: f64 = 0.8;

/// The engine's side at every bin.
pub(super) type Sides = Vec<EngineSide>;

/// How the engine's control acts upon its torque, where that is not recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Control {
    /// It holds for 2τ.
    Held,
    /// It acts τ late.
    Delayed,
}

impl Control {
    /// (1 − e^{−2sτ})/(2sτ) or e^{−sτ}, and its slope by τ.
    pub(super) fn response(self, s: Complex64, delay: f64) -> (Complex64, Complex64) {
        let x = 2.0 * s * delay;
        match self {
            Control::Delayed => ((-s * delay).exp(), -s * (-s * delay).exp()),
            Control::Held if x.norm() < SMALL_HOLD => (1.0 - 0.5 * x, -s),
            Control::Held => {
                let late = (-x).exp();
                ((1.0 - late) / x, 2.0 * s * (late * (x + 1.0) - 1.0) / (x * x))
            }
        }
    }
}

#[derive(Clone, Copy)]
pub(super) struct EngineEquation<'a> {
    pub(super) spectra: &'a Spectra,
    pub(super) control: Control,
}

impl EngineEquation<'_> {
    /// The engine's side at every bin, for the shaft's parameters.
    pub(super) fn sides(&self, theta: &[f64]) -> Sides {
        self.spectra.bins.iter().map(|bin| engine_side(self.spectra, theta, *bin)).collect()
    }

    /// The error of the equation at every bin, and its slopes by the unknowns.
    pub(super) fn errors<'b>(
        &'b self,
        sides: &'b [EngineSide],
        [inertia, p, i, delay]: Unknowns,
    ) -> impl Iterator<Item = (Complex64, [Complex64; UNKNOWNS])> + 'b {
        self.spectra.bins.iter().zip(sides).map(move |(bin, side)| {
            let (late, by_delay) = self.control.response(laplace(self.spectra, *bin), delay);
            let [by_inertia, rate, speed] = side.regressors;
            let control = rate * p + speed * i;
            let error = side.torque_rate + by_inertia * inertia + control * late;
            (error, [by_inertia, rate * late, speed * late, control * by_delay])
        })
    }

    /// The spectrum of s T_e: a running mean of the errors' powers.
    pub(super) fn spectrum(&self, sides: &[EngineSide], solution: Unknowns) -> Vec<f64> {
        let reach = (0.5 * SMOOTHED_HZ * self.spectra.window.duration_s).ceil() as usize;
        let mut sums = vec![0.0];
        for (error, _) in self.errors(sides, solution) {
            sums.push(sums[sums.len() - 1] + error.norm_sqr());
        }
        let n = sums.len() - 1;
        let mean = |i: usize| {
            let (from, to) = (i.saturating_sub(reach), (i + reach + 1).min(n));
            ((sums[to] - sums[from]) / (to - from) as f64).max(f64::MIN_POSITIVE)
        };
        (0..n).map(mean).collect()
    }
}

/// s at a bin.
pub(super) fn laplace(spectra: &Spectra, bin: usize) -> Complex64 {
    Complex64::new(0.0, TAU * spectra.window.frequency_hz(bin))
}
