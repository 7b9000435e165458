//! How many lines of frequency an input moves the output by: each gives a gain and a phase, and no more.

use std::f64::consts::TAU;

use lti::TransferFunction;
use signal::Complex64;
use signal::spectrum::fft_real;
use signal::window::Window;

use crate::Dataset;

/// Lines counted at most: more than any model here takes.
const MOST: usize = 8;

/// A share of the power below this is left to noise and rounding.
const NEGLIGIBLE: f64 = 1e-4;

/// Bins to either side of a line that the window blurs it over.
const LOBE: usize = 4;

/// The lines that carry an input's part of the output.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Lines {
    /// Frequencies, the strongest of each experiment first.
    pub(crate) all_hz: Vec<f64>,
}

impl Lines {
    /// The fewest lines without which less than `share` of the power of an input behind a system is left, at most [`MOST`].
    pub(crate) fn of(data: &Dataset, input: usize, system: Option<&TransferFunction>, share: f64) -> Self {
        let mut experiments: Vec<&[f64]> = data.experiments().iter().map(|e| e.input(input)).collect();
        experiments.sort_by_key(|x| std::cmp::Reverse(x.len()));
        let mut all_hz: Vec<f64> = Vec::new();
        for x in experiments {
            let bin_hz = 1.0 / (x.len().max(1) as f64 * data.sample_time_s());
            let apart = |a: f64, b: f64| (a - b).abs() > LOBE as f64 * bin_hz;
            let power = power(x, bin_hz, system);
            for line in strongest(power, share.max(NEGLIGIBLE)).into_iter().map(|bin| bin as f64 * bin_hz) {
                if all_hz.len() < MOST && all_hz.iter().all(|known| apart(*known, line)) {
                    all_hz.push(line);
                }
            }
        }
        Lines { all_hz }
    }
}

/// The power of an input behind a system, bin by bin; a delay does not bear on it.
fn power(x: &[f64], bin_hz: f64, system: Option<&TransferFunction>) -> Vec<f64> {
    let taper = Window::Blackman.periodic(x.len()).unwrap_or_default();
    let known = || x.iter().zip(&taper).filter(|(v, _)| !v.is_nan());
    let level = known().map(|(v, w)| v * w).sum::<f64>() / known().map(|(_, w)| w).sum::<f64>();
    let tapered: Vec<f64> = x.iter().zip(&taper).map(|(v, w)| if v.is_nan() { 0.0 } else { (v - level) * w }).collect();
    let gain = |bin: usize| {
        let at = Complex64::new(0.0, TAU * bin as f64 * bin_hz);
        system.map_or(1.0, |system| system.evaluate(at).norm_sqr())
    };
    let spectrum = fft_real(&tapered).unwrap_or_default();
    let power = spectrum.iter().enumerate().map(|(bin, v)| v.norm_sqr() * gain(bin));
    power.map(|p| if p.is_finite() { p } else { 0.0 }).collect()
}

/// The bins of the strongest lines, one after another, until less than a share of the power is left.
fn strongest(mut power: Vec<f64>, share: f64) -> Vec<usize> {
    let enough = share * power.iter().sum::<f64>();
    let mut found = Vec::new();
    while found.len() < MOST && power.iter().sum::<f64>() > enough {
        let Some(top) = (0..power.len()).max_by(|a, b| power[*a].total_cmp(&power[*b])) else { break };
        let end = (top + LOBE + 1).min(power.len());
        power[top.saturating_sub(LOBE)..end].fill(0.0);
        found.push(top);
    }
    found
}
