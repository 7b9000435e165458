//! Speed controller, torque control and shaft of a campaign: each chosen by one rule, and estimated from a recording at
//! most once, whoever asks.

use std::sync::{Arc, OnceLock};

use crate::shaft::{self, NoisyTorque, ShaftInputs, Wanted};
use crate::shaft_inputs::{both_inertias, shaft_inputs, shaft_torque};
use part_controller::SpeedControllers;
use part_torque::TorqueControls;
use rig::estimation::{Chosen, EstimateError, OncePerRecording, first, once};
use rig::experiment::Sought;
use rig::facts::BenchVariant;
use rig::results::{Estimate, Reason, Shaft};
use rig::{BenchFile, Experiment};

/// The parts of a bench that are estimated from single recordings.
#[derive(Debug)]
pub struct Parts<'a> {
    /// The recordings.
    pub experiments: Vec<&'a Experiment>,
    /// The bench.
    pub bench: &'a BenchFile,
    /// Speed controller and feed-forward.
    pub controllers: SpeedControllers<'a>,
    /// Torque control.
    pub torque_controls: TorqueControls<'a>,
    shafts: ShaftEstimates<'a>,
    chosen: OnceLock<Result<Chosen<'a, Shaft>, Vec<Reason>>>,
}

/// Estimates of the shaft beside one controller and one torque control.
#[derive(Debug)]
struct ShaftEstimates<'a> {
    torques: OncePerRecording<'a, Vec<NoisyTorque>>,
    judged: OncePerRecording<'a, Shaft>,
    whole: OncePerRecording<'a, Estimate>,
    inertias: OncePerRecording<'a, Estimate>,
}

impl<'a> ShaftEstimates<'a> {
    fn of(experiments: &[&'a Experiment]) -> Self {
        ShaftEstimates {
            torques: OncePerRecording::new(experiments),
            judged: OncePerRecording::new(experiments),
            whole: OncePerRecording::new(experiments),
            inertias: OncePerRecording::new(experiments),
        }
    }

    fn with<'b>(&self, further: &'b Experiment) -> ShaftEstimates<'b>
    where
        'a: 'b,
    {
        ShaftEstimates {
            torques: self.torques.with(further),
            judged: self.judged.with(further),
            whole: self.whole.with(further),
            inertias: self.inertias.with(further),
        }
    }
}

impl<'a> Parts<'a> {
    /// Of these recordings of a bench.
    pub fn of(experiments: &[&'a Experiment], bench: &'a BenchFile) -> Self {
        let limit = bench.limits.torque_nm;
        Parts {
            experiments: experiments.to_vec(),
            bench,
            controllers: SpeedControllers::of(experiments, limit),
            torque_controls: TorqueControls::of(experiments, limit),
            shafts: ShaftEstimates::of(experiments),
            chosen: OnceLock::new(),
        }
    }

    /// With a further recording: what it leaves as it was is not estimated again.
    #[must_use]
    pub fn with<'b>(&self, further: &'b Experiment) -> Parts<'b>
    where
        'a: 'b,
    {
        let experiments: Vec<&'b Experiment> = self.experiments.iter().copied().chain([further]).collect();
        let (controllers, torque_controls) = (self.controllers.with(further), self.torque_controls.with(further));
        let same_controller = is_same(self.controllers.chosen(), controllers.chosen());
        let same_torque_control = is_same(self.torque_controls.chosen(), torque_controls.chosen());
        let shafts = match same_controller && same_torque_control {
            true => self.shafts.with(further),
            false => ShaftEstimates::of(&experiments),
        };
        Parts { experiments, bench: self.bench, controllers, torque_controls, shafts, chosen: OnceLock::new() }
    }

    /// Inputs of the shaft's estimate from a recording, beside the chosen speed controller and torque control.
    ///
    /// # Errors
    /// A signal that is missing.
    pub fn shaft_inputs<'e>(&self, experiment: &'e Experiment) -> Result<ShaftInputs<'e>, EstimateError> {
        let torque = self
            .shafts
            .torques
            .get(experiment, || shaft_torque(experiment, self.bench, self.torque_controls.between_samples()))?;
        let torque_control = self.torque_controls.between_samples();
        shaft_inputs(experiment, self.bench, self.controllers.best(), torque.as_ref().clone(), torque_control)
    }

    /// The shaft from the first part of a recording, judged on the rest.
    ///
    /// # Errors
    /// Those of [`shaft::estimate`].
    pub fn shaft(&self, experiment: &Experiment) -> Result<Arc<Shaft>, EstimateError> {
        self.shafts.judged.get(experiment, || shaft::estimate(&self.shaft_inputs(experiment)?))
    }

    /// The shaft's parameters from the whole of a recording, to compare recordings with one another.
    ///
    /// # Errors
    /// Those of [`shaft::fit`].
    pub fn shaft_of_whole(&self, experiment: &Experiment) -> Result<Arc<Estimate>, EstimateError> {
        self.shafts.whole.get(experiment, || Ok(shaft::fit(&self.shaft_inputs(experiment)?, Wanted::Shaft)?.estimate))
    }

    /// The shaft from the recording that is chosen for it.
    ///
    /// # Errors
    /// The recordings that would be needed.
    pub fn chosen_shaft(&self) -> Result<&Chosen<'a, Shaft>, &Vec<Reason>> {
        once(&self.chosen, || first(Sought::Shaft, &self.experiments, |e| self.shaft(e))).as_ref()
    }

    /// Tells whether a recording gives both inertias: behind a torque flange stands a dual-mass flywheel, with which
    /// there is no one J_e.
    pub fn gives_inertias(&self, experiment: &Experiment) -> bool {
        self.bench.variant == BenchVariant::LoadCell && Sought::Inertias.is_given_by(experiment)
    }

    /// Both inertias from a recording, as if nothing were known of them.
    ///
    /// # Errors
    /// Those of [`shaft::fit`].
    pub fn inertias(&self, experiment: &Experiment) -> Result<Arc<Estimate>, EstimateError> {
        let estimate = || both_inertias(experiment, &self.shaft_inputs(experiment)?, self.bench);
        self.shafts.inertias.get(experiment, estimate)
    }

    /// Both inertias from the recording that is chosen for them.
    ///
    /// # Errors
    /// The recordings that would be needed.
    pub fn chosen_inertias(&self) -> Result<Chosen<'a, Estimate>, Vec<Reason>> {
        let giving: Vec<&Experiment> = self.experiments.iter().copied().filter(|e| self.gives_inertias(e)).collect();
        first(Sought::Inertias, &giving, |e| self.inertias(e))
    }
}

fn is_same<T>(one: Result<&Chosen<'_, T>, &Vec<Reason>>, other: Result<&Chosen<'_, T>, &Vec<Reason>>) -> bool {
    match (one, other) {
        (Ok(one), Ok(other)) => Arc::ptr_eq(&one.fit, &other.fit),
        (one, other) => one.is_err() && other.is_err(),
    }
}
