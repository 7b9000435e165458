//! What a prediction or a simulation takes for granted.

use page::{Block, Finding, Tone};
use virtual_bench::Assumption;

use crate::wording;

/// Each assumption as a finding.
pub(crate) fn assumptions(all: &[Assumption]) -> impl Iterator<Item = Block> + '_ {
    let finding = |assumption| Finding::new(Tone::Caution, "assumed", wording::assumption(assumption));
    all.iter().map(move |assumption| Block::Finding(finding(assumption)))
}
