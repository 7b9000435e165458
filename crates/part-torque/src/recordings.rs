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
    /// What the inverter gives, Nm.
    pub torque_limit_nm: Option<f64>,
    fits: OncePerRecording<'a, TorqueControlFit>,
    chosen: OnceLock<Result<Chosen<'a, TorqueControlFit>, Vec<Reason>>>,
    unseparated: OnceLock<Option<TorqueControlFit>>,
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
    /// What would be needed.
    pub fn chosen(&self) -> Result<&Chosen<'a, TorqueControlFit>, &Vec<Reason>> {
        once(&self.chosen, || first(Sought::TorqueControl, &self.experiments, |e| self.fit(e))).as_ref()
    }

    /// What gives T_d between the samples of T_d,calc: the chosen torque control, or one whose delay and lag the recordings cannot
    /// separate.
    pub fn between_samples(&self) -> Option<&TorqueControlFit> {
        let unseparated = || {
            let candidates = Sought::TorqueControl.candidates(&self.experiments);
            candidates.into_iter().find_map(|e| Some(estimate_unseparated(e, self.torque_limit_nm).ok()?.0))
        };
        self.best().or_else(|| self.unseparated.get_or_init(unseparated).as_ref())
    }

    /// The chosen torque control, if there is one.
    pub fn best(&self) -> Option<&TorqueControlFit> {
        self.chosen().ok().map(|chosen| chosen.fit.as_ref())
    }
}
