//! What recordings are to an estimate.

use ident::Source;
use ident::validate::TestData;

/// What data are to an estimate: its own where a part of them is.
pub(super) fn which_data(sources: &[Source], of_the_estimate: &[Source]) -> TestData {
    let shared = |source: &Source| of_the_estimate.iter().any(|own| own.overlaps(source));
    if sources.iter().any(shared) { TestData::Own } else { TestData::Unseen }
}
