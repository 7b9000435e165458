//! Findings of the parts' analyses on a campaign, in addition to the study: the same as each of them shows on its own.

use numerics::parallel;
use part_controller::noise_test::{NoiseTest, NoiseTestOptions, noise_test};
use part_controller::speed_controller::{SpeedControl, speed_control};
use part_engine::{EngineTorque, engine_torque};
use part_friction::{Friction, FrictionError};
use part_lines::lines::{OverSpeed, RecordingLines, find_lines, on_one_mains, over_speed};
use part_shaft::Parts;
use part_shaft::shaft_analysis::{ShaftAnalysis, shaft_analysis};
use part_torque::model_comparison::{self, ModelComparison, OrdersTried};
use part_torque::torque_signals::{TorqueSignals, torque_signals};
use rig::experiment::Sought;
use rig::results::{Outcome, Reason, read_found, read_if_sought, write_found, write_if_sought};
use rig::{BenchFile, Experiment};
use serde::{Deserialize, Serialize};
use work::Context;

use super::next::{self, NextExperiments, NextOptions};
use super::recorded::{RecordedCourse, StepResponse, courses, step_response};

/// Orders of the torque control that are tried here: those of the thesis's low-order models. All of
/// `OrdersTried::default()` take minutes.
const ORDERS: OrdersTried = OrdersTried { highest: 2, longest_delay: 2 };
/// Draws of each noise in the study of a known PI: enough to separate a coverage of 95 % from one of 80 %.
const DRAWS: usize = 50;
/// Steps of all analyses.
const COUNT: u64 = 8;

/// The analyses of a campaign's recordings. One that lacks its recordings says so, and costs none of the others.
/// [`crate::document`] has its form in JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Analyses {
    /// Recorded signals, as they were recorded.
    pub courses: Vec<RecordedCourse>,
    /// The torque signals and N_d at a step of T_d*; `None` without such a step in torque control.
    pub step: Option<StepResponse>,
    /// Lines of the spectra, one entry a recording.
    pub lines: Vec<RecordingLines>,
    /// The lines of all recordings over the speed.
    pub over_speed: Vec<OverSpeed>,
    /// The torque signals against each other.
    pub torque_signals: TorqueSignals,
    /// Terms that are added to PI, delay and feed-forward.
    pub speed_control: SpeedControl,
    /// Effect of noise on the estimate of a PI; `None` without a BS_T_NT.
    #[serde(serialize_with = "write_if_sought", deserialize_with = "read_if_sought")]
    pub pi_study: Option<Outcome<NoiseTest>>,
    /// Models of the torque control held against a delay of one sample.
    #[serde(serialize_with = "write_found", deserialize_with = "read_found")]
    pub torque_control: Outcome<ModelComparison>,
    /// Friction and inertia of the dynamometer.
    #[serde(serialize_with = "write_found", deserialize_with = "read_found")]
    pub friction: Outcome<Friction>,
    /// The shaft by band, by route, and beyond K and B.
    pub shaft: ShaftAnalysis,
    /// The engine's torque.
    pub engine_torque: EngineTorque,
    /// Experiments to record next.
    #[serde(serialize_with = "write_found", deserialize_with = "read_found")]
    pub next: Outcome<NextExperiments>,
}

impl Analyses {
    /// The highest order and the longest delay of torque controls that were tried.
    pub const ORDERS_TRIED: OrdersTried = ORDERS;
}

/// The lines of the spectra of each recording, and their causes.
pub fn lines(experiments: &[Experiment], bench: &BenchFile, context: &Context) -> Vec<RecordingLines> {
    let step = context.step("finding lines", experiments.len() as u64);
    let found = parallel::map(experiments, |experiment| {
        let _part = step.step(format!("finding lines in {}", experiment.file), 0);
        find_lines(experiment, bench)
    });
    on_one_mains(found)
}

/// Makes all analyses that the recordings allow; the friction is that of the study.
pub(super) fn analyses(
    experiments: &[Experiment],
    parts: &Parts<'_>,
    friction: Result<Friction, FrictionError>,
    context: &Context,
) -> Analyses {
    let (all, bench) = (&parts.experiments, parts.bench);
    let (controllers, torque_controls) = (&parts.controllers, &parts.torque_controls);
    let step = context.step("analysing", COUNT);
    let lines = lines(experiments, bench, &step);
    let torque_signals = torque_signals(controllers, torque_controls, bench, &step);
    let speed_control = speed_control(controllers, &step);
    let pi_study = held_speed(parts).map(|experiment| {
        let options = NoiseTestOptions { draws: DRAWS, ..NoiseTestOptions::default() };
        noise_test(experiment, &options, &step).into()
    });
    let torque_control = model_comparison::compare_models(torque_controls, ORDERS, &step).map_err(Reason::of_analysis);
    let shaft = shaft_analysis(parts, &step);
    let engine_torque = engine_torque(parts, &step);
    let next = next::beside(parts, NextOptions::default(), &step).map_err(Reason::of_analysis);
    Analyses {
        courses: courses(all),
        step: step_response(all),
        over_speed: over_speed(&lines),
        lines,
        torque_signals,
        speed_control,
        pi_study,
        torque_control: torque_control.into(),
        friction: friction.map_err(Reason::of_analysis).into(),
        shaft,
        engine_torque,
        next: next.into(),
    }
}

/// The recording with constant N_d* that the controller is from, or else the first that may give it.
fn held_speed<'a>(parts: &Parts<'a>) -> Option<&'a Experiment> {
    let candidates = || Sought::SpeedController.candidates(&parts.experiments).first().copied();
    parts.controllers.chosen().ok().map(|chosen| chosen.experiment).or_else(candidates)
}
