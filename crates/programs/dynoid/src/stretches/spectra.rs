//! Spectra of a stretch, over frequency and over time.

use dataset::{Adjustment, CommonClock, DatasetError, DatasetOptions, dataset};
use ident::Dataset;
use recording::Recording;
use signal::SignalView;
use signal::clock::check_clock;
use signal::spectrum::{Spectrogram, SpectrogramBuilder, Welch};
use toolbox_report::one_clock::adjustments;
use toolbox_report::spectrum::{squared_per_hertz, usual_window};
use work::Context;

use super::{Course, PIECE, PowerFacts, RecordedStretch, SegmentsFacts, SpectrogramFacts};
use crate::error::Error;

/// Samples that a clock may have in a piece, gaps included.
const MOST_ON_CLOCK: f64 = 4.0 * PIECE as f64;
/// Probability of the intervals.
const LEVEL: f64 = 0.95;

/// A spectrogram that is made of pieces.
struct Gathering {
    builder: SpectrogramBuilder,
    segments: SegmentsFacts,
}

impl RecordedStretch {
    /// Power spectrum by Welch's method, over Hann windows of this many samples that overlap by half. All segments in
    /// which no sample is missing are averaged. Without a length it is that of `dynoid data spectrum`.
    ///
    /// # Errors
    /// A channel that cannot be read or brought onto a clock, and one without a whole segment.
    pub fn spectrum(&self, channel: &str, segment: Option<usize>, context: &Context) -> Result<PowerFacts, Error> {
        let (found, segments) = self.gathered(channel, segment, 1, context)?;
        let mean = found.mean().ok_or_else(|| self.no_segment(channel, &segments))?;
        let interval = mean.interval(LEVEL).map_err(|source| self.unusable(channel, source))?;
        // The same at all frequencies but the first and the last.
        let factor = |end: usize| interval.get(1).map_or(f64::NAN, |ends| ends[end] / mean.density[1]);
        let unit = self.unit(channel)?;
        Ok(PowerFacts {
            density_unit: squared_per_hertz(&unit),
            unit,
            amplitude: found.amplitudes(&mean.density),
            interval_95: [factor(0), factor(1)],
            segments,
            frequency_hz: mean.freq_hz,
            density: mean.density,
        })
    }

    /// Power densities over time, in at most so many columns and bands of frequency, up to a frequency. Of each column
    /// it is the mean over its segments, and of each band the largest.
    ///
    /// # Errors
    /// Those of [`RecordedStretch::spectrum`].
    pub fn spectrogram(
        &self,
        channel: &str,
        segment: Option<usize>,
        columns: usize,
        bands: usize,
        up_to_hz: f64,
        context: &Context,
    ) -> Result<SpectrogramFacts, Error> {
        let (found, segments) = self.gathered(channel, segment, columns, context)?;
        if segments.segments == 0 {
            return Err(self.no_segment(channel, &segments));
        }
        let shown = found.bands(up_to_hz, bands);
        Ok(SpectrogramFacts {
            density_unit: squared_per_hertz(&self.unit(channel)?),
            from_s: *found.span_s.start(),
            to_s: *found.span_s.end(),
            first_hz: shown.first_hz,
            band_hz: shown.width_hz,
            frequencies_a_band: (shown.width_hz / segments.spacing_hz).round() as usize,
            range_db: shown.range_db(),
            levels_db: shown.levels_db,
            segments,
        })
    }

    fn gathered(
        &self,
        channel: &str,
        segment: Option<usize>,
        columns: usize,
        context: &Context,
    ) -> Result<(Spectrogram, SegmentsFacts), Error> {
        let course = self.some_course(channel, context)?;
        let mut gathering: Option<Gathering> = None;
        let mut nothing = None;
        for span in course.pieces() {
            let read = self.read(&[channel], &span, context)?;
            self.check_clock_of(channel, &read)?;
            let own = gathering.as_ref().map(|gathering| gathering.segments.sample_time_s);
            let options = DatasetOptions {
                outputs: vec![channel.to_owned()],
                clock: own.map_or(CommonClock::Slowest, CommonClock::Every),
                ..DatasetOptions::default()
            };
            match dataset(&[(&self.file, &read)], &options) {
                Ok((data, adjusted)) => {
                    let gathering = match &mut gathering {
                        Some(gathering) => gathering,
                        none => none.insert(self.begun(channel, course, &data, segment, columns, &adjusted)?),
                    };
                    gathering.add(&data).map_err(|source| self.unusable(channel, source))?;
                }
                // All of the piece is missing.
                Err(error @ (DatasetError::NothingLeft { .. } | DatasetError::SampleTime { .. })) => {
                    nothing = Some(error);
                }
                Err(error) => return Err(error.into()),
            }
        }
        let Some(Gathering { builder, mut segments }) = gathering else {
            return Err(nothing.map_or_else(|| self.no_sample(channel), Error::from));
        };
        let found = builder.finish();
        (segments.segments, segments.left_out) = (found.segments.iter().sum(), found.left_out);
        Ok((found, segments))
    }

    /// Refuses a piece whose clock has far more ticks than samples: they would fill the memory.
    fn check_clock_of(&self, channel: &str, read: &Recording) -> Result<(), Error> {
        let stamps = read.rasters.first().map_or(&[][..], |raster| &raster.time_s);
        // What is wrong with stamps is found when they are brought onto a clock.
        let Ok(check) = check_clock(stamps) else { return Ok(()) };
        let ticks = stamps.last().zip(stamps.first()).map_or(0.0, |(last, first)| (last - first) / check.sample_time_s);
        if ticks <= MOST_ON_CLOCK {
            return Ok(());
        }
        let samples = stamps.len();
        let fault =
            format!("{samples} samples where its clock would have {ticks:.0}; choose a stretch with fewer gaps");
        Err(self.unusable(channel, fault))
    }

    fn begun(
        &self,
        channel: &str,
        course: Course,
        data: &Dataset,
        segment: Option<usize>,
        columns: usize,
        adjusted: &[Adjustment],
    ) -> Result<Gathering, Error> {
        let sample_time_s = data.sample_time_s();
        let start_s = data.experiments().first().map_or(course.from_s, |experiment| experiment.start_s);
        let samples = ((course.to_s - start_s) / sample_time_s).round() as usize + 1;
        let welch = Welch::half_overlapping(segment.unwrap_or_else(|| usual_window(samples)));
        let failed = |source| self.unusable(channel, format!("{source}; choose a longer stretch or shorter segments"));
        let builder = SpectrogramBuilder::new(welch, sample_time_s, start_s, samples, columns).map_err(failed)?;
        let adjusted: Vec<Adjustment> =
            adjusted.iter().filter(|one| !matches!(one, Adjustment::Missing { .. })).cloned().collect();
        let segments = SegmentsFacts {
            from_s: start_s,
            to_s: course.to_s,
            samples: 0,
            missing: 0,
            sample_time_s,
            window: welch.window,
            segment: welch.segment,
            overlap: welch.overlap,
            segments: 0,
            left_out: 0,
            spacing_hz: 1.0 / (welch.segment as f64 * sample_time_s),
            bandwidth_hz: welch.noise_bandwidth_hz(sample_time_s).map_err(failed)?,
            notes: adjustments(&adjusted),
        };
        Ok(Gathering { builder, segments })
    }

    fn no_segment(&self, channel: &str, segments: &SegmentsFacts) -> Error {
        let SegmentsFacts { segment, missing, samples, .. } = segments;
        let fault = format!(
            "{missing} of {samples} samples are missing, some in each segment of {segment}; choose shorter segments"
        );
        self.unusable(channel, fault)
    }
}

impl Gathering {
    fn add(&mut self, data: &Dataset) -> Result<(), signal::SignalError> {
        for experiment in data.experiments() {
            let samples = experiment.output(0);
            self.segments.samples += samples.len();
            self.segments.missing += samples.iter().filter(|sample| sample.is_nan()).count();
            self.builder.add(SignalView::new(experiment.start_s, data.sample_time_s(), samples)?)?;
        }
        Ok(())
    }
}
