//! The shaft's differential equation with the timing of its signals.

use ident::frequency::{Equation, ORDERS, Slope};
use signal::Complex64;

use super::places::{
    COMPUTED_LAG, COUNT, DYNO, ENGINE, FRICTION, GATE, INERTIA, K, LAG, SKEW_ENGINE, SKEW_TORQUE, TERM, TERM_WAVE,
    TORQUE,
};
use super::springs::Springs;
use crate::shaft::term::Term;

/// s T_shaft + (K + B s)(ω_d − ω_e) = 0, with s T_shaft = J_d s² ω_d + c s ω_d + s T_d when it is computed (c the slope
/// of the friction over speed, without which it would be taken for B: both brake ω_d) and J_d = c = 0 when a flange
/// measures it.
///
/// A logged speed holds the once-a-turn error of its encoder, ω (a cos θ + b sin θ), which is taken from it; and it is
/// the mean over a gate that ends at its time stamp, (1 − e^{−sT})/(sT) = e^{−sT/2} sinc; the common factor e^{−sT/2}
/// is divided out, which leaves e^{−sT/2} on the torque, a point sample. Where the torque is what the torque control
/// makes of its demand, its lag may be another than it was computed with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ShaftEquation {
    pub(super) dating: Dating,
    /// Term that may be in the shaft beyond K and B.
    pub(super) term: Option<Term>,
}

const ZERO: Complex64 = Complex64::ZERO;

/// By how much N_e and torque were dated earlier than recorded before they were transformed, s.
///
/// A delay is e^{−sδ} in the transform of a whole signal; under a window it is so only as far as the window does not
/// change over δ. Signals are therefore dated by the skews of a first fit, which leaves the second nothing to err
/// about.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Dating {
    pub(super) engine_s: f64,
    pub(super) torque_s: f64,
}

impl Dating {
    /// Dating that takes a fit's skews out.
    pub(super) fn of(theta: &[f64]) -> Self {
        Dating { engine_s: theta[SKEW_ENGINE], torque_s: theta[SKEW_TORQUE] - theta[GATE] / 2.0 }
    }
}

/// 1/sinc of a gate, y/sin y with y = ωT/2 at s = jω, and its derivative by T.
fn gate_correction(s: Complex64, gate: f64) -> (f64, f64) {
    let y = s.im * gate / 2.0;
    if y.abs() < 1e-6 {
        return (1.0, s.im * y / 6.0);
    }
    let (sin, cos) = y.sin_cos();
    (y / sin, s.im / 2.0 * (sin - y * cos) / (sin * sin))
}

/// Factors that turn the transforms of the records into those of the motion and torque they stand for, at one
/// frequency.
pub(super) struct Corrections {
    pub(super) speed: f64,
    pub(super) engine: Complex64,
    pub(super) torque: Complex64,
    speed_by_gate: f64,
    /// Derivative of the logarithm of `torque` by the lag.
    torque_by_lag: Complex64,
}

impl Corrections {
    /// For records that were dated earlier by `dating` already.
    pub(super) fn at(s: Complex64, theta: &[f64], dating: Dating) -> Self {
        let rest = Dating::of(theta);
        let (speed, speed_by_gate) = gate_correction(s, theta[GATE]);
        let lag = 1.0 + s * theta[LAG];
        let lagged = (1.0 + s * theta[COMPUTED_LAG]) / lag;
        Corrections {
            speed,
            engine: speed * Complex64::cis(s.im * (rest.engine_s - dating.engine_s)),
            torque: lagged * Complex64::cis(s.im * (rest.torque_s - dating.torque_s)),
            speed_by_gate,
            torque_by_lag: -s / lag,
        }
    }
}

impl Equation for ShaftEquation {
    const SIGNALS: usize = TERM_WAVE + 1;
    const PARAMETERS: usize = COUNT;

    fn coefficients(
        &self,
        s: Complex64,
        theta: &[f64],
        polynomials: &mut [[Complex64; ORDERS]],
        slopes: Option<&mut Vec<Slope>>,
    ) {
        let corrections = Corrections::at(s, theta, self.dating);
        let Corrections { speed, engine, torque, .. } = corrections;
        let springs = Springs::of(self.term, s, theta, slopes.is_some());
        let mut dyno = springs.sides.dyno;
        dyno[1] += theta[FRICTION];
        dyno[2] += theta[INERTIA];
        polynomials[DYNO] = dyno.map(|c| speed * c);
        polynomials[ENGINE] = springs.sides.engine.map(|c| -engine * c);
        polynomials[TORQUE] = [ZERO, torque, ZERO];
        polynomials[TERM_WAVE] = match self.term {
            Some(Term::OfStiffness(_)) => [Complex64::from(-theta[K] * theta[TERM]), ZERO, ZERO],
            Some(Term::OfDamping(_)) => [ZERO, Complex64::from(-theta[TERM]), ZERO],
            Some(Term::LossFactor | Term::SecondMass | Term::DualMass) | None => [ZERO; ORDERS],
        };
        if let Some(slopes) = slopes {
            self.add_slopes(s, theta, polynomials, &corrections, &springs, slopes);
        }
    }
}

impl ShaftEquation {
    fn add_slopes(
        &self,
        s: Complex64,
        theta: &[f64],
        polynomials: &[[Complex64; ORDERS]],
        corrections: &Corrections,
        springs: &Springs,
        slopes: &mut Vec<Slope>,
    ) {
        let Corrections { speed, engine, speed_by_gate, torque_by_lag, .. } = *corrections;
        let mut add = |parameter, signal, by_order| slopes.push(Slope { parameter, signal, by_order });
        add(INERTIA, DYNO, [ZERO, ZERO, speed.into()]);
        add(FRICTION, DYNO, [ZERO, speed.into(), ZERO]);
        for (parameter, slope) in springs.slopes.iter().flatten() {
            add(*parameter, DYNO, slope.dyno.map(|c| speed * c));
            add(*parameter, ENGINE, slope.engine.map(|c| -engine * c));
        }
        add(SKEW_ENGINE, ENGINE, polynomials[ENGINE].map(|c| s * c));
        add(SKEW_TORQUE, TORQUE, polynomials[TORQUE].map(|c| s * c));
        for signal in [DYNO, ENGINE] {
            add(GATE, signal, polynomials[signal].map(|c| speed_by_gate / speed * c));
        }
        add(GATE, TORQUE, polynomials[TORQUE].map(|c| -0.5 * s * c));
        add(LAG, TORQUE, polynomials[TORQUE].map(|c| torque_by_lag * c));
        match self.term {
            Some(Term::OfStiffness(_)) => {
                add(TERM, TERM_WAVE, [Complex64::from(-theta[K]), ZERO, ZERO]);
                add(K, TERM_WAVE, [Complex64::from(-theta[TERM]), ZERO, ZERO]);
            }
            Some(Term::OfDamping(_)) => add(TERM, TERM_WAVE, [ZERO, Complex64::from(-1.0), ZERO]),
            Some(Term::LossFactor | Term::SecondMass | Term::DualMass) | None => (),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shaft::places::{B, DUAL_MASS};
    use crate::shaft::term::Weight;

    /// A shaft with everything in it: values, and steps of the differences.
    fn theta(term: Option<Term>) -> [(f64, f64); COUNT] {
        let mut theta = [(0.0, 0.0); COUNT];
        theta[K] = (2400.0, 0.1);
        theta[B] = (6.0, 1e-3);
        theta[SKEW_ENGINE] = (3e-4, 1e-8);
        theta[SKEW_TORQUE] = (-7e-4, 1e-8);
        theta[GATE] = (1.1e-3, 1e-7);
        theta[INERTIA] = (0.6, 1e-5);
        theta[FRICTION] = (0.01, 1e-5);
        theta[LAG] = (2e-3, 1e-8);
        theta[COMPUTED_LAG] = (1.5e-3, 0.0);
        theta[TERM] = (0.02, 1e-5);
        if term == Some(Term::DualMass) {
            for (place, value) in DUAL_MASS.into_iter().zip([(0.08, 1e-6), (900.0, 0.05), (4.0, 1e-3)]) {
                theta[place] = value;
            }
        }
        theta
    }

    #[test]
    fn prop_slopes_equal_differences() {
        let of_stiffness = Term::OfStiffness(Weight::Torque);
        let terms = [of_stiffness, Term::LossFactor, Term::SecondMass, Term::DualMass].map(Some);
        for term in terms.into_iter().chain([None]) {
            let equation = ShaftEquation { dating: Dating { engine_s: 1e-4, torque_s: 2e-4 }, term };
            let s = Complex64::new(0.0, 130.0);
            let (theta, steps): (Vec<f64>, Vec<f64>) = theta(term).into_iter().unzip();
            let mut slopes = Vec::new();
            let mut at = [[ZERO; ORDERS]; ShaftEquation::SIGNALS];
            equation.coefficients(s, &theta, &mut at, Some(&mut slopes));
            for j in (0..COUNT).filter(|j| steps[*j] > 0.0) {
                let moved = |sign: f64| {
                    let mut moved = theta.clone();
                    moved[j] += sign * steps[j];
                    let mut polynomials = at;
                    equation.coefficients(s, &moved, &mut polynomials, None);
                    polynomials
                };
                let (up, down) = (moved(1.0), moved(-1.0));
                for signal in 0..ShaftEquation::SIGNALS {
                    for n in 0..ORDERS {
                        let difference = (up[signal][n] - down[signal][n]) / (2.0 * steps[j]);
                        let own = slopes.iter().filter(|slope| (slope.parameter, slope.signal) == (j, signal));
                        let slope: Complex64 = own.map(|slope| slope.by_order[n]).sum();
                        // What rounding leaves of a difference.
                        let rounding = 1e-13 * at[signal][n].norm() / steps[j];
                        let apart = (difference - slope).norm();
                        assert!(
                            apart <= 1e-6 * slope.norm() + rounding,
                            "{term:?}: {j}, {signal}, {n}: {slope}, {difference}"
                        );
                    }
                }
            }
        }
    }
}
