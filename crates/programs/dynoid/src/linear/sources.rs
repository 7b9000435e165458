//! Relation of recordings to an estimate.

use ident::Source;
use ident::validate::TestData;

/// Relation of data to an estimate: its own where a part of them is.
pub fn which_data(sources: &[Source], of_the_estimate: &[Source]) -> TestData {
    let shared = |source: &Source| of_the_estimate.iter().any(|own| own.overlaps(source));
    if sources.iter().any(shared) { TestData::Own } else { TestData::Unseen }
}
