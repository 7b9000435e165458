//! A sine in a series: how large it is at one frequency, and how late it follows another.

use std::f64::consts::{PI, TAU};

/// Periods of the window in which an amplitude is looked for: a sweep passes the frequency in few of them.
const PERIODS: f64 = 5.0;
/// Places of the window for each of its lengths.
const PLACES: usize = 8;
/// Share of a series over which its changes fade at its end.
const FADES: f64 = 0.1;
/// Fewest samples in a period.
const LEAST_SAMPLES: f64 = 5.0;

/// A sine in a window of a series.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sine {
    pub(crate) amplitude: f64,
    /// Middle of the window, s.
    pub(crate) time_s: f64,
    /// Which part of the variance within the window it is, 0 … 1.
    pub(crate) share: f64,
}

/// The largest sine of a frequency in a series. The window is that of Hann over five periods, or over the whole series
/// if that is shorter. `None` where the series has too few samples in a period, or less than a period.
pub(crate) fn largest_sine(values: &[f64], sample_time_s: f64, frequency_hz: f64) -> Option<Sine> {
    let period = 1.0 / (frequency_hz * sample_time_s);
    if period < LEAST_SAMPLES || (values.len() as f64) < period {
        return None;
    }
    let length = ((PERIODS * period).round() as usize).min(values.len());
    let window: Vec<f64> = (0..length).map(|k| (PI * (k as f64 + 0.5) / length as f64).sin().powi(2)).collect();
    let turn = TAU / period;
    let wave: Vec<(f64, f64)> = (0..length).map(|k| (turn * k as f64).sin_cos()).collect();
    let weight: f64 = window.iter().sum();
    let at = |start: usize| {
        let part = &values[start..start + length];
        let mean = part.iter().zip(&window).map(|(value, w)| value * w).sum::<f64>() / weight;
        let (mut sine, mut cosine, mut square) = (0.0, 0.0, 0.0);
        for ((value, w), (s, c)) in part.iter().zip(&window).zip(&wave) {
            let from_mean = value - mean;
            sine += w * from_mean * s;
            cosine += w * from_mean * c;
            square += w * from_mean * from_mean;
        }
        let amplitude = 2.0 * sine.hypot(cosine) / weight;
        let share = if square > 0.0 { 0.5 * amplitude * amplitude * weight / square } else { 0.0 };
        Sine { amplitude, time_s: (start as f64 + 0.5 * (length as f64 - 1.0)) * sample_time_s, share }
    };
    let last = values.len() - length;
    let starts = (0..=last).step_by((length / PLACES).max(1)).chain([last]);
    starts.map(at).reduce(|most, one| if one.amplitude > most.amplitude { one } else { most })
}

/// Values at even times.
#[derive(Debug, Clone, Copy)]
pub struct Samples<'a> {
    /// Time of the first one, s.
    pub start_s: f64,
    /// Time from one to the next, s.
    pub sample_time_s: f64,
    /// The values.
    pub values: &'a [f64],
    /// True if a value holds from its time to the next. Otherwise the series changes somewhere in between, in the
    /// middle on average.
    pub is_held: bool,
}

impl Samples<'_> {
    fn time_s(&self, place: f64) -> f64 {
        self.start_s + place * self.sample_time_s
    }

    fn end_s(&self) -> f64 {
        self.time_s(self.values.len() as f64 - 1.0)
    }

    /// The changes from value to value after `from_s`, with their times.
    fn changes(&self, from_s: f64) -> impl Iterator<Item = (f64, f64)> {
        let after = if self.is_held { 1.0 } else { 0.5 };
        let change = move |(k, pair): (usize, &[f64])| (self.time_s(k as f64 + after), pair[1] - pair[0]);
        self.values.windows(2).enumerate().map(change).filter(move |(time_s, _)| *time_s > from_s)
    }
}

/// By how much a value is late behind its demand at a frequency.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Lag {
    /// −π … π.
    pub(crate) rad: f64,
    /// Half of the 95 % interval by what of the value does not follow the demand, rad; `None` where the demand has the
    /// frequency in too few windows to show it.
    pub(crate) scatter_rad: Option<f64>,
}

/// Periods of a window of the cross-spectrum: it smooths over a seventh of the frequency.
const SPECTRAL_PERIODS: f64 = 10.0;
/// Blocks of a window, each of which begins one: 75 % overlap.
const BLOCKS: usize = 4;
/// Independent averages that a window's length of a long record is worth with this overlap (Harris 1978, table I,
/// Hann).
const AVERAGES_A_LENGTH: f64 = 1.9;
/// Fewest independent averages that a coherence is estimated from: of one or two it is nearly one whatever the noise.
const LEAST_AVERAGES: f64 = 4.0;
/// Half of a 95 % interval in standard deviations.
const HALF_WIDTH: f64 = 1.96;

/// The phase of the cross-spectrum of demand and value at a frequency, over the time that both have. Each keeps its own
/// times, as a series held on the raster of the other is late by half of a step. The spectra are those of the changes:
/// zero before and after a step, so that its transform has no end effect.
///
/// # Source
/// Bendat & Piersol, *Random Data*, 4th ed. 2010, eq. 9.52: the standard deviation of the phase is √(1 − γ²)/(|γ| √(2
/// n)).
pub(crate) fn lag(demand: &Samples<'_>, value: &Samples<'_>, frequency_hz: f64) -> Lag {
    let (from_s, to_s) = (demand.start_s.max(value.start_s), demand.end_s().min(value.end_s()));
    let [asked, came] = [demand, value].map(|series| series.changes(from_s).collect::<Vec<_>>());
    let window_s = SPECTRAL_PERIODS / frequency_hz;
    if to_s - from_s < 2.0 * window_s {
        let fades_s = FADES * (to_s - from_s);
        let fade = |time_s: f64| (0.5 * PI * ((to_s - time_s) / fades_s).clamp(0.0, 1.0)).sin().powi(2);
        let [asked, came] = [asked, came].map(|changes| transform(&changes, frequency_hz, fade));
        return Lag { rad: -turned(asked, came), scatter_rad: None };
    }
    let block_s = window_s / BLOCKS as f64;
    // Windows that begin before the record serve a step at its begin; what comes after its end is not known.
    let count = BLOCKS - 1 + ((to_s - from_s) / block_s) as usize;
    let first_s = from_s - (BLOCKS - 1) as f64 * block_s;
    let [asked, came] = [asked, came].map(|changes| windows(&changes, frequency_hz, first_s, block_s, count));
    let (mut cross, mut of_asked, mut of_came, mut squares) = ((0.0, 0.0), 0.0, 0.0, 0.0);
    for (x, y) in asked.into_iter().zip(came) {
        let size = x.0 * x.0 + x.1 * x.1;
        cross = (cross.0 + y.0 * x.0 + y.1 * x.1, cross.1 + y.1 * x.0 - y.0 * x.1);
        of_asked += size;
        of_came += y.0 * y.0 + y.1 * y.1;
        squares += size * size;
    }
    let averages = AVERAGES_A_LENGTH / BLOCKS as f64 * of_asked * of_asked / squares;
    let coherence = (cross.0 * cross.0 + cross.1 * cross.1) / (of_asked * of_came);
    let deviation = ((1.0 - coherence).max(0.0) / (2.0 * coherence * averages)).sqrt();
    Lag {
        rad: -cross.1.atan2(cross.0),
        scatter_rad: (averages >= LEAST_AVERAGES).then(|| (HALF_WIDTH * deviation).min(PI)),
    }
}

/// The Fourier transforms of changes in windows of Hann, each of which begins a block after the one before. The cosine
/// of a window is one of the time itself, turned: all windows share the sums of their blocks.
fn windows(changes: &[(f64, f64)], frequency_hz: f64, first_s: f64, block_s: f64, count: usize) -> Vec<(f64, f64)> {
    // The transform by itself, times the cosine and times the sine.
    let mut blocks = vec![[(0.0, 0.0); 3]; count];
    for (time_s, change) in changes {
        let place = (time_s - first_s) / block_s;
        let Some(block) = blocks.get_mut(place as usize) else { continue };
        let (sine, cosine) = (TAU * frequency_hz * time_s).sin_cos();
        let (turn_sine, turn_cosine) = (TAU * place / BLOCKS as f64).sin_cos();
        for (sum, by) in block.iter_mut().zip([1.0, turn_cosine, turn_sine]) {
            *sum = (sum.0 + by * change * cosine, sum.1 - by * change * sine);
        }
    }
    let window = |(k, blocks): (usize, &[[(f64, f64); 3]])| {
        let (sine, cosine) = (TAU * k as f64 / BLOCKS as f64).sin_cos();
        blocks.iter().fold((0.0, 0.0), |sum, [plain, by_cosine, by_sine]| {
            let part = |of: fn(&(f64, f64)) -> f64| of(plain) - cosine * of(by_cosine) - sine * of(by_sine);
            (sum.0 + 0.5 * part(|z| z.0), sum.1 + 0.5 * part(|z| z.1))
        })
    };
    blocks.windows(BLOCKS).enumerate().map(window).collect()
}

/// Real and imaginary part of the Fourier transform of weighed changes.
fn transform(changes: &[(f64, f64)], frequency_hz: f64, weight: impl Fn(f64) -> f64) -> (f64, f64) {
    changes.iter().fold((0.0, 0.0), |(re, im), (time_s, change)| {
        let change = change * weight(*time_s);
        let (sine, cosine) = (TAU * frequency_hz * time_s).sin_cos();
        (re + change * cosine, im - change * sine)
    })
}

/// By what angle the second of two transforms is ahead of the first.
fn turned(first: (f64, f64), second: (f64, f64)) -> f64 {
    (second.1 * first.0 - second.0 * first.1).atan2(second.0 * first.0 + second.1 * first.1)
}
