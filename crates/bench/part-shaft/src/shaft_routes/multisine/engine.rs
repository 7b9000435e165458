//! The engine's side: J_e beside the engine's own speed control.

use std::f64::consts::TAU;

use faer::{Mat, MatMut};
use ident::{Bounds, IdentError, Minimum, NonlinearOptions, ResidualModel, minimise};
use rig::facts::Engine;
use signal::Complex64;

use super::lines::Row;
use super::shaft::{COUNT, ENGINE_SKEW, INERTIA, Shaft, differences};
use crate::shaft::{SLOWEST_RAD_S, ShaftInputs, WITHOUT_FIRING_S};
use crate::shaft_routes::multisine::cost::{CostTest, cost_test};

/// Beyond this coherence the engine's cycles repeat with the demand.
const COHERENT: f64 = 0.5;
/// Fewest periods from which the engine's torque, whose spectrum has lines, is weighed.
const FEWEST_FOR_ENGINE: usize = 6;
/// Standard uncertainty of the hold of the engine's control beforehand, as a part of it.
const HOLD_SPREAD: f64 = 0.6;

/// J_e with its variance and its covariance with the shaft's parameters.
pub(super) struct EngineFit {
    pub(super) inertia_kg_m2: f64,
    pub(super) variance: f64,
    pub(super) with_shaft: Vec<f64>,
    pub(super) cost: CostTest,
}

/// The engine's side of the shaft: J_e, P, I and τ.
pub(super) struct EngineSide<'a> {
    shaft: &'a Shaft<'a>,
    half_firing_s: f64,
    control: Control,
    theta: Vec<f64>,
}

/// How the engine's control acts upon its torque, where that is not recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Control {
    /// It holds for 2τ.
    Held,
    /// It acts τ late.
    Delayed,
}

/// Why J_e is not determined by the means over the periods.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EngineError {
    /// Too few periods.
    #[error(
        "J_e needs {needed} periods to weigh the engine's torque by its scatter, and {recorded} were recorded; record longer"
    )]
    TooFewPeriods {
        /// Periods that are needed.
        needed: usize,
        /// Periods that were recorded.
        recorded: usize,
    },
    /// The engine's cycles repeat with the demand.
    #[error(
        "J_e is not estimated: the engine's cycles repeat with the demand, so its torque does not average out; \
         record at a speed some 1 % higher"
    )]
    Coherent,
    /// The numbers do not allow an estimate.
    #[error("J_e: {0}")]
    Ident(#[from] IdentError),
}

pub(super) const ENGINE_UNKNOWNS: usize = 4;
pub(super) const HOLD: usize = 3;
pub(super) const ENGINE_SIZES: [f64; ENGINE_UNKNOWNS] = [1e-2, 0.1, 0.1, 1e-3];

impl<'a> EngineSide<'a> {
    pub(super) fn new(shaft: &'a Shaft<'a>, inputs: &ShaftInputs<'_>, engine: Engine) -> Result<Self, EngineError> {
        let periods = shaft.lines.periods();
        if periods < FEWEST_FOR_ENGINE {
            return Err(EngineError::TooFewPeriods { needed: FEWEST_FOR_ENGINE, recorded: periods });
        }
        let turns_per_s = inputs.engine_speed.mean().unwrap_or(0.0).abs().max(SLOWEST_RAD_S) / TAU;
        if shaft.lines.coherence > COHERENT {
            return Err(EngineError::Coherent);
        }
        let half_firing_s = match engine.cylinders {
            0 => WITHOUT_FIRING_S,
            _ => 0.5 / (engine.firings_per_turn() * turns_per_s),
        };
        Ok(EngineSide { shaft, half_firing_s, control: Control::Held, theta: Vec::new() })
    }

    pub(super) fn fit(mut self, theta: &[f64], covariance: &Mat<f64>) -> Result<EngineFit, EngineError> {
        let held = self.solve(theta)?;
        self.control = Control::Delayed;
        let delayed = self.solve(theta)?.parameters[0];
        self.control = Control::Held;
        let gradient: Vec<f64> = (0..COUNT)
            .map(|i| {
                let step = 0.1 * covariance[(i, i)].max(0.0).sqrt();
                let moved = |side: &mut Self, by: f64| {
                    let mut theta = theta.to_vec();
                    theta[i] += by;
                    side.solve(&theta).map(|m| m.parameters[0])
                };
                if step == 0.0 {
                    return Ok(0.0);
                }
                Ok((moved(&mut self, step)? - moved(&mut self, -step)?) / (2.0 * step))
            })
            .collect::<Result<_, IdentError>>()?;
        let with_shaft: Vec<f64> =
            (0..COUNT).map(|i| (0..COUNT).map(|j| covariance[(i, j)] * gradient[j]).sum()).collect();
        let through: f64 = with_shaft.iter().zip(&gradient).map(|(c, g)| c * g).sum();
        let lines = self.shaft.lines;
        let nu = (lines.periods() - 1) as f64;
        let freedom = (2 * lines.count() - ENGINE_UNKNOWNS + 1) as f64;
        let squares: f64 = held.residuals.iter().take(2 * lines.count()).map(|r| r * r).sum();
        let inertia = held.parameters[0];
        let cost = cost_test(0.5 * squares, freedom, nu);
        Ok(EngineFit {
            inertia_kg_m2: inertia,
            // As uncertain as what another control would make of the same data; uniform between the two and as far
            // beyond.
            variance: held.unscaled_covariance[(0, 0)] * nu / (nu - 2.0) * cost.inflation()
                + through
                + (delayed - inertia).powi(2) / 3.0,
            with_shaft,
            cost,
        })
    }

    fn solve(&mut self, theta: &[f64]) -> Result<Minimum, IdentError> {
        self.theta = theta.to_vec();
        let start = [0.5 * self.shaft.stated, 1.0, 1.0, self.half_firing_s];
        let bounds = [
            Bounds::new(0.0, f64::INFINITY),
            Bounds::new(0.0, f64::INFINITY),
            Bounds::new(0.0, f64::INFINITY),
            Bounds::new(0.05 * self.half_firing_s, 5.0 * self.half_firing_s),
        ];
        minimise(self, &start, &bounds, NonlinearOptions::default())
    }

    fn equation(&self, s: Complex64, p: &[f64]) -> Row {
        let theta = &self.theta;
        let x = 2.0 * s * p[HOLD];
        let late = match self.control {
            Control::Held => (1.0 - (-x).exp()) / x,
            Control::Delayed => (-0.5 * x).exp(),
        };
        let skew = (s * theta[ENGINE_SKEW]).exp();
        let dyno = [Complex64::default(), Complex64::default(), Complex64::from(theta[INERTIA])];
        let engine = [late * skew * p[2], late * skew * p[1], skew * p[0]];
        self.shaft.with_turns(s, theta, dyno, engine)
    }
}

impl ResidualModel for EngineSide<'_> {
    fn parameter_count(&self) -> usize {
        ENGINE_UNKNOWNS
    }

    fn residual_count(&self) -> usize {
        2 * self.shaft.lines.count() + 1
    }

    fn evaluate(
        &mut self,
        p: &[f64],
        residuals: &mut [f64],
        jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        let side = &*self;
        let at = |p: &[f64], values: &mut [f64]| {
            let lines = side.shaft.lines;
            for k in 0..lines.count() {
                let (error, variance) = lines.error(k, &side.equation(lines.s(k), p));
                let value = error * (2.0 / variance.max(f64::MIN_POSITIVE)).sqrt();
                (values[2 * k], values[2 * k + 1]) = (value.re, value.im);
            }
            values[2 * lines.count()] = (p[HOLD] - side.half_firing_s) / (HOLD_SPREAD * side.half_firing_s);
        };
        at(p, residuals);
        if let Some(jacobian) = jacobian {
            differences(p, &ENGINE_SIZES, residuals.len(), at, jacobian);
        }
        Ok(())
    }
}
