//! Order tracking: amplitude and phase of each order while the speed changes.
//!
//! Least squares in a window that slides along: within it x(t) = Σ_k (a_k cos φ_k(t) + b_k sin φ_k(t)) + c_0 + c_1 u +
//! c_2 u², φ_k = k θ(t) for an order k, 2πf_k t for a line that follows no speed, u the place in the window; every
//! residual is weighted by a Hann window over [`TURNS`] turns of the crank. The phase is taken at the instants of the
//! samples, so an order that folds is tracked like any other; orders that come close share their correlation out among
//! them, which their standard errors show. A single order's estimate is that of the time-variant discrete Fourier
//! transform; all at once, that with its orthogonality compensation. Its bandwidth is stated ([`BANDWIDTH_ORDERS`]),
//! and its error follows from what is left beside the order, which a Vold–Kalman filter's does not without a model of
//! how fast amplitudes wander.
//!
//! # Source
//! Blough, *Development and analysis of time variant discrete Fourier transform order tracking*, Mechanical Systems and
//! Signal Processing 17 (2003) 1185–1199; Vold and Leuridan, SAE 931288, 1993, for the alternative.

use std::f64::consts::{PI, TAU};

use faer::{Mat, c64};
use numerics::linalg;
use rig::facts::Engine;
use signal::Signal;

use super::angle::Angle;
use super::reference::PhaseLaw;
use super::search::Found;
use super::track::OrderTrack;
use super::track::TrackPoint;

/// The window, in turns of the crank: five working cycles of four strokes.
pub const TURNS: f64 = 10.0;
/// Equivalent noise bandwidth of the window, orders: that of a Hann window, 1.5 bins.
pub const BANDWIDTH_ORDERS: f64 = 1.5 / TURNS;
/// Windows of a recording, at most; they overlap by a half where there are fewer.
const MOST_WINDOWS: usize = 200;
/// Orders that are fitted at once, the strongest, and lines that follow no speed.
const MOST_ORDERS: usize = 8;
const MOST_STAYING: usize = 3;
/// Multiples of the firing order that are looked for.
const HIGHEST_FIRING: u32 = 6;
/// A window has so many samples for each coefficient.
const SAMPLES_EACH: f64 = 1.5;
/// Coefficients of what drifts.
const DRIFT: usize = 3;
/// Bins beside an order that show the noise: beyond the window's lobe, short of the next half order.
const BESIDE: [f64; 4] = [-3.0, -2.0, 2.0, 3.0];
/// Windows to either side whose noise counts too.
const NEIGHBOURS: usize = 3;
/// Where other lines make a variance this many times larger, they cannot be separated.
const INSEPARABLE: f64 = 10.0;
/// An order that stands this many standard errors above nothing on average is there.
const CLEAR: f64 = 3.0;

/// The orders of a signal, each over time, those that do not stand out left out; and the signal without them, each as
/// strong as it is at the moment. Lines that follow no speed are fitted beside them.
pub(super) fn order_tracks(
    signal: &Signal,
    angle: &Angle<'_>,
    engine: Engine,
    lines: &[Found],
) -> (Vec<OrderTrack>, Signal) {
    let windows: Vec<Window<'_>> = windows(signal, angle).collect();
    let alone = possible_orders(engine).map(|order| PhaseLaw { order, frequency_hz: 0.0, tolerance_hz: 0.0 });
    let mut orders: Vec<(f64, PhaseLaw)> = alone.filter_map(|law| Some((size(&windows, law)?, law))).collect();
    orders.sort_by(|a, b| b.0.total_cmp(&a.0));
    orders.truncate(MOST_ORDERS);
    let staying = lines.iter().filter_map(|line| line.causes.first()).map(|r| r.law).filter(|c| c.order == 0.0);
    let count = orders.len();
    let laws: Vec<PhaseLaw> = orders.into_iter().map(|(_, law)| law).chain(staying.take(MOST_STAYING)).collect();
    let fitted: Vec<Vec<Option<Fitted>>> = windows.iter().map(|window| window.fitted(&laws, count)).collect();
    let track = |at: usize| (at, OrderTrack { order: laws[at].order, points: points(&fitted, at) });
    let there: Vec<(usize, OrderTrack)> = (0..count).map(track).filter(|(_, track)| is_there(track)).collect();
    let followed: Vec<(usize, PhaseLaw)> = there.iter().map(|(at, _)| (*at, laws[*at])).collect();
    let rest = without(signal, &windows, &fitted, &followed);
    let mut tracks: Vec<OrderTrack> = there.into_iter().map(|(_, track)| track).collect();
    tracks.sort_by(|a, b| a.order.total_cmp(&b.order));
    (tracks, rest)
}

/// A signal less what its windows hold of some laws; nothing where no window reaches.
fn without(
    signal: &Signal,
    windows: &[Window<'_>],
    fitted: &[Vec<Option<Fitted>>],
    laws: &[(usize, PhaseLaw)],
) -> Signal {
    let (mut held, mut weights) = (vec![0.0; signal.len()], vec![0.0; signal.len()]);
    for (window, fitted) in windows.iter().zip(fitted) {
        let points: Vec<(PhaseLaw, TrackPoint)> =
            laws.iter().filter_map(|(at, law)| Some((*law, fitted[*at].as_ref()?.point))).collect();
        for (k, (time_s, weight)) in window.times_s.iter().zip(window.weights()).enumerate() {
            let wave = |(law, p): &(PhaseLaw, TrackPoint)| {
                p.amplitude * (law.phase(window.angle, *time_s) + p.phase_rad).cos()
            };
            held[window.first + k] += weight * points.iter().map(wave).sum::<f64>();
            weights[window.first + k] += weight;
        }
    }
    let left = |k: usize| if weights[k] > 0.0 { signal.samples[k] - held[k] / weights[k] } else { 0.0 };
    signal.with_samples((0..signal.len()).map(left).collect())
}

/// Multiples of a working cycle's frequency up to twice the firing order, and multiples of the firing order beyond.
fn possible_orders(engine: Engine) -> impl Iterator<Item = f64> {
    let (firing, step) = (engine.firings_per_turn(), 2.0 / f64::from(engine.strokes));
    let low = (1..=(2.0 * firing / step).round() as u32).map(move |k| step * f64::from(k));
    low.chain((3..=HIGHEST_FIRING).map(move |k| firing * f64::from(k)))
}

/// Mean amplitude of an order that is fitted alone; none of one that does not stand out.
fn size(windows: &[Window<'_>], law: PhaseLaw) -> Option<f64> {
    let fitted: Vec<Vec<Option<Fitted>>> = windows.iter().map(|window| window.fitted(&[law], 1)).collect();
    let track = OrderTrack { order: law.order, points: points(&fitted, 0) };
    is_there(&track).then(|| track.points.iter().map(|p| p.amplitude).sum::<f64>() / track.points.len() as f64)
}

fn is_there(track: &OrderTrack) -> bool {
    let ratios = track.points.iter().map(|p| (p.amplitude / p.standard_error.max(f64::MIN_POSITIVE)).powi(2));
    ratios.sum::<f64>() > CLEAR * CLEAR * track.points.len() as f64 && !track.points.is_empty()
}

/// Lowest and highest of the mean speeds over windows, Hz.
pub(super) fn range_hz(angle: &Angle<'_>, start_s: f64, end_s: f64) -> [f64; 2] {
    let turns = (angle.at(end_s) - angle.at(start_s)) / TAU;
    let count = ((turns / TURNS).floor().max(1.0) as usize).min(MOST_WINDOWS);
    let length_s = (end_s - start_s) / count as f64;
    let means =
        (0..count).map(|k| start_s + k as f64 * length_s).map(|from_s| angle.mean_hz(from_s, from_s + length_s));
    means.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], hz| [low.min(hz), high.max(hz)])
}

/// The points of one order. The noise about each is that of its own window, or where that is more, averaged with its
/// neighbours': a step of the demand is in one window alone.
fn points(fitted: &[Vec<Option<Fitted>>], order: usize) -> Vec<TrackPoint> {
    let of_order: Vec<&Fitted> = fitted.iter().filter_map(|window| window[order].as_ref()).collect();
    let noise = |k: usize| {
        let about = &of_order[k.saturating_sub(NEIGHBOURS)..(k + NEIGHBOURS + 1).min(of_order.len())];
        of_order[k].noise.max(about.iter().map(|fitted| fitted.noise).sum::<f64>() / about.len() as f64)
    };
    let point = |(k, fitted): (usize, &&Fitted)| TrackPoint {
        standard_error: (0.5 * noise(k) * fitted.widened).sqrt(),
        ..fitted.point
    };
    of_order.iter().enumerate().map(point).collect()
}

/// An order in a window, its standard error still open.
struct Fitted {
    point: TrackPoint,
    /// Mean power of what lies beside it, as of an amplitude.
    noise: f64,
    /// How many times larger other lines make its variance.
    widened: f64,
}

/// Samples about an instant with their weights.
struct Window<'a> {
    angle: &'a Angle<'a>,
    time_s: f64,
    turns_hz: f64,
    /// The first of its samples in the signal.
    first: usize,
    times_s: Vec<f64>,
    samples: Vec<f64>,
    /// Place in the window, −½ … ½ of its turns.
    places: Vec<f64>,
}

/// Windows along a signal, whole ones alone.
fn windows<'a>(signal: &'a Signal, angle: &'a Angle<'a>) -> impl Iterator<Item = Window<'a>> {
    let (start_s, end_s) = (signal.start_s, signal.end_s());
    let turns = (angle.at(end_s) - angle.at(start_s)) / TAU;
    let count = ((2.0 * turns / TURNS).floor().max(0.0) as usize).min(MOST_WINDOWS);
    let step_s = (end_s - start_s) / count.max(1) as f64;
    (0..count).filter_map(move |k| Window::about(signal, angle, start_s + (k as f64 + 0.5) * step_s))
}

impl<'a> Window<'a> {
    /// None where the recording ends within it, or the engine does not turn.
    fn about(signal: &'a Signal, angle: &'a Angle<'a>, time_s: f64) -> Option<Self> {
        let place = |time_s: f64, middle: f64| (angle.at(time_s) - middle) / (TAU * TURNS);
        let middle = angle.at(time_s);
        let is_whole = place(signal.start_s, middle) <= -0.5 && place(signal.end_s(), middle) >= 0.5;
        let is_inside = |k: &usize| place(signal.time_s(*k), middle).abs() < 0.5;
        let here = (((time_s - signal.start_s) / signal.sample_time_s) as usize).min(signal.len());
        let before = (0..here).rev().take_while(is_inside).last().unwrap_or(here);
        let indices: Vec<usize> = (before..signal.len()).take_while(is_inside).collect();
        let (first, last) = (*indices.first()?, *indices.last()?);
        let turns_hz = angle.mean_hz(signal.time_s(first), signal.time_s(last));
        (is_whole && last > first && turns_hz > 0.0).then(|| Window {
            angle,
            time_s,
            turns_hz,
            first,
            times_s: indices.iter().map(|k| signal.time_s(*k)).collect(),
            samples: indices.iter().map(|k| signal.samples[*k]).collect(),
            places: indices.iter().map(|k| place(signal.time_s(*k), middle)).collect(),
        })
    }

    fn weights(&self) -> Vec<f64> {
        self.places.iter().map(|u| (PI * u).cos().powi(2)).collect()
    }

    /// The first of some laws, all of which are fitted; none of those that cannot be separated.
    fn fitted(&self, laws: &[PhaseLaw], wanted: usize) -> Vec<Option<Fitted>> {
        let (rows, columns) = (self.samples.len(), 2 * laws.len() + DRIFT);
        if (rows as f64) < SAMPLES_EACH * columns as f64 {
            return (0..wanted).map(|_| None).collect();
        }
        let weights = self.weights();
        let phases: Vec<Vec<f64>> =
            laws.iter().map(|c| self.times_s.iter().map(|t| c.phase(self.angle, *t)).collect()).collect();
        let regressor = |k: usize, j: usize| match j.checked_sub(2 * laws.len()) {
            Some(power) => (2.0 * self.places[k]).powi(power as i32),
            None if j.is_multiple_of(2) => phases[j / 2][k].cos(),
            None => phases[j / 2][k].sin(),
        };
        let regressors = Mat::from_fn(rows, columns, regressor);
        let weighted = Mat::from_fn(rows, columns, |k, j| weights[k] * regressors[(k, j)]);
        let samples = Mat::from_fn(rows, 1, |k, _| self.samples[k]);
        let information = weighted.transpose() * &regressors;
        let inverse = linalg::inverse(information.as_ref());
        let solution = &inverse * (weighted.transpose() * &samples);
        let left = &samples - &regressors * &solution;
        let freedom = rows as f64 / (rows - columns) as f64;
        let point = |i: usize| {
            let [cosine, sine] = [solution[(2 * i, 0)], solution[(2 * i + 1, 0)]];
            let widening = |j: usize| inverse[(j, j)] * information[(j, j)];
            let widened = 0.5 * (widening(2 * i) + widening(2 * i + 1));
            let noise = freedom * self.noise(&phases[i], &weights, |k| left[(k, 0)]);
            let is_separable = widened.is_finite() && widened < INSEPARABLE && cosine.is_finite() && sine.is_finite();
            let point = TrackPoint {
                time_s: self.time_s,
                speed_rad_s: TAU * self.turns_hz,
                amplitude: cosine.hypot(sine),
                phase_rad: (-sine).atan2(cosine),
                standard_error: 0.0,
            };
            is_separable.then_some(Fitted { point, noise, widened })
        };
        (0..wanted).map(point).collect()
    }

    /// Mean power of what lies beside a phase, as of an amplitude.
    fn noise(&self, phase: &[f64], weights: &[f64], left: impl Fn(usize) -> f64) -> f64 {
        let scale = 2.0 / weights.iter().sum::<f64>();
        let power = |bin: &f64| {
            let term = |k: usize| c64::cis(-phase[k] - TAU * bin * self.places[k]) * (weights[k] * left(k));
            ((0..phase.len()).map(term).sum::<c64>() * scale).norm_sqr()
        };
        BESIDE.iter().map(power).sum::<f64>() / BESIDE.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lines::Cause;
    use crate::lines::reference::Reference;
    use signal::excitation::Random;

    /// Orders with their amplitudes, and a line that follows no speed.
    const ORDERS: [(f64, f64); 4] = [(2.0, 30.0), (2.5, 6.0), (4.0, 10.0), (8.0, 3.0)];
    const FIXED_HZ: f64 = 100.0;
    const ENGINE: Engine = Engine { cylinders: 4, strokes: 4 };

    fn run_up() -> Signal {
        // 900 to 2700 rpm in 20 s.
        Signal::new(0.0, 1e-3, (0..20_000).map(|k| 94.2 + 9.42e-3 * f64::from(k)).collect()).unwrap()
    }

    fn staying() -> Vec<Found> {
        let law = PhaseLaw { order: 0.0, frequency_hz: FIXED_HZ, tolerance_hz: 0.0 };
        let causes = vec![Reference { cause: Cause::Unknown, law }];
        vec![Found { frequency_hz: FIXED_HZ, amplitude: 2.0, standard_error: 0.0, causes }]
    }

    /// Sampled at 250 Hz: above 940 rpm order 8 folds, and crosses the others.
    fn torque(angle: &Angle<'_>, deviation: f64) -> Signal {
        let mut random = Random::new(5);
        let at = |k: i32| {
            let time_s = 0.004 * f64::from(k);
            let orders = ORDERS.map(|(order, amplitude)| amplitude * (order * angle.at(time_s)).cos());
            let drift = 40.0 + 0.5 * time_s;
            orders.iter().sum::<f64>() + 2.0 * (TAU * FIXED_HZ * time_s).sin() + drift + deviation * random.normal()
        };
        Signal::new(0.0, 0.004, (0..5000).map(at).collect()).unwrap()
    }

    #[test]
    fn exact_orders_of_a_run_up_are_tracked_where_they_fold_and_cross() {
        let speed = run_up();
        let angle = Angle::of(&speed);
        let torque = torque(&angle, 0.0);
        let (tracks, rest) = order_tracks(&torque, &angle, ENGINE, &staying());
        for (order, amplitude) in ORDERS {
            let track = tracks.iter().find(|track| track.order == order).unwrap();
            assert!(track.points.len() > 80, "{order}: {}", track.points.len());
            for point in &track.points {
                assert!((point.amplitude - amplitude).abs() < 1e-6, "{order}: {point:?}");
                assert!(point.phase_rad.abs() < 1e-6, "{order}: {point:?}");
            }
        }
        // What is left is the line that follows no speed, and the drift, but where orders cross.
        let known = |time_s: f64| 2.0 * (TAU * FIXED_HZ * time_s).sin() + 40.0 + 0.5 * time_s;
        let is_free = |k: &usize| (rest.samples[*k] - known(rest.time_s(*k))).abs() < 1e-5;
        let free = (0..rest.len()).filter(is_free).count();
        assert!(free as f64 > 0.6 * rest.len() as f64, "{free} of {}", rest.len());
        let [low, high] = range_hz(&angle, 0.0, 20.0);
        assert!((60.0 * low - 900.0).abs() < 40.0 && (60.0 * high - 2700.0).abs() < 40.0, "{low} {high}");
    }

    #[test]
    fn stat_the_standard_error_of_a_track_covers() {
        let speed = run_up();
        let angle = Angle::of(&speed);
        let (tracks, _) = order_tracks(&torque(&angle, 2.0), &angle, ENGINE, &staying());
        let ratios: Vec<f64> = tracks
            .iter()
            .filter_map(|track| Some((track, ORDERS.iter().find(|o| o.0 == track.order)?.1)))
            .flat_map(|(track, amplitude)| {
                track.points.iter().map(move |p| (p.amplitude - amplitude) / p.standard_error)
            })
            .collect();
        let within = ratios.iter().filter(|r| r.abs() < 2.0).count() as f64 / ratios.len() as f64;
        let spread = (ratios.iter().map(|r| r * r).sum::<f64>() / ratios.len() as f64).sqrt();
        assert!((0.91..0.98).contains(&within) && spread < 1.15, "{within} of {}, {spread}", ratios.len());
    }
}
