//! One cylinder over its working cycle.
//!
//! The angle is 0 where the intake begins; the charge burns about 2π. While the valves are shut p = p_c (V_0/V)^n (1 +
//! r x), with the charge's pressure p_c, the pressure rise r and the burnt fraction x of Wiebe. Without combustion such
//! a cycle does no work, and the work of combustion is in proportion to r (Matekunas, SAE 830337). The exhaust valve
//! then lets the pressure down to that of the surroundings.

use std::f64::consts::{PI, TAU};

use super::slider_crank::SliderCrank;
use crate::bench;

/// Angle of a working cycle, rad.
pub(super) const CYCLE_RAD: f64 = 2.0 * TAU;
/// Points of the table: four a degree.
const POINTS: usize = 2880;
/// n, exponent of compression and expansion.
const POLYTROPIC: f64 = 1.32;
/// Exponent of Wiebe's function.
const WIEBE_EXPONENT: i32 = 3;
/// Factor of Wiebe's function: 99.9 % are burnt at its end.
const WIEBE_FACTOR: f64 = 6.908;
/// The exhaust valve opens, rad.
const EXHAUST_OPENS_RAD: f64 = 3.0 * PI - 0.7;
/// The pressure has fallen, rad.
const EXHAUST_FALLEN_RAD: f64 = 3.0 * PI + 0.2;

/// Terms of a cylinder at one angle.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Point {
    /// Torque for the pressure of the charge, m³.
    pub(super) charge_m3: f64,
    /// Torque for the pressure of the charge times r, m³.
    pub(super) burn_m3: f64,
    /// Torque for the pressure of the surroundings, m³.
    pub(super) ambient_m3: f64,
    /// Inertia of the piston at the crank, kg m².
    pub(super) inertia_kg_m2: f64,
    /// Its derivative by the angle, kg m².
    pub(super) inertia_slope_kg_m2: f64,
}

/// A working cycle, linear between its points.
pub(super) struct CycleTable {
    points: Vec<Point>,
    /// Means over the cycle.
    pub(super) mean: Point,
}

impl CycleTable {
    pub(super) fn of(engine: &bench::Engine) -> Self {
        let points: Vec<Point> = (0..POINTS).map(|k| point(engine, angle_rad(k))).collect();
        let sum = points.iter().fold(Point::default(), |sum, one| sum.plus(one, 1.0));
        CycleTable { mean: Point::default().plus(&sum, 1.0 / POINTS as f64), points }
    }

    /// At an angle within the cycle.
    pub(super) fn at(&self, angle_rad: f64) -> Point {
        let place = angle_rad * (POINTS as f64 / CYCLE_RAD);
        let low = (place as usize).min(POINTS - 1);
        let high = if low + 1 == POINTS { 0 } else { low + 1 };
        let share = place - low as f64;
        Point::default().plus(&self.points[low], 1.0 - share).plus(&self.points[high], share)
    }
}

impl Point {
    fn plus(self, other: &Point, factor: f64) -> Point {
        Point {
            charge_m3: self.charge_m3 + factor * other.charge_m3,
            burn_m3: self.burn_m3 + factor * other.burn_m3,
            ambient_m3: self.ambient_m3 + factor * other.ambient_m3,
            inertia_kg_m2: self.inertia_kg_m2 + factor * other.inertia_kg_m2,
            inertia_slope_kg_m2: self.inertia_slope_kg_m2 + factor * other.inertia_slope_kg_m2,
        }
    }
}

fn angle_rad(point: usize) -> f64 {
    point as f64 * CYCLE_RAD / POINTS as f64
}

/// The torque of a pressure is p dV/dθ.
fn point(engine: &bench::Engine, angle_rad: f64) -> Point {
    let crank = SliderCrank { radius_m: 0.5 * engine.stroke_m, rod_ratio: engine.rod_ratio };
    let area_m2 = engine.swept_m3 / engine.stroke_m;
    let clearance_m3 = engine.swept_m3 / (engine.compression - 1.0);
    let volume_m3 = clearance_m3 + area_m2 * crank.position_m(angle_rad);
    let (slope_m, curvature_m) = (crank.slope_m(angle_rad), crank.curvature_m(angle_rad));
    let swept_slope_m3 = area_m2 * slope_m;
    let compressed = ((clearance_m3 + engine.swept_m3) / volume_m3).powf(POLYTROPIC);
    let shut = shut(angle_rad);
    let charge = if angle_rad < PI { 1.0 } else { shut * compressed };
    // Below the piston is the pressure of the surroundings.
    let ambient = if angle_rad < PI { -1.0 } else { (1.0 - shut) - 1.0 };
    Point {
        charge_m3: charge * swept_slope_m3,
        burn_m3: if angle_rad < PI { 0.0 } else { shut * compressed * burnt(engine, angle_rad) * swept_slope_m3 },
        ambient_m3: ambient * swept_slope_m3,
        inertia_kg_m2: engine.piston_kg * slope_m * slope_m,
        inertia_slope_kg_m2: 2.0 * engine.piston_kg * slope_m * curvature_m,
    }
}

/// Share of the pressure of the charge: 1 up to where the exhaust opens, 0 after it.
fn shut(angle_rad: f64) -> f64 {
    let share = ((angle_rad - EXHAUST_OPENS_RAD) / (EXHAUST_FALLEN_RAD - EXHAUST_OPENS_RAD)).clamp(0.0, 1.0);
    0.5 * (1.0 + (PI * share).cos())
}

/// x = 1 − e^{−a y^m}, y from ignition to the end of combustion.
fn burnt(engine: &bench::Engine, angle_rad: f64) -> f64 {
    let since = (angle_rad - (TAU - engine.ignition_rad)) / engine.burn_rad;
    1.0 - (-WIEBE_FACTOR * since.max(0.0).powi(WIEBE_EXPONENT)).exp()
}
