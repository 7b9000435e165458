//! The engine: cylinders that take up charge and ignition one after the other.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use super::cycle_table::{CYCLE_RAD, CycleTable};
use crate::bench;
use crate::random::Random;

/// Pressure of the surroundings, Pa.
const AMBIENT_PA: f64 = 1.0e5;
/// Lowest and highest pressure of the charge, Pa.
const CHARGE_PA: RangeInclusive<f64> = 2.5e4..=3.0e5;

/// Torque and inertia of the engine at an angle and a speed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Motion {
    /// Torque of gas, friction and of pistons at constant speed, Nm.
    pub(crate) torque_nm: f64,
    /// Inertia of the pistons at the crank, kg m².
    pub(crate) pistons_kg_m2: f64,
}

struct Cylinder {
    /// Crank angle at which its cycle began, rad.
    begin_rad: f64,
    /// Torque over the mean of all.
    share: f64,
    charge_pa: f64,
    pressure_rise: f64,
    is_lit: bool,
}

/// The engine in motion.
pub(crate) struct Engine {
    parameters: bench::Engine,
    table: CycleTable,
    cylinders: Vec<Cylinder>,
    /// Torque that the charge is for, behind the air path, Nm.
    air_nm: f64,
    /// Torque that the next ignition gives, Nm.
    level_nm: f64,
    random: Random,
}

impl Engine {
    /// At rest at a torque, with a charge for another.
    pub(crate) fn new(parameters: &bench::Engine, level_nm: f64, air_nm: f64, angle_rad: f64, random: Random) -> Self {
        let table = CycleTable::of(parameters);
        let count = parameters.cylinders.len();
        let cylinder = |(place, share): (usize, &f64)| {
            let into_rad = (angle_rad + CYCLE_RAD * place as f64 / count as f64).rem_euclid(CYCLE_RAD);
            let is_lit = into_rad >= TAU - parameters.ignition_rad;
            Cylinder { begin_rad: angle_rad - into_rad, share: *share, charge_pa: 0.0, pressure_rise: 0.0, is_lit }
        };
        let cylinders = parameters.cylinders.iter().enumerate().map(cylinder).collect();
        let mut engine = Engine { parameters: parameters.clone(), table, cylinders, air_nm, level_nm, random };
        let charge_pa = engine.charge_pa();
        for place in 0..count {
            engine.cylinders[place].charge_pa = charge_pa;
            engine.cylinders[place].pressure_rise = engine.pressure_rise(place, 0.0);
        }
        engine
    }

    /// Mean inertia of the pistons at the crank, kg m².
    pub(crate) fn mean_pistons_kg_m2(&self) -> f64 {
        self.cylinders.len() as f64 * self.table.mean.inertia_kg_m2
    }

    /// A demand for a millisecond. By ignition the charge stays as it is.
    pub(crate) fn demand(&mut self, torque_nm: f64, is_by_ignition: bool) {
        if is_by_ignition {
            self.level_nm = torque_nm;
            return;
        }
        let lag_s = self.parameters.air_lag_s;
        let stays = if lag_s > 0.0 { (-1e-3 / lag_s).exp() } else { 0.0 };
        self.air_nm = torque_nm + (self.air_nm - torque_nm) * stays;
        self.level_nm = self.air_nm;
    }

    /// Charge and ignition of the cylinders that have come to them.
    pub(crate) fn turn_to(&mut self, angle_rad: f64) {
        let ignition_rad = TAU - self.parameters.ignition_rad;
        for place in 0..self.cylinders.len() {
            if angle_rad >= self.cylinders[place].begin_rad + CYCLE_RAD {
                self.cylinders[place].begin_rad += CYCLE_RAD;
                self.cylinders[place].charge_pa = self.charge_pa();
                self.cylinders[place].is_lit = false;
            }
            if !self.cylinders[place].is_lit && angle_rad >= self.cylinders[place].begin_rad + ignition_rad {
                let deviation = self.parameters.cycle_variation * self.random.normal();
                self.cylinders[place].pressure_rise = self.pressure_rise(place, deviation);
                self.cylinders[place].is_lit = true;
            }
        }
    }

    pub(crate) fn motion(&self, angle_rad: f64, speed_rad_s: f64) -> Motion {
        let mut motion = Motion { torque_nm: -self.parameters.friction_nm, pistons_kg_m2: 0.0 };
        for cylinder in &self.cylinders {
            let into_rad = angle_rad - cylinder.begin_rad;
            // Within a step a cylinder may come to its next cycle.
            let point = self.table.at(if into_rad < CYCLE_RAD { into_rad } else { into_rad - CYCLE_RAD });
            let gas_m3 = point.charge_m3 + cylinder.pressure_rise * point.burn_m3;
            // The kinetic energy ½ J(θ) ω² takes ½ J′ ω² of the torque, and J of the acceleration.
            motion.torque_nm += cylinder.charge_pa * gas_m3 + AMBIENT_PA * point.ambient_m3
                - 0.5 * point.inertia_slope_kg_m2 * speed_rad_s * speed_rad_s;
            motion.pistons_kg_m2 += point.inertia_kg_m2;
        }
        motion
    }

    /// The charge with which the best ignition gives the torque.
    fn charge_pa(&self) -> f64 {
        let mean = &self.table.mean;
        let wanted_nm = (self.air_nm + self.parameters.friction_nm) / self.cylinders.len() as f64;
        let per_pa_m3 = mean.charge_m3 + self.parameters.pressure_rise * mean.burn_m3;
        ((wanted_nm - AMBIENT_PA * mean.ambient_m3) / per_pa_m3).clamp(*CHARGE_PA.start(), *CHARGE_PA.end())
    }

    /// The pressure rise with which a cycle of a cylinder gives its part of the torque; never below zero.
    fn pressure_rise(&self, place: usize, deviation: f64) -> f64 {
        let (mean, cylinder, count) = (&self.table.mean, &self.cylinders[place], self.cylinders.len() as f64);
        let wanted_nm = (self.level_nm * cylinder.share * (1.0 + deviation) + self.parameters.friction_nm) / count;
        let of_charge_m3 = (wanted_nm - AMBIENT_PA * mean.ambient_m3) / cylinder.charge_pa;
        ((of_charge_m3 - mean.charge_m3) / mean.burn_m3).max(0.0)
    }
}
