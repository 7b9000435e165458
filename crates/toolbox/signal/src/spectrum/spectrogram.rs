//! Spectra over time, of records of any length.

use std::ops::RangeInclusive;

use numerics::order::select;

use super::fft_frequencies_hz;
use super::welch::{PowerSpectrum, SegmentTransform, Welch};
use crate::SignalView;
use crate::error::{SignalError, check_range, check_sample_time};

/// Power densities over time. Of each column it is the mean over the segments whose middles are in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrogram {
    /// How the record was cut.
    pub welch: Welch,
    /// Time from sample to sample, s.
    pub sample_time_s: f64,
    /// Time that the columns share evenly, s.
    pub span_s: RangeInclusive<f64>,
    /// Frequencies in hertz.
    pub freq_hz: Vec<f64>,
    /// Density of each column at each frequency, (unit of x)²/Hz; NaN in a column without a segment.
    pub columns: Vec<Vec<f64>>,
    /// Segments that each column is the mean of.
    pub segments: Vec<usize>,
    /// Segments that are left out, since samples are missing in them.
    pub left_out: usize,
}

/// Densities in bands of frequency, for a picture of a [`Spectrogram`].
#[derive(Debug, Clone, PartialEq)]
pub struct Bands {
    /// Lower edge of the first band, Hz. It is below zero, since the first frequency is in the middle of its line.
    pub first_hz: f64,
    /// Width of a band, Hz.
    pub width_hz: f64,
    /// Largest density of each column in each band, dB; NaN where a column has no segment or no power.
    pub levels_db: Vec<Vec<f64>>,
}

impl Bands {
    /// The largest level, and the level below which a twentieth of them is, but at most 80 dB below the largest: the
    /// range for the colours of a picture. None without a level.
    #[must_use]
    pub fn range_db(&self) -> Option<[f64; 2]> {
        const DEEPEST_DB: f64 = 80.0;
        let mut levels: Vec<f64> = self.levels_db.iter().flatten().copied().filter(|level| level.is_finite()).collect();
        let place = levels.len() / 20;
        let low = select(&mut levels, place)?;
        let high = levels.into_iter().fold(low, f64::max);
        Some([low.max(high - DEEPEST_DB), high])
    }
}

/// Spectrogram of one record on one clock; samples that are missing (NaN) cost the segments with them.
///
/// # Errors
/// Those of [`SpectrogramBuilder::new`].
///
/// # Example
/// ```
/// use signal::SignalView;
/// use signal::spectrum::{Welch, spectrogram};
/// // A sine of amplitude 3 at 125 Hz, which is a line of these segments.
/// let x: Vec<f64> = (0..4000).map(|i| 3.0 * (std::f64::consts::FRAC_PI_4 * i as f64).sin()).collect();
/// let found = spectrogram(SignalView::new(0.0, 1e-3, &x)?, Welch::half_overlapping(200), 10)?;
/// let line = found.freq_hz.iter().position(|f| *f == 125.0).unwrap();
/// assert!(found.columns.iter().all(|column| (found.amplitudes(column)[line] - 3.0).abs() < 1e-9));
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn spectrogram(record: SignalView<'_>, welch: Welch, columns: usize) -> Result<Spectrogram, SignalError> {
    let SignalView { start_s, sample_time_s, samples } = record;
    let mut builder = SpectrogramBuilder::new(welch, sample_time_s, start_s, samples.len(), columns)?;
    builder.add(record)?;
    Ok(builder.finish())
}

/// Spectrogram under construction, to which a long record is added piece by piece. Only its columns are in memory.
#[derive(Debug)]
pub struct SpectrogramBuilder {
    found: Spectrogram,
    window: Vec<f64>,
}

impl SpectrogramBuilder {
    /// A spectrogram of a record with this start and so many samples, in so many columns, but one a segment at most.
    /// The columns share the time of the segments, each of which stands for the time around its middle.
    ///
    /// # Errors
    /// [`SignalError::TooShort`] for a record shorter than a segment, [`SignalError::Parameter`] for impossible
    /// segments and for no column, [`SignalError::SampleTime`].
    pub fn new(
        welch: Welch,
        sample_time_s: f64,
        start_s: f64,
        samples: usize,
        columns: usize,
    ) -> Result<Self, SignalError> {
        check_sample_time(sample_time_s)?;
        welch.check(samples)?;
        check_range("columns", columns as f64, 1.0, f64::INFINITY)?;
        let hop = welch.segment - welch.overlap;
        let segments = (samples - welch.segment) / hop + 1;
        let from_s = start_s + 0.5 * welch.overlap as f64 * sample_time_s;
        let to_s = from_s + (segments * hop) as f64 * sample_time_s;
        let columns = columns.min(segments);
        let freq_hz = fft_frequencies_hz(welch.segment, sample_time_s);
        let found = Spectrogram {
            columns: vec![vec![0.0; freq_hz.len()]; columns],
            segments: vec![0; columns],
            left_out: 0,
            freq_hz,
            welch,
            sample_time_s,
            span_s: from_s..=to_s,
        };
        Ok(SpectrogramBuilder { found, window: welch.window.periodic(welch.segment)? })
    }

    /// Adds a piece of the record. No segment goes from one piece to the next.
    ///
    /// # Errors
    /// A transform that fails.
    pub fn add(&mut self, piece: SignalView<'_>) -> Result<(), SignalError> {
        let Self { found, window } = self;
        let (welch, length) = (found.welch, found.welch.segment);
        let Some(last) = piece.samples.len().checked_sub(length) else { return Ok(()) };
        let energy: f64 = window.iter().map(|w| w * w).sum();
        let scale = found.sample_time_s / energy;
        let mut transform = SegmentTransform::new(window);
        for start in (0..=last).step_by(length - welch.overlap) {
            let segment = &piece.samples[start..start + length];
            if segment.iter().any(|sample| !sample.is_finite()) {
                found.left_out += 1;
                continue;
            }
            let middle_s = piece.start_s + (start as f64 + 0.5 * length as f64) * found.sample_time_s;
            let column = found.column_of(middle_s);
            for (k, (sum, x)) in found.columns[column].iter_mut().zip(transform.apply(segment)?).enumerate() {
                *sum += welch.sides(k) * scale * x.norm_sqr();
            }
            found.segments[column] += 1;
        }
        Ok(())
    }

    /// The spectrogram of all that was added.
    #[must_use]
    pub fn finish(mut self) -> Spectrogram {
        for (column, segments) in self.found.columns.iter_mut().zip(&self.found.segments) {
            // Without a segment 0/0, which is NaN.
            column.iter_mut().for_each(|sum| *sum /= *segments as f64);
        }
        self.found
    }
}

impl Spectrogram {
    fn column_of(&self, time_s: f64) -> usize {
        let (from_s, to_s) = (self.span_s.start(), self.span_s.end());
        let position = (time_s - from_s) / (to_s - from_s) * self.columns.len() as f64;
        (position.max(0.0) as usize).min(self.columns.len() - 1)
    }

    /// The mean over all segments: the spectrum by Welch's method. None without a segment.
    #[must_use]
    pub fn mean(&self) -> Option<PowerSpectrum> {
        let segments: usize = self.segments.iter().sum();
        let window = self.welch.window.periodic(self.welch.segment).ok()?;
        let share = |of: usize| of as f64 / segments as f64;
        let columns = || self.columns.iter().zip(&self.segments).filter(|(_, segments)| **segments > 0);
        let density = |k: usize| columns().map(|(column, segments)| share(*segments) * column[k]).sum();
        let freedom = self.welch.degrees_of_freedom(&window, segments);
        (segments > 0).then(|| PowerSpectrum {
            freq_hz: self.freq_hz.clone(),
            density: (0..self.freq_hz.len()).map(density).collect(),
            // Half as many where the transform is real.
            degrees_of_freedom: (0..self.freq_hz.len()).map(|k| 0.5 * self.welch.sides(k) * freedom).collect(),
        })
    }

    /// Amplitudes of the sines that have these densities in their line, `√(2 P B)` with B the noise bandwidth. At rest
    /// and at half the sample rate it is `√(P B)`.
    ///
    /// A sine between two lines has less: with the Hann window down to 0.85 of it.
    #[must_use]
    pub fn amplitudes(&self, density: &[f64]) -> Vec<f64> {
        let bandwidth_hz = self.welch.noise_bandwidth_hz(self.sample_time_s).unwrap_or(f64::NAN);
        let amplitude = |(k, density): (usize, &f64)| (self.welch.sides(k) * density * bandwidth_hz).sqrt();
        density.iter().enumerate().map(amplitude).collect()
    }

    /// Levels `10 lg P` for a picture: up to a frequency, in at most so many bands, and of each the largest density, so
    /// that no line is lost.
    #[must_use]
    pub fn bands(&self, up_to_hz: f64, most: usize) -> Bands {
        let spacing_hz = 1.0 / (self.welch.segment as f64 * self.sample_time_s);
        let lines = self.freq_hz.partition_point(|f| *f <= up_to_hz).max(1);
        let several = lines.div_ceil(most.max(1));
        let level = |lines: &[f64]| {
            let largest = lines.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            if largest > 0.0 { 10.0 * largest.log10() } else { f64::NAN }
        };
        let levels = |column: &Vec<f64>| column[..lines].chunks(several).map(level).collect();
        Bands {
            first_hz: -0.5 * spacing_hz,
            width_hz: several as f64 * spacing_hz,
            levels_db: self.columns.iter().map(levels).collect(),
        }
    }
}
