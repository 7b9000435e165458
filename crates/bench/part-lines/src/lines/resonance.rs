//! Broad peaks of what is left without lines: resonances of the shaft and of sensors.

use signal::Signal;
use signal::spectrum::{PowerSpectrum, Welch, peaks, power_spectrum};

use super::search::Lines;

/// Length of the averaged parts, s, and the fewest of them.
const PART_S: f64 = 2.0;
const FEWEST: f64 = 6.0;
/// Bins to either side within which a peak is one, and how far its power rises above that beside it.
const LOBE: usize = 3;
const EXCESS: f64 = 4.0;
/// Confidence of the powers.
const CONFIDENCE: f64 = 0.999;
/// An excitation of less than this share of its strongest is none.
const WEAK: f64 = 1e-3;
/// Broad peaks within this share of each other are one.
const ONE_PEAK: f64 = 0.15;
/// A peak within this share of a line's frequency is its skirt.
const SKIRT: f64 = 0.06;

/// A broad peak.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BroadPeak {
    pub(super) frequency_hz: f64,
    /// Root of the power about it, within a bandwidth of a part's resolution, as of a sine's amplitude.
    pub(super) amplitude: f64,
    /// How many times its power is that beside it.
    pub(super) excess: f64,
}

/// The broad peaks of what a signal leaves without its lines; where it is known what excites it, those that stand out
/// over that too: an excitation that is held has lobes, and zeros at which noise stands out over nothing.
pub(super) fn broad_peaks(lines: &Lines, excitation: Option<&Signal>) -> Vec<BroadPeak> {
    let mut alone = peaks_over(lines, None);
    if let Some(excitation) = excitation {
        let over = peaks_over(lines, Some(excitation));
        alone.retain_mut(|peak| match over.iter().find(|other| is_one(peak, other)) {
            Some(other) => {
                peak.excess = other.excess;
                true
            }
            None => false,
        });
    }
    alone
}

/// Tells whether two peaks are one.
pub(super) fn is_one(a: &BroadPeak, b: &BroadPeak) -> bool {
    (a.frequency_hz - b.frequency_hz).abs() < ONE_PEAK * b.frequency_hz
}

fn peaks_over(lines: &Lines, excitation: Option<&Signal>) -> Vec<BroadPeak> {
    let Some(own) = averaged(&lines.left) else { return Vec::new() };
    let Ok(mut intervals) = own.interval(CONFIDENCE) else { return Vec::new() };
    let mut power = own.density.clone();
    if let Some(excitation) = excitation.and_then(averaged) {
        let Ok(beside) = excitation.interval(CONFIDENCE) else { return Vec::new() };
        power.truncate(beside.len());
        intervals.truncate(beside.len());
        let strong = WEAK * excitation.density.iter().copied().fold(0.0, f64::max);
        for (k, power) in power.iter_mut().enumerate() {
            // Where next to nothing excites there is noise over noise.
            let density = excitation.density[k].max(strong);
            *power /= density;
            intervals[k] = [intervals[k][0] / beside[k][1].max(strong), intervals[k][1] / beside[k][0].max(strong)];
        }
    }
    let intervals: Vec<(f64, f64)> = intervals.into_iter().map(|[low, high]| (low, high)).collect();
    let is_skirt = |hz: f64| lines.found.iter().any(|line| (line.frequency_hz - hz).abs() < SKIRT * line.frequency_hz);
    let described = peaks(&own.freq_hz, &power, &intervals, LOBE, EXCESS).into_iter().map(|peak| BroadPeak {
        frequency_hz: own.freq_hz[peak.index],
        amplitude: (2.0 * own.density[peak.index] / PART_S).sqrt(),
        excess: peak.excess,
    });
    described.filter(|peak| peak.amplitude > lines.floor && !is_skirt(peak.frequency_hz)).collect()
}

/// The averaged power of a signal; none of one that is too short.
fn averaged(signal: &Signal) -> Option<PowerSpectrum> {
    if signal.duration_s() < FEWEST * PART_S {
        return None;
    }
    let part = (PART_S / signal.sample_time_s).round() as usize;
    power_spectrum(&signal.samples, signal.sample_time_s, Welch::half_overlapping(part)).ok()
}
