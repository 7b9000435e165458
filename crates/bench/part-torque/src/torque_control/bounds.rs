//! Where delays and lags are looked for.

use std::ops::RangeInclusive;

/// The longest delay looked for, s.
pub(super) const LONGEST_DELAY_S: f64 = 0.02;

/// By how much T_d,calc may be dated before the demand that it follows, s: as far as clocks of rasters are apart.
pub(super) const EARLIEST_S: f64 = 0.005;

/// Range of the lag, rad/s.
pub(super) const LAG_RAD_S: RangeInclusive<f64> = 20.0..=2e4;
