//! Options of the prediction-error method.

use signal::filter::Sos;

use super::orders::PerInput;
use crate::{Focus, NonlinearOptions};

/// Options of the prediction-error method for the general polynomial model, for every output `i`:
///
/// `A(q) y_i(t) = Σ_k B_k(q)/F_k(q) u_k(t) + C(q)/D(q) e_i(t)`
///
/// with polynomials in `q⁻¹` as in [`lti::PolynomialEquation`]: `A`, `C`, `D`, `F` start with one, and `B_k` with its
/// `nb` coefficients after a delay of `nk` samples. Every output has an equation of its own with the same orders. The
/// known members of the family are [`Armax`](crate::Armax), [`Ararx`](crate::Ararx),
/// [`OutputError`](crate::OutputError), [`BoxJenkins`](crate::BoxJenkins) and [`Arma`](crate::Arma).
///
/// Prediction errors are minimised by the Levenberg–Marquardt method with analytic gradients. `C` and `F` are kept in
/// the unit circle (`F` up to a growth of 1/N a sample, so that integrators can be met). An experiment is cut where an
/// input is missing, and each part has an initial state; where an output is missing, a model without `A`, `C`, `D`
/// leaves the sample out, and others cut the experiment there too.
///
/// # Source
/// Ljung, *System Identification*, 2nd ed., 1999, §7.2 (the method), §10.2–10.3 (search and gradient), (9.17)
/// (covariance).
#[derive(Debug, Clone, PartialEq)]
pub struct Polynomial {
    pub(super) na: usize,
    pub(super) nb: PerInput,
    pub(super) nc: usize,
    pub(super) nd: usize,
    pub(super) nf: PerInput,
    pub(super) nk: PerInput,
    pub(super) from_rest: bool,
    pub(super) focus: Focus,
    pub(super) prefilter: Option<Sos>,
    pub(super) batches: Option<usize>,
    pub(super) held: Vec<(String, f64)>,
    pub(super) starts: Vec<Vec<f64>>,
    pub(super) search: NonlinearOptions,
}
