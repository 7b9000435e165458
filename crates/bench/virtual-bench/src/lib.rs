#![doc = include_str!("../README.md")]
//!
//! A virtual bench: simulates the experiments of the method on a dynamometer bench whose every parameter is known, and
//! records them as a real bench would.
//!
//! Speed or shaft-torque controller → drive (delay and lag, or an induction machine under field-oriented control) →
//! masses and shafts (two masses; more with a dual-mass flywheel or a rotor that twists; play, stiffening, loss factor)
//! ← engine over crank angle (harmonics of the firing order, or cylinders on a crankshaft; intake, throttle, ignition);
//! encoders, load cell or flange and the automation system's own torques on top. It exists to test estimators against
//! known truth and to try an experiment before it is run. [`BenchParameters`] and [`ExperimentPlan`] are plain data.
//!
//! # Numerical scheme
//!
//! Controllers and sensors work every millisecond, the drive's machine every quarter of one, the mechanics in steps
//! of 50 µs (see [`Numerics`]). Within a step the mechanics and the torque sensors are exact for torques that run
//! straight in time; the drive's delay and lag are exact whatever the delays, the machine for a speed that stays;
//! the step in which a cylinder fires is split at the firing. What depends on the state in a non-linear way (play,
//! stiffening, Coulomb friction, the crankshaft) is predicted and corrected once. The error is of second order in the
//! step size. In T_shaft, from 50 to 25 µs steps on the default bench: 5·10⁻⁴ Nm of the engine's harmonics, 1.5·10⁻³ Nm
//! of the ripple in a white-noise test, 1.3·10⁻³ Nm of the machine, 5·10⁻⁴ Nm of the slider crank, 8·10⁻³ Nm with play,
//! which is of second order from 12.5 µs on only.
//!
//! Randomness comes from ChaCha streams, one for each source: equal parameters, plan and seed give equal bits, and a
//! source that is switched on or off leaves what the others draw alone.
//!
//! # Source
//!
//! Glans & Kärnell, Chalmers EX112/2018, chapters 2, 5 and 6 for the bench and its equations.

mod control;
mod cubic;
mod drive;
mod engine;
mod error;
mod hidden;
mod names;
mod numerics;
mod run;
mod sensors;
mod stated;
mod train;
mod truth;
mod write;

use recording::Recording;
use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use work::Context;

pub use error::VirtualBenchError;
pub use hidden::HiddenTruth;
pub use names::{CHANNELS, rename};
pub use numerics::Numerics;
pub use stated::{Assumption, StatedBench};
pub use truth::Truth;

/// A recording together with what really happened.
#[derive(Debug, Clone, PartialEq)]
pub struct VirtualRun {
    /// Recording of the bench.
    pub recording: Recording,
    /// The true signals, where they were asked for.
    pub hidden: HiddenTruth,
}

/// Runs an experiment on a virtual bench and returns its recording.
///
/// Channels: `DynoSpeed`, `DynoSpeedDemand` (rpm), `DynoTorqueDemand` (Nm) every 1 ms, `EngineSpeed` (rpm) every 2 ms,
/// `DynoTorqueCalc`, `DynoTorqueMeas`, `ShaftTorqueCalc` (Nm) every 4 ms with default clocks. Without a shaft there is
/// no `EngineSpeed`. A bench with a flange has `FlangeTorque` in place of `DynoTorqueMeas` and `ShaftTorqueCalc`. Where
/// the engine gets a throttle there is `Throttle` (%), and in shaft-torque control `ShaftTorqueDemand` (Nm).
///
/// # Errors
///
/// [`VirtualBenchError`] where parameters or plan are impossible or the bench is unstable.
///
/// # Example
///
/// ```
/// use rig::bench_parameters::BenchParameters;
/// use rig::experiment::ExperimentPlan;
/// use virtual_bench::simulate;
///
/// let recording = simulate(&BenchParameters::default(), &ExperimentPlan::bs_t_nt(1200.0, 2.0), 1)?;
/// let speed = &recording.channels[0];
/// assert_eq!((speed.name.as_str(), speed.unit.as_str(), speed.samples.len()), ("DynoSpeed", "rpm", 2000));
/// assert!(speed.samples.iter().all(|n| (n - 1200.0).abs() < 50.0));
/// # Ok::<(), virtual_bench::VirtualBenchError>(())
/// ```
pub fn simulate(
    parameters: &BenchParameters,
    plan: &ExperimentPlan,
    seed: u64,
) -> Result<Recording, VirtualBenchError> {
    simulate_hidden(parameters, plan, seed, Numerics::WITHOUT_TRUTH).map(|run| run.recording)
}

/// As [`simulate`], with a choice of the step size, and with the hidden truth.
///
/// # Errors
///
/// As [`simulate`]; also where `numerics` is impossible.
pub fn simulate_hidden(
    parameters: &BenchParameters,
    plan: &ExperimentPlan,
    seed: u64,
    numerics: Numerics,
) -> Result<VirtualRun, VirtualBenchError> {
    simulate_as_step(&Context::new(), parameters, plan, seed, numerics)
}

/// As [`simulate_hidden`], as a step of the work.
///
/// # Errors
///
/// As [`simulate_hidden`].
pub fn simulate_as_step(
    context: &Context,
    parameters: &BenchParameters,
    plan: &ExperimentPlan,
    seed: u64,
    numerics: Numerics,
) -> Result<VirtualRun, VirtualBenchError> {
    parameters.check()?;
    plan.check()?;
    numerics.check(parameters.drive.machine.is_some())?;
    let (recording, hidden) = run::run(parameters, plan, seed, &numerics, context)?;
    Ok(VirtualRun { recording, hidden })
}
