//! What a recording shows before any model is made of it: the lines of its spectra, each with its cause.
//!
//! A line is looked for behind the phase that its cause would give it: multiples of the crank angle, which are sharp however
//! the speed moves, and found where they fold to above half a channel's sample rate; and fixed frequencies, of the demand, of
//! the images that a held demand has, of the mains, and of sidebands of a ripple. Causes whose phases are too alike to
//! be told apart in a recording stay undecided, with a speed at which they lie apart. What stands out of the rest is a
//! line without a cause, or broad: a resonance, of the masses if several signals show it, of a sensor if it alone does.
//!
//! # Source
//! Glans & Kärnell, Chalmers EX112/2018, chapter 5; order tracking by the angle: Vold and Leuridan, *High resolution order
//! tracking at extreme slew rates*, SAE 931288, 1993, for the idea.

mod advice;
mod angle;
mod campbell;
mod cause;
mod demand;
mod lines;
mod over_speed;
mod reference;
mod resonance;
mod tracking;

use std::f64::consts::TAU;

use serde::Serialize;
use signal::Signal;
use signal::spectrum::{fft_frequencies_hz, fft_real};

use crate::model::Engine;
use crate::{ControlMode, Experiment, Role};
use angle::Angle;
pub use campbell::ShortSpectrum;
pub use cause::Cause;
use demand::Stretch;
use lines::{Found, Lines};
pub use over_speed::{CurvePoint, OrderCurve, OverSpeed, over_speed};
pub use reference::folded_hz;
use reference::{Reference, Setting};
use resonance::BroadPeak;
pub use tracking::{BANDWIDTH_ORDERS, OrderTrack, TURNS, TrackPoint};

/// Signals that the masses move.
const OF_THE_MASSES: [Role; 4] = [Role::DynoSpeed, Role::EngineSpeed, Role::SystemShaftTorque, Role::FlangeTorque];
/// Sensors with a resonance of their own, and the signal that shows the same without it.
const SENSORS: [(Role, Role); 1] = [(Role::LoadCellTorque, Role::AirGapTorque)];
/// The masses on a shaft of a bench resonate below this, Hz.
const HIGHEST_STRUCTURAL_HZ: f64 = 60.0;
/// A broad peak this close to a multiple of half the firing order, Hz, is of what varies from firing to firing.
const OF_A_FIRING_HZ: f64 = 0.6;
/// Slower than this, Hz, is drift; a line without a cause is not told from it.
const DRIFT_HZ: f64 = 3.0;
/// A sideband is at most this share of what swings.
const RIPPLED: f64 = 0.1;
/// An image in T_d is at most this many times what T_d* holds of it.
const FOLLOWED: f64 = 1.5;
/// An order is told from another by a signal in which it is this many times as strong.
const CLEARLY: f64 = 4.0;
/// A speed changes where it ranges over more than this share of its mean.
const CHANGES: f64 = 0.03;
/// What is slower than this, s, is the trend of a signal whose speed changes.
const TREND_S: f64 = 0.25;
/// A stretch has at least so many samples of a signal.
pub const FEWEST_SAMPLES: usize = 256;

/// What one recording shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Look {
    /// The file.
    pub file: String,
    /// The experiment's label.
    pub label: String,
    /// The order of the firing.
    pub firing_order: f64,
    /// Its parts: each sine of a sine test, or the whole.
    pub parts: Vec<LookedPart>,
}

/// What a part of a recording shows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LookedPart {
    /// From, s of the recording's clock.
    pub start_s: f64,
    /// To, s.
    pub end_s: f64,
    /// Mean speed of the engine, or of the dynamometer where that is not recorded, rad/s.
    pub speed_rad_s: f64,
    /// Lowest and highest speed, each a mean over a tracking window, rad/s.
    pub speed_range_rad_s: [f64; 2],
    /// Demanded sines, Hz.
    pub demanded_hz: Vec<f64>,
    /// Signals.
    pub signals: Vec<LookedSignal>,
}

/// A signal's spectrum and its lines.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LookedSignal {
    /// Which.
    pub role: Role,
    /// Time between its samples, s.
    pub sample_time_s: f64,
    /// Frequencies of the spectrum, Hz.
    pub frequency_hz: Vec<f64>,
    /// Amplitude of a sine there, in SI.
    pub amplitude: Vec<f64>,
    /// Lines, the strongest first.
    pub lines: Vec<Line>,
    /// Spectra of moments, for a Campbell map.
    pub short: Vec<ShortSpectrum>,
    /// Orders over time, where the speed changes.
    pub tracks: Vec<OrderTrack>,
}

/// A line, or a broad peak.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Line {
    /// Where it shows, Hz.
    pub frequency_hz: f64,
    /// Amplitude, in SI; of a broad peak, of what a bandwidth of half a hertz holds.
    pub amplitude: f64,
    /// Its standard error; none of a broad peak.
    pub standard_error: Option<f64>,
    /// Where it comes from.
    pub cause: Cause,
}

/// Names the lines of a recording.
///
/// # Example
/// ```
/// use bench::look::{Cause, look};
/// use bench::model::Engine;
/// use bench::virtual_bench::{BenchParameters, ExperimentPlan, simulate};
/// # use bench::{BenchFile, Role};
/// # let mut text = "[bench]\nname = \"x\"\nvariant = \"load-cell\"\ncylinders = 4\ndynamometer_inertia = 0.6\nengine_inertia = 0.28\n[channels]\n".to_owned();
/// # for (role, name) in bench::virtual_bench::CHANNELS { if !matches!(role, Role::FlangeTorque | Role::Throttle) { text += &format!("{} = \"{name}\"\n", role.key()); } }
/// # let file: BenchFile = text.parse()?;
/// let recording = simulate(&BenchParameters::default(), &ExperimentPlan::bs_t_nt(1230.0, 10.0), 1)?;
/// let (experiment, _) = bench::prepare("BS_T_NT_1230.mf4", &recording, &file, "BS_T_NT".parse()?)?;
/// let found = look(&experiment, Engine { cylinders: 4, strokes: 4 });
/// let speed = found.parts[0].signals.iter().find(|s| s.role == Role::EngineSpeed).ok_or("not recorded")?;
/// assert!((speed.lines[0].frequency_hz - 41.0).abs() < 0.1);
/// assert_eq!(speed.lines[0].cause, Cause::Order { order: 2.0, is_firing: true });
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn look(experiment: &Experiment, engine: Engine) -> Look {
    let speed = experiment.signal(Role::EngineSpeed).or_else(|| experiment.signal(Role::DynoSpeed));
    let angle = speed.filter(|speed| !speed.is_empty()).map(Angle::of);
    let looker = angle.as_ref().map(|angle| Looker { experiment, engine, angle });
    let parts = looker
        .iter()
        .flat_map(|looker| demand::stretches(experiment).iter().map(|s| looker.part(s)).collect::<Vec<_>>());
    Look {
        file: experiment.file.clone(),
        label: experiment.label.to_string(),
        firing_order: engine.firings_per_turn(),
        parts: parts.collect(),
    }
}

/// A recording to look at.
struct Looker<'a> {
    experiment: &'a Experiment,
    engine: Engine,
    angle: &'a Angle<'a>,
}

/// A signal of a part with what was found in it.
struct Shown {
    role: Role,
    signal: Signal,
    lines: Lines,
    broad: Vec<BroadPeak>,
}

impl Looker<'_> {
    fn part(&self, stretch: &Stretch) -> LookedPart {
        let turns_hz = self.angle.mean_hz(stretch.start_s, stretch.end_s);
        let demand = self.experiment.signal(demand::demand_role(self.experiment));
        let held_hz = demand.and_then(|demand| demand::held_hz(&demand.slice(stretch.start_s, stretch.end_s)));
        let mut shown: Vec<Shown> = self
            .experiment
            .signals
            .iter()
            .filter_map(|(role, signal)| self.shown(*role, signal, stretch, held_hz))
            .collect();
        let broad: Vec<Vec<BroadPeak>> =
            shown.iter().map(|one| self.broad(one, &shown, stretch.sines_hz.is_empty())).collect();
        shown.iter_mut().zip(broad).for_each(|(one, broad)| one.broad = broad);
        let range_hz = tracking::range_hz(self.angle, stretch.start_s, stretch.end_s);
        let changes = self.changes(stretch);
        let signals = shown.iter().map(|one| LookedSignal {
            lines: self.named(one, &shown, turns_hz),
            short: campbell::short_spectra(&one.signal, self.angle),
            tracks: match changes {
                true => tracking::order_tracks(&one.signal, self.angle, self.engine, &one.lines.found),
                false => Vec::new(),
            },
            ..spectrum(one.role, &one.signal)
        });
        LookedPart {
            start_s: stretch.start_s,
            end_s: stretch.end_s,
            speed_rad_s: TAU * turns_hz,
            speed_range_rad_s: range_hz.map(|hz| TAU * hz),
            demanded_hz: stretch.sines_hz.clone(),
            signals: signals.collect(),
        }
    }

    /// Whether the speed changes.
    fn changes(&self, stretch: &Stretch) -> bool {
        let [low, high] = tracking::range_hz(self.angle, stretch.start_s, stretch.end_s);
        high - low > CHANGES * 0.5 * (high + low)
    }

    fn shown(&self, role: Role, whole: &Signal, stretch: &Stretch, held_hz: Option<f64>) -> Option<Shown> {
        let mut signal = whole.slice(stretch.start_s, stretch.end_s);
        let is_still = signal.samples.iter().all(|x| *x == signal.samples[0]);
        if signal.len() < FEWEST_SAMPLES || is_still {
            return None;
        }
        if self.changes(stretch) {
            // Orders run through what a ramp leaves; it is no line.
            signal = without_trend(signal);
        }
        let setting = Setting {
            engine: self.engine,
            turns_hz: self.angle.mean_hz(signal.start_s, signal.end_s()),
            sines_hz: &stretch.sines_hz,
            held_hz,
            demand_answers: self.experiment.label.mode == ControlMode::Tn,
            highest_hz: self.highest_hz(),
        };
        let rate_hz = 1.0 / signal.sample_time_s;
        let references = match role == demand::demand_role(self.experiment) {
            true => setting.demanded(),
            false => setting.references(rate_hz),
        };
        let lines = Lines::of(&signal, self.angle, &references);
        Some(Shown { role, signal, lines, broad: Vec::new() })
    }

    /// Broad peaks over what excites them: a sensor's over what it measures, those of the masses over what a dynamometer is
    /// asked for, which a hold shapes where it is broad.
    fn broad(&self, one: &Shown, all: &[Shown], is_broad: bool) -> Vec<BroadPeak> {
        let of = |role: Role| all.iter().find(|shown| shown.role == role);
        let measured = SENSORS.iter().find(|(sensor, _)| *sensor == one.role).and_then(|(_, other)| of(*other));
        let excitation =
            of(demand::demand_role(self.experiment)).filter(|_| is_broad && OF_THE_MASSES.contains(&one.role));
        resonance::broad_peaks(&one.lines, measured.or(excitation).map(|other| &other.lines.left))
    }

    /// Whether there is an engine that turns: its speed is recorded.
    fn turns(&self) -> bool {
        self.experiment.signal(Role::EngineSpeed).is_some()
    }

    /// Half the highest sample rate.
    fn highest_hz(&self) -> f64 {
        self.experiment.signals.values().map(Signal::nyquist_hz).fold(0.0, f64::max)
    }

    fn named(&self, one: &Shown, all: &[Shown], turns_hz: f64) -> Vec<Line> {
        let line = |found: &Found| {
            let cause = decided(found, one, all, demand::demand_role(self.experiment), turns_hz);
            let is_drift = found.frequency_hz < DRIFT_HZ || one.lines.is_beside(found);
            (cause != Cause::Unknown || !is_drift).then_some(Line {
                frequency_hz: found.frequency_hz,
                amplitude: found.amplitude,
                standard_error: Some(found.standard_error),
                cause,
            })
        };
        let broad = one.broad.iter().filter_map(|peak| {
            let (frequency_hz, amplitude) = (peak.frequency_hz, peak.amplitude);
            let orders = 2.0 * frequency_hz / (self.engine.firings_per_turn() * turns_hz);
            let off_hz = (orders - orders.round()).abs() * frequency_hz / orders;
            let is_of_firing = self.turns() && orders > 0.5 && off_hz < OF_A_FIRING_HZ;
            let cause = of_peak(one.role, peak, all).filter(|_| !is_of_firing)?;
            Some(Line { frequency_hz, amplitude, standard_error: None, cause })
        });
        let mut lines: Vec<Line> = one.lines.found.iter().filter_map(line).chain(broad).collect();
        lines.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
        lines
    }
}

/// The one cause, or several that the recording does not part.
fn decided(found: &Found, one: &Shown, all: &[Shown], demand: Role, turns_hz: f64) -> Cause {
    let is_image = |r: &Reference| matches!(r.cause, Cause::HoldImage { .. });
    let is_sideband = |r: &Reference| matches!(r.cause, Cause::RippleSideband { .. });
    if found.frequency_hz < DRIFT_HZ && is_in_the_demand(found, all, demand) {
        return Cause::Demanded;
    }
    let mut causes: Vec<Reference> = found.causes.clone();
    let is_demanded = |r: &Reference| matches!(r.cause, Cause::Demanded | Cause::HoldImage { .. });
    if !causes.iter().any(is_demanded) && FOLLOWED * demanded_at(found.frequency_hz, all, demand) > found.amplitude {
        return Cause::Demanded;
    }
    causes.dedup_by(|a, b| a.cause == b.cause);
    causes.retain(|r| is_plausible(&r.cause, found.amplitude, one, all));
    // A multiple of the mains that folds onto a lower one is the weaker of the two; references come with the lowest first.
    let mut has_mains = false;
    causes.retain(|r| !matches!(r.cause, Cause::Mains { .. }) || !std::mem::replace(&mut has_mains, true));
    if let Some(demanded) = causes.iter().position(|r| r.cause == Cause::Demanded) {
        // What a sine's own images add to it where they fold onto it is little.
        causes = vec![causes.swap_remove(demanded)];
    }
    let image = causes.iter().find(|r| is_image(r)).cloned();
    if let Some(image) = image.filter(|_| causes.iter().any(is_sideband)) {
        // What the demand holds of it tells: an image is in T_d* already.
        let of_the_hold = FOLLOWED * demanded_amplitude(&image, all) > found.amplitude;
        causes.retain(|r| if of_the_hold { !is_sideband(r) } else { !is_image(r) });
    }
    if let Some(order) = told_by_a_faster_signal(&causes, one.role, all, turns_hz) {
        causes = vec![order];
    }
    match &causes[..] {
        [] if is_in_the_demand(found, all, demand) => Cause::Demanded,
        [] => Cause::Unknown,
        [one] => one.cause.clone(),
        several => Cause::Undecided {
            between: several.iter().map(|r| r.cause.clone()).collect(),
            repeat_at_rpm: advice::repeat_at_rpm(several, turns_hz, 1.0 / one.signal.sample_time_s),
        },
    }
}

/// Whether a cause can make a line as strong as this.
fn is_plausible(cause: &Cause, amplitude: f64, one: &Shown, all: &[Shown]) -> bool {
    let anywhere = |hz: f64| all.iter().any(|shown| shown.lines.strength_at(hz) > 0.0);
    match *cause {
        // A ripple that is there makes little of a torque swing.
        Cause::RippleSideband { of_hz, ripple_hz } => {
            amplitude < RIPPLED * one.lines.strength_at(of_hz) && anywhere(ripple_hz)
        }
        // An image is weaker than what it is one of.
        Cause::HoldImage { of_hz, .. } => amplitude < one.lines.strength_at(of_hz),
        // Higher multiples come with the ripple of a rectifier.
        Cause::Mains { multiple, mains_hz } => multiple <= 2 || anywhere(2.0 * mains_hz),
        _ => true,
    }
}

/// Of orders that fold onto each other, the one that stands out where N_d, the fastest signal, shows them apart.
fn told_by_a_faster_signal(causes: &[Reference], role: Role, all: &[Shown], turns_hz: f64) -> Option<Reference> {
    let faster = all.iter().find(|shown| shown.role == Role::DynoSpeed && shown.role != role)?;
    let is_told = |r: &Reference| {
        matches!(r.cause, Cause::Order { .. } | Cause::FoldedOrder { .. })
            && r.course.at_hz(turns_hz) < faster.signal.nyquist_hz()
    };
    if causes.len() < 2 || !causes.iter().all(is_told) {
        return None;
    }
    // T_shaft is to N_d as frequency, N_e above the resonance as its square.
    let power = match role {
        Role::EngineSpeed => 2,
        Role::SystemShaftTorque | Role::FlangeTorque => 1,
        _ => 0,
    };
    let strength = |r: &&Reference| {
        let hz = r.course.at_hz(turns_hz);
        let of_it =
            faster.lines.found.iter().filter(|line| line.causes.iter().any(|c| c.course.order == r.course.order));
        of_it.map(|line| line.amplitude * hz.powi(power)).fold(0.0, f64::max)
    };
    let mut ranked: Vec<&Reference> = causes.iter().collect();
    ranked.sort_by(|a, b| strength(b).total_cmp(&strength(a)));
    (strength(&ranked[0]) > CLEARLY * strength(&ranked[1])).then(|| ranked[0].clone())
}

/// Whether the demand holds a line that no sine in it explains, such as what rounding gives it.
fn is_in_the_demand(found: &Found, all: &[Shown], demand: Role) -> bool {
    all.iter().any(|shown| shown.role == demand && shown.lines.strength_at(found.frequency_hz) > 0.0)
}

/// The strength of the line that a demand of torque holds at a frequency; zero without.
fn demanded_at(frequency_hz: f64, all: &[Shown], demand: Role) -> f64 {
    let torque = all.iter().find(|shown| shown.role == demand && demand == Role::DynoTorqueDemand);
    torque.map_or(0.0, |shown| shown.lines.strength_at(frequency_hz))
}

/// How much of an image the demand of torque itself holds.
fn demanded_amplitude(image: &Reference, all: &[Shown]) -> f64 {
    let demand = all.iter().find(|shown| shown.role == Role::DynoTorqueDemand);
    let lines = demand.iter().flat_map(|demand| &demand.lines.found);
    lines
        .filter(|line| line.causes.iter().any(|r| r.cause == image.cause && r.course == image.course))
        .map(|l| l.amplitude)
        .sum()
}

/// The cause of a broad peak; none where it has no known one.
fn of_peak(role: Role, peak: &BroadPeak, all: &[Shown]) -> Option<Cause> {
    let shows = |other: Role| {
        let peaks = all.iter().filter(|shown| shown.role == other).flat_map(|shown| &shown.broad);
        peaks.into_iter().any(|p| resonance::is_one(p, peak))
    };
    if peak.frequency_hz < HIGHEST_STRUCTURAL_HZ
        && OF_THE_MASSES.contains(&role)
        && OF_THE_MASSES.iter().filter(|other| shows(**other)).count() > 1
    {
        return Some(Cause::StructuralResonance);
    }
    let is_strongest = |one: &&Shown| one.broad.iter().all(|other| other.excess <= peak.excess);
    if !all.iter().find(|shown| shown.role == role).is_some_and(|one| is_strongest(&one)) {
        return None;
    }
    let is_sensor =
        |(sensor, other): &&(Role, Role)| *sensor == role && all.iter().any(|s| s.role == *other) && !shows(*other);
    SENSORS.iter().find(is_sensor).map(|_| Cause::SensorResonance)
}

/// A signal less its mean over [`TREND_S`] about each sample, taken twice.
fn without_trend(signal: Signal) -> Signal {
    let half = (0.5 * TREND_S / signal.sample_time_s).round() as usize;
    let trend = moving_mean(&moving_mean(&signal.samples, half), half);
    let samples = signal.samples.iter().zip(trend).map(|(x, trend)| x - trend).collect();
    signal.with_samples(samples)
}

fn moving_mean(samples: &[f64], half: usize) -> Vec<f64> {
    let mut sums = vec![0.0];
    samples.iter().for_each(|x| sums.push(sums[sums.len() - 1] + x));
    let mean = |k: usize| {
        let (from, to) = (k.saturating_sub(half), (k + half + 1).min(samples.len()));
        (sums[to] - sums[from]) / (to - from) as f64
    };
    (0..samples.len()).map(mean).collect()
}

/// The spectrum of a signal, its mean taken out, seen through a Hann window; without lines yet.
fn spectrum(role: Role, signal: &Signal) -> LookedSignal {
    let (frequency_hz, amplitude) = amplitudes(&signal.samples, signal.sample_time_s);
    let (lines, short, tracks) = (Vec::new(), Vec::new(), Vec::new());
    LookedSignal { role, sample_time_s: signal.sample_time_s, frequency_hz, amplitude, lines, short, tracks }
}

/// Frequencies, Hz, and the amplitude of a sine at each, of samples without their mean, seen through a Hann window.
pub(crate) fn amplitudes(samples: &[f64], sample_time_s: f64) -> (Vec<f64>, Vec<f64>) {
    let count = samples.len() as f64;
    let mean = samples.iter().sum::<f64>() / count;
    let window = |k: usize| 1.0 - (TAU * (k as f64 + 0.5) / count).cos();
    let seen: Vec<f64> = samples.iter().enumerate().map(|(k, x)| window(k) * (x - mean)).collect();
    let lines = fft_real(&seen).unwrap_or_default();
    let amplitude = lines.iter().map(|line| 2.0 * line.norm() / count).collect();
    (fft_frequencies_hz(samples.len(), sample_time_s), amplitude)
}
