//! Lines of a signal that follow a phase, and those that follow none.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::f64::consts::{LN_2, LN_10, TAU};
use std::rc::Rc;

use faer::{Mat, c64};
use numerics::{linalg, order};
use signal::Signal;
use signal::periodicity::find_sinusoids;
use signal::spectrum::fft_real;

use super::angle::Angle;
use super::cause::Cause;
use super::reference::{PhaseLaw, Reference, folded_hz};
use crate::lines::found::DRIFT_HZ;
use crate::lines::track::OrderTrack;

/// Bins about the line, and those of them that the window blurs it over.
const ABOUT: isize = 64;
const LOBE: isize = 3;
/// The power of a line over the mean of what lies about it: by chance once in 10⁸ times.
const EXCESS: f64 = 18.0;
/// Phases that are closer than this to another's cannot be separated from it; those farther than the second do not
/// touch.
const SAME: f64 = 0.9;
const APART: f64 = 0.02;
/// The mains stray: what is this like them, two bins away at a steady speed, may be theirs.
const RESOLVED: f64 = 1.0 / 6.0;
/// An amplitude is there where it is this many times its standard error, and this share of the largest beside it: what
/// a reference leaves of a strong line looks like a weak one.
const CLEAR: f64 = 4.5;
const SHARE: f64 = 0.2;
/// A line is there where it is this share of the strongest.
const FLOOR: f64 = 2e-3;
/// A reference is looked at where the spectrum rises this far above its median in so many times the neighbourhood.
const RISE: f64 = 6.0;
const WIDE: f64 = 8.0;
/// Frequencies within this share of each other are one.
const AT: f64 = 0.005;
/// Passes over what is left, and the share of the strongest line that one has to have for each but the last: the phase
/// of an order wobbles as the engine fires, and so has a little of other frequencies in it.
const PASSES: usize = 5;
const OF_THE_STRONGEST: f64 = 0.1;
/// Samples over which a phasor turns before rounding is taken out.
const TURNED: usize = 256;
/// Slow changes of an order's strength spread it this far, Hz.
const MODULATED_HZ: f64 = 1.0;
/// Lines without a cause that are looked for, and the probability with which chance makes one of them.
const MOST_UNKNOWN: usize = 8;
const FALSE_ALARM: f64 = 1e-9;
/// Bins within which a line without a cause is part of one with.
const BESIDE: f64 = 4.0;
/// Bins within which two lines are one.
const SAME_BINS: f64 = 2.0;

/// A line.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Found {
    /// Where it shows, Hz.
    pub(super) frequency_hz: f64,
    pub(super) amplitude: f64,
    pub(super) standard_error: f64,
    /// Its possible causes: one, or several that cannot be separated.
    pub(super) causes: Vec<Reference>,
}

/// The lines of a signal, and what is left without them.
pub(super) struct Lines {
    pub(super) found: Vec<Found>,
    pub(super) left: Signal,
    /// The least amplitude that counts.
    pub(super) floor: f64,
}

/// A signal seen through a window, beside references.
struct Seen<'a> {
    signal: &'a Signal,
    turns_hz: f64,
    /// How far the speed is spread, Hz.
    spread_hz: f64,
    /// The crank angle at each sample, rad; and e^{jkθ} for each order k that was asked for, by the bits of k.
    angles: Vec<f64>,
    orders: RefCell<BTreeMap<u64, Rc<Vec<c64>>>>,
    /// Less its mean.
    samples: Vec<f64>,
    window: Vec<f64>,
    /// Powers of its spectrum.
    powers: Vec<f64>,
    /// The least amplitude that counts.
    floor: f64,
}

/// A reference that a line follows.
struct Candidate {
    reference: Reference,
    /// e^{jφ} at each sample.
    turning: Vec<c64>,
    /// Power behind its phase, and the mean power of what lies about it, as of an amplitude.
    power: f64,
    noise: f64,
}

impl Lines {
    /// Tells whether a line is part of a stronger one whose strength changes.
    pub(super) fn is_beside(&self, line: &Found) -> bool {
        let is_near = |other: &Found| (other.frequency_hz - line.frequency_hz).abs() < MODULATED_HZ;
        self.found.iter().any(|other| other.amplitude > line.amplitude && is_near(other))
    }

    /// With orders that were followed through a change of speed, and what was found in the rest.
    pub(super) fn of_changing(self, tracks: &[OrderTrack], rest: Lines) -> Self {
        let is_followed = |r: &Reference| match r.cause {
            Cause::Order { order, .. } | Cause::FoldedOrder { order, .. } => tracks.iter().any(|t| t.order == order),
            _ => false,
        };
        let mut found = self.found;
        found.iter_mut().for_each(|line| line.causes.retain(is_followed));
        found.retain(|line| !line.causes.is_empty());
        found.extend(rest.found);
        found.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
        Lines { found, left: rest.left, floor: self.floor }
    }

    /// The amplitude of the line at a frequency; zero where there is none.
    pub(super) fn strength_at(&self, frequency_hz: f64) -> f64 {
        let is_it = |found: &&Found| (found.frequency_hz - frequency_hz).abs() < AT * frequency_hz;
        self.found.iter().filter(is_it).map(|found| found.amplitude).fold(0.0, f64::max)
    }

    /// Of a signal over which the engine turns as `angle` says.
    pub(super) fn of(signal: &Signal, angle: &Angle<'_>, references: &[Reference]) -> Self {
        let mut seen = Seen::new(signal, angle);
        let mut open: Vec<&Reference> = references.iter().collect();
        let mut found: Vec<Found> = Vec::new();
        // Weak lines show once strong ones are gone.
        for pass in 1..=PASSES {
            let mut candidates: Vec<Candidate> = open.iter().filter_map(|r| seen.candidate(r)).collect();
            let strongest = candidates.iter().map(|c| c.power).fold(0.0, f64::max);
            candidates.retain(|c| pass == PASSES || c.power >= OF_THE_STRONGEST * OF_THE_STRONGEST * strongest);
            let mut left = seen.samples.clone();
            let mut new = Vec::new();
            for group in grouped(&seen, candidates) {
                new.extend(seen.amplitudes(group, &found, &mut left));
            }
            if new.is_empty() {
                break;
            }
            open.retain(|r| !new.iter().any(|line| seen.is_of(line, r)));
            for line in new {
                match found.iter_mut().find(|known| seen.is_unresolved(&known.causes, &line.causes)) {
                    Some(known) => known.causes.extend(line.causes),
                    None => found.push(line),
                }
            }
            seen.show(left);
        }
        let strays: Vec<Vec<Reference>> = found.iter().map(|line| seen.strays(line, &found, references)).collect();
        found.iter_mut().zip(strays).for_each(|(line, strays)| line.causes.extend(strays));
        let beside = seen.beside(&found, references);
        found.extend(beside);
        found.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
        Lines { found, floor: seen.floor, left: signal.with_samples(seen.samples) }
    }
}

impl<'a> Seen<'a> {
    fn new(signal: &'a Signal, angle: &Angle<'_>) -> Self {
        let count = signal.len() as f64;
        let window: Vec<f64> = (0..signal.len()).map(|k| 1.0 - (TAU * (k as f64 + 0.5) / count).cos()).collect();
        let mean = signal.mean().unwrap_or(0.0);
        let samples: Vec<f64> = signal.samples.iter().map(|x| x - mean).collect();
        let turns_hz = angle.mean_hz(signal.start_s, signal.end_s());
        let spread_hz = angle.spread_hz(signal.start_s, signal.end_s());
        let (none, powers, floor) = (Vec::new(), Vec::new(), 0.0);
        let angles = (0..signal.len()).map(|k| angle.at(signal.time_s(k))).collect();
        let orders = RefCell::default();
        let mut seen = Seen { signal, turns_hz, spread_hz, angles, orders, samples: none, window, powers, floor };
        seen.show(samples);
        seen.floor = FLOOR * 2.0 * seen.powers.iter().copied().fold(0.0, f64::max).sqrt() / count;
        seen
    }

    /// Takes other samples in place of those that were seen.
    fn show(&mut self, samples: Vec<f64>) {
        let seen: Vec<f64> = samples.iter().zip(&self.window).map(|(x, w)| x * w).collect();
        self.powers = fft_real(&seen).unwrap_or_default().iter().map(|line| line.norm_sqr()).collect();
        self.samples = samples;
    }

    fn rate_hz(&self) -> f64 {
        1.0 / self.signal.sample_time_s
    }

    fn bin_hz(&self) -> f64 {
        1.0 / self.signal.duration_s().max(self.signal.sample_time_s)
    }

    /// e^{jφ} at each sample, φ the phase that a reference gives it.
    fn turning(&self, reference: &Reference) -> Vec<c64> {
        let PhaseLaw { order, frequency_hz, .. } = reference.law;
        let of_order = (order != 0.0).then(|| self.of_order(order.abs()));
        let step = c64::cis(TAU * frequency_hz * self.signal.sample_time_s);
        let mut turned = c64::ONE;
        let at = |k: usize| {
            turned = match k.is_multiple_of(TURNED) {
                true => c64::cis(TAU * frequency_hz * self.signal.time_s(k)),
                false => turned * step,
            };
            match &of_order {
                Some(of_order) if order < 0.0 => of_order[k].conj() * turned,
                Some(of_order) => of_order[k] * turned,
                None => turned,
            }
        };
        (0..self.signal.len()).map(at).collect()
    }

    /// e^{jkθ} at each sample: sidebands and images of an order share it.
    fn of_order(&self, order: f64) -> Rc<Vec<c64>> {
        let turning = || Rc::new(self.angles.iter().map(|angle| c64::cis(order * angle)).collect());
        self.orders.borrow_mut().entry(order.to_bits()).or_insert_with(turning).clone()
    }

    /// Powers of the bins about a phase, the line itself in the middle, as of amplitudes.
    fn about(&self, turning: &[c64]) -> Vec<f64> {
        let behind = |part: fn(c64) -> f64| {
            let term = |k: usize| part(turning[k].conj()) * self.window[k] * self.samples[k];
            fft_real(&(0..turning.len()).map(term).collect::<Vec<_>>()).unwrap_or_default()
        };
        let (real, imaginary) = (behind(|z| z.re), behind(|z| z.im));
        let scale = 2.0 / self.window.iter().sum::<f64>();
        let of_real = |lines: &[c64], bin: isize| match lines.get(bin.unsigned_abs()) {
            Some(line) if bin < 0 => line.conj(),
            Some(line) => *line,
            None => c64::ZERO,
        };
        let power = |bin: isize| {
            let line = of_real(&real, bin) + c64::new(0.0, 1.0) * of_real(&imaginary, bin);
            (line * scale).norm_sqr()
        };
        (-ABOUT..=ABOUT).map(power).collect()
    }

    /// Tells whether a line is that of a reference.
    fn is_of(&self, line: &Found, reference: &Reference) -> bool {
        let hz = |law: &PhaseLaw| law.at_hz(self.turns_hz);
        let apart_hz = reference.law.tolerance_hz + self.bin_hz();
        let is_it = |found: &Reference| {
            found.cause == reference.cause && (hz(&found.law) - hz(&reference.law)).abs() < apart_hz
        };
        line.causes.iter().any(is_it)
    }

    /// Tells whether the spectrum rises anywhere near where a reference shows.
    fn rises(&self, reference: &Reference, shown_hz: f64) -> bool {
        let reach_hz = reference.law.tolerance_hz + self.spread_hz(reference) + BESIDE * self.bin_hz();
        let bins = |hz: f64| ((hz.max(0.0) / self.bin_hz()).round() as usize).min(self.powers.len());
        let about = &self.powers[bins(shown_hz - reach_hz)..bins(shown_hz + reach_hz)];
        let wide = &self.powers[bins(shown_hz - WIDE * reach_hz)..bins(shown_hz + WIDE * reach_hz)];
        let top = about.iter().copied().fold(0.0, f64::max);
        order::upper_median(&mut wide.to_vec()).is_some_and(|median| top > RISE * median)
    }

    /// The reference where a line follows it; its frequency refined as far as it is not known.
    fn candidate(&self, reference: &Reference) -> Option<Candidate> {
        let frequency_hz = reference.law.at_hz(self.turns_hz);
        let lowest_hz = f64::from(LOBE as i32 + 1) * self.bin_hz();
        let shown_hz = folded_hz(frequency_hz, self.rate_hz());
        let is_drift = frequency_hz > 0.5 * self.rate_hz() && shown_hz < DRIFT_HZ;
        if is_drift || shown_hz < lowest_hz || shown_hz > 0.5 * self.rate_hz() - lowest_hz {
            return None;
        }
        if !self.rises(reference, shown_hz) {
            return None;
        }
        let reference = self.refined(reference);
        let turning = self.turning(&reference);
        let powers = self.about(&turning);
        let middle = ABOUT as usize;
        let reach = LOBE as usize;
        let top = powers[middle - reach..=middle + reach].iter().copied().fold(0.0, f64::max);
        // Noise that falls or rises with frequency counts by its stronger side.
        let noise = mean_noise(&powers[..middle - reach]).max(mean_noise(&powers[middle + reach + 1..]));
        let is_strong = powers[middle] > (EXCESS * noise).max(self.floor * self.floor);
        (powers[middle] >= top && is_strong).then_some(Candidate { reference, turning, power: powers[middle], noise })
    }

    /// The reference at the strongest line within its tolerance.
    fn refined(&self, reference: &Reference) -> Reference {
        let PhaseLaw { frequency_hz, tolerance_hz, .. } = reference.law;
        let bins = ((tolerance_hz / self.bin_hz()).ceil() as isize).min(ABOUT - 1);
        if bins == 0 {
            return reference.clone();
        }
        let powers = self.about(&self.turning(reference));
        let at = |bin: isize| powers[(ABOUT + bin) as usize];
        let Some(top) = (-bins..=bins).max_by(|a, b| at(*a).total_cmp(&at(*b))) else { return reference.clone() };
        // The top of the parabola through the logarithms, nearly exact for this window.
        let [below, here, above] = [top - 1, top, top + 1].map(|bin| at(bin).max(f64::MIN_POSITIVE).ln());
        let curvature = below - 2.0 * here + above;
        let part = if curvature < 0.0 { (0.5 * (below - above) / curvature).clamp(-0.5, 0.5) } else { 0.0 };
        let off_hz = ((top as f64 + part) * self.bin_hz()).clamp(-tolerance_hz, tolerance_hz);
        let law = PhaseLaw { frequency_hz: frequency_hz + off_hz, ..reference.law };
        Reference { law, ..reference.clone() }
    }

    /// How alike two phases are to a real signal: 1 where one cannot be separated from the other.
    fn likeness(&self, a: &[c64], b: &[c64]) -> f64 {
        let (mut power, mut apart, mut together) = (0.0, c64::ZERO, c64::ZERO);
        for ((a, b), window) in a.iter().zip(b).zip(&self.window) {
            let weighted = a * (window * window);
            power += window * window;
            apart += weighted * b.conj();
            together += weighted * b;
        }
        apart.norm().max(together.norm()) / power
    }

    /// The amplitudes of lines that touch each other, by least squares; they are taken off what is left.
    fn amplitudes(&self, mut group: Vec<Vec<Candidate>>, known: &[Found], left: &mut [f64]) -> Vec<Found> {
        let count = self.samples.len();
        let wave = |k: usize, j: usize| {
            let turning = group[j / 2][0].turning[k];
            if j.is_multiple_of(2) { turning.re } else { turning.im }
        };
        let columns = Mat::from_fn(count, 2 * group.len(), |k, j| self.window[k] * wave(k, j));
        let target = Mat::from_fn(count, 1, |k, _| self.window[k] * self.samples[k]);
        let solution = linalg::Qr::new(columns.as_ref()).least_squares(target.as_ref());
        // Noise of even density has this variance in a column's amplitude, by the power that was found about the line.
        let alone = (0..columns.ncols()).map(|j| columns.col(j).squared_norm_l2());
        let alone: Vec<f64> = alone.collect();
        let inverse = linalg::inverse((columns.transpose() * &columns).as_ref());
        let line = |i: usize| {
            let (cosine, sine) = (solution[(2 * i, 0)], solution[(2 * i + 1, 0)]);
            let widening =
                0.5 * (inverse[(2 * i, 2 * i)] * alone[2 * i] + inverse[(2 * i + 1, 2 * i + 1)] * alone[2 * i + 1]);
            let standard_error = (0.5 * group[i][0].noise * widening.max(1.0)).sqrt();
            (cosine.hypot(sine), standard_error)
        };
        let lines: Vec<(f64, f64)> = (0..group.len()).map(line).collect();
        let largest = lines.iter().map(|l| l.0).fold(0.0, f64::max);
        let shown_hz = |i: usize| folded_hz(group[i][0].reference.law.at_hz(self.turns_hz), self.rate_hz());
        let stands = |i: &usize| {
            let (amplitude, standard_error) = lines[*i];
            let is_near = |f: &&Found| (f.frequency_hz - shown_hz(*i)).abs() < self.skirt_hz(f);
            let near = known.iter().filter(is_near).map(|f| f.amplitude).fold(largest, f64::max);
            amplitude >= CLEAR * standard_error && amplitude >= SHARE * near
        };
        let standing: Vec<usize> = (0..group.len()).filter(stands).collect();
        if let Some((kept, other)) = self.unresolved(&group, &standing) {
            let same = std::mem::take(&mut group[other]);
            group[kept].extend(same);
            strongest_first(&mut group[kept]);
            group.remove(other);
            return self.amplitudes(group, known, left);
        }
        let mut found = Vec::new();
        for i in standing {
            let ((amplitude, standard_error), frequency_hz) = (lines[i], shown_hz(i));
            for (k, left) in left.iter_mut().enumerate() {
                *left -= solution[(2 * i, 0)] * wave(k, 2 * i) + solution[(2 * i + 1, 0)] * wave(k, 2 * i + 1);
            }
            let causes: Vec<Reference> = group[i].iter().map(|c| c.reference.clone()).collect();
            found.push(Found { frequency_hz, amplitude, standard_error, causes });
        }
        found
    }

    /// Two lines of which one may be of the mains, and the other is within its resolution: two phases share the power
    /// of a line whose frequency lies between them, and that of the mains is not known better.
    fn unresolved(&self, group: &[Vec<Candidate>], lines: &[usize]) -> Option<(usize, usize)> {
        let causes = |i: usize| group[i].iter().map(|c| c.reference.clone()).collect::<Vec<_>>();
        let pairs = lines.iter().enumerate().flat_map(|(k, i)| lines[..k].iter().map(move |j| (*j, *i)));
        pairs.into_iter().find(|(i, j)| self.is_unresolved(&causes(*i), &causes(*j)))
    }

    /// Tells whether one of two lines may be of the mains, and the other is within its resolution.
    fn is_unresolved(&self, a: &[Reference], b: &[Reference]) -> bool {
        let pairs = a.iter().flat_map(|a| b.iter().map(move |b| (a, b)));
        let mut pairs = pairs.filter(|(a, b)| is_of_mains(a) || is_of_mains(b));
        let shown_hz = |r: &Reference| folded_hz(r.law.at_hz(self.turns_hz), self.rate_hz());
        let is_near = |a, b| (shown_hz(a) - shown_hz(b)).abs() < SAME_BINS * self.bin_hz();
        pairs.any(|(a, b)| is_near(a, b) && self.likeness(&self.turning(a), &self.turning(b)) > RESOLVED)
    }

    /// Further possible causes of a line of which only straying ones were found: the mains, within their tolerance, and
    /// orders whose phase cannot be separated from its own.
    fn strays(&self, line: &Found, found: &[Found], references: &[Reference]) -> Vec<Reference> {
        let is_straying = |r: &Reference| is_of_mains(r) || matches!(r.cause, Cause::RippleSideband { .. });
        if line.causes.is_empty() || !line.causes.iter().all(is_straying) {
            return Vec::new();
        }
        let is_known = |r: &Reference| found.iter().flat_map(|f| &f.causes).any(|known| known.cause == r.cause);
        let own = self.turning(&line.causes[0]);
        let is_alike = |r: &Reference| self.likeness(&self.turning(r), &own) > SAME;
        let is_order = |r: &Reference| matches!(r.cause, Cause::Order { .. });
        let apart_hz = |r: &Reference| folded_hz(r.law.frequency_hz, self.rate_hz()) - line.frequency_hz;
        let is_mains = |r: &Reference| is_of_mains(r) && apart_hz(r).abs() < r.law.tolerance_hz;
        let is_meant = |r: &&Reference| is_mains(r) || (is_order(r) && is_alike(r));
        self.at(line.frequency_hz, references).filter(is_meant).filter(|r| !is_known(r)).cloned().collect()
    }

    /// Lines that stand out of the rest, away from those that were found: an order whose strength changes, or a line
    /// without a cause.
    fn beside(&self, found: &[Found], references: &[Reference]) -> Vec<Found> {
        let (samples, sample_time_s) = (&self.samples, self.signal.sample_time_s);
        let sinusoids = find_sinusoids(samples, sample_time_s, MOST_UNKNOWN, FALSE_ALARM).unwrap_or_default();
        let mut new: Vec<Found> = Vec::new();
        for s in sinusoids {
            let is_known = found.iter().chain(&new).any(|f| (f.frequency_hz - s.freq_hz).abs() < self.skirt_hz(f));
            let as_fixed = Reference::fixed(Cause::Unknown, s.freq_hz);
            if is_known || self.candidate(&as_fixed).is_none() {
                continue;
            }
            let has = |cause: &Cause| found.iter().flat_map(|f| &f.causes).any(|r| r.cause == *cause);
            let at: Vec<Reference> = self.at(s.freq_hz, references).filter(|r| !has(&r.cause)).cloned().collect();
            let causes = match at.is_empty() {
                true => self.modulated(s.freq_hz, references).into_iter().collect(),
                false => at,
            };
            let (amplitude, standard_error) = (s.amplitude, s.amplitude_deviation);
            new.push(Found { frequency_hz: s.freq_hz, amplitude, standard_error, causes });
        }
        new
    }

    /// The orders, multiples of the mains and sidebands of a ripple that a frequency is as far as the recording shows:
    /// with noise about it, what lies beside it may have hidden them.
    fn at<'r>(&self, frequency_hz: f64, references: &'r [Reference]) -> impl Iterator<Item = &'r Reference> {
        let is_meant =
            |cause: &Cause| matches!(cause, Cause::Mains { .. } | Cause::RippleSideband { .. } | Cause::Order { .. });
        let (turns_hz, rate_hz, bins_hz) = (self.turns_hz, self.rate_hz(), SAME_BINS * self.bin_hz());
        let apart_hz = move |r: &Reference| (folded_hz(r.law.at_hz(turns_hz), rate_hz) - frequency_hz).abs();
        let is_it = move |r: &&Reference| apart_hz(r) < r.law.tolerance_hz + bins_hz;
        references.iter().filter(move |r| is_meant(&r.cause)).filter(is_it)
    }

    /// The order in whose neighbourhood a frequency is.
    fn modulated(&self, frequency_hz: f64, references: &[Reference]) -> Option<Reference> {
        let distance = |r: &Reference| (folded_hz(r.law.at_hz(self.turns_hz), self.rate_hz()) - frequency_hz).abs();
        let orders = references.iter().filter(|r| matches!(r.cause, Cause::Order { .. } | Cause::FoldedOrder { .. }));
        let reach = |r: &Reference| match r.cause {
            Cause::Order { .. } => MODULATED_HZ + self.spread_hz(r),
            _ => BESIDE * self.bin_hz() + self.spread_hz(r),
        };
        orders.filter(|r| distance(r) < reach(r)).min_by(|a, b| distance(a).total_cmp(&distance(b))).cloned()
    }

    /// How far from a line something may belong to it.
    fn skirt_hz(&self, line: &Found) -> f64 {
        let changes = line.causes.iter().any(|r| matches!(r.cause, Cause::Order { .. }));
        let spread = line.causes.iter().map(|r| self.spread_hz(r)).fold(0.0, f64::max);
        spread + if changes { MODULATED_HZ } else { 0.0 } + BESIDE * self.bin_hz()
    }

    /// Spread of a reference that follows the speed: that of the speed, times the order, Hz.
    fn spread_hz(&self, reference: &Reference) -> f64 {
        reference.law.order.abs() * self.spread_hz
    }
}

fn is_of_mains(reference: &Reference) -> bool {
    matches!(reference.cause, Cause::Mains { .. })
}

/// Of candidates that cannot be separated the one first that explains most.
fn strongest_first(line: &mut [Candidate]) {
    let strongest = line.iter().enumerate().max_by(|a, b| a.1.power.total_cmp(&b.1.power)).map(|(k, _)| k);
    line[..=strongest.unwrap_or(0)].rotate_right(1);
}

/// Candidates in groups that touch each other; within a group those that cannot be separated are one.
fn grouped(seen: &Seen<'_>, candidates: Vec<Candidate>) -> Vec<Vec<Vec<Candidate>>> {
    let mut groups: Vec<Vec<Vec<Candidate>>> = Vec::new();
    for candidate in candidates {
        let nearest = |line: &[Candidate]| seen.likeness(&candidate.turning, &line[0].turning);
        let touches = |group: &[Vec<Candidate>]| group.iter().any(|line| nearest(line) > APART);
        let (mut joined, apart): (Vec<_>, Vec<_>) = groups.into_iter().partition(|group| touches(group));
        let mut group: Vec<Vec<Candidate>> = joined.drain(..).flatten().collect();
        let same = group.iter().map(|line| nearest(line)).enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
        match same.filter(|(_, likeness)| *likeness > SAME) {
            Some((line, _)) => group[line].push(candidate),
            None => group.push(vec![candidate]),
        }
        groups = apart;
        groups.push(group);
    }
    groups
}

/// Mean of noise powers, whose distribution is exponential, by their median and by what a tenth of them exceeds: few
/// lines among them do not count, but the comb does that steps leave, which cannot be separated from lines.
fn mean_noise(powers: &[f64]) -> f64 {
    let mut powers = powers.to_vec();
    let mut exceeded = |share: f64| {
        let place = (share * powers.len() as f64) as usize;
        order::select(&mut powers, place).unwrap_or(0.0)
    };
    (exceeded(0.5) / LN_2).max(exceeded(0.9) / LN_10)
}
