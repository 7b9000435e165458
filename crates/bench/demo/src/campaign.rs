//! The experiments of the demonstration, and its bench file.

use recording::Recording;
use rig::bench_file::{ChannelMapping, Limits, RecordingList, ReportIdentity, ShaftPrior};
use rig::bench_parameters::BenchParameters;
use rig::experiment::{ExperimentPlan, UPDATE_S};
use rig::facts::BenchVariant;
use rig::{BenchFile, Experiment, Role};
use signal::Signal;
use units::RPM_RAD_S;
use virtual_bench::{CHANNELS, VirtualBenchError, simulate};

/// Length of the recording at a held speed, s.
const HELD_S: f64 = 60.0;
/// Its speed, rpm.
const HELD_RPM: f64 = 1200.0;

/// An experiment and the file its recording goes to.
#[derive(Debug, Clone)]
pub struct Planned {
    /// Name of the file.
    pub file_name: String,
    plan: ExperimentPlan,
}

impl Planned {
    /// The recording of the experiment.
    ///
    /// # Errors
    /// Those of [`simulate`].
    pub fn record(&self, parameters: &BenchParameters, seed: u64) -> Result<Recording, VirtualBenchError> {
        simulate(parameters, &self.plan, seed)
    }
}

/// The experiments, the longest first, so that two cores finish together.
pub fn plans() -> Vec<Planned> {
    let planned = |speed_rpm: f64, duration_s: f64, plan: fn(f64, f64) -> ExperimentPlan| {
        let plan = plan(speed_rpm, duration_s);
        Planned { file_name: format!("{}_{speed_rpm:.0}.mf4", plan.label), plan }
    };
    vec![
        planned(1200.0, 60.0, ExperimentPlan::sine_t_tn),
        planned(1200.0, 40.0, ExperimentPlan::bs_t_nt),
        planned(1200.0, 40.0, ExperimentPlan::white_noise_t_tn),
        planned(1200.0, 40.0, ExperimentPlan::levels_n_nt),
        planned(1200.0, 32.0, ExperimentPlan::ramp_n_nt),
        planned(1200.0, 30.0, ExperimentPlan::unfired_n_nt),
        planned(3000.0, 20.0, ExperimentPlan::bs_t_nt),
        planned(1200.0, 20.0, ExperimentPlan::step_t_tn),
        planned(1200.0, 18.0, ExperimentPlan::no_shaft_n_nt),
    ]
}

/// Bench file that the user of a real bench would write.
pub fn bench_file(parameters: &BenchParameters, recordings: &str) -> BenchFile {
    let is_recorded = |(role, _): &&(Role, &str)| !matches!(role, Role::FlangeTorque | Role::Throttle);
    BenchFile {
        name: "Virtual bench".to_owned(),
        variant: BenchVariant::LoadCell,
        cylinders: parameters.engine.cylinder_factors.len() as u32,
        strokes: 4,
        dynamometer_inertia_kg_m2: parameters.mechanics.dyno_inertia_kg_m2,
        dynamometer_inertia_uncertainty_percent: None,
        dynamometer_friction_nm_s_per_rad: None,
        dynamometer_coulomb_friction_nm: None,
        dynamometer_friction_uncertainty_percent: None,
        engine_inertia_kg_m2: parameters.mechanics.engine_inertia_kg_m2,
        engine_inertia_uncertainty_percent: None,
        limits: Limits { torque_nm: Some(parameters.drive.torque_limit_nm), ..Limits::default() },
        shaft: ShaftPrior::default(),
        virtual_bench: toml::Table::new(),
        channels: CHANNELS
            .iter()
            .filter(is_recorded)
            .map(|(role, name)| (*role, ChannelMapping::named(*name)))
            .collect(),
        recordings: RecordingList { files: vec![recordings.to_owned()], ..RecordingList::default() },
        report: ReportIdentity::default(),
    }
}

/// N_d and N_d* of a BS_T_NT on the bench of the demonstration: speeds for a controller where no recording is given.
///
/// # Errors
/// Those of [`simulate`].
pub fn held_speed(seed: u64) -> Result<Experiment, VirtualBenchError> {
    let plan = ExperimentPlan::bs_t_nt(HELD_RPM, HELD_S);
    let recording = simulate(&BenchParameters::default(), &plan, seed)?;
    let signal = |(role, name): &(Role, &str)| {
        let channel = recording.channels.iter().find(|channel| channel.name == *name)?;
        let samples = channel.samples.iter().map(|rpm| rpm * RPM_RAD_S).collect();
        Some((*role, Signal::new(0.0, UPDATE_S, samples).ok()?))
    };
    let speeds = CHANNELS.iter().filter(|(role, _)| matches!(role, Role::DynoSpeed | Role::DynoSpeedDemand));
    let signals = speeds.filter_map(signal).collect();
    Ok(Experiment { file: format!("{} of a virtual bench", plan.label), label: plan.label, signals })
}
