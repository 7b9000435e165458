//! The torque signals of a bench: how late each is, what filter is in the system's own shaft torque, what the shaft
//! torque really was, how the load cell moves, and whether T_d,calc can be trusted at rest (thesis §3.4, §6.1).

mod routes;
mod shaft;
mod trust;

use numerics::parallel;
use part_controller::SpeedControllers;
use part_controller::speed_controller::SpeedControllerFit;
use rig::experiment::{Excitation, Sought};
use rig::prepare::believable;
use rig::results::{Outcome, Parameter, Reason, SignalDelay, read_found, read_if_sought, write_found, write_if_sought};
use rig::{BenchFile, Experiment, ExperimentLabel, Role};
use serde::{Deserialize, Serialize};
use work::Context;

use crate::TorqueControls;
use crate::timing::{self, ShaftFilter};
use crate::torque_control::{self, TorqueControlFit};
use shaft::Known;
pub use shaft::{OnceATurn, RebuiltShaft};
pub use trust::{Trust, TrustCheck};

/// Findings of recordings on the torque signals.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TorqueSignals {
    /// One entry a recording.
    pub recordings: Vec<TorqueRecording>,
    /// T_d,calc against the load cell, of all recordings together.
    pub trust: Option<TrustCheck>,
}

/// Findings of one recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TorqueRecording {
    /// The file.
    pub file: String,
    /// The experiment's label.
    pub label: ExperimentLabel,
    /// Delays of its torque signals.
    #[serde(serialize_with = "write_found", deserialize_with = "read_found")]
    pub delays: Outcome<Vec<SignalDelay>>,
    /// The filter in T_d,shaft,calc; `None` where that was not recorded.
    #[serde(serialize_with = "write_if_sought", deserialize_with = "read_if_sought")]
    pub filter: Option<Outcome<ShaftFilter>>,
    /// The shaft torque; `None` without a shaft.
    #[serde(serialize_with = "write_if_sought", deserialize_with = "read_if_sought")]
    pub shaft: Option<Outcome<RebuiltShaft>>,
}

impl TorqueSignals {
    /// The load cell's own dynamics, τ_cell, ω_n and ζ, by the recording that shows them best: that whose ω_n is
    /// sharpest.
    #[must_use]
    pub fn load_cell(&self) -> Option<(&str, &[Parameter])> {
        let all = self.recordings.iter().filter_map(|recording| {
            let delays = recording.delays.estimated()?;
            let cell = delays.iter().find_map(|delay| delay.dynamics.as_ref())?;
            Some((recording.file.as_str(), cell.parameters.as_slice()))
        });
        let sharpness =
            |parameters: &[Parameter]| parameters.get(1).map_or(f64::INFINITY, |p| p.standard_error / p.value);
        all.min_by(|a, b| sharpness(a.1).total_cmp(&sharpness(b.1)))
    }
}

/// Looks at the torque signals of recordings; `step` hears of each before its turn comes.
///
/// Delays come from experiments that move T_d* by themselves (WhiteNoise_T_TN, Multisine_T_TN, Binary_T_TN, Step_T_TN,
/// BS_T_NT), see [`timing::estimate`]; the filter from any with N_d, T_d,calc and T_d,shaft,calc; the shaft torque from
/// any with a shaft, N_d and T_d,calc. The encoder's once-a-turn error is taken out where the speed controller shows it
/// (BS_T_NT).
///
/// A T_d,calc whose sign contradicts what it does to the speed is not used.
#[must_use]
pub fn torque_signals(
    controllers: &SpeedControllers<'_>,
    torque_controls: &TorqueControls<'_>,
    bench: &BenchFile,
    context: &Context,
) -> TorqueSignals {
    let step = context.step("looking at the torques", torque_controls.experiments.len() as u64);
    let look = |experiment: &&Experiment| {
        let _part = step.step(format!("looking at the torques of {}", experiment.file), 0);
        of_recording(experiment, controllers, torque_controls, bench)
    };
    // Chosen before the recordings are shared out.
    let _ = torque_controls.chosen();
    let experiments = &torque_controls.experiments;
    let recordings = parallel::map(experiments, look);
    let believed: Vec<&Experiment> = experiments.iter().copied().filter(|e| believable(e).is_ok()).collect();
    TorqueSignals { recordings, trust: trust::check(&believed).ok().flatten() }
}

/// The chosen torque control serves where a recording does not give it itself.
fn of_recording(
    experiment: &Experiment,
    controllers: &SpeedControllers<'_>,
    torque_controls: &TorqueControls<'_>,
    bench: &BenchFile,
) -> TorqueRecording {
    if let Err(error) = believable(experiment) {
        return with_wrong_sign(experiment, &Reason::from(error), bench);
    }
    let is_known = torque_control::choose(&[experiment]).is_some();
    let control = if is_known { torque_controls.fit(experiment).ok() } else { None };
    let control = control.as_deref();
    let gives_controller = Sought::SpeedController.is_given_by(experiment);
    let controller = if gives_controller { controllers.fit(experiment).ok() } else { None };
    TorqueRecording {
        file: experiment.file.clone(),
        label: experiment.label.clone(),
        delays: if is_known { delays(experiment, control, bench) } else { Outcome::because(not_excited(experiment)) },
        filter: filter(experiment),
        shaft: (!experiment.label.is_without_shaft())
            .then(|| rebuilt(experiment, control.or(torque_controls.best()), controller.as_deref(), bench)),
    }
}

/// Findings that are left where T_d,calc cannot be believed: how late the other torques are.
fn with_wrong_sign(experiment: &Experiment, why: &Reason, bench: &BenchFile) -> TorqueRecording {
    let mut others = experiment.clone();
    others.signals.remove(&Role::AirGapTorque);
    let others_tell = others.label.excitation == Excitation::Torque;
    let delays = if others_tell { delays(&others, None, bench) } else { Outcome::because(why.clone()) };
    TorqueRecording {
        file: experiment.file.clone(),
        label: experiment.label.clone(),
        delays: if delays.estimated().is_some() { delays } else { Outcome::because(why.clone()) },
        filter: Some(Outcome::because(why.clone())),
        shaft: (!experiment.label.is_without_shaft()).then(|| Outcome::because(why.clone())),
    }
}

/// T_d* does not move T_d by itself, or hardly.
fn not_excited(experiment: &Experiment) -> Reason {
    Reason::NotExcited { file: experiment.file.clone(), role: Role::DynoTorqueDemand }
}

fn missing(experiment: &Experiment, role: Role) -> Reason {
    Reason::Channel { file: experiment.file.clone(), role }
}

fn delays(experiment: &Experiment, control: Option<&TorqueControlFit>, bench: &BenchFile) -> Outcome<Vec<SignalDelay>> {
    if !Role::TORQUES.iter().any(|role| experiment.signal(*role).is_some()) {
        return Outcome::because(missing(experiment, Role::AirGapTorque));
    }
    timing::estimate(&[experiment], control, bench.dynamometer_inertia_kg_m2).map(|timing| timing.delays).into()
}

fn filter(experiment: &Experiment) -> Option<Outcome<ShaftFilter>> {
    experiment.signal(Role::SystemShaftTorque)?;
    let missing = [Role::DynoSpeed, Role::AirGapTorque].into_iter().find(|role| experiment.signal(*role).is_none());
    Some(match (missing, timing::shaft_filter(experiment)) {
        (Some(role), _) => Outcome::because(self::missing(experiment, role)),
        (None, Some(filter)) => Outcome::Estimated(filter),
        (None, None) => Outcome::because(Reason::NotExplained { file: experiment.file.clone() }),
    })
}

fn rebuilt(
    experiment: &Experiment,
    control: Option<&TorqueControlFit>,
    controller: Option<&SpeedControllerFit>,
    bench: &BenchFile,
) -> Outcome<RebuiltShaft> {
    let known = Known {
        inertia_kg_m2: bench.dynamometer_inertia_kg_m2,
        engine: bench.engine(),
        torque_control: control,
        encoder: controller.map(|fit| fit.encoder),
        stated_gate_s: bench.channels.get(&Role::DynoSpeed).and_then(|mapping| mapping.gate_s),
    };
    shaft::rebuild(experiment, &known).into()
}
