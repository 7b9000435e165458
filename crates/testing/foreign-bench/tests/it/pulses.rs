//! The firing pulses that a study finds, beside those of the other simulator's engine.

use std::f64::consts::TAU;

use foreign_bench::{Bench, Mode, run};
use numerics::parallel;
use rig::engine_pulses::EnginePulses;

use crate::known::Known;
use crate::support::{RPM, drawn, mean, steady};

/// Length of a run at constant demands, ms.
const RUN_MS: usize = 6000;

/// Amplitudes of the first harmonics of the working cycle at a torque and a speed: those of T_shaft + J_e dω_e/dt over
/// the crank's angle.
fn true_waves_nm(bench: &Bench, count: usize, (torque_nm, speed_rad_s): (f64, f64)) -> Vec<f64> {
    let truth = run(bench, &steady(Mode::Speed, speed_rad_s, torque_nm, RUN_MS), 1).truth;
    let angle = &truth.crank_angle_rad;
    let last = angle[1] + 2.0 * TAU * ((angle[RUN_MS - 2] - angle[1]) / (2.0 * TAU)).floor();
    let inside: Vec<usize> = (1..RUN_MS - 1).take_while(|k| angle[*k] < last).collect();
    let wave = |values: &[f64], m: usize| {
        let middle = mean(values);
        let part = |k: &usize| {
            let (step, phase) = (0.5 * (angle[k + 1] - angle[k - 1]), 0.5 * m as f64 * angle[*k]);
            let value = values[*k] - middle;
            [value * phase.cos() * step, -value * phase.sin() * step, step]
        };
        let sum = inside.iter().map(part).fold([0.0; 3], |sum, one| std::array::from_fn(|i| sum[i] + one[i]));
        [2.0 * sum[0] / sum[2], 2.0 * sum[1] / sum[2]]
    };
    let of = |m: usize| {
        let (shaft, speed) = (wave(&truth.shaft_torque_nm, m), wave(&truth.engine_speed_rad_s, m));
        let inertia = 0.5 * m as f64 * speed_rad_s * bench.train.engine_inertia_kg_m2;
        (shaft[0] - inertia * speed[1]).hypot(shaft[1] + inertia * speed[0])
    };
    (1..=count).map(of).collect()
}

/// Of each harmonic: its number, the amplitude found, its standard error and the true one, Nm.
fn compared(pulses: &EnginePulses, bench: &Bench, at: (f64, f64)) -> Vec<(usize, [f64; 3])> {
    let truth = true_waves_nm(bench, pulses.harmonics.len(), at);
    let one = |(harmonic, truth): (&rig::engine_pulses::PulseHarmonic, f64)| {
        [harmonic.value.at(at.0, at.1).norm(), harmonic.standard_error_nm(at.0, at.1), truth]
    };
    (1..).zip(pulses.harmonics.iter().zip(truth).map(one)).collect()
}

fn found(seed: u64) -> Option<(Known, EnginePulses)> {
    let known = Known::of(seed);
    let pulses = known.study.model.as_ref()?.engine_pulses.clone()?;
    Some((known, pulses))
}

#[test]
fn stat_pulses_of_the_other_engine_are_found_and_stay_uncertain_where_nothing_shows_them() {
    let (known, pulses) = found(7).unwrap();
    let cylinders = known.bench.engine.cylinders.len();
    for torque_nm in [60.0, 160.0] {
        let at = (torque_nm, known.speed_rad_s + 150.0 * RPM);
        for (m, [amplitude, error, truth]) in compared(&pulses, &known.bench, at) {
            println!("{torque_nm} Nm, {m}: {amplitude:.2} ± {error:.2} Nm, true {truth:.2}");
            assert!((amplitude - truth).abs() < 3.5 * error, "{m}: {amplitude} ± {error}, {truth}");
            let most = if torque_nm < 100.0 { 0.05 } else { 0.2 };
            assert!(m != cylinders || error < most * amplitude, "{m}: {amplitude} ± {error}");
        }
    }
}

#[test]
#[ignore = "slow: 40 studies"]
fn stat_pulses_of_other_engines_are_within_their_errors() {
    let all = parallel::map(&drawn(40, 60_000), |seed| {
        let Some((known, pulses)) = found(*seed) else { return Vec::new() };
        let cylinders = known.bench.engine.cylinders.len();
        let mut off = Vec::new();
        for torque_nm in [30.0, 60.0, 160.0] {
            for (m, [amplitude, error, truth]) in
                compared(&pulses, &known.bench, (torque_nm, known.speed_rad_s + 400.0 * RPM))
            {
                println!(
                    "bench {seed}, {cylinders} cylinders, {torque_nm} Nm, {m}: {amplitude:.2} ± {error:.2} Nm, true {truth:.2}"
                );
                off.push((torque_nm, m == cylinders, (amplitude - truth) / error));
            }
        }
        off
    });
    let off: Vec<_> = all.into_iter().flatten().collect();
    for (torque_nm, is_firing) in [30.0, 60.0, 160.0].into_iter().flat_map(|torque| [(torque, true), (torque, false)]) {
        let those: Vec<f64> =
            off.iter().filter(|one| (one.0, one.1) == (torque_nm, is_firing)).map(|one| one.2).collect();
        let far = those.iter().filter(|off| off.abs() > 2.0).count();
        println!("{torque_nm} Nm, firing order {is_firing}: {far} of {} beyond two standard errors", those.len());
        // Amplitudes are no normal numbers, and those of one bench go together.
        assert!(far as f64 <= 0.1 * those.len() as f64 + 2.0, "{torque_nm} Nm: {far} of {}", those.len());
    }
}
