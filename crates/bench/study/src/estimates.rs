//! Which recording serves which estimate, and what is missing where none does.

use std::sync::Arc;

use bench_model::analysis::WholeModel;
use bench_model::drive_ripple::RecordedTorque;
use bench_model::model::AssembledModel;
use bench_model::replay::Replay;
use bench_model::skews::SignalSkews;
use numerics::order::upper_median;
use numerics::parallel::map;
use part_controller::speed_controller::{GAINS_APART_STANDARD_ERRORS, SpeedControllerFit};
use part_engine::folded_pulses::Folded;
use part_engine::pulse_path::Answer;
use part_shaft::{Parts, shaft};
use part_torque::timing;
use rig::estimation::{EstimateError, first};
use rig::experiment::{Choice, Sought};
use rig::facts::StatedInertia;
use rig::results::{
    Estimate, FeedForward, Outcome, Parameter, Part, Quantity, Reason, Shaft, SpeedController, Timing, TorqueControl,
};
use rig::{Experiment, Finding, Role, Severity};

use crate::findings::Findings;
use crate::fits::Fits;
use crate::whole::{self, Whole};
use crate::{clocks_and_pulses, struck};

/// The channels of the speeds are exchanged if the shaft's equation leaves this many times less with exchanged speeds.
/// Rightly named speeds have 10⁻³ and exchanged ones 10³; with a dual-mass flywheel, which the equation lacks, 0.3 and
/// 9.
const EXCHANGED: f64 = 3.0;
/// Two values this many standard errors of their difference apart contradict each other.
const APART: f64 = 4.0;
/// Contradictions of K and of B that are worth a warning, as a share; smaller ones are in the intervals, and noted.
/// Slow rasters may make each recording wrong by half of it.
const MATTERS: [(Quantity, f64); 2] = [(Quantity::Stiffness, 0.04), (Quantity::Damping, 0.2)];
/// A signal is late if the shaft's equation dates it so far from its stamps, s, ...
const LATE_S: f64 = 2e-3;
/// ... and so many standard errors. The two clocks of a bench are apart by 1.5 ms at most.
const LATE_STANDARD_ERRORS: f64 = 5.0;
/// A recording that moves J_d by more than this many of its stated standard uncertainties checks no other one. In speed
/// control T_d follows N_d, and noise on a slow T_d,calc then bends all of J_d, K and the skews together.
const MOVED: f64 = 3.0;
/// Disagreement, as a share, beyond which the stated inertia is wrong rather than doubtful: K and B scale with it.
const INERTIA_CONTRADICTED: f64 = 0.3;

/// Gains that differ by this part of the smaller are of another controller, or of another bench, or in another scale.
/// Terms beside PI, such as a filter on N_d*, change what recordings with a moving N_d* give by 20 % and less, which is
/// 25 % of the smaller.
const OTHER_GAINS: f64 = 0.27;

/// Everything that was estimated.
pub(super) struct Estimates {
    pub(super) choices: Vec<Choice>,
    pub(super) timing: Outcome<Timing>,
    pub(super) speed_controller: Outcome<SpeedController>,
    pub(super) feed_forward: Outcome<FeedForward>,
    pub(super) torque_control: Outcome<TorqueControl>,
    pub(super) shaft: Outcome<Shaft>,
    pub(super) whole: Outcome<WholeModel>,
    pub(super) model: Option<AssembledModel>,
    pub(super) skews: Option<SignalSkews>,
    pub(super) recorded_torque: Option<RecordedTorque>,
    pub(super) replays: Vec<Replay>,
}

/// Estimates every part the recordings allow, checks one recording by another, and replays the model.
pub(super) fn all(findings: &mut Findings<'_>, parts: &Parts<'_>) -> Estimates {
    let mut fits = Fits::of(parts, findings.context);
    for choice in &fits.choices {
        findings.note_use(choice);
    }
    let comparing = findings.context.step("comparing the recordings", 0);
    doubt_controllers(findings, parts, &mut fits);
    let pulses = clocks_and_pulses::doubt_firing(findings);
    clocks_and_pulses::doubt_clocks(findings, &pulses);
    doubt_exchange(findings, parts);
    let mut timing = timing(findings, parts);
    if let (Ok(shaft), Ok(chosen)) = (&mut fits.shaft, parts.chosen_shaft()) {
        let answer = Answer::of(fits.controller.as_ref().ok(), fits.torque_control.as_ref().ok());
        clocks_and_pulses::doubt_pulse_path(findings, &parts.experiments, shaft, answer);
        cross_check(findings, parts, shaft, chosen.experiment);
    }
    drop(comparing);
    struck::strike(&mut fits, &mut timing, findings);
    let Whole { model, analysis } = match struck::errors_of(Part::Whole, findings) {
        because if because.is_empty() => fits.pieces().map_or_else(Whole::missing, |p| whole::assemble(findings, &p)),
        because => Whole { model: None, analysis: Err(because) },
    };
    let replays = match (&model, fits.pieces()) {
        (Some(assembled), Some(pieces)) => whole::replays(findings, &pieces, &assembled.model),
        _ => Vec::new(),
    };
    let skews = fits.pieces().map(|pieces| pieces.skews());
    let recorded_torque = fits.pieces().and_then(|pieces| pieces.recorded_torque());
    Estimates {
        skews,
        recorded_torque,
        choices: fits.choices,
        timing: timing.into(),
        speed_controller: fits.controller.map(|c| c.result).into(),
        feed_forward: fits.feed_forward.into(),
        torque_control: fits.torque_control.map(|t| t.result).into(),
        shaft: fits.shaft.into(),
        whole: analysis.into(),
        model,
        replays,
    }
}

/// The doubts about speed controller, feed-forward and torque control.
fn doubt_controllers(findings: &mut Findings<'_>, parts: &Parts<'_>, fits: &mut Fits) {
    if let Ok(fit) = &mut fits.controller {
        doubt_gains(findings, parts, fit);
        findings.doubt_residuals(Part::SpeedController, &fit.result.validation);
        doubt_smoothing(findings, fit);
        if let Some(step) = fit.coarse_demand_nm {
            let finding = Finding::CoarseResolution { role: Role::DynoTorqueDemand, step };
            findings.doubt(&fit.result.validation.stretch.file, Severity::Note, finding);
        }
    }
    if let Ok(feed_forward) = &fits.feed_forward {
        findings.doubt_residuals(Part::FeedForward, &feed_forward.validation);
    }
    if let Ok(fit) = &fits.torque_control {
        findings.diagnostics.extend(fit.diagnostics.iter().cloned());
        // The shortest lag that the data allow: a lag that they do not show is none.
        let bandwidth = fit.result.delay_and_lag.parameter(Quantity::TorqueControlBandwidth);
        clocks_and_pulses::doubt_demand_clock(
            findings,
            bandwidth.filter(|_| fit.has_lag()).map_or(0.0, |a| 1.0 / a.interval.1),
        );
    }
}

/// Doubts N_d of the speed controller's recording where it is smoother than an encoder makes it.
fn doubt_smoothing(findings: &mut Findings<'_>, controller: &SpeedControllerFit) {
    let file = &controller.result.validation.stretch.file;
    let of = findings.experiments.iter().find(|experiment| &experiment.file == file);
    let Some(sample_time_s) = of.and_then(|one| one.signal(Role::DynoSpeed)).map(|speed| speed.sample_time_s) else {
        return;
    };
    if controller.encoder.is_behind_a_filter(sample_time_s) {
        let finding = Finding::SpeedSmoothed { mean_s: controller.encoder.gate_s, sample_time_s };
        findings.doubt_channel(file, Role::DynoSpeed, finding);
    }
}

/// Doubts the recordings that contradict each other in the gains of the speed controller: the one that it is from where
/// most of the others give other gains, else these. The intervals cover what the others give.
fn doubt_gains(findings: &mut Findings<'_>, parts: &Parts<'_>, controller: &mut SpeedControllerFit) {
    let own = controller.result.validation.stretch.file.clone();
    let mut others = Sought::FeedForward.candidates(&parts.experiments);
    others.retain(|other| other.file != own);
    let of_others: Vec<OtherGain> = others.iter().flat_map(|other| other_gains(parts, other, controller)).collect();
    let found: Vec<_> = others.iter().map(|other| parts.controllers.feed_forward(other, controller)).collect();
    cover_other_gains(findings, &mut controller.result.estimate, &of_others);
    let agreeing = found.iter().filter(|one| one.is_ok()).count();
    let contradictions = found.into_iter().filter_map(|one| match one {
        Err(EstimateError::Contradiction { file, quantity, here, known }) => {
            Some((file, Finding::RoutesDisagree { quantity, first: known, second: here }))
        }
        _ => None,
    });
    let contradictions: Vec<(String, Finding)> = contradictions.collect();
    let of_own = contradictions.len() > agreeing;
    for (file, finding) in contradictions {
        let apart = |first: f64, second: f64| (second - first).abs() > OTHER_GAINS * first.abs().min(second.abs());
        let is_other = matches!(finding, Finding::RoutesDisagree { first, second, .. } if apart(first.0, second.0));
        let severity = if is_other { Severity::Error } else { Severity::Warning };
        findings.doubt(if of_own { &own } else { &file }, severity, finding);
    }
}

/// A gain of the controller as another recording gives it, with its standard error.
struct OtherGain {
    file: String,
    quantity: Quantity,
    gain: (f64, f64),
    /// True where the recording is refused, and warned of.
    is_refused: bool,
}

impl OtherGain {
    fn is_apart(&self, known: &Parameter) -> bool {
        (self.gain.0 - known.value).abs() > GAINS_APART_STANDARD_ERRORS * self.gain.1.hypot(known.standard_error)
    }
}

/// K_p and K_i as another recording gives them.
fn other_gains(parts: &Parts<'_>, other: &Experiment, controller: &SpeedControllerFit) -> Vec<OtherGain> {
    let gains = parts.controllers.gains(other, controller).map_or_else(|_| Vec::new(), |gains| gains.parameters);
    let is_refused = parts.controllers.feed_forward(other, controller).is_err();
    let of = |gain: Parameter| {
        let Parameter { quantity, value, standard_error, .. } = gain;
        OtherGain { file: other.file.clone(), quantity, gain: (value, standard_error), is_refused }
    };
    gains.into_iter().map(of).collect()
}

/// Widens the intervals of K_p and K_i to what contradicts them, and notes it, where half or more of the other
/// recordings do: nothing shows which of them is right. Both move together, as the scale of the torques moves them.
fn cover_other_gains(findings: &mut Findings<'_>, own: &mut Estimate, others: &[OtherGain]) {
    let mut distance = |known: &Parameter| {
        let all: Vec<&OtherGain> = others.iter().filter(|other| other.quantity == known.quantity).collect();
        let far: Vec<&&OtherGain> = all.iter().filter(|other| other.is_apart(known)).collect();
        if 2 * far.len() < all.len() {
            return 0.0;
        }
        for other in far.iter().filter(|other| !other.is_refused) {
            let first = (known.value, known.standard_error);
            let finding = Finding::RoutesDisagree { quantity: known.quantity, first, second: other.gain };
            findings.doubt(&other.file, Severity::Note, finding);
        }
        let mut distances: Vec<f64> = far.iter().map(|other| other.gain.0 - known.value).collect();
        upper_median(&mut distances).unwrap_or(0.0)
    };
    let moves: Vec<f64> = own.parameters.iter().map(&mut distance).collect();
    own.add_moves(&moves);
}

/// Doubts the channels of the speeds where the first recording that the shaft was sought in explains more with them
/// exchanged.
fn doubt_exchange(findings: &mut Findings<'_>, parts: &Parts<'_>) {
    let chosen = parts.chosen_shaft().ok().map(|chosen| chosen.experiment.file.as_str());
    for experiment in Sought::Shaft.candidates(&parts.experiments) {
        let ratio = parts.shaft_inputs(experiment).and_then(|inputs| shaft::checks::gain_by_exchange(&inputs)).ok();
        if let Some(misfit_ratio) = ratio.filter(|ratio| *ratio > EXCHANGED) {
            findings.doubt(&experiment.file, Severity::Error, Finding::SpeedsExchanged { misfit_ratio });
            return;
        }
        if chosen == Some(experiment.file.as_str()) {
            return;
        }
    }
}

fn timing(findings: &mut Findings<'_>, parts: &Parts<'_>) -> Result<Timing, Vec<Reason>> {
    let _step = findings.context.step("estimating: timing of the signals", 0);
    let inertia = findings.bench.dynamometer_inertia_kg_m2;
    let torque_control = parts.torque_controls.best();
    let found =
        first(Sought::Timing, &parts.experiments, |e| timing::estimate(&[e], torque_control, inertia).map(Arc::new))?;
    findings.note_use(&found.choice);
    Ok(found.fit.as_ref().clone())
}

/// Adds the estimates of the shaft from other recordings, and notes the doubts about it.
fn cross_check(findings: &mut Findings<'_>, parts: &Parts<'_>, shaft: &mut Shaft, experiment: &Experiment) {
    doubt_pulses(findings, experiment);
    let mut others = Sought::Shaft.candidates(&parts.experiments);
    let is_sound = |other: &&Experiment| !struck::has_error(findings, &other.file, struck::roles(Part::Shaft));
    others.retain(|other| other.file != experiment.file && is_sound(other));
    let estimates = map(&others, |other| parts.shaft_of_whole(other).ok());
    let mut moved = Vec::new();
    for (other, estimate) in others.into_iter().zip(estimates) {
        let Some(estimate) = estimate else { continue };
        doubt_pulses(findings, other);
        match impossible(&estimate, findings.bench.dynamometer_inertia()) {
            Some(found) => {
                if found.quantity == Quantity::DynoInertia {
                    moved.push((other.file.as_str(), found.clone()));
                }
                match other_scale(&shaft.estimate, &estimate) {
                    Some(scale) => findings.doubt(&other.file, Severity::Warning, scale),
                    None => findings.doubt(&other.file, Severity::Note, no_check(found)),
                }
            }
            None => shaft.cross_checks.push((other.file.clone(), estimate.as_ref().clone())),
        }
    }
    let inertia = parts.shaft_inputs(experiment).and_then(|inputs| shaft::checks::inertia(&inputs));
    let own = inertia.ok().flatten().map(|estimated| (experiment.file.as_str(), estimated));
    let of_inertia = doubt_shaft(findings, experiment, shaft, own.or_else(|| agreed(&moved)));
    cover_contradictions(shaft, of_inertia.max(torque_error(parts)));
}

/// J_d that several recordings show alike, although the bench file states another: the best known of them, and the file
/// that it is from.
fn agreed<'a>(moved: &[(&'a str, Parameter)]) -> Option<(&'a str, (f64, f64))> {
    let (file, best) = moved.iter().min_by(|a, b| a.1.standard_error.total_cmp(&b.1.standard_error))?;
    let agree = moved.len() > 1 && moved.iter().all(|(_, other)| !contradict(best, other));
    agree.then_some((*file, (best.value, best.standard_error)))
}

/// Value that the bench cannot have, although a recording gives it: a skew, or another inertia than the stated one.
fn impossible(estimate: &Estimate, stated: StatedInertia) -> Option<&Parameter> {
    let is_moved = |j: &&Parameter| (j.value - stated.kg_m2).abs() > MOVED * stated.standard_uncertainty_kg_m2();
    let moved = || estimate.parameter(Quantity::DynoInertia).filter(is_moved);
    late(estimate).next().map(|(_, skew)| skew).or_else(moved)
}

/// That the torques of a recording have another scale than those of the shaft's own: J_d and K differ by one factor.
fn other_scale(own: &Estimate, other: &Estimate) -> Option<Finding> {
    let [(inertia, theirs), (stiffness, their_stiffness)] = [
        (own.parameter(Quantity::DynoInertia)?, other.parameter(Quantity::DynoInertia)?),
        (own.parameter(Quantity::Stiffness)?, other.parameter(Quantity::Stiffness)?),
    ];
    let error = |of: &Parameter| of.standard_error / of.value;
    let all = [inertia, theirs, stiffness, their_stiffness].map(error);
    let between = (their_stiffness.value / stiffness.value) / (theirs.value / inertia.value) - 1.0;
    let is_one_factor = between.abs() < APART * all.iter().map(|error| error * error).sum::<f64>().sqrt();
    (is_one_factor && contradict(inertia, theirs)).then_some(Finding::RoutesDisagree {
        quantity: Quantity::DynoInertia,
        first: (inertia.value, inertia.standard_error),
        second: (theirs.value, theirs.standard_error),
    })
}

fn no_check(found: &Parameter) -> Finding {
    let Parameter { quantity, value, standard_error, .. } = *found;
    Finding::NoCheckOfShaft { quantity, value, standard_error }
}

/// By how large a part of itself T_d differs from what T_d* demands, where that is worth a warning. K and B are
/// proportional to T_d.
fn torque_error(parts: &Parts<'_>) -> f64 {
    let gain = |finding: &Finding| match finding {
        Finding::RoutesDisagree { quantity: Quantity::TorqueControlGain, first, .. } => Some((first.0 - 1.0).abs()),
        _ => None,
    };
    let fit = parts.torque_controls.best();
    fit.and_then(|fit| fit.diagnostics.iter().find_map(|one| gain(&one.finding))).unwrap_or(0.0)
}

/// Says where pulses fold onto what K is estimated from, which no residual shows: what folds goes with what it folds
/// onto.
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

/// By how large a part of itself J_d is contradicted, zero where it is not.
fn doubt_shaft(
    findings: &mut Findings<'_>,
    experiment: &Experiment,
    shaft: &Shaft,
    inertia: Option<(&str, (f64, f64))>,
) -> f64 {
    let excluded = &shaft.residual_spectrum.excluded_hz;
    if !excluded.is_empty() {
        let finding = Finding::ExcludedLines { frequencies_hz: excluded.clone() };
        findings.doubt(&experiment.file, Severity::Note, finding);
    }
    for (quantity, matters) in MATTERS {
        let Some(own) = shaft.estimate.parameter(quantity) else { continue };
        for (file, other) in &shaft.cross_checks {
            let Some(other) = other.parameter(quantity).filter(|other| contradict(own, other)) else { continue };
            let finding = Finding::RoutesDisagree {
                quantity,
                first: (own.value, own.standard_error),
                second: (other.value, other.standard_error),
            };
            let is_large = (own.value - other.value).abs() > matters * own.value.abs();
            findings.doubt(file, if is_large { Severity::Warning } else { Severity::Note }, finding);
        }
    }
    doubt_late_signals(findings, experiment, shaft);
    doubt_inertias(findings, shaft, inertia)
}

/// Tells whether two values of one quantity are further apart than their errors explain.
fn contradict(own: &Parameter, other: &Parameter) -> bool {
    (own.value - other.value).abs() > APART * own.standard_error.hypot(other.standard_error)
}

/// Doubts signals that the shaft's equation dates far from where their time stamps do.
fn doubt_late_signals(findings: &mut Findings<'_>, experiment: &Experiment, shaft: &Shaft) {
    for (role, skew) in late(&shaft.estimate) {
        let (late_s, standard_error_s) = (skew.value, skew.standard_error);
        findings.doubt_channel(&experiment.file, role, Finding::LateSignal { role, late_s, standard_error_s });
    }
}

/// Signals dated far from where their time stamps do, with their skew.
fn late(estimate: &Estimate) -> impl Iterator<Item = (Role, &Parameter)> {
    let skews = [(Role::EngineSpeed, Quantity::EngineSpeedSkew), (Role::AirGapTorque, Quantity::AirGapTorqueSkew)];
    let found = skews.into_iter().filter_map(|(role, quantity)| Some((role, estimate.parameter(quantity)?)));
    found.filter(|(_, skew)| skew.value.abs() > LATE_S.max(LATE_STANDARD_ERRORS * skew.standard_error))
}

/// Widens the intervals of K and B by what contradicts them: they are proportional to T_d, which may be wrong where J_d
/// or T_d* and the data disagree; where half or more of the other recordings give another value, nothing shows which of
/// them is right.
fn cover_contradictions(shaft: &mut Shaft, of_torque: f64) {
    for quantity in [Quantity::Stiffness, Quantity::Damping] {
        let Some(own) = shaft.estimate.parameter(quantity).cloned() else { continue };
        let others = shaft.cross_checks.iter().filter_map(|(_, other)| other.parameter(quantity));
        let apart = |other: &Parameter| (own.value - other.value).abs();
        let all: Vec<&Parameter> = others.collect();
        let contradicting = all.iter().filter(|other| contradict(&own, other));
        let mut distances: Vec<f64> = contradicting.map(|other| apart(other)).collect();
        let by_others =
            if 2 * distances.len() >= all.len() { upper_median(&mut distances).unwrap_or(0.0) } else { 0.0 };
        let uncovered = by_others.max(of_torque * own.value.abs());
        if uncovered > 0.0 {
            shaft.estimate.add_systematic(&[quantity], uncovered);
        }
    }
}

/// Compares the stated inertias with the recording that shows each best: that of the shaft, or one that shows both.
/// By how large a part of itself J_d is contradicted, zero where it is not.
fn doubt_inertias(findings: &mut Findings<'_>, shaft: &Shaft, inertia: Option<(&str, (f64, f64))>) -> f64 {
    let bench = findings.bench;
    let both = shaft.inertias.as_ref();
    let found = |quantity| {
        both.and_then(|(file, e)| e.parameter(quantity).map(|p| (file.as_str(), (p.value, p.standard_error))))
    };
    let better = |a: &(&str, (f64, f64)), b: &(&str, (f64, f64))| a.1.1.total_cmp(&b.1.1);
    let mut contradiction = 0.0;
    if let Some((file, estimated)) = inertia.into_iter().chain(found(Quantity::DynoInertia)).min_by(better) {
        contradiction = doubt_inertia(findings, file, Quantity::DynoInertia, bench.dynamometer_inertia(), estimated);
    }
    if let Some((file, estimated)) = found(Quantity::EngineInertia) {
        doubt_inertia(findings, file, Quantity::EngineInertia, bench.engine_inertia(), estimated);
    }
    contradiction
}

/// By how large a part of itself an estimate contradicts the stated value, zero where it does not.
fn doubt_inertia(
    findings: &mut Findings<'_>,
    file: &str,
    inertia: Quantity,
    stated: StatedInertia,
    (estimated_kg_m2, standard_error_kg_m2): (f64, f64),
) -> f64 {
    let Some(share) = stated.contradicted_by(estimated_kg_m2, standard_error_kg_m2) else { return 0.0 };
    let given_kg_m2 = stated.kg_m2;
    let finding = Finding::ImplausibleInertia { inertia, given_kg_m2, estimated_kg_m2, standard_error_kg_m2 };
    let severity = if share > INERTIA_CONTRADICTED { Severity::Error } else { Severity::Warning };
    findings.doubt(file, severity, finding);
    share
}
