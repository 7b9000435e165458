use bench_model::disturbances::Disturbances;
use bench_model::document::Validity;
use bench_model::friction::DynoFriction;
use bench_model::model::{FeedForwardGains, PiController};
use bench_model::prediction::PredictionInputs;
use capability::{Answer, Beyond, Change, CycleDemand, Demand, LimitOf, can, easier, shapes};
use cycle::{Own, Reference, builtin, requirement};
use design::safety::{BenchSpread, FrictionSpread, Prior, Quantity, SafetyInputs, check};
use rig::bench_file::{DriveHeat, Limits};
use rig::experiment::catalogue::Settings;
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan};
use work::Context;

use crate::support::{SAMPLES, bench, map};

fn shape(name: &str, given: &[(&str, &str)]) -> (ExperimentPlan, Demands) {
    let shape = shapes::find(name).unwrap();
    let plan = shape.plan(&Settings::parse(shape.parameters, given).unwrap()).unwrap();
    let demands = Demands::of(&plan, 1, DEMAND_HOLD_S);
    (plan, demands)
}

#[test]
fn exact_a_cycle_within_the_limits_gets_a_yes_with_its_statistics() {
    let (bench, map) = (bench(), map());
    let reference = builtin("whtc").unwrap().reference(&map).unwrap();
    let sets = [requirement("whtc").unwrap()];
    let demand = Demand::Cycle(CycleDemand { reference: &reference, map: Some(&map) });
    let verdict =
        can(&capability::CanInputs { sets: &sets, samples: 10, ..bench.inputs(demand) }, &Context::new()).unwrap();
    assert_eq!((verdict.answer, verdict.kept.count, verdict.kept.of), (Answer::Yes, 10, 10), "{:?}", verdict.limits);
    assert_eq!(verdict.sets[0].statistics.len(), 13);
    assert!(verdict.sets[0].nominal.as_ref().unwrap().passes);
    // Limits that are not stated are named, and nothing is said of them.
    assert!(verdict.unchecked.contains(&LimitOf::Power) && !verdict.unchecked.contains(&LimitOf::ShaftTorque));
    let torque = verdict.limits.iter().find(|one| one.of == LimitOf::TorqueDemand).unwrap();
    assert!(
        torque.values.quantile(0.5) > 150.0 && torque.values.quantile(0.95) < 400.0,
        "{}",
        torque.values.quantile(0.5)
    );
}

#[test]
fn exact_a_limit_below_what_a_cycle_needs_gives_a_no_with_its_moment() {
    let (mut bench, map) = (bench(), map());
    bench.limits.torque_nm = Some(120.0);
    bench.model.torque_limit_nm = Some(120.0);
    let reference = builtin("whtc").unwrap().reference(&map).unwrap();
    let demand = Demand::Cycle(CycleDemand { reference: &reference, map: Some(&map) });
    let verdict = can(&capability::CanInputs { samples: 10, ..bench.inputs(demand) }, &Context::new()).unwrap();
    assert_eq!((verdict.answer, verdict.kept.count), (Answer::No, 0));
    let torque = verdict.limits.iter().find(|one| one.of == LimitOf::TorqueDemand).unwrap();
    assert_eq!(torque.reached.unwrap().count, 10);
    assert!(torque.time_s > 1.0 && torque.time_s < 1800.0 && torque.values.quantile(1.0) <= 120.0);
}

#[test]
fn exact_equal_seeds_give_equal_answers_on_any_number_of_threads() {
    let bench = bench();
    let (plan, demands) = shape("tip-in", &[]);
    let inputs = bench.inputs(Demand::Plan(&plan, &demands));
    let on_threads = |threads: usize| {
        let context = Context::new().with_threads(threads);
        context.run(|| can(&inputs, &context).unwrap()).unwrap()
    };
    let one = on_threads(1);
    let two = on_threads(2);
    assert_eq!(one, two);
    let other = can(&capability::CanInputs { seed: 2, ..inputs }, &Context::new()).unwrap();
    assert_ne!(one.limits, other.limits);
}

#[test]
fn exact_without_limits_and_requirements_nothing_is_judged() {
    let mut bench = bench();
    bench.limits = Limits::default();
    let (plan, demands) = shape("tip-in", &[]);
    let inputs = bench.inputs(Demand::Plan(&plan, &demands));
    assert_eq!(can(&inputs, &Context::new()).unwrap().answer, Answer::NotJudged);
    let own: [Own; 1] = ["speed within 1000 rpm for 95 %".parse().unwrap()];
    assert_eq!(can(&capability::CanInputs { own: &own, ..inputs }, &Context::new()).unwrap().answer, Answer::Yes);
}

#[test]
fn exact_a_shape_is_judged_by_requirements_of_ones_own() {
    let bench = bench();
    let (plan, demands) = shape("speed-step", &[("height", "20")]);
    let own: [Own; 2] = ["speed rise below 2 s".parse().unwrap(), "speed within 0.001 rpm for 99 %".parse().unwrap()];
    let demand = Demand::Plan(&plan, &demands);
    let verdict = can(&capability::CanInputs { own: &own, ..bench.inputs(demand) }, &Context::new()).unwrap();
    assert_eq!((verdict.own[0].kept.count, verdict.own[1].kept.count), (SAMPLES, 0));
    assert_eq!((verdict.answer, verdict.kept.count), (Answer::No, 0));
}

#[test]
fn exact_a_slower_or_smaller_test_is_found_where_one_is_possible() {
    let mut bench = bench();
    // 2000 rpm in 0.3 s are 6667 rpm/s, and more at the beginning of the jump.
    bench.limits = Limits { speed_gradient_rad_s2: Some(2000.0 * units::RPM_RAD_S), ..Limits::default() };
    let (plan, demands) = shape("gear-shift", &[("to", "1500"), ("torque", "0")]);
    let inputs = bench.inputs(Demand::Plan(&plan, &demands));
    assert_eq!(can(&inputs, &Context::new()).unwrap().answer, Answer::No);
    let found = easier(&inputs, &Context::new()).unwrap();
    let factor = |kind: fn(Change) -> Option<f64>| found.iter().find_map(|one| kind(one.change)).unwrap();
    let slower = factor(|change| if let Change::Slower { factor } = change { Some(factor) } else { None });
    let smaller = factor(|change| if let Change::Smaller { factor } = change { Some(factor) } else { None });
    // 5000 rpm/s have to become 2000.
    assert!(slower > 2.0 && slower < 6.0, "{slower}");
    assert!(smaller > 0.1 && smaller < 0.5, "{smaller}");
    assert!(found.iter().all(|one| one.kept.estimate >= 0.95 && one.kept.of == SAMPLES));
    // A low-pass of first order makes a ramp of 0.3 s flatter; no gain and no shaft does.
    let corner = factor(|change| if let Change::Filter { corner_hz } = change { Some(corner_hz) } else { None });
    assert!(corner > 0.1 && corner < 2.0, "{corner}");
    assert_eq!(found, Context::new().with_threads(1).run(|| easier(&inputs, &Context::new()).unwrap()).unwrap());
    assert!(!found.iter().any(|one| matches!(one.change, Change::Stiffness { .. })), "{found:?}");
}

#[test]
fn exact_a_change_of_the_bench_or_of_its_controller_is_found_where_one_helps() {
    let mut bench = bench();
    // The engine's pulses meet the resonance: another stiffness moves it away, a slower test does not.
    bench.limits = Limits { shaft_torque_nm: Some(1.0), ..Limits::default() };
    let (plan, demands) = shape("tip-in", &[("to", "110"), ("speed", "560"), ("ramp", "1")]);
    let shaft = can(&bench.inputs(Demand::Plan(&plan, &demands)), &Context::new()).unwrap();
    let peak = shaft.limits.iter().find(|one| one.of == LimitOf::ShaftTorque).unwrap().values.quantile(0.5);
    bench.limits = Limits { shaft_torque_nm: Some(0.75 * peak), ..Limits::default() };
    let inputs = bench.inputs(Demand::Plan(&plan, &demands));
    assert_eq!(can(&inputs, &Context::new()).unwrap().answer, Answer::No);
    let found = easier(&inputs, &Context::new()).unwrap();
    let softer = found.iter().any(|one| matches!(one.change, Change::Stiffness { factor } if factor < 1.0));
    let slower = found.iter().any(|one| matches!(one.change, Change::Slower { .. }));
    assert!(softer && !slower, "{peak} {:?}", found.iter().map(|one| one.change).collect::<Vec<_>>());

    // Without feed-forward the speed lags behind a ramp by what PI needs.
    bench.model.feed_forward = None;
    bench.limits = Limits::default();
    let (plan, demands) = shape("coast-down", &[("speed", "2000"), ("to", "1000"), ("ramp", "1"), ("duration", "4")]);
    let demand = Demand::Plan(&plan, &demands);
    let within = |error: f64| [Own::Within { signal: cycle::Signal::Speed, error, share: 0.95 }];
    let far = within(1.0);
    let error = can(&capability::CanInputs { own: &far, ..bench.inputs(demand) }, &Context::new()).unwrap().own[0]
        .values
        .as_slice()[0];
    let own = within(0.6 * error);
    let inputs = capability::CanInputs { own: &own, ..bench.inputs(demand) };
    assert_eq!(can(&inputs, &Context::new()).unwrap().answer, Answer::No);
    let found = easier(&inputs, &Context::new()).unwrap();
    let fed = found.iter().find_map(|one| match one.change {
        Change::FeedForward { acceleration_nm_s2_per_rad } => Some(acceleration_nm_s2_per_rad),
        _ => None,
    });
    let mechanics = &bench.model.mechanics;
    let all = mechanics.dyno_inertia_kg_m2 + mechanics.engine_inertia_kg_m2;
    let changes: Vec<_> = found.iter().map(|one| one.change).collect();
    assert!(fed.is_some_and(|fed| fed < 0.0 && fed >= -all), "{changes:?}, {:?} {error}", bench.model.feed_forward);
}

#[test]
fn exact_a_filter_is_judged_by_the_demand_before_it() {
    let bench = bench();
    let own: [Own; 1] = ["speed rise below 0.5 s".parse().unwrap()];
    let (plan, demands) = shape("speed-step", &[("height", "20")]);
    let inputs = capability::CanInputs { own: &own, ..bench.inputs(Demand::Plan(&plan, &demands)) };
    let rise = |filter_hz| {
        can(&capability::CanInputs { filter_hz, ..inputs }, &Context::new()).unwrap().own[0].values.as_slice()[0]
    };
    // The rise of a first order is 0.35 of the inverse of its corner; that of the loop shortens it with its overshoot.
    let (free, filtered) = (rise(None), rise(Some(0.5)));
    assert!(free < 0.2 && (0.5..0.8).contains(&filtered), "{free} {filtered}");
}

#[test]
fn exact_a_doubt_names_the_number_that_decides() {
    let bench = bench();
    let (plan, demands) = shape("tip-in", &[("to", "160")]);
    let of = |limit_nm: f64| {
        let limits = Limits { shaft_torque_nm: Some(limit_nm), ..Limits::default() };
        can(
            &capability::CanInputs { limits, samples: 200, ..bench.inputs(Demand::Plan(&plan, &demands)) },
            &Context::new(),
        )
    };
    let free = of(1000.0).unwrap();
    assert!(free.doubts.is_empty());
    let shaft = free.limits.iter().find(|one| one.of == LimitOf::ShaftTorque).unwrap();
    let verdict = of(shaft.values.quantile(0.7)).unwrap();
    assert_eq!(verdict.answer, Answer::Perhaps);
    let first = verdict.doubts.first().unwrap();
    assert!(first.explained > 0.1 && first.explained <= 1.0, "{first:?}");
    assert!((first.kept[0] - first.kept[1]).abs() > 0.2, "{first:?}");
    assert_eq!(first.settled_by.as_ref().unwrap().to_string(), "WhiteNoise_T_TN");
}

#[test]
fn exact_every_shape_makes_a_plan_that_can_be_predicted() {
    let bench = bench();
    for shape in &shapes::ALL {
        let (plan, demands) = self::shape(shape.name, &[]);
        let verdict =
            can(&capability::CanInputs { samples: 2, ..bench.inputs(Demand::Plan(&plan, &demands)) }, &Context::new());
        let verdict = verdict.unwrap_or_else(|error| panic!("{}: {error}", shape.name));
        assert_eq!(verdict.unstable.count, 0, "{}", shape.name);
        assert_eq!(verdict.bands.time_s.len(), 400.min(verdict.nominal.speed_rad_s.len()), "{}", shape.name);
    }
}

/// The longest time near the resonance in a sine test is that of the sine there, as the check of experiments counts it.
#[test]
fn exact_a_sine_at_the_resonance_counts() {
    let bench = bench();
    let plan = ExperimentPlan::sine_t_tn(2500.0, 40.0);
    let demands = Demands::of(&plan, 1, DEMAND_HOLD_S);
    let inputs = bench.inputs(Demand::Plan(&plan, &demands));
    let verdict = can(&inputs, &Context::new()).unwrap();
    let stays = &verdict.limits.iter().find(|one| one.of == LimitOf::TimeAtResonance).unwrap().values;
    let prediction = PredictionInputs {
        plan: &plan,
        demands: &demands,
        model: &bench.model,
        engine: &bench.engine,
        firing_seed: Some(inputs.seed),
        friction: DynoFriction::default(),
        disturbances: Disturbances::default(),
        limits: Limits::default(),
    };
    let of_check = SafetyInputs {
        prediction,
        spread: inputs.spread,
        pulses: inputs.pulses,
        slowest_engine_control: inputs.slowest_engine_control,
        friction: inputs.friction,
        samples: inputs.samples,
        seed: inputs.seed,
    };
    let checked = check(&of_check, &Context::new()).unwrap();
    let of_check = checked.checked.iter().find(|one| one.of == Quantity::TimeAtResonance).unwrap();
    assert_eq!(stays.as_slice(), of_check.values);
    assert!(stays.as_slice()[0] >= 2.0, "{stays:?}");
}

#[test]
fn exact_the_drive_heats_by_the_square_of_its_torque() {
    let mut bench = bench();
    bench.model.torque_limit_nm = None;
    bench.engine.firing_harmonics.clear();
    bench.limits.drive_heat = Some(DriveHeat { continuous_torque_nm: 100.0, time_constant_s: 10.0 });
    // From rest at 50 Nm to 150 Nm for 10 s: θ = 2.25 + (0.25 − 2.25) e^{−t/τ}.
    let (plan, demands) = shape("tip-in", &[("to", "150"), ("ramp", "0"), ("start", "2"), ("duration", "12")]);
    let heat = |bench: &crate::support::Bench| {
        let verdict =
            can(&capability::CanInputs { samples: 3, ..bench.inputs(Demand::Plan(&plan, &demands)) }, &Context::new());
        let verdict = verdict.unwrap();
        verdict.limits.into_iter().find(|one| one.of == LimitOf::DriveHeat)
    };
    let found = heat(&bench).unwrap();
    let expected = 2.25 - 2.0 * (-1.0_f64).exp();
    // The controller takes the torque up within some tenths of a second.
    assert!((found.values.quantile(0.5) - expected).abs() < 0.04, "{} {expected}", found.values.quantile(0.5));
    assert_eq!((found.limit, found.reached.unwrap().count), (Some(1.0), 3));
    assert!((found.time_s - 12.0).abs() < 0.01);
    bench.limits.drive_heat = None;
    assert_eq!(heat(&bench), None);
}

#[test]
fn exact_a_phase_is_that_of_the_linear_model() {
    let bench = bench();
    let (plan, demands) = shape("sine-sweep", &[("from", "2"), ("to", "20"), ("duration", "10")]);
    let own: Vec<Own> = ["torque phase at 8 Hz below 90 deg", "shaft_torque amplitude at 8 Hz below 500 Nm"]
        .map(|text| text.parse().unwrap())
        .to_vec();
    let nominal = Prior { resonance: 0.0, damping: 0.0, engine_inertia: 0.0 };
    let inputs = capability::CanInputs {
        own: &own,
        spread: BenchSpread::Prior(nominal),
        samples: 2,
        ..bench.inputs(Demand::Plan(&plan, &demands))
    };
    let verdict = can(&inputs, &Context::new()).unwrap();
    // The demand is held for 10 ms, in which it is late by the steps of the automation system alone.
    let lag = -bench.model.torque_control.unwrap().response(std::f64::consts::TAU * 8.0).arg();
    let found = verdict.own[0].values.quantile(0.5);
    assert!((found - lag).abs() < 0.05, "{found} {lag}");
    assert!((verdict.own[0].time_s - 10.0 * 4.0_f64.ln() / 10.0_f64.ln()).abs() < 0.5, "{}", verdict.own[0].time_s);
    let shaft = verdict.own[1].values.quantile(0.5);
    // 10 Nm times J_e/(J_d + J_e) at the least, below the resonance of 18 Hz.
    assert!((3.0..10.0).contains(&shaft) && verdict.own[1].kept.count == 2, "{shaft}");
    let none: Vec<Own> = vec!["speed phase at 8 Hz below 90 deg".parse().unwrap()];
    let error = can(&capability::CanInputs { own: &none, ..inputs }, &Context::new()).unwrap_err().to_string();
    assert!(error.contains("no part at 8 Hz"), "{error}");
}

#[test]
fn regress_beyond_the_range_of_the_model_there_is_no_plain_yes() {
    let bench = bench();
    let (plan, demands) = shape("tip-in", &[]);
    let rpm = |low: f64, high: f64| Some((low * units::RPM_RAD_S, high * units::RPM_RAD_S));
    let of = |speed, torque| {
        let validity = Validity { dyno_speed_rad_s: speed, air_gap_torque_nm: torque, frequency_hz: None };
        let inputs = capability::CanInputs { validity, samples: 3, ..bench.inputs(Demand::Plan(&plan, &demands)) };
        can(&inputs, &Context::new()).unwrap()
    };
    assert_eq!(of(None, None).answer, Answer::Yes);
    assert_eq!(of(rpm(1000.0, 2000.0), Some((0.0, 250.0))).answer, Answer::Yes);
    let slow = of(rpm(1000.0, 1300.0), None);
    assert_eq!(slow.answer, Answer::NotShown);
    assert!(matches!(slow.beyond[..], [Beyond::ModelSpeed { .. }]), "{:?}", slow.beyond);
    let weak = of(None, Some((6.0, 107.0)));
    assert!(
        weak.answer == Answer::NotShown && matches!(weak.beyond[..], [Beyond::ModelTorque { .. }]),
        "{:?}",
        weak.beyond
    );
    // A no stays one.
    let limits = Limits { shaft_torque_nm: Some(20.0), ..Limits::default() };
    let validity = Validity { air_gap_torque_nm: Some((6.0, 107.0)), ..Validity::default() };
    let inputs = capability::CanInputs { validity, limits, samples: 3, ..bench.inputs(Demand::Plan(&plan, &demands)) };
    assert_eq!(can(&inputs, &Context::new()).unwrap().answer, Answer::No);
}

#[test]
fn regress_what_the_engine_cannot_is_said_of_the_engine() {
    let (bench, map) = (bench(), map());
    let of = |torque: f64, rpm: f64| {
        let speeds = vec![1500.0 * units::RPM_RAD_S, rpm * units::RPM_RAD_S, 1500.0 * units::RPM_RAD_S];
        let reference = Reference::of_itself(0.0, speeds, vec![50.0, torque, 50.0]);
        let demand = Demand::Cycle(CycleDemand { reference: &reference, map: Some(&map) });
        can(&capability::CanInputs { samples: 2, ..bench.inputs(demand) }, &Context::new()).unwrap()
    };
    assert!(of(150.0, 2000.0).beyond.is_empty());
    let strong = of(300.0, 2000.0);
    let [Beyond::EngineTorque { asked_nm, given_nm, time_s, .. }] = strong.beyond[..] else { panic!("{strong:?}") };
    assert_eq!((asked_nm.round(), given_nm.round(), time_s.round()), (300.0, 190.0, 1.0));
    let fast = of(50.0, 8000.0);
    assert!(fast.beyond.iter().any(|one| matches!(one, Beyond::EngineSpeed { .. })), "{:?}", fast.beyond);
    assert!(fast.answer != Answer::Yes && fast.beyond[0].is_of_engine());
    let reference = Reference::of_itself(0.0, vec![-100.0; 3], vec![50.0; 3]);
    let demand = Demand::Cycle(CycleDemand { reference: &reference, map: None });
    assert!(can(&bench.inputs(demand), &Context::new()).unwrap_err().to_string().contains("turns forwards"));
}

#[test]
fn regress_requirements_that_a_test_does_not_show_are_refused() {
    let bench = bench();
    for (name, requirement) in [
        ("tip-in", "speed overshoot below 5 %"),
        ("tip-in", "torque phase at 5 Hz below 60 deg"),
        ("speed-step", "torque rise below 10 ms"),
        ("coast-down", "torque rise below 10 ms"),
        ("gear-shift", "torque settling within 2 % below 1 s"),
    ] {
        let (plan, demands) = shape(name, &[]);
        let own: [Own; 1] = [requirement.parse().unwrap()];
        let inputs = capability::CanInputs { own: &own, samples: 2, ..bench.inputs(Demand::Plan(&plan, &demands)) };
        let error = can(&inputs, &Context::new()).unwrap_err().to_string();
        let signal = requirement.split(" below").next().unwrap();
        assert!(error.contains(signal) && error.contains("its demand"), "{name}: {error}");
    }
}

/// How many benches of two are not stable.
fn runs(bench: &crate::support::Bench, demand: Demand<'_>) -> usize {
    let friction = FrictionSpread { coulomb_nm: (0.0, 2.0), viscous_nm_s_per_rad: (0.0, 0.03), ..FrictionSpread::NONE };
    let inputs = capability::CanInputs { samples: 2, friction, ..bench.inputs(demand) };
    can(&inputs, &Context::new()).unwrap().unstable.count
}

/// Models that estimates give: ω_d* late or early in the error and in the feed-forward, with delays of parts of a
/// sample.
#[test]
fn regress_no_lead_of_the_demand_makes_a_test_fail() {
    let mut bench = bench();
    bench.limits = Limits {
        shaft_torque_slew_nm_per_s: Some(1e6),
        torque_slew_nm_per_s: Some(1e6),
        speed_gradient_rad_s2: Some(1e4),
        power_w: Some(1e6),
        time_at_resonance_s: Some(1e3),
        drive_heat: Some(DriveHeat { continuous_torque_nm: 200.0, time_constant_s: 10.0 }),
        ..bench.limits
    };
    let (nominal, engine_map) = (bench.model.clone(), map());
    let reference = builtin("whtc").unwrap().reference(&engine_map).unwrap();
    let second = |values: &[f64]| values[..60].to_vec();
    let reference = Reference::of_itself(0.0, second(&reference.speed_rad_s), second(&reference.torque_nm));
    for (error_ms, fed_ms) in [(0.0, -1.0), (-1.0, 0.0), (-2.0, -6.0), (3.0, -5.0), (2.0, 4.0), (0.4, -0.6)] {
        let delay_s = 2.06e-3;
        let pi = nominal.speed_controller.unwrap();
        let demand_delay_s = delay_s + 1e-3 * error_ms;
        bench.model.speed_controller = Some(PiController { delay_s, demand_delay_s, ..pi });
        bench.model.feed_forward = nominal.feed_forward.map(|fed| FeedForwardGains { delay_s: 1e-3 * fed_ms, ..fed });
        let demand = Demand::Cycle(CycleDemand { reference: &reference, map: Some(&engine_map) });
        assert_eq!(runs(&bench, demand), 0);
        for shape in &shapes::ALL {
            let (plan, demands) = self::shape(shape.name, &[]);
            let unstable = runs(&bench, Demand::Plan(&plan, &demands));
            assert_eq!(unstable, 0, "{}, {error_ms} and {fed_ms} ms", shape.name);
        }
    }
}

/// A controller answers what its encoder reads once a turn: a slow test has the slew of T_d* that this makes, in shapes
/// as in cycles.
#[test]
fn exact_errors_of_the_encoder_count_in_the_slew_of_the_torque_demand() {
    let mut bench = bench();
    bench.engine.cycle_variation = 0.0;
    let (speed_rad_s, once_a_turn) = (3000.0 * units::RPM_RAD_S, 2e-3);
    let (plan, demands) = shape("tip-in", &[("speed", "3000"), ("ramp", "2")]);
    let reference = Reference::of_itself(0.0, vec![speed_rad_s; 8], vec![50.0; 8]);
    let gain = bench.model.speed_controller.unwrap().proportional_nm_s_per_rad;
    for demand in [Demand::Plan(&plan, &demands), Demand::Cycle(CycleDemand { reference: &reference, map: None })] {
        let median = |disturbances: Disturbances| {
            let inputs = capability::CanInputs { samples: 9, disturbances, ..bench.inputs(demand) };
            let verdict = can(&inputs, &Context::new()).unwrap();
            verdict.limits.iter().find(|one| one.of == LimitOf::TorqueSlew).unwrap().values.quantile(0.5)
        };
        let added = median(Disturbances { once_a_turn, ..Disturbances::default() }) - median(Disturbances::default());
        // From trough to crest within 10 ms, half a turn: twice the amplitude, which between benches has the median √ln
        // 2 of its root mean square.
        let wanted = 2.0 * gain * once_a_turn * speed_rad_s * std::f64::consts::LN_2.sqrt() / 0.01;
        assert!((0.4..1.6).contains(&(added / wanted)), "{added} for {wanted}");
    }
}
