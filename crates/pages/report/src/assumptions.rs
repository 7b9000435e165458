//! Assumptions of a prediction or a simulation.

use design::safety::{FrictionFrom, FrictionSpread, Prior};
use page::{Block, Finding, Tone, decimal};
use virtual_bench::Assumption;

use crate::wording::{self, number};

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

/// Friction of the dynamometer, and whence it is known.
pub(crate) fn friction(spread: &FrictionSpread) -> Block {
    let between = |(low, high): (f64, f64)| {
        format!("{} … {}", number::significant(low.max(0.0), 2), number::significant(high, 2))
    };
    let values = format!(
        "friction of the dynamometer, {} Nm and {} Nm s/rad; each bench has its own",
        between(spread.coulomb_nm),
        between(spread.viscous_nm_s_per_rad)
    );
    let finding = match spread.from {
        FrictionFrom::Estimated => Finding::new(Tone::Plain, "estimated", format!("{values}; estimated from run-outs")),
        FrictionFrom::Stated => Finding::new(Tone::Plain, "stated", values),
        FrictionFrom::Assumed => {
            let remedy = "State what `dynoid friction` estimates from a run-out, as `dynamometer_friction` and \
                          `dynamometer_coulomb_friction`.";
            Finding::new(Tone::Caution, "assumed", format!("{values}. {remedy}"))
        }
    };
    Block::Finding(finding)
}
