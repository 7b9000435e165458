//! Speed control, feed-forward, torque control.

use rig::Role;
use rig::results::{Estimate, Parameter, Part, Quantity, ResidualTest, SpeedController, TorqueControl, Validation};

use super::grade::Grade;
use super::graded::{grade, of_part, recording, sources};
use super::result::{Known, Subject};
use super::why::Why;
use crate::{Analyses, Study};

/// PI and delay.
pub(super) fn speed_controller(study: &Study, analyses: Option<&Analyses>) -> Vec<Known> {
    of_part(Part::SpeedController, &study.speed_controller, |part| {
        let beyond = analyses.and_then(beyond_pi);
        let known = |quantity: &Quantity| {
            let own = part.estimate.parameter(*quantity)?;
            let mut why = judged(study, &part.estimate, &part.validation);
            why.extend(match quantity {
                Quantity::ControllerDelay => delay_seen(part),
                Quantity::ProportionalGain => Some(Why::IntegrationRule),
                _ => None,
            });
            why.extend(beyond.clone());
            Some(Known::of(own, with_residuals(grade(study, own), &part.validation), why))
        };
        [Quantity::ProportionalGain, Quantity::IntegralGain, Quantity::ControllerDelay]
            .iter()
            .filter_map(known)
            .collect()
    })
}

/// How an estimate came about, and what it makes of data it has not seen.
fn judged(study: &Study, estimate: &Estimate, validation: &Validation) -> Vec<Why> {
    let mut why = vec![
        sources(study, estimate),
        Why::HeldOut { signal: validation.quantity.clone(), fit_percent: validation.fit_percent },
    ];
    let dependent = validation.residuals.as_ref().filter(|test| test.depends_on_input());
    why.extend(dependent.map(|test| Why::DependsOn(test.input.clone())));
    why
}

fn with_residuals(grade: Grade, validation: &Validation) -> Grade {
    if validation.residuals.as_ref().is_some_and(ResidualTest::depends_on_input) { grade.contradicted() } else { grade }
}

/// Verdict of the residuals of the held-out stretch on the delay; nothing where they were not tested.
fn delay_seen(part: &SpeedController) -> Option<Why> {
    let (without, with) = (part.without_delay.residuals.as_ref()?, part.validation.residuals.as_ref()?);
    match (without.depends_on_input(), with.depends_on_input()) {
        (true, false) => Some(Why::DelaySeen { input: with.input.clone(), share: without.share_outside() }),
        (false, false) => Some(Why::DelayNotSeen(with.input.clone())),
        (_, true) => None,
    }
}

/// The terms found beyond PI and delay, in the longest recording that shows them.
fn beyond_pi(found: &Analyses) -> Option<Why> {
    let mut all = found.speed_control.controllers.iter();
    let found = all.find_map(|one| one.found.estimated()?.structure.estimated())?;
    Some(Why::BeyondPi { level: found.level, terms: found.found(), left_rad_s: found.left_rad_s })
}

/// k, k_a, and m, which no recording shows.
pub(super) fn feed_forward(study: &Study, analyses: Option<&Analyses>) -> Vec<Known> {
    of_part(Part::FeedForward, &study.feed_forward, |part| {
        let beyond = analyses.and_then(|found| {
            let mut all = found.speed_control.feed_forward.iter();
            all.find_map(|one| one.found.estimated()?.terms.estimated()).map(|terms| terms.found())
        });
        let known = |quantity: &Quantity| {
            let own = part.estimate.parameter(*quantity)?;
            let mut why = judged(study, &part.estimate, &part.validation);
            why.push(Why::PiAlone(part.pi_alone.fit_percent));
            why.extend(beyond.clone().map(Why::BeyondFeedForward));
            Some(Known::of(own, with_residuals(grade(study, own), &part.validation), why))
        };
        let constant = Known::not_at_all(Subject::FeedForwardConstant, Why::ConstantInInitialState);
        [Quantity::SpeedFeedForward, Quantity::AccelerationFeedForward]
            .iter()
            .filter_map(known)
            .chain([constant])
            .collect()
    })
}

/// The total delay of the torque control, and delay and lag one by one.
pub(super) fn torque_control(study: &Study, analyses: Option<&Analyses>) -> Vec<Known> {
    of_part(Part::TorqueControl, &study.torque_control, |part| {
        let known = |quantity: &Quantity| {
            let own = part.delay_and_lag.parameter(*quantity)?;
            let validation = &part.delay_and_lag_validation;
            let mut why = judged(study, &part.delay_and_lag, validation);
            why.push(Why::DelayAlone(part.pure_delay_validation.fit_percent));
            if own.quantity != Quantity::TorqueControlBandwidth {
                let delay = part.delay_and_lag.parameter(Quantity::TorqueControlDelay).cloned();
                why.push(Why::ClockOfDelay { skew: part.torque_skew.clone(), delay });
            }
            why.extend((own.interval.1 < 0.0).then(|| Why::BeforeDemand(own.clone())));
            why.extend(sampling(study, part, own));
            why.extend(analyses.and_then(|found| {
                let studied = found.torque_control.as_ref().ok()?;
                Some(Why::SecondOrder(studied.recordings.first()?.second_order))
            }));
            Some(Known {
                subject: Subject::OfTorqueControl(own.quantity),
                ..Known::of(own, with_residuals(grade(study, own), validation), why)
            })
        };
        [Quantity::TorqueControlTotalDelay, Quantity::TorqueControlDelay, Quantity::TorqueControlBandwidth]
            .iter()
            .filter_map(known)
            .collect()
    })
}

/// How the lag compares with the time between samples of T_d,calc.
fn sampling(study: &Study, part: &TorqueControl, own: &Parameter) -> Option<Why> {
    if own.quantity == Quantity::TorqueControlTotalDelay {
        return None;
    }
    let lag_s = 1.0 / part.delay_and_lag.parameter(Quantity::TorqueControlBandwidth)?.value;
    let file = &part.delay_and_lag.stretches.first()?.file;
    let times = &recording(study, file)?.sample_times_s;
    let (_, sample_s) = *times.iter().find(|(role, _)| *role == Role::AirGapTorque)?;
    (lag_s < sample_s).then_some(Why::LagBelowSample { lag_s, sample_s })
}
