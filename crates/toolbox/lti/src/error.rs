//! The one error type of the crate.

use numerics::linalg::DecompositionError;

use crate::dimensions::Dimensions;

/// Why an operation on a system cannot proceed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LtiError {
    /// A matrix or table does not have the rows and columns it must.
    #[error("{what} has {got} rows and columns, {expected} are needed")]
    Shape {
        /// Which matrix.
        what: &'static str,
        /// Rows and columns it must have.
        expected: Dimensions,
        /// Rows and columns given.
        got: Dimensions,
    },
    /// A number is NaN or infinite.
    #[error("{what} holds a number that is not finite")]
    NonFinite {
        /// Where it was found.
        what: &'static str,
    },
    /// The sample time is not a positive finite number.
    #[error("sample time {sample_time_s} s is not a positive finite number")]
    SampleTime {
        /// The value given.
        sample_time_s: f64,
    },
    /// A continuous system where a discrete one is needed.
    #[error("the system is continuous, a discrete one is needed")]
    NotDiscrete,
    /// A discrete system where a continuous one is needed.
    #[error("the system is discrete, a continuous one is needed")]
    NotContinuous,
    /// Two systems with different sample times, or one continuous and one discrete.
    #[error("sample times differ: {} and {}", clock(*first), clock(*second))]
    SampleTimesDiffer {
        /// The first system's sample time in seconds, `None` for a continuous one.
        first: Option<f64>,
        /// The second system's.
        second: Option<f64>,
    },
    /// A system with one input and one output is needed.
    #[error("{inputs} inputs and {outputs} outputs, one of each is needed")]
    NotSiso {
        /// Number of inputs.
        inputs: usize,
        /// Number of outputs.
        outputs: usize,
    },
    /// A polynomial without a coefficient other than zero.
    #[error("{what} is the zero polynomial")]
    ZeroPolynomial {
        /// Which polynomial.
        what: &'static str,
    },
    /// A numerator of higher degree than its denominator has no state-space form.
    #[error("numerator of degree {numerator} over denominator of degree {denominator}")]
    Improper {
        /// Degree of the numerator.
        numerator: usize,
        /// Degree of the denominator.
        denominator: usize,
    },
    /// A delay is negative, not finite, or of more samples than can be handled.
    #[error("delay {delay_s} s is out of range")]
    Delay {
        /// The value given.
        delay_s: f64,
    },
    /// The operation has no finite-dimensional result for a system with a delay.
    #[error("the system has a delay of {delay_s} s")]
    DelayPresent {
        /// The system's delay.
        delay_s: f64,
    },
    /// A matrix that must be inverted is singular, such as `A` of an integrator for the gain at rest.
    #[error("{what} is singular")]
    Singular {
        /// Which matrix.
        what: &'static str,
    },
    /// A loop closed without a delay or a state in it has no solution: `I + D₂D₁` is singular.
    #[error("the loop is algebraic and has no solution")]
    AlgebraicLoop,
    /// The transfer function is zero, so it has no zeros.
    #[error("the output does not depend on the input")]
    ZeroSystem,
    /// An output that depends on another one has no transfer function of its own polynomials.
    #[error("output {output} depends on another output; take the channel of the innovations form")]
    OutputsCoupled {
        /// The output asked for.
        output: usize,
    },
    /// The eigenvalue iteration did not converge.
    #[error("the eigenvalue iteration did not converge")]
    NoConvergence,
    /// An index of an input or output outside the system.
    #[error("{what} {index} of {count}")]
    Index {
        /// `"input"` or `"output"`.
        what: &'static str,
        /// The index asked for.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// More poles, or a higher degree of approximation, than there may be.
    #[error("order {order}, at most {most} is possible")]
    Order {
        /// The order asked for.
        order: usize,
        /// The highest possible.
        most: usize,
    },
    /// A matrix with an eigenvalue at zero or on the negative real axis has no real principal logarithm: no continuous
    /// system of as many states has such a pole when sampled.
    #[error("a pole at {re} + {im}j has no real logarithm")]
    NoLogarithm {
        /// The eigenvalue's real part.
        re: f64,
        /// Its imaginary part.
        im: f64,
    },
    /// The operation needs every pole strictly inside the stable region.
    #[error("the system is not stable: pole at {re} + {im}j")]
    Unstable {
        /// Real part of the pole nearest to or furthest beyond the limit.
        re: f64,
        /// Its imaginary part.
        im: f64,
    },
    /// A delay that must be a whole number of samples is not.
    #[error("delay {delay_s} s is not a whole number of samples of {sample_time_s} s")]
    FractionalDelay {
        /// The delay.
        delay_s: f64,
        /// The sample time.
        sample_time_s: f64,
    },
    /// A frequency that must lie between zero and the Nyquist frequency does not.
    #[error("frequency {omega_rad_s} rad/s is not between 0 and the Nyquist frequency")]
    Frequency {
        /// The value given.
        omega_rad_s: f64,
    },
    /// Roots off the real axis without their conjugates belong to no real system.
    #[error("{what} are not in conjugate pairs")]
    NotConjugate {
        /// Which roots.
        what: &'static str,
    },
}

impl From<DecompositionError> for LtiError {
    fn from(_: DecompositionError) -> Self {
        LtiError::NoConvergence
    }
}

impl LtiError {
    /// The error of a matrix or table of other dimensions than expected.
    #[must_use]
    pub fn shape(what: &'static str, expected: impl Into<Dimensions>, got: impl Into<Dimensions>) -> Self {
        LtiError::Shape { what, expected: expected.into(), got: got.into() }
    }
}

pub(crate) fn check_sample_time(sample_time_s: f64) -> Result<(), LtiError> {
    if sample_time_s.is_finite() && sample_time_s > 0.0 { Ok(()) } else { Err(LtiError::SampleTime { sample_time_s }) }
}

pub(crate) fn check_delay(delay_s: f64) -> Result<(), LtiError> {
    if delay_s.is_finite() && delay_s >= 0.0 { Ok(()) } else { Err(LtiError::Delay { delay_s }) }
}

pub(crate) fn check_shape(what: &'static str, expected: (usize, usize), got: (usize, usize)) -> Result<(), LtiError> {
    if expected == got { Ok(()) } else { Err(LtiError::shape(what, expected, got)) }
}

pub(crate) fn check_finite(what: &'static str, mut values: impl Iterator<Item = f64>) -> Result<(), LtiError> {
    if values.all(f64::is_finite) { Ok(()) } else { Err(LtiError::NonFinite { what }) }
}

fn clock(sample_time_s: Option<f64>) -> String {
    sample_time_s.map_or_else(|| "continuous time".to_owned(), |time_s| format!("{time_s} s"))
}

pub(crate) fn check_state(x0: &[f64], states: usize) -> Result<(), LtiError> {
    check_shape("initial state", (states, 1), (x0.len(), 1))?;
    check_finite("initial state", x0.iter().copied())
}
