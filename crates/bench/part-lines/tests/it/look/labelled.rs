//! Simulated recordings with the true cause of each line, known by what is missing where a cause is switched off.

use std::f64::consts::TAU;

use faer::c64;
use part_lines::lines::{Cause, Line, PartLines, RecordingLines, SignalLines, find_lines};
use rig::bench_parameters::{BenchParameters, PulseParameters};
use rig::experiment::{ExperimentPlan, Test, Waveform};
use rig::facts::{BenchVariant, Engine};
use rig::{BenchFile, ControlMode, Experiment, Role, prepare};
use signal::Signal;
use signal::excitation::Random;
use units::RPM_RAD_S;
use virtual_bench::{Numerics, simulate, simulate_hidden};

/// Sources that a component needs to be there.
const SOURCES: usize = 4;
const TURNING: usize = 0;
const RIPPLE: usize = 1;
const HOLD: usize = 2;
const SINE: usize = 3;
/// Orders up to this multiple of the firing order are looked up.
const HIGHEST_FIRING: f64 = 6.0;
/// The strength of what turns with the engine changes within this, Hz.
const MODULATED_HZ: f64 = 1.0;
/// Lines closer than so many bins are one.
const BINS: f64 = 2.0;
/// A component is a cause where it explains this share of what the strongest does, and this share of the line.
const SHARE: f64 = 0.5;
const LEAST: f64 = 0.1;
/// A component is looked at where it has this share of a line's amplitude.
const EXPLAINED: f64 = 0.3;
/// Demands that step or ramp have their lines below this, Hz; nothing else the bench does is so slow.
const SLOW_HZ: f64 = 2.0;
/// How near the frequency of a resonance is named.
const STRUCTURAL: f64 = 0.2;
const SENSOR: f64 = 0.1;

/// Bench, experiment and seed of a recording.
#[derive(Debug, Clone)]
pub(crate) struct Drawn {
    pub(crate) parameters: BenchParameters,
    pub(crate) plan: ExperimentPlan,
    pub(crate) seed: u64,
}

/// A recording, what is said of it, and the same without one of its causes each.
pub(crate) struct Labelled {
    drawn: Drawn,
    pub(crate) look: RecordingLines,
    whole: Experiment,
    /// Every channel at 1 kHz, where less folds.
    unfolded: Experiment,
    without: [Option<Experiment>; SOURCES],
    /// Crank angle every millisecond, rad, as it really is.
    angle: Vec<f64>,
}

/// Something that the bench does at a frequency: so many times the crank angle, and hertz beside.
#[derive(Debug, Clone)]
struct Component {
    cause: Cause,
    order: f64,
    frequency_hz: f64,
    needs: [bool; SOURCES],
}

/// Judgement of a line's name where its cause is known.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Judged {
    /// The true kind, the strongest of several.
    pub(crate) truth: &'static str,
    pub(crate) named: &'static str,
    pub(crate) is_right: bool,
    /// All that made the line: multiples of the crank angle and frequencies beside, Hz.
    pub(crate) causes: Vec<(&'static str, f64, f64)>,
}

/// Kinds of causes.
pub(crate) const KINDS: [&str; 11] = [
    "order",
    "folded order",
    "demanded",
    "hold image",
    "ripple sideband",
    "order sideband",
    "mains",
    "structural",
    "sensor",
    "undecided",
    "none",
];

fn kind(cause: &Cause) -> &'static str {
    match cause {
        Cause::Order { .. } => "order",
        Cause::FoldedOrder { .. } => "folded order",
        Cause::Demanded => "demanded",
        Cause::HoldImage { .. } => "hold image",
        Cause::RippleSideband { .. } => "ripple sideband",
        Cause::OrderSideband { .. } => "order sideband",
        Cause::Mains { .. } => "mains",
        Cause::StructuralResonance => "structural",
        Cause::SensorResonance => "sensor",
        Cause::Undecided { .. } => "undecided",
        Cause::BroadHump | Cause::Unknown => "none",
    }
}

impl Drawn {
    /// A bench and an experiment over the whole range of both.
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut within = |low: f64, high: f64| low + (high - low) * random.uniform();
        let mut parameters = match within(0.0, 10.0) as usize {
            0..3 => BenchParameters::torque_flange(),
            _ => BenchParameters::default(),
        };
        let cylinders = [2, 3, 4, 4, 4, 5, 6, 8][within(0.0, 8.0) as usize];
        let engine = &mut parameters.engine;
        engine.strokes = if within(0.0, 10.0) < 1.0 { 2 } else { 4 };
        engine.cylinder_factors = (0..cylinders).map(|_| within(0.9, 1.1)).collect();
        engine.cycle_variation = within(0.0, 0.03);
        engine.firing_harmonics.iter_mut().for_each(|h| h.relative_amplitude *= within(0.5, 1.5));
        let mechanics = &mut parameters.mechanics;
        mechanics.dyno_inertia_kg_m2 *= within(0.6, 1.6);
        mechanics.engine_inertia_kg_m2 *= within(0.6, 1.6);
        mechanics.shaft_stiffness_nm_per_rad *= within(0.5, 2.0);
        mechanics.shaft_damping_nm_s_per_rad *= within(0.5, 2.0);
        parameters.drive.ripple_hz = [100.0, 120.0][within(0.0, 2.0) as usize] * within(0.998, 1.002);
        parameters.drive.additive_ripple_nm = within(0.0, 2.0);
        parameters.drive.multiplicative_ripple = within(0.0, 0.06);
        let sensors = &mut parameters.sensors;
        sensors.gate_s = [1e-3, 1e-3, 2e-3, 4e-3][within(0.0, 4.0) as usize];
        sensors.dyno_eccentricity = within(0.0, 5e-4);
        sensors.engine_eccentricity = within(0.0, 5e-4);
        sensors.cell_resonance_hz = within(60.0, 90.0);
        sensors.cell_damping_ratio = within(0.05, 0.35);
        sensors.cell_noise_nm = within(0.0, 0.3);
        sensors.pulses = (within(0.0, 5.0) < 1.0).then(PulseParameters::default);
        let clocks = &mut parameters.clocks;
        clocks.torque_decimation = [1, 2, 4, 4, 5][within(0.0, 5.0) as usize];
        clocks.engine_speed_decimation = [1, 2, 4][within(0.0, 3.0) as usize];
        clocks.engine_speed_skew_s = within(-2e-3, 2e-3);
        clocks.torque_skew_s = within(-2e-3, 2e-3);
        clocks.start_offset_s = within(0.0, 3.0);
        parameters.controller.demand_hold_s = [5e-3, 1e-2, 1e-2, 2e-2][within(0.0, 4.0) as usize];
        let speed_rpm = 10.0 * within(60.0, 450.0).round();
        let duration_s = within(12.0, 24.0);
        // Held samples of a faster sine are those of a slower one.
        let highest_hz = f64::min(30.0, 0.4 / parameters.controller.demand_hold_s);
        // White noise is what shows a load cell's resonance.
        let mut plan = match within(0.0, 11.0) as usize {
            0 | 1 => ExperimentPlan::bs_t_nt(speed_rpm, duration_s),
            2 | 10 => ExperimentPlan::white_noise_t_tn(speed_rpm, duration_s),
            3 | 4 => sines(speed_rpm, duration_s, (0..1).map(|_| within(2.0, highest_hz)).collect()),
            5 => sines(speed_rpm, duration_s, (0..4).map(|_| within(2.0, highest_hz)).collect()),
            6 => ExperimentPlan::step_t_tn(speed_rpm, duration_s),
            7 => ExperimentPlan::ramp_n_nt(speed_rpm.min(3700.0), duration_s),
            8 => ExperimentPlan::unfired_n_nt(speed_rpm, duration_s),
            _ => ExperimentPlan::no_shaft_n_nt(speed_rpm, duration_s),
        };
        if plan.label.test == Test::Bs && within(0.0, 2.0) < 1.0 {
            plan.engine_torque_nm = Waveform::Constant { value: within(20.0, 60.0) };
        }
        Drawn { parameters, plan, seed }
    }

    /// The same at another speed.
    pub(crate) fn at_rpm(&self, speed_rpm: f64) -> Self {
        let mut other = self.clone();
        let by = speed_rpm * RPM_RAD_S;
        other.plan.speed_rad_s = match other.plan.speed_rad_s {
            Waveform::Constant { .. } => Waveform::Constant { value: by },
            Waveform::RandomBinary { low, high, clock_s } => {
                let half = 0.5 * (high - low);
                Waveform::RandomBinary { low: by - half, high: by + half, clock_s }
            }
            kept => kept,
        };
        other
    }

    /// Tells whether its speed stays about one value that can be chosen.
    pub(crate) fn has_one_speed(&self) -> bool {
        matches!(self.plan.speed_rad_s, Waveform::Constant { .. } | Waveform::RandomBinary { .. })
    }

    fn demand_role(&self) -> Role {
        match self.plan.label.mode {
            ControlMode::Tn => Role::DynoTorqueDemand,
            ControlMode::Nt => Role::DynoSpeedDemand,
        }
    }

    /// Tells whether a demand steps or ramps.
    fn is_slowly_driven(&self) -> bool {
        let is = |demand: &Waveform| matches!(demand, Waveform::Ramps { .. } | Waveform::Square { .. });
        is(&self.plan.speed_rad_s) || is(&self.plan.dyno_torque_nm)
    }

    /// Where the masses on the shaft resonate, without damping: two masses once, those of a dual-mass flywheel twice.
    fn structural_hz(&self) -> Vec<f64> {
        let mechanics = &self.parameters.mechanics;
        let (dyno, stiffness) = (mechanics.dyno_inertia_kg_m2, mechanics.shaft_stiffness_nm_per_rad);
        let hz = |squared: f64| squared.sqrt() / TAU;
        let Some(flywheel) = &mechanics.flywheel else {
            return vec![hz(stiffness / dyno + stiffness / mechanics.engine_inertia_kg_m2)];
        };
        let (middle, springs) = (flywheel.secondary_inertia_kg_m2, flywheel.stiffness_nm_per_rad);
        // ω⁴ − bω² + c = 0 of the chain of three.
        let engine = mechanics.engine_inertia_kg_m2 - middle;
        let b = stiffness / dyno + (stiffness + springs) / middle + springs / engine;
        let c = stiffness * springs * (dyno + middle + engine) / (dyno * middle * engine);
        let root = (0.25 * b * b - c).sqrt();
        vec![hz(0.5 * b - root), hz(0.5 * b + root)]
    }

    /// Where the load cell's gain is largest: below its natural frequency as it is damped.
    fn sensor_hz(&self) -> f64 {
        let sensors = &self.parameters.sensors;
        sensors.cell_resonance_hz * (1.0 - 2.0 * sensors.cell_damping_ratio.powi(2)).sqrt()
    }

    fn engine(&self) -> Engine {
        let engine = &self.parameters.engine;
        Engine { cylinders: engine.cylinder_factors.len() as u32, strokes: engine.strokes }
    }

    fn bench_file(&self) -> BenchFile {
        let Engine { cylinders, strokes } = self.engine();
        let roles: &[Role] = match self.parameters.variant {
            BenchVariant::LoadCell => &[Role::LoadCellTorque, Role::SystemShaftTorque],
            BenchVariant::TorqueFlange => &[Role::FlangeTorque],
        };
        let variant = match self.parameters.variant {
            BenchVariant::LoadCell => "load-cell",
            BenchVariant::TorqueFlange => "torque-flange",
        };
        let mut text = format!(
            "[bench]\nname = \"x\"\nvariant = \"{variant}\"\ncylinders = {cylinders}\nstrokes = {strokes}\n\
             dynamometer_inertia = {}\nengine_inertia = {}\n[channels]\n",
            self.parameters.mechanics.dyno_inertia_kg_m2, self.parameters.mechanics.engine_inertia_kg_m2
        );
        let of_any =
            [Role::DynoSpeed, Role::EngineSpeed, Role::DynoSpeedDemand, Role::DynoTorqueDemand, Role::AirGapTorque];
        for (role, name) in virtual_bench::CHANNELS {
            if of_any.contains(&role) || roles.contains(&role) {
                text += &format!("{} = \"{name}\"\n", role.key());
            }
        }
        text.parse().unwrap()
    }

    fn recorded(&self) -> Experiment {
        let recording = simulate(&self.parameters, &self.plan, self.seed).unwrap();
        prepare("run.mf4", &recording, &self.bench_file(), self.plan.label.clone()).unwrap().0
    }

    pub(crate) fn look(&self) -> RecordingLines {
        find_lines(&self.recorded(), &self.bench_file())
    }

    fn without(&self, source: usize) -> Option<Experiment> {
        let mut other = self.clone();
        let sensors = &mut other.parameters.sensors;
        match source {
            TURNING => {
                other.parameters.engine.firing_harmonics.clear();
                other.parameters.engine.cylinder_factors.fill(1.0);
                other.parameters.engine.cycle_variation = 0.0;
                (sensors.dyno_eccentricity, sensors.engine_eccentricity) = (0.0, 0.0);
                if let Some(pulses) = &mut sensors.pulses {
                    pulses.slit_error_rad = 0.0;
                }
            }
            RIPPLE => {
                let drive = &mut other.parameters.drive;
                (drive.additive_ripple_nm, drive.multiplicative_ripple) = (0.0, 0.0);
            }
            // Noise that is held differs with how long it is held.
            HOLD if self.sines_hz().is_empty() => return None,
            HOLD => other.parameters.controller.demand_hold_s = 1e-3,
            _ => match &mut other.plan.dyno_torque_nm {
                Waveform::SineLadder { amplitude, .. } if self.plan.label.test == Test::Sine => *amplitude = 0.0,
                _ => return None,
            },
        }
        Some(other.recorded())
    }

    fn unfolded(&self) -> Experiment {
        let mut other = self.clone();
        (other.parameters.clocks.torque_decimation, other.parameters.clocks.engine_speed_decimation) = (1, 1);
        other.recorded()
    }

    /// Crank angle every millisecond from the start of the recording; of the dynamometer where there is no shaft.
    fn angle(&self) -> Vec<f64> {
        let hidden = simulate_hidden(&self.parameters, &self.plan, self.seed, Numerics::default()).unwrap().hidden;
        let speed = if self.plan.has_shaft { hidden.engine_speed_rad_s } else { hidden.dyno_speed_rad_s };
        let mut angle = 0.0;
        let at = speed.iter().map(|w| {
            angle += w * hidden.sample_time_s;
            angle
        });
        at.collect()
    }

    fn sines_hz(&self) -> Vec<f64> {
        match &self.plan.dyno_torque_nm {
            Waveform::SineLadder { frequencies_hz, .. } if self.plan.label.test == Test::Sine => frequencies_hz.clone(),
            _ => Vec::new(),
        }
    }

    /// All that the bench does while one sine is demanded, or none.
    fn components(&self, sine_hz: Option<f64>) -> Vec<Component> {
        let firing = self.engine().firings_per_turn();
        let step = 2.0 / f64::from(self.engine().strokes);
        let orders: Vec<f64> = (1..=(HIGHEST_FIRING * firing / step) as i32).map(|k| step * f64::from(k)).collect();
        let ripple_hz = self.parameters.drive.ripple_hz;
        let held_hz = 1.0 / self.parameters.controller.demand_hold_s;
        let of = |cause: Cause, order: f64, frequency_hz: f64, needed: &[usize]| {
            let needs = std::array::from_fn(|source| needed.contains(&source));
            Component { cause, order, frequency_hz, needs }
        };
        let mut all = vec![of(Cause::Mains { multiple: 2, mains_hz: 0.5 * ripple_hz }, 0.0, ripple_hz, &[RIPPLE])];
        for order in orders {
            all.push(of(Cause::Order { order, is_firing: (order / firing).fract() == 0.0 }, order, 0.0, &[TURNING]));
            for side in [order, -order] {
                let cause = Cause::RippleSideband { of_hz: 0.0, ripple_hz };
                all.push(of(cause, side, ripple_hz, &[TURNING, RIPPLE]));
            }
            for side_hz in sine_hz.iter().flat_map(|hz| [-hz, *hz]) {
                all.push(of(Cause::OrderSideband { order, demanded_hz: 0.0 }, order, side_hz, &[TURNING, SINE]));
            }
        }
        if let Some(hz) = sine_hz {
            // Rounding and limits give a sine multiples.
            for multiple in 1..=9 {
                all.push(of(Cause::Demanded, 0.0, f64::from(multiple) * hz, &[SINE]));
                all.push(of(Cause::Demanded, 0.0, f64::from(multiple) * hz, &[SINE, HOLD]));
            }
            for side_hz in [-hz, hz] {
                let cause = Cause::RippleSideband { of_hz: hz, ripple_hz };
                all.push(of(cause, 0.0, ripple_hz + side_hz, &[RIPPLE, SINE]));
                for multiple in 1..=10 {
                    let image = Cause::HoldImage { of_hz: hz, held_hz };
                    all.push(of(image, 0.0, f64::from(multiple) * held_hz + side_hz, &[HOLD, SINE]));
                }
            }
        }
        all
    }
}

/// Sines one after another about a torque.
fn sines(speed_rpm: f64, duration_s: f64, frequencies_hz: Vec<f64>) -> ExperimentPlan {
    let mut plan = ExperimentPlan::sine_t_tn(speed_rpm, duration_s);
    let dwell_s = duration_s / frequencies_hz.len() as f64;
    plan.dyno_torque_nm = Waveform::SineLadder { mean: 45.0, amplitude: 8.0, frequencies_hz, dwell_s };
    plan
}

impl Labelled {
    pub(crate) fn new(drawn: Drawn) -> Self {
        let whole = drawn.recorded();
        Labelled {
            look: find_lines(&whole, &drawn.bench_file()),
            unfolded: drawn.unfolded(),
            without: std::array::from_fn(|source| drawn.without(source)),
            angle: drawn.angle(),
            whole,
            drawn,
        }
    }

    pub(crate) fn lines(&self) -> impl Iterator<Item = (&PartLines, &SignalLines, &Line)> {
        self.look.parts.iter().flat_map(|part| {
            part.signals.iter().flat_map(move |signal| signal.lines.iter().map(move |line| (part, signal, line)))
        })
    }

    /// Crank angle at an instant of the recording's clock.
    fn angle_at(&self, time_s: f64) -> f64 {
        let place = ((time_s - self.drawn.parameters.clocks.start_offset_s) / 1e-3).max(0.0);
        let below = (place as usize).min(self.angle.len() - 2);
        self.angle[below] + (place - below as f64) * (self.angle[below + 1] - self.angle[below])
    }

    fn turns_hz(&self, part: &PartLines) -> f64 {
        (self.angle_at(part.end_s) - self.angle_at(part.start_s)) / (TAU * (part.end_s - part.start_s))
    }

    /// How far the speed is spread in a part, Hz.
    fn spread_hz(&self, part: &PartLines) -> f64 {
        let offset_s = self.drawn.parameters.clocks.start_offset_s;
        let at = |time_s: f64| (((time_s - offset_s) / 1e-3).max(0.0) as usize).min(self.angle.len() - 1);
        let speeds: Vec<f64> =
            self.angle[at(part.start_s)..at(part.end_s)].windows(101).map(|w| (w[100] - w[0]) / (0.1 * TAU)).collect();
        let mean = speeds.iter().sum::<f64>() / speeds.len() as f64;
        (speeds.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / speeds.len() as f64).sqrt()
    }

    /// e^{−jφ} of a component at each sample of a part of a signal.
    fn behind(&self, signal: &Signal, of: &Component) -> Vec<c64> {
        let phase = |time_s: f64| of.order * self.angle_at(time_s) + TAU * of.frequency_hz * time_s;
        (0..signal.len()).map(|k| c64::cis(-phase(signal.time_s(k)))).collect()
    }

    fn part_of(experiment: &Experiment, part: &PartLines, role: Role) -> Signal {
        experiment.signal(role).unwrap().slice(part.start_s, part.end_s)
    }

    /// How much of a component is missed without each source, and how strong it is where less folds; none where it
    /// makes little of a line.
    fn score(&self, part: &PartLines, role: Role, of: &Component, amplitude: f64) -> Option<(f64, f64)> {
        let power = |x: &[c64]| x.iter().map(|x| x.norm_sqr()).sum::<f64>();
        let signal = Self::part_of(&self.whole, part, role);
        let behind = self.behind(&signal, of);
        let whole = about(&signal, &behind);
        if power(&whole).sqrt() < EXPLAINED * amplitude {
            return None;
        }
        let missed = |(source, without): (usize, &Experiment)| {
            let without = about(&Self::part_of(without, part, role), &behind);
            // A hold makes a sine late: what is left without it is as strong, at another phase.
            let difference = |(a, b): (&c64, &c64)| match source {
                HOLD => c64::new(a.norm() - b.norm(), 0.0),
                _ => a - b,
            };
            let apart: Vec<c64> = without.iter().zip(&whole).map(difference).collect();
            (power(&apart) / power(&whole)).sqrt().min(1.0)
        };
        let missed =
            self.without.iter().enumerate().map(|(source, without)| without.as_ref().map(|w| missed((source, w))));
        let (mut least, mut others) = (1.0_f64, 1.0);
        for (needed, missed) in of.needs.iter().zip(missed) {
            match (needed, missed) {
                (true, missed) => least = least.min(missed.unwrap_or(0.0)),
                (false, Some(missed)) => others *= 1.0 - missed,
                (false, None) => {}
            }
        }
        let unfolded = Self::part_of(&self.unfolded, part, role);
        Some((least * others, power(&about(&unfolded, &self.behind(&unfolded, of))).sqrt()))
    }

    /// The causes that made a line, the strongest first; none where nothing that is known did.
    fn causes(&self, part: &PartLines, signal: &SignalLines, line: &Line) -> Vec<Component> {
        let rate_hz = 1.0 / signal.sample_time_s;
        let (turns_hz, spread_hz) = (self.turns_hz(part), self.spread_hz(part));
        let bin_hz = 1.0 / (part.end_s - part.start_s);
        let sine_hz = part.demanded_hz.first().and_then(|hz| {
            let apart = |sine: &f64| (sine - hz).abs();
            self.drawn.sines_hz().into_iter().min_by(|a, b| apart(a).total_cmp(&apart(b)))
        });
        let components = self.drawn.components(sine_hz);
        let within = |reach_hz: f64| -> Vec<&Component> {
            let distance = |c: &&Component| {
                let hz = (c.order * turns_hz + c.frequency_hz).abs();
                (folded_hz(hz, rate_hz) - line.frequency_hz).abs() - 0.1 * c.order.abs() * spread_hz
            };
            components.iter().filter(|c| distance(c) < reach_hz).collect()
        };
        let scored = |near: Vec<&Component>| {
            let score = |c: &Component| Some((self.score(part, signal.role, c, line.amplitude)?, c.clone()));
            let scores: Vec<((f64, f64), Component)> = near.into_iter().filter_map(score).collect();
            let counts = scores.iter().filter(|(score, _)| score.0 > LEAST);
            let strongest = counts.map(|(score, _)| score.1).fold(f64::MIN_POSITIVE, f64::max);
            let mut scored: Vec<(f64, Component)> =
                scores.into_iter().map(|((share, strength), c)| (share * strength / strongest, c)).collect();
            scored.sort_by(|a, b| b.0.total_cmp(&a.0));
            let best = scored.first().map_or(0.0, |s| s.0);
            scored.retain(|s| s.0 > LEAST && s.0 >= SHARE * best);
            scored.into_iter().map(|s| s.1).collect::<Vec<_>>()
        };
        let close = scored(within(BINS * bin_hz));
        // What an order's changing strength makes beside it is of the order.
        if close.is_empty() { scored(within(MODULATED_HZ)) } else { close }
    }

    /// Tells whether a name says what a component is.
    fn names(&self, cause: &Cause, component: &Component, part: &PartLines) -> bool {
        let turns_hz = self.turns_hz(part);
        let bin_hz = 1.0 / (part.end_s - part.start_s);
        match (cause, &component.cause) {
            (Cause::Order { order, .. } | Cause::FoldedOrder { order, .. }, Cause::Order { order: truth, .. }) => {
                order == truth
            }
            (Cause::OrderSideband { order, .. }, Cause::OrderSideband { order: truth, .. }) => order == truth,
            (
                Cause::RippleSideband { of_hz, ripple_hz },
                Cause::RippleSideband { of_hz: truth_hz, ripple_hz: truth },
            ) => {
                let of = if component.order == 0.0 { *truth_hz } else { component.order.abs() * turns_hz };
                (of_hz - of).abs() < BINS * bin_hz && (ripple_hz / truth - 1.0).abs() < 0.01
            }
            (Cause::Mains { multiple, mains_hz }, Cause::Mains { .. }) => {
                (f64::from(*multiple) * mains_hz / component.frequency_hz - 1.0).abs() < 0.01
            }
            (Cause::HoldImage { of_hz, .. }, Cause::HoldImage { of_hz: truth_hz, .. }) => {
                (of_hz - truth_hz).abs() < BINS * bin_hz
            }
            (Cause::Demanded, Cause::Demanded) => true,
            _ => false,
        }
    }

    /// Tells whether all that a line may come from lies within its resolution.
    fn coincide(&self, between: &[Cause], part: &PartLines, signal: &SignalLines, line: &Line) -> bool {
        let rate_hz = 1.0 / signal.sample_time_s;
        let (turns_hz, spread_hz) = (self.turns_hz(part), self.spread_hz(part));
        let reach = |order: f64| MODULATED_HZ.min(BINS / (part.end_s - part.start_s)) + order * spread_hz;
        let is_there = |hz: f64, order: f64| (folded_hz(hz, rate_hz) - line.frequency_hz).abs() < reach(order);
        between.len() > 1
            && between.iter().all(|cause| match *cause {
                Cause::Order { order, .. } | Cause::FoldedOrder { order, .. } => is_there(order * turns_hz, order),
                Cause::OrderSideband { order, demanded_hz } => {
                    [-demanded_hz, demanded_hz].iter().any(|hz| is_there((order * turns_hz + hz).abs(), order))
                }
                Cause::Mains { multiple, mains_hz } => {
                    // The mains stray.
                    let hz = folded_hz(f64::from(multiple) * mains_hz, rate_hz);
                    (hz - line.frequency_hz).abs() < 4e-3 * f64::from(multiple) * mains_hz
                }
                Cause::RippleSideband { of_hz, ripple_hz } => [ripple_hz - of_hz, ripple_hz + of_hz]
                    .iter()
                    .any(|hz| (folded_hz(hz.abs(), rate_hz) - line.frequency_hz).abs() < 4e-3 * ripple_hz + reach(0.0)),
                Cause::HoldImage { of_hz, held_hz } => (1..=20)
                    .flat_map(|m| [f64::from(m) * held_hz - of_hz, f64::from(m) * held_hz + of_hz])
                    .any(|hz| is_there(hz.abs(), 0.0)),
                _ => false,
            })
    }

    pub(crate) fn judge(&self, part: &PartLines, signal: &SignalLines, line: &Line) -> Judged {
        let named = kind(&line.cause);
        let near = |hz: f64, share: f64| (line.frequency_hz / hz - 1.0).abs() < share;
        let is_structural = self.drawn.structural_hz().iter().any(|hz| near(*hz, STRUCTURAL));
        let is_sensor = near(self.drawn.sensor_hz(), SENSOR);
        if line.standard_error.is_none() {
            let truth = match line.cause {
                Cause::StructuralResonance if is_structural => "structural",
                Cause::SensorResonance if is_sensor => "sensor",
                _ if is_structural => "structural",
                _ if is_sensor => "sensor",
                _ => "none",
            };
            return Judged { truth, named, is_right: truth == named, causes: Vec::new() };
        }
        let demanded = || {
            let is_right = named == "demanded";
            Judged { truth: "demanded", named, is_right, causes: Vec::new() }
        };
        if self.drawn.is_slowly_driven() && line.frequency_hz < SLOW_HZ {
            return demanded();
        }
        let causes = self.causes(part, signal, line);
        if causes.is_empty() && signal.role == self.drawn.demand_role() {
            // What the experimenter sets is demanded, rounding included.
            return demanded();
        }
        let is_one = |cause: &Cause| causes.iter().any(|c| self.names(cause, c, part));
        let is_right = match &line.cause {
            Cause::Undecided { between, .. } => {
                between.iter().any(is_one) && self.coincide(between, part, signal, line)
            }
            Cause::Unknown => causes.is_empty(),
            cause => is_one(cause),
        };
        let is_folded = |c: &Component| c.order * self.turns_hz(part) > 0.5 / signal.sample_time_s;
        let truth = causes.first().map_or("none", |c| match c.cause {
            Cause::Order { .. } if is_folded(c) => "folded order",
            _ => kind(&c.cause),
        });
        let causes = causes.iter().map(|c| (kind(&c.cause), c.order, c.frequency_hz)).collect();
        Judged { truth, named, is_right, causes }
    }
}

/// A component's amplitude in a signal, bin by bin about its phase.
fn about(signal: &Signal, behind: &[c64]) -> Vec<c64> {
    let (mean, n) = (signal.mean().unwrap(), signal.len() as f64);
    let bins = -(BINS as i32)..=BINS as i32;
    let turns: Vec<c64> = bins.clone().map(|bin| c64::cis(-TAU * f64::from(bin) / n)).collect();
    let (mut turned, mut sums) = (vec![c64::ONE; turns.len()], vec![c64::ZERO; turns.len()]);
    for (k, (x, behind)) in signal.samples.iter().zip(behind).enumerate() {
        let window = 1.0 - (TAU * (k as f64 + 0.5) / n).cos();
        let term = behind * (2.0 * window / n * (x - mean));
        for ((sum, turned), turn) in sums.iter_mut().zip(&mut turned).zip(&turns) {
            *sum += term * *turned;
            *turned *= turn;
        }
    }
    sums
}

/// Where a frequency shows at a sample rate, Hz.
fn folded_hz(frequency_hz: f64, rate_hz: f64) -> f64 {
    let rest = frequency_hz.rem_euclid(rate_hz);
    rest.min(rate_hz - rest)
}
