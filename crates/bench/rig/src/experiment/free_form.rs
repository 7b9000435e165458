//! Plans from demands of one's own: a recording with a channel for each demand.

use recording::names::likely_meant;
use recording::{Channel, Recording};
use signal::SignalError;
use units::{self, Quantity, RPM_RAD_S, UnitError};

use super::catalogue::{CatalogueError, Parameter, Settings};
use super::{
    ControlMode, DEMAND_HOLD_S, DemandKind, Excitation, ExperimentLabel, ExperimentPlan, PlanError, Test, TorqueTarget,
    UPDATE_S, Waveform,
};

/// Stamps closer than this count as one instant, s.
const SAME_INSTANT_S: f64 = 1e-6;
/// Steps of a raster that differ by less than this part are equal.
const SAME_STEP: f64 = 1e-3;
/// Longest experiment, s.
const LONGEST_S: f64 = 1e4;

/// Parameters that can be set beside the demands themselves.
pub const PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "speed",
        unit: "rpm",
        default: 1200.0,
        lowest: -20_000.0,
        highest: 20_000.0,
        meaning: "speed demanded where the file holds no speed",
    },
    Parameter {
        name: "duration",
        unit: "s",
        default: 0.0,
        lowest: 0.0,
        highest: LONGEST_S,
        meaning: "length of the recording; 0: as long as the demands",
    },
    Parameter {
        name: "settling",
        unit: "s",
        default: 2.0,
        lowest: 0.0,
        highest: 1000.0,
        meaning: "time at the first demands before the recording starts",
    },
    Parameter {
        name: "motored",
        unit: "",
        default: 0.0,
        lowest: 0.0,
        highest: 1.0,
        meaning: "1: the engine turns without fuel; 0: as the file's name says (Unfired)",
    },
];

/// A plan, and what of the recording is no part of it.
#[derive(Debug, Clone, PartialEq)]
pub struct FreeForm {
    /// The plan.
    pub plan: ExperimentPlan,
    /// Channels that are no demand.
    pub ignored: Vec<String>,
}

/// Why a recording gives no plan.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FreeFormError {
    /// No channel is a demand.
    #[error(
        "no column is a demand{}; the names of demands are {}",
        .closest.as_ref().map_or(String::new(), |(found, meant)| format!(": `{found}` may be meant as `{meant}`")),
        names()
    )]
    NoDemand {
        /// A channel, and the demand it was probably meant as.
        closest: Option<(String, String)>,
    },
    /// Demands of both control modes.
    #[error(
        "`{one}` and `{other}` exclude each other: a dynamometer controls either its speed (NT) or its torque (TN); leave \
         one of them out"
    )]
    Contradiction {
        /// One demand.
        one: &'static str,
        /// The other.
        other: &'static str,
    },
    /// The file's name says another control mode than its demands.
    #[error(
        "the file's name says {label}, but its demands are those of {mode}; rename the file, or change the columns"
    )]
    OtherMode {
        /// The label in the name.
        label: ExperimentLabel,
        /// NT or TN.
        mode: &'static str,
    },
    /// A demand that the mode needs is missing.
    #[error("a demand is missing: add a column `{name} [{unit}]`{or}")]
    Missing {
        /// Its name.
        name: &'static str,
        /// Its unit.
        unit: &'static str,
        /// Alternative that would do.
        or: &'static str,
    },
    /// Two channels have the name of one demand.
    #[error("the column `{name}` is there twice; leave one of them out")]
    Twice {
        /// The name.
        name: &'static str,
    },
    /// A unit that does not fit.
    #[error("`{name}`: {source}")]
    Unit {
        /// The demand.
        name: &'static str,
        /// Why not.
        source: UnitError,
    },
    /// A value that is no number.
    #[error("`{name}` has no value at {time_s} s; fill in the cell, or delete the row")]
    NoValue {
        /// The demand.
        name: &'static str,
        /// When.
        time_s: f64,
    },
    /// Time that runs backwards, or is no number.
    #[error("the time of `{name}` is {time_s} s after {before_s} s; time must not run backwards")]
    Backwards {
        /// The demand.
        name: &'static str,
        /// The stamp.
        time_s: f64,
        /// The one before.
        before_s: f64,
    },
    /// A value outside what the demand can be.
    #[error("`{name}` is {value} {unit} at {time_s} s, outside {lowest} … {highest} {unit}")]
    OutOfRange {
        /// The demand.
        name: &'static str,
        /// The value.
        value: f64,
        /// The unit.
        unit: &'static str,
        /// When.
        time_s: f64,
        /// Smallest possible.
        lowest: f64,
        /// Largest possible.
        highest: f64,
    },
    /// Demands without a length.
    #[error("the demands have a single instant; give the length with --duration")]
    NoLength,
    /// Numbers that cannot be.
    #[error(transparent)]
    Settings(#[from] CatalogueError),
    /// A signal that cannot be.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// A plan that cannot be.
    #[error(transparent)]
    Plan(#[from] PlanError),
}

fn names() -> String {
    DemandKind::ALL.map(DemandKind::name).join(", ")
}

/// The plan of a recording whose channels are named as demand files name them, see [`DemandKind::name`].
///
/// Speeds run straight between their stamps and are taken every millisecond; all others are held until their next stamp
/// and taken every 10 ms, as an automation system does. Before its first stamp a demand has its first value, after the
/// last one its last. Time counts from the first stamp. Which controls what follows from the demands:
/// `dyno_speed_demand` means NT, a torque of the dynamometer TN. A label in `file`, the recording's name, is kept, and
/// says whether the engine is motored (`Unfired`) and the shaft off (`NoShaft`); without one the test is called
/// `FreeForm`.
///
/// # Errors
/// [`FreeFormError`], each with its remedy.
pub fn plan(file: &str, recording: &Recording, settings: &Settings) -> Result<FreeForm, FreeFormError> {
    let found = Found::of(recording)?;
    let stated: Option<ExperimentLabel> = file.rsplit(['/', '\\']).next().unwrap_or(file).parse().ok();
    let mode = found.mode()?;
    if let Some(label) = stated.as_ref().filter(|label| label.mode != mode) {
        let mode = if mode == ControlMode::Nt { "NT" } else { "TN" };
        return Err(FreeFormError::OtherMode { label: label.clone(), mode });
    }
    let label = stated.unwrap_or_else(|| found.label(mode));
    let (start_s, end_s) = found.span();
    let asked_s = settings.get("duration");
    let duration_s = if asked_s > 0.0 { asked_s } else { end_s - start_s };
    if duration_s < UPDATE_S {
        return Err(FreeFormError::NoLength);
    }
    let base = ExperimentPlan::new(label.test.clone(), label.excitation, mode, settings.get("speed"), duration_s);
    base.check()?;
    let has_shaft = !label.is_without_shaft();
    let is_motored = settings.get("motored") > 0.5 || label.test == Test::Unfired;
    let waveform = |kind: DemandKind| found.demand(kind).map(|demand| demand.waveform(start_s, duration_s));
    let torque_target = match found.demand(DemandKind::ShaftTorque) {
        Some(_) => TorqueTarget::Shaft,
        None => TorqueTarget::AirGap,
    };
    found.check_complete(mode, has_shaft && !is_motored, settings.is_given("speed"))?;
    let plan = ExperimentPlan {
        speed_rad_s: waveform(DemandKind::DynoSpeed)
            .or_else(|| waveform(DemandKind::EngineSpeed))
            .unwrap_or(Waveform::Constant { value: settings.get("speed") * RPM_RAD_S }),
        dyno_torque_nm: waveform(DemandKind::DynoTorque)
            .or_else(|| waveform(DemandKind::ShaftTorque))
            .unwrap_or(base.dyno_torque_nm),
        engine_torque_nm: waveform(DemandKind::EngineTorque).unwrap_or(base.engine_torque_nm),
        throttle: waveform(DemandKind::Throttle),
        ignition_efficiency: waveform(DemandKind::IgnitionEfficiency).unwrap_or(base.ignition_efficiency),
        settling_s: settings.get("settling"),
        torque_target,
        is_motored,
        has_shaft,
        ..base
    };
    plan.check()?;
    Ok(FreeForm { plan, ignored: found.ignored })
}

/// A demand with its stamps.
struct Given<'a> {
    kind: DemandKind,
    time_s: &'a [f64],
    /// SI.
    values: Vec<f64>,
}

struct Found<'a> {
    demands: Vec<Given<'a>>,
    ignored: Vec<String>,
}

impl<'a> Found<'a> {
    fn of(recording: &'a Recording) -> Result<Self, FreeFormError> {
        let mut found = Found { demands: Vec::new(), ignored: Vec::new() };
        for channel in &recording.channels {
            let name = channel.name.trim();
            match DemandKind::ALL.into_iter().find(|kind| kind.name().eq_ignore_ascii_case(name)) {
                None => found.ignored.push(channel.name.clone()),
                Some(kind) if found.demand(kind).is_some() => {
                    return Err(FreeFormError::Twice { name: kind.name() });
                }
                Some(kind) => found.demands.push(given(kind, channel, recording)?),
            }
        }
        if !found.demands.is_empty() {
            return Ok(found);
        }
        let meant = |name: &String| {
            likely_meant(name, DemandKind::ALL.map(DemandKind::name).into_iter()).map(|meant| (name.clone(), meant))
        };
        Err(FreeFormError::NoDemand { closest: found.ignored.iter().find_map(meant) })
    }

    fn demand(&self, kind: DemandKind) -> Option<&Given<'a>> {
        self.demands.iter().find(|given| given.kind == kind)
    }

    fn mode(&self) -> Result<ControlMode, FreeFormError> {
        use DemandKind::{DynoSpeed, DynoTorque, EngineSpeed, EngineTorque, ShaftTorque, Throttle};
        let first = |kinds: &[DemandKind]| kinds.iter().copied().find(|kind| self.demand(*kind).is_some());
        let nt = first(&[DynoSpeed, EngineTorque, Throttle]);
        let tn = first(&[DynoTorque, ShaftTorque, EngineSpeed]);
        let excluded =
            [(nt, tn), (first(&[DynoTorque]), first(&[ShaftTorque])), (first(&[EngineTorque]), first(&[Throttle]))];
        if let Some((one, other)) = excluded.into_iter().find_map(|(one, other)| one.zip(other)) {
            return Err(FreeFormError::Contradiction { one: one.name(), other: other.name() });
        }
        Ok(if tn.is_some() { ControlMode::Tn } else { ControlMode::Nt })
    }

    fn check_complete(&self, mode: ControlMode, is_fired: bool, speed_given: bool) -> Result<(), FreeFormError> {
        let missing = |kind: DemandKind, or| Err(FreeFormError::Missing { name: kind.name(), unit: kind.unit(), or });
        let has = |kind| self.demand(kind).is_some();
        let speed = if mode == ControlMode::Nt { DemandKind::DynoSpeed } else { DemandKind::EngineSpeed };
        if !has(speed) && !speed_given {
            return missing(speed, ", or give a constant one with --speed");
        }
        match mode {
            ControlMode::Tn if !has(DemandKind::DynoTorque) && !has(DemandKind::ShaftTorque) => {
                missing(DemandKind::DynoTorque, "")
            }
            ControlMode::Nt if is_fired && !has(DemandKind::EngineTorque) && !has(DemandKind::Throttle) => missing(
                DemandKind::EngineTorque,
                ", or `throttle_demand [%]`; a motored engine is said with --set motored=1",
            ),
            _ => Ok(()),
        }
    }

    /// A label for demands without one: what changes is what is excited.
    fn label(&self, mode: ControlMode) -> ExperimentLabel {
        let changes = |given: &&Given<'_>| given.values.windows(2).any(|pair| pair[0] != pair[1]);
        let torque = self.demands.iter().filter(changes).any(|given| !given.kind.is_speed());
        let excitation = if torque { Excitation::Torque } else { Excitation::Speed };
        ExperimentLabel { test: Test::FreeForm, excitation, mode }
    }

    /// From the first stamp to the end of the last: one step of the fastest raster after it.
    fn span(&self) -> (f64, f64) {
        let ends = |given: &Given<'_>| given.time_s.first().copied().zip(given.time_s.last().copied());
        let start_s = self.demands.iter().filter_map(ends).map(|(first, _)| first).fold(f64::INFINITY, f64::min);
        let last_s = self.demands.iter().filter_map(ends).map(|(_, last)| last).fold(f64::NEG_INFINITY, f64::max);
        let steps = self.demands.iter().filter_map(Given::uniform_step_s);
        let step_s = steps.fold(f64::INFINITY, f64::min);
        (start_s, last_s + if step_s.is_finite() { step_s } else { 0.0 })
    }
}

impl Given<'_> {
    /// The time from stamp to stamp where it is always the same.
    fn uniform_step_s(&self) -> Option<f64> {
        let (first, last, steps) = (self.time_s.first()?, self.time_s.last()?, self.time_s.len() - 1);
        let step_s = (last - first) / steps.max(1) as f64;
        let same = |pair: &[f64]| (pair[1] - pair[0] - step_s).abs() <= SAME_STEP * step_s;
        (steps > 0 && step_s > 0.0 && self.time_s.windows(2).all(same)).then_some(step_s)
    }

    /// The demand on its clock, from `start_s` on.
    fn waveform(&self, start_s: f64, duration_s: f64) -> Waveform {
        let clock_s = if self.kind.is_speed() { UPDATE_S } else { DEMAND_HOLD_S };
        let ticks = (duration_s / clock_s - 1e-9).ceil().max(1.0) as usize;
        let mut place = 0;
        let mut at = |tick: usize| {
            let time_s = tick as f64 * clock_s;
            while self.time_s.get(place + 1).is_some_and(|next| next - start_s <= time_s + SAME_INSTANT_S) {
                place += 1;
            }
            self.between(place, time_s + start_s)
        };
        Waveform::Sampled { sample_time_s: clock_s, values: (0..ticks).map(&mut at).collect() }
    }

    /// The value at a time from stamp `place` on.
    fn between(&self, place: usize, time_s: f64) -> f64 {
        let value = self.values[place];
        let next = self.values.get(place + 1).zip(self.time_s.get(place + 1));
        let Some((next, next_s)) = next.filter(|_| self.kind.is_speed()) else { return value };
        let share = ((time_s - self.time_s[place]) / (next_s - self.time_s[place])).clamp(0.0, 1.0);
        // Stamps that count as one instant are no rounding of each other.
        let is_here = time_s - self.time_s[place] <= SAME_INSTANT_S || !share.is_finite();
        if is_here { value } else { value + share * (next - value) }
    }
}

/// A channel as a demand, checked and in SI.
fn given<'a>(kind: DemandKind, channel: &Channel, recording: &'a Recording) -> Result<Given<'a>, FreeFormError> {
    let name = kind.name();
    let time_s = recording.time_s(channel).unwrap_or_default();
    if time_s.is_empty() || channel.samples.len() != time_s.len() {
        return Err(FreeFormError::NoValue { name, time_s: 0.0 });
    }
    let mut before_s = f64::NEG_INFINITY;
    for time in time_s {
        if !time.is_finite() || *time < before_s {
            return Err(FreeFormError::Backwards { name, time_s: *time, before_s });
        }
        before_s = *time;
    }
    let (quantity, (lowest, highest)) = match kind {
        kind if kind.is_speed() => (Quantity::AngularSpeed, (-3000.0, 3000.0)),
        DemandKind::Throttle | DemandKind::IgnitionEfficiency => (Quantity::Ratio, (0.0, 1.0)),
        _ => (Quantity::Torque, (-20_000.0, 20_000.0)),
    };
    let written = if channel.unit.trim().is_empty() { kind.unit() } else { &channel.unit };
    let unit = units::parse_unit_of(written, quantity).map_err(|source| FreeFormError::Unit { name, source })?;
    let mut values = Vec::with_capacity(time_s.len());
    for (value, time) in channel.samples.iter().zip(time_s) {
        let si = unit.to_si(*value);
        if !value.is_finite() {
            return Err(FreeFormError::NoValue { name, time_s: *time });
        }
        if !(lowest..=highest).contains(&si) {
            let edge = |si: f64| si / kind.si_per_unit();
            let (value, unit) = (edge(si), kind.unit());
            let (lowest, highest) = (edge(lowest).round(), edge(highest).round());
            return Err(FreeFormError::OutOfRange { name, value, unit, time_s: *time, lowest, highest });
        }
        values.push(si);
    }
    Ok(Given { kind, time_s, values })
}
