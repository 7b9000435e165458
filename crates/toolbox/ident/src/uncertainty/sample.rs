//! Models drawn from the distribution of an estimate.

use signal::excitation::Random;

use super::Dynamics;
use crate::dense::covariance_root;
use crate::{Fit, IdentError, Parametric};

/// One model drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Sample<M> {
    /// The model.
    pub model: M,
    /// True if it is stable.
    pub stable: bool,
}

/// Models drawn from the distribution of an estimate.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples<M> {
    /// The models, stable or not.
    pub models: Vec<Sample<M>>,
    /// Draws at which the structure has no model; where there are many, the distribution is not normal in these
    /// parameters.
    pub refused: usize,
}

impl<M: Parametric + Dynamics> Fit<M> {
    /// Draws `count` models whose parameters are normal about the estimate with its covariance, which may be singular.
    ///
    /// # Errors
    /// [`IdentError::Length`], [`IdentError::NotFinite`] for an unusable covariance; the eigenvalues of a model drawn.
    pub fn sample(&self, count: usize, random: &mut Random) -> Result<Samples<M>, IdentError> {
        let theta = self.parameters();
        let found = self.covariance.nrows();
        if theta.len() != found {
            return Err(IdentError::Length { what: "the covariance", expected: theta.len(), found });
        }
        let root = covariance_root::root(&self.covariance)?;
        let mut samples = Samples { models: Vec::with_capacity(count), refused: 0 };
        for _ in 0..count {
            work::checkpoint();
            let normal: Vec<f64> = (0..root.ncols()).map(|_| random.normal()).collect();
            let offset = |i: usize| normal.iter().enumerate().map(|(k, v)| root[(i, k)] * v).sum::<f64>();
            let drawn: Vec<f64> = theta.iter().enumerate().map(|(i, v)| v + offset(i)).collect();
            match self.model.with_parameters(&drawn) {
                Err(_) => samples.refused += 1,
                Ok(model) => {
                    let stable = model.system()?.is_stable()?;
                    samples.models.push(Sample { model, stable });
                }
            }
        }
        Ok(samples)
    }
}
