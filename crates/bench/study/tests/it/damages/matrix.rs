//! Damages of growing size, to all recordings of a campaign or to one: no number is wrong without a cause that is
//! named, and the verdict never improves as the damage grows. The benches are of a simulator that shares no code with
//! the project.

use recording::{Channel, Raster, Recording};
use rig::Severity;
use rig::experiment::ExperimentPlan;
use rig::results::{Parameter, Quantity};
use signal::filter::Sos;
use study::verdict::Level;
use study::{Study, torque_scale, verdict};
use virtual_bench::simulate;

use super::work::{CALC, CELL, DYNO_SPEED, ENGINE_SPEED, SHAFT, SPEED_DEMAND, SPEEDS, TORQUE_DEMAND, TORQUES};
use super::{Brought, kind, parameters, study_of};
use crate::recorded_bench::{RecordedBench, found};
use bench_testkit::benches::{default_bench, in_parallel};
use bench_testkit::recordings::recordings;

/// A number is wrong beyond so many half widths of its interval.
const WRONG: f64 = 1.5;
/// Numbers that are compared with the truth.
const TOLD: [Quantity; 3] = [Quantity::Stiffness, Quantity::Damping, Quantity::ProportionalGain];
/// Benches of the test.
const BENCHES: [&str; 3] = ["drawn/bench-208", "drawn/bench-211", "drawn/bench-214"];
/// The recordings of a drawn bench, by the start of their names; all of them.
const WHICH: [&str; 5] = ["", "BS", "White", "Levels", "Ramp"];

/// Half width of a value with the scale of the torques, which a study states beside its intervals.
fn half_width_with_scale(found: &Parameter, study: &Study) -> f64 {
    let of_scale = torque_scale(study).map_or(0.0, |scale| scale.half_width);
    (0.5 * (found.interval.1 - found.interval.0)).hypot(of_scale * found.value)
}

/// A wrong value: its quantity, and by how many half widths it is off.
type Wrong = (Quantity, f64);

/// Wrong values of a study.
fn wrong(bench: &RecordedBench, study: &Study, is_of_scale: bool) -> Vec<Wrong> {
    let off = TOLD.iter().filter_map(|quantity| {
        let found = found(study, *quantity)?;
        let widths = match is_of_scale {
            true => (found.value - bench.truth(*quantity)) / half_width_with_scale(found, study),
            false => bench.half_widths_off(found),
        };
        (widths.abs() > WRONG).then_some((*quantity, widths))
    });
    off.collect()
}

fn shown(wrong: &[Wrong]) -> String {
    let shown = |(quantity, widths): &Wrong| format!("{} {widths:+.1}", quantity.symbol());
    wrong.iter().map(shown).collect::<Vec<_>>().join("; ")
}

/// The study of a bench without damage.
struct Clean {
    /// Kinds of findings beyond notes.
    usual: Vec<String>,
    wrong: Vec<Wrong>,
}

impl Clean {
    /// True where the damage made this value wrong, or wronger by half a half width.
    fn is_by_damage(&self, (quantity, widths): &Wrong) -> bool {
        let before = self.wrong.iter().find(|(of, _)| of == quantity);
        before.is_none_or(|(_, before)| (widths - before).abs() > 0.5)
    }
}

/// Damage to a campaign, in steps that grow.
struct Series {
    name: &'static str,
    which: &'static str,
    steps: Vec<(String, Step)>,
}

impl Series {
    /// True where all torques have one factor: values are then as wrong as the scale of the torques, beyond their
    /// intervals.
    fn is_of_scale(&self) -> bool {
        self.name.starts_with("torques") && self.which.is_empty()
    }

    /// The smallest, the middle and the largest step.
    fn thin(&mut self) {
        let last = self.steps.len() - 1;
        let mut number = 0..;
        self.steps.retain(|_| number.next().is_some_and(|i| [0, last.div_ceil(2), last].contains(&i)));
    }
}

/// Every kind of damage in three sizes; of the recordings that each may strike, every third, from another one on for
/// each bench. Three benches in a row have all of them.
fn thinned(mut all: Vec<Series>, bench: usize) -> Vec<Series> {
    let mut seen: Vec<&str> = Vec::new();
    all.retain_mut(|one| {
        let place = seen.iter().filter(|name| **name == one.name).count();
        seen.push(one.name);
        one.thin();
        (place + bench).is_multiple_of(3)
    });
    all
}

type Step = Box<dyn Fn(&mut Brought) + Sync>;

fn series(
    name: &'static str,
    which: &'static str,
    sizes: &[f64],
    work: impl Fn(&mut Recording, f64) + Sync + Copy + 'static,
) -> Series {
    let step = |size: &f64| {
        let size = *size;
        let apply = move |brought: &mut Brought| {
            let recordings = brought.recordings.iter_mut().filter(|(file, _)| file.starts_with(which));
            recordings.for_each(|(_, recording)| work(recording, size));
        };
        (size.to_string(), Box::new(apply) as Step)
    };
    Series { name, which, steps: sizes.iter().map(step).collect() }
}

fn samples(recording: &mut Recording, names: &[&str], work: impl Fn(&mut Vec<f64>)) {
    let of = |channel: &&mut Channel| names.contains(&channel.name.as_str());
    recording.channels.iter_mut().filter(of).for_each(|channel| work(&mut channel.samples));
}

fn scaled(recording: &mut Recording, names: &[&str], percent: f64) {
    samples(recording, names, |x| x.iter_mut().for_each(|x| *x *= 1.0 + 0.01 * percent));
}

fn clocked(recording: &mut Recording, percent: f64) {
    recording.rasters.iter_mut().flat_map(|raster| &mut raster.time_s).for_each(|t| *t *= 1.0 + 0.01 * percent);
}

/// New samples of a channel from its own, with their time step.
fn filtered(recording: &mut Recording, name: &str, work: impl Fn(&[f64], f64) -> Vec<f64>) {
    for i in 0..recording.channels.len() {
        if recording.channels[i].name == name {
            let Raster { time_s, .. } = &recording.rasters[recording.channels[i].raster];
            let step_s = (time_s[time_s.len() - 1] - time_s[0]) / (time_s.len() - 1) as f64;
            recording.channels[i].samples = work(&recording.channels[i].samples, step_s);
        }
    }
}

/// The mean over the last samples.
fn mean_over(x: &[f64], count: usize) -> Vec<f64> {
    let mean = |k: usize| {
        let from = (k + 1).saturating_sub(count.max(1));
        x[from..=k].iter().sum::<f64>() / (k + 1 - from) as f64
    };
    (0..x.len()).map(mean).collect()
}

fn filtered_both_ways(x: &[f64], step_s: f64, cutoff_hz: f64) -> Vec<f64> {
    let Ok(filter) = Sos::butterworth_lowpass(2, cutoff_hz, step_s) else { return x.to_vec() };
    let once = |x: &[f64]| -> Vec<f64> {
        let mut state = filter.state_at_level(x[0]);
        let mut y = filter.filter(x, &mut state);
        y.reverse();
        y
    };
    once(&once(x))
}

fn lagged(x: &[f64], step_s: f64, lag_s: f64) -> Vec<f64> {
    let share = step_s / (lag_s + step_s);
    let mut state = x[0];
    x.iter()
        .map(|x| {
            state += share * (x - state);
            state
        })
        .collect()
}

fn later(recording: &mut Recording, names: &[&str], milliseconds: f64) {
    let names: Vec<&str> = names.to_vec();
    for name in names {
        filtered(recording, name, |x, step_s| {
            let by = (1e-3 * milliseconds / step_s).round() as usize;
            (0..x.len()).map(|k| x[k.saturating_sub(by)]).collect()
        });
    }
}

/// Puts a recording of another bench in the place of one.
fn foreign(other: &'static str, which: &'static str) -> Series {
    let apply = move |brought: &mut Brought| {
        let Some((_, recording)) = recordings(other).into_iter().find(|(file, _)| file.starts_with(which)) else {
            return;
        };
        brought.file(which).1 = recording;
    };
    Series { name: "of another bench", which, steps: vec![(other.to_owned(), Box::new(apply))] }
}

fn all_series() -> Vec<Series> {
    const PERCENT: [f64; 5] = [1.0, 3.0, 5.0, 10.0, 30.0];
    let mut all = Vec::new();
    for which in WHICH {
        all.push(series("speeds +%", which, &PERCENT, |one, percent| scaled(one, &SPEEDS, percent)));
        all.push(series("speeds -%", which, &[1.0, 3.0, 5.0, 10.0, 25.0], |one, percent| {
            scaled(one, &SPEEDS, -percent)
        }));
        all.push(series("clock +%", which, &[0.5, 1.0, 3.0, 5.0, 10.0, 30.0], clocked));
        all.push(series("clock -%", which, &[0.5, 1.0, 3.0, 5.0, 10.0, 25.0], |one, percent| clocked(one, -percent)));
        all.push(series("torques +%", which, &PERCENT, |one, percent| scaled(one, &TORQUES, percent)));
        all.push(series("T_d* late, ms", which, &[1.0, 2.0, 5.0, 10.0], |one, ms| later(one, &[TORQUE_DEMAND], ms)));
    }
    for which in ["", "BS", "White"] {
        all.push(series("N_d +%", which, &PERCENT, |one, percent| scaled(one, &[DYNO_SPEED], percent)));
        all.push(series("N_e +%", which, &PERCENT, |one, percent| scaled(one, &[ENGINE_SPEED], percent)));
        all.push(series("N_d* +%", which, &PERCENT, |one, percent| scaled(one, &[SPEED_DEMAND], percent)));
        for (name, channel) in [("mean of N_e, ms", ENGINE_SPEED), ("mean of N_d, ms", DYNO_SPEED)] {
            all.push(series(name, which, &[4.0, 6.0, 10.0, 20.0], move |one, ms| {
                filtered(one, channel, |x, step_s| mean_over(x, (1e-3 * ms / step_s).round() as usize));
            }));
        }
        for (name, channel) in [("N_e both ways, Hz", ENGINE_SPEED), ("N_d both ways, Hz", DYNO_SPEED)] {
            all.push(series(name, which, &[60.0, 30.0, 15.0], move |one, hz| {
                filtered(one, channel, |x, step_s| filtered_both_ways(x, step_s, hz));
            }));
        }
        all.push(series("lag of N_d, ms", which, &[1.0, 2.0, 5.0, 10.0], |one, ms| {
            filtered(one, DYNO_SPEED, |x, step_s| lagged(x, step_s, 1e-3 * ms));
        }));
        all.push(series("T_d,calc late, ms", which, &[2.0, 5.0, 10.0], |one, ms| {
            later(one, &[CALC, CELL, SHAFT], ms);
        }));
    }
    all
}

fn brought_of(bench: &RecordedBench) -> Brought {
    Brought { bench: bench.file.clone(), recordings: bench.recordings.clone() }
}

/// One study of a damaged campaign.
struct Row {
    text: String,
    level: Level,
    is_silent: bool,
    is_without_damaged: bool,
}

fn row(bench: &RecordedBench, clean: &Clean, series: &Series, (size, step): &(String, Step)) -> Row {
    let mut damaged = brought_of(bench);
    step(&mut damaged);
    let Some(study) = study_of(&damaged) else {
        let text = format!("{} | {} {size} {} | refused", bench.name, series.name, series.which);
        return Row { text, level: Level::Insufficient, is_silent: false, is_without_damaged: false };
    };
    let wrong = wrong(bench, &study, series.is_of_scale());
    let (level, named) = (verdict(&study).level, named(&study, &clean.usual));
    let is_by_damage = wrong.iter().any(|one| clean.is_by_damage(one));
    let is_silent = is_by_damage && (level == Level::Good || named.is_empty());
    let text = format!(
        "{} | {} {size} {} | {} | {} | {}{}",
        bench.name,
        series.name,
        series.which,
        level.key(),
        named.join(" "),
        shown(&wrong),
        if is_silent { " | SILENT" } else { "" }
    );
    Row { text, level, is_silent, is_without_damaged: is_without(&study, series.which) }
}

/// True where an error names the one recording that is damaged, and no part is from it: a study of the others, which
/// may be better than one in which a smaller damage struck a part.
fn is_without(study: &Study, which: &str) -> bool {
    let has_error = |file: &String| {
        let mut errors = study.diagnostics.iter().filter(|found| found.severity == Severity::Error);
        errors.any(|found| found.place.file.as_ref() == Some(file))
    };
    let mut damaged = study.recordings.iter().filter(|one| !which.is_empty() && one.file.starts_with(which));
    damaged.any(|one| one.used_for.is_empty() && has_error(&one.file))
}

/// Kinds of findings beyond notes, without those that there are without damage.
fn named(study: &Study, usual: &[String]) -> Vec<String> {
    let grave = study.diagnostics.iter().filter(|found| found.severity > Severity::Note);
    let mark = |severity| if severity == Severity::Error { "!" } else { "" };
    let mut kinds: Vec<String> =
        grave.map(|found| format!("{}{}", mark(found.severity), kind(&found.finding))).collect();
    kinds.sort();
    kinds.dedup();
    kinds.retain(|kind| !usual.contains(kind));
    kinds
}

/// The studies of a bench, a line each; how many are silent or improve, and how many there are.
fn of_bench(name: &str, series: &[Series]) -> [usize; 3] {
    let Some(bench) = RecordedBench::of(name) else { return [0; 3] };
    let study = study_of(&brought_of(&bench)).unwrap();
    let clean = Clean { usual: named(&study, &[]), wrong: wrong(&bench, &study, false) };
    let level = verdict(&study).level.key();
    println!("{name} | none | {level} | {} | {}", clean.usual.join(" "), shown(&clean.wrong));
    let rows = in_parallel(series.len(), |i| {
        let rows: Vec<Row> = series[i].steps.iter().map(|step| row(&bench, &clean, &series[i], step)).collect();
        rows.iter().for_each(|row| println!("{}", row.text));
        rows
    });
    let improves = |rows: &Vec<Row>| {
        rows.windows(2).filter(|pair| pair[1].level < pair[0].level && !pair[1].is_without_damaged).count()
    };
    let silent = rows.iter().flatten().filter(|row| row.is_silent).count();
    [silent, rows.iter().map(improves).sum(), rows.iter().map(Vec::len).sum()]
}

/// Two recordings of the virtual bench.
fn small() -> Brought {
    let plans = [ExperimentPlan::bs_t_nt(1230.0, 14.0), ExperimentPlan::white_noise_t_tn(1230.0, 14.0)];
    let recorded = in_parallel(plans.len(), |i| {
        (format!("{}_1230.mf4", plans[i].label), simulate(&parameters(), &plans[i], 21 + i as u64).unwrap())
    });
    Brought { bench: default_bench(), recordings: recorded }
}

/// Kinds of errors, and the parts that are estimated.
fn errors_and_parts(study: &Study) -> (Vec<String>, [bool; 3]) {
    let mut errors = named(study, &[]);
    errors.retain(|kind| kind.starts_with('!'));
    let estimated =
        [study.speed_controller.estimated().is_some(), study.shaft.estimated().is_some(), study.model.is_some()];
    (errors, estimated)
}

#[test]
fn stat_an_error_strikes_the_parts_that_rest_on_its_recording() {
    let clean = small();
    assert_eq!(errors_and_parts(&study_of(&clean).unwrap()), (vec![], [true; 3]));
    let of_shaft = [true, false, false];
    let cases: [(&str, Step, [bool; 3]); 6] = [
        ("!PulsesOffSpeed", Box::new(|b| b.each(|one| scaled(one, &SPEEDS, 5.0))), [false; 3]),
        ("!ClockRate", Box::new(|b| clocked(&mut b.file("White").1, 3.0)), of_shaft),
        (
            "!PulsesOffShaft",
            Box::new(|b| filtered(&mut b.file("White").1, ENGINE_SPEED, |x, s| filtered_both_ways(x, s, 30.0))),
            of_shaft,
        ),
        // The shaft is from the other recording.
        (
            "!PulsesOffShaft",
            Box::new(|b| filtered(&mut b.file("BS").1, ENGINE_SPEED, |x, s| filtered_both_ways(x, s, 30.0))),
            [true; 3],
        ),
        ("!EarlySignal", Box::new(|b| later(&mut b.file("White").1, &[TORQUE_DEMAND], 6.0)), of_shaft),
        ("!FiringOrderDisagrees", Box::new(|b| b.bench.cylinders = 6), [true, true, false]),
    ];
    for (kind, damage, expected) in cases {
        let mut damaged = clean.clone();
        damage(&mut damaged);
        let (errors, parts) = errors_and_parts(&study_of(&damaged).unwrap());
        assert!(errors.iter().any(|found| found == kind) && parts == expected, "{kind}: {errors:?} {parts:?}");
    }
}

/// K_p was off by 50 half widths and more.
#[test]
fn regress_gains_cover_a_recording_whose_torques_have_another_scale() {
    let plans = [ExperimentPlan::bs_t_nt(1230.0, 14.0), ExperimentPlan::levels_n_nt(1230.0, 14.0)];
    let recordings = in_parallel(plans.len(), |i| {
        (format!("{}_1230.mf4", plans[i].label), simulate(&parameters(), &plans[i], 21 + i as u64).unwrap())
    });
    let clean = Brought { bench: default_bench(), recordings };
    let gains_with = |percent: f64| {
        let mut damaged = clean.clone();
        scaled(&mut damaged.file("BS").1, &TORQUES, percent);
        let study = study_of(&damaged).unwrap();
        [Quantity::ProportionalGain, Quantity::IntegralGain].map(|quantity| found(&study, quantity).unwrap().clone())
    };
    let controller = parameters().controller;
    let truth = [controller.proportional_nm_s_per_rad, controller.integral_nm_per_rad];
    for (gain, truth) in gains_with(0.0).into_iter().zip(truth) {
        assert!(gain.interval.1 - gain.interval.0 < 1e-3 * truth, "{gain:?}");
    }
    for percent in [1.0, 5.0, 20.0] {
        for (gain, truth) in gains_with(percent).into_iter().zip(truth) {
            assert!((gain.interval.0..=gain.interval.1).contains(&truth), "{percent} %: {gain:?} {truth}");
        }
    }
}

/// K_p was off by five half widths.
#[test]
fn regress_a_lag_of_the_speed_strikes_the_controller_and_leaves_the_shaft() {
    let mut damaged = small();
    filtered(&mut damaged.file("BS").1, DYNO_SPEED, |x, step_s| lagged(x, step_s, 5e-3));
    let study = study_of(&damaged).unwrap();
    let named = named(&study, &[]);
    let (_, [controller, shaft, _]) = errors_and_parts(&study);
    assert!(named.iter().any(|kind| kind == "!PulsesOffShaft") && !controller && shaft, "{named:?}");
}

#[test]
#[ignore = "slow: hundreds of studies a bench"]
fn stat_damage_of_any_size_is_hardly_ever_wrong_without_a_word() {
    // All sizes and recordings where damages are chosen, by parts of their names.
    let damages = std::env::var("DYNOID_DAMAGES").ok();
    let benches = std::env::var("DYNOID_BENCHES").unwrap_or_else(|_| BENCHES.join(","));
    let mut sums = [0; 3];
    for (i, bench) in benches.split(',').enumerate() {
        let number = BENCHES.iter().position(|usual| *usual == bench).unwrap_or(i);
        let mut series = all_series();
        let others = ["drawn/bench-201", "drawn/bench-204", "drawn/bench-210"];
        series.extend(WHICH[1..].iter().map(|which| foreign(others[number % others.len()], which)));
        match &damages {
            Some(chosen) => {
                let is_chosen = |one: &Series, part: &str| format!("{} {}", one.name, one.which).contains(part);
                series.retain(|one| chosen.split(',').any(|part| is_chosen(one, part)));
            }
            None => series = thinned(series, number),
        }
        let of_bench = of_bench(bench, &series);
        sums.iter_mut().zip(of_bench).for_each(|(sum, one)| *sum += one);
    }
    let [silent, improved, all] = sums;
    println!(
        "of {all} studies {silent} are wrong without a word, and {improved} have a better verdict than a smaller damage"
    );
    // One in fifty each: B is known too poorly in some benches for a smoothed N_e to show.
    assert!(50 * silent <= all && 50 * improved <= all, "{silent} and {improved} of {all}");
}
