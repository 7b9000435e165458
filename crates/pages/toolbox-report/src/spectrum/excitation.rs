//! Where inputs that do not repeat excite too little for a response.

use page::decimal::digits;
use signal::SignalError;
use signal::spectrum::{Welch, power_spectrum};

use super::coherence::Coherence;

/// Part of its largest density below which an input counts as none: what leaks from elsewhere, and rounding.
const NOTHING: f64 = 1e-6;
/// Part below which an input counts as none if the output does not follow it more than by chance: noise on the input.
const WEAK: f64 = 1e-3;

/// The density of an input over frequency, relative to its largest.
pub(super) struct Excitation {
    freq_hz: Vec<f64>,
    part: Vec<f64>,
}

impl Excitation {
    pub(super) fn of(u: &[f64], sample_time_s: f64, welch: Welch) -> Result<Self, SignalError> {
        let power = power_spectrum(u, sample_time_s, welch)?;
        let largest = power.density.iter().copied().fold(0.0, f64::max).max(f64::MIN_POSITIVE);
        Ok(Excitation { freq_hz: power.freq_hz, part: power.density.iter().map(|d| d / largest).collect() })
    }

    /// True for each of these frequencies at which a response has a value.
    pub(super) fn known(&self, freq_hz: &[f64], coherence: Option<&Coherence>) -> Vec<bool> {
        let is_known = |f: &f64| {
            let part = self.part_at(*f);
            part > NOTHING && (part > WEAK || coherence.is_none_or(|c| c.is_by_chance(*f) != Some(true)))
        };
        freq_hz.iter().map(is_known).collect()
    }

    /// Between two frequencies the larger.
    fn part_at(&self, freq_hz: f64) -> f64 {
        let next = self.freq_hz.partition_point(|f| *f < freq_hz).min(self.freq_hz.len() - 1);
        self.part[next].max(self.part[next.saturating_sub(1)])
    }
}

/// Where there is no value.
pub(super) fn sentence(freq_hz: &[f64], known: &[bool]) -> Option<String> {
    let ranges = ranges(freq_hz, known);
    let (first, last) = (ranges.first()?, ranges.last()?);
    let in_words = |(low, high): &(f64, f64)| format!("{} … {} Hz", digits(*low, 4), digits(*high, 4));
    let place = match ranges.len() {
        1 => in_words(first),
        count => format!("{count} ranges from {} to {} Hz", digits(first.0, 4), digits(last.1, 4)),
    };
    Some(format!("the input has next to no power at {place}: there is no value there"))
}

/// Ranges of frequencies without a value.
pub(super) fn ranges(freq_hz: &[f64], known: &[bool]) -> Vec<(f64, f64)> {
    let mut all: Vec<(f64, f64)> = Vec::new();
    let mut before = true;
    for (f, known) in freq_hz.iter().zip(known) {
        match all.last_mut() {
            Some(last) if !known && !before => last.1 = *f,
            _ if !known => all.push((*f, *f)),
            _ => {}
        }
        before = *known;
    }
    all
}
