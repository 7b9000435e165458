//! Models of the torque control against the bar of one sample's delay.

use page::Blocks;
use part_torque::model_comparison::{
    BlackBox, ChosenBy, ComparedRecording, Judgement, Model, ModelComparison, Visibility, VisibilityCase,
};
use rig::results::{Outcome, Parameter, ResidualTest};
use study::Analyses;

use super::words;
use crate::blocks::{figures, heading, no_result, of_recording, plain_table, sentence};
use crate::wording::{self, number};

/// Models of the torque control, with the orders that a report tries.
pub(crate) fn analysis_in_report(found: &Outcome<ModelComparison>) -> Blocks {
    let studied = match found.as_ref() {
        Ok(studied) => studied,
        Err(why) => return no_result("Models of the torque control beyond delay and lag", &wording::reasons(why)),
    };
    let orders = Analyses::ORDERS_TRIED;
    let mut all = sentence(&format!(
        "Black boxes of up to {} poles and {} samples of delay were tried here; `dynoid torque-control` tries more, which takes minutes",
        orders.highest, orders.longest_delay
    ));
    all.push(analysis(studied));
    all
}

/// Every model compared with a delay of one sample.
pub(crate) fn analysis(studied: &ModelComparison) -> Blocks {
    let mut all = heading("Delay, lag or black box?");
    all.push(sentence(
        "Every model is compared with the simplest one, the reference: T_d is T_d* one sample of T_d,calc ago",
    ));
    studied.recordings.iter().for_each(|recording| all.push(one(studied, recording)));
    studied.unusable.iter().for_each(|(file, why)| all.push(no_result(file, &wording::reason_of(why))));
    studied.visibility.iter().for_each(|one| all.push(visibility(one)));
    all.push(figures(words::figures(studied)));
    all
}

fn one(studied: &ModelComparison, recording: &ComparedRecording) -> Blocks {
    let mut all = of_recording(&recording.file, &recording.label);
    all.push(sentence(&stretches(recording)));
    all.push(estimates(recording));
    all.push(sentence(
        "These delays contain the skew of T_d,calc. The estimate of the study is without it, where the shaft shows it",
    ));
    words::early(recording).iter().for_each(|text| all.push(sentence(text)));
    all.push(judgements(studied, recording));
    all.push(sentence(&words::against_bar(studied, recording)));
    let boxes = || recording.black_boxes.iter();
    let by_fit = boxes().filter(|black_box| black_box.chosen_by.contains(&ChosenBy::Fit));
    by_fit.filter_map(|black_box| words::belief(recording, black_box)).for_each(|text| all.push(sentence(&text)));
    for black_box in boxes() {
        if let Some(why) = words::closed(black_box.closed) {
            all.push(sentence(&format!("{} {why}", words::structure(&black_box.structure))));
        }
    }
    words::circular(recording).iter().for_each(|text| all.push(sentence(text)));
    all.push(sentence(&words::beyond(recording.second_order.as_ref())));
    all
}

/// Mover of T_d*, the part that judges the other, and the ripple that was taken out.
fn stretches(recording: &ComparedRecording) -> String {
    let ends = [recording.estimation.end_s, recording.held_out.end_s].map(|s| number::significant(s, 4));
    let ripple = match recording.ripple_hz.as_slice() {
        [] => "no ripple was found".to_owned(),
        all => {
            let lines: Vec<String> = all.iter().map(|f| number::significant_with_unit(*f, 4, "Hz")).collect();
            format!("ripple at {} was taken out", lines.join(", "))
        }
    };
    let mover = words::mover(recording.excited);
    format!("T_d* moved by {mover}; estimated up to {} s, judged from there to {} s; {ripple}", ends[0], ends[1])
}

/// Delay alone, then delay and lag, each with how many residuals depend on T_d*.
fn estimates(recording: &ComparedRecording) -> Blocks {
    let outside = |test: &Option<ResidualTest>| {
        test.as_ref().map_or_else(|| "–".to_owned(), |test| number::share(test.share_outside()))
    };
    let row = |name: &str, p: &Parameter, outside: String| {
        vec![name.to_owned(), p.quantity.symbol().to_owned(), number::parameter(p), number::interval(p), outside]
    };
    let first = row("delay", &recording.pure_delay, outside(&recording.pure_delay_residuals));
    let both = recording.delay_and_lag.iter().enumerate().map(|(n, p)| match n {
        0 => row("delay and lag", p, outside(&recording.delay_and_lag_residuals)),
        _ => row("", p, String::new()),
    });
    let heads = ["Model", "", "Estimate", "95 % interval", "Residuals that depend on T_d*"];
    plain_table(&heads, std::iter::once(first).chain(both))
}

/// Visibility at other rates and demands.
fn visibility(of: &Visibility) -> Blocks {
    let mut all = heading(&format!("What {} of other rates and demands would show", number::duration(of.recording_s)));
    let row = |case: &VisibilityCase| {
        let least = case.least_term;
        vec![
            format!("{} Hz", number::significant(case.rate_hz, 4)),
            number::duration(case.hold_s),
            number::significant_with_unit(case.delay_s, 2, "s"),
            number::significant_with_unit(case.lag_rad_s, 2, "rad/s"),
            if least.is_finite() { number::significant(least, 2) } else { "none".to_owned() },
            words::recording_needed(case.needed_s),
        ]
    };
    let heads = ["T_d,calc at", "T_d* held", "Error of τ", "Error of a", "Least κ seen", "κ = 0.25 seen in"];
    all.push(plain_table(&heads, of.cases.iter().map(row)));
    all.push(sentence(&words::first_visible(of)));
    all
}

fn chosen_by(studied: &ModelComparison, judged: &Judgement) -> String {
    let Model::BlackBox { structure } = judged.model else { return String::new() };
    let of = |black_box: &&BlackBox| black_box.structure == structure;
    let found = studied.recording(judged.estimated_on).and_then(|r| r.black_boxes.iter().find(of));
    let word = |by: &ChosenBy| match by {
        ChosenBy::Fit => "fit",
        ChosenBy::Bic => "BIC",
    };
    found.map_or_else(String::new, |b| b.chosen_by.iter().map(word).collect::<Vec<_>>().join(", "))
}

fn judgements(studied: &ModelComparison, recording: &ComparedRecording) -> Blocks {
    let or_dash = |value: Option<String>| value.unwrap_or_else(|| "–".to_owned());
    let nm = |value: f64| number::significant_with_unit(value, 3, "Nm");
    let bar = vec![
        "T_d* one sample ago (the bar)".to_owned(),
        "–".to_owned(),
        String::new(),
        number::fit(recording.bar_fit_percent),
        nm(recording.bar_rms_nm),
        "1".to_owned(),
        String::new(),
    ];
    let row = |judged: &Judgement| {
        vec![
            words::model(&judged.model),
            words::mover(judged.estimated_on).trim_start_matches("the ").to_owned(),
            chosen_by(studied, judged),
            or_dash(judged.fit_percent.map(number::fit)),
            or_dash(judged.rms_nm.map(nm)),
            or_dash(judged.ratio.map(|ratio| number::significant(ratio, 3))),
            words::verdict(judged.verdict).to_owned(),
        ]
    };
    let heads = [
        "Model",
        "Estimated where T_d* was moved by",
        "Chosen by",
        "Fit",
        "Rms error",
        "Over the bar’s",
        "Against the bar",
    ];
    plain_table(&heads, std::iter::once(bar).chain(studied.judged_on(recording.excited).map(row)))
}
