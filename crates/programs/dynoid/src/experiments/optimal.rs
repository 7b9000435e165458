//! The excitation from which chosen parameters are learnt best.

use design::excitation_design::{
    DesignTask, DesignedExcitation, ExcitedDemand, Goal, LimitedQuantity, Measurements, OperatingPoint, PeakLimits,
    PredictedParameter, SpectralLine, design,
};
use report::design::Optimal as Shown;
use report::wording;
use rig::experiment::{ExperimentPlan, Test};
use serde::Serialize;
use units::RPM_RAD_S;
use work::Context;

use crate::error::{NotDesigned, NotPredicted};
use crate::known::KnownBench;

/// How far the resonance of a bench may be off of which there is no study.
const UNCERTAIN_RESONANCE: f64 = 0.15;
/// Usual deviation of N_d from its mean, rpm.
const PEAK_SPEED_RPM: f64 = 100.0;

/// The form of a designed demand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DemandForm {
    /// Sines of many frequencies.
    Multisine,
    /// Two levels.
    Binary,
}

/// Choices of an optimal excitation.
#[derive(Debug, Clone, PartialEq)]
pub struct OptimalOptions {
    /// Parameters that it is to teach.
    pub goals: Vec<Goal>,
    /// Form of the demand.
    pub form: DemandForm,
    /// The demand that is excited; without it the one that teaches the goals.
    pub excited: Option<ExcitedDemand>,
    /// Largest deviation of T_shaft from its mean, Nm; without it what the limits of the bench leave.
    pub peak_shaft_torque_nm: Option<f64>,
    /// Largest deviation of T_d from its mean, Nm; without it what the limits of the bench leave.
    pub peak_torque_nm: Option<f64>,
    /// Largest deviation of N_d from its mean, rpm.
    pub peak_speed_rpm: f64,
}

impl OptimalOptions {
    /// A multisine for these parameters, within the limits of the bench.
    pub fn of(goals: Vec<Goal>) -> Self {
        OptimalOptions {
            goals,
            form: DemandForm::Multisine,
            excited: None,
            peak_shaft_torque_nm: None,
            peak_torque_nm: None,
            peak_speed_rpm: PEAK_SPEED_RPM,
        }
    }

    fn excited(&self) -> ExcitedDemand {
        match self.excited {
            Some(excited) => excited,
            None if self.goals.iter().any(|goal| goal.needs_speed_control()) => ExcitedDemand::Speed,
            None => ExcitedDemand::Torque,
        }
    }

    /// The peaks that are asked for, or what the bench file's limits leave.
    fn limits(&self, bench: &KnownBench, at: OperatingPoint) -> Result<PeakLimits, NotDesigned> {
        let left = PeakLimits::left_by(&bench.file().limits, at);
        let shaft_torque_nm = self.peak_shaft_torque_nm.or(left.shaft_torque_nm).ok_or(NotDesigned::NoShaftLimit)?;
        let air_gap_torque_nm = self.peak_torque_nm.or(left.air_gap_torque_nm);
        if shaft_torque_nm <= 0.0 || air_gap_torque_nm.is_some_and(|nm| nm <= 0.0) {
            return Err(NotDesigned::NothingLeft { torque_nm: at.torque_nm });
        }
        Ok(PeakLimits {
            shaft_torque_nm: Some(shaft_torque_nm),
            air_gap_torque_nm,
            speed_rad_s: Some(self.peak_speed_rpm * RPM_RAD_S),
            demand: None,
        })
    }
}

/// A designed excitation.
#[derive(Debug, Clone, PartialEq)]
pub struct OptimalExcitation {
    goals: Vec<Goal>,
    excitation: DesignedExcitation,
    /// Empty for a binary demand.
    lines: Vec<SpectralLine>,
    excited: ExcitedDemand,
}

/// The name of an optimal excitation in errors.
pub const OPTIMAL: &str = "optimal excitation";

impl OptimalExcitation {
    /// Designs the excitation on a bench, at an operating point.
    pub(super) fn of(
        bench: &KnownBench,
        options: &OptimalOptions,
        at: OperatingPoint,
        duration_s: f64,
        context: &Context,
    ) -> Result<Self, NotDesigned> {
        let excited = options.excited();
        let model = bench.model_with_shaft().map_err(|_: NotPredicted| NotDesigned::UnknownShaft)?;
        let limits = options.limits(bench, at)?;
        let measured = Measurements::of_bench(&bench.virtual_bench().parameters, at);
        let task = DesignTask::of_goals(&options.goals, model, excited, at, measured, limits, duration_s)?;
        let is_known = bench.assembled().is_some();
        let task = if is_known { task } else { task.with_uncertain_resonance(UNCERTAIN_RESONANCE) };
        let _step = context.step("designing", 0);
        let found = design(&task)?;
        let (excitation, lines) = match options.form {
            DemandForm::Multisine => (found.multisine, found.spectrum),
            DemandForm::Binary => (found.binary, Vec::new()),
        };
        Ok(OptimalExcitation { goals: options.goals.clone(), excitation, lines, excited })
    }

    /// The plan that runs it.
    pub(super) fn plan(&self, form: DemandForm, at: OperatingPoint, duration_s: f64) -> ExperimentPlan {
        let test = match form {
            DemandForm::Multisine => Test::Multisine,
            DemandForm::Binary => Test::Binary,
        };
        self.excitation.plan(test, self.excited, at, duration_s)
    }

    /// Suffix of its files beside their label and speed: _K_B.
    pub(super) fn suffix(&self) -> String {
        self.goals.iter().map(|goal| format!("_{goal}")).collect()
    }

    /// The excitation, with the covariance that it would give.
    pub fn excitation(&self) -> &DesignedExcitation {
        &self.excitation
    }

    /// Part of it that a report shows.
    pub(super) fn shown(&self) -> Shown<'_> {
        Shown { excitation: &self.excitation, excited: self.excited, lines: &self.lines }
    }

    /// The excitation in numbers.
    pub fn facts(&self) -> OptimalFacts {
        let peaks = &self.excitation.peaks;
        OptimalFacts {
            goals: self.goals.iter().map(Goal::to_string).collect(),
            parameters: self.excitation.parameters.iter().map(ParameterFacts::of).collect(),
            largest_deviations: Deviations {
                shaft_torque_nm: peaks.shaft_torque_nm,
                torque_nm: peaks.air_gap_torque_nm,
                speed_rpm: peaks.speed_rad_s / RPM_RAD_S,
            },
            binding: self.excitation.binding,
        }
    }
}

/// Numbers of [`OptimalExcitation`].
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OptimalFacts {
    goals: Vec<String>,
    parameters: Vec<ParameterFacts>,
    largest_deviations: Deviations,
    binding: LimitedQuantity,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct ParameterFacts {
    symbol: &'static str,
    unit: &'static str,
    value: f64,
    standard_error: f64,
    white_noise_standard_error: f64,
    variance_ratio: f64,
}

impl ParameterFacts {
    fn of(one: &PredictedParameter) -> Self {
        let (symbol, unit, si) = wording::model_parameter(one.parameter);
        ParameterFacts {
            symbol,
            unit,
            value: one.value / si,
            standard_error: one.standard_error / si,
            white_noise_standard_error: one.white_noise_standard_error / si,
            variance_ratio: one.gain_over_white_noise(),
        }
    }
}

#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Deviations {
    shaft_torque_nm: f64,
    torque_nm: f64,
    speed_rpm: f64,
}
