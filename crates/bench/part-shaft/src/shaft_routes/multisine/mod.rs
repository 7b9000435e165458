//! The shaft from a periodic torque demand: sample maximum likelihood.
//!
//! At each excited line k every period gives a vector Z of transforms of ω_d, ω_e, T_d and of ω cos θ and ω sin θ of
//! both encoders, whose once-a-turn errors are estimated along. The shaft's equation c(s_k, θ)ᵀ Z = 0, for exact
//! encoders (J_d s² + K + B s) ω_d − (K + B s) e^{sδ_e} ω_e + s g(s) e^{sδ_T} T_d = 0, holds for what repeats and for
//! what the engine does in between alike; what errs are the sensors. With Z̄ the mean over P periods and C its sample
//! covariance, V = Σ_k |cᵀ Z̄|²/(cᵀ C c*) is made small: noise levels need not be known, and may be correlated between
//! the signals. g = (1 − e^{−sT_g})/(sT_g) gives the torque the gate of the encoders.
//!
//! A period is weighed by a window that rises like sin² over a quarter of a period and falls over the first quarter of
//! the next, so that windows add up to one: the mean over periods holds all of the data and nothing of other lines of
//! the demand. Derivatives are moved to the window, so that what does not repeat leaks into no equation.
//!
//! A sample covariance from few periods errs, so that |e|²/σ̂² is F-distributed. It is therefore averaged over
//! neighbouring lines, as a factor upon the shape that equal white noise of both encoders would have, until it has
//! enough degrees of freedom ν; cost and covariance are then freed of what is left, ν/(ν − 1) and ν/(ν − 2).
//!
//! J_e follows from the engine's side, s T_shaft + J_e s² ω_e + (P s + I) h(s) ω_e = s T_e, with P and I the engine's
//! own speed control, which acts upon its next firing and holds, h(s) = (1 − e^{−2sτ})/(2sτ). T_e is not recorded, but
//! does not repeat with the demand; its scatter is in C.
//!
//! # Source
//! Pintelon & Schoukens, *System Identification: A Frequency Domain Approach*, 2nd ed. 2012, §10.3 and §12.3 (sample
//! maximum likelihood, its expected cost and covariance); Shinbrot, *On the analysis of linear and nonlinear systems*,
//! 1957 (derivatives by the window); thesis (6.1), (6.4), (6.10).

mod cost;
mod engine;
mod lines;
mod shaft;

use numerics::null::{infinite_if_null, nan_if_null};
use rig::InWords;
use rig::estimation::{EstimateError, timing_floor_s};
use rig::facts::Engine;
use rig::results::{Estimate, Quantity};
use serde::{Deserialize, Serialize};
use signal::Signal;

use super::{Timing, estimate_of, flange_torque};
use crate::shaft::ShaftInputs;
pub use cost::CostTest;
pub use engine::EngineError;
use engine::EngineSide;
use lines::Lines;
use shaft::{ENGINE_SKEW, Shaft, TORQUE_SKEW};

/// Treatment of J_d.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum DynoInertia {
    /// As stated, within its uncertainty.
    Stated,
    /// Estimated along, as if nothing were known of it.
    Estimated,
}

/// The shaft from a periodic demand.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MultisineRoute {
    /// K, B, J_d where it was not exactly known, δ_e and δ_T; J_e where it is determined.
    pub estimate: Estimate,
    /// The period, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub period_s: f64,
    /// Periods that were used.
    pub periods: usize,
    /// The lines, Hz.
    #[serde(deserialize_with = "nan_if_null")]
    pub lines_hz: Vec<f64>,
    /// |e|/σ at each line.
    #[serde(deserialize_with = "nan_if_null")]
    pub normalised: Vec<f64>,
    /// Degrees of freedom of the variance at a line.
    #[serde(deserialize_with = "infinite_if_null")]
    pub variance_freedom: f64,
    /// The test of the cost.
    pub cost: CostTest,
    /// The test of the cost of the engine's side, where J_e is determined.
    pub engine_cost: Option<CostTest>,
    /// Why J_e is not determined; it serialises as its words.
    pub engine_error: Option<InWords<EngineError>>,
}

/// Estimates the shaft from a recording under a periodic torque demand, T_d* on the clock of N_d. `timing` gives the
/// gate; both skews are estimated, from its values on. The engine's firings show how long its control holds.
///
/// # Errors
/// A demand that does not repeat or repeats too seldom, a torque that is that of a flange, or data that do not
/// determine the parameters.
pub fn estimate(
    inputs: &ShaftInputs<'_>,
    demand: &Signal,
    timing: &Timing,
    inertia: DynoInertia,
    engine: Engine,
) -> Result<MultisineRoute, EstimateError> {
    let of = |source| EstimateError::Ident { file: inputs.file.to_owned(), source };
    let Some(stated) = inputs.inertia_kg_m2 else {
        return Err(flange_torque(inputs, "multisine route"));
    };
    let lines = Lines::new(inputs, demand, timing, engine)?;
    let prior = (inertia == DynoInertia::Stated).then_some(stated);
    let mut model = Shaft { lines: &lines, gate_s: timing.gate_s.0, stated: stated.0, prior };
    let (fit, covariance) = model.fit().map_err(of)?;
    let cost = model.cost(&fit);
    let covariance = faer::Scale(cost.inflation()) * &covariance;
    let chosen = model.read();
    let theta = fit.parameters.clone();
    let dated = |i: usize| match i {
        ENGINE_SKEW => timing.engine_skew_s.0,
        TORQUE_SKEW => timing.torque_skew_s.0,
        _ => 0.0,
    };
    let mut found: Vec<_> = chosen.iter().map(|(label, i)| (*label, theta[*i] + dated(*i))).collect();
    let entry = |i: usize, j: usize| covariance[(i, j)];
    let mut rows: Vec<Vec<f64>> =
        chosen.iter().map(|(_, i)| chosen.iter().map(|(_, j)| entry(*i, *j)).collect()).collect();
    // What is uncertain of the gate shifts the torque by half of it.
    if let Some(skew) = chosen.iter().position(|(_, i)| *i == TORQUE_SKEW) {
        rows[skew][skew] += (0.5 * timing.gate_s.1).powi(2) + timing_floor_s(inputs.dyno_speed.sample_time_s).powi(2);
    }
    let engine = EngineSide::new(&model, inputs, engine).and_then(|engine| engine.fit(&theta, &covariance));
    let (engine_cost, engine_error) = match engine {
        Ok(engine) => {
            let with: Vec<f64> = chosen.iter().map(|(_, i)| engine.with_shaft[*i]).collect();
            rows.iter_mut().zip(&with).for_each(|(row, c)| row.push(*c));
            rows.push(with.into_iter().chain([engine.variance]).collect());
            found.push((Quantity::EngineInertia, engine.inertia_kg_m2));
            (Some(engine.cost), None)
        }
        Err(error) => (None, Some(error)),
    };
    let normalised =
        fit.residuals.chunks_exact(2).take(lines.count()).map(|r| r[0].hypot(r[1]) / 2f64.sqrt()).collect();
    let freedom = 2.0 * cost.expected.max(0.5);
    Ok(MultisineRoute {
        estimate: estimate_of(
            &found,
            rows,
            freedom.max(1.0),
            lines.stretch(inputs.file),
            (fit.iterations, fit.condition),
        ),
        period_s: lines.period_s,
        periods: lines.periods(),
        lines_hz: lines.frequencies_hz.clone(),
        normalised,
        variance_freedom: lines.freedom(),
        cost,
        engine_cost,
        engine_error: engine_error.map(InWords::from),
    })
}
