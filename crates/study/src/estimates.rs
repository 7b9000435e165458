//! Which recording serves which estimate, and what is missing where none does.

use bench_model::analysis::WholeModel;
use bench_model::model::AssembledModel;
use bench_model::replay::Replay;
use part_controller::speed_controller::{self, SpeedControllerFit};
use part_shaft::shaft;
use part_shaft::shaft_inputs::{SHAFT_TESTS, both_inertias, shaft_inputs, tells_inertias};
use part_torque::timing;
use part_torque::torque_control::{self, TorqueControlFit};
use rig::experiment::Test;
use rig::results::{Estimate, FeedForward, Need, Part, Shaft, SpeedController, Timing, TorqueControl};
use rig::{BenchFile, Experiment, Finding, Role, Severity};

use crate::findings::{Findings, needs_part};
use crate::folded_pulses::Folded;
use crate::whole::{self, Pieces, Whole};

/// Times by which the shaft's equation leaves less with the speeds exchanged that tell that their channels are: rightly named
/// speeds have 10⁻³ and exchanged ones 10³, with a dual-mass flywheel behind a flange, which the equation lacks, 0.3 and 9.
const EXCHANGED: f64 = 3.0;
/// Disagreement of the inertia in the bench file with the data that is worth a warning: standard errors, and share.
const INERTIA_DOUBT: (f64, f64) = (5.0, 0.01);
/// Disagreement, as a share, beyond which the stated inertia is wrong rather than doubtful: K and B scale with it.
const INERTIA_CONTRADICTED: f64 = 0.3;
/// Everything that was estimated.
pub(super) struct Estimates {
    pub(super) timing: Part<Timing>,
    pub(super) speed_controller: Part<SpeedController>,
    pub(super) feed_forward: Part<FeedForward>,
    pub(super) torque_control: Part<TorqueControl>,
    pub(super) shaft: Part<Shaft>,
    pub(super) whole: Part<WholeModel>,
    pub(super) model: Option<AssembledModel>,
    pub(super) replays: Vec<Replay>,
}

/// A part from the outcome of its estimate.
fn part<T>(outcome: Result<T, Vec<Need>>) -> Part<T> {
    match outcome {
        Ok(value) => Part::Estimated(value),
        Err(needs) => Part::NotEstimated { needs },
    }
}

/// The parts that the recordings allow, as they are fitted.
pub(super) struct Fits<'a> {
    pub(super) controller: Result<SpeedControllerFit, Vec<Need>>,
    pub(super) feed_forward: Result<FeedForward, Vec<Need>>,
    pub(super) torque_control: Result<TorqueControlFit, Vec<Need>>,
    pub(super) shaft: Result<ShaftFit<'a>, Vec<Need>>,
}

/// A shaft, the experiment it was estimated from, and J_d as that experiment shows it, if it does.
pub(super) struct ShaftFit<'a> {
    pub(super) shaft: Shaft,
    experiment: &'a Experiment,
    inertia: Option<(f64, f64)>,
}

impl<'a> Fits<'a> {
    pub(super) fn of(findings: &mut Findings<'a>) -> Self {
        let controller = controller(findings);
        let feed_forward = feed_forward(findings, controller.as_ref().ok());
        if let Ok(feed_forward) = &feed_forward {
            findings.doubt_residuals("feed_forward", &feed_forward.validation);
        }
        let torque_control = torque_control(findings);
        let shaft = shaft(findings, controller.as_ref().ok(), torque_control.as_ref().ok());
        Fits { controller, feed_forward, torque_control, shaft }
    }

    /// What a model is made of; none without a shaft.
    pub(super) fn pieces(&self) -> Option<Pieces<'_>> {
        Some(Pieces {
            shaft: &self.shaft.as_ref().ok()?.shaft,
            controller: self.controller.as_ref().ok(),
            feed_forward: self.feed_forward.as_ref().ok(),
            torque_control: self.torque_control.as_ref().ok(),
        })
    }
}

/// Estimates every part the recordings allow, checks one recording by another, and replays the model.
pub(super) fn all(findings: &mut Findings<'_>) -> Estimates {
    let mut fits = Fits::of(findings);
    let timing = timing(findings, fits.torque_control.as_ref().ok());
    if let Ok(fit) = &mut fits.shaft {
        cross_check(findings, fit, fits.controller.as_ref().ok(), fits.torque_control.as_ref().ok());
    }
    let Whole { model, analysis } = fits.pieces().map_or_else(Whole::missing, |p| whole::assemble(findings, &p));
    let replays = match (&model, fits.pieces()) {
        (Some(assembled), Some(pieces)) => whole::replays(findings, &pieces, &assembled.model),
        _ => Vec::new(),
    };
    Estimates {
        timing: part(timing),
        speed_controller: part(fits.controller.map(|c| c.result)),
        feed_forward: part(fits.feed_forward),
        torque_control: part(fits.torque_control.map(|t| t.result)),
        shaft: part(fits.shaft.map(|fit| fit.shaft)),
        whole: part(analysis),
        model,
        replays,
    }
}

fn controller(findings: &mut Findings<'_>) -> Result<SpeedControllerFit, Vec<Need>> {
    let limit = findings.bench.limits.torque_nm;
    let recordings = findings.of_test(&Test::Bs);
    let fit =
        findings.first("speed controller", &recordings, &["BS_T_NT"], |e| speed_controller::estimate(e, limit))?;
    findings.doubt_residuals("speed_controller", &fit.result.validation);
    if let Some(step) = fit.coarse_demand_nm {
        let finding = Finding::CoarseResolution { role: Role::DynoTorqueDemand, step };
        findings.doubt(&fit.result.validation.stretch.file, Severity::Warning, finding);
    }
    Ok(fit)
}

fn feed_forward(
    findings: &mut Findings<'_>,
    controller: Option<&SpeedControllerFit>,
) -> Result<FeedForward, Vec<Need>> {
    let Some(controller) = controller else { return Err(needs_part("speed controller")) };
    let limit = findings.bench.limits.torque_nm;
    let recordings = findings.of_tests(&[Test::Levels, Test::Ramp]);
    let labels = ["Levels_N_NT", "Ramp_N_NT"];
    findings.first("feed-forward", &recordings, &labels, |candidate| {
        let judge = recordings.iter().find(|other| other.file != candidate.file).copied();
        speed_controller::estimate_feed_forward(candidate, judge, controller, limit)
    })
}

fn torque_control(findings: &mut Findings<'_>) -> Result<TorqueControlFit, Vec<Need>> {
    let limit = findings.bench.limits.torque_nm;
    let candidates = findings.of_tests(&[Test::WhiteNoise, Test::Multisine, Test::Binary, Test::Step, Test::Bs]);
    let fit = findings.first("torque control", &candidates, &["WhiteNoise_T_TN", "Step_T_TN", "BS_T_NT"], |e| {
        torque_control::estimate(e, limit)
    })?;
    findings.diagnostics.extend(fit.diagnostics.iter().cloned());
    Ok(fit)
}

fn timing(findings: &mut Findings<'_>, torque_control: Option<&TorqueControlFit>) -> Result<Timing, Vec<Need>> {
    let inertia = findings.bench.dynamometer_inertia_kg_m2;
    let candidates = findings.of_tests(&[Test::WhiteNoise, Test::Multisine, Test::Binary, Test::Step]);
    findings.first("timing", &candidates, &["WhiteNoise_T_TN", "Step_T_TN"], |e| {
        timing::estimate(&[e], torque_control, inertia)
    })
}

fn shaft<'a>(
    findings: &mut Findings<'a>,
    controller: Option<&SpeedControllerFit>,
    torque_control: Option<&TorqueControlFit>,
) -> Result<ShaftFit<'a>, Vec<Need>> {
    let candidates = findings.of_tests(&SHAFT_TESTS);
    let bench = findings.bench;
    let labels = ["BS_T_NT", "WhiteNoise_T_TN"];
    let mut exchanged = None;
    let fit = findings.first("shaft", &candidates, &labels, |experiment| {
        let inputs = shaft_inputs(experiment, bench, controller, torque_control)?;
        let misfit_ratio = shaft::gain_by_exchange(&inputs).ok().filter(|ratio| *ratio > EXCHANGED);
        exchanged = exchanged.take().or(misfit_ratio.map(|ratio| (experiment, ratio)));
        let (shaft, inertia) = (shaft::estimate(&inputs)?, shaft::estimate_inertia(&inputs)?);
        Ok(ShaftFit { shaft, experiment, inertia })
    });
    if let Some((experiment, misfit_ratio)) = exchanged {
        findings.doubt(&experiment.file, Severity::Error, Finding::SpeedsExchanged { misfit_ratio });
    }
    let mut fit = fit?;
    fit.shaft.inertias = inertias(&candidates, bench, controller, torque_control);
    Ok(fit)
}

/// What other recordings say of the shaft, and the doubts about it.
fn cross_check(
    findings: &mut Findings<'_>,
    fit: &mut ShaftFit<'_>,
    controller: Option<&SpeedControllerFit>,
    torque_control: Option<&TorqueControlFit>,
) {
    doubt_pulses(findings, fit.experiment);
    let others = findings.of_tests(&SHAFT_TESTS).into_iter().filter(|e| e.file != fit.experiment.file);
    for other in others {
        let inputs = shaft_inputs(other, findings.bench, controller, torque_control);
        if let Ok(estimate) = inputs.and_then(|inputs| shaft::estimate_parameters(&inputs)) {
            fit.shaft.cross_checks.push((other.file.clone(), estimate));
            doubt_pulses(findings, other);
        }
    }
    doubt_shaft(findings, fit.experiment, &fit.shaft, fit.inertia);
}

/// Says where pulses fold onto what K is estimated from, which no residual shows: what folds goes with what it folds onto.
fn doubt_pulses(findings: &mut Findings<'_>, experiment: &Experiment) {
    let engine = findings.bench.engine();
    for role in [Role::DynoSpeed, Role::EngineSpeed] {
        let Some(speed) = experiment.signal(role) else { continue };
        if let Some(Folded { firing_hz, multiple }) = Folded::of(speed, engine.firings_per_turn()) {
            let finding = Finding::PulsesFoldToRest { role, rate_hz: 1.0 / speed.sample_time_s, firing_hz, multiple };
            findings.doubt(&experiment.file, Severity::Note, finding);
        }
    }
}

fn doubt_shaft(findings: &mut Findings<'_>, experiment: &Experiment, shaft: &Shaft, inertia: Option<(f64, f64)>) {
    let excluded = &shaft.residual_spectrum.excluded_hz;
    if !excluded.is_empty() {
        let finding = Finding::ExcludedLines { frequencies_hz: excluded.clone() };
        findings.doubt(&experiment.file, Severity::Note, finding);
    }
    doubt_inertias(findings, experiment, shaft, inertia);
    let checks: Vec<_> = ["K", "B"]
        .iter()
        .flat_map(|symbol| {
            let own = shaft.estimate.parameter(symbol);
            let others = shaft.cross_checks.iter().map(move |(file, e)| (file.clone(), e.parameter(symbol)));
            others.filter_map(move |(file, other)| Some((file, own?, other?)))
        })
        .filter(|(_, own, other)| {
            let spread = own.standard_error.hypot(other.standard_error);
            (own.value - other.value).abs() > 4.0 * spread
        })
        .map(|(file, own, other)| (file, own.clone(), other.clone()))
        .collect();
    for (file, own, other) in checks {
        let finding = Finding::RoutesDisagree {
            quantity: own.symbol,
            first: (own.value, own.standard_error),
            second: (other.value, other.standard_error),
        };
        findings.doubt(&file, Severity::Warning, finding);
    }
}

/// Compares the stated inertias with the recording that shows each best: that of the shaft, or one that shows both.
fn doubt_inertias(findings: &mut Findings<'_>, experiment: &Experiment, shaft: &Shaft, inertia: Option<(f64, f64)>) {
    let bench = findings.bench;
    let both = shaft.inertias.as_ref();
    let found = |symbol: &str| {
        both.and_then(|(file, e)| e.parameter(symbol).map(|p| (file.as_str(), (p.value, p.standard_error))))
    };
    let alone = inertia.map(|estimated| (experiment.file.as_str(), estimated));
    let better = |a: &(&str, (f64, f64)), b: &(&str, (f64, f64))| a.1.1.total_cmp(&b.1.1);
    if let Some((file, estimated)) = alone.into_iter().chain(found("J_d")).min_by(better) {
        let stated = (bench.dynamometer_inertia_kg_m2, bench.dynamometer_inertia_uncertainty_percent);
        doubt_inertia(findings, file, ("J_d", stated), estimated);
    }
    if let Some((file, estimated)) = found("J_e") {
        let stated = (bench.engine_inertia_kg_m2, bench.engine_inertia_uncertainty_percent);
        doubt_inertia(findings, file, ("J_e", stated), estimated);
    }
}

fn doubt_inertia(
    findings: &mut Findings<'_>,
    file: &str,
    (symbol, (given_kg_m2, uncertainty_percent)): (&str, (f64, Option<f64>)),
    (estimated_kg_m2, standard_error_kg_m2): (f64, f64),
) {
    let difference = (estimated_kg_m2 - given_kg_m2).abs();
    let spread = standard_error_kg_m2.hypot(uncertainty_percent.unwrap_or(0.0) / 100.0 * given_kg_m2);
    if difference > INERTIA_DOUBT.0 * spread && difference > INERTIA_DOUBT.1 * given_kg_m2 {
        let symbol = symbol.to_owned();
        let finding = Finding::ImplausibleInertia { symbol, given_kg_m2, estimated_kg_m2, standard_error_kg_m2 };
        let contradicts = difference > INERTIA_CONTRADICTED * given_kg_m2;
        findings.doubt(file, if contradicts { Severity::Error } else { Severity::Warning }, finding);
    }
}

/// Both inertias from the first recording in torque control that shows them.
fn inertias(
    candidates: &[&Experiment],
    bench: &BenchFile,
    controller: Option<&SpeedControllerFit>,
    torque_control: Option<&TorqueControlFit>,
) -> Option<(String, Estimate)> {
    candidates.iter().filter(|e| tells_inertias(e, bench)).find_map(|experiment| {
        let inputs = shaft_inputs(experiment, bench, controller, torque_control).ok()?;
        Some((experiment.file.clone(), both_inertias(experiment, &inputs, bench).ok()?))
    })
}
