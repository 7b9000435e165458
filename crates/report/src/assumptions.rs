//! What a prediction or a simulation takes for granted.

use design::safety::Prior;
use page::{Block, Finding, Tone, decimal};
use virtual_bench::Assumption;

use crate::wording;

/// Each assumption as a finding.
pub(crate) fn assumptions(all: &[Assumption]) -> impl Iterator<Item = Block> + '_ {
    let finding = |assumption| Finding::new(Tone::Caution, "assumed", wording::assumption(assumption));
    all.iter().map(move |assumption| Block::Finding(finding(assumption)))
}

/// How benches spread that no study describes, as [`Prior`] has it.
pub(crate) fn prior_ranges() -> String {
    let percent = |share: f64| format!("±{} %", decimal::fixed(100.0 * share, 0));
    let Prior { resonance, damping, engine_inertia } = Prior::default();
    format!(
        "resonance {}, damping {}, inertia of the engine {} (95 % ranges)",
        percent(resonance),
        percent(damping),
        percent(engine_inertia)
    )
}
