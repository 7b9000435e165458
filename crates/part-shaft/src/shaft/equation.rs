//! The shaft's differential equation with the timing of its signals.

use ident::frequency::{Equation, ORDERS};
use signal::Complex64;

use super::places::{
    COUNT, DYNO, DYNO_TURN, DYNO_WAVES, ENGINE, ENGINE_TURN, ENGINE_WAVES, FRICTION, GATE, INERTIA, K, SKEW_ENGINE,
    SKEW_TORQUE, TERM, TERM_WAVE, TORQUE,
};
use super::springs::Springs;
use crate::shaft::term::Term;

/// s T_shaft + (K + B s)(ω_d − ω_e) = 0, with s T_shaft = J_d s² ω_d + c s ω_d + s T_d when it is computed (c the slope of
/// the friction over speed, without which it would be taken for B: both brake ω_d) and J_d = c = 0 when a flange measures it.
///
/// A logged speed holds the once-a-turn error of its encoder, ω (a cos θ + b sin θ), which is taken from it; and it is the mean over a gate that ends at its time stamp, (1 − e^{−sT})/(sT) =
/// e^{−sT/2} sinc; the common factor e^{−sT/2} is divided out, which leaves e^{−sT/2} on the torque, a point sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ShaftEquation {
    pub(super) dating: Dating,
    /// What may be in the shaft beyond K and B.
    pub(super) term: Option<Term>,
}

/// By how much N_e and torque were dated earlier than recorded before they were transformed, s.
///
/// A delay is e^{−sδ} in the transform of a whole signal; under a window it is so only as far as the window does not
/// change over δ. Signals are therefore dated by the skews of a first fit, which leaves the second nothing to err about.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Dating {
    pub(super) engine_s: f64,
    pub(super) torque_s: f64,
}

impl Dating {
    /// What takes a fit's skews out.
    pub(super) fn of(theta: &[f64]) -> Self {
        Dating { engine_s: theta[SKEW_ENGINE], torque_s: theta[SKEW_TORQUE] - theta[GATE] / 2.0 }
    }
}

/// A correction factor with its derivative by the gate.
struct Factor {
    value: Complex64,
    by_gate: Complex64,
}

/// 1/sinc of a gate: sT/2 / sinh(sT/2).
fn gate_correction(s: Complex64, gate: f64) -> Factor {
    let x = s * gate / 2.0;
    if x.norm() < 1e-6 {
        return Factor { value: Complex64::from(1.0), by_gate: -s * x / 6.0 };
    }
    let value = x / x.sinh();
    Factor { value, by_gate: s / 2.0 * value * (1.0 / x - x.cosh() / x.sinh()) }
}

/// What turns the transforms of the records into those of the motion and torque they stand for, at one frequency.
pub(super) struct Corrections {
    pub(super) speed: Complex64,
    pub(super) engine: Complex64,
    pub(super) torque: Complex64,
    speed_by_gate: Complex64,
}

impl Corrections {
    /// For records that were dated earlier by `dating` already.
    pub(super) fn at(s: Complex64, theta: &[f64], dating: Dating) -> Self {
        let rest = Dating::of(theta);
        let gate = gate_correction(s, theta[GATE]);
        Corrections {
            speed: gate.value,
            engine: gate.value * (s * (rest.engine_s - dating.engine_s)).exp(),
            torque: (s * (rest.torque_s - dating.torque_s)).exp(),
            speed_by_gate: gate.by_gate,
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
        derivatives: &mut [Vec<[Complex64; ORDERS]>],
    ) {
        let Corrections { speed, engine, torque, speed_by_gate } = Corrections::at(s, theta, self.dating);
        let springs = Springs::of(self.term, s, theta);
        let real = Complex64::from;
        let mut dyno = springs.sides.dyno;
        dyno[1] += theta[FRICTION];
        dyno[2] += theta[INERTIA];
        polynomials.fill([Complex64::default(); ORDERS]);
        polynomials[DYNO] = dyno.map(|c| speed * c);
        polynomials[ENGINE] = springs.sides.engine.map(|c| -engine * c);
        polynomials[TORQUE] = [0.0, 1.0, 0.0].map(|c| torque * c);
        for row in derivatives.iter_mut() {
            row.fill([Complex64::default(); ORDERS]);
        }
        derivatives[INERTIA][DYNO][2] = speed;
        derivatives[FRICTION][DYNO][1] = speed;
        for (parameter, slope) in springs.slopes.into_iter().flatten() {
            derivatives[parameter][DYNO] = slope.dyno.map(|c| speed * c);
            derivatives[parameter][ENGINE] = slope.engine.map(|c| -engine * c);
        }
        derivatives[SKEW_ENGINE][ENGINE] = polynomials[ENGINE].map(|c| s * c);
        derivatives[SKEW_TORQUE][TORQUE] = polynomials[TORQUE].map(|c| s * c);
        derivatives[GATE][DYNO] = dyno.map(|c| speed_by_gate * c);
        derivatives[GATE][ENGINE] = polynomials[ENGINE].map(|c| speed_by_gate / speed * c);
        derivatives[GATE][TORQUE] = polynomials[TORQUE].map(|c| -0.5 * s * c);
        match self.term {
            Some(Term::OfStiffness(_)) => {
                polynomials[TERM_WAVE][0] = real(-theta[K] * theta[TERM]);
                derivatives[TERM][TERM_WAVE][0] = real(-theta[K]);
                derivatives[K][TERM_WAVE][0] = real(-theta[TERM]);
            }
            Some(Term::OfDamping(_)) => {
                polynomials[TERM_WAVE][1] = real(-theta[TERM]);
                derivatives[TERM][TERM_WAVE][1] = real(-1.0);
            }
            Some(Term::LossFactor | Term::SecondMass | Term::DualMass) | None => (),
        }
        for (speed, waves, amplitudes) in [(DYNO, DYNO_WAVES, DYNO_TURN), (ENGINE, ENGINE_WAVES, ENGINE_TURN)] {
            for (wave, amplitude) in waves.into_iter().zip(amplitudes) {
                polynomials[wave] = polynomials[speed].map(|c| -theta[amplitude] * c);
                for row in derivatives.iter_mut() {
                    row[wave] = row[speed].map(|c| -theta[amplitude] * c);
                }
                derivatives[amplitude][wave] = polynomials[speed].map(|c| -c);
            }
        }
    }
}
