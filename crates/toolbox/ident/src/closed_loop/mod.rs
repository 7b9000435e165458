//! Estimation from data that were taken under feedback.
//!
//! The loop is `y(t) = G(q) u(t) + H(q) e(t)`, `u(t) = r(t) − R(q) y(t)`, with a reference or dither `r` independent of
//! the noise (a set point `w` gives `r = R w`). With the sensitivity `S = 1/(1 + G R)`:
//!
//! `y = G S r + S H e`, `u = S r − R S H e`.
//!
//! Data sets for these helpers have the inputs `u` and `r`, in this order, and one output.
//!
//! | method | needs | biased when |
//! | --- | --- | --- |
//! | [`Subspace`](crate::Subspace) with [`Weighting::Ssarx`](crate::Weighting::Ssarx): a state-space model from `u` to `y` | nothing of the loop | the loop has no delay; few samples, as all subspace methods |
//! | [`direct`]: a model from `u` to `y` | nothing of the loop | the noise model cannot describe `H` (output error with coloured noise, least squares with other than ARX noise): then towards `−1/R`, the more so the smaller `r` is against the noise; the loop has no delay |
//! | [`Indirect`]: a model from `r` to `y`, solved for `G` | `R`, exactly, and linear | `R` is not what was used, as with saturation; the model from `r` to `y` is of too low order |
//! | [`TwoStage`]: `r` to `u` at high order, then from the part of `u` that `r` made to `y` | `r` | the first model is of too low order; the noise model is no reason for bias. Errors are larger by the noise that circulates |
//! | [`JointInputOutput`]: `r` to `u` and `y` together, divided | `r` | orders too low; where `r` has little power the ratio is uncertain, and says so |
//!
//! # Source
//! Forssell & Ljung, *Closed-loop identification revisited*, Automatica 35, 1999; Ljung 1999, §13.4 and §13.5; Van den
//! Hof & Schrama, *An indirect method for transfer function estimation from closed loop data*, Automatica 29, 1993.

mod indirect;
mod joint;
mod two_stage;

pub use indirect::Indirect;
pub use joint::{ClosedLoopResponse, JointInputOutput};
pub use two_stage::TwoStage;

use crate::{Dataset, ExcitationOptions, Fit, IdentError};
use fitting::{Count, StructureError};

/// Index of the plant's input.
const INPUT: usize = 0;

/// Index of the reference.
const REFERENCE: usize = 1;

/// Fits a model from `u` to `y`, once it is made sure that the loop lets it: past inputs and outputs together must be
/// persistently exciting of `order`, the longest lag in the model.
///
/// Without a reference a regulator of low order makes the input a combination of past outputs. Many models then fit
/// equally well, and an estimator returns any of them. Only the residual test of the estimate shows whether the noise
/// model is sufficient: residuals must be white, and independent of *past* inputs.
///
/// # Errors
/// [`IdentError::RankDeficient`] where the data are not informative; those of `estimate`; [`IdentError::Structure`] for
/// other than one output.
///
/// # Example
/// ```
/// # use ident::closed_loop::direct;
/// // u = −2 y with nothing else: no estimator can separate the plant from −1/2.
/// let y: Vec<f64> = (0..100).map(|t| ((t * t) as f64).sin()).collect();
/// let u: Vec<f64> = y.iter().map(|y| -2.0 * y).collect();
/// let data = ident::Dataset::siso(0.1, &u, &y)?;
/// let refused = direct::<lti::PolynomialModel>(&data, 2, |_| Err(ident::IdentError::NoOutput));
/// assert!(matches!(refused, Err(ident::IdentError::RankDeficient { .. })));
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Ljung 1999, theorem 13.2 and (13.49)–(13.53).
pub fn direct<M>(
    data: &Dataset,
    order: usize,
    estimate: impl Fn(&Dataset) -> Result<Fit<M>, IdentError>,
) -> Result<Fit<M>, IdentError> {
    let plant = data.channels(&[INPUT], &[0])?;
    let options = ExcitationOptions { highest_order: order.max(1), ..Default::default() };
    let excitation = options.of_inputs_and_outputs(&plant)?;
    if excitation.order < order.min(excitation.levels.len()) {
        let weakest = excitation.levels.last().copied().unwrap_or(0.0);
        let parameters = 2 * order;
        return Err(IdentError::RankDeficient { rank: 2 * excitation.order, parameters, condition: weakest.recip() });
    }
    estimate(&plant)
}

/// Refuses data without input, reference and one output.
fn check_loop(data: &Dataset) -> Result<(), IdentError> {
    let method = "a loop with input u and reference r";
    if data.inputs() != 2 {
        return Err(StructureError::inputs(method, Count::Exactly(2), data.inputs()).into());
    }
    if data.outputs() != 1 {
        return Err(StructureError::outputs(method, Count::Exactly(1), data.outputs()).into());
    }
    Ok(())
}
