//! Facts stated of a bench: how it measures torque, its engine, inertias and limits.

use serde::{Deserialize, Serialize};

/// Facts that the bench file states.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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

/// Standard uncertainty of J_d where none is stated, %. Data sheets round, and couplings and flanges come on top of the
/// rotor; IEC 60034-1 even allows the rotor of a machine 10 %.
const DYNO_INERTIA_PERCENT: f64 = 1.0;
/// The same of J_e, %: that of an engine changes with its accessories, its oil and the angle of its crank besides.
const ENGINE_INERTIA_PERCENT: f64 = 2.0;

/// Standard errors of the difference beyond which a stated inertia and what recordings show contradict each other.
const CONTRADICTED: f64 = 3.0;
/// A difference of a stated J_d from what a recording shows is worth a warning beyond so many standard errors: J_d is
/// all that shows the scale of the torques. One that is stated rightly is doubted once in a hundred times.
const DYNO_DOUBTED_STANDARD_ERRORS: f64 = 2.6;
/// The same of J_e, ...
const ENGINE_DOUBTED_STANDARD_ERRORS: f64 = 5.0;
/// ... and beyond this share of the inertia.
const DOUBTED_SHARE: f64 = 0.01;

/// An inertia before anything was estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedInertia {
    /// As the bench file states it, kg m².
    pub kg_m2: f64,
    /// Its standard uncertainty, % of it; zero counts as exact.
    pub uncertainty_percent: f64,
    /// True where the bench file states that uncertainty.
    pub is_uncertainty_stated: bool,
    doubted_standard_errors: f64,
}

impl StatedInertia {
    /// J_d; without a stated uncertainty it has one of 1 %.
    pub fn of_dynamometer(kg_m2: f64, uncertainty_percent: Option<f64>) -> Self {
        StatedInertia::new(kg_m2, uncertainty_percent, DYNO_INERTIA_PERCENT, DYNO_DOUBTED_STANDARD_ERRORS)
    }

    /// J_e; without a stated uncertainty it has one of 2 %.
    pub fn of_engine(kg_m2: f64, uncertainty_percent: Option<f64>) -> Self {
        StatedInertia::new(kg_m2, uncertainty_percent, ENGINE_INERTIA_PERCENT, ENGINE_DOUBTED_STANDARD_ERRORS)
    }

    fn new(kg_m2: f64, stated: Option<f64>, usual_percent: f64, doubted_standard_errors: f64) -> Self {
        let uncertainty_percent = stated.unwrap_or(usual_percent);
        StatedInertia { kg_m2, uncertainty_percent, is_uncertainty_stated: stated.is_some(), doubted_standard_errors }
    }

    /// Its standard uncertainty, kg m².
    pub fn standard_uncertainty_kg_m2(&self) -> f64 {
        self.uncertainty_percent / 100.0 * self.kg_m2
    }

    /// By which part of itself it differs from what a recording shows, value and standard uncertainty in kg m²; `None`
    /// where chance or less than 1 % may be the reason.
    pub fn contradicted_by(&self, seen: f64, error: f64) -> Option<f64> {
        let apart = (seen - self.kg_m2).abs();
        let spread = error.hypot(self.standard_uncertainty_kg_m2());
        (apart > self.doubted_standard_errors * spread && apart > DOUBTED_SHARE * self.kg_m2)
            .then_some(apart / self.kg_m2)
    }

    /// With what recordings show of it: value and standard uncertainty, kg m². Where the two contradict each other,
    /// what the recordings show counts, and its uncertainty reaches to the stated value: the scale of a torque may be
    /// wrong as well.
    ///
    /// # Source
    /// JCGM 100:2008 (GUM), 4.3, for the stated one; means weighted by precision: Rao, *Linear Statistical Inference
    /// and Its Applications*, 2nd ed., §6a.2.
    pub fn with_seen(&self, seen: f64, error: f64) -> (f64, f64) {
        let (stated, uncertainty) = (self.kg_m2, self.standard_uncertainty_kg_m2());
        let apart = (seen - stated).abs();
        if apart > CONTRADICTED * uncertainty.hypot(error) {
            return (seen, apart);
        }
        if uncertainty == 0.0 {
            return (stated, 0.0);
        }
        let (by_stated, by_seen) = (uncertainty.powi(-2), error.powi(-2));
        let precision = by_stated + by_seen;
        ((by_stated * stated + by_seen * seen) / precision, precision.powf(-0.5))
    }
}

impl BenchFacts {
    /// J_d.
    pub fn dynamometer_inertia(&self) -> StatedInertia {
        StatedInertia::of_dynamometer(self.dynamometer_inertia_kg_m2, self.dynamometer_inertia_uncertainty_percent)
    }

    /// J_e.
    pub fn engine_inertia(&self) -> StatedInertia {
        StatedInertia::of_engine(self.engine_inertia_kg_m2, self.engine_inertia_uncertainty_percent)
    }
}

/// How torque is measured at the bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum BenchVariant {
    /// DTB: T_d measured by a load cell, shaft torque computed, two masses.
    LoadCell,
    /// TB: shaft torque measured by a flange, T_d computed, dual-mass flywheel.
    TorqueFlange,
}

/// The engine's firing, as the bench file states it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
