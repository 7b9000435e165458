//! Quantities that can be estimated, each under one name.

mod notation;

use serde::{Deserialize, Serialize};

pub use notation::{
    Notation, ReadNotation, WrittenQuantity, read_notation, read_symbol, write_notation, write_quantity, write_symbol,
};
#[cfg(feature = "schema")]
pub(crate) use notation::{Symbol, SymbolAsQuantity};

/// A quantity that is estimated or computed from estimates, in SI.
///
/// [`Quantity::notation`] has its symbol and the unit people read it in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// K_p of the speed controller, Nm s/rad.
    ProportionalGain,
    /// K_i of the speed controller, Nm/rad.
    IntegralGain,
    /// τ of the speed controller, s.
    ControllerDelay,
    /// The zero −K_i/K_p of PI, rad/s.
    ControllerZero,
    /// The integrator's state at the start, Nm.
    IntegratorState,
    /// Time over which the encoder of N_d averages, s.
    DynoEncoderGate,
    /// k, from N_d* to T_d*, Nm s/rad.
    SpeedFeedForward,
    /// k_a, from dN_d*/dt to T_d*, Nm s²/rad.
    AccelerationFeedForward,
    /// T_f of a filter on N_d, s.
    FilterTime,
    /// K_d of the speed controller, Nm s²/rad.
    DerivativeGain,
    /// Gain of a second integrator, Nm/(rad s).
    SecondIntegralGain,
    /// An offset in the speed error, rad/s.
    SpeedErrorOffset,
    /// Half the difference of the feed-forward between speeds reached from below and from above, Nm.
    FeedForwardHysteresis,
    /// A torque with the sign of dN_d*/dt, Nm.
    FrictionCompensation,
    /// b_0 of the discrete PI, Nm s/rad.
    PresentErrorGain,
    /// b_1 of the discrete PI, Nm s/rad.
    PreviousErrorGain,

    /// τ of the torque control, s.
    TorqueControlDelay,
    /// a of the torque control, rad/s.
    TorqueControlBandwidth,
    /// τ + 1/a of the torque control, s.
    TorqueControlTotalDelay,
    /// Gain from T_d* to T_d,calc, 1.
    TorqueControlGain,
    /// Gain of a black-box model of the torque control at 10 Hz, 1.
    BlackBoxGain,
    /// Delay of a black-box model of the torque control at 10 Hz, s.
    BlackBoxDelay,

    /// Delay of a torque signal against T_d*, s.
    DelayAgainstDemand,
    /// Delay of a torque signal against the bend in N_d, s.
    DelayAgainstSpeedBend,
    /// Delay of the load cell alone, s.
    LoadCellDelay,
    /// Natural frequency of the load cell, rad/s.
    LoadCellFrequency,
    /// Damping ratio of the load cell, 1.
    LoadCellDampingRatio,
    /// Delay of the load cell with its dynamics, against T_d*, s.
    LoadCellTotalDelay,
    /// T_d,calc less T_d,meas in the middle of the torques seen, Nm.
    TorqueOffset,
    /// Error of the gain of T_d,calc against T_d,meas, 1.
    TorqueGainError,
    /// How late slow changes appear in T_d,meas, s.
    LoadCellLateness,
    /// Drift of T_d,calc against T_d,meas, Nm/s.
    TorqueDrift,

    /// K of the shaft, Nm/rad.
    Stiffness,
    /// B of the shaft, Nm s/rad.
    Damping,
    /// The zero −K/B of the shaft, rad/s.
    ShaftZero,
    /// J_d, kg m².
    DynoInertia,
    /// J_e, kg m².
    EngineInertia,
    /// δ_e: how late N_e is against N_d, s.
    EngineSpeedSkew,
    /// δ_T: how late T_d,calc is against N_d, s.
    AirGapTorqueSkew,
    /// δ_T: how late T_d is against N_d, s.
    TorqueSkew,
    /// Time over which both encoders average, s.
    EncoderGates,
    /// Slope of the dynamometer's friction over speed, Nm s/rad.
    FrictionSlope,
    /// J_2 between shaft and engine, kg m².
    FlywheelInertia,
    /// K_2 of a dual-mass flywheel, Nm/rad.
    FlywheelStiffness,
    /// B_2 of a dual-mass flywheel, Nm s/rad.
    FlywheelDamping,
    /// Loss factor of the shaft, 1.
    LossFactor,
    /// J₂/K₂ of a mass behind a spring, s².
    SecondMassOverSpring,
    /// J₂ as one term beside the shaft, kg m².
    SecondMass,
    /// ΔK/K per 100 Nm, 1.
    StiffnessWithTorque,
    /// ΔK/K per (100 Nm)², 1.
    StiffnessWithTorqueSquared,
    /// ΔK/K about zero torque, 1.
    StiffnessNearZeroTorque,
    /// ΔK/K per 1000 rpm, 1.
    StiffnessWithSpeed,
    /// ΔB per 100 Nm, Nm s/rad.
    DampingWithTorque,
    /// ΔB per (100 Nm)², Nm s/rad.
    DampingWithTorqueSquared,
    /// ΔB about zero torque, Nm s/rad.
    DampingNearZeroTorque,
    /// ΔB per 1000 rpm, Nm s/rad.
    DampingWithSpeed,
    /// P of the engine's speed control, Nm s/rad.
    EngineProportionalGain,
    /// I of the engine's speed control, Nm/rad.
    EngineIntegralGain,

    /// T_0 of the friction, Nm.
    FrictionOffset,
    /// c_0 of the friction, Nm.
    CoulombFriction,
    /// c_1 of the friction, Nm s/rad.
    ViscousFriction,
    /// c_2 of the friction, Nm s²/rad².
    QuadraticFriction,
    /// c_3 of the friction, Nm s³/rad³.
    CubicFriction,
    /// T_0/J_d, rad/s².
    FrictionOffsetOverInertia,
    /// c_0/J_d, rad/s².
    CoulombFrictionOverInertia,
    /// c_1/J_d, 1/s.
    ViscousFrictionOverInertia,
    /// c_2/J_d, 1/rad.
    QuadraticFrictionOverInertia,
    /// c_3/J_d, s/rad².
    CubicFrictionOverInertia,
    /// How late T_d is against N_d in a free run, s.
    TorqueLateness,

    /// Frequency of the resonance of T_d → T_shaft, Hz.
    ResonanceFrequency,
    /// Gain of T_d → T_shaft at the resonance, 1.
    ResonanceGain,
    /// Damping ratio of the resonance, 1.
    ResonanceDampingRatio,
    /// Engine speed at which firing meets the resonance, rad/s.
    FiringResonanceSpeed,
    /// Crossover of the speed loop, Hz.
    Crossover,
    /// Phase margin of the speed loop, rad.
    PhaseMargin,
}
