//! Drift between the clocks of two signals, estimated from the signals themselves.

use std::f64::consts::TAU;

use numerics::search;
use serde::{Deserialize, Serialize};

use crate::correlation::is_constant;
use crate::error::{SignalError, check_at_least, check_finite};
use crate::spectrum::SegmentTransform;
use crate::window::Window;
use crate::{Complex64, SignalView};

/// Stretches that the common time is cut into.
const SEGMENTS: usize = 16;
/// Samples of the slower signal that a stretch needs.
const SEGMENT_SAMPLES: usize = 64;
/// Samples of the faster signal from the beginning of a stretch that are transformed at most: of hours, to save memory.
const MOST_SAMPLES: f64 = (1 << 20) as f64;
/// Rates searched, either way: crystals differ by some 10⁻⁴, clocks of software by more.
const LARGEST_RATE: f64 = 2e-3;
/// Lines used at most; more would add time, not certainty.
const MOST_LINES: usize = 1000;
/// Share of the slower signal's band that is used: above it there are the flanks of anti-alias filters.
const BAND_SHARE: f64 = 0.8;
/// Steps of the search, either way, at most: where they would be more, as over hours, a narrower band is used.
const MOST_STEPS: f64 = 2000.0;
/// Steps of the search within the width of the peak.
const STEPS_PER_PEAK: f64 = 4.0;
/// How far the likelihood of the best rate must stand above that of unrelated signals, in standard deviations, and
/// above that of any other rate.
const SIGNIFICANCE: f64 = 6.0;
const LEAD: f64 = 10.0;
/// Neighbouring lines under a Hann window share this many lines' information.
const HANN_LINES: f64 = 1.5;
/// Bands of equal width that are left out in turn.
const BANDS: usize = 8;
/// A coherence closer to one than this is one: what is left is rounding and leakage.
const CLOSEST_COHERENCE: f64 = 1e-6;

/// How fast one clock runs away from another.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Drift {
    /// The second signal becomes later by so many seconds each second.
    pub rate: f64,
    /// Its standard error: the largest of the one the likelihood gives and those of leaving out each stretch and each
    /// band of frequencies in turn. A clock makes all frequencies late by the same time; what one band alone shows is
    /// none.
    pub standard_error: f64,
}

/// How fast `later` becomes later than `earlier`, for two signals with any relation that is linear and does not change
/// with time; their sample times may differ, and their stamps may be offset.
///
/// The common time is cut into sixteen stretches, of each of which the first million samples of the faster signal
/// count. With `S_k(f)` the cross-periodogram of stretch `k`, which begins at `t_k`, the rate `r` is where
/// `−Σ_f ln(1 − γ²(f, r))` is largest, `γ²` being the coherence of the stretches after each is turned by
/// `e^{j2πf r t_k}`: the likelihood of Gaussian signals. Rates up to 2·10⁻³ are searched. Where the signals have too
/// little in common, or several rates are as likely (as of a single line), the standard error is of that size.
///
/// # Errors
/// [`SignalError::TooShort`] under 1024 samples of the slower in the common time; [`SignalError::Constant`],
/// [`SignalError::NonFinite`].
///
/// # Example
/// ```
/// use signal::{Signal, drift::relative_drift, excitation::Random};
/// let mut random = Random::new(1);
/// // A sum of sines, and the same on a clock that counts 100 µs too much each second.
/// let lines: Vec<[f64; 2]> = (0..40).map(|_| [1.0 + 30.0 * random.uniform(), 6.3 * random.uniform()]).collect();
/// let at = |t: f64| lines.iter().map(|[f, phase]| (std::f64::consts::TAU * f * t + phase).sin()).sum::<f64>();
/// let x = Signal::new(0.0, 0.01, (0..3000).map(|i| at(0.01 * i as f64)).collect())?;
/// let y = Signal::new(0.0, 0.01, (0..3000).map(|i| at(0.01 * i as f64 * (1.0 - 1e-4))).collect())?;
/// let found = relative_drift(&x, &y)?;
/// assert!((found.rate - 1e-4).abs() < 1e-6 && found.standard_error < 1e-5);
/// # Ok::<(), signal::SignalError>(())
/// ```
///
/// # Source
/// Knapp and Carter, *The generalized correlation method for estimation of time delay*, IEEE Trans. ASSP 24, 1976, for
/// the likelihood; Betz, *Comparison of the deskewed short-time correlator and the maximum likelihood correlator*, IEEE
/// Trans. ASSP 32, 1984, for turning short stretches.
pub fn relative_drift<'a>(
    earlier: impl Into<SignalView<'a>>,
    later: impl Into<SignalView<'a>>,
) -> Result<Drift, SignalError> {
    let stretches = Stretches::of(earlier.into(), later.into())?;
    let step = 1.0 / (stretches.highest_hz * stretches.duration_s) / STEPS_PER_PEAK;
    let (best, second) = stretches.likeliest(step);
    let rate = stretches.refined(best, step, |_| true);
    let likelihood = |rate: f64| stretches.log_likelihood(rate, |_| true, |_| true);
    let is_rival = |other: f64| likelihood(stretches.refined(other, step, |_| true)) > likelihood(rate) - LEAD;
    if !stretches.is_related(rate) || second.is_some_and(is_rival) {
        return Ok(Drift { rate, standard_error: LARGEST_RATE });
    }
    let without: Vec<f64> = (0..SEGMENTS).map(|out| stretches.without(out, rate, best, step)).collect();
    let standard_error = jackknife(&without)
        .max(jackknife(&stretches.without_bands(rate, step)))
        .max(stretches.curvature_error(rate, 0.1 * step))
        .min(LARGEST_RATE);
    Ok(Drift { rate, standard_error })
}

/// Standard error of an estimate from those that each leave out one part of the data.
fn jackknife(without: &[f64]) -> f64 {
    let count = without.len() as f64;
    let mean = without.iter().sum::<f64>() / count;
    ((count - 1.0) / count * without.iter().map(|r| (r - mean).powi(2)).sum::<f64>()).sqrt()
}

/// Cross-periodograms of the stretches, each line divided by the root of both signals' mean power.
struct Stretches {
    /// Line by line, the stretches of a line one after another.
    cross: Vec<Complex64>,
    freq_hz: Vec<f64>,
    highest_hz: f64,
    /// From the beginning of a stretch to that of the next.
    stretch_s: f64,
    duration_s: f64,
}

impl Stretches {
    fn of(earlier: SignalView<'_>, later: SignalView<'_>) -> Result<Self, SignalError> {
        let from_s = earlier.start_s.max(later.start_s);
        let to_s = earlier.end_s().min(later.end_s());
        let (faster_s, slower_s) =
            (earlier.sample_time_s.min(later.sample_time_s), earlier.sample_time_s.max(later.sample_time_s));
        let samples = ((to_s - from_s) / slower_s).floor().max(0.0) as usize;
        check_at_least(SEGMENTS * SEGMENT_SAMPLES, samples)?;
        let stretch_s = (samples / SEGMENTS) as f64 * slower_s;
        let most_s = (MOST_SAMPLES * faster_s / slower_s).floor().max(SEGMENT_SAMPLES as f64) * slower_s;
        let transformed_s = stretch_s.min(most_s);
        let duration_s = SEGMENTS as f64 * stretch_s;
        let searched_hz = MOST_STEPS / (STEPS_PER_PEAK * LARGEST_RATE * duration_s);
        let highest_hz = (0.5 * BAND_SHARE / slower_s).min(searched_hz);
        let last = (highest_hz * transformed_s) as usize;
        let every = last.div_ceil(MOST_LINES).max(1);
        // Below the second line a linear trend reaches through the window.
        let lines = || (2..=last).step_by(every);
        let of = |signal: SignalView<'_>| transforms(signal, from_s, stretch_s, transformed_s, lines);
        let (x, y) = (of(earlier)?, of(later)?);
        let mut found = Stretches { cross: Vec::new(), freq_hz: Vec::new(), highest_hz, stretch_s, duration_s };
        for (index, line) in lines().enumerate() {
            found.add(line as f64 / transformed_s, index, &x, &y);
        }
        Ok(found)
    }

    /// Takes in a line, unless a signal has no power there.
    fn add(&mut self, freq_hz: f64, index: usize, x: &[Transform], y: &[Transform]) {
        let power = |of: &[Transform]| of.iter().map(|t| t.lines[index].norm_sqr()).sum::<f64>();
        let scale = 1.0 / (power(x) * power(y)).sqrt();
        if !scale.is_finite() {
            return;
        }
        self.freq_hz.push(freq_hz);
        self.cross.extend(x.iter().zip(y).map(|(x, y)| {
            // The first samples of a stretch are not taken at the same instant.
            let turned = Complex64::cis(-TAU * freq_hz * (y.start_s - x.start_s));
            x.lines[index].conj() * y.lines[index] * turned * scale
        }));
    }

    /// The likeliest of the rates a step apart, and the likeliest of the other local maxima.
    fn likeliest(&self, step: f64) -> (f64, Option<f64>) {
        let count = (LARGEST_RATE / step).ceil() as i64;
        let tried: Vec<f64> =
            (-count..=count).map(|i| self.log_likelihood(i as f64 * step, |_| true, |_| true)).collect();
        let largest = |of: &mut dyn Iterator<Item = usize>| of.max_by(|a, b| tried[*a].total_cmp(&tried[*b]));
        let best = largest(&mut (0..tried.len())).unwrap_or(0);
        let is_peak = |i: &usize| tried[*i - 1] <= tried[*i] && tried[*i] >= tried[*i + 1];
        let others = (1..tried.len().saturating_sub(1)).filter(|i| i.abs_diff(best) > 1 && is_peak(i));
        let second = largest(&mut others.into_iter());
        let rate = |i: usize| (i as i64 - count) as f64 * step;
        (rate(best), second.map(rate))
    }

    /// The likeliest rate within a step of this one, from the stretches that are kept.
    fn refined(&self, rate: f64, step: f64, kept: impl Fn(usize) -> bool) -> f64 {
        search::maximum((rate - step, rate + step), 1e-4 * step, |rate| self.log_likelihood(rate, &kept, |_| true))
    }

    /// The likeliest rates, each from all bands but one: anywhere, since without the band that showed it a rate may be
    /// gone.
    fn without_bands(&self, rate: f64, step: f64) -> Vec<f64> {
        let lines = self.freq_hz.len();
        let without = |out: usize| {
            let is_kept = |line: usize| line * BANDS / lines != out;
            let likelihood = |rate: f64| self.log_likelihood(rate, |_| true, is_kept);
            let count = (LARGEST_RATE / step).ceil() as i64;
            let tried = (-count..=count).map(|i| i as f64 * step).chain([rate]);
            let rated = tried.map(|rate| (rate, likelihood(rate)));
            let (best, _) = rated.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((rate, 0.0));
            search::maximum((best - step, best + step), 1e-3 * step, likelihood)
        };
        (0..BANDS).map(without).collect()
    }

    /// The likeliest rate within a step of the best from all stretches but one: by a step of Newton's from the
    /// likeliest rate of all, or where the likelihood is not rounded there, by a search.
    fn without(&self, out: usize, rate: f64, best: f64, step: f64) -> f64 {
        let (slope, curvature) = self.derivatives(rate, out);
        let found = rate - slope / curvature;
        if curvature < 0.0 && (found - best).abs() < step {
            return found;
        }
        self.refined(best, step, |k| k != out)
    }

    /// First and second derivative of the likelihood of all stretches but one by the rate, but for its factor.
    fn derivatives(&self, rate: f64, out: usize) -> (f64, f64) {
        work::checkpoint();
        let of_line = |(freq_hz, cross): (&f64, &[Complex64])| {
            let angle = TAU * freq_hz * self.stretch_s;
            let step = Complex64::cis(angle * rate);
            let mut turn = Complex64::ONE;
            let (mut sum, mut first, mut second) = (Complex64::ZERO, Complex64::ZERO, Complex64::ZERO);
            for (k, s) in cross.iter().enumerate() {
                if k != out {
                    let (part, slope) = (s * turn, angle * k as f64);
                    sum += part;
                    first += part * Complex64::new(0.0, slope);
                    second -= part * (slope * slope);
                }
                turn *= step;
            }
            let left = 1.0 - sum.norm_sqr();
            if left < CLOSEST_COHERENCE {
                return (0.0, 0.0);
            }
            let slope = 2.0 * (sum.conj() * first).re / left;
            let curvature = 2.0 * (first.norm_sqr() + (sum.conj() * second).re) / left;
            (slope, curvature + slope * slope)
        };
        let lines = self.freq_hz.iter().zip(self.cross.chunks_exact(SEGMENTS)).map(of_line);
        lines.fold((0.0, 0.0), |all, line| (all.0 + line.0, all.1 + line.1))
    }

    /// Returns true if the signals are coherent beyond chance. γ² of unrelated ones is Beta(1, K−1) distributed, so
    /// that −K ln(1 − γ²) has the mean and the standard deviation K/(K−1).
    fn is_related(&self, rate: f64) -> bool {
        let lines = self.freq_hz.len() as f64 / HANN_LINES;
        let each = SEGMENTS as f64 / (SEGMENTS as f64 - 1.0);
        self.log_likelihood(rate, |_| true, |_| true) > each * (lines + SIGNIFICANCE * lines.sqrt())
    }

    /// From the stretches and the lines that are kept.
    fn log_likelihood(&self, rate: f64, kept: impl Fn(usize) -> bool, kept_line: impl Fn(usize) -> bool) -> f64 {
        work::checkpoint();
        let of_line = |(freq_hz, cross): (&f64, &[Complex64])| {
            let step = Complex64::cis(TAU * freq_hz * rate * self.stretch_s);
            let (mut sum, mut turn) = (Complex64::ZERO, Complex64::ONE);
            for (k, s) in cross.iter().enumerate() {
                if kept(k) {
                    sum += s * turn;
                }
                turn *= step;
            }
            -(1.0 - sum.norm_sqr()).max(CLOSEST_COHERENCE).ln()
        };
        let lines = self.freq_hz.iter().zip(self.cross.chunks_exact(SEGMENTS)).enumerate();
        let sum: f64 = lines.filter(|(line, _)| kept_line(*line)).map(|(_, line)| of_line(line)).sum();
        SEGMENTS as f64 / HANN_LINES * sum
    }

    /// Standard error from the curvature of the likelihood at its peak.
    fn curvature_error(&self, rate: f64, step: f64) -> f64 {
        let at = |rate| self.log_likelihood(rate, |_| true, |_| true);
        let curvature = (2.0 * at(rate) - at(rate - step) - at(rate + step)) / (step * step);
        if curvature > 0.0 { curvature.sqrt().recip() } else { f64::INFINITY }
    }
}

/// Lines of a stretch's Fourier transform and the instant of its first sample.
struct Transform {
    start_s: f64,
    lines: Vec<Complex64>,
}

/// Of each stretch the transform of so much of its beginning, its mean removed, under a Hann window.
fn transforms<I: Iterator<Item = usize>>(
    signal: SignalView<'_>,
    from_s: f64,
    stretch_s: f64,
    transformed_s: f64,
    lines: impl Fn() -> I,
) -> Result<Vec<Transform>, SignalError> {
    check_finite(signal.samples)?;
    let length = (transformed_s / signal.sample_time_s).round() as usize;
    let window = Window::Hann.periodic(length)?;
    if is_constant(signal.samples) {
        return Err(SignalError::Constant);
    }
    let mut transform = SegmentTransform::new(&window);
    let of_stretch = |k: usize| {
        let wanted =
            ((from_s + k as f64 * stretch_s - signal.start_s) / signal.sample_time_s).round().max(0.0) as usize;
        let first = wanted.min(signal.samples.len() - length);
        let all = transform.apply(&signal.samples[first..first + length])?;
        Ok(Transform { start_s: signal.time_s(first), lines: lines().map(|line| all[line]).collect() })
    };
    (0..SEGMENTS).map(of_stretch).collect()
}
