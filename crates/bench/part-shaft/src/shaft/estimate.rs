//! Estimating the shaft and saying how sure that is.

use std::f64::consts::TAU;

use rig::align::split_window;
use rig::estimation::{ESTIMATION_SHARE, EstimateError, ReadOut};
use rig::results::{Estimate, Quantity, Shaft, Stretch};
use signal::Signal;

use super::inputs::ShaftInputs;
use super::response::{measured_response, validate};
use super::solution::{SLOWEST_RAD_S, Solution, Unknowns, WITHOUT_FIRING_S};
use super::term::Term;
use super::{engine_side, places};

/// Estimates the shaft from the first part of a recording and judges it on the rest.
///
/// # Errors
/// Signals that do not overlap long enough, or data that do not determine the parameters.
pub fn estimate(inputs: &ShaftInputs<'_>) -> Result<Shaft, EstimateError> {
    let stretch = inputs.stretch()?;
    let (estimation, validation) = split_window((stretch.start_s, stretch.end_s), ESTIMATION_SHARE);
    let known = Stretch { end_s: estimation.1, ..stretch };
    let solution = Solution::of(inputs, &known, Unknowns::Shaft)?;
    let naive = Solution::of(inputs, &known, Unknowns::ShaftWithoutTiming)?;
    let theta = &solution.fit.fit.parameters;
    Ok(Shaft {
        estimate: solution.estimate(&known),
        zero: solution.zero(&known)?,
        ignoring_timing: naive.estimate(&known),
        residual_spectrum: solution.residual_spectrum(),
        frequency_response: measured_response(&solution.spectra, theta),
        validation: validate(inputs, theta, validation)?,
        cross_checks: Vec::new(),
        inertias: None,
        shared_errors: solution.shared_errors(inputs),
    })
}

/// Unknowns that a fit to the whole of a recording is to find.
#[derive(Debug, Clone, Copy)]
pub enum Wanted<'a> {
    /// K and B with timing, and J_d within its stated uncertainty.
    Shaft,
    /// K, B, J_d and J_e with timing, as if nothing were known of the inertias; J_d stays as stated where the torque is
    /// that of a flange.
    ///
    /// The demand, T_d* in torque control and N_d* in speed control, shows J_e: what it moves cannot come from the
    /// engine, whose torque is not recorded. It has to be on the clock of N_d to some milliseconds. The engine's own
    /// speed control, which acts upon its next firing, is estimated along.
    Inertias {
        /// The demand.
        demand: &'a Signal,
        /// Firings a turn of the engine.
        firings_per_turn: f64,
    },
    /// The shaft of a bench with a dual-mass flywheel: K, B, the mass J_2 between shaft and engine, the spring K_2 and
    /// damping B_2 behind it, and timing.
    DualMass,
}

/// A fit to the whole of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The parameters.
    pub estimate: Estimate,
    /// The mean of |error|²/σ², which is one where the equation and the noise levels are right.
    pub misfit: f64,
}

/// The parameters alone, from the whole of a recording: to compare recordings with one another.
///
/// # Errors
/// Those of [`estimate`], and a demand that moves nothing.
pub fn fit(inputs: &ShaftInputs<'_>, wanted: Wanted<'_>) -> Result<Fitted, EstimateError> {
    let stretch = inputs.stretch()?;
    let unknowns = match wanted {
        Wanted::DualMass => Unknowns::ShaftAnd(Term::DualMass),
        Wanted::Inertias { .. } if inputs.inertia_kg_m2.is_some() => Unknowns::ShaftAndInertia,
        Wanted::Inertias { .. } | Wanted::Shaft => Unknowns::Shaft,
    };
    let solution = Solution::of(inputs, &stretch, unknowns)?;
    let estimate = match wanted {
        Wanted::Shaft => solution.estimate(&stretch),
        Wanted::Inertias { demand, firings_per_turn } => {
            with_inertias(inputs, &solution, &stretch, demand, firings_per_turn)?
        }
        Wanted::DualMass => dual_mass(&solution, &stretch),
    };
    Ok(Fitted { estimate, misfit: solution.fit.scale })
}

fn with_inertias(
    inputs: &ShaftInputs<'_>,
    solution: &Solution,
    stretch: &Stretch,
    demand: &Signal,
    firings_per_turn: f64,
) -> Result<Estimate, EstimateError> {
    let turns_per_s = inputs.engine_speed.mean().unwrap_or(0.0).abs().max(SLOWEST_RAD_S) / TAU;
    let (theta, covariance) = (&solution.fit.fit.parameters, &solution.fit.covariance);
    let firing_s = if firings_per_turn > 0.0 { 1.0 / (firings_per_turn * turns_per_s) } else { WITHOUT_FIRING_S };
    let engine = engine_side::estimate(&solution.spectra, demand, firing_s, theta, covariance)
        .map_err(|source| EstimateError::Ident { file: inputs.file.to_owned(), source })?;
    Ok(solution.with_engine_inertia(stretch, &engine))
}

fn dual_mass(solution: &Solution, stretch: &Stretch) -> Estimate {
    let [mass, stiffness, damping] = places::DUAL_MASS;
    let outputs: [ReadOut<'_>; 8] = [
        (Quantity::Stiffness, &|t| t[places::K]),
        (Quantity::Damping, &|t| t[places::B]),
        (Quantity::FlywheelInertia, &|t| t[mass]),
        (Quantity::FlywheelStiffness, &|t| t[stiffness]),
        (Quantity::FlywheelDamping, &|t| t[damping]),
        (Quantity::EngineSpeedSkew, &|t| t[places::SKEW_ENGINE]),
        (Quantity::AirGapTorqueSkew, &|t| t[places::SKEW_TORQUE]),
        (Quantity::EncoderGates, &|t| t[places::GATE]),
    ];
    solution.outputs(&outputs, stretch)
}
