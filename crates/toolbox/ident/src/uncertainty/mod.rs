//! How certain an estimate is, and whatever is computed from it: functions of the parameters, poles and zeros,
//! frequency and time responses, sampled models, tests between estimates.

mod bands;
mod charts;
mod dynamics;
mod features;
mod hypothesis;
mod modes;
mod robust;
mod roots;
mod sample;

pub use bands::{FrequencyBand, TimeBand};
pub use charts::{BodeChart, StepChart};
pub use dynamics::{Dynamics, Ratio};
pub use features::{Feature, Features, Resonance, StepFeatures};
pub use hypothesis::{RatioTest, agreement, nested};
pub use modes::UncertainMode;
pub use roots::{Ellipse, UncertainRoot};
pub use sample::{Sample, Samples};

use faer::Mat;
use lti::LtiError;

use crate::dense::covariance_root;
use crate::distributions::interval;
use crate::{Fit, IdentError, Parametric};

/// Part of a standard deviation by which parameters are moved for a derivative: large against rounding, small against
/// the distance over which a linear approximation has to hold anyway.
const STEP: f64 = 1e-2;

/// A function of the parameters with its uncertainty, to first order.
#[derive(Debug, Clone, PartialEq)]
pub struct Derived {
    /// The values at the estimate.
    pub values: Vec<f64>,
    /// `F` with `Cov = F Fᵀ`, values × directions: small where the values are many.
    pub factor: Mat<f64>,
    /// Degrees of freedom of Student's t for intervals.
    pub degrees_of_freedom: f64,
}

impl Derived {
    /// The covariance of the values.
    #[must_use]
    pub fn covariance(&self) -> Mat<f64> {
        &self.factor * self.factor.transpose()
    }

    /// Standard error of each value.
    #[must_use]
    pub fn standard_errors(&self) -> Vec<f64> {
        (0..self.values.len()).map(|i| self.factor.row(i).norm_l2()).collect()
    }

    /// The interval that holds each value with probability `level`, by Student's t.
    #[must_use]
    pub fn intervals(&self, level: f64) -> Vec<(f64, f64)> {
        let pairs = self.values.iter().zip(self.standard_errors());
        pairs.map(|(value, error)| interval(*value, error, self.degrees_of_freedom, level)).collect()
    }

    /// Covariance of two of the values.
    fn covariance_of(&self, i: usize, j: usize) -> f64 {
        (0..self.factor.ncols()).map(|k| self.factor[(i, k)] * self.factor[(j, k)]).sum()
    }
}

impl<M: Parametric> Fit<M> {
    /// A function of the model with its covariance by the delta method, `Cov g(θ̂) = g′ P g′ᵀ`.
    ///
    /// Derivatives are central differences along the principal directions of the covariance (parameters in units of
    /// their deviations), never along single parameters: those may be far more uncertain than anything that follows
    /// from them.
    ///
    /// # Errors
    /// Those of `function`, also where it fails within a hundredth of a standard deviation of the estimate;
    /// [`IdentError::Length`] where it changes its number of values; [`IdentError::NotFinite`].
    ///
    /// # Source
    /// Ljung 1999, §9.6 and appendix II.
    pub fn derive(&self, function: impl Fn(&M) -> Result<Vec<f64>, LtiError>) -> Result<Derived, IdentError> {
        let values = function(&self.model)?;
        let factor = self.differentiate(&function)?;
        let finite = |i: usize| values[i].is_finite() && (0..factor.ncols()).all(|k| factor[(i, k)].is_finite());
        if let Some(index) = (0..values.len()).find(|i| !finite(*i)) {
            return Err(IdentError::NotFinite { what: "a function of the parameters", index });
        }
        Ok(Derived { values, factor, degrees_of_freedom: self.degrees_of_freedom })
    }

    /// The derivative of a function along each column of the root of the covariance.
    fn differentiate(&self, function: impl Fn(&M) -> Result<Vec<f64>, LtiError>) -> Result<Mat<f64>, IdentError> {
        let theta = self.parameters();
        let found = self.covariance.nrows();
        if theta.len() != found {
            return Err(IdentError::Length { what: "the covariance", expected: theta.len(), found });
        }
        let root = covariance_root::root(&self.covariance)?;
        let length = function(&self.model)?.len();
        let mut factor = Mat::zeros(length, root.ncols());
        for k in 0..root.ncols() {
            let at = |h: f64| {
                let moved: Vec<f64> = theta.iter().enumerate().map(|(i, v)| v + h * root[(i, k)]).collect();
                function(&self.model.with_parameters(&moved)?)
            };
            let (above, below) = (at(STEP)?, at(-STEP)?);
            for found in [above.len(), below.len()] {
                if found != length {
                    return Err(IdentError::Length { what: "values of a function", expected: length, found });
                }
            }
            for i in 0..length {
                factor[(i, k)] = (above[i] - below[i]) / (2.0 * STEP);
            }
        }
        Ok(factor)
    }
}
