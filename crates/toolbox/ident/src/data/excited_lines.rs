//! How many lines of frequency an input moves the output by: each gives a gain and a phase, and no more.

use std::f64::consts::TAU;

use lti::TransferFunction;
use numerics::linalg;
use signal::Complex64;
use signal::spectrum::fft_real;
use signal::window::Window;

use crate::Dataset;
use crate::data::regression::{Lagged, Regression};

/// Lines counted at most: more than any model here takes.
const MOST: usize = 8;

/// A share of the power below this is left to noise and rounding.
const NEGLIGIBLE: f64 = 1e-4;

/// Bins to either side of a line that the window blurs it over.
const LOBE: usize = 4;

/// Gaps of at most so many samples are bridged: in short stretches noise looks like a few lines.
const BRIDGED: usize = 40;

/// Instants that are so near, in samples, are on one clock.
const ON_CLOCK: f64 = 0.01;

/// Past samples that a missing one is made of: two for each line, and one for a level.
const PAST: usize = 2 * MOST + 1;

/// Directions of the past below this part of the strongest are rounding.
const UNSEEN: f64 = 1e-10;

/// The lines that carry an input's part of the output.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Lines {
    /// Frequencies, the strongest of each experiment first.
    pub(crate) all_hz: Vec<f64>,
}

impl Lines {
    /// The fewest lines without which less than `share` of the power of an input behind a system is left, at most
    /// [`MOST`].
    pub(crate) fn of(data: &Dataset, input: usize, system: Option<&TransferFunction>, share: f64) -> Self {
        let mut courses = bridged(courses(data, input));
        courses.sort_by_key(|x| std::cmp::Reverse(x.len()));
        let mut all_hz: Vec<f64> = Vec::new();
        for x in &courses {
            let bin_hz = 1.0 / (x.len().max(1) as f64 * data.sample_time_s());
            let apart = |a: f64, b: f64| (a - b).abs() > LOBE as f64 * bin_hz;
            let power = power(x, bin_hz, system);
            for line in strongest(power, share.max(NEGLIGIBLE)).into_iter().map(|bin| bin as f64 * bin_hz) {
                if all_hz.len() < MOST && all_hz.iter().all(|known| apart(*known, line)) {
                    all_hz.push(line);
                }
            }
        }
        Lines { all_hz }
    }
}

/// An input of each experiment. Those that were cut from one recording at short gaps are one again, NaN in the gaps.
fn courses(data: &Dataset, input: usize) -> Vec<Vec<f64>> {
    let (mut courses, mut end_s) = (Vec::<Vec<f64>>::new(), f64::NAN);
    for e in data.experiments() {
        let apart = (e.start_s - end_s) / data.sample_time_s();
        let missing = apart.round();
        let follows = (apart - missing).abs() < ON_CLOCK && (1.0..=BRIDGED as f64).contains(&missing);
        if !follows {
            courses.push(Vec::new());
        }
        if let Some(course) = courses.last_mut() {
            course.extend(std::iter::repeat_n(f64::NAN, if follows { missing as usize } else { 0 }));
            course.extend_from_slice(e.input(input));
        }
        end_s = e.start_s + e.len() as f64 * data.sample_time_s();
    }
    courses
}

/// Missing samples made of those before them by the recursion that all of the data follow best. That is exact for a sum
/// of few lines, which would otherwise leak over all frequencies.
fn bridged(mut courses: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let Some(recursion) = recursion(&courses) else { return courses };
    for course in &mut courses {
        let known = || course.iter().filter(|v| !v.is_nan());
        let (low, high) =
            known().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
        for t in PAST..course.len() {
            if course[t].is_nan() {
                let next: f64 = recursion.iter().zip(course[..t].iter().rev()).map(|(a, v)| a * v).sum();
                course[t] = next.max(low).min(high);
            }
        }
    }
    courses
}

/// How a sample follows from those before it, the latest first; none where nothing is missing.
fn recursion(courses: &[Vec<f64>]) -> Option<Vec<f64>> {
    if !courses.iter().flatten().any(|v| v.is_nan()) {
        return None;
    }
    let signals: Vec<Vec<&[f64]>> = courses.iter().map(|course| vec![course.as_slice()]).collect();
    let columns = Lagged::each(0, 1..=PAST as isize).chain([Lagged::new(0, 0)]).collect();
    let factor = Regression::new(&signals, columns).factor();
    let (past, now) = (factor.get(..PAST, ..PAST), factor.get(..PAST, PAST..PAST + 1));
    let solution = linalg::least_norm(past, now, UNSEEN).ok()?;
    Some(solution.col_as_slice(0).to_vec())
}

/// The power of an input behind a system, bin by bin; a delay does not bear on it.
fn power(x: &[f64], bin_hz: f64, system: Option<&TransferFunction>) -> Vec<f64> {
    let taper = Window::Blackman.periodic(x.len()).unwrap_or_default();
    let known = || x.iter().zip(&taper).filter(|(v, _)| !v.is_nan());
    let level = known().map(|(v, w)| v * w).sum::<f64>() / known().map(|(_, w)| w).sum::<f64>();
    let tapered: Vec<f64> = x.iter().zip(&taper).map(|(v, w)| if v.is_nan() { 0.0 } else { (v - level) * w }).collect();
    let gain = |bin: usize| {
        let at = Complex64::new(0.0, TAU * bin as f64 * bin_hz);
        system.map_or(1.0, |system| system.evaluate(at).norm_sqr())
    };
    let spectrum = fft_real(&tapered).unwrap_or_default();
    let power = spectrum.iter().enumerate().map(|(bin, v)| v.norm_sqr() * gain(bin));
    power.map(|p| if p.is_finite() { p } else { 0.0 }).collect()
}

/// The bins of the strongest lines, one after another, until less than a share of the power is left.
fn strongest(mut power: Vec<f64>, share: f64) -> Vec<usize> {
    let enough = share * power.iter().sum::<f64>();
    let mut found = Vec::new();
    while found.len() < MOST && power.iter().sum::<f64>() > enough {
        let Some(top) = (0..power.len()).max_by(|a, b| power[*a].total_cmp(&power[*b])) else { break };
        let end = (top + LOBE + 1).min(power.len());
        power[top.saturating_sub(LOBE)..end].fill(0.0);
        found.push(top);
    }
    found
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// How many lines there are in an input of which every so manieth sample is missing.
    fn lines(u: &[f64], every: usize) -> usize {
        let known: Vec<f64> = u.iter().enumerate().map(|(t, v)| if t % every == 7 { f64::NAN } else { *v }).collect();
        let data = Dataset::siso(0.01, &known, u).unwrap().without_input_gaps(20).unwrap();
        Lines::of(&data, 0, None, 0.0).all_hz.len()
    }

    #[test]
    fn exact_lines_are_counted_across_gaps() {
        let sines = |count: usize| -> Vec<f64> {
            let sine = |t: usize, line: usize| (0.13 * (1.0 + 1.7 * line as f64) * t as f64).sin();
            (0..2000).map(|t| 3.0 + (0..count).map(|line| sine(t, line)).sum::<f64>()).collect()
        };
        let mut random = signal::excitation::Random::new(3);
        let white: Vec<f64> = (0..2000).map(|_| random.normal()).collect();
        for every in [30, 50, 170] {
            let found = [1, 2, 4].map(|count| lines(&sines(count), every));
            assert_eq!((found, lines(&white, every)), ([1, 2, 4], MOST), "{every}");
        }
    }
}
