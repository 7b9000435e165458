//! The torque control of a campaign: from each recording at most once.

use std::sync::{Arc, OnceLock};

use crate::torque_control::{TorqueControlFit, estimate, estimate_unseparated};
use rig::estimation::{Chosen, EstimateError, OncePerRecording, first, once};
use rig::experiment::{Experiment, Sought};
use rig::prepare::believable;
use rig::results::Reason;

/// The torque control as recordings give it.
#[derive(Debug)]
pub struct TorqueControls<'a> {
    /// The recordings.
    pub experiments: Vec<&'a Experiment>,
    /// Torque that the inverter gives, Nm.
    pub torque_limit_nm: Option<f64>,
    fits: OncePerRecording<'a, TorqueControlFit>,
    chosen: OnceLock<Result<Chosen<'a, TorqueControlFit>, Vec<Reason>>>,
    unseparated: OnceLock<Option<Arc<TorqueControlFit>>>,
}

impl<'a> TorqueControls<'a> {
    /// Of these recordings, on a bench whose inverter gives so much torque.
    pub fn of(experiments: &[&'a Experiment], torque_limit_nm: Option<f64>) -> Self {
        TorqueControls {
            experiments: experiments.to_vec(),
            torque_limit_nm,
            fits: OncePerRecording::new(experiments),
            chosen: OnceLock::new(),
            unseparated: OnceLock::new(),
        }
    }

    /// With a further recording.
    #[must_use]
    pub fn with<'b>(&self, further: &'b Experiment) -> TorqueControls<'b>
    where
        'a: 'b,
    {
        let experiments: Vec<&'b Experiment> = self.experiments.iter().copied().chain([further]).collect();
        TorqueControls { fits: self.fits.with(further), ..TorqueControls::of(&experiments, self.torque_limit_nm) }
    }

    /// The torque control from one recording.
    ///
    /// # Errors
    /// Those of [`estimate`], and a T_d,calc of the wrong sign.
    pub fn fit(&self, experiment: &Experiment) -> Result<Arc<TorqueControlFit>, EstimateError> {
        self.fits.get(experiment, || {
            believable(experiment)?;
            estimate(experiment, self.torque_limit_nm)
        })
    }

    /// The torque control from the recording that is chosen for it.
    ///
    /// # Errors
    /// The recordings that would be needed.
    pub fn chosen(&self) -> Result<&Chosen<'a, TorqueControlFit>, &Vec<Reason>> {
        once(&self.chosen, || first(Sought::TorqueControl, &self.experiments, |e| self.fit(e))).as_ref()
    }

    /// [`TorqueControls::fit`], also where delay and lag cannot be separated: the model is then right at the samples
    /// alone.
    ///
    /// # Errors
    /// Those of [`TorqueControls::fit`], but for delay and lag that cannot be separated.
    pub fn fit_unseparated(&self, experiment: &Experiment) -> Result<Arc<TorqueControlFit>, EstimateError> {
        self.fit(experiment).or_else(|error| match error {
            EstimateError::Inseparable { .. } => {
                estimate_unseparated(experiment, self.torque_limit_nm).map(|(fit, _)| Arc::new(fit))
            }
            other => Err(other),
        })
    }

    /// Torque control that gives T_d between the samples of T_d,calc: the chosen one, or one whose delay and lag the
    /// recordings cannot separate.
    pub fn between_samples(&self) -> Option<&TorqueControlFit> {
        let unseparated = || {
            let candidates = Sought::TorqueControl.candidates(&self.experiments);
            candidates.into_iter().find_map(|e| self.fit_unseparated(e).ok())
        };
        self.best().or_else(|| self.unseparated.get_or_init(unseparated).as_deref())
    }

    /// The chosen torque control, if there is one.
    pub fn best(&self) -> Option<&TorqueControlFit> {
        self.chosen().ok().map(|chosen| chosen.fit.as_ref())
    }
}
