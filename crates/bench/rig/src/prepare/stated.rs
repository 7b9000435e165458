//! Stretches that the bench file states of a recording: samples that have another purpose are treated as missing.

use std::borrow::Cow;

use recording::Recording;

use super::log::Log;
use crate::bench_file::{StatedStretch, StretchUse};
use crate::diagnostics::{Finding, Severity};

/// Share of a recording, not used beside what is left out, that is worth a warning.
const MUCH: f64 = 0.01;

/// The purpose that a recording is prepared for.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// All samples but those that are left out, or kept for the other purpose.
    Estimates,
    /// The samples that are kept for it alone.
    Validation,
}

/// Stretches that the bench file states of a recording.
pub(super) struct Stated<'b> {
    stretches: Vec<&'b StatedStretch>,
    purpose: Purpose,
    /// Time of the first and last sample of the recording, s.
    recorded_s: (f64, f64),
}

impl<'b> Stated<'b> {
    pub(super) fn new(stretches: Vec<&'b StatedStretch>, purpose: Purpose, recording: &Recording) -> Self {
        Stated { stretches, purpose, recorded_s: recorded(recording) }
    }

    /// Tells whether nothing is stated: then nothing of the recording changes.
    pub(super) fn is_empty(&self) -> bool {
        self.stretches.is_empty()
    }

    /// Tells whether every stretch is within the recording; notes those that hold no sample.
    pub(super) fn is_within(&self, recording: &Recording, log: &mut Log) -> bool {
        let times = || recording.rasters.iter().flat_map(|raster| raster.time_s.iter());
        let is_outside = |stretch: &&&StatedStretch| !times().any(|time_s| holds(stretch, *time_s));
        let mut all_within = true;
        for stretch in self.stretches.iter().filter(is_outside) {
            let finding =
                Finding::StretchOutside { from_s: stretch.from_s, to_s: stretch.to_s, recorded_s: self.recorded_s };
            log.file(Severity::Error, None, finding);
            all_within = false;
        }
        all_within
    }

    /// The recording without the samples that are left out.
    pub(super) fn kept<'r>(&self, recording: &'r Recording) -> Cow<'r, Recording> {
        if self.is_empty() {
            return Cow::Borrowed(recording);
        }
        let mut kept = recording.clone();
        let of_raster = |raster: usize| recording.rasters.get(raster).map_or(&[][..], |found| &found.time_s);
        for channel in &mut kept.channels {
            let times = of_raster(channel.raster).iter();
            let samples = channel.samples.iter().zip(times).filter(|(_, time_s)| self.keeps(**time_s));
            channel.samples = samples.map(|(sample, _)| *sample).collect();
        }
        for raster in &mut kept.rasters {
            raster.time_s.retain(|time_s| self.keeps(*time_s));
        }
        Cow::Owned(kept)
    }

    fn keeps(&self, time_s: f64) -> bool {
        let of = |usage: StretchUse| self.stretches.iter().filter(move |stretch| stretch.usage == usage);
        let is_in = |usage: StretchUse| of(usage).any(|stretch| holds(stretch, time_s));
        let is_of_this = match self.purpose {
            Purpose::Validation => is_in(StretchUse::Validate),
            Purpose::Estimates => {
                !is_in(StretchUse::Validate)
                    && (of(StretchUse::Estimate).next().is_none() || is_in(StretchUse::Estimate))
            }
        };
        is_of_this && !is_in(StretchUse::LeaveOut)
    }

    /// The stretches of the recording that are left out, in order, s.
    fn left_out_s(&self) -> Vec<(f64, f64)> {
        let (first, last) = self.recorded_s;
        let mut edges: Vec<f64> = self.stretches.iter().flat_map(|stretch| [stretch.from_s, stretch.to_s]).collect();
        edges.extend([first, last]);
        edges.retain(|edge| (first..=last).contains(edge));
        edges.sort_by(f64::total_cmp);
        let pieces = edges.windows(2).map(|pair| (pair[0], pair[1])).filter(|(from, to)| from < to);
        let mut left_out: Vec<(f64, f64)> = Vec::new();
        for (from, to) in pieces.filter(|(from, to)| !self.keeps(0.5 * (from + to))) {
            match left_out.last_mut().filter(|before| before.1 == from) {
                Some(before) => before.1 = to,
                None => left_out.push((from, to)),
            }
        }
        left_out
    }

    /// Forgets the gaps that are stated, and notes what is left out. Of what is kept only the stretch `used_s` is used.
    pub(super) fn note(&self, used_s: (f64, f64), log: &mut Log) {
        if self.is_empty() {
            return;
        }
        let left_out_s = self.left_out_s();
        let is_stated = |from_s: f64, to_s: f64| left_out_s.iter().any(|(from, to)| from_s < *to && *from < to_s);
        log.diagnostics.retain(|diagnostic| match diagnostic.finding {
            Finding::Gap { duration_s, .. } => {
                diagnostic.place.time_s.is_none_or(|from_s| !is_stated(from_s, from_s + duration_s))
            }
            Finding::Cut { .. } => false,
            _ => true,
        });
        let left: f64 = left_out_s.iter().map(|(from, to)| to - from).sum();
        let whole = self.recorded_s.1 - self.recorded_s.0;
        let beyond = left_out_s.iter().map(|(from, to)| (to.min(used_s.1) - from.max(used_s.0)).max(0.0)).sum::<f64>();
        let beside_s = whole - left - (used_s.1 - used_s.0 - beyond);
        // Channels that begin a sample later than others are no loss.
        let (unused_s, severity) =
            if beside_s > MUCH * whole { (beside_s, Severity::Warning) } else { (0.0, Severity::Note) };
        log.file(severity, None, Finding::LeftOut { stretches_s: left_out_s, used_s, unused_s });
    }
}

fn holds(stretch: &StatedStretch, time_s: f64) -> bool {
    (stretch.from_s..=stretch.to_s).contains(&time_s)
}

fn recorded(recording: &Recording) -> (f64, f64) {
    let times = recording.rasters.iter().flat_map(|raster| raster.time_s.iter().copied()).filter(|t| t.is_finite());
    times.fold((f64::INFINITY, f64::NEG_INFINITY), |(first, last), time_s| (first.min(time_s), last.max(time_s)))
}
