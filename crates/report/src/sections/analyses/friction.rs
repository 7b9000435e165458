//! Friction and inertia of the dynamometer.

use bench::friction::{Friction, FrictionError, Inertia};
use bench::study::BenchFacts;
use page::Blocks;

use super::{figures, parameters, plain_table, sentence, untold};
use crate::friction as words;
use crate::wording::number;

/// The section on friction.
pub(crate) fn friction(found: &Result<Friction, FrictionError>, bench: &BenchFacts) -> Blocks {
    let found = match found {
        Ok(found) => found,
        Err(why) => return untold("Friction and inertia of the dynamometer are not known", &why.to_string()),
    };
    let inertia = match &found.inertia {
        Inertia::Estimated { inertia, delay } => vec![inertia.as_ref(), delay.as_ref()],
        Inertia::Stated { .. } => Vec::new(),
    };
    let mut all = sentence(
        "What the dynamometer loses by itself, T_fric(ω) = −(J_d dω_d/dt + T_d), told without a shaft, since with one it \
         cannot be told from engine torque",
    );
    all.push(parameters(inertia.into_iter().chain(&found.friction.parameters).chain(&found.per_inertia.parameters)));
    let stated = words::StatedInertia {
        kg_m2: bench.dynamometer_inertia_kg_m2,
        uncertainty_percent: bench.dynamometer_inertia_uncertainty_percent,
    };
    let said = words::doubts(found, stated).into_iter().chain(words::remarks(found));
    said.for_each(|remark| all.push(sentence(&remark)));
    let row = |candidate: &bench::friction::Candidate| {
        let chosen = if candidate.chosen { "chosen" } else { "" };
        vec![words::terms(&candidate.terms), number::significant(candidate.bic_above_best, 3), chosen.to_owned()]
    };
    all.push(plain_table(&["Terms", "BIC above the best", ""], found.candidates.iter().map(row)));
    all.push(figures(words::figures(found)));
    all
}
