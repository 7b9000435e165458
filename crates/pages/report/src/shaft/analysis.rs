//! The shaft by recording, band and route, and beyond K and B.

use page::Blocks;
use part_shaft::shaft_analysis::{Band, ShaftAnalysis, ShaftRecording};
use rig::results::{Estimate, Outcome, Quantity, Shaft};

use super::words;
use crate::blocks::{figures, heading, no_result, of_recording, parameters, plain_table, sentence};
use crate::wording::{self, number};

/// Why a recording may have two values.
const WHICH: &str = "The values of each recording come from its first part, and the rest judges them. A comparison of whole recordings \
    gives values that differ a little";

/// Findings of all recordings with a shaft on it.
pub(crate) fn analysis(found: &ShaftAnalysis) -> Blocks {
    let mut all = match found.recordings.len() {
        0 => sentence("None of these recordings has a shaft: run BS_T_NT or WhiteNoise_T_TN with the shaft on"),
        1 => Blocks::default(),
        _ => sentence(WHICH),
    };
    if let Some(together) = &found.together {
        all.push(heading("All recordings together"));
        all.push(parameters([&together.stiffness.parameter, &together.damping.parameter]));
        all.push(sentence(&words::together(together)));
    }
    let mut said = Vec::new();
    found.recordings.iter().for_each(|recording| all.push(one(recording, &mut said)));
    words::routes_not_taken(found).iter().for_each(|why| all.push(sentence(why)));
    all.push(figures(words::figures(found)));
    all
}

/// One recording; a remark that holds of several is `said` once.
fn one(recording: &ShaftRecording, said: &mut Vec<String>) -> Blocks {
    let mut all = of_recording(&recording.file, &recording.label);
    if let Outcome::NotEstimated { needs: why } = &recording.shaft {
        all.push(no_result("Shaft", &wording::reasons(why)));
        return all;
    }
    if let Outcome::Estimated(shaft) = &recording.shaft {
        all.push(parameters(shaft.estimate.parameters.iter().chain([&shaft.zero])));
        all.push(bands(recording, shaft));
    }
    all.push(routes(recording));
    for remark in words::route_remarks(recording) {
        if !said.contains(&remark) {
            all.push(sentence(&remark));
            said.push(remark);
        }
    }
    match &recording.inertias {
        Some(Outcome::Estimated(estimate)) => {
            all.push(sentence("As if nothing were known of the inertias:"));
            all.push(parameters(MASSES_AND_SHAFT.iter().filter_map(|quantity| estimate.parameter(*quantity))));
        }
        Some(Outcome::NotEstimated { needs: why }) => all.push(no_result("Inertias", &wording::reasons(why))),
        None if recording.routes.black_box.is_some() => {}
        None => all.push(sentence(
            "This recording does not show J_e; run WhiteNoise_T_TN or Multisine_T_TN on a bench with load cell",
        )),
    }
    match &recording.beyond {
        Outcome::Estimated(found) => {
            let row = |test: &part_shaft::shaft::TermTest| {
                vec![
                    words::term(test.term).to_owned(),
                    words::term_value(test),
                    words::term_interval(test),
                    words::term_verdict(test).to_owned(),
                ]
            };
            let heads = ["Beyond K and B", "Estimate, ± 95 %", "99 % interval, all together", ""];
            all.push(plain_table(&heads, found.tests.iter().map(row)));
            all.push(sentence(&words::beyond(found)));
        }
        Outcome::NotEstimated { needs: why } => all.push(no_result("Beyond K and B", &wording::reasons(why))),
    }
    match &recording.dual_mass {
        Some(Outcome::Estimated(found)) => {
            all.push(parameters(&found.estimate.parameters));
            let simple = recording.beyond.estimated().map(|beyond| beyond.simple_misfit);
            all.push(sentence(&words::dual_mass(found, simple)));
        }
        Some(Outcome::NotEstimated { needs: why }) => all.push(no_result("Dual-mass flywheel", &wording::reasons(why))),
        None => {}
    }
    all
}

/// Quantities that make up two masses and a shaft.
const MASSES_AND_SHAFT: [Quantity; 4] =
    [Quantity::Stiffness, Quantity::Damping, Quantity::DynoInertia, Quantity::EngineInertia];

/// K and B by band, with the timing estimated and with time stamps taken as exact.
fn bands(recording: &ShaftRecording, shaft: &Shaft) -> Blocks {
    // At zero, where it can go no further, a parameter is without uncertainty and says nothing.
    let shown = |estimate: &Estimate, quantity| {
        let known = estimate.parameter(quantity).filter(|p| p.standard_error > 0.0);
        known.map_or_else(|| "–".to_owned(), number::parameter)
    };
    let row = |name: String, own: &Estimate, naive: &Estimate| {
        let [k, b] = [Quantity::Stiffness, Quantity::Damping];
        vec![name, shown(own, k), shown(own, b), shown(naive, k), shown(naive, b)]
    };
    let of_band =
        |band: &Band| row(format!("{} … {}", band.band_hz.0, band.band_hz.1), &band.estimate, &band.ignoring_timing);
    let all = row("all".to_owned(), &shaft.estimate, &shaft.ignoring_timing);
    let heads = ["Band, Hz", "K", "B", "K, time stamps taken as exact", "B, so"];
    plain_table(&heads, recording.bands.iter().map(of_band).chain([all]))
}

fn routes(recording: &ShaftRecording) -> Blocks {
    let rows = words::routes(recording).into_iter().map(|route| match route.estimate {
        Ok(estimate) => {
            let shown = |quantity| estimate.parameter(quantity).map_or_else(|| "–".to_owned(), number::parameter);
            let [k, b, dyno, engine] = MASSES_AND_SHAFT.map(shown);
            vec![route.name.to_owned(), k, b, dyno, engine]
        }
        Err(why) => {
            let blank = || "–".to_owned();
            vec![format!("{}: {}", route.name, wording::reasons(why)), blank(), blank(), blank(), blank()]
        }
    });
    plain_table(&["Method", "K", "B", "J_d", "J_e"], rows)
}
