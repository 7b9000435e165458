use part_torque::timing::estimate;
use part_torque::torque_control;
use rig::estimation::EstimateError;
use rig::results::SignalDelay;
use rig::{Experiment, Role};
use signal::Signal;

use bench_testkit::torque_bench::{Noise, TRUTH, Truth, lagged, rippled, white_noise};

const INERTIA: f64 = 0.6;
const CELL_DELAY_S: f64 = 8e-3;
const CELL_NATURAL_RAD_S: f64 = 471.24;
const CELL_DAMPING: f64 = 0.25;

/// Adds a load cell, a free-spinning dynamometer's N_d, and the system's shaft torque with its average over 16 samples.
fn with_all_torques(truth: Truth) -> Experiment {
    let mut e = white_noise(truth, 4);
    let demand = e.signals[&Role::DynoTorqueDemand].clone();
    let calc = e.signals[&Role::AirGapTorque].clone();
    let fine_s = 5e-5;
    let count = (truth.duration_s / fine_s) as usize;
    let times: Vec<f64> = (0..count).map(|i| truth.start_s + fine_s * i as f64).collect();
    let smooth = lagged(&demand, truth.delay_s, truth.lag_rad_s, &times);
    let torque: Vec<f64> = smooth.iter().zip(&times).map(|(m, t)| rippled(*m, truth.ripple_hz, *t)).collect();
    let cell = load_cell(&torque, fine_s);
    let mut noise = Noise::new(8);
    let cell = cell.iter().step_by(80).map(|v| v + truth.noise_nm * noise.normal()).collect();
    let mut speed = 0.0;
    let integrate = |m: &f64| {
        speed -= fine_s * (m - 60.0) / INERTIA;
        speed
    };
    let speed: Vec<f64> = torque.iter().map(integrate).step_by(20).collect();
    let speed = Signal::new(truth.start_s, 1e-3, speed).unwrap();
    let rate = signal::derivative::central_difference(&speed.samples, 1e-3).unwrap();
    let mean = signal::filter::moving_average(&rate, 16).unwrap();
    let shaft = calc.samples.iter().enumerate().map(|(i, t)| t + INERTIA * mean[4 * i]).collect();
    e.signals.insert(Role::LoadCellTorque, calc.with_samples(cell));
    e.signals.insert(Role::SystemShaftTorque, calc.with_samples(shaft));
    e.signals.insert(Role::DynoSpeed, speed);
    e
}

/// Delay and resonance by small steps of the midpoint rule.
fn load_cell(torque: &[f64], step_s: f64) -> Vec<f64> {
    let (delay, w, z) = (CELL_DELAY_S, CELL_NATURAL_RAD_S, CELL_DAMPING);
    let late = (delay / step_s).round() as usize;
    let slope = |x: f64, v: f64, u: f64| w * w * (u - x) - 2.0 * z * w * v;
    let (mut x, mut v) = (torque[0], 0.0);
    let mut out = Vec::with_capacity(torque.len());
    for i in 0..torque.len() {
        out.push(x);
        let at = |k: usize| torque[k.saturating_sub(late).min(torque.len() - 1)];
        let u = 0.5 * (at(i) + at(i + 1));
        let (xm, vm) = (x + 0.5 * step_s * v, v + 0.5 * step_s * slope(x, v, u));
        (x, v) = (x + step_s * vm, v + step_s * slope(xm, vm, u));
    }
    out
}

fn delays(truth: Truth) -> Vec<SignalDelay> {
    let e = with_all_torques(truth);
    let fit = torque_control::estimate(&e, None).unwrap();
    estimate(&[&e], Some(&fit), INERTIA).unwrap().delays
}

fn of(delays: &[SignalDelay], role: Role) -> &SignalDelay {
    delays.iter().find(|d| d.role == role).unwrap()
}

#[test]
fn stat_every_torque_is_as_late_as_it_was_made() {
    let truth = Truth { noise_nm: 0.1, duration_s: 24.0, ..TRUTH };
    let found = delays(truth);
    let total = truth.delay_s + 1.0 / truth.lag_rad_s;
    let calc = of(&found, Role::AirGapTorque);
    assert!((calc.against_demand.as_ref().unwrap().value - total).abs() < 2e-5);
    // Nothing but inertia, and no gate: T_d and the bend coincide.
    assert!(calc.against_speed_bend.as_ref().unwrap().value.abs() < 1e-4, "{:?}", calc.against_speed_bend);
    let cell = of(&found, Role::LoadCellTorque);
    let behind = CELL_DELAY_S + 2.0 * CELL_DAMPING / CELL_NATURAL_RAD_S;
    assert!((cell.against_demand.as_ref().unwrap().value - total - behind).abs() < 5e-5);
    let dynamics = cell.dynamics.as_ref().unwrap();
    assert!((dynamics.parameters[0].value - CELL_DELAY_S).abs() < 5e-5, "{dynamics:?}");
    // The product of ripple and torque is not filtered by the cell in the model: a bias of about one per cent.
    assert!((dynamics.parameters[1].value / CELL_NATURAL_RAD_S - 1.0).abs() < 1.5e-2, "{dynamics:?}");
    assert!((dynamics.parameters[2].value - CELL_DAMPING).abs() < 1.5e-2, "{dynamics:?}");
    for signal in [calc, cell] {
        let parametric = signal.against_demand.as_ref().unwrap().value;
        assert_eq!(signal.routes.len(), 3);
        assert_eq!(signal.routes_agree(), Some(true), "{:?}", signal.routes);
        assert!(signal.routes.iter().all(|route| route.interval_s.is_some()));
        assert!((signal.routes[1].delay_s - parametric).abs() < 3e-4, "{:?}", signal.routes);
        assert!((signal.routes[2].delay_s - parametric).abs() < 3e-3, "{:?}", signal.routes);
    }
}

#[test]
fn stat_load_cell_behind_a_drive_without_ripple() {
    let found = delays(Truth { noise_nm: 0.1, ripple_hz: None, ..TRUTH });
    let dynamics = of(&found, Role::LoadCellTorque).dynamics.as_ref().unwrap();
    for (p, truth) in dynamics.parameters.iter().zip([CELL_DELAY_S, CELL_NATURAL_RAD_S, CELL_DAMPING]) {
        assert!((p.value - truth).abs() < 4.0 * p.standard_error + 1e-4 * truth, "{p:?}");
    }
}

#[test]
fn stat_flange_late_against_the_bend() {
    let truth = Truth { noise_nm: 0.1, ..TRUTH };
    let mut e = with_all_torques(truth);
    let mut noise = Noise::new(3);
    let speed = &e.signals[&Role::DynoSpeed];
    let mut shaft = 0.0;
    let shaft: Vec<f64> = (0..speed.len())
        .map(|_| {
            shaft = 0.97 * shaft + 2.0 * noise.normal();
            shaft
        })
        .collect();
    let mut sum = 0.0;
    let turning = |(v, t): (&f64, &f64)| {
        sum += 1e-3 * t / INERTIA;
        v + sum
    };
    let speed = speed.with_samples(speed.samples.iter().zip(&shaft).map(turning).collect());
    let late = (0..speed.len() / 4).map(|i| shaft[(4 * i).saturating_sub(5)]).collect();
    e.signals.insert(Role::FlangeTorque, e.signals[&Role::AirGapTorque].with_samples(late));
    e.signals.insert(Role::DynoSpeed, speed);
    let fit = torque_control::estimate(&e, None).unwrap();
    let found = estimate(&[&e], Some(&fit), INERTIA).unwrap().delays;
    let flange = of(&found, Role::FlangeTorque);
    // The sum above makes the speed answer half a sample early.
    assert!((flange.against_speed_bend.as_ref().unwrap().value - 5.5e-3).abs() < 3e-4, "{flange:?}");
    assert!(flange.against_demand.is_none());
}

#[test]
fn exact_length_of_the_moving_average() {
    let found = delays(Truth { duration_s: 8.0, ripple_hz: None, ..TRUTH });
    let shaft = of(&found, Role::SystemShaftTorque);
    assert_eq!(shaft.moving_average_length, Some(16));
    assert!((shaft.against_speed_bend.as_ref().unwrap().value - 7.5e-3).abs() < 1e-9);
}

#[test]
fn regress_without_a_fit_only_routes_without_a_model_are_given() {
    let e = white_noise(Truth { noise_nm: 0.1, ..TRUTH }, 2);
    let found = estimate(&[&e], None, INERTIA).unwrap();
    let calc = of(&found.delays, Role::AirGapTorque);
    assert_eq!(calc.routes.len(), 2);
    assert!(calc.against_speed_bend.is_none());
    assert!((calc.against_demand.as_ref().unwrap().value - 3.0184e-3).abs() < 3e-4);
}

#[test]
fn regress_unusable_recordings_are_errors() {
    assert!(matches!(estimate(&[], None, INERTIA), Err(EstimateError::MissingSignal { .. })));
    let mut e = white_noise(TRUTH, 2);
    e.signals.get_mut(&Role::AirGapTorque).unwrap().samples[5] = f64::NAN;
    assert!(matches!(estimate(&[&e], None, INERTIA), Err(EstimateError::Ident { .. })));
    e.signals.remove(&Role::DynoTorqueDemand);
    assert!(matches!(estimate(&[&e], None, INERTIA), Err(EstimateError::MissingSignal { .. })));
    let short = white_noise(Truth { duration_s: 2.0, ..TRUTH }, 1);
    assert!(matches!(estimate(&[&short], None, INERTIA), Err(EstimateError::TooShort { .. })));
    let mut constant = white_noise(TRUTH, 2);
    let demand = constant.signals.get_mut(&Role::DynoTorqueDemand).unwrap();
    *demand = demand.map(|_| 60.0);
    assert!(estimate(&[&constant], None, INERTIA).is_err());
}
