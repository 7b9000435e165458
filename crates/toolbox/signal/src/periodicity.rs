//! Periodic parts of a record: single sinusoids, harmonic series, and whether the whole repeats.

use std::f64::consts::{LN_2, PI, TAU};

use numerics::order::upper_median;
use numerics::search;

use crate::Complex64;
use crate::correlation::{auto_correlation, is_constant};
use crate::error::{SignalError, check_at_least, check_finite, check_range, check_same_length, check_sample_time};
use crate::series::mean;
use crate::spectrum::{fft_real, fourier_sum};

/// Bins on each side whose median gives the noise about a line.
const NEIGHBOURS: usize = 100;
/// Samples over which a phasor turns before rounding is taken out, and those at which it is known at once.
const STRAIGHT: usize = 256;
const LANES: usize = 8;
/// Within this part of a bin of its centre, a [`Demodulated`] record of a thousand samples or more has Fourier sums to
/// rounding.
const NEAR: f64 = 0.01;

/// A sinusoid, `amplitude · cos(2π freq_hz t + phase_rad)` with `t = 0` at the first sample, with standard deviations
/// for noise that is white about its frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sinusoid {
    /// Frequency in hertz.
    pub freq_hz: f64,
    /// Amplitude, positive.
    pub amplitude: f64,
    /// Phase in radians, −π to π.
    pub phase_rad: f64,
    /// Standard deviation of the frequency, in hertz.
    pub freq_deviation_hz: f64,
    /// Standard deviation of the amplitude.
    pub amplitude_deviation: f64,
    /// Standard deviation of the phase, in radians.
    pub phase_deviation_rad: f64,
    /// Probability that noise alone shows a line this strong anywhere in its spectrum.
    pub false_alarm: f64,
}

/// The sinusoids that stand out from the noise, strongest first, at most `max_count` of them.
///
/// One after the other is found at the largest line (relative to the noise about it) of what is left, and all are
/// refined in turn by maximising their Fourier sum with the others taken off, which reaches far below a bin; it stops
/// at one that noise would show with a probability above `false_alarm`. The mean is removed. Sinusoids closer than
/// about two bins (`2/(N·T)` hertz) are not separated. Noise is estimated by the median of 200 neighbouring lines.
///
/// # Errors
/// [`SignalError::TooShort`] for fewer than 32 samples, [`SignalError::Constant`], [`SignalError::Parameter`] for a
/// probability outside 0 ..= 1, [`SignalError::NonFinite`], [`SignalError::SampleTime`].
///
/// # Example
/// ```
/// use signal::excitation::Random;
/// let mut random = Random::new(2);
/// let x: Vec<f64> = (0..1000).map(|t| (1.2345 * t as f64 + 0.5).cos() + 0.5 * random.normal()).collect();
/// let found = signal::periodicity::find_sinusoids(&x, 1.0, 5, 1e-3)?;
/// assert_eq!(found.len(), 1);
/// assert!((found[0].freq_hz * std::f64::consts::TAU - 1.2345).abs() < 3e-4 && found[0].false_alarm < 1e-12);
/// # Ok::<(), signal::SignalError>(())
/// ```
///
/// # Source
/// Li, J. and Stoica, P. (1996), IEEE Trans. Signal Process. 44(2), 281–295 (RELAX); deviations: Stoica and Moses
/// (2005), *Spectral Analysis of Signals*, (4.2.11).
pub fn find_sinusoids(
    x: &[f64],
    sample_time_s: f64,
    max_count: usize,
    false_alarm: f64,
) -> Result<Vec<Sinusoid>, SignalError> {
    check_sample_time(sample_time_s)?;
    check_at_least(32, x.len())?;
    check_finite(x)?;
    check_range("false_alarm", false_alarm, 0.0, 1.0)?;
    if is_constant(x) {
        return Err(SignalError::Constant);
    }
    let level = mean(x).unwrap_or(0.0);
    let mut left: Vec<f64> = x.iter().map(|v| v - level).collect();
    // Below this a line is rounding.
    let rounding = 1e-13 * x.iter().map(|v| v * v).sum::<f64>().sqrt();
    let mut lines: Vec<Line> = Vec::new();
    while lines.len() < max_count {
        let (bin, strength) = strongest(&left)?;
        let candidate = Line::near(&left, bin as f64 / x.len() as f64);
        if probability(strength, x.len()) > false_alarm || candidate.value.norm() < rounding {
            break;
        }
        candidate.add(&mut left, -1.0);
        lines.push(candidate);
        if lines.len() > 1 {
            relax(&mut lines, &mut left);
        }
    }
    let power: Vec<f64> = fft_real(&left)?.iter().map(|v| v.norm_sqr()).collect();
    let mut found: Vec<Sinusoid> = lines.iter().map(|line| line.describe(&power, x.len(), sample_time_s)).collect();
    found.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
    Ok(found)
}

/// Refines every line with the others taken off, until none moves.
fn relax(lines: &mut [Line], left: &mut [f64]) {
    for _ in 0..20 {
        let mut moved = 0.0_f64;
        for line in lines.iter_mut() {
            line.add(left, 1.0);
            let refined = Line::near(left, line.turns);
            moved = moved.max((refined.value - line.value).norm() / refined.value.norm());
            *line = refined;
            line.add(left, -1.0);
        }
        if moved < 1e-6 {
            break;
        }
    }
}

/// The bin whose power stands out most from those about it, and by how much: its power over the mean of the noise.
fn strongest(x: &[f64]) -> Result<(usize, f64), SignalError> {
    let power: Vec<f64> = fft_real(x)?.iter().map(|v| v.norm_sqr()).collect();
    let bins = 1..=(x.len() - 1) / 2;
    let mut best = (1, 0.0);
    let mut noise = 0.0;
    for k in bins {
        // The median moves slowly: a new one every few bins serves.
        if (k - 1).is_multiple_of(NEIGHBOURS / 4) {
            noise = noise_about(&power, x.len(), k + NEIGHBOURS / 8);
        }
        let strength = if noise > 0.0 {
            power[k] / noise
        } else if power[k] > 0.0 {
            f64::INFINITY
        } else {
            0.0
        };
        if strength > best.1 || (strength == f64::INFINITY && power[k] > power[best.0]) {
            best = (k, strength);
        }
    }
    Ok(best)
}

/// Mean power of the noise about a bin: the median over `ln 2`, which a few lines do not disturb.
fn noise_about(power: &[f64], length: usize, k: usize) -> f64 {
    let last = (length - 1) / 2;
    let width = (2 * NEIGHBOURS).min(last);
    let first = k.saturating_sub(NEIGHBOURS).clamp(1, last + 1 - width);
    let mut window = power[first..first + width].to_vec();
    upper_median(&mut window).unwrap_or(0.0) / LN_2
}

/// That the largest of `N/2` exponentially distributed powers exceeds `strength` times their mean.
fn probability(strength: f64, length: usize) -> f64 {
    -(length as f64 / 2.0 * (-(-strength).exp()).ln_1p()).exp_m1()
}

/// A sinusoid `2 Re(value · e^{j2π turns t})`, `t` counted in samples.
#[derive(Clone, Copy)]
struct Line {
    turns: f64,
    value: Complex64,
}

impl Line {
    /// Least squares at the frequency within a bin of `turns` where the power explained is largest.
    fn near(x: &[f64], turns: f64) -> Self {
        let bin = 1.0 / x.len() as f64;
        let (low, high) = ((turns - bin).max(0.25 * bin), (turns + bin).min(0.5 - 0.25 * bin));
        let coarse = Demodulated::new(x, turns);
        let explained = |turns: f64| Self::fit(coarse.sum_at(turns), turns, x.len()).1;
        // A bin to either side may hold more than one peak.
        let at = |i: i32| low + (high - low) * f64::from(i) / 8.0;
        let best = (0..=8).max_by(|a, b| explained(at(*a)).total_cmp(&explained(at(*b)))).unwrap_or(4);
        let turns = search::maximum((at((best - 1).max(0)), at((best + 1).min(8))), 1e-5 * bin, explained);
        // Near its centre what was summed up in blocks serves.
        let fine = if (turns - coarse.centre).abs() < NEAR * bin { coarse } else { Demodulated::new(x, turns) };
        let explained = |turns: f64| Self::fit(fine.sum_at(turns), turns, x.len()).1;
        let turns = search::maximum((turns - 1e-3 * bin, turns + 1e-3 * bin), 1e-8 * bin, explained);
        Self { turns, value: Self::fit(fine.sum_at(turns), turns, x.len()).0 }
    }

    /// The least-squares sinusoid of a frequency from the Fourier sum there, exact also where it does not fit the
    /// record a whole number of times, and the power it explains.
    fn fit(sum: Complex64, turns: f64, length: usize) -> (Complex64, f64) {
        let n = length as f64;
        // value·n + conj(value)·Σ e^{−j4π turns t} = sum
        let mirror = geometric(-2.0 * TAU * turns, length);
        let value = (sum * n - mirror * sum.conj()) / (n * n - mirror.norm_sqr());
        (value, 2.0 * (value.conj() * sum).re)
    }

    fn add(&self, x: &mut [f64], sign: f64) {
        let value = 2.0 * sign * self.value;
        for (index, block) in work::checked(x.chunks_mut(STRAIGHT)).enumerate() {
            let mut turning = Turning::new(value * from_start(self.turns, index * STRAIGHT), self.turns);
            for part in block.chunks_mut(LANES) {
                part.iter_mut().zip(turning.re).for_each(|(v, re)| *v += re);
                turning.go_on();
            }
        }
    }

    /// In physical units, with the deviations that noise of the power about the line gives.
    fn describe(&self, power_left: &[f64], length: usize, sample_time_s: f64) -> Sinusoid {
        let n = length as f64;
        let noise = noise_about(power_left, length, (self.turns * n).round() as usize) / n;
        let amplitude = 2.0 * self.value.norm();
        let ratio = noise / (amplitude * amplitude);
        Sinusoid {
            freq_hz: self.turns / sample_time_s,
            amplitude,
            phase_rad: self.value.arg(),
            freq_deviation_hz: (24.0 * ratio / (n * (n * n - 1.0))).sqrt() / (TAU * sample_time_s),
            amplitude_deviation: (2.0 * noise / n).sqrt(),
            phase_deviation_rad: (8.0 * ratio / n).sqrt().min(PI),
            false_alarm: probability(0.25 * n / ratio.max(f64::MIN_POSITIVE), length),
        }
    }
}

/// A record shifted down by `centre` in frequency and summed up in blocks, so that Fourier sums within a bin or so of
/// it cost next to nothing: in each block the rest of the rotation is taken to second order.
struct Demodulated {
    centre: f64,
    /// Samples of each block but the last, and how many of these there are.
    length: usize,
    whole: usize,
    /// Moments of order 0, 1 and 2 of each such block about its middle, real and imaginary, and of nothing up to whole
    /// lanes.
    moments: [[Vec<f64>; 2]; 3],
    /// The middle of the last block and its moments.
    last: (f64, [Complex64; 3]),
}

impl Demodulated {
    fn new(x: &[f64], centre: f64) -> Self {
        const SMALLEST: usize = 16;
        let length = (x.len() / 256).max(SMALLEST);
        let of_block = |start: usize, block: &[f64]| {
            let middle = 0.5 * (block.len() as f64 - 1.0);
            let mut moments = [Complex64::ZERO; 3];
            for (part, samples) in work::checked(block.chunks(STRAIGHT)).enumerate() {
                let first = part * STRAIGHT;
                let factor = from_start(-centre, start + first);
                add_moments(samples, Turning::new(factor, -centre), first as f64 - middle, &mut moments);
            }
            (start as f64 + middle, moments)
        };
        let whole = x.len().saturating_sub(1) / length;
        let mut moments: [[Vec<f64>; 2]; 3] = Default::default();
        for (index, block) in x.chunks(length).take(whole).enumerate() {
            for ([re, im], moment) in moments.iter_mut().zip(of_block(index * length, block).1) {
                re.push(moment.re);
                im.push(moment.im);
            }
        }
        moments.iter_mut().flatten().for_each(|all| all.resize(whole.next_multiple_of(LANES), 0.0));
        let last = of_block(whole * length, &x[whole * length..]);
        Self { centre, length, whole, moments, last }
    }

    fn sum_at(&self, turns: f64) -> Complex64 {
        let shift = TAU * (turns - self.centre);
        let square = -0.5 * shift * shift;
        let (end, [sum, first, second]) = &self.last;
        let rest = Complex64::cis(-shift * end) * (sum - Complex64::new(0.0, shift) * first + second * square);
        if self.whole == 0 {
            return rest;
        }
        // Whole blocks are as long as each other, and turn on by the same angle.
        let middle = 0.5 * (self.length as f64 - 1.0);
        let turns_on = (self.centre - turns) * self.length as f64;
        let mut turning = Turning::new(Complex64::cis(-shift * middle), turns_on);
        let mut sums = [[0.0; LANES]; 2];
        let [[sum_re, sum_im], [first_re, first_im], [second_re, second_im]] =
            self.moments.each_ref().map(|both| both.each_ref().map(|all| all.as_chunks::<LANES>().0));
        for k in 0..sum_re.len() {
            for lane in 0..LANES {
                let re = sum_re[k][lane] + shift * first_im[k][lane] + square * second_re[k][lane];
                let im = sum_im[k][lane] - shift * first_re[k][lane] + square * second_im[k][lane];
                sums[0][lane] += turning.re[lane] * re - turning.im[lane] * im;
                sums[1][lane] += turning.re[lane] * im + turning.im[lane] * re;
            }
            turning.go_on();
        }
        let [re, im] = sums;
        rest + Complex64::new(re.iter().sum(), im.iter().sum())
    }
}

/// Adds the moments of order 0, 1 and 2 of samples that turn, the first of them at this distance from the middle.
fn add_moments(samples: &[f64], mut turning: Turning, first: f64, moments: &mut [Complex64; 3]) {
    let mut sums = [[[0.0; LANES]; 2]; 3];
    let mut distances: [f64; LANES] = std::array::from_fn(|lane| first + lane as f64);
    let mut add = |part: &[f64; LANES]| {
        for lane in 0..LANES {
            let (distance, value) = (distances[lane], [part[lane] * turning.re[lane], part[lane] * turning.im[lane]]);
            for (k, value) in value.into_iter().enumerate() {
                sums[0][k][lane] += value;
                sums[1][k][lane] += value * distance;
                sums[2][k][lane] += value * (distance * distance);
            }
            distances[lane] += LANES as f64;
        }
        turning.go_on();
    };
    let (parts, rest) = samples.as_chunks::<LANES>();
    parts.iter().for_each(&mut add);
    let mut last = [0.0; LANES];
    last[..rest.len()].copy_from_slice(rest);
    add(&last);
    for (moment, [re, im]) in moments.iter_mut().zip(sums) {
        *moment += Complex64::new(re.iter().sum(), im.iter().sum());
    }
}

/// `e^{j2π turns t}`.
fn from_start(turns: f64, t: usize) -> Complex64 {
    Complex64::cis(TAU * (turns * t as f64).fract())
}

/// A phasor at the next samples.
struct Turning {
    re: [f64; LANES],
    im: [f64; LANES],
    /// By which it turns over all of them.
    step: Complex64,
}

impl Turning {
    fn new(first: Complex64, turns: f64) -> Self {
        let turn = from_start(turns, 1);
        let (mut re, mut im, mut at, mut step) = ([0.0; LANES], [0.0; LANES], first, Complex64::ONE);
        for lane in 0..LANES {
            (re[lane], im[lane]) = (at.re, at.im);
            at *= turn;
            step *= turn;
        }
        Turning { re, im, step }
    }

    fn go_on(&mut self) {
        for (re, im) in self.re.iter_mut().zip(&mut self.im) {
            (*re, *im) = (*re * self.step.re - *im * self.step.im, *re * self.step.im + *im * self.step.re);
        }
    }
}

/// `Σ_{t<n} e^{j·angle·t}`.
fn geometric(angle: f64, n: usize) -> Complex64 {
    let half = (0.5 * angle).sin();
    if half.abs() < 1e-12 {
        return Complex64::new(n as f64, 0.0);
    }
    let count = n as f64;
    Complex64::cis(0.5 * angle * (count - 1.0)) * ((0.5 * angle * count).sin() / half)
}

/// A sum of harmonics of one frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct HarmonicSeries {
    /// Fundamental frequency in hertz.
    pub freq_hz: f64,
    /// Complex amplitudes: harmonic `h` is `Re(a[h − 1] · e^{j2π h freq_hz t})`, `t = 0` at the first sample.
    pub amplitudes: Vec<Complex64>,
    /// The part of the variance of the record that the series explains, at most one.
    pub explained: f64,
}

/// The series of `count` harmonics near `freq_hz` that explains most of a record, the fundamental searched within half
/// a bin (`1/(2·N·T)` hertz) of the guess.
///
/// Offset and harmonics are fitted together, so that they do not leak into each other.
///
/// # Errors
/// [`SignalError::Parameter`] for no harmonic, or a guess of which less than two periods are recorded or whose highest
/// harmonic is not below half the sample rate; [`SignalError::Constant`], [`SignalError::TooShort`] for fewer than 32
/// samples, [`SignalError::NonFinite`], [`SignalError::SampleTime`].
///
/// # Source
/// Quinn, B. G. and Thomson, P. J. (1991), Biometrika 78(1), 65–74.
pub fn fit_harmonics(x: &[f64], sample_time_s: f64, freq_hz: f64, count: usize) -> Result<HarmonicSeries, SignalError> {
    check_sample_time(sample_time_s)?;
    check_at_least(32, x.len())?;
    check_finite(x)?;
    check_range("count", count as f64, 1.0, x.len() as f64)?;
    let bin = 1.0 / x.len() as f64;
    let highest = (0.5 - bin) / count as f64;
    check_range("freq_hz", freq_hz, 2.0 * bin / sample_time_s, highest / sample_time_s)?;
    if is_constant(x) {
        return Err(SignalError::Constant);
    }
    let level = mean(x).unwrap_or(0.0);
    let x: Vec<f64> = x.iter().map(|v| v - level).collect();
    let guess = freq_hz * sample_time_s;
    let explained = |turns: f64| harmonics_at(&x, turns, count).1;
    // The peak is as narrow as the highest harmonic makes it: steps of a quarter of its width.
    let steps = 4 * count.min(1000) as i32;
    let at = |i: i32| (guess + 0.5 * bin * f64::from(i) / f64::from(steps)).clamp(bin, highest);
    let best = (-steps..=steps).max_by(|a, b| explained(at(*a)).total_cmp(&explained(at(*b)))).unwrap_or(0);
    let turns = search::maximum((at(best - 1), at(best + 1)), 1e-7 * bin / count as f64, explained);
    let total: f64 = x.iter().map(|v| v * v).sum();
    let (halves, power) = harmonics_at(&x, turns, count);
    Ok(HarmonicSeries {
        freq_hz: turns / sample_time_s,
        amplitudes: halves.into_iter().map(|c| 2.0 * c).collect(),
        explained: (power / total).min(1.0),
    })
}

/// Least-squares coefficients `c` of `b + Σ_h 2 Re(c_h e^{j2π h turns t})` and the power they explain: Gauss and
/// Seidel's iteration, which converges fast because harmonics over two periods or more are nearly orthogonal.
fn harmonics_at(x: &[f64], turns: f64, count: usize) -> (Vec<Complex64>, f64) {
    work::checkpoint();
    let n = x.len() as f64;
    let sums: Vec<Complex64> = (0..=count).map(|h| fourier_sum(x, TAU * turns * h as f64)).collect();
    let overlaps: Vec<Complex64> = (0..=2 * count).map(|m| geometric(TAU * turns * m as f64, x.len())).collect();
    let overlap = |m: i64| {
        let value = overlaps[m.unsigned_abs() as usize];
        if m < 0 { value.conj() } else { value }
    };
    let mut values = vec![Complex64::ZERO; count + 1];
    for _ in 0..100 {
        let mut moved = 0.0_f64;
        for h in 0..=count as i64 {
            let others = (0..=count as i64).filter(|m| *m != h);
            let leak = |m: i64| values[m as usize] * overlap(m - h) + values[m as usize].conj() * overlap(-m - h);
            let rest = sums[h as usize] - others.map(leak).sum::<Complex64>();
            // At rest value and conjugate are one unknown.
            let value = if h == 0 {
                Complex64::new(rest.re / (2.0 * n), 0.0)
            } else {
                let mirror = overlap(-2 * h);
                (rest * n - mirror * rest.conj()) / (n * n - mirror.norm_sqr())
            };
            moved = moved.max((value - values[h as usize]).norm());
            values[h as usize] = value;
        }
        let largest = values.iter().map(|v| v.norm()).fold(0.0, f64::max);
        if moved <= 1e-13 * largest {
            break;
        }
    }
    let power = values.iter().zip(&sums).map(|(c, s)| 2.0 * (c.conj() * s).re).sum();
    (values.split_off(1), power)
}

/// How a record repeats.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Periodicity {
    /// The period in samples.
    pub period: usize,
    /// Whole periods recorded, at least two.
    pub periods: usize,
    /// Part that does not repeat: half the mean squared change from one period to the next over the variance. It is
    /// zero for an exact repetition, about the noise's share of the power with noise, and one for nothing in common.
    pub unrepeated: f64,
}

/// Detects whether a record, of an excitation as a rule, repeats after a whole number of samples, and returns the
/// period. This is the shortest one after which no more than `tolerance` (of the variance) fails to repeat; none where
/// there is no such.
///
/// Periods up to half the record are tried. A tolerance of 1e-6 suits commands, 0.1 noisy measurements. For every lag
/// `p` the share `Σ (x[t+p] − x[t])² / (Σ x[t+p]² + Σ x[t]²)` is found from one correlation; smooth signals change
/// little over short lags too, so only lags at which that share has a minimum, after having been above one half, count.
///
/// # Errors
/// [`SignalError::TooShort`] for fewer than four samples, [`SignalError::Constant`], [`SignalError::Parameter`] for a
/// tolerance outside 0 ..= 0.5, [`SignalError::NonFinite`].
///
/// # Example
/// ```
/// use signal::excitation::{Prbs, Timing};
/// let prbs = Prbs { order: 6, hold: 2, levels: [-1.0, 1.0], seed: 3 };
/// let x = prbs.generate(Timing { sample_time_s: 1e-3, length: 500 })?;
/// let found = signal::periodicity::detect_period(&x.samples, 1e-6)?.ok_or(signal::SignalError::Constant)?;
/// assert_eq!((found.period, found.periods), (126, 3));
/// # Ok::<(), signal::SignalError>(())
/// ```
///
/// # Source
/// de Cheveigné, A. and Kawahara, H. (2002), J. Acoust. Soc. Am. 111(4), 1917–1930, §II (difference function).
pub fn detect_period(x: &[f64], tolerance: f64) -> Result<Option<Periodicity>, SignalError> {
    detect_common_period(&[x], tolerance)
}

/// [`detect_period`] of several records at once: the shortest period after which each of them repeats. Of the records
/// the one that repeats least counts.
///
/// # Errors
/// Those of [`detect_period`], and [`SignalError::LengthMismatch`]; [`SignalError::TooShort`] without a record.
pub fn detect_common_period(records: &[&[f64]], tolerance: f64) -> Result<Option<Periodicity>, SignalError> {
    let n = records.first().map_or(0, |x| x.len());
    check_at_least(4, n)?;
    check_range("tolerance", tolerance, 0.0, 0.5)?;
    let mut unrepeated = vec![0.0; n / 2 + 1];
    for x in records {
        check_same_length(n, x.len())?;
        check_finite(x)?;
        if is_constant(x) {
            return Err(SignalError::Constant);
        }
        unrepeated.iter_mut().zip(changes(x)?).for_each(|(worst, own): (&mut f64, f64)| *worst = worst.max(own));
    }
    let share = |p: usize| unrepeated[p];
    let Some(start) = (1..=n / 2).find(|p| share(*p) > 0.5) else { return Ok(None) };
    let candidates = (start..=n / 2).filter(|&p| share(p) <= share(p - 1) && (p == n / 2 || share(p) <= share(p + 1)));
    let candidates: Vec<usize> = candidates.collect();
    let least = candidates.iter().map(|p| share(*p)).fold(f64::INFINITY, f64::min).max(0.0);
    // Multiples of the period repeat as well, give or take the noise; and rounding must not count.
    let limit = tolerance.min(1.5 * least + 1e-9);
    let found = candidates.into_iter().find(|p| share(*p) <= limit.max(1e-12));
    Ok(found.map(|period| Periodicity { period, periods: n / period, unrepeated: share(period).max(0.0) }))
}

/// For every lag up to half the record the share of the variance that does not repeat after it.
fn changes(x: &[f64]) -> Result<Vec<f64>, SignalError> {
    let level = mean(x).unwrap_or(0.0);
    let x: Vec<f64> = x.iter().map(|v| v - level).collect();
    let n = x.len();
    let correlation = auto_correlation(&x, n / 2)?;
    let mut energy = vec![0.0; n + 1];
    for (t, v) in x.iter().enumerate() {
        energy[t + 1] = energy[t] + v * v;
    }
    let share = |p: usize| {
        let both = energy[n - p] + energy[n] - energy[p];
        if both > 0.0 { 1.0 - 2.0 * n as f64 * correlation.at(p as i64) / both } else { 0.0 }
    };
    Ok((0..=n / 2).map(share).collect())
}
