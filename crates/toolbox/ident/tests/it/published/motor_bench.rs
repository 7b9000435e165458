//! Two motors coupled by a flexible shaft, under a multisine of 11 to 250 Hz (Hori-Fujimoto laboratory, Tokyo): from
//! the current to the angle of the motor.
//!
//! The record is so clean that what any linear model leaves is some two hundred times the noise; the limits below are
//! therefore those of what is known of the bench, not standard errors.

use std::f64::consts::TAU;

use ident::{Bounds, ChannelPair, Doubt, FrequencyGreyBox, FrequencyTransferFunction, ResponseFunction, SpectralData};
use signal::Complex64;
use signal::frf::periodic_spectra;

use super::channels;

const PERIOD: usize = 2500;
const SAMPLE_TIME_S: f64 = 4e-4;

/// Mean spectra over all periods but the first, with the noise on both.
fn spectra() -> Option<SpectralData> {
    let [current, motor] = channels("motor-bench-two-mass/MultisineTypeA.mat", ["iq_adx", "theta_mx"])?;
    let harmonics: Vec<usize> = (11..=250).collect();
    let steady = [&current[PERIOD..], &motor[PERIOD..]];
    let spectra = periodic_spectra(&steady, PERIOD, SAMPLE_TIME_S, &harmonics).unwrap();
    Some(SpectralData::of_spectra(&spectra, ChannelPair { output: 1, input: 0 }).unwrap())
}

fn within(found: f64, wanted: f64, limit: f64) {
    assert!((found - wanted).abs() <= limit, "{found} for {wanted} ± {limit}");
}

/// The published structure, two zeros and four poles, and a delay: anti-resonance at 53 to 55 Hz, resonance at 76 to 77
/// Hz.
#[test]
fn ref_motor_bench_modes_and_delay() {
    let Some(data) = spectra() else { return };
    let found = FrequencyTransferFunction::continuous(2, 4).with_delay_between(0.0, 1e-3).fit(&data).unwrap();
    let g = found.fit.model.transfer_function().unwrap();
    let fastest = |p: &[f64]| lti::polynomial::roots(p).unwrap().iter().map(|r| r.norm() / TAU).fold(0.0, f64::max);
    within(fastest(g.num()), 54.0, 0.5);
    within(fastest(g.den()), 76.5, 0.5);
    within(g.delay_s(), 1.2e-4, 2e-6);
    assert!(found.fit.doubts.iter().any(|d| matches!(d, Doubt::LargerThanNoise { ratio } if *ratio > 100.0)));
}

/// Inertias and stiffness over the torque constant, which is not published. Dry friction holds both shafts like a soft
/// spring and damps them; without it, its damping is taken for the coupling's, fourfold.
#[test]
fn ref_motor_bench_two_masses() {
    let Some(data) = spectra() else { return };
    let system = |p: &[f64], w: f64| {
        let s = Complex64::new(0.0, w);
        let (link, bearing) = (s * p[3] + p[2], s * p[5] + p[6]);
        let (motor, load) = (s * s * p[0] + bearing + link, s * s * p[1] + bearing + link);
        load / (motor * load - link * link) * (-s * p[4]).exp()
    };
    let names = ["motor", "load", "stiffness", "damping", "delay", "friction", "hold"];
    let start = ResponseFunction::new(&names, &[0.004, 0.005, 480.0, 0.05, 1e-5, 0.01, 0.1], system);
    let bounds = [1.0, 1.0, 1e5, 10.0, 1e-2, 1.0, 100.0].map(|high| Bounds::new(0.0, high));
    let found = FrequencyGreyBox::default().with_bounds(&bounds).fit(&start, &data).unwrap();
    let [motor, load, stiffness, damping, delay, ..] = found.fit.parameters()[..] else { unreachable!() };
    // The two angles, each alone and both together, scatter by as much: 0.00484 to 0.00487, 0.00474 to 0.00480, 549 to
    // 556.
    within(motor, 0.00482, 0.015 * 0.00482);
    within(load, 0.00479, 0.015 * 0.00479);
    within(stiffness, 551.0, 0.015 * 551.0);
    within(load / motor, 0.99, 0.005);
    within(delay, 1.2e-4, 2e-6);
    let compliance = (1.0 / motor + 1.0 / load) / stiffness;
    within(0.5 * damping * compliance.sqrt(), 0.005, 0.0005);
    within((stiffness / load).sqrt() / TAU, 53.5, 0.6);
    within((stiffness * stiffness * compliance).sqrt() / TAU, 76.6, 0.4);
}
