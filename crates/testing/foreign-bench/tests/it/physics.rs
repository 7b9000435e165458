//! The bench by its own laws.

use std::f64::consts::TAU;

use foreign_bench::{Demand, Mode, draw, run, run_in_steps};

use crate::support::{RPM, mean, quiet, steady};

/// Integral of a power over samples a millisecond apart, J.
fn work_j(torque_nm: &[f64], speed_rad_s: &[f64]) -> f64 {
    let power = |k: usize| torque_nm[k] * speed_rad_s[k];
    (1..torque_nm.len()).map(|k| 0.5e-3 * (power(k - 1) + power(k))).sum()
}

#[test]
fn exact_energy_is_neither_made_nor_lost() {
    for seed in 0..4 {
        let mut bench = draw(seed);
        bench.engine.air_lag_s = 0.0;
        let mut demand = steady(Mode::Speed, 2000.0 * RPM, 30.0, 6000);
        demand.torque_nm[3000..].fill(120.0);
        let truth = run(&bench, &demand, seed).truth;
        let last = truth.twist_rad.len() - 1;
        let energy_j = |k: usize| {
            0.5 * bench.train.dyno_inertia_kg_m2 * truth.dyno_speed_rad_s[k].powi(2)
                + truth.engine_energy_j[k]
                + 0.5 * bench.train.stiffness_nm_per_rad * truth.twist_rad[k].powi(2)
        };
        let slip: Vec<f64> = truth.engine_speed_rad_s.iter().zip(&truth.dyno_speed_rad_s).map(|(e, d)| e - d).collect();
        let damped: Vec<f64> = slip.iter().map(|slip| bench.train.damping_nm_s_per_rad * slip).collect();
        let given_j = work_j(&truth.engine_torque_nm, &truth.engine_speed_rad_s);
        let taken_j = work_j(&truth.air_gap_torque_nm, &truth.dyno_speed_rad_s)
            + work_j(&truth.friction_nm, &truth.dyno_speed_rad_s)
            + work_j(&damped, &slip);
        let kept_j = energy_j(last) - energy_j(0);
        println!("{seed}: given {given_j} J, taken {taken_j} J, kept {kept_j} J");
        assert!((given_j - taken_j - kept_j).abs() < 5e-4 * given_j, "{given_j} {taken_j} {kept_j}");
    }
}

#[test]
fn exact_half_the_step_changes_little() {
    let bench = quiet(5);
    let mut demand = steady(Mode::Speed, 1500.0 * RPM, 40.0, 1500);
    demand.torque_nm[200..].fill(140.0);
    let shaft = |steps: usize| run_in_steps(&bench, &demand, 1, steps).truth.shaft_torque_nm;
    let (coarse, usual, fine) = (shaft(25), shaft(50), shaft(200));
    let apart = |one: &[f64]| one.iter().zip(&fine).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let (of_coarse, of_usual) = (apart(&coarse), apart(&usual));
    println!("{of_coarse} Nm, {of_usual} Nm");
    assert!(of_usual < 0.005 && of_usual < of_coarse, "{of_coarse} {of_usual}");
}

/// A step of T_d* makes the shaft swing with ω = ω_0 √(1 − ζ²), ω_0² = K (1/J_d + 1/J_e), 2 ζ ω_0 = B (1/J_d + 1/J_e).
#[test]
fn exact_the_resonance_is_that_of_the_formula() {
    for seed in 0..3 {
        let mut bench = quiet(seed);
        // Without pulses: an engine that hardly has pistons or pressure, and no control.
        bench.engine.swept_m3 *= 1e-9;
        bench.engine.piston_kg *= 1e-9;
        bench.engine.friction_nm = 0.0;
        (bench.engine.speed_proportional_nm_s_per_rad, bench.engine.speed_integral_nm_per_rad) = (0.0, 0.0);
        (bench.train.coulomb_nm, bench.train.viscous_nm_s_per_rad) = (0.0, 0.0);
        bench.train.damping_nm_s_per_rad *= 0.3;
        let mut demand = steady(Mode::Torque, 1500.0 * RPM, 0.0, 600);
        demand.torque_nm[5..].fill(20.0);
        let torque = run(&bench, &demand, 1).truth.shaft_torque_nm;
        let mobility = 1.0 / bench.train.dyno_inertia_kg_m2 + 1.0 / bench.train.engine_inertia_kg_m2;
        let (natural, decay) =
            ((bench.train.stiffness_nm_per_rad * mobility).sqrt(), 0.5 * bench.train.damping_nm_s_per_rad * mobility);
        // An undriven second order: y_{k+2} = 2 e^{−δT} cos(ωT) y_{k+1} − e^{−2δT} y_k about its end, which a
        // difference takes away.
        let ahead = 4;
        let free: Vec<f64> = torque[60..].windows(2).map(|pair| pair[1] - pair[0]).collect();
        let time_s = 1e-3 * ahead as f64;
        let omega = (natural * natural - decay * decay).sqrt();
        let (first, second) = (2.0 * (-decay * time_s).exp() * (omega * time_s).cos(), (-2.0 * decay * time_s).exp());
        let largest = free.iter().fold(0.0_f64, |most, one| most.max(one.abs()));
        for k in 0..free.len() - 2 * ahead {
            let left = free[k + 2 * ahead] - first * free[k + ahead] + second * free[k];
            assert!(left.abs() < 1e-4 * largest, "bench {seed}, {k}: {left} of {largest}, {} Hz", omega / TAU);
        }
    }
}

#[test]
fn exact_the_engine_gives_the_torque_demanded() {
    for (seed, torque_nm, speed_rpm) in [(1, 20.0, 1000.0), (2, 60.0, 2500.0), (3, 150.0, 4500.0)] {
        let mut bench = quiet(seed);
        bench.drive.limit_nm = 1000.0;
        let demand = steady(Mode::Speed, speed_rpm * RPM, torque_nm, 6000);
        let truth = run(&bench, &demand, seed).truth;
        // Work over whole cycles.
        let cycle = 2.0 * TAU;
        let turned = truth.crank_angle_rad[5999] - truth.crank_angle_rad[0];
        let whole = (turned / cycle).floor() * cycle + truth.crank_angle_rad[0];
        let last = truth.crank_angle_rad.iter().rposition(|angle| *angle <= whole).unwrap();
        let given_nm = work_j(&truth.engine_torque_nm[..=last], &truth.engine_speed_rad_s[..=last])
            / (truth.crank_angle_rad[last] - truth.crank_angle_rad[0]);
        let span = truth.engine_torque_nm.iter().fold((0.0_f64, 0.0_f64), |(l, h), t| (l.min(*t), h.max(*t)));
        println!("{seed}: {given_nm} Nm of {torque_nm}, pulses {span:?}");
        assert!((given_nm - torque_nm).abs() < 0.01 * torque_nm + 0.3, "{given_nm} {torque_nm}");
        // T_shaft = T_d + friction in the mean.
        let shaft_nm = mean(&truth.shaft_torque_nm);
        let braked_nm = mean(&truth.air_gap_torque_nm) + mean(&truth.friction_nm);
        assert!((shaft_nm - braked_nm).abs() < 0.5, "{shaft_nm} {braked_nm}");
    }
}

/// The first harmonic of the firings is 0.5 to 4 times the mean torque of 60 Nm over the class, as those of passenger
/// cars' engines.
#[test]
fn prop_pulses_have_the_size_of_real_ones() {
    for seed in 0..12 {
        let bench = quiet(seed);
        let demand = steady(Mode::Speed, 1500.0 * RPM, 60.0, 4000);
        let truth = run(&bench, &demand, seed).truth;
        let order = 0.5 * bench.engine.cylinders.len() as f64;
        let (mut re, mut im) = (0.0, 0.0);
        for (angle, torque) in truth.crank_angle_rad.iter().zip(&truth.engine_torque_nm) {
            re += torque * (order * angle).cos();
            im += torque * (order * angle).sin();
        }
        let relative = 2.0 * f64::hypot(re, im) / 4000.0 / 60.0;
        println!("{seed}: {} cylinders, first harmonic {relative:.2} of the mean", bench.engine.cylinders.len());
        assert!((0.5..4.0).contains(&relative), "{relative}");
    }
}

#[test]
fn prop_drawn_benches_are_stable() {
    let seeds: Vec<u64> = (0..40).collect();
    let largest = numerics::parallel::map(&seeds, |seed| {
        let demand = Demand { speed_rad_s: vec![1500.0 * RPM; 1000], ..steady(Mode::Speed, 0.0, 60.0, 1000) };
        let truth = run(&draw(*seed), &demand, *seed).truth;
        let apart = |speed: &f64| (speed - 1500.0 * RPM).abs();
        truth.dyno_speed_rad_s.iter().map(apart).fold(0.0, f64::max) / RPM
    });
    assert!(largest.iter().all(|rpm| *rpm < 60.0), "{largest:?}");
}
