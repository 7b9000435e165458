//! One cylinder over its working cycle: geometry, gas, reciprocating mass.

use std::f64::consts::{PI, TAU};

use rig::bench_parameters::{EngineParameters, SliderCrank};

/// Points of the tables in a turn: 0.1° each.
const POINTS_A_TURN: usize = 3600;
/// Pressure of the surroundings, Pa.
const AMBIENT_PA: f64 = 1e5;
/// Factor of Wiebe's function: e^−5 is not burnt at its end.
const WIEBE_FACTOR: f64 = 5.0;
/// Form factor of Wiebe's function.
const WIEBE_FORM: f64 = 2.0;

/// Terms of a cylinder at an angle after its firing top dead centre. Its torque is `still_nm` + p_im · `charge_m3` + q
/// · `burnt_m3`; `lever_m` is dx/dϑ and `bend_m` d²x/dϑ² of its piston.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Angle {
    pub(super) still_nm: f64,
    pub(super) charge_m3: f64,
    pub(super) burnt_m3: f64,
    /// (dx/dϑ)², m².
    pub(super) lever_squared_m2: f64,
    /// dx/dϑ · d²x/dϑ², m².
    pub(super) lever_bend_m2: f64,
}

/// The cycle, straight between points of a table.
#[derive(Debug, Clone)]
pub(super) struct Cycle {
    points: Vec<Angle>,
    points_a_rad: f64,
    /// Means over the cycle.
    pub(super) mean: Angle,
}

impl Cycle {
    pub(super) fn new(engine: &EngineParameters, crank: &SliderCrank) -> Self {
        let count = (engine.cycle_rad() / TAU * POINTS_A_TURN as f64).round() as usize;
        let points_a_rad = count as f64 / engine.cycle_rad();
        let points: Vec<Angle> = (0..count).map(|k| at(crank, k as f64 / points_a_rad, engine.cycle_rad())).collect();
        let sum = points.iter().fold(Angle::default(), |sum, point| sum.plus(point, 1.0));
        let mean = Angle::default().plus(&sum, 1.0 / count as f64);
        Self { points, points_a_rad, mean }
    }

    /// The cylinder at an angle, rad; the cycle repeats.
    pub(super) fn at(&self, angle_rad: f64) -> Angle {
        let place = angle_rad * self.points_a_rad;
        let below = place.floor();
        let index = (below as i64).rem_euclid(self.points.len() as i64) as usize;
        let next = if index + 1 == self.points.len() { 0 } else { index + 1 };
        let part = place - below;
        Angle::default().plus(&self.points[index], 1.0 - part).plus(&self.points[next], part)
    }
}

impl Angle {
    fn plus(self, other: &Angle, weight: f64) -> Angle {
        Angle {
            still_nm: self.still_nm + weight * other.still_nm,
            charge_m3: self.charge_m3 + weight * other.charge_m3,
            burnt_m3: self.burnt_m3 + weight * other.burnt_m3,
            lever_squared_m2: self.lever_squared_m2 + weight * other.lever_squared_m2,
            lever_bend_m2: self.lever_bend_m2 + weight * other.lever_bend_m2,
        }
    }
}

/// The cylinder at an angle after its firing top dead centre, 0 to the length of the cycle.
///
/// x = r (1 − cos ϑ) + l (1 − √(1 − λ² sin² ϑ)), λ = r/l. With valves shut, from −180° to 180°,
/// p = p_im (V_b/V)^κ + q w(ϑ) (V_c/V)^κ, w by Wiebe; then p is ambient (exhaust) and p_im (intake).
fn at(crank: &SliderCrank, angle_rad: f64, cycle_rad: f64) -> Angle {
    let from_firing = if angle_rad > cycle_rad - PI { angle_rad - cycle_rad } else { angle_rad };
    let (sine, cosine) = from_firing.sin_cos();
    let (radius, ratio) = (0.5 * crank.stroke_m, crank.rod_ratio);
    let root = (1.0 - (ratio * sine).powi(2)).sqrt();
    let lever = radius * (sine + ratio * sine * cosine / root);
    let bend = radius
        * (cosine
            + ratio * (cosine * cosine - sine * sine) / root
            + ratio.powi(3) * (sine * cosine).powi(2) / root.powi(3));
    let area = PI * crank.bore_m * crank.bore_m / 4.0;
    let swept = area * crank.stroke_m;
    let clearance = swept / (crank.compression_ratio - 1.0);
    let volume = clearance + area * radius * ((1.0 - cosine) + (1.0 - root) / ratio);
    let opened = area * lever;
    let (is_shut, is_intake) = (from_firing <= PI, from_firing > TAU);
    let packed = |full: f64| (full / volume).powf(crank.polytropic_exponent);
    let (still_nm, charge_m3, burnt_m3) = match (is_shut, is_intake) {
        (true, _) => {
            let burnt = burnt(crank, from_firing) * packed(clearance) * opened;
            (-AMBIENT_PA * opened, packed(clearance + swept) * opened, burnt)
        }
        (false, true) => (-AMBIENT_PA * opened, opened, 0.0),
        (false, false) => (0.0, 0.0, 0.0),
    };
    Angle { still_nm, charge_m3, burnt_m3, lever_squared_m2: lever * lever, lever_bend_m2: lever * bend }
}

/// Part of the charge that is burnt, 0 … 1 (Wiebe).
fn burnt(crank: &SliderCrank, from_firing_rad: f64) -> f64 {
    let progress = (from_firing_rad + crank.burn_start_rad) / crank.burn_duration_rad;
    if progress <= 0.0 { 0.0 } else { 1.0 - (-WIEBE_FACTOR * progress.powf(WIEBE_FORM + 1.0)).exp() }
}

/// Pressure of the charge for a torque, Pa: straight from that of the idling engine to ambient at full torque.
pub(super) fn charge_pa(crank: &SliderCrank, level_nm: f64) -> f64 {
    let load = (level_nm / crank.full_torque_nm).clamp(0.0, 1.0);
    crank.idle_pressure_pa + load * (AMBIENT_PA - crank.idle_pressure_pa)
}
