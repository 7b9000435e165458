//! The bound of the firing pulses, which cycles and the map take, against pulses that are simulated.

use capability::{CanInputs, CycleDemand, Demand, LimitOf, can};
use cycle::Reference;
use design::safety::{BenchSpread, Prior};
use rig::bench_parameters::CycleHarmonic;
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan, Waveform};
use units::RPM_RAD_S;

use crate::support::{Bench, bench};

/// Length of the runs, s.
const DURATION_S: f64 = 8.0;

/// What pulses move.
const MOVED: [LimitOf; 7] = [
    LimitOf::ShaftTorque,
    LimitOf::ShaftTorqueSlew,
    LimitOf::TorqueDemand,
    LimitOf::TorqueSlew,
    LimitOf::Speed,
    LimitOf::SpeedGradient,
    LimitOf::Power,
];

/// The largest value of each on the nominal bench.
fn peaks(bench: &Bench, demand: Demand<'_>) -> [f64; MOVED.len()] {
    let nominal = Prior { resonance: 0.0, damping: 0.0, engine_inertia: 0.0 };
    let inputs = CanInputs { spread: BenchSpread::Prior(nominal), samples: 1, ..bench.inputs(demand) };
    let verdict = can(&inputs, &|_, _| {}).unwrap();
    MOVED.map(|of| verdict.limits.iter().find(|one| one.of == of).unwrap().values.quantile(0.5))
}

/// Bound and simulation of a run from one speed, rpm, straight to another.
fn both(from: f64, to: f64) -> ([f64; MOVED.len()], [f64; MOVED.len()]) {
    both_of(&bench(), 80.0, (from, to))
}

fn both_of(bench: &Bench, torque: f64, (from, to): (f64, f64)) -> ([f64; MOVED.len()], [f64; MOVED.len()]) {
    let speed = |k: f64| (from + k * (to - from)) * RPM_RAD_S;
    let seconds = (0..=DURATION_S as usize).map(|k| speed(k as f64 / DURATION_S)).collect();
    let reference = Reference::of_itself(0.0, seconds, vec![torque; DURATION_S as usize + 1]);
    let bound = peaks(bench, Demand::Cycle(CycleDemand { reference: &reference, map: None }));
    let each = (0..(DURATION_S * 1e3) as usize).map(|k| speed(k as f64 * 1e-3 / DURATION_S)).collect();
    let plan = ExperimentPlan {
        speed_rad_s: Waveform::Sampled { sample_time_s: 1e-3, values: each },
        engine_torque_nm: Waveform::Constant { value: torque },
        ..ExperimentPlan::levels_n_nt(from, DURATION_S)
    };
    (bound, peaks(bench, Demand::Plan(&plan, &Demands::of(&plan, 1, DEMAND_HOLD_S))))
}

#[test]
fn ref_the_bound_of_pulses_is_what_a_speed_that_is_held_gives() {
    for rpm in [700.0, 900.0, 1100.0, 1500.0, 2000.0, 3000.0, 4500.0] {
        let (bound, simulated) = both(rpm, rpm);
        for ((of, bound), simulated) in MOVED.into_iter().zip(bound).zip(simulated) {
            let ratio = bound / simulated;
            println!("{rpm} rpm, {of:?}: {simulated:.1}, bound over it {ratio:.3}");
            // Away from the resonance, changes are those of single strong firings, of which there is a bound alone.
            let slack = match of {
                LimitOf::SpeedGradient => 6.0,
                LimitOf::TorqueSlew => 200.0,
                _ => 0.0,
            };
            assert!(ratio > 0.97 && bound < 1.1 * simulated + slack, "{rpm} rpm, {of:?}: {bound} against {simulated}");
        }
    }
}

/// A bench whose engine has compression without load, gas torque, and masses in one harmonic: what they add is not proportional to the torque.
fn bench_with_compression() -> Bench {
    let mut bench = bench();
    bench.engine.cycle_variation = 0.0;
    bench.engine.cycle_harmonics = vec![CycleHarmonic::default(); 4];
    bench.engine.cycle_harmonics[0].of_torque = [0.05, 0.0];
    bench.engine.cycle_harmonics[3] =
        CycleHarmonic { unloaded_nm: [-60.0, 40.0], of_torque: [1.2, 0.5], of_speed_nm_s2: [8e-4, 0.0] };
    bench
}

#[test]
fn ref_the_bound_holds_where_pulses_do_not_grow_with_the_torque_alone() {
    let bench = bench_with_compression();
    for (torque, rpm) in [(0.0, 1200.0), (50.0, 1200.0), (120.0, 2500.0)] {
        let (bound, simulated) = both_of(&bench, torque, (rpm, rpm));
        println!("{torque} Nm, {rpm} rpm: {simulated:.1?}, bound {bound:.1?}");
        assert!((0.97..1.1).contains(&(bound[0] / simulated[0])), "{torque} Nm: {bound:.1?} against {simulated:.1?}");
    }
}

/// A test with a high torque somewhere makes no larger pulses elsewhere.
#[test]
fn ref_the_bound_is_close_far_below_the_largest_torque() {
    let bench = bench_with_compression();
    let speed_rad_s = 1200.0 * RPM_RAD_S;
    let of_torques = |torques: Vec<f64>| {
        let reference = Reference::of_itself(0.0, vec![speed_rad_s; torques.len()], torques);
        peaks(&bench, Demand::Cycle(CycleDemand { reference: &reference, map: None }))
    };
    let steady = of_torques(vec![-50.0; 9]);
    // The torque of the dynamometer brakes less than the pulses pull: the largest T_shaft is that at -50 Nm.
    let ramped = of_torques(vec![-50.0, -50.0, -50.0, -50.0, -40.0, -30.0, -20.0, -10.0, 0.0]);
    assert!((ramped[0] / steady[0] - 1.0).abs() < 0.05, "{ramped:.1?} for {steady:.1?}");
}

#[test]
fn ref_a_resonance_that_is_passed_gives_no_more_than_the_bound() {
    let (bound, simulated) = both(450.0, 1200.0);
    for ((of, bound), simulated) in MOVED.into_iter().zip(bound).zip(simulated) {
        println!("passed, {of:?}: {simulated:.1}, bound {bound:.1}");
        assert!(bound > 0.97 * simulated, "{of:?}: {bound} against {simulated}");
    }
}
