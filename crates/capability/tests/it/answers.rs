use capability::{Answer, Change, CycleDemand, Demand, LimitOf, can, easier, shapes};
use cycle::{Own, builtin, requirement};
use rig::bench_file::Limits;
use rig::experiment::catalogue::Settings;
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan};

use crate::support::{SAMPLES, bench, map};

fn shape(name: &str, given: &[(&str, &str)]) -> (ExperimentPlan, Demands) {
    let shape = shapes::find(name).unwrap();
    let plan = shape.plan(&Settings::parse(shape.parameters, given).unwrap()).unwrap();
    let demands = Demands::of(&plan, 1, DEMAND_HOLD_S);
    (plan, demands)
}

fn silent() -> &'static (dyn Fn(u64, u64) + Sync) {
    &|_, _| {}
}

#[test]
fn exact_a_cycle_within_the_limits_gets_a_yes_with_its_statistics() {
    let (bench, map) = (bench(), map());
    let reference = builtin("whtc").unwrap().reference(&map).unwrap();
    let sets = [requirement("whtc").unwrap()];
    let demand = Demand::Cycle(CycleDemand { reference: &reference, map: Some(&map) });
    let verdict = can(&capability::CanInputs { sets: &sets, samples: 10, ..bench.inputs(demand) }, silent()).unwrap();
    assert_eq!((verdict.answer, verdict.kept.count, verdict.kept.of), (Answer::Yes, 10, 10), "{:?}", verdict.limits);
    assert_eq!(verdict.sets[0].statistics.len(), 13);
    assert!(verdict.sets[0].nominal.as_ref().unwrap().passes);
    // Limits that are not stated are named, and nothing is said of them.
    assert!(verdict.unchecked.contains(&LimitOf::Power) && !verdict.unchecked.contains(&LimitOf::ShaftTorque));
    let torque = verdict.limits.iter().find(|one| one.of == LimitOf::TorqueDemand).unwrap();
    assert!(torque.quantile(0.5) > 150.0 && torque.quantile(0.95) < 400.0, "{}", torque.quantile(0.5));
}

#[test]
fn exact_a_limit_below_what_a_cycle_needs_gives_a_no_with_its_moment() {
    let (mut bench, map) = (bench(), map());
    bench.limits.torque_nm = Some(120.0);
    bench.model.torque_limit_nm = Some(120.0);
    let reference = builtin("whtc").unwrap().reference(&map).unwrap();
    let demand = Demand::Cycle(CycleDemand { reference: &reference, map: Some(&map) });
    let verdict = can(&capability::CanInputs { samples: 10, ..bench.inputs(demand) }, silent()).unwrap();
    assert_eq!((verdict.answer, verdict.kept.count), (Answer::No, 0));
    let torque = verdict.limits.iter().find(|one| one.of == LimitOf::TorqueDemand).unwrap();
    assert_eq!(torque.reached.unwrap().count, 10);
    assert!(torque.time_s > 1.0 && torque.time_s < 1800.0 && torque.quantile(1.0) <= 120.0);
}

#[test]
fn exact_equal_seeds_give_equal_answers_on_any_number_of_threads() {
    let bench = bench();
    let (plan, demands) = shape("tip-in", &[]);
    let inputs = bench.inputs(Demand::Plan(&plan, &demands));
    let one = numerics_free(1, || can(&inputs, silent()).unwrap());
    let two = numerics_free(2, || can(&inputs, silent()).unwrap());
    assert_eq!(one, two);
    let other = can(&capability::CanInputs { seed: 2, ..inputs }, silent()).unwrap();
    assert_ne!(one.limits, other.limits);
}

/// Work in threads of its own.
fn numerics_free<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    numerics::parallel::with_threads(threads, work)
}

#[test]
fn exact_a_shape_is_judged_by_requirements_of_ones_own() {
    let bench = bench();
    let (plan, demands) = shape("speed-step", &[("height", "20")]);
    let own: [Own; 2] = ["speed rise below 2 s".parse().unwrap(), "speed within 0.001 rpm for 99 %".parse().unwrap()];
    let demand = Demand::Plan(&plan, &demands);
    let verdict = can(&capability::CanInputs { own: &own, ..bench.inputs(demand) }, silent()).unwrap();
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
    assert_eq!(can(&inputs, silent()).unwrap().answer, Answer::No);
    let found = easier(&inputs, silent()).unwrap();
    let factor = |kind: fn(Change) -> Option<f64>| found.iter().find_map(|one| kind(one.change)).unwrap();
    let slower = factor(|change| if let Change::Slower { factor } = change { Some(factor) } else { None });
    let smaller = factor(|change| if let Change::Smaller { factor } = change { Some(factor) } else { None });
    // 5000 rpm/s have to become 2000.
    assert!(slower > 2.0 && slower < 6.0, "{slower}");
    assert!(smaller > 0.1 && smaller < 0.5, "{smaller}");
    assert!(found.iter().all(|one| one.verdict.answer == Answer::Yes));
}

#[test]
fn exact_every_shape_makes_a_plan_that_can_be_predicted() {
    let bench = bench();
    for shape in &shapes::ALL {
        let (plan, demands) = self::shape(shape.name, &[]);
        let verdict =
            can(&capability::CanInputs { samples: 2, ..bench.inputs(Demand::Plan(&plan, &demands)) }, silent());
        let verdict = verdict.unwrap_or_else(|error| panic!("{}: {error}", shape.name));
        assert_eq!(verdict.unstable.count, 0, "{}", shape.name);
        assert_eq!(verdict.bands.time_s.len(), 400.min(verdict.nominal.speed_rad_s.len()), "{}", shape.name);
    }
}
