//! Which parts an error concerns: they are struck, so that no number of theirs stands anywhere.

use rig::results::{Part, Quantity, Reason, Timing};
use rig::{Diagnostic, Experiment, Finding, Role, Severity};

use crate::findings::Findings;
use crate::fits::Fits;

/// Strikes every part that an error concerns, and every part that rests on one of these.
pub(super) fn strike(fits: &mut Fits, timing: &mut Result<Timing, Vec<Reason>>, findings: &mut Findings<'_>) {
    let on = |part: Part, errors: &[Reason]| if errors.is_empty() { None } else { Some(Reason::Part { part }) };
    let controller = errors_of(Part::SpeedController, findings);
    let torque_control = errors_of(Part::TorqueControl, findings);
    let mut feed_forward = errors_of(Part::FeedForward, findings);
    let mut shaft = errors_of(Part::Shaft, findings);
    feed_forward.extend(on(Part::SpeedController, &controller));
    shaft.extend(on(Part::TorqueControl, &torque_control));
    strike_one(&mut fits.controller, Part::SpeedController, controller, findings);
    strike_one(&mut fits.feed_forward, Part::FeedForward, feed_forward, findings);
    strike_one(&mut fits.torque_control, Part::TorqueControl, torque_control, findings);
    if let (false, Ok(fit), Some(recorded)) =
        (shaft.is_empty(), &mut fits.torque_control, fits.torque_control_as_recorded.take())
    {
        // The skew of T_d,calc is of a shaft that is struck.
        *fit = recorded;
    }
    strike_one(&mut fits.shaft, Part::Shaft, shaft, findings);
    if let Ok(shaft) = &mut fits.shaft {
        shaft.inertias.take_if(|(file, _)| has_error(findings, file, roles(Part::Shaft)));
    }
    let of_timing = errors_of(Part::Timing, findings);
    strike_one(timing, Part::Timing, of_timing, findings);
    if let Ok(timing) = timing {
        timing.delays.retain(|delay| !has_error(findings, &delay.stretch.file, &[delay.role]));
    }
}

fn strike_one<T>(
    estimated: &mut Result<T, Vec<Reason>>,
    part: Part,
    because: Vec<Reason>,
    findings: &mut Findings<'_>,
) {
    if estimated.is_ok() && !because.is_empty() {
        *estimated = Err(because);
        findings.forget_use(part);
    }
}

/// The errors that concern a part, a reason for each file that has one.
pub(super) fn errors_of(part: Part, findings: &Findings<'_>) -> Vec<Reason> {
    let files = findings.files_of(part);
    let is_from = |found: &Diagnostic| found.place.file.as_ref().is_some_and(|file| files.contains(file));
    let concerns = |found: &&Diagnostic| match &found.finding {
        Finding::SpeedsExchanged { .. } | Finding::TorquesExchanged { .. } => part != Part::Whole,
        Finding::ImplausibleInertia { inertia: Quantity::EngineInertia, .. } => part == Part::Whole,
        Finding::ImplausibleInertia { .. } => part == Part::Shaft,
        // A filter makes pulses weaker: of N_d, which the controller is from, or of N_e.
        Finding::PulsesOffShaft { ratio, .. } => {
            is_from(found) && (part == Part::Shaft || part == Part::SpeedController && *ratio < 1.0)
        }
        Finding::RoutesDisagree { quantity: Quantity::ProportionalGain | Quantity::IntegralGain, .. } => {
            matches!(part, Part::SpeedController | Part::FeedForward) && is_from(found)
        }
        Finding::FiringOrderDisagrees { .. } if found.place.file.is_none() => part == Part::Whole,
        _ => files.iter().any(|file| is_of(findings, found, file, roles(part))),
    };
    let mut reasons = Vec::new();
    for found in findings.diagnostics.iter().filter(|found| found.severity == Severity::Error).filter(concerns) {
        let reason = Reason::Error { file: found.place.file.clone() };
        if !reasons.contains(&reason) {
            reasons.push(reason);
        }
    }
    reasons
}

/// The signals whose errors concern a part.
pub(super) fn roles(part: Part) -> &'static [Role] {
    match part {
        Part::SpeedController | Part::FeedForward => &[Role::DynoSpeed, Role::DynoSpeedDemand, Role::DynoTorqueDemand],
        Part::TorqueControl => &[Role::DynoTorqueDemand, Role::AirGapTorque],
        Part::Timing => &[Role::DynoTorqueDemand],
        Part::Shaft => {
            &[Role::DynoSpeed, Role::EngineSpeed, Role::DynoTorqueDemand, Role::AirGapTorque, Role::FlangeTorque]
        }
        Part::Whole => &[],
    }
}

/// Tells whether no error concerns a signal of a recording that shows the shaft.
pub(super) fn is_sound(findings: &Findings<'_>, experiment: &Experiment) -> bool {
    !has_error(findings, &experiment.file, roles(Part::Shaft))
}

/// Tells whether an error concerns one of these signals of a recording.
pub(super) fn has_error(findings: &Findings<'_>, file: &str, roles: &[Role]) -> bool {
    let mut errors = findings.diagnostics.iter().filter(|found| found.severity == Severity::Error);
    errors.any(|found| is_of(findings, found, file, roles))
}

/// The same of one error. One about a channel that could not be used concerns nothing that was estimated.
fn is_of(findings: &Findings<'_>, found: &Diagnostic, file: &str, roles: &[Role]) -> bool {
    let experiment = findings.experiments.iter().find(|experiment| experiment.file == file);
    let Some(experiment) = experiment.filter(|_| found.place.file.as_deref() == Some(file)) else { return false };
    let Some(channel) = &found.place.channel else { return true };
    let of_channel = |role: &&Role| findings.bench.channels.get(role).is_some_and(|mapping| &mapping.name == channel);
    roles.iter().filter(of_channel).any(|role| experiment.signal(*role).is_some())
}
