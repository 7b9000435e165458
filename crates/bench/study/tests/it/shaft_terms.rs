//! Terms that may be in a shaft beyond K and B: found where they are, and nowhere else; and friction that is not taken
//! for damping.

use part_shaft::shaft::{Beyond, Fitted, Term, TermTest, Wanted, Weight, checks, fit};
use rig::bench_parameters::{DualMassFlywheel, LossFactor, MechanicsParameters};
use rig::results::Quantity;

use crate::shaft_benches::{Drawn, inputs};
use bench_testkit::benches::in_parallel;

/// The terms of a bench's shaft, with 30 Nm upon so much.
fn terms_of(bench: &Drawn, mean_nm: f64, seed: u64) -> Beyond {
    let experiment = bench.white_noise((mean_nm, 30.0), 40.0, seed);
    let beyond = checks::beyond(&inputs(&experiment, bench.parameters.mechanics.dyno_inertia_kg_m2)).unwrap();
    for test in beyond.tests.iter().filter(|test| test.found) {
        println!("{:?}: {:?} misfit {:?} of {}", test.term, test.value, test.misfit, beyond.simple_misfit);
    }
    for test in &beyond.tests {
        let (low, high) = test.joint_interval.unwrap_or((0.0, 0.0));
        assert_eq!(test.found, low > 0.0 || high < 0.0, "{test:?}");
    }
    beyond
}

fn altered(seed: usize, alter: impl Fn(&mut MechanicsParameters)) -> Drawn {
    let mut bench = Drawn::new(seed);
    alter(&mut bench.parameters.mechanics);
    bench
}

#[test]
#[ignore = "slow: 24 benches"]
fn stat_a_simple_shaft_has_no_term_beyond() {
    let all = in_parallel(24, |i| terms_of(&Drawn::new(5000 + i), 40.0, i as u64));
    for term in Term::ALL {
        let of = |beyond: &Beyond| beyond.tests.iter().find(|test| test.term == term).unwrap().value.clone();
        let ratios: Vec<f64> = all.iter().filter_map(of).map(|p| (p.value / p.standard_error).abs()).collect();
        let far = ratios.iter().filter(|t| **t > 1.96).count();
        println!("{term:?}: {far} of {} beyond 1.96 standard errors", ratios.len());
        assert!(far <= 5, "{term:?} {ratios:?}");
    }
    let found = all.iter().filter(|beyond| beyond.best().is_some()).count();
    assert!(found <= 2, "{found} of 24 at a level of 1 %");
    assert!(all.iter().all(|beyond| (0.7..1.5).contains(&beyond.simple_misfit)));
}

#[test]
#[ignore = "slow: 4 benches"]
fn stat_terms_are_found_where_they_are() {
    let loss = LossFactor { loss_factor: 0.1, reference_hz: 18.0, lowest_hz: 1.0, highest_hz: 100.0 };
    let benches = [
        (altered(1, |m| m.shaft_loss = Some(loss)), 40.0),
        (altered(1, |m| m.shaft_stiffening_nm_per_rad3 = 20.0 * m.shaft_stiffness_nm_per_rad), 40.0),
        (altered(1, |m| m.shaft_backlash_rad = 2e-3), 5.0),
        (altered(1, |m| m.flywheel = Some(DualMassFlywheel::default())), 40.0),
    ];
    let found = in_parallel(benches.len(), |i| terms_of(&benches[i].0, benches[i].1, 1));
    let best = |i: usize| -> &TermTest { found[i].best().unwrap() };
    assert_eq!(best(0).term, Term::LossFactor);
    let value = |test: &TermTest| test.value.as_ref().unwrap().value;
    assert!((0.06..0.12).contains(&value(best(0))), "{:?}", best(0));
    assert_eq!(best(1).term, Term::OfStiffness(Weight::Torque));
    // 3 K_3 φ² grows with the twist, whose mean is above zero.
    assert!(value(best(1)) > 0.0, "{:?}", best(1));
    assert_eq!(best(2).term, Term::OfStiffness(Weight::NearZeroTorque));
    assert!((-1.0..-0.2).contains(&value(best(2))), "{:?}", best(2));
    assert!(found[3].simple_misfit > 5.0, "a flywheel of two masses is not a shaft: {}", found[3].simple_misfit);
}

#[test]
#[ignore = "slow: 12 benches"]
fn stat_a_dual_mass_flywheel_is_estimated() {
    let flywheel = DualMassFlywheel::default();
    let rows = in_parallel(12, |i| {
        let bench = altered(7000 + i, |m| m.flywheel = Some(flywheel));
        let experiment = bench.white_noise((40.0, 30.0), 40.0, i as u64);
        let mechanics = bench.parameters.mechanics;
        let found = fit(&inputs(&experiment, mechanics.dyno_inertia_kg_m2), Wanted::DualMass).unwrap();
        (mechanics, found)
    });
    let mut held = 0;
    for (mechanics, Fitted { estimate, misfit }) in &rows {
        let truths = [
            (Quantity::Stiffness, mechanics.shaft_stiffness_nm_per_rad),
            (Quantity::Damping, mechanics.shaft_damping_nm_s_per_rad),
            (Quantity::FlywheelInertia, flywheel.secondary_inertia_kg_m2),
            (Quantity::FlywheelStiffness, flywheel.stiffness_nm_per_rad),
            (Quantity::FlywheelDamping, flywheel.damping_nm_s_per_rad),
        ];
        println!("misfit {misfit}");
        for (quantity, truth) in truths {
            let p = estimate.parameter(quantity).unwrap();
            println!("{quantity}: {} ± {}, truth {truth}", p.value, p.standard_error);
            held += usize::from((p.interval.0..=p.interval.1).contains(&truth));
        }
        assert!((0.7..1.6).contains(misfit), "{misfit}");
    }
    println!("{held} of {} in the interval", 5 * rows.len());
    assert!(held >= 50, "{held} of 60");
}

#[test]
#[ignore = "slow: 40 benches"]
fn stat_friction_does_not_go_into_the_damping() {
    let rows = in_parallel(40, |i| {
        // Dynamometers that run out with a time constant of 60 s or more.
        let slope = |m: &MechanicsParameters| m.dyno_inertia_kg_m2 / 60.0 * i as f64 / 40.0;
        let bench = altered(6000 + i, |m| m.viscous_friction_nm_s_per_rad = slope(m));
        let experiment = bench.white_noise((40.0, 30.0), 40.0, i as u64);
        let mechanics = bench.parameters.mechanics;
        let estimate = fit(&inputs(&experiment, mechanics.dyno_inertia_kg_m2), Wanted::Shaft).unwrap().estimate;
        (mechanics, estimate)
    });
    type Truth = fn(&MechanicsParameters) -> f64;
    let parameters: [(Quantity, Truth); 3] = [
        (Quantity::Stiffness, |m| m.shaft_stiffness_nm_per_rad),
        (Quantity::Damping, |m| m.shaft_damping_nm_s_per_rad),
        (Quantity::FrictionSlope, |m| m.viscous_friction_nm_s_per_rad),
    ];
    for (quantity, truth) in parameters {
        let held = |(mechanics, estimate): &&(MechanicsParameters, rig::results::Estimate)| {
            let (low, high) = estimate.parameter(quantity).unwrap().interval;
            (low..=high).contains(&truth(mechanics))
        };
        let held = rows.iter().filter(held).count();
        println!("{quantity}: {held} of 40 in the interval");
        assert!(held >= 34, "{quantity}: {held}");
    }
}

#[test]
fn stat_every_band_tells_the_same_shaft_once_timing_is_part_of_it() {
    let bench = Drawn::new(4);
    let experiment = bench.white_noise((40.0, 30.0), 40.0, 4);
    let mechanics = &bench.parameters.mechanics;
    let inputs = inputs(&experiment, mechanics.dyno_inertia_kg_m2);
    let truth = mechanics.shaft_damping_nm_s_per_rad;
    let bands_hz = [(1.0, 20.0), (5.0, 40.0), (15.0, 60.0), (1.0, 110.0)];
    for (band_hz, found) in bands_hz.iter().zip(checks::by_band(&inputs, &bands_hz).unwrap()) {
        let (estimate, ignoring_timing) = found.unwrap();
        let (own, naive) =
            (estimate.parameter(Quantity::Damping).unwrap(), ignoring_timing.parameter(Quantity::Damping).unwrap());
        println!("{band_hz:?}: B {} ± {}, naive {} for {truth}", own.value, own.standard_error, naive.value);
        assert!((own.value - truth).abs() < 4.0 * own.standard_error, "{band_hz:?} {own:?}");
        assert!((naive.value - truth).abs() > (own.value - truth).abs(), "{band_hz:?} {naive:?}");
    }
}
