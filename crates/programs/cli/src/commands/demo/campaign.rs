//! The demo's experiments and their simulation.

use dynoid::{Files, encode_mdf4};
use numerics::parallel;
use rig::bench_file::{ChannelMapping, Limits, RecordingList, ReportIdentity, ShaftPrior};
use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use rig::facts::BenchVariant;
use rig::{BenchFile, Role};
use virtual_bench::{CHANNELS, simulate};
use work::Context;

use crate::error::CliError;

/// An experiment and the file its recording goes to.
pub(super) struct Planned {
    pub(super) file_name: String,
    plan: ExperimentPlan,
}

/// The experiments, the longest first, so that two cores finish together.
pub(super) fn plans() -> Vec<Planned> {
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

/// Simulates the experiments on all cores; returns the recordings' bytes in their order. Every experiment has a seed of
/// its own, counted from `seed`.
pub(super) fn simulate_all(
    parameters: &BenchParameters,
    plans: &[Planned],
    seed: u64,
    context: &Context,
    files: &Files,
) -> Result<Vec<Vec<u8>>, CliError> {
    let seeded: Vec<(&Planned, u64)> = plans.iter().zip(seed..).collect();
    let record = |(planned, seed): &(&Planned, u64)| record(parameters, &planned.plan, *seed, files);
    parallel::map_as_step(context, "simulating the bench", &seeded, record).into_iter().collect()
}

fn record(parameters: &BenchParameters, plan: &ExperimentPlan, seed: u64, files: &Files) -> Result<Vec<u8>, CliError> {
    Ok(encode_mdf4(&simulate(parameters, plan, seed).map_err(CliError::internal)?, files)?)
}

/// Bench file that the user of a real bench would write.
pub(super) fn bench_file(parameters: &BenchParameters, recordings: &str) -> BenchFile {
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
        recordings: RecordingList { files: vec![recordings.to_owned()], labels: Vec::new() },
        report: ReportIdentity::default(),
    }
}
