//! The cubic through two points with their slopes.

/// The cubic (Hermite's) at a part `u`, 0 … 1, of the way from one point to the next. Points are values, and slopes a
/// way.
pub(crate) fn between((from, slope_from): (f64, f64), (to, slope_to): (f64, f64), u: f64) -> f64 {
    let (v, rise) = (1.0 - u, to - from);
    from + u * rise + u * v * (v * (slope_from - rise) - u * (slope_to - rise))
}
