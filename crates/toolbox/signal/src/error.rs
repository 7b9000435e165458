//! The one error type of the crate.

/// Why an operation on a signal cannot proceed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SignalError {
    /// Fewer samples than the operation needs.
    #[error("{got} samples, at least {needed} are needed")]
    TooShort {
        /// The smallest number of samples that would do.
        needed: usize,
        /// The number of samples given.
        got: usize,
    },
    /// Two series that must be equally long are not.
    #[error("length {got}, expected {expected}")]
    LengthMismatch {
        /// The length that was expected.
        expected: usize,
        /// The length given.
        got: usize,
    },
    /// A sample, instant or frequency is NaN or infinite.
    #[error("not a finite number at index {index}")]
    NonFinite {
        /// Index of the first such value.
        index: usize,
    },
    /// The sample time is not a positive finite number.
    #[error("sample time {sample_time_s} s is not a positive finite number")]
    SampleTime {
        /// The value given.
        sample_time_s: f64,
    },
    /// A parameter lies outside its range.
    #[error("{name} = {value} is outside {low} ..= {high}")]
    Parameter {
        /// The parameter's name in the function's signature or options.
        name: &'static str,
        /// The value given.
        value: f64,
        /// Smallest value allowed.
        low: f64,
        /// Largest value allowed.
        high: f64,
    },
    /// A filter's cut-off is not strictly between zero and half the sample rate, or a band's edges are not ascending.
    #[error("cut-off {cutoff_hz} Hz is not strictly between {low_hz} Hz and {high_hz} Hz")]
    Cutoff {
        /// The cut-off given.
        cutoff_hz: f64,
        /// The open lower bound.
        low_hz: f64,
        /// The open upper bound.
        high_hz: f64,
    },
    /// A filter section has a pole on or outside the unit circle, or a leading denominator coefficient of zero.
    #[error("filter section {section} is not stable")]
    UnstableSection {
        /// Index of the section.
        section: usize,
    },
    /// An instant lies outside the recorded time.
    #[error("instant {time_s} s is outside the record, {start_s} s to {end_s} s")]
    OutsideRecord {
        /// The instant asked for.
        time_s: f64,
        /// Instant of the first sample.
        start_s: f64,
        /// Instant of the last sample.
        end_s: f64,
    },
    /// The signal does not vary, so a normalised quantity does not exist.
    #[error("the signal is constant")]
    Constant,
    /// The Fourier transform refused its input.
    #[error("Fourier transform of {length} points failed")]
    Transform {
        /// Number of points.
        length: usize,
    },
    /// An even number of taps, where the filter asked for has a middle one.
    #[error("{taps} taps, an odd number is needed")]
    EvenTaps {
        /// The number of taps given.
        taps: usize,
    },
    /// The inputs do not repeat after the period given.
    #[error("the inputs do not repeat after {period} samples")]
    NotRepeated {
        /// The period in samples.
        period: usize,
    },
    /// The excitation is too weak or one input is a combination of the others: equations cannot be solved.
    #[error("the inputs do not excite the system independently at {freq_hz} Hz")]
    NotExcited {
        /// The first frequency where that is so.
        freq_hz: f64,
    },
}

pub(crate) fn check_finite(x: &[f64]) -> Result<(), SignalError> {
    match x.iter().position(|v| !v.is_finite()) {
        Some(index) => Err(SignalError::NonFinite { index }),
        None => Ok(()),
    }
}

pub(crate) fn check_sample_time(sample_time_s: f64) -> Result<(), SignalError> {
    if sample_time_s.is_finite() && sample_time_s > 0.0 {
        Ok(())
    } else {
        Err(SignalError::SampleTime { sample_time_s })
    }
}

pub(crate) fn check_same_length(expected: usize, got: usize) -> Result<(), SignalError> {
    if expected == got { Ok(()) } else { Err(SignalError::LengthMismatch { expected, got }) }
}

pub(crate) fn check_at_least(needed: usize, got: usize) -> Result<(), SignalError> {
    if got >= needed { Ok(()) } else { Err(SignalError::TooShort { needed, got }) }
}

/// Checks `low <= value <= high`; NaN fails.
pub(crate) fn check_range(name: &'static str, value: f64, low: f64, high: f64) -> Result<(), SignalError> {
    if value >= low && value <= high { Ok(()) } else { Err(SignalError::Parameter { name, value, low, high }) }
}
