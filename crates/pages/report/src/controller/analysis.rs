//! The speed controller and its feed-forward beyond what the model takes of them.

use page::Blocks;
use part_controller::noise_test::{Case, Estimator, NoiseTest, Summary};
use part_controller::speed_controller::{
    Controller, ControllerRecording, FeedForwardTerms, Round, SpeedControl, TermTest,
};
use rig::results::{Notation, Outcome, Parameter, WrittenParameter};
use units::RPM_RAD_S;

use super::words;
use crate::blocks::{figures, heading, no_result, of_recording, parameters, plain_table, sentence};
use crate::wording::{self, number};

/// PI and delay in every recording with constant N_d*, further terms, the limit of T_d*, and what noise does.
pub(crate) fn analysis(found: &SpeedControl, study: Option<&Outcome<NoiseTest>>) -> Blocks {
    let mut all: Blocks = found.controllers.iter().map(one).collect();
    all.push(figures(words::correlation_figures(found)));
    if !found.controllers.is_empty() {
        all.push(heading("Limit of T_d*"));
        words::limits(found).iter().for_each(|text| all.push(sentence(text)));
    }
    match study.map(Outcome::as_ref) {
        Some(Ok(study)) => all.push(pi_study(study)),
        Some(Err(why)) => all.push(no_result("What noise does to a known PI", &wording::reasons(why))),
        None => {}
    }
    all
}

fn one(recording: &ControllerRecording) -> Blocks {
    let mut all = of_recording(&recording.file, &recording.label);
    match &recording.found {
        Outcome::Estimated(found) => all.push(found_in(found)),
        Outcome::NotEstimated { needs: why } => all.push(no_result("Speed controller", &wording::reasons(why))),
    }
    all
}

fn found_in(found: &Controller) -> Blocks {
    let rows = found.with_delay.parameters.iter().map(|p| {
        let alone = found.without_delay.parameter(p.quantity).map_or_else(|| "–".to_owned(), number::parameter);
        parameter_row(p.written(), alone)
    });
    let discrete = found.discrete.coefficients.parameters.iter().map(Parameter::written);
    let further = words::gains_in_si(found).chain(discrete).map(|p| parameter_row(p, String::new()));
    let heads = ["", "Parameter", "PI alone", "PI and delay", "95 % interval"];
    let mut all = plain_table(&heads, rows.chain(further));
    all.push(sentence(&words::delay(found)));
    all.push(sentence(&format!(
        "Discrete form, every {}: T_d*(k) = T_d*(k − 1) + b_0 e(k) + b_1 e(k − 1), where e is the speed error τ ago. {}",
        number::duration(found.discrete.sample_time_s),
        words::rules(found)
    )));
    match &found.structure {
        Outcome::Estimated(tested) => {
            all.push(rounds("PI and delay", &tested.rounds));
            all.push(sentence(&words::structure(tested)));
            if let Some(with) = &tested.with_terms {
                let values =
                    with.parameters.iter().map(|p| format!("{} = {}", p.quantity.symbol(), number::parameter(p)));
                all.push(sentence(&format!("Together: {}", values.collect::<Vec<_>>().join(", "))));
            }
        }
        Outcome::NotEstimated { needs: why } => {
            all.push(no_result("Terms beside PI and delay", &wording::reasons(why)))
        }
    }
    all
}

fn parameter_row(p: WrittenParameter, alone: String) -> Vec<String> {
    let Notation { symbol, name, .. } = p.notation;
    vec![symbol.to_owned(), name.to_owned(), alone, number::parameter(p), number::interval(p)]
}

fn rounds(base: &str, all: &[Round]) -> Blocks {
    let heads = ["Term", "", "Estimate (95 %)", "Explains of N_d", "p (Holm)", ""];
    let mut section = Blocks::default();
    for round in all {
        section.push(sentence(&format!("{}:", words::round(base, round))));
        section.push(plain_table(&heads, round.tests.iter().map(test_row)));
    }
    let last = all.last().map(|round| round.tests.as_slice()).unwrap_or_default();
    words::undecided_terms(last).iter().chain(&words::negligible(last)).for_each(|text| section.push(sentence(text)));
    section
}

fn test_row(test: &TermTest) -> Vec<String> {
    let estimate = test.estimate.as_ref();
    let is_tested = test.p_value < 1.0;
    let or_dash = |is_known: bool, text: String| if is_known { text } else { "–".to_owned() };
    vec![
        words::term(test.term).to_owned(),
        estimate.map_or_else(String::new, |p| p.quantity.symbol().to_owned()),
        estimate.map_or_else(|| "–".to_owned(), number::parameter),
        or_dash(
            estimate.is_some() || is_tested,
            number::significant_with_unit(test.explains_rad_s / RPM_RAD_S, 2, "rpm"),
        ),
        or_dash(is_tested, words::probability(test.adjusted_p_value)),
        words::verdict(test).to_owned(),
    ]
}

/// Terms that bend the feed-forward, in every recording in which N_d* moves.
pub(crate) fn feed_forward_analysis(found: &SpeedControl) -> Blocks {
    let mut all = Blocks::default();
    for one in &found.feed_forward {
        all.push(of_recording(&one.file, &one.label));
        match &one.found {
            Outcome::NotEstimated { needs: why } => all.push(no_result("Feed-forward", &wording::reasons(why))),
            Outcome::Estimated(found) => {
                all.push(parameters(&found.straight.estimate.parameters));
                all.push(sentence(&words::improvement(found)));
                match &found.terms {
                    Outcome::Estimated(terms) => all.push(bends(terms)),
                    Outcome::NotEstimated { needs: why } => {
                        all.push(no_result("Terms beside k and k_a", &wording::reasons(why)))
                    }
                }
            }
        }
    }
    if found.feed_forward.is_empty() {
        all.push(sentence("No recording moves N_d*, so the feed-forward is not known; run Levels_N_NT"));
    }
    all.push(sentence(words::M_IS_NOT_SHOWN));
    all.push(figures(words::map_figures(found)));
    all
}

fn bends(terms: &FeedForwardTerms) -> Blocks {
    let mut all = rounds("k and k_a", &terms.rounds);
    all.push(sentence(&words::bends(&terms.found())));
    if !terms.map.is_empty() {
        all.push(map(terms));
    }
    all
}

/// The feed-forward over the speed.
fn map(terms: &FeedForwardTerms) -> Blocks {
    let shown = |value: f64, (low, high): (f64, f64)| match high > low {
        true => number::plus_minus(value, 0.5 * (high - low), "Nm"),
        false => "–".to_owned(),
    };
    let rows = terms.map.iter().map(|point| {
        vec![
            number::rpm(point.speed_rad_s),
            shown(point.torque_nm, point.interval_nm),
            shown(point.bend_nm, point.bend_interval_nm),
        ]
    });
    plain_table(&["N_d*", "Feed-forward above the lowest", "Beyond straight"], rows)
}

/// Effect of noise on the estimate of a PI that is known.
pub(crate) fn pi_study(found: &NoiseTest) -> Blocks {
    let mut all = heading("Could noise be why a PI does not explain a recording?");
    all.push(sentence(&format!(
        "A known PI runs on the speeds of {}, with each noise in {} draws, and is estimated again",
        found.file, found.options.draws
    )));
    let heads = ["Estimated", "", "Truth", "Mean", "Bias", "St. dev.", "Claimed", "Coverage", "Table 7.1"];
    for cases in found.cases.chunk_by(|a, b| a.noise == b.noise) {
        let noise = cases.first().map_or_else(String::new, |case| words::noise(found, case.noise));
        all.push(sentence(&format!("{noise}:")));
        all.push(plain_table(&heads, cases.iter().flat_map(|case| case_rows(found, case))));
    }
    all.push(sentence(words::NOISE_TEST_DEFINITIONS));
    all.push(sentence(words::ESTIMATORS));
    all.push(figures(words::noise_test_figures(found)));
    all
}

fn case_rows(found: &NoiseTest, case: &Case) -> Vec<Vec<String>> {
    let digits = |value: f64| number::significant(value, 5);
    let spread = |value: f64| number::significant_with_unit(value, 2, "");
    let row = |summary: &Summary| {
        let of_many = |text: String| if summary.values.len() < 2 { "–".to_owned() } else { text };
        let once =
            words::published(found, case.noise, summary.quantity).filter(|_| case.estimator == Estimator::Forward);
        let summary = summary.written();
        vec![
            words::estimator(case.estimator).to_owned(),
            format!("{}, {}", summary.symbol, summary.unit),
            digits(summary.truth),
            digits(summary.mean),
            spread(summary.bias),
            of_many(spread(summary.standard_deviation)),
            spread(summary.claimed),
            of_many(number::proportion(&summary.coverage)),
            once.map_or_else(|| "–".to_owned(), digits),
        ]
    };
    case.summaries.iter().map(row).collect()
}
