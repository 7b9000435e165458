//! Figures of a stretch of one channel, which is gone through in pieces.

use serde::Serialize;

/// Figures of a stretch of one channel. Numbers are in the channel's unit; none where no sample is a number.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Stretch {
    /// Samples that are numbers.
    pub samples: usize,
    /// Samples that are none.
    pub missing: usize,
    /// Stamp of the first sample that is a number, s.
    pub from_s: Option<f64>,
    /// Stamp of the last one, s.
    pub to_s: Option<f64>,
    /// The first sample.
    pub first: Option<f64>,
    /// The last sample.
    pub last: Option<f64>,
    /// The last less the first sample.
    pub change: Option<f64>,
    /// The change over the time from the first to the last sample, per s.
    pub slope_per_s: Option<f64>,
    /// Mean.
    pub mean: Option<f64>,
    /// Root of the mean square.
    pub rms: Option<f64>,
    /// Standard deviation about the mean, of n − 1.
    pub standard_deviation: Option<f64>,
    /// The least sample.
    pub least: Option<f64>,
    /// The largest sample.
    pub largest: Option<f64>,
}

/// Gatherer of the figures of a [`Stretch`].
#[derive(Debug, Clone, Copy, Default)]
pub struct Gathered {
    stretch: Stretch,
    /// Of the samples less the first one, so that large levels cost no digits: their sum, and that of their squares.
    sum: f64,
    squares: f64,
}

impl Gathered {
    /// Takes in the next samples with their stamps, s.
    pub fn add(&mut self, time_s: &[f64], samples: &[f64]) {
        for (time_s, sample) in time_s.iter().zip(samples) {
            if !sample.is_finite() {
                self.stretch.missing += 1;
                continue;
            }
            let Stretch { first, from_s, last, to_s, least, largest, samples, .. } = &mut self.stretch;
            let apart = sample - *first.get_or_insert(*sample);
            from_s.get_or_insert(*time_s);
            (*last, *to_s) = (Some(*sample), Some(*time_s));
            *least = Some(least.map_or(*sample, |least| least.min(*sample)));
            *largest = Some(largest.map_or(*sample, |largest| largest.max(*sample)));
            *samples += 1;
            self.sum += apart;
            self.squares += apart * apart;
        }
    }

    /// The figures of all that was taken in.
    #[must_use]
    pub fn figures(&self) -> Stretch {
        let stretch = self.stretch;
        let (Some(first), Some(last)) = (stretch.first, stretch.last) else { return stretch };
        let count = stretch.samples as f64;
        let (mean_apart, change) = (self.sum / count, last - first);
        let about_mean = (self.squares - count * mean_apart * mean_apart).max(0.0);
        let duration_s = stretch.to_s.unwrap_or_default() - stretch.from_s.unwrap_or_default();
        let mean = first + mean_apart;
        Stretch {
            change: Some(change),
            slope_per_s: (duration_s > 0.0).then(|| change / duration_s),
            mean: Some(mean),
            rms: Some((about_mean / count + mean * mean).sqrt()),
            standard_deviation: (stretch.samples > 1).then(|| (about_mean / (count - 1.0)).sqrt()),
            ..stretch
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn exact_figures_in_pieces() {
        let (time_s, samples) = ([0.0, 0.5, 1.0, 1.5, 2.0], [1e6 + 1.0, f64::NAN, 1e6 + 3.0, 1e6 - 1.0, 1e6 + 5.0]);
        let mut gathered = Gathered::default();
        for piece in [0..2, 2..2, 2..5] {
            gathered.add(&time_s[piece.clone()], &samples[piece]);
        }
        let found = gathered.figures();
        assert_eq!((found.samples, found.missing, found.change), (4, 1, Some(4.0)));
        assert_eq!((found.slope_per_s, found.mean), (Some(2.0), Some(1e6 + 2.0)));
        assert_eq!((found.least, found.largest), (Some(1e6 - 1.0), Some(1e6 + 5.0)));
        // The squares about the mean are 1, 1, 9 and 9.
        assert!((found.standard_deviation.unwrap() - (20.0_f64 / 3.0).sqrt()).abs() < 1e-9);
        assert!((found.rms.unwrap().powi(2) - (1e6_f64 + 2.0).powi(2) - 5.0).abs() < 1e-3);
    }

    #[test]
    fn exact_a_stretch_without_numbers_has_no_figures() {
        let mut gathered = Gathered::default();
        gathered.add(&[0.0], &[f64::NAN]);
        assert_eq!(gathered.figures(), Stretch { missing: 1, ..Stretch::default() });
    }
}
