//! Verdicts and maps as documents.

use bench_testkit::documents::read_back;
use capability::gradient::gradients;
use capability::map::{MapInputs, SineOf, map};
use capability::wanted::{self, Wanted};
use capability::{Bands, Change, CycleDemand, Demand, Easier, LimitOf, Trace, Verdict, can, document, shapes};
use cycle::{Feedback, builtin, requirement, validate};
use rig::bench_file::Limits;
use rig::experiment::catalogue::Settings;
use rig::experiment::{DEMAND_HOLD_S, Demands};
use units::RPM_RAD_S;
use work::Context;

use crate::maps;
use crate::support::{Bench, bench, map as engine_map};
use signal::proportion::Proportion;

/// A verdict as its document has it, without curves.
fn without_curves(verdict: Verdict) -> Verdict {
    Verdict { nominal: Trace::default(), bands: Bands::default(), ..verdict }
}

#[test]
fn exact_a_verdict_on_a_cycle_is_read_as_it_was_written() {
    let (bench, map) = (bench(), engine_map());
    let reference = builtin("whtc").unwrap().reference(&map).unwrap();
    let (sets, own) = ([requirement("whtc").unwrap()], ["speed within 10 rpm for 95 %".parse().unwrap()]);
    let demand = Demand::Cycle(CycleDemand { reference: &reference, map: Some(&map) });
    let inputs = capability::CanInputs { sets: &sets, own: &own, samples: 4, ..bench.inputs(demand) };
    let verdict = can(&inputs, &Context::new()).unwrap();
    assert_eq!(read_back(&document::VERDICT, &verdict), without_curves(verdict));
}

#[test]
fn exact_a_verdict_with_doubts_is_read_as_it_was_written() {
    let mut bench = bench();
    let shape = shapes::find("tip-in").unwrap();
    let settings = Settings::parse(shape.parameters, &[("to", "110"), ("speed", "560")]).unwrap();
    let plan = shape.plan(&settings).unwrap();
    let demands = Demands::of(&plan, 1, DEMAND_HOLD_S);
    let of = |bench: &Bench| can(&bench.inputs(Demand::Plan(&plan, &demands)), &Context::new()).unwrap();
    let shaft = of(&bench).limits.into_iter().find(|one| one.of == LimitOf::ShaftTorque).unwrap();
    bench.limits = Limits { shaft_torque_nm: Some(shaft.values.quantile(0.7)), ..Limits::default() };
    let verdict = of(&bench);
    assert!(!verdict.doubts.is_empty());
    assert_eq!(read_back(&document::VERDICT, &verdict), without_curves(verdict));
}

#[test]
fn exact_changes_are_read_as_they_were_written() {
    let kept = Proportion::new(38, 40);
    let changes = [Change::Slower { factor: 2.1 }, Change::FeedForward { acceleration_nm_s2_per_rad: 0.88 }];
    let found: Vec<Easier> = changes.into_iter().map(|change| Easier { change, kept }).collect();
    assert_eq!(read_back(&document::EASIER, &found), found);
}

fn map_inputs(bench: &Bench) -> MapInputs<'_> {
    MapInputs { samples: 8, ..maps::inputs(bench) }
}

#[test]
fn exact_maps_are_read_as_they_were_written() {
    let (bench, speeds) = (bench(), [1200.0 * RPM_RAD_S, 2500.0 * RPM_RAD_S]);
    let inputs = map_inputs(&bench);
    for of in [SineOf::Speed, SineOf::Torque] {
        let found = map(&inputs, of, &[1.0, 18.0], &speeds).unwrap();
        assert_eq!(read_back(&document::MAP, &found), found);
    }
    let found = gradients(&inputs, &speeds, &[50.0]).unwrap();
    assert_eq!(read_back(&document::GRADIENTS, &found), found);
    let wish = Wanted::Sine { of: SineOf::Torque, amplitude: 100.0, frequency_hz: 5.0 };
    let found = wanted::answer(&inputs, wish, &speeds).unwrap();
    assert_eq!(read_back(&document::WANTED, &found), found);
}

#[test]
fn exact_a_judged_run_is_read_as_it_was_written() {
    let reference = builtin("whtc").unwrap().reference(&engine_map()).unwrap();
    let time = |k: usize| k as f64 * 0.1;
    let feedback = Feedback {
        start_s: 0.0,
        sample_time_s: 0.1,
        speed_rad_s: (0..18_021).map(|k| reference.speed_at(time(k))).collect(),
        torque_nm: (0..18_021).map(|k| 0.97 * reference.torque_at(time(k))).collect(),
        demand: None,
    };
    let mut set = requirement("1065.514").unwrap();
    set.shift_s = 0.0;
    let found = validate(&reference, &feedback, &set).unwrap();
    assert_eq!(read_back(&document::VALIDATION, &found), found);
}
