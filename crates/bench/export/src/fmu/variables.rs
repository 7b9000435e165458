//! The variables of an FMU and their value references, as `instance.h` of the runtime has them.

use super::numbers::BenchNumbers;
use crate::numbers::Unit;

/// Role of a variable for an importer.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Role {
    /// The independent variable.
    Time,
    /// An input.
    Input,
    /// A parameter that is set before the start.
    Fixed,
    /// A parameter that may change in a run.
    Tunable,
    /// An output that moves all the time.
    Output,
    /// An output that changes at the controller's samples.
    Sampled,
    /// A continuous state.
    State,
    /// A continuous state that other models are connected to.
    OutputState,
    /// The derivative of the state with this reference.
    Derivative(u32),
}

/// Type and start value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// A real number: its unit, its start value, and the lowest value it may have.
    Real(FmiUnit, Option<f64>, Option<f64>),
    /// The control mode.
    ControlMode(u8),
    /// A whole number from 0 to this; it starts at 0.
    Integer(usize),
    /// Yes or no.
    Boolean,
}

/// A unit by its name and its exponents of kg, m, s and rad.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct FmiUnit {
    pub(super) name: &'static str,
    pub(super) exponents: [i32; 4],
}

/// One variable.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Variable {
    pub(super) name: String,
    pub(super) reference: u32,
    pub(super) description: String,
    pub(super) role: Role,
    pub(super) kind: Kind,
    /// How large it usually is, for solvers; none where that says nothing.
    pub(super) nominal: Option<f64>,
}

const TORQUE_RATE: FmiUnit = FmiUnit { name: "N.m/s", exponents: [1, 2, -3, 0] };
const ACCELERATION: FmiUnit = FmiUnit { name: "rad/s2", exponents: [0, 0, -2, 1] };
/// First references of parameters, initial values and states.
const PARAMETER: u32 = 10;
const INITIAL: u32 = 30;
const STATE: u32 = 60;
/// Usual torque of a bench whose model has no range, Nm.
const NOMINAL_NM: f64 = 100.0;
/// The input that a model of the engine gives.
pub(super) const ENGINE_TORQUE: &str = "engine_torque";
/// The state that it needs.
pub(super) const ENGINE_SIDE_SPEED: &str = "engine_side_speed";
/// Distance of a derivative's reference from that of its state.
const TO_DERIVATIVE: u32 = 10;

impl From<Unit> for FmiUnit {
    fn from(unit: Unit) -> Self {
        FmiUnit { name: unit.modelica(), exponents: unit.exponents() }
    }
}

impl Variable {
    /// Tells whether people read it in rpm. A parameter in rad/s is a bandwidth.
    pub(super) fn is_speed(&self) -> bool {
        matches!(self.kind, Kind::Real(unit, ..) if unit.name == "rad/s") && self.role != Role::Tunable
    }

    fn new(reference: u32, name: &str, role: Role, kind: Kind, description: &str) -> Self {
        Variable { name: name.to_owned(), reference, description: description.to_owned(), role, kind, nominal: None }
    }

    /// How large it usually is: as the model's range says, or as the parameter is.
    fn with_nominal(mut self, numbers: &BenchNumbers) -> Self {
        let Kind::Real(unit, start, _) = self.kind else { return self };
        let torque_nm = numbers.torque_range_nm.map_or(NOMINAL_NM, |(low, high)| low.abs().max(high.abs()));
        let stiffness = numbers.value("K");
        self.nominal = match (self.role, unit.name) {
            (Role::Fixed | Role::Tunable, _) if !(INITIAL..INITIAL + 10).contains(&self.reference) => {
                start.map(f64::abs)
            }
            (Role::Derivative(_) | Role::Time, _) => None,
            (_, "rad/s") if self.name.contains("difference") => None,
            (_, "rad/s") => Some(numbers.start_rad_s.abs()),
            (_, "N.m") => Some(torque_nm),
            (_, "rad") if self.name.starts_with("twist") && stiffness > 0.0 => Some(torque_nm / stiffness),
            _ => None,
        };
        self.nominal = self.nominal.filter(|nominal| nominal.is_finite() && *nominal > 0.0);
        self
    }

    /// Tells whether an importer learns its first value from the FMU.
    pub(super) fn is_calculated(&self) -> bool {
        matches!(self.role, Role::Output | Role::Sampled | Role::State | Role::OutputState | Role::Derivative(_))
    }

    /// Tells whether it is an output.
    pub(super) fn is_output(&self) -> bool {
        matches!(self.role, Role::Output | Role::Sampled | Role::OutputState)
    }

    /// Tells whether it is a parameter.
    pub(super) fn is_parameter(&self) -> bool {
        matches!(self.role, Role::Fixed | Role::Tunable)
    }
}

/// How large each continuous state usually is, in their order: 1 where the model description says nothing, as FMI has
/// it.
pub(super) fn nominals_of_states(numbers: &BenchNumbers) -> Vec<f64> {
    let is_state = |variable: &Variable| matches!(variable.role, Role::State | Role::OutputState);
    let nominal = |variable: Variable| variable.with_nominal(numbers).nominal.unwrap_or(1.0);
    states().into_iter().filter(is_state).map(nominal).collect()
}

/// All variables of an FMU, in the order of its model description.
pub(super) fn all(numbers: &BenchNumbers) -> Vec<Variable> {
    let time = Variable::new(0, "time", Role::Time, real(Unit::Time, None), "time");
    std::iter::once(time)
        .chain(inputs(numbers))
        .chain(parameters(numbers))
        .chain(initial_values(numbers))
        .chain(choices(numbers))
        .chain(outputs())
        .chain(states())
        .map(|variable| variable.with_nominal(numbers))
        .collect()
}

fn real(unit: impl Into<FmiUnit>, start: Option<f64>) -> Kind {
    Kind::Real(unit.into(), start, None)
}

fn inputs(numbers: &BenchNumbers) -> Vec<Variable> {
    let input = |reference, name, unit: FmiUnit, start, description: &str| {
        Variable::new(reference, name, Role::Input, real(unit, Some(start)), description)
    };
    let lead = numbers.demand_lead.as_ref().map_or_else(String::new, |words| format!("; {words}"));
    vec![
        input(
            1,
            "speed_demand",
            Unit::Speed.into(),
            numbers.start_rad_s,
            &format!("N_d*, in speed control; the controller samples it{lead}"),
        ),
        input(
            2,
            "torque_demand",
            Unit::Torque.into(),
            numbers.start_nm,
            "T_d*, in torque control; sampled as well; positive brakes",
        ),
        input(3, ENGINE_TORQUE, Unit::Torque.into(), numbers.start_nm, "T_e"),
        input(4, "engine_torque_rate", TORQUE_RATE, 0.0, "slope of T_e within the next step (Co-Simulation alone)"),
    ]
}

fn parameters(numbers: &BenchNumbers) -> Vec<Variable> {
    let lowest = |name: &str| match name {
        "K_p" | "K_i" | "k" | "k_a" | "tau_n" | "tau_f" => None,
        _ => Some(0.0),
    };
    let variable = |(reference, parameter): (u32, &super::numbers::RuntimeParameter)| {
        let role = if parameter.name == "T_s" { Role::Fixed } else { Role::Tunable };
        let kind = Kind::Real(parameter.unit.into(), Some(parameter.value), lowest(parameter.name));
        let none = match parameter.name {
            "a" => "; 0 for a delay alone",
            "T_limit" | "T_gate" => "; 0 for none",
            _ => "",
        };
        Variable::new(reference, parameter.name, role, kind, &format!("{}{none}", parameter.description))
    };
    (PARAMETER..).zip(&numbers.parameters).map(variable).collect()
}

fn initial_values(numbers: &BenchNumbers) -> Vec<Variable> {
    let values: [(&str, Unit, f64, &str); 6] = [
        ("initial_speed", Unit::Speed, numbers.start_rad_s, "speed of both sides at the start"),
        ("initial_torque", Unit::Torque, numbers.start_nm, "torque through the whole bench at the start"),
        ("initial_speed_difference", Unit::Speed, 0.0, "engine's speed less the dynamometer's at the start"),
        ("initial_twist_offset", Unit::Angle, 0.0, "twist at the start beyond initial_torque/K"),
        ("initial_air_gap_torque_offset", Unit::Torque, 0.0, "T_d at the start beyond initial_torque"),
        ("initial_integrator_offset", Unit::Torque, 0.0, "integrator at the start beyond what holds initial_torque"),
    ];
    let variable = |(reference, (name, unit, start, description)): (u32, (&str, Unit, f64, &str))| {
        Variable::new(reference, name, Role::Fixed, real(unit, Some(start)), description)
    };
    (INITIAL..).zip(values).map(variable).collect()
}

fn choices(numbers: &BenchNumbers) -> [Variable; 2] {
    let mode = Kind::ControlMode(if numbers.has_speed_control { 1 } else { 2 });
    let draw = Kind::Integer(numbers.draws.len());
    [
        Variable::new(40, "control_mode", Role::Fixed, mode, "control of the dynamometer: 1 speed (NT), 2 torque (TN)"),
        Variable::new(41, "draw", Role::Tunable, draw, "0 the estimate, k the k-th draw of its covariance"),
    ]
}

fn outputs() -> [Variable; 6] {
    let output = |reference, name, role, unit: Unit, description| {
        Variable::new(reference, name, role, real(unit, None), description)
    };
    [
        output(50, "dyno_speed", Role::Sampled, Unit::Speed, "N_d as the encoder shows it"),
        output(51, "engine_speed", Role::Sampled, Unit::Speed, "N_e as an encoder with the same gate shows it"),
        output(52, "air_gap_torque", Role::Output, Unit::Torque, "T_d; positive brakes the dynamometer"),
        output(53, "shaft_torque", Role::Output, Unit::Torque, "T_shaft"),
        output(54, "limited_torque_demand", Role::Sampled, Unit::Torque, "T_d* as it acts after the limit"),
        Variable::new(55, "valid", Role::Sampled, Kind::Boolean, "whether the model was validated at this N_d and T_d"),
    ]
}

/// Each state, and its derivative.
fn states() -> Vec<Variable> {
    let states: [(&str, Unit, FmiUnit, &str); 6] = [
        ("dyno_side_speed", Unit::Speed, ACCELERATION, "speed of the dynamometer itself"),
        (ENGINE_SIDE_SPEED, Unit::Speed, ACCELERATION, "speed of the engine itself, at its flange"),
        ("twist", Unit::Angle, Unit::Speed.into(), "twist of the shaft"),
        ("lagged_torque", Unit::Torque, TORQUE_RATE, "T_d, where the torque control has a lag"),
        ("dyno_angle", Unit::Angle, Unit::Speed.into(), "angle of the dynamometer, less whole multiples of 160 turns"),
        ("engine_angle", Unit::Angle, Unit::Speed.into(), "angle of the engine, less whole multiples of 160 turns"),
    ];
    let pair = |(reference, (name, unit, slope, description)): (u32, (&str, Unit, FmiUnit, &str))| {
        let role = if name == ENGINE_SIDE_SPEED { Role::OutputState } else { Role::State };
        let state = Variable::new(reference, name, role, real(unit, None), description);
        let name = format!("der({name})");
        let derivative = Role::Derivative(reference);
        let slope = Variable::new(reference + TO_DERIVATIVE, &name, derivative, real(slope, None), "its derivative");
        [state, slope]
    };
    (STATE..).zip(states).flat_map(pair).collect()
}
