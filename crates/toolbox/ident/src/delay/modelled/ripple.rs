//! Ripple: lines in the errors that the inputs do not have.

use std::f64::consts::TAU;

use faer::Mat;
use numerics::order;
use signal::periodicity::find_sinusoids;
use signal::spectrum::fft_real;

use crate::continuous::RationalChannel;
use crate::continuous::estimate::OutputFit;
use crate::{Dataset, Experiment, IdentError};

/// Most lines, and most columns they may take.
const LINES: usize = 3;
const COLUMNS: usize = 16;

/// Columns of one line in one experiment: cosine and sine, added and in proportion to the output.
pub(super) const PER_LINE: usize = 4;

/// Probability of a line that is none.
const FALSE_ALARM: f64 = 1e-3;

/// Bins on either side with which a line is compared, without those within its lobe.
const BESIDE: usize = 15;
const LOBE: usize = 2;

/// A line is so many times the mean power of what is beside it.
const SHARP: f64 = 25.0;

/// Lines of the inputs looked at.
const INPUT_LINES: usize = 20;

pub(super) struct Ripple {
    pub(super) lines_hz: Vec<f64>,
}

impl Ripple {
    /// The lines that stand out of the errors of the longest experiment.
    pub(super) fn of(data: &Dataset, errors: &[Vec<f64>]) -> Self {
        let lines = LINES.min(COLUMNS / (PER_LINE * data.experiments().len()).max(1));
        let longest = errors.iter().enumerate().max_by_key(|(_, e)| e.len()).map_or(0, |(index, _)| index);
        let Some((first, step)) = errors.get(longest).and_then(|errors| raster(errors)) else {
            return Ripple { lines_hz: Vec::new() };
        };
        let on_raster = |x: &[f64]| -> Vec<f64> {
            x[first..].iter().step_by(step).map(|v| if v.is_nan() { 0.0 } else { *v }).collect()
        };
        let clock_s = step as f64 * data.sample_time_s();
        let found =
            |x: &[f64], most: usize| find_sinusoids(&on_raster(x), clock_s, most, FALSE_ALARM).unwrap_or_default();
        let mut lines_hz: Vec<f64> = found(&errors[longest], lines).iter().map(|line| line.freq_hz).collect();
        let spectrum = fft_real(&hann(&on_raster(&errors[longest]))).unwrap_or_default();
        let power: Vec<f64> = spectrum.iter().map(|v| v.norm_sqr()).collect();
        let rows = errors[longest][first..].iter().step_by(step).count() as f64;
        lines_hz.retain(|line| stands_out(&power, (line * clock_s * rows).round() as usize));
        let resolution_hz = 2.0 / (errors[longest].len() as f64 * data.sample_time_s());
        for k in 0..if lines_hz.is_empty() { 0 } else { data.inputs() } {
            let driven = found(data.experiments()[longest].input(k), INPUT_LINES);
            lines_hz.retain(|line| driven.iter().all(|d| (d.freq_hz - line).abs() > resolution_hz));
        }
        Ripple { lines_hz }
    }

    /// The data with a column for each part of the ripple as further inputs; in proportion to what `clean` leaves
    /// without its errors.
    pub(super) fn beside(&self, data: &Dataset, clean: &Dataset, errors: &[Vec<f64>]) -> Result<Dataset, IdentError> {
        let (own, count) = (data.inputs(), PER_LINE * self.lines_hz.len());
        let mut whole: Option<Dataset> = None;
        for (index, experiment) in clean.experiments().iter().enumerate() {
            let explained: Vec<f64> = experiment
                .output(0)
                .iter()
                .zip(&errors[index])
                .map(|(y, e)| y - e)
                .map(|v| if v.is_nan() { 0.0 } else { v })
                .collect();
            let column = |t: usize, j: usize| {
                let Some(j) = j.checked_sub(own) else { return experiment.inputs[(t, j)] };
                if j / count != index {
                    return 0.0;
                }
                let part = j % count;
                let (sin, cos) = (TAU * self.lines_hz[part / PER_LINE] * t as f64 * data.sample_time_s()).sin_cos();
                let wave = if part % 2 == 0 { cos } else { sin };
                if part % PER_LINE < 2 { wave } else { wave * explained[t] }
            };
            let inputs = Mat::from_fn(experiment.len(), own + count * errors.len(), column);
            let outputs = data.experiments()[index].outputs.clone();
            whole = Some(match whole {
                None => Dataset::new(data.sample_time_s(), inputs, outputs)?.with_intersample(data.intersample()),
                Some(before) => before.with_experiment(Experiment { inputs, outputs, ..experiment.clone() })?,
            });
        }
        whole.ok_or(IdentError::TooFewSamples { samples: 0, parameters: count })
    }

    /// The data without the ripple that was found beside them.
    pub(super) fn removed(
        &self,
        data: &Dataset,
        with: &Dataset,
        found: &OutputFit<RationalChannel>,
    ) -> Result<Dataset, IdentError> {
        let gains: Vec<(usize, f64)> = (data.inputs()..with.inputs()).map(|k| (k, gain(found, k))).collect();
        let mut experiments = with.experiments().iter();
        data.map_experiments(|e| {
            let Some(columns) = experiments.next() else { return Ok(e.clone()) };
            let ripple = |t: usize| gains.iter().map(|(k, gain)| gain * columns.inputs[(t, *k)]).sum::<f64>();
            let outputs = Mat::from_fn(e.len(), 1, |t, _| e.outputs[(t, 0)] - ripple(t));
            Ok(Experiment { outputs, ..e.clone() })
        })
    }
}

fn hann(x: &[f64]) -> Vec<f64> {
    let n = x.len() as f64;
    x.iter().enumerate().map(|(t, v)| v * (0.5 - 0.5 * (TAU * (t as f64 + 0.5) / n).cos())).collect()
}

/// Returns true if a line rises sharply above the bins about it, as coloured noise does not.
fn stands_out(power: &[f64], bin: usize) -> bool {
    let about = |reach: usize| bin.saturating_sub(reach)..(bin + reach + 1).min(power.len());
    let top = about(1).map(|k| power[k]).fold(0.0, f64::max);
    let mut beside: Vec<f64> = about(BESIDE).filter(|k| k.abs_diff(bin) > LOBE).map(|k| power[k]).collect();
    order::upper_median(&mut beside).is_some_and(|median| top * std::f64::consts::LN_2 > SHARP * median)
}

fn gain(found: &OutputFit<RationalChannel>, input: usize) -> f64 {
    found.minimum.parameters[found.model.offsets()[input]]
}

/// The first instant with an error, and how far it is from one to the next; none where that differs.
fn raster(errors: &[f64]) -> Option<(usize, usize)> {
    let known: Vec<usize> = (0..errors.len()).filter(|t| !errors[*t].is_nan()).collect();
    let step = known.windows(2).map(|w| w[1] - w[0]).min()?;
    known.windows(2).all(|w| (w[1] - w[0]).is_multiple_of(step)).then_some((known[0], step))
}
