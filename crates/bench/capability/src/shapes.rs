//! Shapes that tests of drivelines have, with parameters.

use std::ops::RangeInclusive;

use rig::experiment::catalogue::{CatalogueError, Parameter, Settings, parameter};
use rig::experiment::{
    ControlMode, DEMAND_HOLD_S, Excitation, ExperimentLabel, ExperimentPlan, Test, UPDATE_S, Waveform,
};
use units::RPM_RAD_S;

/// A shape by its name.
#[derive(Debug, Clone, Copy)]
pub struct Shape {
    /// Name on the command line.
    pub name: &'static str,
    /// Demand, in words.
    pub demands: &'static str,
    /// Its numbers.
    pub parameters: &'static [Parameter],
    excitation: Excitation,
    mode: ControlMode,
    course: fn(&Settings, f64) -> Point,
}

/// Speed, rpm, and torque, Nm.
type Point = (f64, f64);

const RPM: RangeInclusive<f64> = -20_000.0..=20_000.0;
const NM: RangeInclusive<f64> = -20_000.0..=20_000.0;
const SECONDS: RangeInclusive<f64> = 0.0..=1000.0;

const SPEED: Parameter = parameter("speed", "rpm", 1500.0, RPM, "speed at the beginning");
const TORQUE: Parameter = parameter("torque", "Nm", 50.0, NM, "torque at the beginning");
const START: Parameter = parameter("start", "s", 1.0, SECONDS, "when the change begins");
const RAMP: Parameter = parameter("ramp", "s", 0.15, SECONDS, "how long the change takes");
const DURATION: Parameter = parameter("duration", "s", 4.0, 0.1..=1000.0, "length of the test");

/// Every shape.
pub const ALL: [Shape; 9] = [
    Shape {
        name: "speed-step",
        demands: "speed demand jumps",
        parameters: &[SPEED, TORQUE, START, DURATION, parameter("height", "rpm", 50.0, RPM, "height of the step")],
        excitation: Excitation::Speed,
        mode: ControlMode::Nt,
        course: |s, t| (s.get("speed") + if t >= s.get("start") { s.get("height") } else { 0.0 }, s.get("torque")),
    },
    Shape {
        name: "torque-step",
        demands: "torque demand of the dynamometer jumps, engine in speed control",
        parameters: &[SPEED, TORQUE, START, DURATION, parameter("height", "Nm", 25.0, NM, "height of the step")],
        excitation: Excitation::Torque,
        mode: ControlMode::Tn,
        course: |s, t| (s.get("speed"), s.get("torque") + if t >= s.get("start") { s.get("height") } else { 0.0 }),
    },
    Shape {
        name: "tip-in",
        demands: "engine torque rises within a fraction of a second at constant speed",
        parameters: &[SPEED, TORQUE, START, RAMP, DURATION, parameter("to", "Nm", 150.0, NM, "torque at the end")],
        excitation: Excitation::Torque,
        mode: ControlMode::Nt,
        course: tip,
    },
    Shape {
        name: "tip-out",
        demands: "engine torque falls within a fraction of a second at constant speed",
        parameters: &[
            SPEED,
            Parameter { default: 150.0, ..TORQUE },
            START,
            RAMP,
            DURATION,
            parameter("to", "Nm", 0.0, NM, "torque at the end"),
        ],
        excitation: Excitation::Torque,
        mode: ControlMode::Nt,
        course: tip,
    },
    Shape {
        name: "gear-shift",
        demands: "speed jumps to that of another gear while the torque is taken away",
        parameters: &[
            Parameter { default: 3000.0, ..SPEED },
            Parameter { default: 100.0, ..TORQUE },
            START,
            Parameter { default: 0.3, ..RAMP },
            DURATION,
            parameter("to", "rpm", 2000.0, RPM, "speed after the shift"),
        ],
        excitation: Excitation::Speed,
        mode: ControlMode::Nt,
        course: |s, t| {
            let into = (t - s.get("start")) / s.get("ramp").max(1e-3);
            let share = into.clamp(0.0, 1.0);
            // The torque goes before the speed moves, and comes back after it.
            let taken = (1.0 - ((into - 0.5).abs() - 0.5).max(0.0) / 0.3).clamp(0.0, 1.0);
            (s.get("speed") + share * (s.get("to") - s.get("speed")), s.get("torque") * (1.0 - taken))
        },
    },
    Shape {
        name: "engine-start",
        demands: "the dynamometer cranks the engine up to a speed",
        parameters: &[
            Parameter { default: 100.0, ..SPEED },
            Parameter { default: -15.0, ..TORQUE },
            START,
            Parameter { default: 0.7, ..RAMP },
            DURATION,
            parameter("to", "rpm", 800.0, RPM, "speed at the end"),
        ],
        excitation: Excitation::Speed,
        mode: ControlMode::Nt,
        course: speed_ramp,
    },
    Shape {
        name: "coast-down",
        demands: "speed falls slowly, engine without load",
        parameters: &[
            Parameter { default: 3000.0, ..SPEED },
            Parameter { default: 0.0, ..TORQUE },
            START,
            Parameter { default: 20.0, ..RAMP },
            Parameter { default: 24.0, ..DURATION },
            parameter("to", "rpm", 800.0, RPM, "speed at the end"),
        ],
        excitation: Excitation::Speed,
        mode: ControlMode::Nt,
        course: speed_ramp,
    },
    Shape {
        name: "clutch-slip",
        demands: "slip falls to the one that is controlled, with a judder on it, while the clutch takes up torque",
        parameters: &[
            SPEED,
            Parameter { default: 10.0, ..TORQUE },
            START,
            Parameter { default: 0.8, ..RAMP },
            Parameter { default: 6.0, ..DURATION },
            parameter("to", "Nm", 80.0, NM, "torque at the end"),
            parameter("slip", "rpm", 150.0, RPM, "slip at the beginning"),
            parameter("hold", "rpm", 20.0, RPM, "slip at the end"),
            parameter("amplitude", "rpm", 4.0, RPM, "amplitude of the judder"),
            parameter("frequency", "Hz", 8.0, 0.01..=100.0, "frequency of the judder"),
        ],
        excitation: Excitation::Speed,
        mode: ControlMode::Nt,
        course: |s, t| {
            let (share, from, to) = (share(s, t), s.get("slip"), s.get("hold"));
            let judder = (std::f64::consts::TAU * s.get("frequency") * (t - s.get("start")).max(0.0)).sin();
            let slip = from + share * (to - from) + share * s.get("amplitude") * judder;
            (s.get("speed") + slip, s.get("torque") + share * (s.get("to") - s.get("torque")))
        },
    },
    Shape {
        name: "sine-sweep",
        demands: "sine of the torque demand with rising frequency, engine in speed control",
        parameters: &[
            SPEED,
            Parameter { default: 60.0, ..TORQUE },
            Parameter { default: 20.0, ..DURATION },
            parameter("amplitude", "Nm", 10.0, NM, "amplitude"),
            parameter("from", "Hz", 1.0, 0.01..=100.0, "first frequency"),
            parameter("to", "Hz", 20.0, 0.01..=100.0, "last frequency"),
        ],
        excitation: Excitation::Torque,
        mode: ControlMode::Tn,
        course: |s, t| {
            let (from, to, whole) = (s.get("from"), s.get("to"), s.get("duration"));
            // f = from (to/from)^(t/T), of which the phase is the integral.
            let growth = (to / from).ln() / whole;
            let turns = if growth.abs() < 1e-9 { from * t } else { from * ((growth * t).exp() - 1.0) / growth };
            (s.get("speed"), s.get("torque") + s.get("amplitude") * (std::f64::consts::TAU * turns).sin())
        },
    },
];

/// The shape of a name; letter case does not matter.
pub fn find(name: &str) -> Option<&'static Shape> {
    ALL.iter().find(|shape| shape.name.eq_ignore_ascii_case(name.trim()))
}

impl Shape {
    /// The plan with these numbers.
    ///
    /// # Errors
    /// A plan that cannot be.
    pub fn plan(&self, settings: &Settings) -> Result<ExperimentPlan, CatalogueError> {
        let duration_s = settings.get("duration");
        let label = ExperimentLabel::new(Test::Other(words(self.name)), self.excitation, self.mode);
        let base = ExperimentPlan::new(Test::FreeForm, self.excitation, self.mode, settings.get("speed"), duration_s);
        let sampled = |step_s: f64, of: &dyn Fn(Point) -> f64| Waveform::Sampled {
            sample_time_s: step_s,
            values: (0..(duration_s / step_s).ceil().max(1.0) as usize)
                .map(|k| of((self.course)(settings, k as f64 * step_s)))
                .collect(),
        };
        let torque = sampled(DEMAND_HOLD_S, &|point| point.1);
        let mut plan = ExperimentPlan {
            label,
            speed_rad_s: sampled(UPDATE_S, &|point| point.0 * RPM_RAD_S),
            is_motored: self.name == "engine-start",
            ..base
        };
        match self.mode {
            ControlMode::Nt => plan.engine_torque_nm = torque,
            ControlMode::Tn => plan.dyno_torque_nm = torque,
        }
        plan.check()?;
        Ok(plan)
    }
}

/// The name as a label writes it: `tip-in` is `TipIn`.
fn words(name: &str) -> String {
    let word = |word: &str| word[..1].to_uppercase() + &word[1..];
    name.split('-').map(word).collect()
}

fn share(settings: &Settings, time_s: f64) -> f64 {
    let ramp_s = settings.get("ramp");
    let into = time_s - settings.get("start");
    if ramp_s > 0.0 { (into / ramp_s).clamp(0.0, 1.0) } else { f64::from(into >= 0.0) }
}

fn tip(settings: &Settings, time_s: f64) -> Point {
    let (from, to) = (settings.get("torque"), settings.get("to"));
    (settings.get("speed"), from + share(settings, time_s) * (to - from))
}

fn speed_ramp(settings: &Settings, time_s: f64) -> Point {
    let (from, to) = (settings.get("speed"), settings.get("to"));
    (from + share(settings, time_s) * (to - from), settings.get("torque"))
}
