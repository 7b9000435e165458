//! Benches drawn at random over a class.

use std::f64::consts::TAU;

use crate::bench::RPM;
use crate::bench::{Bench, Clocks, Controller, Drive, Engine, Sensors, Train};
use crate::random::Random;

/// The bench of a seed: passenger cars' engines of 3, 4 or 6 cylinders on dynamometers of 0.3 to 1.2 kg m², resonances
/// from 9 to 30 Hz.
pub fn draw(seed: u64) -> Bench {
    let mut random = Random::new(seed);
    let train = train(&mut random);
    Bench {
        drive: drive(&mut random),
        controller: controller(&train, &mut random),
        engine: Engine { torque_error: torque_error(seed), ..engine(&mut random) },
        sensors: sensors(&mut random),
        clocks: clocks(&mut random),
        train,
    }
}

fn train(random: &mut Random) -> Train {
    let (dyno, engine) = (random.between(0.28, 1.2), random.between(0.14, 0.45));
    let resonance_rad_s = TAU * random.between(9.0, 30.0);
    let stiffness = resonance_rad_s * resonance_rad_s / (1.0 / dyno + 1.0 / engine);
    Train {
        dyno_inertia_kg_m2: dyno,
        engine_inertia_kg_m2: engine,
        stiffness_nm_per_rad: stiffness,
        damping_nm_s_per_rad: 2.0 * random.between(0.05, 0.18) * stiffness / resonance_rad_s,
        coulomb_nm: random.between(0.3, 1.5),
        viscous_nm_s_per_rad: random.between(0.0005, 0.02),
    }
}

fn drive(random: &mut Random) -> Drive {
    Drive {
        delay_s: random.between(0.7e-3, 1.8e-3),
        bandwidth_rad_s: random.between(400.0, 850.0),
        ripple_hz: 100.0,
        added_ripple_nm: random.between(0.3, 1.8),
        multiplied_ripple: random.between(0.01, 0.035),
        limit_nm: 600.0,
    }
}

/// Gains in proportion to the inertia that the controller has to move.
fn controller(train: &Train, random: &mut Random) -> Controller {
    let inertia = train.dyno_inertia_kg_m2;
    Controller {
        proportional_nm_s_per_rad: inertia * random.between(9.0, 22.0),
        integral_nm_per_rad: random.between(11.0, 37.0),
        delay_ms: random.one_of([1, 2, 3]),
        delays_demand: random.one_of([true, false]),
        speed_gain_nm_s_per_rad: random.between(0.03, 0.19),
        constant_nm: random.between(-5.0, 5.0),
        acceleration_gain_nm_s2_per_rad: -inertia * random.between(0.5, 1.7),
    }
}

fn engine(random: &mut Random) -> Engine {
    let count = random.one_of([3, 4, 6]);
    let drawn: Vec<f64> = (0..count).map(|_| random.between(0.91, 1.09)).collect();
    let mean = drawn.iter().sum::<f64>() / count as f64;
    let swept_m3 = random.between(0.3e-3, 0.5e-3);
    // Speed control between slow and quick, with about the same damping.
    let quickness = random.between(0.1, 1.0);
    Engine {
        cylinders: drawn.iter().map(|one| one / mean).collect(),
        cycle_variation: random.between(0.005, 0.03),
        swept_m3,
        // As long as it is wide.
        stroke_m: (swept_m3 * 4.0 / std::f64::consts::PI).cbrt(),
        rod_ratio: random.between(0.25, 0.33),
        compression: random.between(9.5, 12.5),
        piston_kg: random.between(0.3, 0.55),
        pressure_rise: random.between(2.0, 3.2),
        ignition_rad: random.between(10.0, 25.0_f64).to_radians(),
        burn_rad: random.between(45.0, 65.0_f64).to_radians(),
        friction_nm: 4.0 * count as f64,
        torque_error: (1.0, 0.0),
        air_lag_s: random.between(0.0, 0.05),
        speed_proportional_nm_s_per_rad: 2.0 * quickness,
        speed_integral_nm_per_rad: 6.0 * quickness * quickness,
    }
}

/// Control units know the torque to some per cent.
fn torque_error(seed: u64) -> (f64, f64) {
    let mut random = Random::new(seed ^ 0x7043_9e00);
    (random.between(0.97, 1.03), random.between(-1.5, 1.5))
}

fn sensors(random: &mut Random) -> Sensors {
    Sensors {
        slits: random.one_of([None, Some(1024), Some(2048)]),
        pitch_error_rad: [random.between(0.0, 3.5e-4), random.between(0.0, 4.5e-4)],
        speed_noise_rad_s: random.between(0.012, 0.075) * RPM,
        speed_step_rad_s: 0.01 * RPM,
        demand_step_nm: 0.01,
        torque_noise_nm: random.between(0.05, 0.35),
        cell_rad_s: 75.0 * TAU,
        cell_damping_ratio: 0.25,
        cell_delay_ms: 8,
    }
}

fn clocks(random: &mut Random) -> Clocks {
    let (engine_speed_ms, torque_ms) = random.one_of([(2, 4), (1, 4), (2, 2), (4, 10)]);
    Clocks {
        engine_speed_ms,
        torque_ms,
        engine_speed_skew_s: random.between(-1.5e-3, 1.5e-3),
        torque_skew_s: random.between(-0.9e-3, 0.9e-3),
    }
}
