//! `dynoid experiment design --optimal`: the excitation from which chosen parameters are learnt best.

use design::excitation_design::{
    DesignTask, DesignedExcitation, ExcitationDesign, ExcitedDemand, Goal, Measurements, OperatingPoint, PeakLimits,
    PredictedParameter, SpectralLine, design,
};
use report::design::Optimal as Shown;
use report::wording;
use rig::experiment::{Test, catalogue};
use serde_json::json;
use units::RPM_RAD_S;

use super::planned::{self, Planned};
use super::stated::Bench;
use crate::cli::experiment::{DesignArguments, Excite, Form, OptimalArguments};
use crate::error::CliError;
use crate::terminal::Terminal;

/// How far the resonance of a bench may be off of which there is no study.
const UNCERTAIN_RESONANCE: f64 = 0.15;

/// A designed excitation.
pub(super) struct Optimal {
    goals: Vec<Goal>,
    excitation: DesignedExcitation,
    /// Empty for a binary demand.
    lines: Vec<SpectralLine>,
    excited: ExcitedDemand,
}

/// The plan of the excitation that the arguments ask for.
pub(super) fn plan(
    arguments: &DesignArguments,
    bench: &Bench,
    terminal: &Terminal,
) -> Result<(Planned, Optimal), CliError> {
    let asked = &arguments.optimal;
    let settings = planned::settings("--optimal", catalogue::OPTIMAL, &arguments.on.plan)?;
    let (speed_rpm, duration_s) = (settings.get("speed"), settings.get("duration"));
    let at = OperatingPoint { speed_rad_s: speed_rpm * RPM_RAD_S, torque_nm: settings.get("torque") };
    let excited = excited(asked);
    let refused = |reason: String| CliError::Usage { what: format!("--optimal: {reason}") };
    let model = bench.model_with_shaft().map_err(|reason| refused(reason.to_owned()))?;
    let limits = limits(asked, bench, at).map_err(refused)?;
    let measured = Measurements::of_bench(&bench.stated.parameters, at);
    let task = DesignTask::of_goals(&asked.optimal, model, excited, at, measured, limits, duration_s);
    let task = task.map_err(|error| refused(error.to_string()))?;
    let task = if bench.assembled.is_some() { task } else { task.with_uncertain_resonance(UNCERTAIN_RESONANCE) };
    let step = terminal.work().step("designing", 0);
    let found: ExcitationDesign = design(&task).map_err(|error| refused(error.to_string()))?;
    drop(step);
    let (test, excitation, lines) = match asked.form {
        Form::Multisine => (Test::Multisine, found.multisine, found.spectrum),
        Form::Binary => (Test::Binary, found.binary, Vec::new()),
    };
    let mut plan = excitation.plan(test, excited, at, duration_s);
    plan.settling_s = settings.get("settling");
    let goals = asked.optimal.clone();
    Ok((Planned { plan, speed_rpm: Some(speed_rpm) }, Optimal { goals, excitation, lines, excited }))
}

fn excited(asked: &OptimalArguments) -> ExcitedDemand {
    match asked.excite {
        Some(Excite::Torque) => ExcitedDemand::Torque,
        Some(Excite::Speed) => ExcitedDemand::Speed,
        None if asked.optimal.iter().any(|goal| goal.needs_speed_control()) => ExcitedDemand::Speed,
        None => ExcitedDemand::Torque,
    }
}

/// The peaks that were asked for, or what the bench file's limits leave.
fn limits(asked: &OptimalArguments, bench: &Bench, at: OperatingPoint) -> Result<PeakLimits, String> {
    let left = PeakLimits::left_by(&bench.file.limits, at);
    let Some(shaft_torque_nm) = asked.peak_shaft_torque.or(left.shaft_torque_nm) else {
        let what = "say how far the shaft's torque may swing, as with --peak-shaft-torque 60, or state shaft_torque in \
                    [limits]";
        return Err(what.to_owned());
    };
    let air_gap_torque_nm = asked.peak_torque.or(left.air_gap_torque_nm);
    if shaft_torque_nm <= 0.0 || air_gap_torque_nm.is_some_and(|nm| nm <= 0.0) {
        return Err(format!(
            "[limits] leaves nothing to excite with at {} Nm; lower it with --set torque=…",
            at.torque_nm
        ));
    }
    Ok(PeakLimits {
        shaft_torque_nm: Some(shaft_torque_nm),
        air_gap_torque_nm,
        speed_rad_s: Some(asked.peak_speed * RPM_RAD_S),
        demand: None,
    })
}

impl Optimal {
    /// Suffix of its files beside their label and speed: K_B.
    pub(super) fn suffix(&self) -> String {
        self.goals.iter().map(|goal| format!("_{goal}")).collect()
    }

    /// Part of it that a report shows.
    pub(super) fn shown(&self) -> Shown<'_> {
        Shown { excitation: &self.excitation, excited: self.excited, lines: &self.lines }
    }

    pub(super) fn facts(&self) -> serde_json::Value {
        let parameter = |one: &PredictedParameter| {
            let (symbol, unit, si) = wording::model_parameter(one.parameter);
            json!({"symbol": symbol, "unit": unit, "value": one.value / si, "standard_error": one.standard_error / si,
                "white_noise_standard_error": one.white_noise_standard_error / si,
                "variance_ratio": one.gain_over_white_noise()})
        };
        let peaks = &self.excitation.peaks;
        json!({
            "goals": self.goals.iter().map(Goal::to_string).collect::<Vec<_>>(),
            "parameters": self.excitation.parameters.iter().map(parameter).collect::<Vec<_>>(),
            "largest_deviations": {"shaft_torque_nm": peaks.shaft_torque_nm, "torque_nm": peaks.air_gap_torque_nm,
                "speed_rpm": peaks.speed_rad_s / RPM_RAD_S},
            "binding": self.excitation.binding,
        })
    }
}
