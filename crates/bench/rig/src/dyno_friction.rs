//! The friction that a dynamometer has beside its air-gap torque, as far as nothing but its class is known.

/// Coulomb friction over the torque limit at the most. Bearings, seals and the fan of asynchronous machines have 0.2 …
/// 2 % of the torque limit at 300 rad/s; this and [`MOST_SLOPE_S_PER_RAD`] make 2 % there.
pub const MOST_COULOMB: f64 = 4e-3;
/// Slope of friction over speed, over the torque limit, at the most, s/rad.
pub const MOST_SLOPE_S_PER_RAD: f64 = 5e-5;
/// Standard uncertainty of stated friction unless that is stated, % of it: friction changes with the temperature of the
/// oil.
pub const DOUBT_PERCENT: f64 = 20.0;
