//! The slope of the phase of a cross-spectrum.

use std::f64::consts::TAU;

use numerics::search;
use signal::correlation::delay_by_correlation;
use signal::spectrum::{Welch, cross_spectrum};

use super::{DelayEstimate, check_one_input, signals};
use crate::data::check_range;
use crate::distributions::chi_squared_quantile;
use crate::{Dataset, IdentError};
use fitting::StructureError;

/// Confidence of the test whether a phase is a straight line, as that of a delay.
const STRAIGHT: f64 = 0.999;

/// Coherences that signals without anything in common exceed with this probability count.
const CHANCE: f64 = 0.05;
/// Independent averages that Hann windows overlapping by half make of one stretch (Welch 1967).
const OVERLAPPING: f64 = 1.64;
/// One less the coherence is at least this, so that exact data have weights.
const INCOHERENCE: f64 = 1e-12;

/// Estimates `τ` of `y(t) = g u(t − τ) + v(t)`, `g` of either sign, from the phase `−ωτ` of the averaged
/// cross-spectrum: each frequency with the weight `γ²/(1 − γ²)` of its coherence, which is that of maximum likelihood.
///
/// Where the phase is no straight line through zero, as with a lag beside the delay, the standard error is infinite; a
/// lag so short that its phase is straight counts as delay.
///
/// The signals are aligned to the nearest sample by [`signal::correlation::delay_by_correlation`] first, so segments
/// need not be long against the delay; the fraction is searched a sample either way.
///
/// # Example
/// ```
/// # let mut random = signal::excitation::Random::new(4);
/// # let wave: Vec<[f64; 2]> = (0..40).map(|_| [random.uniform(), 6.28 * random.uniform()]).collect();
/// let at = |t: f64| wave.iter().map(|[f, p]| (2.0 * f * t + p).sin()).sum::<f64>();
/// let u: Vec<f64> = (0..4000).map(|t| at(f64::from(t))).collect();
/// let y: Vec<f64> = (0..4000).map(|t| at(f64::from(t) - 2.37)).collect();
/// let delay = ident::delay::PhaseDelay::default().estimate(&ident::Dataset::siso(1.0, &u, &y)?)?;
/// assert!((delay.samples - 2.37).abs() < 0.01);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Knapp & Carter 1976 (maximum-likelihood weight, variance); Hamon & Hannan, *Spectral estimation of time delay for
/// dispersive and non-dispersive systems*, 1974.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhaseDelay {
    /// Samples in a segment; the record should have tens of them.
    pub segment: usize,
    /// Longest delay, in samples, either way.
    pub highest: usize,
    /// Frequencies used, in hertz; `None` for all.
    pub band_hz: Option<(f64, f64)>,
}

impl Default for PhaseDelay {
    /// Segments of 128, delays from −50 to 50, all frequencies.
    fn default() -> Self {
        PhaseDelay { segment: 128, highest: 50, band_hz: None }
    }
}

/// One frequency: its angle per sample, the phase found, and its weight `γ²/(1 − γ²)`.
struct Line {
    angle: f64,
    phase: f64,
    weight: f64,
}

/// Returns true if the phases lie on the line `−ωτ` within their errors: their variance is `1/(2nw)` for a weight `w`
/// and `n` averages. Only where the coherence is significant: elsewhere phases lie anywhere, and say nothing of a line.
fn is_straight(lines: &[Line], averages: f64, tau: f64) -> bool {
    let averages = OVERLAPPING * averages;
    let chance = 1.0 - CHANCE.powf(1.0 / (averages - 1.0).max(1.0));
    let coherent = || lines.iter().filter(|l| l.weight / (1.0 + l.weight) > chance);
    let off = |l: &Line| {
        let angle = l.phase + l.angle * tau;
        2.0 * averages * l.weight * angle.sin().atan2(angle.cos()).powi(2)
    };
    let freedom = coherent().count().saturating_sub(1).max(1) as f64;
    coherent().map(off).sum::<f64>() <= chi_squared_quantile(STRAIGHT, freedom)
}

impl PhaseDelay {
    /// The delay for data of one input and one output.
    ///
    /// # Errors
    /// [`IdentError::Structure`] for other channels or an empty band; [`IdentError::Missing`];
    /// [`signal::SignalError::TooShort`] unless every experiment is longer than two segments and the longest delay;
    /// [`signal::SignalError::Constant`].
    pub fn estimate(&self, data: &Dataset) -> Result<DelayEstimate, IdentError> {
        check_one_input(data)?;
        data.refuse_missing()?;
        check_range("segment", self.segment as f64, 8.0, 1e9)?;
        let signals = signals(data)?;
        let longest = signals.iter().max_by_key(|s| s[0].len());
        let Some(longest) = longest else {
            return Err(IdentError::TooFewSamples { samples: 0, parameters: 1 });
        };
        let coarse = delay_by_correlation(longest[1], longest[0], 1.0, self.highest as f64)?;
        let whole = coarse.delay_s.round() as isize;
        let (lines, averages) = self.lines(&signals, whole, coarse.coefficient < 0.0, data.sample_time_s())?;
        let misfit = |tau: f64| lines.iter().map(|l| -l.weight * (l.phase + l.angle * tau).cos()).sum();
        let fraction = search::minimum((-1.0, 1.0), 1e-8, misfit);
        let information: f64 = lines.iter().map(|l| 2.0 * averages * l.angle * l.angle * l.weight).sum();
        let is_straight = is_straight(&lines, averages, fraction);
        let standard_error = if is_straight { information.powf(-0.5) } else { f64::INFINITY };
        Ok(DelayEstimate { samples: whole as f64 + fraction, standard_error })
    }

    /// The lines of the aligned signals, and how many independent averages each rests on.
    fn lines(
        &self,
        signals: &[Vec<&[f64]>],
        whole: isize,
        opposed: bool,
        sample_time_s: f64,
    ) -> Result<(Vec<Line>, f64), IdentError> {
        let bins = self.segment / 2 + 1;
        let (mut uu, mut yy) = (vec![0.0; bins], vec![0.0; bins]);
        let mut uy = vec![signal::Complex64::new(0.0, 0.0); bins];
        let mut rows = 0;
        for s in signals {
            let shift = whole.unsigned_abs().min(s[0].len());
            let kept = s[0].len() - shift;
            let (u, y) = if whole >= 0 { (&s[1][..kept], &s[0][shift..]) } else { (&s[1][shift..], &s[0][..kept]) };
            let part = cross_spectrum(u, y, 1.0, Welch::half_overlapping(self.segment))?;
            rows += kept;
            for k in 0..bins {
                uu[k] += part.pxx[k] * kept as f64;
                yy[k] += part.pyy[k] * kept as f64;
                uy[k] += part.pxy[k] * kept as f64;
            }
        }
        let (low, high) = self.band_hz.unwrap_or((0.0, f64::INFINITY));
        let line = |k: usize| {
            let cycles = k as f64 / self.segment as f64;
            let freq_hz = cycles / sample_time_s;
            let power = uu[k] * yy[k];
            if power <= 0.0 || freq_hz < low || freq_hz > high {
                return None;
            }
            let coherence = (uy[k].norm_sqr() / power).min(1.0);
            let phase = if opposed { -uy[k] } else { uy[k] }.arg();
            Some(Line { angle: TAU * cycles, phase, weight: coherence / (1.0 - coherence).max(INCOHERENCE) })
        };
        // Without the mean, which each segment lost, and without the end, whose phase is 0 or π.
        let lines: Vec<Line> = (1..bins - 1).filter_map(line).collect();
        if lines.is_empty() {
            return Err(StructureError::EmptyBand { low_hz: low, high_hz: high }.into());
        }
        // Overlap and window bring no information: it is that of segments side by side.
        Ok((lines, rows as f64 / self.segment as f64))
    }
}
