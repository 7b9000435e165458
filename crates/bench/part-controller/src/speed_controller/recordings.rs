//! The speed controller of a campaign: from each recording at most once.

use std::sync::{Arc, OnceLock};

use rig::estimation::{Chosen, EstimateError, OncePerRecording, first, once};
use rig::experiment::{Experiment, Sought};
use rig::results::{Estimate, FeedForward, Part, Reason};

use super::feed_forward::MovingDemand;
use super::fit::{SpeedControllerFit, estimate};

/// The speed controller as recordings give it.
#[derive(Debug)]
pub struct SpeedControllers<'a> {
    /// The recordings.
    pub experiments: Vec<&'a Experiment>,
    /// Torque that the inverter gives, Nm.
    pub torque_limit_nm: Option<f64>,
    fits: OncePerRecording<'a, SpeedControllerFit>,
    moving: OncePerRecording<'a, MovingDemand>,
    chosen: OnceLock<Result<Chosen<'a, SpeedControllerFit>, Vec<Reason>>>,
}

impl<'a> SpeedControllers<'a> {
    /// Of these recordings, on a bench whose inverter gives so much torque.
    pub fn of(experiments: &[&'a Experiment], torque_limit_nm: Option<f64>) -> Self {
        SpeedControllers {
            experiments: experiments.to_vec(),
            torque_limit_nm,
            fits: OncePerRecording::new(experiments),
            moving: OncePerRecording::new(experiments),
            chosen: OnceLock::new(),
        }
    }

    /// With a further recording.
    #[must_use]
    pub fn with<'b>(&self, further: &'b Experiment) -> SpeedControllers<'b>
    where
        'a: 'b,
    {
        let experiments: Vec<&'b Experiment> = self.experiments.iter().copied().chain([further]).collect();
        let mut all = SpeedControllers {
            fits: self.fits.with(further),
            ..SpeedControllers::of(&experiments, self.torque_limit_nm)
        };
        let same_judges = !Sought::FeedForward.is_given_by(further);
        if same_judges && self.is_chosen_in(&all) {
            all.moving = self.moving.with(further);
        }
        all
    }

    fn is_chosen_in(&self, all: &SpeedControllers<'_>) -> bool {
        match (self.chosen(), all.chosen()) {
            (Ok(own), Ok(other)) => Arc::ptr_eq(&own.fit, &other.fit),
            (own, other) => own.is_err() && other.is_err(),
        }
    }

    /// PI and delay from one recording.
    ///
    /// # Errors
    /// Those of [`estimate`].
    pub fn fit(&self, experiment: &Experiment) -> Result<Arc<SpeedControllerFit>, EstimateError> {
        self.fits.get(experiment, || estimate(experiment, self.torque_limit_nm))
    }

    /// PI and delay from the recording that is chosen for them.
    ///
    /// # Errors
    /// The recordings that would be needed.
    pub fn chosen(&self) -> Result<&Chosen<'a, SpeedControllerFit>, &Vec<Reason>> {
        once(&self.chosen, || first(Sought::SpeedController, &self.experiments, |e| self.fit(e))).as_ref()
    }

    /// The chosen controller, if there is one.
    pub fn best(&self) -> Option<&SpeedControllerFit> {
        self.chosen().ok().map(|chosen| chosen.fit.as_ref())
    }

    /// The feed-forward from one recording beside the chosen controller, judged by the best of the others.
    ///
    /// # Errors
    /// Those of [`estimate_feed_forward`](super::estimate_feed_forward).
    pub fn feed_forward(
        &self,
        experiment: &Experiment,
        controller: &SpeedControllerFit,
    ) -> Result<Arc<FeedForward>, EstimateError> {
        self.moving_demand(experiment, controller)?.feed_forward.clone().map(Arc::new)
    }

    /// K_p and K_i as a recording in which N_d* moves gives them beside a feed-forward. They may contradict those of
    /// the chosen controller.
    ///
    /// # Errors
    /// Those of [`estimate_feed_forward`](super::estimate_feed_forward), but for contradictions.
    pub fn gains(&self, experiment: &Experiment, controller: &SpeedControllerFit) -> Result<Estimate, EstimateError> {
        Ok(self.moving_demand(experiment, controller)?.gains.clone())
    }

    fn moving_demand(
        &self,
        experiment: &Experiment,
        controller: &SpeedControllerFit,
    ) -> Result<Arc<MovingDemand>, EstimateError> {
        self.moving.get(experiment, || {
            let others = Sought::FeedForward.candidates(&self.experiments);
            let judge = others.into_iter().find(|other| other.file != experiment.file);
            MovingDemand::of(experiment, judge, controller, self.torque_limit_nm)
        })
    }

    /// The feed-forward from the recording that is chosen for it.
    ///
    /// # Errors
    /// The recordings that would be needed.
    pub fn chosen_feed_forward(&self) -> Result<Chosen<'a, FeedForward>, Vec<Reason>> {
        let controller = self.best().ok_or_else(|| vec![Reason::Part { part: Part::SpeedController }])?;
        first(Sought::FeedForward, &self.experiments, |e| self.feed_forward(e, controller))
    }
}
