//! The experiments of the demonstration, and its bench file.

use recording::Recording;
use rig::bench_file::{ChannelMapping, Limits, RecordingList, ReportIdentity, ShaftPrior};
use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use rig::facts::BenchVariant;
use rig::{BenchFile, Role};
use virtual_bench::{CHANNELS, VirtualBenchError, simulate};

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
        recordings: RecordingList { files: vec![recordings.to_owned()], labels: Vec::new() },
        report: ReportIdentity::default(),
    }
}
