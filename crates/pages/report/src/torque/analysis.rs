//! The torque signals compared with one another.

use page::Blocks;
use part_torque::torque_signals::{TorqueRecording, TorqueSignals};
use rig::results::Outcome;

use super::words as torque;
use crate::blocks::{figures, heading, no_result, parameters, plain_table, sentence};
use crate::wording::{self, number};

/// The section on the torque signals.
pub(crate) fn analysis(found: &TorqueSignals) -> Blocks {
    let mut all = sentence(
        "Accuracy and delay of the torque signals. Each is compared with T_d*, with the bend in N_d, and with the \
         load cell at steady torque. The shaft torque is computed from N_d and T_d, with its standard deviation",
    );
    all.push(match &found.trust {
        Some(check) => sentence(&torque::trust(check)),
        None => no_result("T_d,calc is not compared with the load cell", torque::NO_TRUST),
    });
    all.push(delays(found));
    if let Some((file, cell)) = found.load_cell() {
        all.push(heading(&format!("Load cell, from {file}")));
        all.push(parameters(cell));
    }
    all.push(heading("The system’s own shaft torque, and the rebuilt one"));
    all.push(by_recording(found));
    all.push(figures(torque::figures(found)));
    all
}

fn delays(found: &TorqueSignals) -> Blocks {
    let shown = |p: &Option<rig::results::Parameter>| p.as_ref().map_or_else(|| "–".to_owned(), number::parameter);
    let of_recording = |recording: &TorqueRecording| {
        let delays = recording.delays.estimated().into_iter().flatten();
        let row = |delay| -> Vec<String> {
            let delay: &rig::results::SignalDelay = delay;
            vec![
                recording.file.clone(),
                delay.role.symbol().to_owned(),
                shown(&delay.against_demand),
                shown(&delay.against_speed_bend),
                torque::agreement(delay).to_owned(),
                torque::routes(delay).join("; "),
            ]
        };
        delays.map(row).collect::<Vec<_>>()
    };
    let rows: Vec<Vec<String>> = found.recordings.iter().flat_map(of_recording).collect();
    if rows.is_empty() {
        return no_result("Delays", "no recording moves T_d* by itself; run WhiteNoise_T_TN or Step_T_TN");
    }
    let heads =
        ["Recording", "Signal", "Behind T_d*", "Behind the bend of N_d", "Agree", "By each method, 95 % intervals"];
    let mut all = heading("Delays in every recording that shows them");
    all.push(plain_table(&heads, rows));
    let found = found.recordings.iter().filter_map(|recording| recording.delays.estimated());
    found.for_each(|delays| {
        torque::lateness(delays).into_iter().for_each(|text| all.push(sentence(&text)));
        torque::early_signals(delays).iter().for_each(|text| all.push(sentence(text)));
    });
    all
}

/// Filter in the system's own shaft torque; and where there is none of one's own, why. How certain the rebuilt one is,
/// the figures say.
fn by_recording(found: &TorqueSignals) -> Blocks {
    let filters = found.recordings.iter().filter_map(|recording| {
        let filter = match recording.filter.as_ref()? {
            Outcome::Estimated(filter) => torque::shaft_filter(filter),
            Outcome::NotEstimated { needs: why } => wording::reasons(why),
        };
        Some(vec![recording.file.clone(), filter])
    });
    let mut all = plain_table(&["Recording", "What T_d,shaft,calc is"], filters);
    for recording in &found.recordings {
        let name = &recording.file;
        match &recording.shaft {
            Some(Outcome::Estimated(shaft)) => {
                all.push(sentence(&format!("{name}: T_shaft rebuilt: {}", torque::rebuilt(shaft))));
            }
            Some(Outcome::NotEstimated { needs: why }) => {
                all.push(no_result(&format!("{name}: T_shaft is not rebuilt"), &wording::reasons(why)))
            }
            None => {}
        }
        if let Outcome::NotEstimated { needs: why } = &recording.delays {
            all.push(no_result(&format!("{name}: delays"), &wording::reasons(why)));
        }
    }
    all
}
