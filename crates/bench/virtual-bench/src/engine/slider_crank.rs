//! The engine as cylinders on a crankshaft: gas torque and the torque of the reciprocating masses.

use numerics::random::Stream;
use rig::bench_parameters::{EngineParameters, SliderCrank};
use rig::random::Source;

use super::cylinder::{Angle, Cycle, charge_pa};
use crate::engine::step::{Combustion, EngineStep};
use crate::train::Train;

/// The engine's cylinders. The crankshaft obeys (J_e + M − M̄) dω/dt = T_gas − ½ (dM/dθ) ω² − T_on, M = Σ m (dx/dθ)²;
/// T_e is what makes J_e dω/dt = T_e − T_on of it.
#[derive(Debug, Clone)]
pub(crate) struct CrankEngine {
    crank: SliderCrank,
    cycle: Cycle,
    cycle_rad: f64,
    factors: Vec<f64>,
    cycle_variation: f64,
    combustion: Combustion,
    random: Stream,
    /// Friction and auxiliaries, Nm.
    friction_nm: f64,
    cylinders: Vec<Cylinder>,
}

/// Content of a cylinder.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cylinder {
    /// Crank angle of its last firing top dead centre, or of the next one where it has burnt yet.
    firing_rad: f64,
    charge_pa: f64,
    heat_pa: f64,
    /// Crank angles at which it takes its next charge and burns next.
    next_charge_rad: f64,
    next_burn_rad: f64,
}

impl CrankEngine {
    pub(super) fn new(
        parameters: &EngineParameters,
        crank: &SliderCrank,
        combustion: Combustion,
        seed: u64,
        angle_rad: f64,
        level_nm: f64,
    ) -> Self {
        let cycle = Cycle::new(parameters, crank);
        let (count, cycle_rad) = (parameters.cylinder_factors.len(), parameters.cycle_rad());
        let idle_nm = count as f64 * (cycle.mean.still_nm + crank.idle_pressure_pa * cycle.mean.charge_m3);
        let mut engine = Self {
            crank: *crank,
            cycle,
            cycle_rad,
            factors: parameters.cylinder_factors.clone(),
            cycle_variation: parameters.cycle_variation,
            combustion,
            random: Source::Firing.stream(seed),
            friction_nm: (idle_nm - parameters.motored_torque_nm).max(0.0),
            cylinders: Vec::with_capacity(count),
        };
        for index in 0..count {
            let place = index as f64 / count as f64;
            let cycles = (angle_rad / cycle_rad - place).floor();
            let firing_rad = (cycles + place) * cycle_rad;
            let charge_pa = engine.charge_pa(level_nm);
            let heat_pa = engine.heat_pa(level_nm, charge_pa);
            let ahead = |rad: f64| if rad > angle_rad { rad } else { rad + cycle_rad };
            let next_charge_rad = ahead(firing_rad + cycle_rad - std::f64::consts::PI);
            let next_burn_rad = ahead(firing_rad + cycle_rad - crank.burn_start_rad);
            engine.cylinders.push(Cylinder { firing_rad, charge_pa, heat_pa, next_charge_rad, next_burn_rad });
        }
        engine
    }

    fn charge_pa(&self, level_nm: f64) -> f64 {
        let level_nm = if self.combustion == Combustion::Fired { level_nm } else { 0.0 };
        charge_pa(&self.crank, level_nm)
    }

    /// q that makes the mean torque of all cylinders, if they were all like this one, a level.
    fn heat_pa(&self, level_nm: f64, charge_pa: f64) -> f64 {
        if self.combustion != Combustion::Fired {
            return 0.0;
        }
        let (count, mean) = (self.factors.len() as f64, &self.cycle.mean);
        let each_nm = (level_nm + self.friction_nm) / count - mean.still_nm - charge_pa * mean.charge_m3;
        (each_nm / mean.burnt_m3).max(0.0)
    }

    /// Cylinders that have come to their intake's end or their burn take what there is now.
    fn take_up(&mut self, angle_rad: f64, level_nm: f64) {
        for index in 0..self.cylinders.len() {
            if angle_rad >= self.cylinders[index].next_charge_rad {
                let charge_pa = self.charge_pa(level_nm);
                let cylinder = &mut self.cylinders[index];
                cylinder.charge_pa = charge_pa;
                cylinder.next_charge_rad += self.cycle_rad;
            }
            if angle_rad >= self.cylinders[index].next_burn_rad {
                let varied = 1.0 + self.cycle_variation * self.random.normal();
                let torque_nm = level_nm * self.factors[index] * varied;
                let heat_pa = self.heat_pa(torque_nm, self.cylinders[index].charge_pa);
                let cylinder = &mut self.cylinders[index];
                cylinder.heat_pa = heat_pa;
                cylinder.firing_rad += self.cycle_rad;
                cylinder.next_burn_rad += self.cycle_rad;
            }
        }
    }

    /// T_e at an angle and a speed with a torque on the crankshaft, Nm.
    fn torque_nm(&self, train: &Train, angle_rad: f64, speed_rad_s: f64, on_nm: f64) -> f64 {
        let (mut gas_nm, mut mass, mut bend) = (-self.friction_nm, 0.0, 0.0);
        for cylinder in &self.cylinders {
            let angle: Angle = self.cycle.at(angle_rad - cylinder.firing_rad);
            gas_nm += angle.still_nm + cylinder.charge_pa * angle.charge_m3 + cylinder.heat_pa * angle.burnt_m3;
            mass += angle.lever_squared_m2 - self.cycle.mean.lever_squared_m2;
            bend += angle.lever_bend_m2;
        }
        let inertia = train.engine_inertia_kg_m2();
        let (mass, bend) = (self.crank.reciprocating_mass_kg * mass, self.crank.reciprocating_mass_kg * bend);
        let left_nm = gas_nm - bend * speed_rad_s * speed_rad_s - on_nm;
        left_nm * inertia / (inertia + mass) + on_nm
    }

    /// Torque now, Nm.
    pub(super) fn now_nm(&self, train: &Train) -> f64 {
        self.torque_nm(train, train.engine_angle_rad(), train.engine_speed_rad_s(), train.torque_on_engine_nm())
    }

    /// The torque over the next step, its end foreseen with angle and speed to second order; see
    /// [`Engine::unforeseen_nm`](super::Engine::unforeseen_nm).
    pub(super) fn step(&mut self, train: &Train, step_s: f64, level_nm: f64) -> EngineStep {
        let (angle_rad, speed) = (train.engine_angle_rad(), train.engine_speed_rad_s());
        self.take_up(angle_rad, level_nm);
        let start_nm = self.now_nm(train);
        let acceleration = train.engine_acceleration_rad_s2(start_nm);
        let turned_rad = (speed + 0.5 * acceleration * step_s) * step_s;
        let (end_rad, end_rad_s) = (angle_rad + turned_rad, speed + acceleration * step_s);
        let end_nm = self.torque_nm(train, end_rad, end_rad_s, train.torque_on_engine_nm());
        EngineStep { start_nm, end_nm, firing: None }
    }
}
