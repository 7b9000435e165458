//! How people write a quantity: symbol, name and unit. Everything inside is SI; this table is used where numbers leave
//! the program, in reports and in JSON.

use std::borrow::Cow;
use std::f64::consts::PI;
use std::fmt;

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use units::RPM_RAD_S;

use super::Quantity;

/// Symbol, name and units of a quantity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Notation {
    /// Symbol of the thesis, e.g. `K_p`.
    pub symbol: &'static str,
    /// Name in words, e.g. `proportional gain`.
    pub name: &'static str,
    /// The unit people read, e.g. `Nm/rpm`.
    pub unit: &'static str,
    /// The SI unit of the estimate, e.g. `Nm s/rad`.
    #[serde(skip)]
    pub si_unit: &'static str,
    /// The unit's number for one of SI.
    #[serde(skip)]
    pub per_si: f64,
}

/// A quantity that people read in its SI unit.
const fn si(symbol: &'static str, name: &'static str, unit: &'static str) -> Notation {
    Notation { symbol, name, unit, si_unit: unit, per_si: 1.0 }
}

/// A quantity over a speed or an acceleration, which people read with rpm.
const fn per_rpm(symbol: &'static str, name: &'static str, unit: &'static str, si_unit: &'static str) -> Notation {
    Notation { symbol, name, unit, si_unit, per_si: RPM_RAD_S }
}

/// A speed.
const fn rpm(symbol: &'static str, name: &'static str) -> Notation {
    Notation { symbol, name, unit: "rpm", si_unit: "rad/s", per_si: 1.0 / RPM_RAD_S }
}

impl Quantity {
    /// All of them, in the order of their definition.
    pub const ALL: [Quantity; 75] = [
        Quantity::ProportionalGain,
        Quantity::IntegralGain,
        Quantity::ControllerDelay,
        Quantity::ControllerZero,
        Quantity::IntegratorState,
        Quantity::DynoEncoderGate,
        Quantity::SpeedFeedForward,
        Quantity::AccelerationFeedForward,
        Quantity::FilterTime,
        Quantity::DerivativeGain,
        Quantity::SecondIntegralGain,
        Quantity::SpeedErrorOffset,
        Quantity::FeedForwardHysteresis,
        Quantity::FrictionCompensation,
        Quantity::PresentErrorGain,
        Quantity::PreviousErrorGain,
        Quantity::TorqueControlDelay,
        Quantity::TorqueControlBandwidth,
        Quantity::TorqueControlTotalDelay,
        Quantity::TorqueControlGain,
        Quantity::BlackBoxGain,
        Quantity::BlackBoxDelay,
        Quantity::DelayAgainstDemand,
        Quantity::DelayAgainstSpeedBend,
        Quantity::LoadCellDelay,
        Quantity::LoadCellFrequency,
        Quantity::LoadCellDampingRatio,
        Quantity::LoadCellTotalDelay,
        Quantity::TorqueOffset,
        Quantity::TorqueGainError,
        Quantity::LoadCellLateness,
        Quantity::TorqueDrift,
        Quantity::Stiffness,
        Quantity::Damping,
        Quantity::ShaftZero,
        Quantity::DynoInertia,
        Quantity::EngineInertia,
        Quantity::EngineSpeedSkew,
        Quantity::AirGapTorqueSkew,
        Quantity::TorqueSkew,
        Quantity::EncoderGates,
        Quantity::FrictionSlope,
        Quantity::FlywheelInertia,
        Quantity::FlywheelStiffness,
        Quantity::FlywheelDamping,
        Quantity::LossFactor,
        Quantity::SecondMassOverSpring,
        Quantity::SecondMass,
        Quantity::StiffnessWithTorque,
        Quantity::StiffnessWithTorqueSquared,
        Quantity::StiffnessNearZeroTorque,
        Quantity::StiffnessWithSpeed,
        Quantity::DampingWithTorque,
        Quantity::DampingWithTorqueSquared,
        Quantity::DampingNearZeroTorque,
        Quantity::DampingWithSpeed,
        Quantity::EngineProportionalGain,
        Quantity::EngineIntegralGain,
        Quantity::FrictionOffset,
        Quantity::CoulombFriction,
        Quantity::ViscousFriction,
        Quantity::QuadraticFriction,
        Quantity::CubicFriction,
        Quantity::FrictionOffsetOverInertia,
        Quantity::CoulombFrictionOverInertia,
        Quantity::ViscousFrictionOverInertia,
        Quantity::QuadraticFrictionOverInertia,
        Quantity::CubicFrictionOverInertia,
        Quantity::TorqueLateness,
        Quantity::ResonanceFrequency,
        Quantity::ResonanceGain,
        Quantity::ResonanceDampingRatio,
        Quantity::FiringResonanceSpeed,
        Quantity::Crossover,
        Quantity::PhaseMargin,
    ];

    /// How people write it.
    #[must_use]
    pub const fn notation(self) -> Notation {
        use Quantity as Q;
        match self {
            Q::ProportionalGain => per_rpm("K_p", "proportional gain", "Nm/rpm", "Nm s/rad"),
            Q::IntegralGain => per_rpm("K_i", "integral gain", "Nm/(rpm s)", "Nm/rad"),
            Q::ControllerDelay => si("τ", "delay of the controller", "s"),
            Q::ControllerZero => si("−K_i/K_p", "zero of (K_p s + K_i)/s", "rad/s"),
            Q::IntegratorState => si("I_0", "initial state of the integrator", "Nm"),
            Q::DynoEncoderGate => si("T_g", "gate of the speed encoder: the time over which it averages", "s"),
            Q::SpeedFeedForward => per_rpm("k", "feed-forward of speed", "Nm/rpm", "Nm s/rad"),
            Q::AccelerationFeedForward => per_rpm("k_a", "feed-forward of acceleration", "Nm/(rpm/s)", "Nm s²/rad"),
            Q::FilterTime => si("T_f", "time constant of a filter on N_d", "s"),
            Q::DerivativeGain => per_rpm("K_d", "derivative gain", "Nm/(rpm/s)", "Nm s²/rad"),
            Q::SecondIntegralGain => per_rpm("K_ii", "gain of a second integrator", "Nm/(rpm s²)", "Nm/(rad s)"),
            Q::SpeedErrorOffset => rpm("N_0", "offset in the speed error"),
            Q::FeedForwardHysteresis => si("h", "half the feed-forward's hysteresis, up less down", "Nm"),
            Q::FrictionCompensation => si("c", "friction compensation with the sign of dN_d*/dt", "Nm"),
            Q::PresentErrorGain => per_rpm("b_0", "on the speed error of this update", "Nm/rpm", "Nm s/rad"),
            Q::PreviousErrorGain => per_rpm("b_1", "on that of the update before", "Nm/rpm", "Nm s/rad"),

            Q::TorqueControlDelay => si("τ", "delay of the torque control", "s"),
            Q::TorqueControlBandwidth => si("a", "bandwidth of the torque control", "rad/s"),
            Q::TorqueControlTotalDelay => si("τ + 1/a", "total delay of the torque control", "s"),
            Q::TorqueControlGain => si("T_d,calc/T_d*", "gain of the torque control", "1"),
            Q::BlackBoxGain => si("gain at 10 Hz", "gain as the black box has it", "1"),
            Q::BlackBoxDelay => si("delay at 10 Hz", "delay as the black box has it", "s"),

            Q::DelayAgainstDemand => si("τ_total", "delay against T_d*", "s"),
            Q::DelayAgainstSpeedBend => si("τ_bend", "delay against the bend in N_d", "s"),
            Q::LoadCellDelay => si("τ_cell", "delay of the load cell", "s"),
            Q::LoadCellFrequency => si("ω_n", "natural frequency of the load cell", "rad/s"),
            Q::LoadCellDampingRatio => si("ζ", "damping ratio of the load cell", "1"),
            Q::LoadCellTotalDelay => si("τ_total", "total delay against T_d*", "s"),
            Q::TorqueOffset => si("o", "T_d,calc above T_d,meas, in the middle of the torques seen", "Nm"),
            Q::TorqueGainError => si("g", "error of the gain of T_d,calc", "1"),
            Q::LoadCellLateness => si("τ", "how late slow changes come out in T_d,meas", "s"),
            Q::TorqueDrift => si("d", "drift of T_d,calc against T_d,meas", "Nm/s"),

            Q::Stiffness => si("K", "stiffness", "Nm/rad"),
            Q::Damping => si("B", "damping", "Nm s/rad"),
            Q::ShaftZero => si("−K/B", "zero of (K + Bs)/s", "rad/s"),
            Q::DynoInertia => si("J_d", "inertia of the dynamometer", "kg m²"),
            Q::EngineInertia => si("J_e", "inertia of the engine", "kg m²"),
            Q::EngineSpeedSkew => si("δ_e", "skew of N_e against N_d (positive: later)", "s"),
            Q::AirGapTorqueSkew => si("δ_T", "skew of T_d,calc against N_d (positive: later)", "s"),
            Q::TorqueSkew => si("δ_T", "skew of T_d against N_d (positive: later)", "s"),
            Q::EncoderGates => si("T_g", "gate of the speed encoders: the time over which they average", "s"),
            Q::FrictionSlope => si("c_1", "slope of the dynamometer's friction over speed", "Nm s/rad"),
            Q::FlywheelInertia => si("J_2", "inertia between shaft and engine", "kg m²"),
            Q::FlywheelStiffness => si("K_2", "stiffness of the flywheel's spring", "Nm/rad"),
            Q::FlywheelDamping => si("B_2", "damping of the flywheel's spring", "Nm s/rad"),
            Q::LossFactor => si("η", "loss factor of the spring", "1"),
            Q::SecondMassOverSpring => si("J₂/K₂", "a mass between shaft and engine, over the spring behind it", "s²"),
            Q::SecondMass => si("J₂", "inertia between shaft and engine", "kg m²"),
            Q::StiffnessWithTorque => si("ΔK/K", "stiffness with torque, per 100 Nm", "1"),
            Q::StiffnessWithTorqueSquared => si("ΔK/K", "stiffness with the square of torque, per (100 Nm)²", "1"),
            Q::StiffnessNearZeroTorque => si("ΔK/K", "stiffness about zero torque", "1"),
            Q::StiffnessWithSpeed => si("ΔK/K", "stiffness with speed, per 1000 rpm", "1"),
            Q::DampingWithTorque => si("ΔB", "damping with torque, per 100 Nm", "Nm s/rad"),
            Q::DampingWithTorqueSquared => si("ΔB", "damping with torque squared, per (100 Nm)²", "Nm s/rad"),
            Q::DampingNearZeroTorque => si("ΔB", "damping about zero torque", "Nm s/rad"),
            Q::DampingWithSpeed => si("ΔB", "damping with speed, per 1000 rpm", "Nm s/rad"),
            Q::EngineProportionalGain => si("P", "proportional gain of the engine's speed control", "Nm s/rad"),
            Q::EngineIntegralGain => si("I", "integral gain of the engine's speed control", "Nm/rad"),

            Q::FrictionOffset => si("T_0", "offset of T_d, or of friction between directions", "Nm"),
            Q::CoulombFriction => si("c_0", "Coulomb friction", "Nm"),
            Q::ViscousFriction => si("c_1", "viscous friction", "Nm s/rad"),
            Q::QuadraticFriction => si("c_2", "quadratic friction", "Nm s²/rad²"),
            Q::CubicFriction => si("c_3", "cubic friction", "Nm s³/rad³"),
            Q::FrictionOffsetOverInertia => si("T_0/J", "offset over inertia", "rad/s²"),
            Q::CoulombFrictionOverInertia => si("c_0/J", "Coulomb friction over inertia", "rad/s²"),
            Q::ViscousFrictionOverInertia => si("c_1/J", "viscous friction over inertia", "1/s"),
            Q::QuadraticFrictionOverInertia => si("c_2/J", "quadratic friction over inertia", "1/rad"),
            Q::CubicFrictionOverInertia => si("c_3/J", "cubic friction over inertia", "s/rad²"),
            Q::TorqueLateness => si("δ_T", "how late the T_d used here is against N_d", "s"),

            Q::ResonanceFrequency => si("f_r", "resonance of T_d → T_shaft", "Hz"),
            Q::ResonanceGain => si("g_r", "gain at the resonance", "Nm/Nm"),
            Q::ResonanceDampingRatio => si("ζ", "damping ratio of the resonance", "1"),
            Q::FiringResonanceSpeed => rpm("N_r", "speed at which firing meets the resonance"),
            Q::Crossover => si("f_c", "crossover of the speed loop", "Hz"),
            Q::PhaseMargin => Notation {
                symbol: "φ_m",
                name: "phase margin of the speed loop",
                unit: "°",
                si_unit: "rad",
                per_si: 180.0 / PI,
            },
        }
    }

    /// Its symbol.
    #[must_use]
    pub const fn symbol(self) -> &'static str {
        self.notation().symbol
    }

    /// Name in words.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.notation().name
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}

/// A quantity as a document has it: its key, by which it is read, and what people read.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WrittenQuantity {
    key: Quantity,
    #[serde(flatten)]
    notation: Notation,
}

/// Serialises a quantity as key, symbol, name and unit.
///
/// # Errors
/// Those of the serialiser.
pub fn write_notation<S: Serializer>(quantity: &Quantity, serializer: S) -> Result<S::Ok, S::Error> {
    WrittenQuantity { key: *quantity, notation: quantity.notation() }.serialize(serializer)
}

/// Key, symbol and name of a quantity, as a document has them. Documents of earlier versions have no key.
#[derive(Deserialize)]
pub struct ReadNotation {
    key: Option<Quantity>,
    symbol: String,
    name: String,
}

impl ReadNotation {
    /// The quantity, or what is wrong.
    ///
    /// # Errors
    /// That no quantity has this symbol and name, or that the key is another one's.
    pub fn quantity(&self) -> Result<Quantity, String> {
        let unknown = || format!("`{}`, “{}”, is no quantity that is known here", self.symbol, self.name);
        let written = || Quantity::ALL.into_iter().find(|one| one.symbol() == self.symbol && one.name() == self.name);
        match self.key {
            Some(key) => with_symbol(key, &self.symbol),
            None => written().ok_or_else(unknown),
        }
    }
}

/// The quantity of a key, if the symbol beside the key is its own.
fn with_symbol(key: Quantity, symbol: &str) -> Result<Quantity, String> {
    let other = || format!("`{symbol}` is not the symbol of the {}, which is `{}`", key.name(), key.symbol());
    (key.symbol() == symbol).then_some(key).ok_or_else(other)
}

/// Reads what [`write_notation`] wrote.
///
/// # Errors
/// Those of the deserialiser, and that the quantity is unknown.
pub fn read_notation<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Quantity, D::Error> {
    ReadNotation::deserialize(deserializer)?.quantity().map_err(D::Error::custom)
}

/// A quantity as findings have it.
#[derive(Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(crate) struct Symbol<'a> {
    #[serde(alias = "quantity")]
    symbol: Cow<'a, str>,
    key: Option<Quantity>,
}

impl Symbol<'_> {
    /// The quantity; one without a key is known by its symbol, unless several have that.
    fn quantity(&self) -> Result<Quantity, String> {
        if let Some(key) = self.key {
            return with_symbol(key, &self.symbol);
        }
        let mut all = Quantity::ALL.into_iter().filter(|quantity| quantity.symbol() == self.symbol);
        match (all.next(), all.next()) {
            (Some(only), None) => Ok(only),
            (Some(_), Some(_)) => Err(format!("several quantities have the symbol `{}`", self.symbol)),
            (None, _) => Err(format!("`{}` is the symbol of no quantity that is known here", self.symbol)),
        }
    }
}

/// Serialises a quantity as `symbol` and `key`; the symbol alone may be that of several quantities.
///
/// # Errors
/// Those of the serialiser.
pub fn write_symbol<S: Serializer>(quantity: &Quantity, serializer: S) -> Result<S::Ok, S::Error> {
    Symbol { symbol: quantity.symbol().into(), key: Some(*quantity) }.serialize(serializer)
}

/// The same where the symbol has another name.
#[derive(Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(crate) struct SymbolAsQuantity {
    quantity: &'static str,
    key: Quantity,
}

/// Serialises a quantity as `quantity`, which is its symbol, and `key`.
///
/// # Errors
/// Those of the serialiser.
pub fn write_quantity<S: Serializer>(quantity: &Quantity, serializer: S) -> Result<S::Ok, S::Error> {
    SymbolAsQuantity { quantity: quantity.symbol(), key: *quantity }.serialize(serializer)
}

/// Reads what [`write_symbol`] and [`write_quantity`] wrote.
///
/// # Errors
/// Those of the deserialiser, and that the quantity is unknown or one of several.
pub fn read_symbol<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Quantity, D::Error> {
    Symbol::deserialize(deserializer)?.quantity().map_err(D::Error::custom)
}
