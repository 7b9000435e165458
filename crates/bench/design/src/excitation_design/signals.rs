//! Effects of the demand, the engine and errors of the encoder on the bench, at one frequency.

use bench_model::model::{BenchModel, Mechanics, mean_over};
use signal::Complex64;

use super::task::{DesignTask, ExcitedDemand};
use crate::excitation_design::unknown::Unknown;

/// Signals that may be measured.
pub(super) const OUTPUTS: usize = 5;
/// Quantities that may be limited: T_shaft, T_d, ω_d, the demand.
pub(super) const LIMITED: usize = 4;

/// Step of the differences, as a part of a parameter's scale. Their error is of fourth order in it: 10⁻¹².
const STEP: f64 = 1e-3;

/// The bench with the timing of its records.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Point {
    pub(super) model: BenchModel,
    pub(super) engine_skew_s: f64,
}

/// Complex amplitudes per unit of what causes them.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Motion {
    pub(super) torque_demand: Complex64,
    pub(super) air_gap: Complex64,
    pub(super) shaft: Complex64,
    pub(super) dyno_speed: Complex64,
    pub(super) engine_speed: Complex64,
}

impl Motion {
    /// Effect of T_d on both masses.
    fn of_torque(mechanics: &Mechanics, omega: f64, torque_demand: Complex64, air_gap: Complex64) -> Self {
        let shaft = mechanics.torque_to_shaft(omega) * air_gap;
        Motion {
            torque_demand,
            air_gap,
            shaft,
            dyno_speed: mechanics.torque_to_speed(omega) * air_gap,
            engine_speed: -shaft / Complex64::new(0.0, omega * mechanics.engine_inertia_kg_m2),
        }
    }

    /// Effect of T_e on both masses where nothing controls them.
    fn of_engine(mechanics: &Mechanics, omega: f64) -> Self {
        let shaft = mechanics.engine_to_shaft(omega);
        Motion {
            shaft,
            dyno_speed: mechanics.engine_to_speed(omega),
            engine_speed: (1.0 - shaft) / Complex64::new(0.0, omega * mechanics.engine_inertia_kg_m2),
            ..Motion::default()
        }
    }

    fn plus(self, other: Self) -> Self {
        Motion {
            torque_demand: self.torque_demand + other.torque_demand,
            air_gap: self.air_gap + other.air_gap,
            shaft: self.shaft + other.shaft,
            dyno_speed: self.dyno_speed + other.dyno_speed,
            engine_speed: self.engine_speed + other.engine_speed,
        }
    }

    /// As it is measured: T_d*, T_d, T_shaft, N_d, N_e.
    fn measured(&self, point: &Point, omega: f64) -> [Complex64; OUTPUTS] {
        // Speeds are means over the gate.
        let gate = mean_over(point.model.encoder_gate_s, omega);
        let late = Complex64::cis(-omega * point.engine_skew_s);
        [self.torque_demand, self.air_gap, self.shaft, self.dyno_speed * gate, self.engine_speed * gate * late]
    }
}

/// By a unit of the demand, whose values are held.
pub(super) fn by_demand(model: &BenchModel, excited: ExcitedDemand, hold_s: f64, omega: f64) -> Option<Motion> {
    let torque_control = model.torque_control.as_ref()?.response(omega);
    match excited {
        ExcitedDemand::Torque => {
            let demand = mean_over(hold_s, omega);
            Some(Motion::of_torque(&model.mechanics, omega, demand, torque_control * demand))
        }
        ExcitedDemand::Speed => {
            let pi = model.speed_controller.as_ref()?;
            let feed_forward = model.feed_forward.map(|f| f.response(omega, pi.sample_time_s)).unwrap_or_default();
            let controller = (feed_forward - pi.demand_response(omega)) / (model.open_loop(omega)? + 1.0);
            // The demand is held over several updates, the controller's output over one.
            let demand = controller * (mean_over(hold_s, omega) / pi.hold(omega));
            Some(Motion::of_torque(&model.mechanics, omega, demand, torque_control * pi.hold(omega) * demand))
        }
    }
}

/// By a unit of T_e.
fn by_engine(model: &BenchModel, excited: ExcitedDemand, omega: f64) -> Option<Motion> {
    let free = Motion::of_engine(&model.mechanics, omega);
    match excited {
        ExcitedDemand::Torque => Some(free),
        ExcitedDemand::Speed => {
            let reading = free.dyno_speed * mean_over(model.encoder_gate_s, omega);
            Some(free.plus(by_reading(model, omega, reading)?))
        }
    }
}

/// By what the speed controller reads beyond what T_d makes it read.
fn by_reading(model: &BenchModel, omega: f64, reading: Complex64) -> Option<Motion> {
    let pi = model.speed_controller.as_ref()?;
    let demand = pi.response(omega) * reading / (model.open_loop(omega)? + 1.0);
    let air_gap = model.torque_control.as_ref()?.response(omega) * pi.hold(omega) * demand;
    Some(Motion::of_torque(&model.mechanics, omega, demand, air_gap))
}

/// T_shaft, T_d, ω_d and the demand by a unit of the demand.
pub(super) fn limited(task: &DesignTask, model: &BenchModel, omega: f64) -> Option<[Complex64; LIMITED]> {
    let motion = by_demand(model, task.excited, task.hold_s, omega)?;
    Some([motion.shaft, motion.air_gap, motion.dyno_speed, mean_over(task.hold_s, omega)])
}

/// Measured signals by a unit of the demand.
fn outputs(task: &DesignTask, point: &Point, omega: f64) -> Option<[Complex64; OUTPUTS]> {
    Some(by_demand(&point.model, task.excited, task.hold_s, omega)?.measured(point, omega))
}

/// Other movers of the measured signals, each with the reciprocal of its density: zero where it may be anything.
pub(super) fn disturbances(task: &DesignTask, point: &Point, omega: f64) -> Option<Vec<([Complex64; OUTPUTS], f64)>> {
    let measured = &task.measurements;
    let engine = by_engine(&point.model, task.excited, omega)?.measured(point, omega);
    let mut all = vec![(engine, measured.engine_torque_density.map_or(0.0, |s| 1.0 / s))];
    if let (ExcitedDemand::Speed, Some(noise)) = (task.excited, measured.controller_reading) {
        let reading = by_reading(&point.model, omega, Complex64::from(1.0))?;
        all.push((reading.measured(point, omega), 1.0 / noise.density()));
    }
    Some(all)
}

impl Point {
    fn moved(&self, unknown: Unknown, by: f64) -> Self {
        let mut moved = self.clone();
        match unknown {
            Unknown::Model(p) => moved.model = self.model.with(p, self.model.value(p).unwrap_or(0.0) + by),
            Unknown::EngineSpeedSkew => moved.engine_skew_s += by,
            Unknown::EncoderGate => moved.model.encoder_gate_s += by,
        }
        moved
    }
}

/// A point with its neighbours, from which derivatives are taken.
pub(super) struct Neighbours {
    pub(super) centre: Point,
    /// For each unknown, those at −2, −1, 1 and 2 steps.
    around: Vec<[Point; 4]>,
}

impl Neighbours {
    pub(super) fn new(model: &BenchModel, unknowns: &[Unknown]) -> Self {
        let centre = Point { model: model.clone(), engine_skew_s: 0.0 };
        let around = |unknown: &Unknown| {
            let step = STEP * unknown.scale(model);
            [-2.0, -1.0, 1.0, 2.0].map(|steps| centre.moved(*unknown, steps * step))
        };
        Neighbours { around: unknowns.iter().map(around).collect(), centre }
    }

    /// Derivatives of the measured signals by each unknown over its scale.
    pub(super) fn derivatives(&self, task: &DesignTask, omega: f64) -> Option<Vec<[Complex64; OUTPUTS]>> {
        let derivative = |points: &[Point; 4]| {
            let [a, b, c, d] = points.each_ref().map(|point| outputs(task, point, omega));
            let (a, b, c, d) = (a?, b?, c?, d?);
            Some(std::array::from_fn(|i| ((c[i] - b[i]) * 8.0 - (d[i] - a[i])) / (12.0 * STEP)))
        };
        self.around.iter().map(derivative).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::excitation_design::PeakLimits;
    use bench_model::model::{ModelParameter, TorqueControlModel};

    /// ∂/∂K and ∂/∂B of T_d → T_shaft = (K + Bs)/J_d/D, D = s² + (K + Bs)μ, are s²/J_d/D² and s³/J_d/D².
    #[test]
    fn exact_differences_are_the_derivatives() -> Result<(), &'static str> {
        let mechanics = Mechanics {
            dyno_inertia_kg_m2: 0.6,
            engine_inertia_kg_m2: 0.28,
            stiffness_nm_per_rad: 2437.7,
            damping_nm_s_per_rad: 5.8,
        };
        let model = BenchModel {
            mechanics,
            speed_controller: None,
            feed_forward: None,
            torque_control: Some(TorqueControlModel { delay_s: 1e-3, bandwidth_rad_s: Some(500.0) }),
            torque_limit_nm: None,
            encoder_gate_s: 1e-3,
        };
        let task = DesignTask::shaft(model.clone(), 0.0, 100.0, PeakLimits::default());
        let unknowns = [Unknown::Model(ModelParameter::Stiffness), Unknown::Model(ModelParameter::Damping)];
        let neighbours = Neighbours::new(&model, &unknowns);
        for omega in [10.0, 113.0, 400.0] {
            let found = neighbours.derivatives(&task, omega).ok_or("a torque control")?;
            let torque = by_demand(&model, task.excited, task.hold_s, omega).ok_or("a torque control")?.air_gap;
            let s = Complex64::new(0.0, omega);
            let (k, b) = (mechanics.stiffness_nm_per_rad, mechanics.damping_nm_s_per_rad);
            let denominator = s * s + (s * b + k) * mechanics.mobility();
            let by_stiffness = s * s / mechanics.dyno_inertia_kg_m2 / (denominator * denominator) * torque;
            for (found, exact) in found.iter().zip([by_stiffness * k, by_stiffness * s * b]) {
                assert!((found[2] - exact).norm() < 1e-9 * exact.norm(), "{omega}: {} {exact}", found[2]);
            }
        }
        Ok(())
    }
}
