//! Firing pulses of a cycle, which is simulated in stretches, against those of a plan that is simulated as a whole.

use capability::{CanInputs, CycleDemand, Demand, LimitOf, can};
use cycle::Reference;
use design::safety::{BenchSpread, Prior};
use rig::bench_parameters::CycleHarmonic;
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan, Waveform};
use units::RPM_RAD_S;

use crate::support::{Bench, bench};

/// Length of the runs, s.
const DURATION_S: f64 = 8.0;

/// Quantities that pulses move.
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
    let verdict = can(&inputs, &work::Context::new()).unwrap();
    MOVED.map(|of| verdict.limits.iter().find(|one| one.of == of).unwrap().values.quantile(0.5))
}

/// Largest values of a cycle and of a plan from one speed, rpm, straight to another.
fn both(from: f64, to: f64) -> ([f64; MOVED.len()], [f64; MOVED.len()]) {
    both_of(&bench(), 80.0, (from, to))
}

fn both_of(bench: &Bench, torque: f64, (from, to): (f64, f64)) -> ([f64; MOVED.len()], [f64; MOVED.len()]) {
    let speed = |k: f64| (from + k * (to - from)) * RPM_RAD_S;
    let seconds = (0..=DURATION_S as usize).map(|k| speed(k as f64 / DURATION_S)).collect();
    let reference = Reference::of_itself(0.0, seconds, vec![torque; DURATION_S as usize + 1]);
    let of_cycle = peaks(bench, Demand::Cycle(CycleDemand { reference: &reference, map: None }));
    let each = (0..(DURATION_S * 1e3) as usize).map(|k| speed(k as f64 * 1e-3 / DURATION_S)).collect();
    let plan = ExperimentPlan {
        speed_rad_s: Waveform::Sampled { sample_time_s: 1e-3, values: each },
        engine_torque_nm: Waveform::Constant { value: torque },
        ..ExperimentPlan::levels_n_nt(from, DURATION_S)
    };
    (of_cycle, peaks(bench, Demand::Plan(&plan, &Demands::of(&plan, 1, DEMAND_HOLD_S))))
}

/// Firings vary, and two runs of some seconds have other strong ones.
fn assert_alike(what: &str, part: f64, (of_cycle, of_plan): ([f64; MOVED.len()], [f64; MOVED.len()])) {
    for ((of, of_cycle), of_plan) in MOVED.into_iter().zip(of_cycle).zip(of_plan) {
        println!("{what}, {of:?}: plan {of_plan:.1}, cycle over it {:.3}", of_cycle / of_plan);
        // Away from the resonance, changes are those of single strong firings.
        let slack = match of {
            LimitOf::SpeedGradient => 3.0,
            LimitOf::TorqueSlew => 100.0,
            _ => 0.0,
        };
        assert!((of_cycle - of_plan).abs() < part * of_plan + slack, "{what}, {of:?}: {of_cycle} against {of_plan}");
    }
}

#[test]
fn ref_a_cycle_at_one_speed_has_the_largest_values_of_a_plan() {
    for rpm in [700.0, 900.0, 1100.0, 1500.0, 2000.0, 3000.0, 4500.0] {
        assert_alike(&format!("{rpm} rpm"), 0.08, both(rpm, rpm));
    }
}

/// A bench whose engine has compression without load, gas torque, and masses in one harmonic: what they add is not
/// proportional to the torque.
pub(crate) fn bench_with_compression() -> Bench {
    let mut bench = bench();
    bench.engine.cycle_variation = 0.0;
    bench.engine.cycle_harmonics = vec![CycleHarmonic::default(); 4];
    bench.engine.cycle_harmonics[0].of_torque = [0.05, 0.0];
    bench.engine.cycle_harmonics[3] =
        CycleHarmonic { unloaded_nm: [-60.0, 40.0], of_torque: [1.2, 0.5], of_speed_nm_s2: [8e-4, 0.0] };
    bench
}

#[test]
fn ref_the_same_holds_where_pulses_do_not_grow_with_the_torque_alone() {
    let bench = bench_with_compression();
    for (torque, rpm) in [(0.0, 1200.0), (50.0, 1200.0), (120.0, 2500.0)] {
        assert_alike(&format!("{torque} Nm, {rpm} rpm"), 0.08, both_of(&bench, torque, (rpm, rpm)));
    }
}

/// Pulses that could come of a resonance that is held do not come of one that is passed. What comes depends on where a
/// firing meets it.
#[test]
fn ref_a_resonance_that_a_cycle_passes_gives_what_it_gives_a_plan() {
    assert_alike("passed", 0.15, both(450.0, 1200.0));
}
