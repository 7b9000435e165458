//! Speed control, feed-forward, torque control.

use rig::Role;
use rig::results::{Estimate, Parameter, Quantity, ResidualTest, SpeedController, TorqueControl, Validation};
use study::{Analyses, Study};

use super::grade::{Grade, Known, grade, of_part, recording, source};
use crate::controller;
use crate::torque;
use crate::torque_control;
use crate::wording::{self, number};

/// PI and delay.
pub(super) fn speed_controller(study: &Study, analyses: Option<&Analyses>) -> Vec<Known> {
    of_part(&study.speed_controller, "K_p, K_i, τ", "speed controller", |part| {
        let beside = analyses.and_then(beside_pi);
        let known = |quantity: &Quantity| {
            let own = part.estimate.parameter(*quantity)?;
            let mut why = judged(study, &part.estimate, &part.validation);
            why.push(match quantity {
                Quantity::ControllerDelay => delay_seen(part),
                Quantity::ProportionalGain => "The recordings cannot show which integration rule the controller uses; with another rule K_p would be less, by at \
                          most K_i times the sample time."
                    .to_owned(),
                _ => String::new(),
            });
            why.extend(beside.clone());
            why.retain(|text| !text.is_empty());
            Some(Known::of(own, with_residuals(grade(study, own), &part.validation), why))
        };
        [Quantity::ProportionalGain, Quantity::IntegralGain, Quantity::ControllerDelay]
            .iter()
            .filter_map(known)
            .collect()
    })
}

/// How an estimate came about, and what it makes of data it has not seen.
fn judged(study: &Study, estimate: &Estimate, validation: &Validation) -> Vec<String> {
    let mut why = vec![source(study, estimate)];
    why.push(format!(
        "On data it has not seen it follows {} with a fit of {}.",
        validation.quantity,
        number::fit(validation.fit_percent)
    ));
    if let Some(test) = &validation.residuals
        && test.depends_on_input()
    {
        why.push(format!("What it leaves still depends on {}: something is missing in the model.", test.input));
    }
    why
}

fn with_residuals(grade: Grade, validation: &Validation) -> Grade {
    if validation.residuals.as_ref().is_some_and(ResidualTest::depends_on_input) { grade.contradicted() } else { grade }
}

/// Verdict of the residuals of the held-out stretch on the delay; nothing where they were not tested.
fn delay_seen(part: &SpeedController) -> String {
    let (Some(without), Some(with)) = (&part.without_delay.residuals, &part.validation.residuals) else {
        return String::new();
    };
    match (without.depends_on_input(), with.depends_on_input()) {
        (true, false) => format!(
            "Without the delay, what PI leaves depends on {} at {} of the lags; with the delay it does not.",
            with.input,
            number::share(without.share_outside())
        ),
        (false, false) => {
            format!("With the delay and without it, what PI leaves does not depend on {}.", with.input)
        }
        (_, true) => String::new(),
    }
}

/// The terms found beyond PI and delay, in the longest recording that shows them.
fn beside_pi(found: &Analyses) -> Option<String> {
    let all = found.speed_control.controllers.iter();
    all.filter_map(|one| one.found.estimated()?.structure.estimated()).next().map(controller::structure)
}

/// k, k_a, and m, which no recording shows.
pub(super) fn feed_forward(study: &Study, analyses: Option<&Analyses>) -> Vec<Known> {
    of_part(&study.feed_forward, "k, k_a", "feed-forward", |part| {
        let bends = analyses.and_then(|found| {
            let all = found.speed_control.feed_forward.iter();
            all.filter_map(|one| one.found.estimated()?.terms.estimated()).next().map(controller::bends)
        });
        let known = |quantity: &Quantity| {
            let own = part.estimate.parameter(*quantity)?;
            let mut why = judged(study, &part.estimate, &part.validation);
            why.push(format!("PI alone follows the same stretch with {}.", number::fit(part.pi_alone.fit_percent)));
            why.extend(bends.clone());
            Some(Known::of(own, with_residuals(grade(study, own), &part.validation), why))
        };
        let why = vec![controller::M_IS_NOT_SHOWN.to_owned()];
        let m = Known::new("m", "constant part of the feed-forward", Grade::NotAtAll, "–".to_owned(), why);
        [Quantity::SpeedFeedForward, Quantity::AccelerationFeedForward].iter().filter_map(known).chain([m]).collect()
    })
}

/// The total delay of the torque control, and delay and lag one by one.
pub(super) fn torque_control(study: &Study, analyses: Option<&Analyses>) -> Vec<Known> {
    of_part(&study.torque_control, "τ, a", "torque control", |part| {
        let known = |quantity: &Quantity| {
            let own = part.delay_and_lag.parameter(*quantity)?;
            let validation = &part.delay_and_lag_validation;
            let mut why = judged(study, &part.delay_and_lag, validation);
            why.push(format!(
                "A delay alone follows the same stretch with {}.",
                number::fit(part.pure_delay_validation.fit_percent)
            ));
            if own.quantity != Quantity::TorqueControlBandwidth {
                why.push(torque::clock_of_delay(part));
            }
            why.extend(torque::early(own.quantity.symbol(), own).map(|text| text + "."));
            why.extend(sampling(study, part, own));
            why.extend(analyses.and_then(|found| {
                let studied = found.torque_control.as_ref().ok()?;
                Some(wording::capitalised(&torque_control::beyond(studied.recordings.first()?)) + ".")
            }));
            Some(Known {
                name: format!("torque control: {}", own.quantity.name()),
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
fn sampling(study: &Study, part: &TorqueControl, own: &Parameter) -> Option<String> {
    if own.quantity == Quantity::TorqueControlTotalDelay {
        return None;
    }
    let lag_s = 1.0 / part.delay_and_lag.parameter(Quantity::TorqueControlBandwidth)?.value;
    let file = &part.delay_and_lag.stretches.first()?.file;
    let times = &recording(study, file)?.sample_times_s;
    let (_, sample_s) = times.iter().find(|(role, _)| *role == Role::AirGapTorque)?;
    (lag_s < *sample_s).then(|| {
        format!(
            "The lag of {} is shorter than the {} between samples of T_d,calc, so the sum of delay and lag is known better than each alone.",
            number::duration(lag_s),
            number::duration(*sample_s)
        )
    })
}
