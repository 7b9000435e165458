//! How much of an output goes with its only input, frequency by frequency.

use page::decimal::digits;
use page::{Abscissa, Axis, Layer, Panel, Style, rounded};
use signal::SignalError;
use signal::spectrum::{Welch, cross_spectrum};

use super::confidence::FALSE_ALARM;
use super::facts::CoherenceFacts;
use crate::level::LEVEL;

/// Coherence by Welch's method. At rest and at half the sample rate nothing is known of it: they are left out.
pub(super) struct Coherence {
    freq_hz: Vec<f64>,
    value: Vec<f64>,
    band: Vec<[f64; 2]>,
    /// Coherence that chance alone exceeds at one frequency of twenty.
    by_chance: f64,
}

impl Coherence {
    /// Nothing where the record has no more than one segment, whose coherence is 1 whatever it holds.
    pub(super) fn of(u: &[f64], y: &[f64], sample_time_s: f64, welch: Welch) -> Result<Option<Self>, SignalError> {
        let cross = cross_spectrum(u, y, sample_time_s, welch)?;
        let by_chance = match cross.coherence_threshold(FALSE_ALARM) {
            Ok(threshold) => threshold,
            Err(SignalError::TooShort { .. }) => return Ok(None),
            Err(other) => return Err(other),
        };
        let known = 1..cross.freq_hz.len() - usize::from(cross.has_even_segments);
        if known.is_empty() {
            return Ok(None);
        }
        Ok(Some(Coherence {
            value: cross.coherence()[known.clone()].to_vec(),
            band: cross.coherence_interval(LEVEL)?[known.clone()].to_vec(),
            freq_hz: cross.freq_hz[known].to_vec(),
            by_chance,
        }))
    }

    /// Returns true if the output follows the input no more than by chance, at the known frequency next to this one;
    /// none without known frequencies.
    pub(super) fn is_by_chance(&self, freq_hz: f64) -> Option<bool> {
        let next = self.freq_hz.partition_point(|f| *f < freq_hz);
        let value = self.value.get(next).or(self.value.last())?;
        Some(*value <= self.by_chance)
    }

    pub(super) fn facts(&self) -> CoherenceFacts {
        CoherenceFacts {
            frequency_hz: self.freq_hz.clone(),
            coherence: self.value.clone(),
            interval_95: self.band.clone(),
            chance_exceeds_at_1_in_20: self.by_chance,
        }
    }

    pub(super) fn panel(&self) -> Panel {
        let (low, high): (Vec<f64>, Vec<f64>) = self.band.iter().map(|[low, high]| (*low, *high)).unzip();
        let x = Abscissa::Values(rounded(&self.freq_hz));
        let (name, style) = ("estimate".to_owned(), Style::Modelled);
        let band = Layer::Band { name, style, x, low: rounded(&low), high: rounded(&high) };
        let curve = Layer::curve("estimate", style, &self.freq_hz, &self.value);
        Panel::new(Axis::linear("coherence γ²", "").within(0.0, 1.05), 130, vec![band, curve])
    }

    pub(super) fn sentence(&self) -> String {
        let above = self.value.iter().filter(|value| **value > self.by_chance).count();
        let mut sorted = self.value.clone();
        sorted.sort_by(f64::total_cmp);
        format!(
            "coherence: median {}; at {} of {} frequencies above the {} that chance exceeds at 1 in 20",
            digits(sorted[sorted.len() / 2], 3),
            above,
            self.value.len(),
            digits(self.by_chance, 2)
        )
    }
}
