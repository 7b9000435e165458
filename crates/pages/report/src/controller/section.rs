//! Speed control and feed-forward in the report of a study.

use rig::results::{DelayPlace, FeedForward, Outcome, Quantity, ResidualTest, SpeedController};
use study::Study;

use page::{Block, Blocks};

use crate::estimates::{fit_line, lead, not_estimated, parameters};
use crate::plots::{Extent, comparison, correlations, cross_outside, residual_test};
use crate::wording::number;

/// PI with delay.
pub(crate) fn section(study: &Study) -> Blocks {
    let what = "The controller that holds the dynamometer’s speed: it turns the speed error N_d − N_d* into a torque \
                demand T_d*.";
    let part = match &study.speed_controller {
        Outcome::Estimated(part) => part,
        Outcome::NotEstimated { needs } => return not_estimated(what, needs),
    };
    let equation = "T_d* = e^(−s τ) (K_p + {K_i}/{s}) (N_d − N_d*) + I_0";
    let title = "Speed control on the held-out stretch";
    let all: Vec<Blocks> = vec![
        lead(what, equation),
        parameters(&part.estimate, &[&part.zero]),
        discrete(part),
        fit_line(&part.validation).into(),
        comparison(title, &part.validation, None).into(),
        delay_evidence(part),
    ];
    all.into_iter().collect()
}

fn discrete(part: &SpeedController) -> Blocks {
    let per_si = Quantity::PresentErrorGain.notation().per_si;
    let coefficient = |value: f64| number::significant(per_si * value, 6);
    let text = format!(
        "The controller computes this every {}, on the speed error in rpm: (b_0 + b_1 q⁻¹)/(1 − q⁻¹) with b_0 = {}, \
         b_1 = {}. This K_p is that of integration by forward Euler. With backward Euler the same sequence has a K_p that \
         is smaller by K_i times the sample time.",
        number::duration(part.sample_time_s),
        coefficient(part.discrete.0),
        coefficient(part.discrete.1),
    );
    Block::paragraph(text).into()
}

/// Residual tests with and without the delay, on one scale.
fn delay_evidence(part: &SpeedController) -> Blocks {
    let (Some(with), Some(without)) = (&part.validation.residuals, &part.without_delay.residuals) else {
        return residual_test(&part.validation).into();
    };
    let extent = Extent::of(&[with, without]);
    let fits = format!(
        "Without the delay, and with K_p and K_i estimated again, the fit is {}; with the delay it is {}.",
        number::fit(part.without_delay.fit_percent),
        number::fit(part.validation.fit_percent)
    );
    let correlated = match is_within(with) && is_within(without) {
        true => format!("The residuals are not correlated with {} either way.", with.input),
        false => format!(
            "The residuals show more than the fit. Their correlation with {} lies outside the region at {} without the \
             delay, and at {} with it.",
            with.input,
            cross_outside(without),
            cross_outside(with)
        ),
    };
    let text = format!("{fits} {correlated}");
    let figures =
        vec![correlations("With the delay", with, extent), correlations("Without the delay", without, extent)];
    vec![Block::paragraph(text), Block::Row { figures }].into()
}

/// Feed-forward, and PI alone beside it.
pub(crate) fn feed_forward_section(study: &Study) -> Blocks {
    let what = "The torque the controller adds from the speed demand N_d* alone, without waiting for an error.";
    let part: &FeedForward = match &study.feed_forward {
        Outcome::Estimated(part) => part,
        Outcome::NotEstimated { needs } => return not_estimated(what, needs),
    };
    let equation = "FF = k N_d* + m + k_a {dN_d*}/{dt}";
    let note = format!(
        "m cannot be separated from the integrator’s initial state and is not reported. Without feed-forward, PI alone \
         fits the same stretch with {}.",
        number::fit(part.pi_alone.fit_percent)
    );
    let title = "PI with feed-forward, and PI alone, on the held-out stretch";
    let all: Vec<Blocks> = vec![
        lead(what, equation),
        parameters(&part.estimate, &[]),
        fit_line(&part.validation).into(),
        Block::paragraph(note).into(),
        Block::paragraph(delay_places(&part.delay_places)).into(),
        comparison(title, &part.validation, Some(("PI alone", &part.pi_alone))).into(),
        residual_test(&part.validation).into(),
    ];
    all.into_iter().collect()
}

fn is_within(test: &ResidualTest) -> bool {
    test.cross_correlation.iter().all(|value| value.abs() <= test.cross_correlation_bound)
}

/// Where the controller's delay acts, as far as the recording shows it.
fn delay_places(places: &[DelayPlace]) -> String {
    let named = |place: &DelayPlace| match place {
        DelayPlace::MeasuredSpeed => "the measured speed alone",
        DelayPlace::SpeedError => "the speed error, so that the feed-forward acts at once",
        DelayPlace::WholeOutput => "the whole output",
    };
    match places {
        [] => {
            "N_d* is delayed in a way that no usual controller explains. Check the clocks of N_d* and T_d*.".to_owned()
        }
        [one] => format!("The delay of the controller acts on {}.", named(one)),
        several => {
            let all: Vec<&str> = several.iter().map(named).collect();
            format!(
                "The recording cannot show where the delay of the controller acts: on {}. The intervals of k and k_a hold for \
                 each of them.",
                all.join(", or on ")
            )
        }
    }
}
