//! Templates of experiments and their parameters.

use super::error::CatalogueError;
use super::parameter::DURATION;
use super::parameter::Parameter;
use super::parameter::SETTLING;
use super::parameter::SPEED;
use super::settings::Settings;
use crate::experiment::{ControlMode, Excitation, ExperimentLabel, ExperimentPlan, Test};

/// An experiment of the method, of which a plan is made by giving it numbers.
#[derive(Debug, Clone)]
pub struct Template {
    /// Test that is done, first part of the label.
    pub test: Test,
    /// Quantity that is excited.
    pub excitation: Excitation,
    /// Who controls what.
    pub mode: ControlMode,
    /// Demands, in words.
    pub demands: &'static str,
    /// Results of a recording of it.
    pub gives: &'static str,
    pub(super) duration_s: f64,
    pub(super) own: &'static [Parameter],
    pub(super) build: fn(&Settings) -> Result<ExperimentPlan, CatalogueError>,
}

impl Template {
    /// The label of its recordings.
    pub fn label(&self) -> ExperimentLabel {
        ExperimentLabel { test: self.test.clone(), excitation: self.excitation, mode: self.mode }
    }

    /// Its parameters: those of every experiment first.
    pub fn parameters(&self) -> Vec<Parameter> {
        let duration = Parameter { default: self.duration_s, ..DURATION };
        [SPEED, duration, SETTLING].into_iter().chain(self.own.iter().copied()).collect()
    }

    /// The plan with these numbers.
    ///
    /// # Errors
    /// Numbers that contradict each other, or a plan that cannot be.
    pub fn plan(&self, settings: &Settings) -> Result<ExperimentPlan, CatalogueError> {
        let mut plan = (self.build)(settings)?;
        plan.settling_s = settings.get("settling");
        plan.check()?;
        Ok(plan)
    }
}
