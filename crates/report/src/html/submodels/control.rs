//! Speed control, feed-forward and torque control.

use bench::study::{Estimate, FeedForward, Part, SpeedController, Study, TorqueControl};

use crate::html::parts::{fit_line, lead, not_estimated, parameters, unbroken};
use crate::html::plots::{Extent, comparison, correlations, cross_outside, figure, residual_test, side_by_side};
use crate::html::typeset::prose;
use crate::torque;
use crate::wording::number;
use page::markup;
use page::markup::Markup;

/// PI with delay.
pub(crate) fn speed_controller(study: &Study) -> Markup {
    let what = "The controller that holds the dynamometer’s speed: it turns the speed error N_d − N_d* into a torque \
                demand T_d*.";
    let part = match &study.speed_controller {
        Part::Estimated(part) => part,
        Part::NotEstimated { needs } => return not_estimated(what, needs),
    };
    let equation = "<i>T</i><sub>d</sub>* = e<sup>−<i>sτ</i></sup> (<i>K</i><sub>p</sub> + <i>K</i><sub>i</sub>/<i>s</i>) \
                    (<i>N</i><sub>d</sub> − <i>N</i><sub>d</sub>*) + <i>I</i><sub>0</sub>";
    let title = "Speed control on the held-out stretch";
    [
        lead(what, equation),
        parameters(&part.estimate, &[&part.zero]),
        discrete(part),
        fit_line(&part.validation),
        figure(&comparison(title, &part.validation, None)),
        delay_evidence(part),
    ]
    .into_iter()
    .collect()
}

fn discrete(part: &SpeedController) -> Markup {
    let coefficient = |value: f64| unbroken(&number::significant(value, 6));
    markup!(
        "<p>As the controller computes it, every {}, on the speed error in rpm: \
         (<i>b</i><sub>0</sub> + <i>b</i><sub>1</sub> q<sup>−1</sup>)/(1 − q<sup>−1</sup>) with \
         <i>b</i><sub>0</sub> = {}, <i>b</i><sub>1</sub> = {}. <i>K</i><sub>p</sub> is that of integration by forward \
         Euler; backward Euler has the same sequence with a <i>K</i><sub>p</sub> that is less by <i>K</i><sub>i</sub> \
         times the sample time.</p>\n",
        unbroken(&number::duration(part.sample_time_s)),
        coefficient(part.discrete.0),
        coefficient(part.discrete.1),
    )
}

/// Residual tests with and without the delay, on one scale.
fn delay_evidence(part: &SpeedController) -> Markup {
    let (Some(with), Some(without)) = (&part.validation.residuals, &part.without_delay.residuals) else {
        return residual_test(&part.validation);
    };
    let extent = Extent::of(&[with, without]);
    let text = format!(
        "Leaving the delay out and estimating K_p and K_i anew gives a fit of {}; with the delay it is {}. The residuals \
         tell more than the fit: their correlation with {} lies outside the region at {} without the delay, and at {} \
         with it.",
        number::fit(part.without_delay.fit_percent),
        number::fit(part.validation.fit_percent),
        with.input,
        cross_outside(without),
        cross_outside(with)
    );
    markup!(
        "<p>{}</p>\n{}",
        prose(&text),
        side_by_side(&[
            correlations("With the delay", with, extent),
            correlations("Without the delay", without, extent)
        ])
    )
}

/// Feed-forward, and PI alone beside it.
pub(crate) fn feed_forward(study: &Study) -> Markup {
    let what = "The torque the controller adds from the speed demand N_d* alone, without waiting for an error.";
    let part: &FeedForward = match &study.feed_forward {
        Part::Estimated(part) => part,
        Part::NotEstimated { needs } => return not_estimated(what, needs),
    };
    let equation =
        "FF = <i>k</i> <i>N</i><sub>d</sub>* + <i>m</i> + <i>k</i><sub>a</sub> d<i>N</i><sub>d</sub>*/d<i>t</i>";
    let note = format!(
        "m cannot be told apart from the integrator’s initial state and is not reported. Without feed-forward, PI alone \
         fits the same stretch with {}.",
        number::fit(part.pi_alone.fit_percent)
    );
    let title = "PI with feed-forward, and PI alone, on the held-out stretch";
    [
        lead(what, equation),
        parameters(&part.estimate, &[]),
        fit_line(&part.validation),
        markup!("<p>{}</p>\n", prose(&note)),
        figure(&comparison(title, &part.validation, Some(("PI alone", &part.pi_alone)))),
        residual_test(&part.validation),
    ]
    .into_iter()
    .collect()
}

/// What a delay below zero means, where one is.
fn early(estimate: &Estimate) -> Markup {
    let said = torque::early_delays(&estimate.parameters);
    said.iter().map(|text| markup!("<p>{}</p>\n", prose(&format!("{text}.")))).collect()
}

/// Inverter and machine: delay alone, and delay with lag.
pub(crate) fn torque_control(study: &Study) -> Markup {
    let what =
        "Inverter and machine with their field-oriented control: how the air-gap torque T_d follows its demand T_d*.";
    let part: &TorqueControl = match &study.torque_control {
        Part::Estimated(part) => part,
        Part::NotEstimated { needs } => return not_estimated(what, needs),
    };
    let equation = "<i>T</i><sub>d</sub> = e<sup>−<i>sτ</i></sup> <span class=\"frac\"><span><i>a</i></span>\
                    <span><i>s</i> + <i>a</i></span></span> <i>T</i><sub>d</sub>*";
    let bar = format!(
        "A delay alone is the bar to beat: on the same stretch it fits with {}, delay and lag with {}.",
        number::fit(part.pure_delay_validation.fit_percent),
        number::fit(part.delay_and_lag_validation.fit_percent)
    );
    let title = "Torque control on the held-out stretch";
    [
        lead(what, equation),
        markup!("<h3>Delay and lag</h3>\n"),
        parameters(&part.delay_and_lag, &[]),
        early(&part.delay_and_lag),
        markup!("<h3>Delay alone</h3>\n"),
        parameters(&part.pure_delay, &[]),
        early(&part.pure_delay),
        fit_line(&part.delay_and_lag_validation),
        markup!("<p>{}</p>\n", prose(&bar)),
        figure(&comparison(title, &part.delay_and_lag_validation, Some(("delay alone", &part.pure_delay_validation)))),
        residual_test(&part.delay_and_lag_validation),
    ]
    .into_iter()
    .collect()
}
