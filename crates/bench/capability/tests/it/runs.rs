//! Runs that are judged again by other limits.

use bench_model::document::Validity;
use capability::{
    Answer, Bands, CanInputs, CapabilityError, CycleDemand, Demand, LimitOf, Runs, Trace, Verdict, can, shapes,
};
use cycle::Reference;
use rig::bench_file::Limits;
use rig::experiment::catalogue::Settings;
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan};
use units::RPM_RAD_S;
use work::Context;

use crate::support::{bench, map};

fn tip_in() -> (ExperimentPlan, Demands) {
    let shape = shapes::find("tip-in").unwrap();
    let plan = shape.plan(&Settings::parse(shape.parameters, &[("ramp", "0.05")]).unwrap()).unwrap();
    let demands = Demands::of(&plan, 1, DEMAND_HOLD_S);
    (plan, demands)
}

/// Limits that half of the benches keep, each on its own, and all of them together.
fn others(verdict: &Verdict, limits: Limits) -> Vec<Limits> {
    let median = |one: &capability::LimitVerdict| (one.of, one.values.quantile(0.5) * 1.000_1);
    let medians: Vec<_> = verdict.limits.iter().map(median).filter(|(_, value)| *value > 0.0).collect();
    let each = medians.iter().map(|(of, value)| of.with(limits, Some(*value)));
    let all = medians.iter().fold(limits, |all, (of, value)| of.with(all, Some(*value)));
    each.chain([all, Limits::default()]).collect()
}

/// The answer of a new run, without its curves.
fn fresh(inputs: &CanInputs<'_>, limits: Limits) -> Verdict {
    let found = can(&CanInputs { limits, ..*inputs }, &Context::new()).unwrap();
    Verdict { nominal: Trace::default(), bands: Bands::default(), ..found }
}

fn judges_as_a_new_run(inputs: &CanInputs<'_>) {
    let runs = Runs::of(inputs, &Context::new()).unwrap();
    assert_eq!(runs.verdict(), can(inputs, &Context::new()).unwrap());
    let mut answers = Vec::new();
    for limits in others(&runs.verdict(), inputs.limits) {
        let again = runs.judged(&limits).unwrap();
        assert_eq!(again, fresh(inputs, limits), "{limits:?}");
        answers.push(again.kept.count);
    }
    let of = inputs.samples;
    assert!(answers.iter().any(|kept| (1..of).contains(kept)), "limits that decide: {answers:?}");
}

#[test]
fn exact_other_limits_judge_a_plan_as_a_new_run_does() {
    let (bench, (plan, demands)) = (bench(), tip_in());
    judges_as_a_new_run(&bench.inputs(Demand::Plan(&plan, &demands)));
}

#[test]
fn exact_other_limits_judge_a_cycle_as_a_new_run_does() {
    let (bench, map) = (bench(), map());
    let speed: Vec<f64> = (0..20).map(|k| (1500.0 + 300.0 * f64::from(k % 5)) * RPM_RAD_S).collect();
    let torque: Vec<f64> = (0..20).map(|k| 40.0 * f64::from(k % 4)).collect();
    let reference = Reference::of_itself(0.0, speed, torque);
    let demand = Demand::Cycle(CycleDemand { reference: &reference, map: Some(&map) });
    judges_as_a_new_run(&CanInputs { samples: 8, ..bench.inputs(demand) });
}

#[test]
fn exact_a_larger_torque_than_that_of_the_drive_needs_a_new_run() {
    let (mut bench, (plan, demands)) = (bench(), tip_in());
    let limited = Limits { torque_nm: Some(100.0), ..bench.limits };
    (bench.limits, bench.model.torque_limit_nm) = (limited, Some(100.0));
    let runs = Runs::of(&bench.inputs(Demand::Plan(&plan, &demands)), &Context::new()).unwrap();
    assert_eq!(runs.largest_limit(LimitOf::TorqueDemand), Some(100.0));
    assert_eq!(runs.largest_limit(LimitOf::Speed), None);
    let larger = runs.judged(&Limits { torque_nm: Some(120.0), ..limited }).unwrap_err();
    assert_eq!(larger, CapabilityError::BeyondDrive { limit_nm: 120.0, drive_nm: 100.0 });
    assert!(runs.judged(&Limits { torque_nm: None, ..limited }).is_err());
    assert_eq!(runs.judged(&Limits { torque_nm: Some(80.0), ..limited }).unwrap().answer, Answer::No);
}

#[test]
fn exact_the_courses_of_a_plan_reach_the_largest_values() {
    let (bench, (plan, demands)) = (bench(), tip_in());
    let runs = Runs::of(&bench.inputs(Demand::Plan(&plan, &demands)), &Context::new()).unwrap();
    let verdict = runs.verdict();
    for one in verdict.limits.iter().filter(|one| one.of != LimitOf::TimeAtResonance) {
        let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let mut of_benches: Vec<f64> =
            (0..verdict.kept.of).map(|place| largest(runs.course_of_bench(one.of, place))).collect();
        of_benches.sort_by(f64::total_cmp);
        assert_eq!(of_benches, one.values.as_slice(), "{:?}", one.of);
        let course = runs.course(one.of);
        assert!(course.low.iter().zip(&course.high).all(|(low, high)| low <= high));
        let place = course.time_s.partition_point(|time_s| *time_s <= one.time_s) - 1;
        assert_eq!(course.nominal[place], largest(&course.nominal), "{:?}", one.of);
    }
}

#[test]
fn exact_a_bench_keeps_all_if_it_reaches_nothing() {
    let (bench, (plan, demands)) = (bench(), tip_in());
    let runs = Runs::of(&bench.inputs(Demand::Plan(&plan, &demands)), &Context::new()).unwrap();
    let limits = others(&runs.verdict(), bench.limits)[0];
    let drawn: Vec<_> = (0..).map_while(|place| runs.bench(place, &limits)).collect();
    let verdict = runs.judged(&limits).unwrap();
    assert_eq!(drawn.len(), verdict.kept.of);
    assert_eq!(drawn.iter().filter(|one| one.keeps).count(), verdict.kept.count);
    assert!(drawn.iter().all(|one| one.keeps == one.reaches.is_empty() && one.is_stable));
    assert_eq!(verdict.binding(), Some(verdict.limits[0].of));
}

#[test]
fn exact_the_spans_beyond_the_model_are_those_of_the_speeds_beyond_it() {
    let (bench, map) = (bench(), map());
    // 10 s at 1500 rpm, 10 s at 3000 rpm.
    let speed: Vec<f64> = (0..20).map(|k| if k < 10 { 1500.0 } else { 3000.0 } * RPM_RAD_S).collect();
    let reference = Reference::of_itself(0.0, speed, vec![50.0; 20]);
    let demand = Demand::Cycle(CycleDemand { reference: &reference, map: Some(&map) });
    let spans = |highest_rpm: f64| {
        let range = (1000.0 * RPM_RAD_S, highest_rpm * RPM_RAD_S);
        let validity = Validity { dyno_speed_rad_s: Some(range), ..Validity::default() };
        let inputs = CanInputs { samples: 2, validity, ..bench.inputs(demand) };
        Runs::of(&inputs, &Context::new()).unwrap().beyond_model()
    };
    assert_eq!(spans(4000.0), []);
    let [(from_s, to_s)] = spans(2000.0)[..] else { panic!("one span") };
    assert!((9.0..10.1).contains(&from_s) && to_s >= 19.0, "{from_s} … {to_s}");
}
