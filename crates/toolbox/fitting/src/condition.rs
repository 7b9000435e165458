//! The condition number of a regression.

use faer::MatRef;
use numerics::linalg;

use crate::IdentError;

/// Singular values below this fraction of the largest, after columns are scaled to one, count as zero.
const RANK_TOLERANCE: f64 = 1e-12;
/// Condition number above which the parameters can hardly be separated.
pub const ILL_CONDITIONED: f64 = 1e8;

/// Condition number of a scaled triangular factor.
///
/// # Errors
/// Rank below the number of columns.
pub fn checked_condition(scaled: MatRef<'_, f64>) -> Result<f64, IdentError> {
    let values = linalg::singular_values(scaled)?;
    let largest = values.first().copied().unwrap_or(0.0);
    let smallest = values.last().copied().unwrap_or(0.0);
    let rank = values.iter().filter(|v| **v > RANK_TOLERANCE * largest && **v > 0.0).count();
    if rank < values.len() {
        return Err(IdentError::RankDeficient { rank, parameters: values.len(), condition: largest / smallest });
    }
    Ok(largest / smallest)
}
