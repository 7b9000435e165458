//! The shaft by recording, band and route, and beyond K and B.

use bench::shaft_study::{ShaftRecording, ShaftStudy};
use bench::torque_signals::Told;
use page::Blocks;

use super::{figures, heading, of_recording, parameters, plain_table, sentence, untold};
use crate::shaft as words;
use crate::torque;
use crate::wording::number;

/// Why a recording may stand in the section with two values.
const WHICH: &str = "From here on K and B of each recording are estimated from its first part, as those at the head of the section are, and the \
    rest judges them. “Other recordings and routes” above takes whole recordings, to compare them with one another, so that its \
    values differ a little from those below. The model has the ones at the head";

/// What all recordings with a shaft tell of it.
pub(crate) fn shaft(found: &ShaftStudy) -> Blocks {
    let mut all = if found.recordings.len() > 1 { sentence(WHICH) } else { Blocks::default() };
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
    if let Told::Untold(why) = &recording.shaft {
        all.push(untold("Shaft", &torque::untold(why)));
        return all;
    }
    all.push(routes(recording));
    for remark in words::route_remarks(recording) {
        if !said.contains(&remark) {
            all.push(sentence(&remark));
            said.push(remark);
        }
    }
    match &recording.inertias {
        Some(Told::Found(estimate)) => {
            all.push(sentence("As if nothing were known of the inertias:"));
            all.push(parameters(["K", "B", "J_d", "J_e"].iter().filter_map(|symbol| estimate.parameter(symbol))));
        }
        Some(Told::Untold(why)) => all.push(untold("Inertias", &torque::untold(why))),
        None => {}
    }
    match &recording.beyond {
        Told::Found(found) => {
            let row = |test: &bench::estimate::shaft::TermTest| {
                vec![
                    words::term(test.term).to_owned(),
                    words::term_value(test),
                    words::term_interval(test),
                    words::term_verdict(test).to_owned(),
                ]
            };
            all.push(plain_table(&["Beyond K and B", "Estimate", "95 % interval", ""], found.tests.iter().map(row)));
            all.push(sentence(&words::beyond(found)));
        }
        Told::Untold(why) => all.push(untold("Beyond K and B", &torque::untold(why))),
    }
    match &recording.dual_mass {
        Some(Told::Found(found)) => {
            all.push(parameters(&found.estimate.parameters));
            let simple = recording.beyond.found().map(|beyond| beyond.simple_misfit);
            all.push(sentence(&words::dual_mass(found, simple)));
        }
        Some(Told::Untold(why)) => all.push(untold("Dual-mass flywheel", &torque::untold(why))),
        None => {}
    }
    all
}

fn routes(recording: &ShaftRecording) -> Blocks {
    let rows = words::routes(recording).into_iter().map(|route| match route.told {
        Ok(estimate) => {
            let shown = |symbol| estimate.parameter(symbol).map_or_else(|| "–".to_owned(), number::parameter);
            let [k, b, dyno, engine] = ["K", "B", "J_d", "J_e"].map(shown);
            vec![route.name.to_owned(), k, b, dyno, engine]
        }
        Err(why) => {
            let blank = || "–".to_owned();
            vec![format!("{}: {}", route.name, torque::untold(why)), blank(), blank(), blank(), blank()]
        }
    });
    plain_table(&["Route", "K", "B", "J_d", "J_e"], rows)
}
