//! From one clock to another.

use faer::Mat;
use ident::{LinearModel, ModelDocument};
use lti::{Discretisation, LtiError, StateSpace, TransferFunction};

/// The form of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Numerator and denominator.
    Ratio,
    /// Zeros, poles and gain.
    ZerosAndPoles,
    /// State space.
    StateSpace,
}

/// Form and clock that a model is to get.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conversion {
    /// Its form.
    pub form: Form,
    /// Its sample time, where it is to be another.
    pub sample_time_s: Option<f64>,
    /// True if it is to be continuous.
    pub continuous: bool,
    /// The rule between continuous and discrete.
    pub rule: Discretisation,
}

impl Conversion {
    /// Returns true if the model keeps its own clock.
    pub(super) fn keeps_clock(&self) -> bool {
        self.sample_time_s.is_none() && !self.continuous
    }
}

pub(super) fn resampled(system: StateSpace, asked: &Conversion) -> Result<StateSpace, LtiError> {
    let method = asked.rule;
    match (asked.sample_time_s, system.sample_time_s()) {
        (Some(t), None) => system.to_discrete(method, t),
        (Some(t), Some(_)) => system.resampled(method, t),
        (None, Some(_)) if asked.continuous => system.to_continuous(method),
        (None, _) => Ok(system),
    }
}

pub(super) fn resampled_ratio(h: TransferFunction, asked: &Conversion) -> Result<TransferFunction, LtiError> {
    let method = asked.rule;
    match (asked.sample_time_s, h.sample_time_s()) {
        (Some(t), None) => h.to_discrete(method, t),
        (Some(t), Some(_)) => h.resampled(method, t),
        (None, Some(_)) if asked.continuous => h.to_continuous(method),
        (None, _) => Ok(h),
    }
}

pub(super) fn clock_words(sample_time_s: Option<f64>) -> String {
    sample_time_s.map_or("continuous".to_owned(), |t| format!("every {t} s"))
}

/// The covariance of the source's innovations.
pub(super) fn noise_covariance(source: &ModelDocument) -> Result<Mat<f64>, LtiError> {
    Ok(source.model.innovations(source.sample_time_s, source.intersample)?.noise_covariance().to_owned())
}
