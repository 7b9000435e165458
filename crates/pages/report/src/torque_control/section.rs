//! Torque control in the report of a study.

use page::{Block, Blocks};
use rig::results::{Estimate, Outcome, Quantity, TorqueControl};
use study::Study;

use crate::estimates::{fit_line, lead, not_estimated, parameters};
use crate::plots::{comparison, residual_test};
use crate::torque;
use crate::wording::number;

/// Meaning of a delay below zero, where one is.
fn early(estimate: &Estimate) -> Blocks {
    let said = torque::early_delays(&estimate.parameters);
    said.iter().map(|text| Block::paragraph(format!("{text}."))).collect()
}

/// Torque control: delay alone, and delay with lag.
pub(crate) fn section(study: &Study) -> Blocks {
    let what = "How the air-gap torque T_d follows its demand T_d*.";
    let part: &TorqueControl = match &study.torque_control {
        Outcome::Estimated(part) => part,
        Outcome::NotEstimated { needs } => return not_estimated(what, needs),
    };
    let equation = "T_d = e^(−s τ) {a}/{s + a} T_d*";
    let bar = format!(
        "The reference is a delay alone: on the same stretch it has a fit of {}, delay and lag have {}.",
        number::fit(part.pure_delay_validation.fit_percent),
        number::fit(part.delay_and_lag_validation.fit_percent)
    );
    let title = "Torque control on the held-out stretch";
    let all: Vec<Blocks> = vec![
        lead(what, equation),
        Block::paragraph(torque::clock_of_delay(
            part.torque_skew.as_ref(),
            part.delay_and_lag.parameter(Quantity::TorqueControlDelay),
        ))
        .into(),
        Block::heading("Delay and lag").into(),
        parameters(&part.delay_and_lag, &[]),
        early(&part.delay_and_lag),
        Block::heading("Delay alone").into(),
        parameters(&part.pure_delay, &[]),
        early(&part.pure_delay),
        fit_line(&part.delay_and_lag_validation).into(),
        Block::paragraph(bar).into(),
        comparison(title, &part.delay_and_lag_validation, Some(("delay alone", &part.pure_delay_validation))).into(),
        residual_test(&part.delay_and_lag_validation).into(),
    ];
    all.into_iter().collect()
}
