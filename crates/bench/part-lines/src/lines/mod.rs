//! Lines in the spectra of a recording before any model is made of it, each with its cause.
//!
//! A line is looked for behind the phase that its cause would give it: multiples of the crank angle, which are sharp
//! however the speed moves, and found where they fold to above half a channel's sample rate; and fixed frequencies, of
//! the demand, of the images that a held demand has, of the mains, and of sidebands of a ripple. Causes whose phases
//! are too alike to be separated in a recording stay undecided, with a speed at which they lie apart. What stands out
//! of the rest is a line without a cause, or broad: a resonance of the masses if several signals show it and N_d and
//! N_e swing as two masses on a shaft do, one of a sensor if it alone shows it.
//!
//! A line that stays undecided is rightly named where its cause is among those that it is undecided between.
//!
//! # Source
//! Glans & Kärnell, Chalmers EX112/2018, chapter 5; order tracking by the angle: Vold and Leuridan, *High resolution
//! order tracking at extreme slew rates*, SAE 931288, 1993, for the idea.

mod advice;
mod amplitudes;
mod angle;
mod campbell;
mod cause;
mod demand;
mod found;
mod mains;
mod naming;
mod opposition;
mod over_speed;
mod reference;
mod resonance;
mod search;
mod shown;
mod track;
mod tracking;

use std::f64::consts::TAU;

use numerics::parallel;
use rig::facts::Engine;
use rig::{BenchFile, ControlMode, Experiment, Role};
use signal::Signal;

pub use amplitudes::amplitudes;
use angle::Angle;
pub use campbell::ShortSpectrum;
pub use cause::Cause;
use demand::Stretch;
use found::{CHANGES, DRIFT_HZ, OF_THE_MASSES, SENSORS};
pub use found::{Line, PartLines, RecordingLines, SignalLines};
pub use mains::on_one_mains;
use naming::Naming;
pub use over_speed::{CurvePoint, OrderCurve, OverSpeed, over_speed};
pub use reference::folded_hz;
use reference::{Reference, Setting};
use resonance::BroadPeak;
use search::{Found, Lines};
use shown::Shown;
pub use track::OrderTrack;
pub use track::TrackPoint;
pub use tracking::{BANDWIDTH_ORDERS, TURNS};

/// A broad peak this close to a multiple of half the firing order, Hz, for more than this share of the time, is of what
/// varies from firing to firing; a line without a cause this close to any order is of it.
const OF_A_FIRING_HZ: f64 = 0.6;
const OFTEN: f64 = 0.2;
/// Time above which a change is the trend of a signal whose speed changes, s.
const TREND_S: f64 = 0.25;
/// A stretch has at least so many samples of a signal.
pub const FEWEST_SAMPLES: usize = 256;

/// Names the lines of a recording.
///
/// # Example
/// ```
/// use part_lines::lines::{Cause, find_lines};
/// use rig::bench_parameters::BenchParameters;
/// use rig::experiment::ExperimentPlan;
/// use virtual_bench::simulate;
/// # use rig::{BenchFile, Role};
/// # let mut text = "[bench]\nname = \"x\"\nvariant = \"load-cell\"\ncylinders = 4\ndynamometer_inertia = 0.6\nengine_inertia = 0.28\n[channels]\n".to_owned();
/// # for (role, name) in virtual_bench::CHANNELS { if !matches!(role, Role::FlangeTorque | Role::Throttle) { text += &format!("{} = \"{name}\"\n", role.key()); } }
/// # let file: BenchFile = text.parse()?;
/// let recording = simulate(&BenchParameters::default(), &ExperimentPlan::bs_t_nt(1230.0, 10.0), 1)?;
/// let (experiment, _) = rig::prepare("BS_T_NT_1230.mf4", &recording, &file, "BS_T_NT".parse()?)?;
/// let found = find_lines(&experiment, &file);
/// let speed = found.parts[0].signals.iter().find(|s| s.role == Role::EngineSpeed).ok_or("not recorded")?;
/// assert!((speed.lines[0].frequency_hz - 41.0).abs() < 0.1);
/// assert_eq!(speed.lines[0].cause, Cause::Order { order: 2.0, is_firing: true });
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn find_lines(experiment: &Experiment, bench: &BenchFile) -> RecordingLines {
    // Without the shaft nothing of the engine is in what the dynamometer shows.
    let engine = (!experiment.label.is_without_shaft()).then(|| bench.engine());
    let inertias_kg_m2 = [bench.dynamometer_inertia_kg_m2, bench.engine_inertia_kg_m2];
    let turning = if engine.is_some() { Role::EngineSpeed } else { Role::DynoSpeed };
    let speed = experiment.signal(turning).or_else(|| experiment.signal(Role::DynoSpeed));
    let angle = speed.filter(|speed| !speed.is_empty()).map(Angle::of);
    let looker = angle.as_ref().map(|angle| Looker { experiment, engine, inertias_kg_m2, angle });
    let parts = looker
        .iter()
        .flat_map(|looker| demand::stretches(experiment).iter().map(|s| looker.part(s)).collect::<Vec<_>>());
    RecordingLines {
        file: experiment.file.clone(),
        label: experiment.label.clone(),
        firing_order: engine.map(|engine| engine.firings_per_turn()),
        parts: parts.collect(),
    }
}

/// A recording to look at.
struct Looker<'a> {
    experiment: &'a Experiment,
    /// None without the shaft.
    engine: Option<Engine>,
    /// Of the dynamometer and of the engine.
    inertias_kg_m2: [f64; 2],
    angle: &'a Angle<'a>,
}

impl Looker<'_> {
    fn part(&self, stretch: &Stretch) -> PartLines {
        let turns_hz = self.angle.mean_hz(stretch.start_s, stretch.end_s);
        let demand = self.experiment.signal(demand::demand_role(self.experiment));
        let held_hz = demand.and_then(|demand| demand::held_hz(&demand.slice(stretch.start_s, stretch.end_s)));
        let signals: Vec<(&Role, &Signal)> = self.experiment.signals.iter().collect();
        let shown = parallel::map(&signals, |(role, signal)| self.shown(**role, signal, stretch, held_hz));
        let mut shown: Vec<Shown> = shown.into_iter().flatten().collect();
        let broad: Vec<Vec<BroadPeak>> =
            shown.iter().map(|one| self.broad(one, &shown, stretch.sines_hz.is_empty())).collect();
        shown.iter_mut().zip(broad).for_each(|(one, broad)| one.broad = broad);
        let range_hz = tracking::range_hz(self.angle, stretch.start_s, stretch.end_s);
        let is_of_firing = |hz: f64| self.is_of_firing(hz, stretch);
        let naming =
            Naming::new(&shown, demand::demand_role(self.experiment), turns_hz, (self.inertias_kg_m2, is_of_firing));
        let signals = parallel::map(&shown, |one| SignalLines {
            lines: self.named(one, &naming, stretch),
            short: campbell::short_spectra(&one.signal, self.angle),
            tracks: one.tracks.clone(),
            ..spectrum(one.role, &one.signal)
        });
        PartLines {
            start_s: stretch.start_s,
            end_s: stretch.end_s,
            speed_rad_s: TAU * turns_hz,
            speed_range_rad_s: range_hz.map(|hz| TAU * hz),
            demanded_hz: stretch.sines_hz.clone(),
            signals,
        }
    }

    /// Tells whether the speed changes.
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
        let changes = self.changes(stretch);
        if changes {
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
        let is_asked_for = role == demand::demand_role(self.experiment);
        let references = if is_asked_for { setting.demanded() } else { setting.references(rate_hz) };
        let lines = Lines::of(&signal, self.angle, &references);
        let (lines, tracks) = match self.engine.filter(|_| changes && !is_asked_for) {
            Some(engine) => self.followed(engine, &signal, lines, &references),
            None => (lines, Vec::new()),
        };
        Some(Shown { role, signal, lines, broad: Vec::new(), tracks })
    }

    /// Orders that can be followed through a change of speed, and the lines of the rest. An order's strength changes
    /// with the speed: what a constant one leaves of it shows wherever another phase meets it, where the speed rests
    /// above all.
    fn followed(
        &self,
        engine: Engine,
        signal: &Signal,
        lines: Lines,
        references: &[Reference],
    ) -> (Lines, Vec<OrderTrack>) {
        let (tracks, rest) = tracking::order_tracks(signal, self.angle, engine, &lines.found);
        let is_order = |r: &&Reference| matches!(r.cause, Cause::Order { .. } | Cause::FoldedOrder { .. });
        let others: Vec<Reference> = references.iter().filter(|r| !is_order(r)).cloned().collect();
        (lines.of_changing(&tracks, Lines::of(&rest, self.angle, &others)), tracks)
    }

    /// Broad peaks over what excites them: a sensor's over what it measures, those of the masses over what a
    /// dynamometer is asked for, which a hold shapes where it is broad.
    fn broad(&self, one: &Shown, all: &[Shown], is_broad: bool) -> Vec<BroadPeak> {
        let of = |role: Role| all.iter().find(|shown| shown.role == role);
        let measured = SENSORS.iter().find(|(sensor, _)| *sensor == one.role).and_then(|(_, other)| of(*other));
        let excitation =
            of(demand::demand_role(self.experiment)).filter(|_| is_broad && OF_THE_MASSES.contains(&one.role));
        resonance::broad_peaks(&one.lines, measured.or(excitation).map(|other| &other.lines.left))
    }

    /// Tells whether a frequency is that of what varies from firing to firing: not without an engine, whose speed is
    /// recorded.
    fn is_of_firing(&self, frequency_hz: f64, stretch: &Stretch) -> bool {
        let Some(engine) = self.engine.filter(|_| self.experiment.signal(Role::EngineSpeed).is_some()) else {
            return false;
        };
        // Where the speed changes, weak orders are not followed.
        let order = if self.changes(stretch) { self.cycle_order() } else { 0.5 * engine.firings_per_turn() };
        self.meets(order, |_| frequency_hz, stretch)
    }

    /// The order of a working cycle; without an engine that of a turn.
    fn cycle_order(&self) -> f64 {
        self.engine.map_or(1.0, |engine| 2.0 / f64::from(engine.strokes))
    }

    /// Tells whether a frequency often is that of a multiple of an order.
    fn meets(&self, order: f64, frequency_hz: impl Fn(f64) -> f64, stretch: &Stretch) -> bool {
        self.angle.share_at([stretch.start_s, stretch.end_s], order, frequency_hz, OF_A_FIRING_HZ) > OFTEN
    }

    /// Tells whether a line may be of an order that is too weak to be followed. Where the speed changes, one shows at
    /// each speed at which it rests, and with it whatever phase it meets there.
    fn may_be_an_order(&self, found: &Found, one: &Shown, stretch: &Stretch) -> bool {
        let law = found.causes.first().map(|r| r.law);
        let at_hz = |turns_hz: f64| law.map_or(found.frequency_hz, |law| law.at_hz(turns_hz));
        let (order, rate_hz) = (self.cycle_order(), 1.0 / one.signal.sample_time_s);
        let meets =
            |unfolded: fn(f64, f64) -> f64| self.meets(order, |turns_hz| unfolded(at_hz(turns_hz), rate_hz), stretch);
        meets(|hz, _| hz) || meets(|hz, rate_hz| (rate_hz - hz).abs()) || meets(|hz, rate_hz| rate_hz + hz)
    }

    /// Tells whether a line is none of its own: drift, part of a stronger one, or, where the speed changes, of an
    /// order. What is in the demand, the ripple and orders are.
    fn is_of_another(&self, found: &Found, cause: &Cause, one: &Shown, stretch: &Stretch) -> bool {
        let is_drift = found.frequency_hz < DRIFT_HZ || one.lines.is_beside(found);
        match cause {
            Cause::Demanded | Cause::Mains { multiple: 2, .. } => false,
            _ if found.causes.iter().any(|r| matches!(r.cause, Cause::Order { .. } | Cause::FoldedOrder { .. })) => {
                false
            }
            Cause::Unknown if is_drift => true,
            // A phase that follows the speed without having a cause meets another's.
            Cause::Unknown if self.changes(stretch) && !found.causes.is_empty() => true,
            _ => self.changes(stretch) && self.may_be_an_order(found, one, stretch),
        }
    }

    /// Half the highest sample rate.
    fn highest_hz(&self) -> f64 {
        self.experiment.signals.values().map(Signal::nyquist_hz).fold(0.0, f64::max)
    }

    fn named(&self, one: &Shown, naming: &Naming<'_>, stretch: &Stretch) -> Vec<Line> {
        let line = |found: &Found| {
            let cause = naming.of_line(found, one);
            (!self.is_of_another(found, &cause, one, stretch)).then_some(Line {
                frequency_hz: found.frequency_hz,
                amplitude: found.amplitude,
                standard_error: Some(found.standard_error),
                cause,
            })
        };
        let broad = one.broad.iter().filter_map(|peak| {
            let (frequency_hz, amplitude) = (peak.frequency_hz, peak.amplitude);
            let cause = naming.of_peak(peak, one).filter(|_| !self.is_of_firing(frequency_hz, stretch))?;
            Some(Line { frequency_hz, amplitude, standard_error: None, cause })
        });
        let mut lines: Vec<Line> = one.lines.found.iter().filter_map(line).chain(broad).collect();
        lines.sort_by(|a, b| b.amplitude.total_cmp(&a.amplitude));
        lines
    }
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
fn spectrum(role: Role, signal: &Signal) -> SignalLines {
    let (frequency_hz, amplitude) = amplitudes(&signal.samples, signal.sample_time_s);
    let (lines, short, tracks) = (Vec::new(), Vec::new(), Vec::new());
    SignalLines { role, sample_time_s: signal.sample_time_s, frequency_hz, amplitude, lines, short, tracks }
}
