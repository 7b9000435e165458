//! Evidence of the samples on a channel.

use recording::{Channel, Recording};

/// Samples looked at in one recording: enough to see noise and means, few enough for a large campaign.
const MAX_SAMPLES: usize = 20_000;
/// Spacing of the differences that take slow trends out before correlating, s.
const DIFFERENCE_S: f64 = 0.02;
/// Largest delay looked for, s, and its step.
const MAX_DELAY_S: f64 = 0.1;
const DELAY_STEP_S: f64 = 0.001;

/// A channel's samples in one recording, with their time stamps.
#[derive(Clone, Copy)]
pub(crate) struct Samples<'r> {
    pub(crate) time_s: &'r [f64],
    pub(crate) values: &'r [f64],
}

impl<'r> Samples<'r> {
    pub(super) fn of(recording: &'r Recording, channel: &'r Channel) -> Option<Self> {
        let time_s = recording.time_s(channel)?;
        let count = time_s.len().min(channel.samples.len()).min(MAX_SAMPLES);
        (count >= 3).then(|| Samples { time_s: &time_s[..count], values: &channel.samples[..count] })
    }

    fn finite(self) -> impl Iterator<Item = f64> + 'r {
        self.values.iter().copied().filter(|value| value.is_finite())
    }

    /// Arithmetic mean of the finite samples.
    pub(super) fn mean(self) -> Option<f64> {
        let count = self.finite().count();
        (count > 0).then(|| self.finite().sum::<f64>() / count as f64)
    }

    /// Smallest and largest of the finite samples.
    pub(super) fn range(self) -> Option<(f64, f64)> {
        self.finite().map(|value| (value, value)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// Mean time from sample to sample.
    pub(super) fn sample_time_s(self) -> Option<f64> {
        let span_s = self.time_s.last()? - self.time_s.first()?;
        (span_s > 0.0).then(|| span_s / (self.time_s.len() - 1) as f64)
    }

    /// Share of the samples that continue the line through the two before them: 1 for a signal that is held or ramps,
    /// small for anything with noise.
    pub(super) fn noise_free_share(self) -> f64 {
        let scale = self.finite().fold(0.0, |largest: f64, value| largest.max(value.abs()));
        let smooth = |w: &[f64]| (w[2] - 2.0 * w[1] + w[0]).abs() <= 1e-9 * scale;
        let count = self.values.windows(3).filter(|w| smooth(w)).count();
        count as f64 / (self.values.len() - 2) as f64
    }

    /// Root mean square of the change over [`DIFFERENCE_S`].
    pub(super) fn fluctuation(self) -> Option<f64> {
        let changes = self.changes(self.time_s, 0.0);
        let sum: f64 = changes.iter().flatten().map(|change| change * change).sum();
        let count = changes.iter().flatten().count();
        (count > 0).then(|| (sum / count as f64).sqrt())
    }

    /// Change over [`DIFFERENCE_S`] up to each instant, of the signal delayed by `delay_s`.
    fn changes(self, instants_s: &[f64], delay_s: f64) -> Vec<Option<f64>> {
        let change = |&t: &f64| Some(self.held_at(t - delay_s)? - self.held_at(t - delay_s - DIFFERENCE_S)?);
        instants_s.iter().map(change).collect()
    }

    /// The last finite sample at or before an instant.
    fn held_at(self, time_s: f64) -> Option<f64> {
        let after = self.time_s.partition_point(|&t| t <= time_s + 1e-9);
        self.values.get(after.checked_sub(1)?).copied().filter(|value| value.is_finite())
    }
}

/// Delay of `later` against `earlier` at which their changes correlate best, with that correlation.
pub(crate) fn best_delay(earlier: Samples<'_>, later: Samples<'_>) -> Option<(f64, f64)> {
    let instants = &later.time_s[..later.time_s.len().min(4000)];
    let later_changes = later.changes(instants, 0.0);
    let steps = (MAX_DELAY_S / DELAY_STEP_S).round() as usize;
    let candidates = (0..=steps).filter_map(|step| {
        let delay_s = step as f64 * DELAY_STEP_S;
        Some((delay_s, correlation(&earlier.changes(instants, delay_s), &later_changes)?))
    });
    candidates.max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Correlation of the instants at which both are known.
fn correlation(x: &[Option<f64>], y: &[Option<f64>]) -> Option<f64> {
    let pairs: Vec<(f64, f64)> = x.iter().zip(y).filter_map(|(x, y)| Some(((*x)?, (*y)?))).collect();
    let count = pairs.len() as f64;
    let (mean_x, mean_y) = pairs.iter().fold((0.0, 0.0), |sum, p| (sum.0 + p.0 / count, sum.1 + p.1 / count));
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for (x, y) in &pairs {
        xx += (x - mean_x).powi(2);
        yy += (y - mean_y).powi(2);
        xy += (x - mean_x) * (y - mean_y);
    }
    (xx > 0.0 && yy > 0.0).then(|| xy / (xx * yy).sqrt())
}
