//! The speed controller as recordings tell it: its discrete form, what stands beside PI and delay, the limit and its
//! anti-windup, bends of the feed-forward, and the study of a known PI under noise.

mod benches;
mod hidden;

use demo::campaign::held_speed;
use part_controller::SpeedControllers;
use part_controller::noise_test::{Estimator, Noise, NoiseTestOptions, noise_test};
use part_controller::speed_controller::{
    AntiWindup, FeedForwardTerms, IntegrationRule, Limit, LimitReached, Structure, Term, Verdict, estimate,
    estimate_feed_forward, feed_forward_terms, limit, speed_control, structure,
};
use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use rig::results::Quantity;
use rig::{BenchFile, Experiment, prepare};

use bench_testkit::recordings::{bench_file, recordings};
use benches::recorded;
use hidden::Hidden;

const LIMIT_NM: f64 = 400.0;
/// Speeds of the static map.
const KNOTS: usize = 7;

/// A recording with constant N_d* whose T_d* is that of a hidden controller, and what is found beside PI and delay.
fn found_in(hidden: &Hidden) -> Structure {
    let bs = hidden.in_the_loop(&recorded(&BenchParameters::default(), &ExperimentPlan::bs_t_nt(1200.0, 20.0), 3));
    let fit = estimate(&bs, Some(LIMIT_NM)).unwrap();
    structure(&bs, &fit, Some(LIMIT_NM)).unwrap()
}

/// Feed-forward found of a hidden controller in levels or ramps of N_d*.
fn bent(hidden: &Hidden, plan: &ExperimentPlan) -> FeedForwardTerms {
    let parameters = BenchParameters::default();
    let bs = Hidden { bend_nm: 0.0, hysteresis_nm: 0.0, friction_nm: 0.0, ..hidden.clone() };
    let bs = bs.rewrite(&recorded(&parameters, &ExperimentPlan::bs_t_nt(1200.0, 20.0), 3));
    let fit = estimate(&bs, Some(LIMIT_NM)).unwrap();
    let moved = hidden.rewrite(&recorded(&parameters, plan, 4));
    let lags = estimate_feed_forward(&moved, None, &fit, Some(LIMIT_NM)).unwrap().lags;
    feed_forward_terms(&moved, &fit, lags, Some(LIMIT_NM)).unwrap()
}

fn levels() -> ExperimentPlan {
    ExperimentPlan::levels_n_nt(1200.0, 30.0)
}

fn estimate_of(rounds: &[part_controller::speed_controller::Round], term: Term) -> (f64, f64, (f64, f64)) {
    let tests = rounds.iter().rev().flat_map(|round| &round.tests);
    let found = tests.filter(|test| test.term == term).find_map(|test| test.estimate.as_ref()).unwrap().written();
    (found.value, found.standard_error, found.interval)
}

#[test]
fn exact_the_discrete_form_follows_from_the_gains_by_any_rule_of_integration() {
    let bs =
        Hidden::default().rewrite(&recorded(&BenchParameters::default(), &ExperimentPlan::bs_t_nt(1200.0, 20.0), 3));
    let found =
        speed_control(&SpeedControllers::of(&[&bs], bench_file("", &[]).limits.torque_nm), &work::Context::new());
    let controller = found.controllers[0].found.estimated().unwrap();
    let discrete = &controller.discrete;
    let [b_0, b_1] = &discrete.coefficients.parameters[..] else { panic!("{discrete:?}") };
    let (b_0, b_1) = (b_0.written(), b_1.written());
    // T_d*(k) − T_d*(k − 1) = K_p (e(k) − e(k − 1)) + K_i T e(k − 1).
    assert!((b_0.value - 0.9385).abs() < 1e-4 && (b_1.value - (1.865e-3 - 0.9385)).abs() < 1e-4, "{b_0:?} {b_1:?}");
    // b_0 + b_1 = K_i T is known much better than either: they are estimated together.
    let c = &discrete.coefficients.covariance;
    let of_sum = (c[0][0] + 2.0 * c[0][1] + c[1][1]).sqrt();
    let k_i = controller.with_delay.parameter(Quantity::IntegralGain).unwrap();
    assert!((of_sum / (1e-3 * k_i.standard_error) - 1.0).abs() < 1e-6, "{of_sum}");
    let gain = |rule| discrete.proportional_gains.iter().find(|(r, _)| *r == rule).unwrap().1.written().value;
    assert!((gain(IntegrationRule::Forward) - b_0.value).abs() < 1e-12);
    assert!((gain(IntegrationRule::Backward) + b_1.value).abs() < 1e-12);
    assert!((gain(IntegrationRule::Trapezoidal) - 0.5 * (b_0.value - b_1.value)).abs() < 1e-12);
    let residuals = |v: &rig::results::Validation| v.residuals.as_ref().unwrap().share_outside();
    assert!(residuals(&controller.validation_without_delay) > 0.05 && residuals(&controller.validation) < 0.05);
    assert!(controller.without_delay.parameter(Quantity::ControllerDelay).is_none());
}

#[test]
fn exact_noise_free_terms_are_written_as_they_are() {
    let quiet = Hidden { noise_rad_s: 0.0, demand_step_nm: 0.0, ..Hidden::default() };
    let cases = [
        (Hidden { filter_s: 3e-3, ..quiet.clone() }, Term::Filter, 3e-3),
        (Hidden { k_d: 0.004, ..quiet.clone() }, Term::Derivative, 0.004),
        (Hidden { k_ii: 0.3, ..quiet.clone() }, Term::SecondIntegrator, 0.3),
        (Hidden { offset_rpm: 0.2, ..quiet.clone() }, Term::SpeedOffset, 0.2),
    ];
    for (hidden, term, truth) in cases {
        let found = found_in(&hidden);
        assert_eq!(found.found().first(), Some(&term), "{:#?}", found.rounds);
        let (value, ..) = estimate_of(&found.rounds[..1], term);
        assert!((value / truth - 1.0).abs() < 0.02, "{term:?}: {value}");
    }
}

#[test]
fn stat_terms_beside_pi_and_delay_are_found_under_noise() {
    let cases = [
        (Hidden { filter_s: 2e-3, ..Hidden::default() }, Term::Filter, 2e-3),
        (Hidden { k_d: 0.002, ..Hidden::default() }, Term::Derivative, 0.002),
        (Hidden { k_ii: 0.2, ..Hidden::default() }, Term::SecondIntegrator, 0.2),
        (Hidden { offset_rpm: 0.05, ..Hidden::default() }, Term::SpeedOffset, 0.05),
    ];
    for (hidden, term, truth) in cases {
        let found = found_in(&hidden);
        assert_eq!(found.found(), [term], "{:#?}", found.rounds);
        let (value, error, _) = estimate_of(&found.rounds[..1], term);
        assert!((value - truth).abs() < 4.0 * error + 0.02 * truth, "{term:?}: {value} ± {error}");
        assert!(found.left_rad_s.1 < found.left_rad_s.0);
        let with = found.with_terms.unwrap();
        let k_p = with.parameter(Quantity::ProportionalGain).unwrap().written();
        assert!((k_p.value / 0.9385 - 1.0).abs() < 2e-3, "{k_p:?}");
    }
}

#[test]
fn stat_bends_of_the_feed_forward_are_found_and_a_straight_one_is_not_rejected() {
    let straight = bent(&Hidden::default(), &levels());
    assert_eq!(straight.found(), [], "{:#?}", straight.rounds);
    for point in &straight.map[1..KNOTS - 1] {
        let (low, high) = point.bend_interval_nm;
        assert!((point.bend_nm).abs() < 3.0 * 0.5 * (high - low), "{point:?}");
    }
    let cases = [
        (Hidden { bend_nm: 1.0, ..Hidden::default() }, Term::StaticMap),
        (Hidden { hysteresis_nm: 0.2, ..Hidden::default() }, Term::Hysteresis),
        (Hidden { friction_nm: 0.2, ..Hidden::default() }, Term::Friction),
    ];
    for (hidden, term) in cases {
        let found = bent(&hidden, &levels());
        assert_eq!(found.found(), [term], "{:#?}", found.rounds);
        if term != Term::StaticMap {
            let (value, error, _) = estimate_of(&found.rounds[..1], term);
            assert!((value - 0.2).abs() < 4.0 * error + 1e-3, "{term:?}: {value} ± {error}");
        }
    }
    let both = bent(&Hidden { bend_nm: 1.0, hysteresis_nm: 0.2, ..Hidden::default() }, &levels());
    assert_eq!(both.found(), [Term::StaticMap, Term::Hysteresis], "{:#?}", both.rounds);
}

#[test]
fn exact_the_static_map_is_that_of_the_controller() {
    let hidden = Hidden { bend_nm: 3.0, ..Hidden::default() };
    let found = bent(&hidden, &levels());
    let map = |speed: f64| hidden.static_nm(speed) - hidden.static_nm(found.map[0].speed_rad_s);
    for point in &found.map {
        // The hump is not straight between speeds: at its top, over the 290 rpm from one to the next, by 0.25 Nm.
        assert!((point.torque_nm - map(point.speed_rad_s)).abs() < 0.25, "{point:?}: {}", map(point.speed_rad_s));
    }
}

#[test]
fn regress_one_slope_does_not_tell_friction_compensation_and_says_so() {
    let found = bent(&Hidden::default(), &ExperimentPlan::ramp_n_nt(1200.0, 30.0));
    let friction = found.test(Term::Friction).unwrap();
    assert_eq!((friction.verdict, &friction.estimate), (Verdict::Undecided, &None), "{friction:?}");
    assert_eq!(found.test(Term::Hysteresis).unwrap().verdict, Verdict::NotFound);
}

/// Limit found in steps of N_d* without shaft.
fn limit_in(law: Option<AntiWindup>, rise_rpm: f64) -> Limit {
    let parameters = BenchParameters::default();
    let mut plan = ExperimentPlan::no_shaft_n_nt(1200.0, 24.0);
    plan.speed_rad_s = rig::experiment::Waveform::Square {
        first: 1200.0 * units::RPM_RAD_S,
        second: (1200.0 + rise_rpm) * units::RPM_RAD_S,
        dwell_s: 3.0,
    };
    let steps = recorded(&parameters, &plan, 5);
    let steps =
        law.map_or(steps.clone(), |law| Hidden { law, limit_nm: LIMIT_NM, ..Hidden::default() }.rewrite(&steps));
    let fit = estimate(&recorded(&parameters, &ExperimentPlan::bs_t_nt(1200.0, 20.0), 3), Some(LIMIT_NM)).unwrap();
    let moved = recorded(&parameters, &levels(), 4);
    let feed_forward = estimate_feed_forward(&moved, None, &fit, Some(LIMIT_NM)).unwrap();
    limit(&steps, &fit, Some(&feed_forward)).unwrap()
}

fn reached(found: Limit) -> LimitReached {
    match found {
        Limit::Reached(reached) => reached,
        Limit::NotReached { highest_nm } => panic!("{highest_nm} Nm"),
    }
}

#[test]
fn stat_anti_windup_is_found_where_the_limit_is_reached_for_long() {
    // The virtual bench itself integrates conditionally.
    let own = reached(limit_in(None, 800.0));
    assert!((own.limit_nm - LIMIT_NM).abs() < 0.01 && own.longest_s > 0.05, "{own:?}");
    let possible: Vec<AntiWindup> = own.possible().map(|test| test.law).collect();
    assert!(possible.contains(&AntiWindup::ConditionalIntegration), "{own:#?}");
    assert!(!possible.contains(&AntiWindup::None), "{own:#?}");
    for law in [AntiWindup::None, AntiWindup::Clamping] {
        let found = reached(limit_in(Some(law), 800.0));
        let possible: Vec<AntiWindup> = found.possible().map(|test| test.law).collect();
        assert!(possible.contains(&law), "{law:?}: {found:#?}");
        assert_eq!(possible.contains(&AntiWindup::None), law == AntiWindup::None, "{found:#?}");
    }
    let found = reached(limit_in(Some(AntiWindup::BackCalculation { tracking_s: 0.05 }), 800.0));
    let possible: Vec<AntiWindup> = found.possible().map(|test| test.law).collect();
    let [AntiWindup::BackCalculation { tracking_s }] = possible[..] else { panic!("{found:#?}") };
    assert!((tracking_s / 0.05 - 1.0).abs() < 0.1, "{tracking_s}");
}

#[test]
fn exact_a_limit_that_is_not_reached_is_not_found() {
    let bs = recorded(&BenchParameters::default(), &ExperimentPlan::bs_t_nt(1200.0, 20.0), 3);
    let fit = estimate(&bs, Some(LIMIT_NM)).unwrap();
    let Limit::NotReached { highest_nm } = limit(&bs, &fit, None).unwrap() else { panic!("no limit is near") };
    assert!(highest_nm > 40.0 && highest_nm < 100.0, "{highest_nm}");
}

/// On benches without anything beside PI, delay and a straight feed-forward, drawn at random, half of them with noise
/// that the controller does not see, terms are found as often as the level says, not more.
#[test]
#[ignore = "slow"]
fn stat_what_is_not_there_is_found_no_more_often_than_the_level_says() {
    let benches = 64;
    let found = benches::on_both_processors(benches, |seed| {
        let (parameters, speed_rpm, hidden) = benches::drawn(seed);
        // Every recording has noise of its own.
        let record = |plan: &ExperimentPlan, noise_seed: u64| match &hidden {
            Some(hidden) => Hidden { noise_seed, ..hidden.clone() }.rewrite(&recorded(&parameters, plan, seed)),
            None => recorded(&parameters, plan, seed),
        };
        let bs = record(&ExperimentPlan::bs_t_nt(speed_rpm, 12.0), 1000 + 2 * seed);
        let fit = estimate(&bs, Some(LIMIT_NM)).unwrap();
        let beside = structure(&bs, &fit, Some(LIMIT_NM)).unwrap();
        let moved = record(&ExperimentPlan::levels_n_nt(1200.0, 20.0), 1001 + 2 * seed);
        let lags = estimate_feed_forward(&moved, None, &fit, Some(LIMIT_NM)).unwrap().lags;
        let bent = feed_forward_terms(&moved, &fit, lags, Some(LIMIT_NM)).unwrap();
        let verdicts = |rounds: &[part_controller::speed_controller::Round]| -> Vec<(Term, f64, Verdict)> {
            rounds[0].tests.iter().map(|t| (t.term, t.adjusted_p_value, t.verdict)).collect()
        };
        (verdicts(&beside.rounds), verdicts(&bent.rounds))
    });
    let (beside, bent): (Vec<_>, Vec<_>) = found.into_iter().unzip();
    let counted = |all: &[Vec<(Term, f64, Verdict)>]| {
        let is_rejected = |tests: &&Vec<(Term, f64, Verdict)>| tests.iter().any(|(_, p, _)| *p < 0.01);
        let has_found = |tests: &&Vec<(Term, f64, Verdict)>| tests.iter().any(|(_, _, v)| *v == Verdict::Found);
        let rejected: Vec<_> = all.iter().filter(is_rejected).collect();
        println!("{rejected:?}");
        (rejected.len(), all.iter().filter(has_found).count())
    };
    let (beside, bent) = (counted(&beside), counted(&bent));
    println!("of {benches} benches: rejected, found beside PI and delay {beside:?}, of the feed-forward {bent:?}");
    // At 1 % each, five or more of 64 are rejected once in 1600 times.
    assert!(beside.0 <= 4 && bent.0 <= 4, "{beside:?} {bent:?}");
    assert_eq!((beside.1, bent.1), (0, 0));
}

fn options(draws: usize) -> NoiseTestOptions {
    NoiseTestOptions { draws, ..NoiseTestOptions::default() }
}

#[test]
fn exact_the_study_returns_the_controller_without_noise() {
    let speeds = held_speed(2).unwrap().within((0.0, 20.0));
    let found = noise_test(&speeds, &options(2), &work::Context::new()).unwrap();
    for case in found.cases.iter().filter(|case| case.noise == Noise::None) {
        for summary in &case.summaries {
            assert!((summary.mean / summary.truth - 1.0).abs() < 1e-6, "{:?} {summary:?}", case.estimator);
        }
    }
    let again = noise_test(&speeds, &options(2), &work::Context::new()).unwrap();
    assert_eq!(found, again);
}

/// Forward, noise that the controller sees makes no bias, and intervals are right; inverse, it does.
#[test]
#[ignore = "slow"]
fn stat_the_study_covers_the_truth_from_t_d_demand() {
    let draws = 40;
    let speeds = held_speed(2).unwrap().within((0.0, 20.0));
    let found = noise_test(&speeds, &options(draws), &work::Context::new()).unwrap();
    for case in found.cases.iter().filter(|case| case.noise != Noise::None) {
        for s in &case.summaries {
            println!(
                "{:?} {:?} {}: bias {:.2e}, st. dev. {:.2e}, claimed {:.2e}, coverage {:.2}",
                case.noise, case.estimator, s.quantity, s.bias, s.standard_deviation, s.claimed, s.coverage.estimate
            );
            if case.estimator == Estimator::Forward {
                assert!(s.bias.abs() < 4.0 * s.standard_deviation / (draws as f64).sqrt(), "{s:?}");
                // Four binomial standard deviations below 0.95.
                assert!(s.coverage.estimate > 0.81, "{s:?}");
            }
        }
        assert_eq!(case.failed, 0);
    }
    let low_pass = |estimator| {
        let case = found.cases.iter().find(|c| (c.noise, c.estimator) == (Noise::LowPass, estimator)).unwrap();
        case.summaries[1].clone()
    };
    assert!(low_pass(Estimator::Inverse).bias.abs() > 5.0 * low_pass(Estimator::Forward).bias.abs());
}

fn experiments(bench: &str, file: &BenchFile) -> Vec<Experiment> {
    let read = |(name, recording): (String, recording::Recording)| {
        prepare(&name, &recording, file, file.label_of(&name).unwrap()).unwrap().0
    };
    recordings(bench).into_iter().map(read).collect()
}

#[test]
fn ref_bench_a_has_pi_delay_and_straight_feed_forward() {
    let file = bench_file("torque = \"400 Nm\"", &[]);
    let all = experiments("bench-a", &file);
    if all.is_empty() {
        return;
    }
    let found = speed_control(
        &SpeedControllers::of(&all.iter().collect::<Vec<_>>(), file.limits.torque_nm),
        &work::Context::new(),
    );
    assert_eq!(found.controllers.len(), 3);
    for one in &found.controllers {
        let controller = one.found.estimated().unwrap();
        // truth.json: Kp 0.9385, Ki 1.865, delay 1 ms.
        for (quantity, truth, tolerance) in [
            (Quantity::ProportionalGain, 0.9385, 1e-3),
            (Quantity::IntegralGain, 1.865, 1e-3),
            (Quantity::ControllerDelay, 1e-3, 3e-4),
        ] {
            let p = controller.with_delay.parameter(quantity).unwrap().written();
            assert!((p.value - truth).abs() < tolerance, "{}: {p:?}", one.file);
        }
        let outside = |v: &rig::results::Validation| v.residuals.as_ref().unwrap().share_outside();
        assert!(outside(&controller.validation_without_delay) > 0.05 && outside(&controller.validation) < 0.05);
        assert_eq!(controller.structure.estimated().unwrap().found(), [], "{}: {:#?}", one.file, controller.structure);
    }
    let feed_forward: Vec<_> = found.feed_forward.iter().filter_map(|one| one.found.estimated()).collect();
    assert_eq!(feed_forward.len(), 2);
    for one in feed_forward {
        let terms = one.terms.estimated().unwrap();
        assert_eq!(terms.found(), [], "{:#?}", terms.rounds);
        for point in &terms.map {
            // truth.json: ff_speed 0.012 Nm/rpm.
            let truth = 0.012 * (point.speed_rad_s - terms.map[0].speed_rad_s) / units::RPM_RAD_S;
            assert!((point.torque_nm - truth).abs() < 0.02 * truth + 1e-9, "{point:?}: {truth}");
        }
    }
}

#[test]
fn ref_bench_b_has_pi_delay_and_straight_feed_forward() {
    let names = [
        ("dyno_speed", "\"nBremse\""),
        ("engine_speed", "\"nMotor\""),
        ("dyno_speed_demand", "\"nBremse_Soll\""),
        ("dyno_torque_demand", "\"MdBremse_Soll\""),
        ("air_gap_torque", "\"MdLuftspalt\""),
        ("load_cell_torque", "\"MdKraftdose\""),
        ("system_shaft_torque", "\"MdWelle\""),
    ];
    let file = bench_file("torque = \"260 Nm\"", &names);
    let all = experiments("bench-b", &file);
    if all.is_empty() {
        return;
    }
    let found = speed_control(
        &SpeedControllers::of(&all.iter().collect::<Vec<_>>(), file.limits.torque_nm),
        &work::Context::new(),
    );
    let controller = found.controllers[0].found.estimated().unwrap();
    assert_eq!(controller.structure.estimated().unwrap().found(), [], "{:#?}", controller.structure);
    let agree = found.feed_forward.iter().filter_map(|one| one.found.estimated()).map(|one| {
        assert_eq!(one.terms.estimated().unwrap().found(), []);
        one.straight.estimate.parameter(Quantity::SpeedFeedForward).unwrap().interval
    });
    let intervals: Vec<(f64, f64)> = agree.collect();
    let [first, second] = intervals[..] else { panic!("{intervals:?}") };
    assert!(first.0 < second.1 && second.0 < first.1, "{intervals:?}");
}
