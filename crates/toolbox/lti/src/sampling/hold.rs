//! Undoing the holds, and holds of another length.

use faer::{Mat, Scale};

use crate::error::LtiError;
use crate::expm::expm;
use crate::logm::logm;
use crate::matrix::{balance, blocks, column_scale, difference, identity, inverse};
use crate::state_space::StateSpace;

/// `[Φ Γ; 0 I]`, which moves state and held input on by one sample.
fn augmented(system: &StateSpace) -> Mat<f64> {
    let (n, m) = (system.states(), system.inputs());
    let (zero, one) = (Mat::zeros(m, n), identity(m));
    blocks([[system.a(), system.b()], [zero.as_ref(), one.as_ref()]])
}

/// The two upper blocks again.
fn upper(whole: &Mat<f64>, system: &StateSpace) -> (Mat<f64>, Mat<f64>) {
    let (n, m) = (system.states(), system.inputs());
    (whole.submatrix(0, 0, n, n).to_owned(), whole.submatrix(0, n, n, m).to_owned())
}

/// The continuous system of which this is the zero-order hold: `[A B; 0 0] T = ln [Φ Γ; 0 I]`.
///
/// States and inputs are scaled first, so that `Γ` does not drown what `Φ` differs from one by.
pub(super) fn zero_order_undone(system: &StateSpace, sample_time_s: f64) -> Result<StateSpace, LtiError> {
    let (n, m) = (system.states(), system.inputs());
    let (phi, states) = balance(system.a());
    let gamma = Mat::from_fn(n, m, |i, j| system.b()[(i, j)] / states[i]);
    let moved = (&phi - identity(n)).norm_l2();
    let inputs: Vec<f64> = (0..m).map(|j| column_scale(gamma.col(j).norm_l2(), moved)).collect();
    let scaled = Mat::from_fn(n, m, |i, j| gamma[(i, j)] * inputs[j]);
    let alike = StateSpace::discrete(phi, scaled, Mat::zeros(0, n), Mat::zeros(0, m), sample_time_s)?;
    let (at, bt) = upper(&logm(augmented(&alike).as_ref())?, system);
    let a = Mat::from_fn(n, n, |i, j| states[i] * at[(i, j)] / states[j] / sample_time_s);
    let b = Mat::from_fn(n, m, |i, j| states[i] * bt[(i, j)] / inputs[j] / sample_time_s);
    StateSpace::continuous(a, b, system.c().to_owned(), system.d().to_owned())
}

/// The continuous system of which this is the first-order hold.
///
/// With `φ₁ = ∫₀¹ e^{ATs} ds` and `φ₂ = ∫₀¹ (1 − s) e^{ATs} ds`, the held system has `B_d = T φ₁² B` and
/// `D_d = D + T C φ₂ B`.
pub(super) fn first_order_undone(system: &StateSpace, sample_time_s: f64) -> Result<StateSpace, LtiError> {
    let n = system.states();
    let at = logm(system.a())?;
    let (zero, one) = (Mat::zeros(n, n), identity(n));
    let e = expm(
        blocks([
            [at.as_ref(), one.as_ref(), zero.as_ref()],
            [zero.as_ref(), zero.as_ref(), one.as_ref()],
            [zero.as_ref(), zero.as_ref(), zero.as_ref()],
        ])
        .as_ref(),
    )?;
    let (phi1, phi2) = (e.submatrix(0, n, n, n), e.submatrix(0, 2 * n, n, n));
    let undo = inverse((phi1 * phi1).as_ref()).ok_or(LtiError::Singular { what: "integral of the exponential" })?;
    let b = undo * system.b() * Scale(1.0 / sample_time_s);
    let d = difference(system.d(), (system.c() * phi2 * &b * Scale(sample_time_s)).as_ref());
    StateSpace::continuous(at * Scale(1.0 / sample_time_s), b, system.c().to_owned(), d)
}

/// The system held for as many samples as its new sample time has: a power of `[Φ Γ; 0 I]`, and only where the number
/// is not whole by way of the continuous system.
pub(super) fn lengthened(system: &StateSpace, now_s: f64, sample_time_s: f64) -> Result<StateSpace, LtiError> {
    let ratio = sample_time_s / now_s;
    let is_whole = ratio > 0.5 && ratio < 2_f64.powi(52) && (ratio - ratio.round()).abs() < 1e-9 * ratio;
    if !is_whole {
        return zero_order_undone(system, now_s)?.to_discrete_zoh(sample_time_s);
    }
    let (a, b) = upper(&power(augmented(system), ratio.round() as u64), system);
    StateSpace::discrete(a, b, system.c().to_owned(), system.d().to_owned(), sample_time_s)
}

/// By repeated squaring; the exponent is at least one.
fn power(mut base: Mat<f64>, mut exponent: u64) -> Mat<f64> {
    let mut product = identity(base.nrows());
    loop {
        if exponent % 2 == 1 {
            product = &product * &base;
        }
        exponent /= 2;
        if exponent == 0 {
            return product;
        }
        base = &base * &base;
    }
}
