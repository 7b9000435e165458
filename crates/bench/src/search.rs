//! The largest value of a function of one variable.

const GOLDEN_RATIO: f64 = 0.618_033_988_749_894_9;
const STEPS: usize = 40;

/// Where `function` is largest between the bounds: the best of `tried` steps from one to the other, then a golden section
/// between its neighbours.
///
/// # Source
/// Kiefer, Proc. Amer. Math. Soc. 4 (1953) 502.
pub(crate) fn maximum((low, high): (f64, f64), tried: usize, function: impl Fn(f64) -> f64) -> f64 {
    let spacing = (high - low) / tried as f64;
    let points = (0..=tried).map(|k| low + k as f64 * spacing).map(|x| (x, function(x)));
    let (best, _) = points.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((low, 0.0));
    golden_section(((best - spacing).max(low), (best + spacing).min(high)), function)
}

/// Where `function` is largest if it has one maximum between the bounds.
pub(crate) fn golden_section((mut low, mut high): (f64, f64), function: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..STEPS {
        let (a, b) = (high - GOLDEN_RATIO * (high - low), low + GOLDEN_RATIO * (high - low));
        if function(a) < function(b) {
            low = a;
        } else {
            high = b;
        }
    }
    0.5 * (low + high)
}
