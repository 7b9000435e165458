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

/// The largest amplitude of a frequency in a series, and the middle of the window where it is, s. The window is that of Hann over five
/// periods, or over the whole series if that is shorter. `None` where the series has too few samples in a period, or less than a period.
pub(crate) fn largest_amplitude(values: &[f64], sample_time_s: f64, frequency_hz: f64) -> Option<(f64, f64)> {
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
        let (mut sine, mut cosine) = (0.0, 0.0);
        for ((value, w), (s, c)) in part.iter().zip(&window).zip(&wave) {
            sine += w * (value - mean) * s;
            cosine += w * (value - mean) * c;
        }
        (2.0 * sine.hypot(cosine) / weight, (start as f64 + 0.5 * (length as f64 - 1.0)) * sample_time_s)
    };
    let last = values.len() - length;
    let starts = (0..=last).step_by((length / PLACES).max(1)).chain([last]);
    starts.map(at).reduce(|most, one| if one.0 > most.0 { one } else { most })
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
    /// Whether a value holds from its time to the next. Otherwise the series changes somewhere in between, in the middle on average.
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

/// By how much a value is late behind its demand at a frequency, rad, −π … π: the phase of the Fourier transforms of their changes over
/// the time that both have. Each keeps its own times, as a series held on the raster of the other is late by half of a step. Changes are
/// zero before and after a step, so that its transform has no end effect; those of the last tenth fade, for a sweep that ends at full
/// swing.
pub(crate) fn lag_rad(demand: &Samples<'_>, value: &Samples<'_>, frequency_hz: f64) -> f64 {
    let (from_s, to_s) = (demand.start_s.max(value.start_s), demand.end_s().min(value.end_s()));
    let fades_s = FADES * (to_s - from_s);
    let transform = |series: &Samples<'_>| {
        series.changes(from_s).fold((0.0, 0.0), |(re, im), (time_s, change)| {
            let left = ((to_s - time_s) / fades_s).clamp(0.0, 1.0);
            let change = change * (0.5 * PI * left).sin().powi(2);
            let (sine, cosine) = (TAU * frequency_hz * (time_s - from_s)).sin_cos();
            (re + change * cosine, im - change * sine)
        })
    };
    let (asked, came) = (transform(demand), transform(value));
    let lead = (came.1 * asked.0 - came.0 * asked.1).atan2(came.0 * asked.0 + came.1 * asked.1);
    -lead
}
