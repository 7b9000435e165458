//! What is stated of a bench: how it measures torque, its engine, inertias and limits.

use serde::{Deserialize, Serialize};

/// What the bench file states.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BenchFacts {
    /// The bench's name.
    pub name: String,
    /// Load cell or torque flange.
    pub variant: BenchVariant,
    /// Cylinders of the engine.
    pub cylinders: u32,
    /// Strokes of the engine, 2 or 4.
    pub strokes: u32,
    /// J_d, kg m².
    pub dynamometer_inertia_kg_m2: f64,
    /// Its standard uncertainty, % of it, if stated.
    pub dynamometer_inertia_uncertainty_percent: Option<f64>,
    /// J_e, kg m².
    pub engine_inertia_kg_m2: f64,
    /// Its standard uncertainty, % of it, if stated.
    pub engine_inertia_uncertainty_percent: Option<f64>,
    /// Drive torque limit, Nm.
    pub torque_limit_nm: Option<f64>,
    /// Shaft torque limit, Nm.
    pub shaft_torque_limit_nm: Option<f64>,
    /// Speed limit, rad/s.
    pub speed_limit_rad_s: Option<f64>,
}

/// How torque is measured at the bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BenchVariant {
    /// DTB: T_d measured by a load cell, shaft torque computed, two masses.
    LoadCell,
    /// TB: shaft torque measured by a flange, T_d computed, dual-mass flywheel.
    TorqueFlange,
}

/// The engine's firing, as the bench file states it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Engine {
    /// Cylinders.
    pub cylinders: u32,
    /// Strokes, 2 or 4.
    pub strokes: u32,
}

impl Engine {
    /// Firings a turn of the crankshaft: cylinders for two strokes, cylinders/2 for four (2.1).
    pub fn firings_per_turn(self) -> f64 {
        let turns_per_cycle = f64::from(self.strokes) / 2.0;
        f64::from(self.cylinders) / turns_per_cycle
    }

    /// Speed, rpm, at which the firing frequency f_cb = firings_per_turn · N/60 (2.1) equals `frequency_hz`.
    pub fn firing_speed_rpm(self, frequency_hz: f64) -> f64 {
        60.0 * frequency_hz / self.firings_per_turn()
    }

    /// Orders (multiples of the speed) at which a fired engine excites the shaft by itself: those of f_cb/4, f_cb/2 and
    /// f_cb (thesis §2.1), for four cylinders and four strokes 0.5, 1 and 2.
    pub fn orders(self) -> [f64; 3] {
        let firing = self.firings_per_turn();
        [firing / 4.0, firing / 2.0, firing]
    }
}
