//! The dynamometer's speed controller, as recordings show it: PI without and with delay side by side, its discrete
//! form, what may be added to it, the limit of T_d*, and the feed-forward (thesis §6.3.1).

use numerics::parallel;
use rig::experiment::Sought;
use rig::results::{Estimate, FeedForward, Outcome, Validation, read_found, write_found};
use rig::{ControlMode, Excitation, Experiment, ExperimentLabel};
use serde::{Deserialize, Serialize};
use work::Context;

use super::discrete::Discrete;
use super::fit::SpeedControllerFit;
use super::limit::{Limit, limit};
use super::recordings::SpeedControllers;
use super::terms::{FeedForwardTerms, Structure, feed_forward_terms, structure};

/// Findings of recordings on the speed controller.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SpeedControl {
    /// PI and delay, one entry a recording with constant N_d*, the longest first.
    pub controllers: Vec<ControllerRecording>,
    /// Feed-forward, one entry a recording in which N_d* moves, the longest first.
    pub feed_forward: Vec<FeedForwardRecording>,
    /// The limit of T_d*, one entry a recording in speed control; empty without a controller.
    pub limits: Vec<LimitRecording>,
}

/// Findings of one recording with constant N_d*.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ControllerRecording {
    /// The file.
    pub file: String,
    /// The experiment's label.
    pub label: ExperimentLabel,
    /// The controller.
    #[serde(serialize_with = "write_found", deserialize_with = "read_found")]
    pub found: Outcome<Box<Controller>>,
}

/// PI without and with delay.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Controller {
    /// K_p, K_i, τ, I_0 and, where the data show it, the encoder's gate T_g.
    pub with_delay: Estimate,
    /// K_p, K_i, I_0 of PI alone, from the same stretch.
    pub without_delay: Estimate,
    /// The former on the held-out stretch.
    pub validation: Validation,
    /// The latter on the same stretch.
    pub validation_without_delay: Validation,
    /// The same as the controller computes it.
    pub discrete: Discrete,
    /// Terms that may be added to PI and delay.
    #[serde(serialize_with = "write_found", deserialize_with = "read_found")]
    pub structure: Outcome<Structure>,
}

/// Findings of one recording with moving N_d*.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FeedForwardRecording {
    /// The file.
    pub file: String,
    /// The experiment's label.
    pub label: ExperimentLabel,
    /// k and k_a, and whether there is more.
    #[serde(serialize_with = "write_found", deserialize_with = "read_found")]
    pub found: Outcome<Box<FeedForwardFound>>,
}

/// A straight feed-forward, and tests for what bends it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FeedForwardFound {
    /// k and k_a, with the PI alone beside them.
    pub straight: FeedForward,
    /// Static map, hysteresis, friction compensation.
    #[serde(serialize_with = "write_found", deserialize_with = "read_found")]
    pub terms: Outcome<FeedForwardTerms>,
}

/// The limit of T_d* in one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LimitRecording {
    /// The file.
    pub file: String,
    /// The limit.
    #[serde(serialize_with = "write_found", deserialize_with = "read_found")]
    pub found: Outcome<Limit>,
}

/// Looks at the speed controller in recordings in speed control. Each is a part of a step of the work.
///
/// PI and delay come from recordings with constant N_d* (BS_T_NT); the controller of the longest of them serves the
/// others: the feed-forward from those in which N_d* moves (Levels_N_NT, Ramp_N_NT), judged on the next of these, and
/// the limit.
#[must_use]
pub fn speed_control(controllers: &SpeedControllers<'_>, context: &Context) -> SpeedControl {
    let (experiments, torque_limit_nm) = (&controllers.experiments, controllers.torque_limit_nm);
    let held = in_order(Sought::SpeedController, experiments, |_| false);
    let moved = in_order(Sought::FeedForward, experiments, |e| e.label.excitation == Excitation::Speed);
    let step = context.step("looking at the speed controller", (held.len() + moved.len()) as u64);
    let of_held = |experiment: &&Experiment| {
        let _part = step.step(format!("looking at the speed controller in {}", experiment.file), 0);
        let found = controllers.fit(experiment).map(|fit| Box::new(controller(experiment, &fit, torque_limit_nm)));
        ControllerRecording { file: experiment.file.clone(), label: experiment.label.clone(), found: found.into() }
    };
    let found = parallel::map(&held, of_held);
    let Some(best) = controllers.best() else {
        return SpeedControl { controllers: found, feed_forward: Vec::new(), limits: Vec::new() };
    };
    let of_moved = |experiment: &&Experiment| {
        let _part = step.step(format!("looking at the feed-forward in {}", experiment.file), 0);
        let found = controllers.feed_forward(experiment, best).map(|straight| {
            let terms = feed_forward_terms(experiment, best, straight.lags, torque_limit_nm).into();
            Box::new(FeedForwardFound { straight: straight.as_ref().clone(), terms })
        });
        let (file, label) = (experiment.file.clone(), experiment.label.clone());
        FeedForwardRecording { file, label, found: found.into() }
    };
    let feed_forward = parallel::map(&moved, of_moved);
    let straight = feed_forward.iter().find_map(|one| one.found.estimated()).map(|found| &found.straight);
    let all: Vec<&Experiment> = held.iter().chain(&moved).copied().collect();
    let limits = parallel::map(&all, |experiment| LimitRecording {
        file: experiment.file.clone(),
        found: limit(experiment, best, straight).into(),
    });
    SpeedControl { limits, controllers: found, feed_forward }
}

/// Those in speed control: first the candidates for what is sought in their order, then others that are wanted, the
/// longest first.
fn in_order<'a>(
    sought: Sought,
    experiments: &[&'a Experiment],
    wanted: impl Fn(&Experiment) -> bool,
) -> Vec<&'a Experiment> {
    let in_control: Vec<&Experiment> =
        experiments.iter().copied().filter(|e| e.label.mode == ControlMode::Nt).collect();
    let mut others: Vec<&Experiment> =
        in_control.iter().copied().filter(|e| wanted(e) && !sought.is_given_by(e)).collect();
    others.sort_by(|a, b| b.duration_s().total_cmp(&a.duration_s()));
    sought.candidates(&in_control).into_iter().chain(others).collect()
}

fn controller(experiment: &Experiment, fit: &SpeedControllerFit, torque_limit_nm: Option<f64>) -> Controller {
    let result = &fit.result;
    Controller {
        with_delay: result.estimate.clone(),
        without_delay: fit.without_delay.clone(),
        validation: result.validation.clone(),
        validation_without_delay: result.without_delay.clone(),
        discrete: Discrete::of(&result.estimate, result.sample_time_s),
        structure: structure(experiment, fit, torque_limit_nm).into(),
    }
}
