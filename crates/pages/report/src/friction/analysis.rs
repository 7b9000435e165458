//! Friction and inertia of the dynamometer.

use page::Blocks;
use part_friction::{Friction, Inertia};
use rig::facts::{BenchFacts, StatedInertia};
use rig::results::Outcome;

use super::words;
use crate::blocks::{figures, no_result, parameters, plain_table, sentence};
use crate::wording::{self, number};

/// The section on friction.
pub(crate) fn analysis(found: &Outcome<Friction>, bench: &BenchFacts) -> Blocks {
    let found = match found.as_ref() {
        Ok(found) => found,
        Err(why) => return no_result("Friction and inertia of the dynamometer are not known", &wording::reasons(why)),
    };
    analysis_of(found, bench.dynamometer_inertia())
}

/// Friction and inertia as they were found.
pub(crate) fn analysis_of(found: &Friction, stated: StatedInertia) -> Blocks {
    let inertia = match &found.inertia {
        Inertia::Estimated { inertia, delay } => vec![inertia.as_ref(), delay.as_ref()],
        Inertia::Stated { .. } => Vec::new(),
    };
    let mut all = sentence(
        "The torque lost in the dynamometer itself, T_fric(ω) = −(J_d dω_d/dt + T_d), from recordings without a \
         shaft. With a shaft it cannot be separated from engine torque",
    );
    all.push(parameters(inertia.into_iter().chain(&found.friction.parameters).chain(&found.per_inertia.parameters)));
    let said = words::doubts(found, stated).into_iter().chain(words::remarks(found));
    said.for_each(|remark| all.push(sentence(&remark)));
    let row = |candidate: &part_friction::Candidate| {
        let chosen = if candidate.chosen { "chosen" } else { "" };
        vec![words::terms(&candidate.terms), number::significant(candidate.bic_above_best, 3), chosen.to_owned()]
    };
    all.push(plain_table(&["Terms", "BIC above the best", ""], found.candidates.iter().map(row)));
    let curve = [found.curve.first(), found.curve.get(found.curve.len() / 2), found.curve.last()];
    let point = |point: &part_friction::CurvePoint| {
        vec![number::rpm(point.speed_rad_s), number::plus_minus(point.torque_nm, point.half_width_nm, "Nm")]
    };
    all.push(plain_table(&["Speed", "T_fric, ± 95 %"], curve.into_iter().flatten().map(point)));
    all.push(plain_table(&["Recording", "From", "To", "Torque", ""], found.run_outs.iter().map(run_out)));
    all.push(figures(words::figures(found)));
    all
}

/// The stretch of a recording that was used.
fn run_out(one: &part_friction::RunOut) -> Vec<String> {
    let [start, end] = [one.stretch.start_s, one.stretch.end_s].map(|s| format!("{} s", number::significant(s, 4)));
    let left_out = match one.left_out {
        0 => String::new(),
        count => format!("{count} samples that drop out left out"),
    };
    vec![one.stretch.file.clone(), start, end, words::torque_used(one.torque).to_owned(), left_out]
}
