//! The virtual bench's modes, engine, sensors of a TB bench, clocks and streams.

use std::f64::consts::{PI, TAU};

use rig::bench_parameters::{BenchParameters, InductionMachine, PulseParameters};
use rig::experiment::{ExperimentPlan, Sine, TorqueTarget, Waveform};
use rig::facts::BenchVariant;
use units::RPM_RAD_S;
use virtual_bench::{Numerics, simulate, simulate_hidden};

use bench_testkit::runs::{amplitude, clean, mean, run, samples, smooth};

const FINE: Numerics = Numerics { steps_per_update: 20, steps_per_hidden_sample: Some(1) };

#[test]
fn exact_shaft_torque_control_reaches_its_demand() {
    for variant in [BenchVariant::LoadCell, BenchVariant::TorqueFlange] {
        let mut parameters = BenchParameters { variant, ..smooth() };
        parameters.mechanics.coulomb_friction_nm = 2.0;
        let mut plan = ExperimentPlan::step_t_tn(1200.0, 16.0);
        plan.torque_target = TorqueTarget::Shaft;
        plan.dyno_torque_nm = Waveform::Square { first: 60.0, second: 85.0, dwell_s: 8.0 };
        let run = run(&parameters, &plan, Numerics::default());
        let shaft = &run.hidden.shaft_torque_nm;
        let friction_nm = if variant == BenchVariant::TorqueFlange { 0.0 } else { 2.0 };
        // The system's own shaft torque is J_d dω_d/dt + T_d and knows no friction: it leaves that error.
        assert!((mean(&shaft[7900..8000]) - 60.0 - friction_nm).abs() < 0.1, "{}", mean(&shaft[7900..8000]));
        assert!((mean(&shaft[15_900..]) - 85.0 - friction_nm).abs() < 0.3, "{}", mean(&shaft[15_900..]));
        let demand = samples(&run.recording, "ShaftTorqueDemand");
        assert!(demand[0] == 60.0 && demand[15_000] == 85.0);
    }
}

#[test]
fn exact_shaft_torque_control_keeps_the_limit() {
    let mut parameters = smooth();
    parameters.drive.torque_limit_nm = 70.0;
    let mut plan = ExperimentPlan::step_t_tn(1200.0, 8.0);
    plan.torque_target = TorqueTarget::Shaft;
    plan.dyno_torque_nm = Waveform::Square { first: 60.0, second: 85.0, dwell_s: 4.0 };
    let run = run(&parameters, &plan, Numerics::default());
    let demand = samples(&run.recording, "DynoTorqueDemand");
    assert_eq!(demand.iter().copied().fold(0.0, f64::max), 70.0);
}

#[test]
fn exact_throttle_reaches_the_map_through_the_intake() {
    let mut parameters = smooth();
    parameters.engine.intake_lag_s = 0.2;
    let mut plan = ExperimentPlan::bs_t_nt(2000.0, 6.0);
    plan.throttle = Some(Waveform::Square { first: 0.1, second: 0.2, dwell_s: 3.0 });
    let run = run(&parameters, &plan, FINE);
    let torque = &run.hidden.engine_torque_nm;
    // At 2000 rpm, a column of the map: 55 and 120 Nm. A cylinder fires every 15 ms.
    assert!((torque[59_999] - 55.0).abs() < 0.5, "{}", torque[59_999]);
    assert!((torque[119_999] - 120.0).abs() < 0.5, "{}", torque[119_999]);
    for since_s in [0.1, 0.2, 0.4] {
        let found = torque[60_000 + (since_s / 5e-5) as usize];
        let at = |t: f64| 120.0 - 65.0 * (-t / 0.2_f64).exp();
        assert!((at(since_s - 0.0155) - 0.7..at(since_s) + 0.7).contains(&found), "{since_s} s: {found}");
    }
    let throttle = run.recording.channel("Throttle").expect("recorded");
    assert_eq!((throttle.unit.as_str(), throttle.samples[0], throttle.samples[1000]), ("%", 10.0, 20.0));
}

#[test]
fn exact_ignition_switches_from_one_firing_to_the_next() {
    let mut parameters = smooth();
    parameters.engine.intake_lag_s = 0.2;
    let mut plan = ExperimentPlan::bs_t_nt(1200.0, 4.0);
    plan.engine_torque_nm = Waveform::Constant { value: 60.0 };
    plan.ignition_efficiency = Waveform::RandomBinary { low: 0.7, high: 1.0, clock_s: 0.08 };
    let hidden = run(&parameters, &plan, FINE).hidden;
    // 60 − 0.3 (60 + 15.8) Nm, past the intake.
    let low = 60.0 - 0.3 * 75.8;
    assert!(hidden.engine_torque_nm.iter().all(|t| (t - low).abs() < 1e-9 || (t - 60.0).abs() < 1e-9));
    let switches: Vec<usize> = (1..hidden.engine_torque_nm.len())
        .filter(|k| hidden.engine_torque_nm[*k] != hidden.engine_torque_nm[k - 1])
        .collect();
    assert!(switches.len() > 15);
    let mut angle = vec![0.0];
    for pair in hidden.engine_speed_rad_s.windows(2) {
        angle.push(angle[angle.len() - 1] + 0.5 * (pair[0] + pair[1]) * 5e-5);
    }
    // Firings are π apart.
    for pair in switches.windows(2) {
        let turns = (angle[pair[1]] - angle[pair[0]]) / PI;
        assert!((turns - turns.round()).abs() < 0.01, "{turns}");
    }
}

#[test]
fn exact_cylinders_and_strokes_set_the_firing_frequency() {
    for (cylinders, strokes) in [(1, 4), (2, 2), (3, 4), (5, 4), (6, 4), (12, 4), (3, 2)] {
        let mut parameters = clean();
        parameters.engine.cylinder_factors = vec![1.0; cylinders];
        parameters.engine.strokes = strokes;
        parameters.engine.cycle_variation = 0.0;
        let mut plan = ExperimentPlan::bs_t_nt(1500.0, 10.0);
        plan.engine_torque_nm = Waveform::Constant { value: 20.0 };
        let hidden = run(&parameters, &plan, Numerics::default()).hidden;
        let firing_hz = 2.0 * cylinders as f64 / f64::from(strokes) * 25.0;
        let line = |f: f64| amplitude(&hidden.engine_torque_nm, 1e-3, f);
        assert!((line(firing_hz) - 40.0).abs() < 4.0, "{cylinders}, {strokes}: {}", line(firing_hz));
        assert!(line(0.73 * firing_hz) < 0.5, "{cylinders}, {strokes}");
    }
}

#[test]
fn exact_flange_reads_the_shaft_and_nothing_without_one() {
    let mut parameters = BenchParameters { variant: BenchVariant::TorqueFlange, ..smooth() };
    parameters.clocks.torque_decimation = 1;
    let mut plan = ExperimentPlan::sine_t_tn(1200.0, 4.0);
    plan.dyno_torque_nm = Waveform::SineLadder { mean: 60.0, amplitude: 2.0, frequencies_hz: vec![18.0], dwell_s: 4.0 };
    let with = run(&parameters, &plan, FINE);
    let names: Vec<&str> = with.recording.channels.iter().map(|c| c.name.as_str()).collect();
    let expected =
        ["DynoSpeed", "DynoTorqueDemand", "DynoSpeedDemand", "EngineSpeed", "DynoTorqueCalc", "FlangeTorque"];
    assert_eq!(names, expected);
    // Late by its delay and by 2ζ/ω_0 of its filter.
    let late_s = 0.0005 + 2.0 * 0.87 / (TAU * 1000.0);
    let steps = (late_s / 5e-5_f64).round() as usize;
    for (k, reading) in samples(&with.recording, "FlangeTorque").iter().enumerate().skip(1000) {
        assert!((reading - with.hidden.shaft_torque_nm[20 * k - steps]).abs() < 0.05, "{k}: {reading}");
    }
    let without = simulate(&parameters, &ExperimentPlan::no_shaft_n_nt(1200.0, 1.0), 7).expect("runs");
    assert!(samples(&without, "FlangeTorque").iter().all(|t| *t == 0.0));
}

#[test]
fn exact_inverter_errs_with_temperature_and_adapts_to_the_load_cell() {
    let mut parameters = smooth();
    parameters.drive.knowledge.cold_error = 0.03;
    parameters.drive.knowledge.error_per_k = 0.002;
    parameters.drive.knowledge.thermal_time_s = 20.0;
    let mut plan = ExperimentPlan::step_t_tn(1200.0, 40.0);
    plan.settling_s = 0.0;
    plan.dyno_torque_nm = Waveform::Constant { value: 60.0 };
    let ratio = |parameters: &BenchParameters| {
        let run = run(parameters, &plan, Numerics::default());
        let calc = samples(&run.recording, "DynoTorqueCalc");
        (0..calc.len()).map(|k| run.hidden.air_gap_torque_nm[4 * k] / calc[k]).collect::<Vec<f64>>()
    };
    let drifts = ratio(&parameters);
    // The torque is that of the machine: about (60 · 1.05)² on the way, 0.005 K/(Nm)².
    for (k, found) in drifts.iter().enumerate().step_by(500) {
        let warm =
            |torque_nm: f64| 1.03 + 0.002 * 0.005 * torque_nm * torque_nm * (1.0 - (-0.004 * k as f64 / 20.0).exp());
        assert!((warm(61.8) - 1e-9..warm(64.5) + 1e-9).contains(found), "{k}: {found}");
    }
    parameters.drive.knowledge.adaptation_time_s = 2.0;
    let adapts = ratio(&parameters);
    assert!((adapts[0] - 1.03).abs() < 1e-9 && (adapts[9999] - 1.0).abs() < 0.003, "{} {}", adapts[0], adapts[9999]);
    // A flange says nothing of the air-gap torque.
    let no_cell = ratio(&BenchParameters { variant: BenchVariant::TorqueFlange, ..parameters });
    assert_eq!(no_cell, drifts);
}

#[test]
fn exact_drift_stretches_the_stamps_only() {
    let plan = ExperimentPlan::step_t_tn(1200.0, 1.0);
    let plain = simulate(&BenchParameters::default(), &plan, 5).expect("runs");
    let mut parameters = BenchParameters::default();
    parameters.clocks.torque_drift = 2e-5;
    parameters.clocks.engine_speed_drift = -1e-4;
    let drifting = simulate(&parameters, &plan, 5).expect("runs");
    assert_eq!(plain.channels, drifting.channels);
    let last = |raster: usize| drifting.rasters[raster].time_s.last().copied().expect("samples");
    assert!((last(1) - 0.998 * (1.0 - 1e-4)).abs() < 1e-12 && (last(2) - 0.996 * (1.0 + 2e-5)).abs() < 1e-12);
}

#[test]
fn exact_one_source_of_noise_leaves_the_others_alone() {
    let mut plan = ExperimentPlan::white_noise_t_tn(1200.0, 1.0);
    let run = |parameters: &BenchParameters, plan: &ExperimentPlan| simulate(parameters, plan, 5).expect("runs");
    let plain = run(&BenchParameters::default(), &plan);
    let mut parameters = BenchParameters::default();
    parameters.sensors.cell_noise_nm = 0.5;
    parameters.sensors.calc_noise_nm = 0.0;
    let other = run(&parameters, &plan);
    for name in ["DynoSpeed", "EngineSpeed", "DynoTorqueDemand"] {
        assert_eq!(samples(&plain, name), samples(&other, name), "{name}");
    }
    assert_ne!(samples(&plain, "DynoTorqueMeas"), samples(&other, "DynoTorqueMeas"));
    // A random demand that this mode does not use changes nothing.
    plan.engine_torque_nm = Waveform::WhiteNoise { mean: 0.0, standard_deviation: 5.0 };
    assert_eq!(run(&BenchParameters::default(), &plan).channels, plain.channels);
}

#[test]
fn exact_demands_of_ones_own_are_played() {
    let mut plan = ExperimentPlan::step_t_tn(1200.0, 1.0);
    plan.dyno_torque_nm = Waveform::Sampled { sample_time_s: 0.1, values: vec![60.0, 61.0, 64.0] };
    let parameters = clean();
    let recording = simulate(&parameters, &plan, 1).expect("runs");
    let demand = samples(&recording, "DynoTorqueDemand");
    assert_eq!((demand[99], demand[100], demand[200], demand[999]), (60.0, 61.0, 64.0, 64.0));
    let sines = vec![Sine { frequency_hz: 5.0, amplitude: 3.0, phase_rad: 0.4 }];
    plan.dyno_torque_nm = Waveform::Multisine { mean: 60.0, sines };
    let recording = simulate(&parameters, &plan, 1).expect("runs");
    let demand = samples(&recording, "DynoTorqueDemand");
    assert!((demand[130] - 60.0 - 3.0 * (TAU * 5.0 * 0.13 + 0.4).cos()).abs() < 1e-9);
}

#[test]
fn exact_plans_survive_toml() {
    let mut plan = ExperimentPlan::levels_n_nt(1200.0, 5.0);
    plan.throttle = Some(Waveform::Constant { value: 0.2 });
    plan.torque_target = TorqueTarget::Shaft;
    let text = toml::to_string(&plan).expect("serialises");
    assert_eq!(toml::from_str::<ExperimentPlan>(&text).expect("parses"), plan);
    let bench = BenchParameters::torque_flange();
    let text = toml::to_string(&bench).expect("serialises");
    assert_eq!(toml::from_str::<BenchParameters>(&text).expect("parses"), bench);
    assert!(simulate_hidden(&bench, &plan, 1, Numerics::default()).is_ok());
    assert!((virtual_bench::Truth::of(&bench).stiffness_nm_per_rad - 2437.7).abs() < 1e-9);
}

/// The default bench's torque_control with an induction machine in place of the lag.
fn with_machine() -> BenchParameters {
    let mut parameters = smooth();
    parameters.drive.machine = Some(InductionMachine::default());
    parameters
}

#[test]
fn exact_machine_follows_its_demand_with_the_bandwidth_of_its_currents() {
    let mut plan = ExperimentPlan::step_t_tn(1200.0, 3.0);
    plan.dyno_torque_nm = Waveform::Square { first: 60.0, second: 85.0, dwell_s: 2.0 };
    let torque = run(&with_machine(), &plan, FINE).hidden.air_gap_torque_nm;
    assert!((torque[39_990] - 60.0).abs() < 0.1 && (torque[59_990] - 85.0).abs() < 0.1, "{}", torque[59_990]);
    let rises_s = |level: f64| torque[40_000..].iter().position(|t| *t > level).expect("rises") as f64 * 5e-5;
    // 1.25 ms on the way, a sample of the control, and ln 2 of 1/(2π 120 Hz); 10 to 90 % in 2.2/(2π 120 Hz) = 2.9 ms,
    // or sooner, as the sample's delay takes damping from the loop.
    assert!((rises_s(72.5) - 0.00242).abs() < 0.0004, "{}", rises_s(72.5));
    assert!((0.0014..0.0032).contains(&(rises_s(82.5) - rises_s(62.5))), "{} {}", rises_s(62.5), rises_s(82.5));
    let highest = torque[40_000..].iter().copied().fold(0.0, f64::max);
    assert!(highest < 87.5, "{highest}");
}

#[test]
fn exact_machine_runs_out_of_voltage_above_its_base_speed() {
    let mut parameters = with_machine();
    parameters.drive.torque_limit_nm = 1000.0;
    let most_nm = |speed_rpm: f64| {
        let mut plan = ExperimentPlan::step_t_tn(speed_rpm, 0.2);
        plan.is_motored = true;
        plan.settling_s = 0.5;
        plan.dyno_torque_nm = Waveform::Square { first: -15.8, second: -700.0, dwell_s: 0.05 };
        let hidden = run(&parameters, &plan, Numerics::default()).hidden;
        hidden.air_gap_torque_nm.iter().copied().fold(0.0, f64::min).abs()
    };
    // At rated flux, i_q of √(350² − 100²) A.
    let rated_nm = 1.5 * 2.0 * (5.0 / 5.15) * 0.5 * (350.0_f64.powi(2) - 100.0_f64.powi(2)).sqrt();
    let (slow, fast) = (most_nm(1000.0), most_nm(6000.0));
    println!("{slow} Nm at 1000 rpm, {fast} Nm at 6000 rpm; rated {rated_nm} Nm");
    assert!((slow / rated_nm - 1.0).abs() < 0.06, "{slow}, {rated_nm}");
    assert!(fast < 0.75 * slow && fast > 0.2 * slow, "{fast}, {slow}");
}

#[test]
fn exact_machine_converges_with_the_square_of_the_step() {
    let mut parameters = clean();
    parameters.drive.machine = Some(InductionMachine::default());
    let mut plan = ExperimentPlan::white_noise_t_tn(1200.0, 1.0);
    plan.settling_s = 0.0;
    let hidden = |n| run(&parameters, &plan, Numerics { steps_per_update: n, steps_per_hidden_sample: Some(n) }).hidden;
    let runs = [20, 40, 80].map(hidden);
    let error = |coarse: usize| {
        let pairs = runs[coarse].shaft_torque_nm.iter().zip(&runs[coarse + 1].shaft_torque_nm);
        pairs.map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    };
    println!("machine: {:e} Nm, halved {:e} Nm", error(0), error(1));
    assert!((2.8..6.0).contains(&(error(0) / error(1))), "{} {}", error(0), error(1));
    let steps = Numerics { steps_per_update: 10, steps_per_hidden_sample: Some(10) };
    assert!(simulate_hidden(&parameters, &plan, 1, steps).is_err(), "10 steps are no whole number for each sample");
}

/// Speeds of a smooth bench read by pulses, and as they are on the mean of the gate, both in rad/s.
fn pulses(pulses: PulseParameters, speed_rpm: f64) -> (Vec<f64>, Vec<f64>) {
    let mut parameters = smooth();
    let mut plan = ExperimentPlan::bs_t_nt(speed_rpm, 2.0);
    plan.engine_torque_nm = Waveform::Constant { value: 45.0 };
    // Motionless but for the turning: the controller gets nothing to act on.
    parameters.controller.proportional_nm_s_per_rad = 0.0;
    parameters.controller.integral_nm_per_rad = 0.0;
    let speeds = |parameters: &BenchParameters| {
        let run = run(parameters, &plan, Numerics::default());
        samples(&run.recording, "DynoSpeed").iter().map(|n| n * RPM_RAD_S).collect::<Vec<f64>>()
    };
    let mean = speeds(&parameters);
    parameters.sensors.pulses = Some(pulses);
    (speeds(&parameters), mean)
}

#[test]
fn exact_perfect_pulses_at_a_steady_speed_read_it() {
    let perfect = PulseParameters { slit_error_rad: 0.0, edge_jitter_rad: 0.0, timer_hz: 0.0, slits: 1024 };
    for speed_rpm in [150.0, 1200.0, 3000.0] {
        let (read, mean) = pulses(perfect, speed_rpm);
        for (k, (read, mean)) in read.iter().zip(&mean).enumerate() {
            assert!((read - mean).abs() < 1e-6 * mean, "{speed_rpm} rpm, {k}: {read}, {mean}");
        }
    }
}

#[test]
fn stat_pulses_err_by_slits_jitter_and_timer() {
    let deviation = |p: PulseParameters| {
        let (read, mean) = pulses(p, 1200.0);
        (read.iter().zip(&mean).map(|(r, m)| (r - m).powi(2)).sum::<f64>() / read.len() as f64).sqrt()
    };
    let none = PulseParameters { slit_error_rad: 0.0, edge_jitter_rad: 0.0, timer_hz: 0.0, slits: 1024 };
    // Two places that err, over 1 ms.
    let jitter = deviation(PulseParameters { edge_jitter_rad: 2e-5, ..none });
    let expected = 2e-5 * 2f64.sqrt() / 1e-3;
    assert!((jitter / expected - 1.0).abs() < 0.1, "{jitter}, {expected}");
    let slits = deviation(PulseParameters { slit_error_rad: 2e-5, ..none });
    assert!((slits / expected - 1.0).abs() < 0.15, "{slits}, {expected}");
    // A timer of 1 MHz: ω · 1 µs/√12 · √2 over 1 ms.
    let timer = deviation(PulseParameters { timer_hz: 1e6, ..none });
    let expected = 40.0 * PI * 1e-6 / 12f64.sqrt() * 2f64.sqrt() / 1e-3;
    assert!((timer / expected - 1.0).abs() < 0.25, "{timer}, {expected}");
}
