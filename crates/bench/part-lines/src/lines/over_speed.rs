//! Content of a signal over the speed, of all recordings together: a Campbell map, and its orders' amplitudes.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use faer::c64;
use numerics::null::nan_if_null;
use rig::Role;
use serde::{Deserialize, Serialize};

use super::campbell::ShortSpectrum;
use super::cause::Cause;
use crate::lines::found::{CHANGES, Line, PartLines, RecordingLines, SignalLines};
use crate::lines::track::TrackPoint;

/// Classes of speed from the lowest to the highest.
const CLASSES: usize = 60;
/// Classes without a spectrum take that of one so many away.
const REACH: usize = 2;
/// Orders that are drawn, the strongest.
const MOST_ORDERS: usize = 10;
/// An order stands out where it is this many times its standard error.
const CLEAR: f64 = 3.0;
/// A line that stays is one of the bench where parts of so many seconds together show it.
const LONG_S: f64 = 10.0;
/// Lines that follow no speed within this share of each other are one.
const ONE_LINE: f64 = 0.1;

/// A signal over the speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OverSpeed {
    /// Which.
    pub role: Role,
    /// Time between its samples, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub sample_time_s: f64,
    /// Lowest and highest speed, rad/s; the classes of speed are of equal width between them.
    #[serde(deserialize_with = "nan_if_null")]
    pub speed_rad_s: [f64; 2],
    /// Root mean squares of the short spectra of each class, every [`ShortSpectrum::STEP_HZ`] from zero on, in SI;
    /// empty where no recording has the speed.
    #[serde(deserialize_with = "nan_if_null")]
    pub map: Vec<Vec<f64>>,
    /// Orders over the speed that stand out anywhere, the strongest first; of recordings with the engine on the shaft.
    pub orders: Vec<OrderCurve>,
    /// Resonances, and multiples of the mains: lines that stay where they are.
    pub staying: Vec<Line>,
}

/// An order over the speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OrderCurve {
    /// The multiple of the engine's speed.
    #[serde(deserialize_with = "nan_if_null")]
    pub order: f64,
    /// True for the order of the firing, and for a multiple of it.
    pub is_firing: bool,
    /// Class by class; classes without are left out.
    pub points: Vec<CurvePoint>,
}

/// An order at a class of speeds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CurvePoint {
    /// Mean speed, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub speed_rad_s: f64,
    /// Amplitude, in SI: the root of the mean power, less that of the noise.
    #[serde(deserialize_with = "nan_if_null")]
    pub amplitude: f64,
    /// Standard error of it.
    #[serde(deserialize_with = "nan_if_null")]
    pub standard_error: f64,
    /// Phase of the mean, rad, as that of a [`TrackPoint`]; none at a steady speed, and none of several recordings,
    /// whose crank angles begin anywhere.
    pub phase_rad: Option<f64>,
}

/// Each signal over the speed; none where all recordings have one speed.
#[must_use]
pub fn over_speed(looks: &[RecordingLines]) -> Vec<OverSpeed> {
    let parts: Vec<&PartLines> = looks.iter().flat_map(|look| &look.parts).collect();
    let ends = parts.iter().flat_map(|part| part.speed_range_rad_s);
    let [low, high] = ends.fold([f64::INFINITY, 0.0], |[low, high], w| [w.min(low), w.max(high)]);
    if high - low < CHANGES * 0.5 * (high + low) || low <= 0.0 {
        return Vec::new();
    }
    let mut by_role: BTreeMap<Role, Vec<Shown<'_>>> = BTreeMap::new();
    for look in looks {
        for part in &look.parts {
            let signals = part.signals.iter().filter(|signal| signal.role != Role::DynoSpeedDemand);
            let shown = signals.map(|signal| Shown { firing_order: look.firing_order, part, signal });
            shown.for_each(|shown| by_role.entry(shown.signal.role).or_default().push(shown));
        }
    }
    by_role.into_values().filter_map(|shown| of_role(&shown, [low, high])).collect()
}

/// A signal of a part.
#[derive(Clone, Copy)]
struct Shown<'a> {
    /// None without the shaft.
    firing_order: Option<f64>,
    part: &'a PartLines,
    signal: &'a SignalLines,
}

impl<'a> Shown<'a> {
    /// Resonances and multiples of the mains.
    fn staying(&self) -> impl Iterator<Item = &'a Line> + use<'a> {
        let is_staying =
            |c: &Cause| matches!(c, Cause::StructuralResonance | Cause::SensorResonance | Cause::Mains { .. });
        self.signal.lines.iter().filter(move |line| is_staying(&line.cause))
    }
}

fn of_role(shown: &[Shown<'_>], range: [f64; 2]) -> Option<OverSpeed> {
    let first = shown.first()?.signal;
    let of_engine: Vec<Shown<'_>> = shown.iter().filter(|one| one.firing_order.is_some()).copied().collect();
    let firing = of_engine.iter().find_map(|one| one.firing_order);
    Some(OverSpeed {
        role: first.role,
        sample_time_s: first.sample_time_s,
        speed_rad_s: range,
        map: map(shown, range),
        orders: firing.map(|firing| orders(&of_engine, range, firing)).unwrap_or_default(),
        staying: staying(shown),
    })
}

fn class(speed_rad_s: f64, [low, high]: [f64; 2]) -> usize {
    ((CLASSES as f64 * (speed_rad_s - low) / (high - low)).max(0.0) as usize).min(CLASSES - 1)
}

fn map(shown: &[Shown<'_>], range: [f64; 2]) -> Vec<Vec<f64>> {
    let mut classes: Vec<Vec<&ShortSpectrum>> = vec![Vec::new(); CLASSES];
    for short in shown.iter().flat_map(|one| &one.signal.short) {
        classes[class(short.speed_rad_s, range)].push(short);
    }
    let root_mean_square = |class: &Vec<&ShortSpectrum>| {
        let lines = class.iter().map(|short| short.amplitude.len()).min().unwrap_or(0);
        let power = |line: usize| class.iter().map(|short| short.amplitude[line].powi(2)).sum::<f64>();
        (0..lines).map(|line| (power(line) / class.len() as f64).sqrt()).collect()
    };
    let known: Vec<Vec<f64>> = classes.iter().map(root_mean_square).collect();
    // A short spectrum covers the speeds beside it too.
    let nearest = |at: usize| {
        let beside = (0..=REACH).flat_map(|off| [at.checked_sub(off), Some(at + off)]).flatten();
        beside.filter_map(|at| known.get(at)).find(|column| !column.is_empty()).cloned().unwrap_or_default()
    };
    (0..CLASSES).map(nearest).collect()
}

fn orders(shown: &[Shown<'_>], range: [f64; 2], firing: f64) -> Vec<OrderCurve> {
    // Orders are multiples of a half, or of one.
    let mut tracked: BTreeMap<u64, Vec<TrackPoint>> = BTreeMap::new();
    let key = |order: f64| (2.0 * order).round() as u64;
    for Shown { part, signal, .. } in shown {
        for track in &signal.tracks {
            tracked.entry(key(track.order)).or_default().extend(&track.points);
        }
        for line in signal.lines.iter().filter(|_| signal.tracks.is_empty()) {
            if let (Some(order), Some(standard_error)) = (order(&line.cause), line.standard_error) {
                let (time_s, speed_rad_s) = (0.5 * (part.start_s + part.end_s), part.speed_rad_s);
                let point =
                    TrackPoint { time_s, speed_rad_s, amplitude: line.amplitude, phase_rad: f64::NAN, standard_error };
                tracked.entry(key(order)).or_default().push(point);
            }
        }
    }
    let is_one_recording = shown.len() == 1;
    let curve = |(key, points): (u64, Vec<TrackPoint>)| {
        let order = 0.5 * key as f64;
        let is_firing = (order / firing).fract() == 0.0;
        OrderCurve { order, is_firing, points: curve_points(&points, range, is_one_recording) }
    };
    let mut curves: Vec<OrderCurve> = tracked.into_iter().map(curve).filter(OrderCurve::stands_out).collect();
    let largest = |curve: &OrderCurve| curve.peak().map_or(0.0, |point| point.amplitude);
    curves.sort_by(|a, b| largest(b).total_cmp(&largest(a)));
    curves.truncate(MOST_ORDERS);
    curves
}

fn order(cause: &Cause) -> Option<f64> {
    match cause {
        Cause::Order { order, .. } | Cause::FoldedOrder { order, .. } => Some(*order),
        _ => None,
    }
}

/// Means over classes of speed. Of amplitudes the noise does not average out, of powers less the noise's it does: |x +
/// n|² has the mean A² + 2σ² and the variance 4A²σ² + 4σ⁴, σ the standard error of an amplitude (Rice's distribution).
fn curve_points(points: &[TrackPoint], range: [f64; 2], has_phase: bool) -> Vec<CurvePoint> {
    let mut classes: BTreeMap<usize, Vec<&TrackPoint>> = BTreeMap::new();
    for point in points {
        classes.entry(class(point.speed_rad_s, range)).or_default().push(point);
    }
    let mean = |class: Vec<&TrackPoint>| {
        let count = class.len() as f64;
        let sum = |of: fn(&TrackPoint) -> f64| class.iter().map(|p| of(p)).sum::<f64>();
        let whole: c64 = class.iter().map(|p| c64::cis(p.phase_rad) * p.amplitude).sum();
        let power = (sum(|p| p.amplitude.powi(2) - 2.0 * p.standard_error.powi(2)) / count).max(0.0);
        let noise = sum(|p| p.standard_error.powi(2)) / count;
        // dA = d(A²) / 2A, of one that does not stand out √d(A²).
        let deviation = (4.0 * (power * noise + noise * noise) / count).sqrt();
        CurvePoint {
            speed_rad_s: sum(|p| p.speed_rad_s) / count,
            amplitude: power.sqrt(),
            standard_error: deviation.sqrt().min(deviation / (2.0 * power.sqrt())),
            phase_rad: (has_phase && whole.arg().is_finite()).then(|| whole.arg()),
        }
    };
    classes.into_values().map(mean).collect()
}

/// Resonances and multiples of the mains, the strongest of those at one frequency; none that a short part alone shows.
fn staying(shown: &[Shown<'_>]) -> Vec<Line> {
    let is_one = |a: &Line, b: &Line| (a.frequency_hz / b.frequency_hz - 1.0).abs() <= ONE_LINE;
    let seen_s = |line: &Line| {
        let parts = shown.iter().filter(|one| one.staying().any(|other| is_one(other, line)));
        parts.map(|one| one.part.end_s - one.part.start_s).sum::<f64>()
    };
    let mut all: Vec<&Line> = shown.iter().flat_map(Shown::staying).filter(|line| seen_s(line) >= LONG_S).collect();
    all.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
    let mut kept: Vec<Line> = Vec::new();
    for line in all {
        if !kept.iter().any(|other| is_one(other, line)) {
            kept.push(line.clone());
        }
    }
    kept
}

impl OrderCurve {
    /// Where it is surely largest: where two standard errors below it is; none where it has no points.
    pub fn peak(&self) -> Option<CurvePoint> {
        let surely = |point: &CurvePoint| point.amplitude - 2.0 * point.standard_error;
        self.points.iter().copied().max_by(|a, b| surely(a).total_cmp(&surely(b)))
    }

    /// Tells whether the order stands out where it is surely largest.
    fn stands_out(&self) -> bool {
        self.peak().is_some_and(|peak| peak.amplitude > CLEAR * peak.standard_error)
    }

    /// Its frequency at a speed, Hz.
    pub fn at_hz(&self, speed_rad_s: f64) -> f64 {
        self.order * speed_rad_s / TAU
    }
}
