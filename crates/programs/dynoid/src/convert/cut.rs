//! A part of a recording.

use std::ops::{Range, RangeInclusive};

use recording::Recording;

/// Leaves out what lies outside the window, in s, and rasters of which nothing is left. Returns a note on channels that
/// are lost.
pub(super) fn cut(recording: &mut Recording, window_s: RangeInclusive<f64>) -> Option<String> {
    let wanted = |t: &[f64]| signal::runs(t.len(), |i| window_s.contains(&t[i])).collect();
    let runs: Vec<Vec<Range<usize>>> = recording.rasters.iter().map(|raster| wanted(&raster.time_s)).collect();
    for channel in &mut recording.channels {
        keep(&mut channel.samples, &runs[channel.raster]);
    }
    for (raster, runs) in recording.rasters.iter_mut().zip(&runs) {
        keep(&mut raster.time_s, runs);
    }
    let (before, rasters) = (recording.channels.len(), std::mem::take(&mut recording.rasters));
    let mut places = Vec::new();
    for raster in rasters {
        places.push((!raster.time_s.is_empty()).then_some(recording.rasters.len()));
        if !raster.time_s.is_empty() {
            recording.rasters.push(raster);
        }
    }
    recording.channels.retain(|channel| places[channel.raster].is_some());
    for channel in &mut recording.channels {
        channel.raster = places[channel.raster].unwrap_or_default();
    }
    let lost = before - recording.channels.len();
    (lost > 0).then(|| format!("{lost} of {before} channels have no sample in the time asked for, and were left out"))
}

fn keep(values: &mut Vec<f64>, runs: &[Range<usize>]) {
    let mut kept = 0;
    for run in runs {
        values.copy_within(run.clone(), kept);
        kept += run.len();
    }
    values.truncate(kept);
    values.shrink_to_fit();
}
