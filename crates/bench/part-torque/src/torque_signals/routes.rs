//! By how much two routes to one torque differ beyond the noise of one of them.

/// Differences are averaged over so long, s.
const WINDOW_S: f64 = 1.0;
/// The mean square of a difference counts where it exceeds that of the noise by so many of its standard deviations.
const CLEARLY: f64 = 4.0;

/// Root of the mean square difference about each value, less that of noise of this variance and band; zero where noise
/// explains the difference.
///
/// A mean square over a window W of noise of the band b has the relative standard deviation 1/√(bW).
pub(super) fn beyond_noise(apart: &[f64], noise_variance: f64, step_s: f64, band_hz: f64) -> Vec<f64> {
    let half = (0.5 * WINDOW_S / step_s).round() as usize;
    let mut sums = vec![0.0];
    apart.iter().for_each(|x| sums.push(sums[sums.len() - 1] + x * x));
    let beyond = |k: usize| {
        let (from, to) = (k.saturating_sub(half), (k + half + 1).min(apart.len()));
        // At the ends the window is half as long.
        let by_noise = noise_variance * (1.0 + CLEARLY / (band_hz * (to - from) as f64 * step_s).sqrt());
        let mean_square = (sums[to] - sums[from]) / (to - from) as f64;
        if mean_square > by_noise { (mean_square - noise_variance).sqrt() } else { 0.0 }
    };
    (0..apart.len()).map(beyond).collect()
}

#[cfg(test)]
mod tests {
    use super::beyond_noise;
    use signal::excitation::Random;

    #[test]
    fn exact_what_noise_explains_is_nothing_and_a_sine_is_its_root_mean_square() {
        let mut random = Random::new(1);
        let noise: Vec<f64> = (0..6000).map(|_| 0.3 * random.normal()).collect();
        assert!(beyond_noise(&noise, 0.09, 1e-3, 120.0).iter().all(|beyond| *beyond == 0.0));
        let sine: Vec<f64> = noise.iter().zip(0..).map(|(x, k)| x + 5.0 * (0.1 * f64::from(k)).sin()).collect();
        let beyond = beyond_noise(&sine, 0.09, 1e-3, 120.0);
        assert!(beyond.iter().all(|beyond| (beyond - 5.0 / 2f64.sqrt()).abs() < 0.15), "{:?}", &beyond[..3]);
    }
}
