//! The rooms of the bench under one name, while their users move to them.

#![allow(missing_docs)]

pub use ::dataset;
pub use ::effects;
pub use bench_model::{drive_ripple, prediction, replay, simulate, skews};
pub use design::{excitation_design, safety};
pub use part_engine as engine_torque;
pub use part_friction as friction;
pub use part_lines::{lines, segments, sine};
pub use part_shaft::shaft_analysis;
pub use part_torque::{model_comparison, torque_smoother};
pub use rig::{
    BenchFile, ControlMode, Diagnostic, Excitation, Experiment, ExperimentLabel, Finding, Place, PrepareError, Role,
    Severity,
};
pub use rig::{
    align, bench_file, bench_parameters, channels, diagnostics, estimation, experiment, facts, prepare, results,
};
pub use study::Study;

pub mod role {
    pub use ::units::Quantity;
    pub use rig::role::*;
}

pub mod units {
    pub use ::units::*;
    pub use rig::role::parse_unit_of_role;
}

pub mod model {
    pub use ::study::{StudyParts, assemble};
    pub use bench_model::model::*;
    pub use rig::facts::Engine;
}

pub mod analysis {
    pub use bench_model::analysis::*;
    pub use bench_model::skews::SignalSkews;
    pub use part_lines::segments::{Segment, steady_sines};
    pub use part_lines::sine::{SineTest, sine_points};
}

pub mod virtual_bench {
    pub use ::effects::{Effects, Gains, NaiveZeros, ShaftZeros, ShownTrace, Spectrum};
    pub use ::virtual_bench::*;
    pub use rig::bench_parameters::*;
    pub use rig::experiment::{ExperimentPlan, Sine, TorqueTarget, UPDATE_S, Waveform};
}

pub mod estimate {
    pub use part_controller::speed_controller;
    pub use part_shaft::{shaft, shaft_routes};
    pub use part_torque::{timing, torque_control};
    pub use rig::estimation::EstimateError;
}

pub mod speed_control {
    pub use ::study::noise_test::{
        Case, Estimator, Noise, NoiseTest, NoiseTestOptions, PUBLISHED, PublishedRow, Summary, noise_test,
        virtual_experiment,
    };
    pub use part_controller::speed_control::*;
}

pub mod torque_signals {
    pub use part_torque::torque_signals::*;
    pub use rig::results::{Told, Untold};
}

pub mod study {
    pub use ::study::*;
    pub use bench_model::analysis::{BodeCurve, Influence, Margins, ParameterInfluence, SinePoint, WholeModel};
    pub use bench_model::replay::Replay;
    pub use rig::facts::{BenchFacts, BenchVariant};
    pub use rig::results::*;
}
