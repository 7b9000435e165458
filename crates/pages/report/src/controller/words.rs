//! The speed controller, in words and figures.

use page::{Abscissa, Axis, Figure, Layer, Panel, Rounded, Style, rounded};
use part_controller::noise_test::{Case, Estimator, Noise, NoiseTest, PUBLISHED, PublishedRow, Summary};
use part_controller::speed_controller::{
    AntiWindup, Controller, FeedForwardFound, FeedForwardTerms, IntegrationRule, Limit, LimitReached, MATTERS,
    MapPoint, Round, SpeedControl, Structure, Term, TermTest, Verdict,
};
use rig::results::{Outcome, Quantity, ResidualTest, WrittenParameter};
use units::RPM_RAD_S;

use crate::figures::HEIGHT;
use crate::wording::{self, number};

/// Room beside the first and last point, as a part of the axis.
const MARGIN: f64 = 0.03;
/// Truths that differ by less than this part of themselves are the same.
const SAME: f64 = 1e-9;

/// A term in a few words.
pub fn term(term: Term) -> &'static str {
    match term {
        Term::Filter => "filter on N_d",
        Term::Derivative => "derivative",
        Term::SecondIntegrator => "second integrator",
        Term::SpeedOffset => "offset in the speed error",
        Term::StaticMap => "bend in the static map",
        Term::Hysteresis => "hysteresis",
        Term::Friction => "friction compensation",
    }
}

/// Verdict of a test, in a word or two.
pub fn verdict(test: &TermTest) -> &'static str {
    match test.verdict {
        Verdict::Found => "found",
        Verdict::Negligible => "too small to matter",
        Verdict::NotFound => "none seen",
        Verdict::Undecided => "not testable",
    }
}

/// A probability, e.g. `0.34` or `below 0.0001`.
pub fn probability(p: f64) -> String {
    match p {
        p if !p.is_finite() => number::NOT_KNOWN.to_owned(),
        p if p < 1e-4 => "below 0.0001".to_owned(),
        p => number::significant(p, 2),
    }
}

/// The experiment that can show a term.
fn remedy(of: Term) -> &'static str {
    match of {
        Term::Filter | Term::Derivative => {
            "run BS_T_NT longer, with the engine's torque switched as fast as it fires, so that N_d moves at 10 to 50 Hz"
        }
        Term::SecondIntegrator | Term::SpeedOffset => "run BS_T_NT for some minutes, so that slow drift shows it",
        Term::StaticMap => "run Levels_N_NT over all speeds that matter",
        Term::Hysteresis => "run Levels_N_NT, which comes to its levels from both sides",
        Term::Friction => {
            "run Levels_N_NT with several slopes: with one slope alone the sign of dN_d*/dt and dN_d*/dt are the same"
        }
    }
}

/// The terms that these data cannot show, each with the experiment that can.
pub fn undecided_terms(tests: &[TermTest]) -> Vec<String> {
    let undecided = tests.iter().filter(|test| test.verdict == Verdict::Undecided);
    undecided.map(|test| format!("{}: these data cannot show it; {}", term(test.term), remedy(test.term))).collect()
}

/// How the residual depends on T_d*, e.g. `outside the 99 % region at 88 % of the lags`.
pub fn dependence(test: &ResidualTest) -> String {
    let share = test.share_outside();
    let place = match (test.depends_on_input(), test.has_many_outside()) {
        (true, _) => "outside",
        (false, true) => "outside, though by too little to matter,",
        (false, false) => "inside",
    };
    format!(
        "{place} the {} region ({} of the lags 0 to {} beyond it)",
        number::share(test.level),
        number::share(share),
        test.cross_correlation.len() / 2
    )
}

/// Effect of the delay, in a sentence or two.
pub fn delay(found: &Controller) -> String {
    let of = |validation: &rig::results::Validation| {
        let residuals =
            validation.residuals.as_ref().map_or_else(String::new, |test| format!(", {}", dependence(test)));
        format!("fit {} on the held-out stretch{residuals}", number::fit(validation.fit_percent))
    };
    format!(
        "Correlation of residual and T_d*: PI alone {}; PI and delay {}.",
        of(&found.validation_without_delay),
        of(&found.validation)
    )
}

/// K_p and K_i in SI.
pub fn gains_in_si(found: &Controller) -> impl Iterator<Item = WrittenParameter> {
    let gains = [Quantity::ProportionalGain, Quantity::IntegralGain].into_iter();
    gains.filter_map(|gain| Some(found.with_delay.parameter(gain)?.written_in_si()))
}

/// The rules of integration, which the recordings cannot distinguish.
pub fn rules(found: &Controller) -> String {
    let rule = |rule: IntegrationRule| match rule {
        IntegrationRule::Forward => "forward Euler",
        IntegrationRule::Trapezoidal => "trapezoidal",
        IntegrationRule::Backward => "backward Euler",
    };
    let gains = &found.discrete.proportional_gains;
    let each = gains.iter().map(|(by, gain)| format!("{} {}", rule(*by), number::parameter(gain)));
    format!(
        "The recordings cannot show which integration rule the controller uses: all give the same b_0 and b_1, and \
         the same K_i. K_p by rule: {}.",
        each.collect::<Vec<_>>().join("; ")
    )
}

/// Findings beside PI and delay.
pub fn structure(found: &Structure) -> String {
    beyond_pi(found.level, &found.found(), found.left_rad_s)
}

/// The same of the terms found at a level, and the speed that stays unexplained without and with them.
pub fn beyond_pi(level: f64, terms: &[Term], left_rad_s: (f64, f64)) -> String {
    let level = format!("{} %", number::significant(100.0 * level, 2));
    let rpm = |rad_s: f64| number::significant_with_unit(rad_s / RPM_RAD_S, 2, "rpm");
    if terms.is_empty() {
        return format!(
            "No term beyond PI and delay is found at the {level} level; {} of N_d stays unexplained.",
            rpm(left_rad_s.0)
        );
    }
    format!(
        "Found at the {level} level beyond PI and delay: {}. Without it {} of N_d stays unexplained, with it {}.",
        names(terms),
        rpm(left_rad_s.0),
        rpm(left_rad_s.1)
    )
}

/// Terms as a list.
fn names(terms: &[Term]) -> String {
    wording::join(&terms.iter().map(|t| term(*t).to_owned()).collect::<Vec<_>>(), "and")
}

/// Against what a round tests; `base` is what is there without terms, e.g. `PI and delay`.
pub fn round(base: &str, round: &Round) -> String {
    match round.beside.as_slice() {
        [] => format!("Beside {base}"),
        beside => format!("Beside {base}, with {}", names(beside)),
    }
}

/// Findings on the feed-forward beside k and k_a.
pub fn bends(terms: &[Term]) -> String {
    match terms {
        [] => "No term beyond k and k_a is found.".to_owned(),
        terms => format!("Found beyond k and k_a: {}.", names(terms)),
    }
}

/// Meaning of `too small to matter`, where it is said of any test.
pub fn negligible(tests: &[TermTest]) -> Option<String> {
    let is_said = tests.iter().any(|test| test.verdict == Verdict::Negligible);
    is_said.then(|| {
        format!(
            "Too small to matter: differs from zero, but explains less than {} % of the variance of the residual of N_d.",
            number::significant(100.0 * MATTERS, 2)
        )
    })
}

/// A law of anti-windup.
pub fn law(law: AntiWindup) -> String {
    match law {
        AntiWindup::None => "none: the integrator runs on".to_owned(),
        AntiWindup::Clamping => "clamping: it rests at the limit".to_owned(),
        AntiWindup::ConditionalIntegration => {
            "conditional integration: it rests if the error would drive it further".to_owned()
        }
        AntiWindup::BackCalculation { tracking_s } => {
            format!("back-calculation, tracking time {}", number::duration(tracking_s))
        }
    }
}

/// Findings of the recordings on the limit of T_d*, one text a recording that reaches it, and one for all others.
pub fn limits(found: &SpeedControl) -> Vec<String> {
    let mut all = Vec::new();
    let (mut highest, mut is_reached) = (None, false);
    for one in &found.limits {
        match &one.found {
            Outcome::Estimated(Limit::Reached(reached)) => {
                is_reached = true;
                all.push(format!("{}: {}", one.file, at_limit(reached)));
            }
            Outcome::Estimated(Limit::NotReached { highest_nm }) => {
                highest = Some(highest.map_or(*highest_nm, |highest: f64| highest.max(*highest_nm)));
            }
            Outcome::NotEstimated { needs: why } => all.push(format!("{}: {}", one.file, wording::reasons(why))),
        }
    }
    all.extend(highest.filter(|_| !is_reached).map(|highest| {
        format!(
            "no recording rests at a limit of T_d* (highest {}), so limit and anti-windup are not known; {RUN_TO_LIMIT}",
            number::significant_with_unit(highest, 4, "Nm")
        )
    }));
    all
}

const RUN_TO_LIMIT: &str =
    "run NoShaft_N_NT with steps of N_d* so high that T_d* rests at its limit for 0.05 s or more, e.g. --set rise=800";

fn at_limit(found: &LimitReached) -> String {
    let rests = format!(
        "T_d* is limited to {} ({} of the time, at most {} on end)",
        number::significant_with_unit(found.limit_nm, 4, "Nm"),
        number::share(found.share),
        number::duration(found.longest_s)
    );
    let possible: Vec<String> = found.possible().map(|test| law(test.law)).collect();
    let verdict = match (found.laws.is_empty(), possible.as_slice()) {
        (true, _) => format!(
            "too short to show its anti-windup (at stake are {}, and a reading is known to {}); {RUN_TO_LIMIT}",
            number::significant_with_unit(found.at_stake_nm, 2, "Nm"),
            number::significant_with_unit(found.reading_nm, 2, "Nm")
        ),
        (_, []) => "no law of anti-windup that is known here explains the integrator; check K_p, K_i and feed-forward"
            .to_owned(),
        (_, [only]) => format!("anti-windup: {only}"),
        (_, several) => format!(
            "anti-windup undecided between {}: at stake are {}, and a reading is known to {}; {RUN_TO_LIMIT}",
            wording::join(several, "and"),
            number::significant_with_unit(found.at_stake_nm, 2, "Nm"),
            number::significant_with_unit(found.reading_nm, 2, "Nm")
        ),
    };
    format!("{rests}, {} episodes; {verdict}", found.episodes)
}

/// The part of the feed-forward that no recording shows.
pub const M_IS_NOT_SHOWN: &str =
    "The constant part of the feed-forward, m, cannot be estimated: the integrator's initial state takes it up.";

/// The feed-forward beside PI alone.
pub fn improvement(found: &FeedForwardFound) -> String {
    let straight = &found.straight;
    format!(
        "With the feed-forward k N_d* + k_a dN_d*/dt, the fit on {} is {}; PI alone has {}.",
        straight.validation.stretch.file,
        number::fit(straight.validation.fit_percent),
        number::fit(straight.pi_alone.fit_percent)
    )
}

/// The noise of a case, with its band.
pub fn noise(study: &NoiseTest, of: Noise) -> String {
    let options = &study.options;
    let hz = |f: f64| number::significant(f, 3);
    match of {
        Noise::None => "no noise".to_owned(),
        Noise::LowPass => {
            format!("low-pass {} Hz, SNR {}", hz(options.low_pass_hz), number::significant(options.low_pass_snr, 3))
        }
        Noise::BandPass => format!(
            "band-pass {} to {} Hz, SNR {}",
            hz(options.band_pass_hz.0),
            hz(options.band_pass_hz.1),
            number::significant(options.band_pass_snr, 3)
        ),
    }
}

/// Published draw of a noise, where the truth is that of the thesis: K_p or K_i of table 7.1.
pub fn published(study: &NoiseTest, of: Noise, quantity: Quantity) -> Option<f64> {
    let same = (study.options.k_p, study.options.k_i) == (PUBLISHED[0].k_p, PUBLISHED[0].k_i);
    let row: &PublishedRow = PUBLISHED.iter().find(|row| same && row.noise == of)?;
    match quantity {
        Quantity::ProportionalGain => Some(row.k_p),
        Quantity::IntegralGain => Some(row.k_i),
        _ => None,
    }
}

/// An estimator in a few words.
pub fn estimator(of: Estimator) -> &'static str {
    match of {
        Estimator::Forward => "T_d* from N_d",
        Estimator::Inverse => "N_d from T_d*",
    }
}

/// How noise and SNR are meant.
pub const NOISE_TEST_DEFINITIONS: &str = "SNR: variance of the speed error N_d − N_d* over that of the noise. The \
     noise is added to the N_d that the controller sees, and not to the N_d of the estimate. The thesis (§7.1) gives \
     neither its bands nor its definition of SNR; its table 7.1 is one draw of each, estimated T_d* from N_d. \
     Coverage: the share of the 95 % intervals that contain the true value; in brackets its own 95 % interval, from \
     the number of draws (Clopper–Pearson).";
/// Uses of the two estimators.
pub const ESTIMATORS: &str = "dynoid estimates N_d from T_d*, because the recorded encoder has noise, which would \
     bias T_d* from N_d. Noise that the controller sees, but no channel records, biases N_d from T_d*.";

/// Cross-correlations side by side, then static maps.
pub fn figures(found: &SpeedControl) -> Vec<Figure> {
    correlation_figures(found).into_iter().chain(map_figures(found)).collect()
}

/// Residuals of PI without and with delay against T_d*, one figure a recording with constant N_d*.
pub fn correlation_figures(found: &SpeedControl) -> Vec<Figure> {
    let controllers = found.controllers.iter().filter_map(|one| Some((one.file.as_str(), one.found.estimated()?)));
    controllers.filter_map(|(file, controller)| correlation_figure(file, controller)).collect()
}

/// The static feed-forward over N_d*, one figure a recording in which it moves.
pub fn map_figures(found: &SpeedControl) -> Vec<Figure> {
    let maps = found.feed_forward.iter().filter_map(|one| {
        let terms = one.found.estimated()?.terms.estimated()?;
        (!terms.map.is_empty()).then(|| map_figure(&one.file, terms))
    });
    maps.collect()
}

fn correlation_figure(file: &str, found: &Controller) -> Option<Figure> {
    let without = found.validation_without_delay.residuals.as_ref()?;
    let with = found.validation.residuals.as_ref()?;
    let panels = vec![
        correlation_panel("PI alone: residual with T_d*", Style::Other, without),
        correlation_panel("PI and delay: residual with T_d*", Style::Modelled, with),
    ];
    Some(
        Figure::new(&format!("{file}: correlation of residual and T_d*"), Axis::linear("lag", "ms"), panels)
            .with_caption(delay(found)),
    )
}

fn correlation_panel(label: &str, style: Style, test: &ResidualTest) -> Panel {
    let bound = test.cross_correlation_bound;
    let first = -((test.cross_correlation.len() / 2) as f64);
    let lags: Vec<f64> =
        (0..test.cross_correlation.len()).map(|n| 1e3 * test.sample_time_s * (first + n as f64)).collect();
    let region = Layer::YRegion {
        low: Rounded(-bound),
        high: Rounded(bound),
        label: format!("{} region", number::share(test.level)),
    };
    let stems = Layer::Stems {
        name: label.to_owned(),
        style,
        x: Abscissa::Values(rounded(&lags)),
        y: rounded(&test.cross_correlation),
    };
    let largest = test.cross_correlation.iter().fold(bound, |largest, c| largest.max(c.abs()));
    Panel::new(Axis::linear(label, "").within(-1.2 * largest, 1.2 * largest), HEIGHT, vec![region, stems])
}

fn map_figure(file: &str, found: &FeedForwardTerms) -> Figure {
    let of = |f: &dyn Fn(&MapPoint) -> f64| found.map.iter().map(f).collect::<Vec<f64>>();
    let rpm = of(&|p| p.speed_rad_s / RPM_RAD_S);
    let points = |value: &dyn Fn(&MapPoint) -> f64, interval: &dyn Fn(&MapPoint) -> (f64, f64)| Layer::Points {
        name: "static map, 95 % intervals".to_owned(),
        style: Style::Measured,
        x: Abscissa::Values(rounded(&rpm)),
        y: rounded(&of(value)),
        low: Some(rounded(&of(&|p| interval(p).0))),
        high: Some(rounded(&of(&|p| interval(p).1))),
    };
    let line = Layer::curve("straight between its ends", Style::Modelled, &rpm, &of(&|p| p.torque_nm - p.bend_nm));
    let zero = Layer::HorizontalMark { y: Rounded(0.0), label: "straight".to_owned() };
    let map = points(&|p| p.torque_nm, &|p| p.interval_nm);
    let bend = points(&|p| p.bend_nm, &|p| p.bend_interval_nm);
    let panels = vec![
        Panel::new(Axis::linear("feed-forward", "Nm"), HEIGHT, vec![line, map]),
        Panel::new(Axis::linear("beyond straight", "Nm"), HEIGHT, vec![zero, bend]),
    ];
    let tested = found.test(Term::StaticMap).map_or_else(String::new, |test| {
        format!(" Bend: {} (p = {}).", verdict(test), probability(test.adjusted_p_value))
    });
    let (low, high) = (rpm.first().copied().unwrap_or(0.0), rpm.last().copied().unwrap_or(1.0));
    let margin = MARGIN * (high - low);
    let x = Axis::linear("N_d*", "rpm").within(low - margin, high + margin);
    Figure::new(&format!("{file}: static feed-forward over N_d*"), x, panels)
        .with_caption(format!("Each speed less the lowest, since m is not known.{tested}"))
}

/// Every draw of the study, as histograms of K_p and K_i for each noise.
pub fn noise_test_figures(study: &NoiseTest) -> Vec<Figure> {
    let is_shown = |case: &&Case| case.noise != Noise::None && case.estimator == Estimator::Forward;
    let gains = |case: &'_ Case| -> Vec<Figure> {
        let gains = case.summaries.iter().filter(|summary| summary.quantity != Quantity::ControllerDelay);
        gains.map(|summary| histogram(study, case, summary)).collect()
    };
    study.cases.iter().filter(is_shown).flat_map(gains).collect()
}

fn histogram(study: &NoiseTest, case: &Case, summary: &Summary) -> Figure {
    let once = published(study, case.noise, summary.quantity);
    let summary = summary.written();
    let (x, y) = bars(&summary.values);
    let symbol = summary.symbol;
    let stems = Layer::Stems { name: "draws".to_owned(), style: Style::Modelled, x: Abscissa::Values(x), y };
    let mark = |value: f64, label: &str| Layer::VerticalMarks { x: rounded(&[value]), label: label.to_owned() };
    let once = once.filter(|value| (value / summary.truth - 1.0).abs() > SAME);
    let marks = [mark(summary.truth, "truth")].into_iter().chain(once.map(|value| mark(value, "table 7.1")));
    let panel = Panel::new(Axis::linear("draws", ""), HEIGHT, std::iter::once(stems).chain(marks).collect());
    let title = format!("{symbol} over all draws: {}", noise(study, case.noise));
    let caption = format!(
        "Estimated {}: mean {}, standard deviation {}, {} of the 95 % intervals contain the true value.",
        estimator(case.estimator),
        number::significant_with_unit(summary.mean, 5, summary.unit),
        number::significant_with_unit(summary.standard_deviation, 2, summary.unit),
        number::proportion(&summary.coverage)
    );
    Figure::new(&title, Axis::linear(symbol, summary.unit), vec![panel]).with_caption(caption)
}

/// How many values lie in each of equal steps, as many as the root of their number.
fn bars(values: &[f64]) -> (Vec<Rounded>, Vec<Rounded>) {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let steps = (values.len() as f64).sqrt().ceil().max(1.0) as usize;
    let width = ((high - low) / steps as f64).max(f64::MIN_POSITIVE);
    let mut counts = vec![0.0; steps];
    for value in values {
        counts[(((value - low) / width) as usize).min(steps - 1)] += 1.0;
    }
    let centres: Vec<f64> = (0..steps).map(|i| low + (i as f64 + 0.5) * width).collect();
    (rounded(&centres), rounded(&counts))
}
