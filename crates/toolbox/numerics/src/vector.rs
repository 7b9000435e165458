//! Sums and products of slices.

/// Independent partial sums of a scalar product: as many as fill the vector registers.
const LANES: usize = 16;
/// Deviation from a constant that rounding explains, in parts of its size.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The scalar product `Σ x_i y_i` over the length of the shorter slice.
///
/// Long slices are summed in independent lanes, which vector registers hold; the order of the sum is fixed.
///
/// # Example
/// ```
/// assert_eq!(numerics::vector::dot(&[1.0, 2.0, 3.0], &[4.0, 5.0, 6.0]), 32.0);
/// ```
#[must_use]
pub fn dot(x: &[f64], y: &[f64]) -> f64 {
    let length = x.len().min(y.len());
    let (xs, ys) = (x[..length].chunks_exact(LANES), y[..length].chunks_exact(LANES));
    let rest: f64 = xs.remainder().iter().zip(ys.remainder()).map(|(a, b)| a * b).sum();
    if length < LANES {
        return rest;
    }
    let mut sums = [0.0; LANES];
    for (a, b) in xs.zip(ys) {
        for i in 0..LANES {
            sums[i] += a[i] * b[i];
        }
    }
    sums.iter().sum::<f64>() + rest
}

/// The sum of squares `Σ x_i²`.
#[must_use]
pub fn sum_of_squares(x: &[f64]) -> f64 {
    dot(x, x)
}

/// The Euclidean norm `√(Σ x_i²)`.
///
/// # Example
/// ```
/// assert_eq!(numerics::vector::norm(&[3.0, -4.0]), 5.0);
/// ```
#[must_use]
pub fn norm(x: &[f64]) -> f64 {
    sum_of_squares(x).sqrt()
}

/// The mean square `Σ x_i² / n`; zero of an empty slice.
#[must_use]
pub fn mean_square(x: &[f64]) -> f64 {
    sum_of_squares(x) / x.len().max(1) as f64
}

/// The root mean square; zero of an empty slice.
///
/// # Example
/// ```
/// assert_eq!(numerics::vector::root_mean_square(&[2.0, -2.0]), 2.0);
/// ```
#[must_use]
pub fn root_mean_square(x: &[f64]) -> f64 {
    mean_square(x).sqrt()
}

/// Adds `factor · x` to `y`, over the length of the shorter slice.
#[inline]
pub fn add_scaled(factor: f64, x: &[f64], y: &mut [f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += factor * x);
}

/// The root of the mean squared deviation from the mean, in the unit of the values; NaN of none.
///
/// # Example
/// ```
/// assert_eq!(numerics::vector::standard_deviation(&[1.0, 3.0]), 1.0);
/// ```
pub fn standard_deviation(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt()
}

/// The variation about the mean, `Σ (y − ȳ)²`; `None` where the values are one constant but for rounding.
///
/// `values` is run through three times.
///
/// # Example
/// ```
/// assert_eq!(numerics::vector::variation(|| [1.0, 3.0].into_iter()), Some(2.0));
/// assert_eq!(numerics::vector::variation(|| [0.1; 7].into_iter()), None);
/// ```
pub fn variation<I: Iterator<Item = f64>>(values: impl Fn() -> I) -> Option<f64> {
    let (mut count, mut sum, mut size) = (0_usize, 0.0, 0.0);
    values().for_each(|v| {
        (count, sum, size) = (count + 1, sum + v, size + v * v);
    });
    let first = sum / count as f64;
    // The rounding of a long sum is taken off again.
    let mean = first + values().map(|v| v - first).sum::<f64>() / count as f64;
    let about: f64 = values().map(|v| (v - mean).powi(2)).sum();
    (about > ROUNDING * ROUNDING * size).then_some(about)
}
