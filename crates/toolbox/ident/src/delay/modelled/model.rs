//! A model of a delay, and how it is asked for.

use crate::continuous::RationalChannel;
use crate::delay::DelayEstimate;

/// Samples by which outputs are made later, so that a dead time of none lies within what is searched.
pub(super) const LEAD: usize = 2;

/// Losses below this part of the output's power are rounding.
pub(super) const ROUNDING: f64 = 1e-18;

/// Estimates the dead times `τ_k` of `y(t) = Σ_k G_k(s) e^{−sτ_k} u_k(t) + r(t) + v(t)` by minimising the error of the
/// simulated output: what is fed in is known between the samples (`Intersample`), so that held inputs give the fraction
/// of a sample too, and the output may be slower than the inputs, or have gaps. Inputs with gaps are cut there
/// ([`Dataset::without_input_gaps`](crate::Dataset::without_input_gaps)); outputs count from where all inputs are known
/// that may reach them.
///
/// `G_k` is the simplest of 0, 1, 2, 3, 4 poles (with up to two zeros) that no richer one improves upon by more than
/// its parameters, and initial states in every experiment, do by chance, and whose errors do not depend on the inputs
/// any more. Ripple `r`, lines in the errors that the inputs do not have, is estimated along, added and in proportion
/// to the output: where it keeps time with a held input, it biases the dead time. The covariance is that of errors with
/// the autocorrelation of the residuals.
///
/// A dead time is claimed by `DelayModels::claimed` alone; the other models are there to be looked at.
///
/// # Example
/// ```
/// # let mut random = signal::excitation::Random::new(1);
/// # let levels: Vec<f64> = (0..120).map(|_| random.normal()).collect();
/// // Held for ten samples; a lag of two samples and a dead time of 1.3.
/// let u: Vec<f64> = (0..1200).map(|t| levels[t / 10]).collect();
/// let mut y = vec![0.0; 1200];
/// for t in 2..1200 {
///     // Over the sample before t the input is u(t − 2) for 0.3 samples more, and u(t − 2 + 1) after.
///     let (early, whole) = ((-0.35_f64).exp(), (-0.5_f64).exp());
///     y[t] = whole * y[t - 1] + (early - whole) * u[t - 2] + (1.0 - early) * u[t - 1];
/// }
/// # y.rotate_right(1);
/// # y[0] = 0.0;
/// let found = ident::delay::ModelledDelay::default().estimate(&ident::Dataset::siso(0.001, &u, &y)?)?;
/// let model = found.claimed().ok_or(ident::StructureError::NoModel)?;
/// assert!((model.dead_times[0].samples - 1.3).abs() < 1e-3);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Ljung 1999, §10.2 (the minimisation), (9.42) (the covariance), §16.4–16.6 (the choice).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ModelledDelay {
    /// Longest dead time, in samples.
    pub longest: usize,
    /// Standard uncertainty of the instants of inputs against outputs, in samples: it is in every error below.
    pub dating: f64,
    /// Confidence of the intervals, above zero.
    pub level: f64,
}

impl Default for ModelledDelay {
    /// Up to 30 samples, exact instants, intervals of 95 %.
    fn default() -> Self {
        ModelledDelay { longest: 30, dating: 0.0, level: 0.95 }
    }
}

/// One model and its dead times, in samples.
#[derive(Debug, Clone, PartialEq)]
pub struct DelayModel {
    /// Zeros of each `G_k`.
    pub zeros: usize,
    /// Poles of each `G_k`; none for a gain.
    pub poles: usize,
    /// The dead time of each input. Of a gain under a held input it is known to a sample alone, and this is the middle
    /// of what is left.
    pub dead_times: Vec<DelayEstimate>,
    /// Their intervals, as far as they lie between zero and the longest dead time.
    pub intervals: Vec<(f64, f64)>,
    /// By how much the answer to slow changes is late: dead time and lags together, `−d arg G/dω` at rest. None for a
    /// gain, and where an input comes through without its mean.
    pub late_by: Vec<Option<DelayEstimate>>,
    /// Their intervals, from the covariance of dead time and coefficients to first order.
    pub late_intervals: Vec<Option<(f64, f64)>>,
    /// Mean squared error of the simulated output.
    pub loss: f64,
    /// 100 (1 − √loss/σ), with σ the standard deviation of the output without ripple.
    pub fit_percent: f64,
    /// Lines found in the errors and taken into the model.
    pub ripple_hz: Vec<f64>,
    /// Rows of errors.
    pub samples: usize,
    /// Why the intervals cannot be relied on.
    pub faults: Vec<DelayFault>,
    /// The dynamics of each input; none for a gain.
    pub(super) channels: Vec<RationalChannel>,
    /// Values that were free to follow the output: parameters, and initial states and levels of every experiment.
    pub(super) free: usize,
    /// The variance of estimates over what it would be with white errors.
    pub(super) inflation: f64,
}

/// Why an interval of a dead time cannot be relied on.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum DelayFault {
    /// A richer model is better.
    Outdone,
    /// The search did not converge, or a profile shows smaller errors elsewhere, where no estimate was possible.
    NotConverged,
    /// The longest dead time is the best, or cannot be distinguished from it: the true one may be longer than what was
    /// searched.
    AtLongest {
        /// Index of the input.
        input: usize,
        /// The longest dead time that was searched, in samples.
        tried: usize,
    },
    /// The output answers at once, or before the input moves: a direct way, instants that do not fit together, or an
    /// input that is not held.
    TooEarly {
        /// Index of the input.
        input: usize,
    },
    /// The inputs explain no more of the output than chance would, or the interval is nearly as wide as what was
    /// searched.
    Undetermined {
        /// Index of the input.
        input: usize,
    },
    /// The input moves the output by so few lines of frequency that a delay looks like a phase of the dynamics: each
    /// line gives a gain and a phase.
    FewLines {
        /// Index of the input.
        input: usize,
        /// Lines there are.
        lines: usize,
        /// Lines that the model asks for, one more value than it has parameters.
        needed: usize,
        /// The strongest of them.
        strongest_hz: f64,
    },
    /// The errors depend on past inputs.
    DynamicsMissing {
        /// The probability of that by chance.
        p_value: f64,
    },
    /// The errors depend on inputs to come, as in a closed loop.
    Feedback {
        /// The probability of that by chance.
        p_value: f64,
    },
    /// Too few data to test the errors.
    Untested,
}

impl DelayFault {
    /// Returns true if the fault depends on where the search ended: another search may end elsewhere.
    pub(super) fn is_of_search(&self) -> bool {
        matches!(self, DelayFault::NotConverged | DelayFault::AtLongest { .. } | DelayFault::TooEarly { .. })
    }
}
