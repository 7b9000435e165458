//! The virtual bench's slider-crank engine against the formulas of mechanics, and its step error.

use std::f64::consts::TAU;

use rig::bench_parameters::{BenchParameters, SliderCrank};
use rig::experiment::{ExperimentPlan, Waveform};
use units::RPM_RAD_S;
use virtual_bench::Numerics;

use bench_testkit::runs::{amplitude, clean, mean, run};

fn cranked(cylinders: usize) -> BenchParameters {
    let mut parameters = clean();
    parameters.engine.slider_crank = Some(SliderCrank::default());
    parameters.engine.cylinder_factors = vec![1.0; cylinders];
    parameters.engine.cycle_variation = 0.0;
    parameters
}

fn steady(speed_rpm: f64, level_nm: f64) -> ExperimentPlan {
    let mut plan = ExperimentPlan::bs_t_nt(speed_rpm, 8.0);
    plan.engine_torque_nm = Waveform::Constant { value: level_nm };
    plan
}

#[test]
fn exact_gas_gives_the_level_on_average() {
    for (cylinders, strokes) in [(4, 4), (1, 4), (3, 2), (12, 4)] {
        let mut parameters = cranked(cylinders);
        parameters.engine.strokes = strokes;
        for level_nm in [20.0, 60.0] {
            let hidden = run(&parameters, &steady(1500.0, level_nm), Numerics::default()).hidden;
            let found = mean(&hidden.engine_torque_nm);
            assert!((found - level_nm).abs() < 0.05 * level_nm, "{cylinders}, {strokes}: {found}, {level_nm}");
            // What goes in comes out: the air-gap torque is the same on average.
            assert!((mean(&hidden.air_gap_torque_nm) - found).abs() < 0.5, "{}", mean(&hidden.air_gap_torque_nm));
        }
    }
}

#[test]
fn exact_motored_engine_drags_with_its_torque_and_compresses() {
    let mut plan = steady(1200.0, 0.0);
    plan.is_motored = true;
    let hidden = run(&cranked(4), &plan, Numerics::default()).hidden;
    assert!((mean(&hidden.engine_torque_nm) + 15.8).abs() < 0.5, "{}", mean(&hidden.engine_torque_nm));
    let line = |hz| amplitude(&hidden.engine_torque_nm, 1e-3, hz);
    assert!(line(40.0) > 5.0 && line(20.0) < 0.5, "{} {}", line(40.0), line(20.0));
}

#[test]
fn exact_masses_pull_as_the_slider_crank_says() {
    // One cylinder with hardly any gas on a crankshaft too heavy to change its speed.
    let mut parameters = cranked(1);
    let crank = SliderCrank { bore_m: 1e-4, ..SliderCrank::default() };
    parameters.engine.slider_crank = Some(crank);
    parameters.mechanics.engine_inertia_kg_m2 = 100.0;
    parameters.engine.motored_torque_nm = 0.0;
    let mut plan = steady(3000.0, 0.0);
    plan.is_motored = true;
    let hidden = run(&parameters, &plan, Numerics::default()).hidden;
    let size = 0.5 * (0.5 * 0.0945_f64).powi(2) * (3000.0 * RPM_RAD_S).powi(2);
    // m r²ω² (λ/4 sin θ − ½ sin 2θ − ¾λ sin 3θ), up to λ².
    for (order, part) in [(1.0, 0.3 / 4.0), (2.0, 0.5), (3.0, 0.75 * 0.3)] {
        let line = amplitude(&hidden.engine_torque_nm, 1e-3, 50.0 * order);
        assert!((line / size / part - 1.0).abs() < 0.04, "order {order}: {} of {part}", line / size);
    }
    assert!(mean(&hidden.engine_torque_nm).abs() < 1e-3 * size);
}

#[test]
fn exact_slider_crank_converges_with_the_square_of_the_step() {
    let mut parameters = cranked(4);
    parameters.engine.cylinder_factors = vec![1.0, 0.93, 1.05, 0.98];
    let mut plan = steady(1200.0, 45.0);
    (plan.duration_s, plan.settling_s) = (1.0, 0.0);
    let runs = [20, 40, 80]
        .map(|n| run(&parameters, &plan, Numerics { steps_per_update: n, steps_per_hidden_sample: Some(n) }));
    let error = |coarse: usize| {
        let pairs = runs[coarse].hidden.shaft_torque_nm.iter().zip(&runs[coarse + 1].hidden.shaft_torque_nm);
        pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    };
    println!("slider crank: {:e} Nm, halved {:e} Nm", error(0), error(1));
    assert!((2.8..6.0).contains(&(error(0) / error(1))), "{} {}", error(0), error(1));
    assert!(error(0) < 0.02, "{} Nm", error(0));
}

#[test]
fn exact_firing_lines_of_the_slider_crank_follow_the_speed() {
    for speed_rpm in [1200.0, 3000.0] {
        let hidden = run(&cranked(4), &steady(speed_rpm, 45.0), Numerics::default()).hidden;
        let line = |hz: f64| amplitude(&hidden.engine_torque_nm, 1e-3, hz);
        let strongest = (5..300).map(f64::from).max_by(|a, b| line(*a).total_cmp(&line(*b)));
        assert_eq!(strongest, Some(2.0 * speed_rpm / 60.0), "{speed_rpm} rpm");
        assert!(line(speed_rpm / 30.0) > 40.0, "{}", line(speed_rpm / TAU));
    }
}
