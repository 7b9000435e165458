//! The parts that the recordings allow, each from the recording that is chosen for it.

use numerics::parallel::join;
use part_controller::speed_controller::SpeedControllerFit;
use part_shaft::Parts;
use part_torque::torque_control::TorqueControlFit;
use rig::experiment::Choice;
use rig::facts::BenchVariant;
use rig::results::{FeedForward, Parameter, Quantity, Reason, Shaft};
use work::Context;

use crate::whole::Pieces;

/// The parts that the recordings allow.
pub(super) struct Fits {
    pub(super) controller: Result<SpeedControllerFit, Vec<Reason>>,
    pub(super) feed_forward: Result<FeedForward, Vec<Reason>>,
    /// Its delays are without the skew of T_d,calc, where the shaft shows one.
    pub(super) torque_control: Result<TorqueControlFit, Vec<Reason>>,
    /// The same with that skew.
    pub(super) torque_control_as_recorded: Option<TorqueControlFit>,
    pub(super) shaft: Result<Shaft, Vec<Reason>>,
    /// From which recording each is, and why.
    pub(super) choices: Vec<Choice>,
}

impl Fits {
    /// Estimates them, each as a part of a step of the work.
    pub(super) fn of(parts: &Parts<'_>, context: &Context) -> Self {
        let step = context.step("estimating", 4);
        let part = |what: &str| step.step(format!("estimating: {what}"), 0);
        let (controllers, torque_controls) = (&parts.controllers, &parts.torque_controls);
        let (controller, torque_control) = join(
            || (part("speed control"), controllers.chosen()).1,
            || (part("torque control"), torque_controls.chosen()).1,
        );
        let (feed_forward, (shaft, inertias)) = join(
            || (part("feed-forward"), controllers.chosen_feed_forward()).1,
            || (part("shaft"), join(|| parts.chosen_shaft(), || parts.chosen_inertias().ok())).1,
        );
        let choices = [
            controller.ok().map(|chosen| &chosen.choice),
            feed_forward.as_ref().ok().map(|chosen| &chosen.choice),
            torque_control.ok().map(|chosen| &chosen.choice),
            shaft.ok().map(|chosen| &chosen.choice),
            inertias.as_ref().map(|chosen| &chosen.choice),
        ];
        let choices = choices.into_iter().flatten().cloned().collect();
        let shaft_estimate = shaft.ok().map(|chosen| &chosen.fit.estimate);
        let torque_skew = shaft_estimate.and_then(|estimate| estimate.parameter(Quantity::AirGapTorqueSkew));
        let torque_skew = torque_skew.filter(|_| parts.bench.variant == BenchVariant::LoadCell);
        let inertias = inertias.map(|both| (both.experiment.file.clone(), both.fit.as_ref().clone()));
        Fits {
            choices,
            controller: controller.map(|chosen| chosen.fit.as_ref().clone()).map_err(Clone::clone),
            feed_forward: feed_forward.map(|chosen| chosen.fit.as_ref().clone()),
            torque_control_as_recorded: torque_control.ok().map(|chosen| chosen.fit.as_ref().clone()),
            torque_control: torque_control.map(|chosen| without_skew(&chosen.fit, torque_skew)).map_err(Clone::clone),
            shaft: shaft.map(|chosen| Shaft { inertias, ..chosen.fit.as_ref().clone() }).map_err(Clone::clone),
        }
    }

    /// Parts that a model is made of; none without a shaft.
    pub(super) fn pieces(&self) -> Option<Pieces<'_>> {
        Some(Pieces {
            shaft: self.shaft.as_ref().ok()?,
            controller: self.controller.as_ref().ok(),
            feed_forward: self.feed_forward.as_ref().ok(),
            torque_control: self.torque_control.as_ref().ok(),
        })
    }
}

/// The torque control on the clock of N_d. On a bench with a load cell, the shaft's estimate dates T_d,calc, which is
/// its torque.
fn without_skew(fit: &TorqueControlFit, torque_skew: Option<&Parameter>) -> TorqueControlFit {
    let recorded = fit.clone();
    match torque_skew {
        Some(skew) => TorqueControlFit { result: recorded.result.without_skew(skew), ..recorded },
        None => recorded,
    }
}
