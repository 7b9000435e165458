//! Models of the torque control against the bar of one sample's delay.

use bench::study::Analyses;
use bench::torque_control_study::{Judgement, StudiedRecording, TorqueControlStudy, TorqueControlStudyError};
use page::Blocks;

use super::{figures, heading, of_recording, parameters, plain_table, sentence, untold};
use crate::inverter as words;
use crate::torque;
use crate::wording::number;

/// What the torque control can be told to be.
pub(crate) fn inverter(found: &Result<TorqueControlStudy, TorqueControlStudyError>) -> Blocks {
    let studied = match found {
        Ok(studied) => studied,
        Err(why) => return untold("Models of the torque control beyond delay and lag", &why.to_string()),
    };
    let orders = Analyses::ORDERS_TRIED;
    let mut all = heading("Delay, lag or black box?");
    all.push(sentence(&format!(
        "Every model is held against the bar that T_d is T_d* one sample of T_d,calc ago. Black boxes of up to {} poles and {} \
         samples of delay were tried here; `dynoid torque-control` tries more, which takes minutes",
        orders.highest, orders.longest_delay
    )));
    studied.recordings.iter().for_each(|recording| all.push(one(studied, recording)));
    studied.untold.iter().for_each(|(file, why)| all.push(untold(file, &torque::untold(why))));
    studied.visibility.iter().for_each(|visibility| all.push(sentence(&words::first_visible(visibility))));
    all.push(figures(words::figures(studied)));
    all
}

fn one(studied: &TorqueControlStudy, recording: &StudiedRecording) -> Blocks {
    let mut all = of_recording(&recording.file, &recording.label);
    all.push(parameters(std::iter::once(&recording.pure_delay).chain(&recording.delay_and_lag)));
    words::early(recording).iter().for_each(|text| all.push(sentence(text)));
    all.push(judgements(studied, recording));
    all.push(sentence(&words::against_bar(studied, recording)));
    all.push(sentence(&words::beyond(recording)));
    all
}

fn judgements(studied: &TorqueControlStudy, recording: &StudiedRecording) -> Blocks {
    let or_dash = |value: Option<String>| value.unwrap_or_else(|| "–".to_owned());
    let nm = |value: f64| number::significant_with_unit(value, 3, "Nm");
    let bar = vec![
        "T_d* one sample ago (the bar)".to_owned(),
        "–".to_owned(),
        number::fit(recording.bar_fit_percent),
        nm(recording.bar_rms_nm),
        "1".to_owned(),
        String::new(),
    ];
    let row = |judged: &Judgement| {
        vec![
            words::model(&judged.model),
            words::mover(judged.estimated_on).trim_start_matches("the ").to_owned(),
            or_dash(judged.fit_percent.map(number::fit)),
            or_dash(judged.rms_nm.map(nm)),
            or_dash(judged.ratio.map(|ratio| number::significant(ratio, 3))),
            words::verdict(judged.verdict).to_owned(),
        ]
    };
    let heads = ["Model", "Estimated where T_d* was moved by", "Fit", "Rms error", "Over the bar’s", "Against the bar"];
    plain_table(&heads, std::iter::once(bar).chain(studied.judged_on(recording.excited).map(row)))
}
