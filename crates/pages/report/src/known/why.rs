//! Reasons for a grade as sentences.

use part_engine::Certainty;
use rig::Role;
use rig::facts::BenchVariant;
use rig::results::{Parameter, Reason};
use study::known::{FoundInertia, SineTests, Source, Why};

use crate::wording::{self, number};
use crate::{controller, engine, torque, torque_control};

/// A reason why the quantity of a symbol is known as well as it is, as one sentence or several.
pub(super) fn sentence(symbol: &str, why: &Why) -> String {
    match why {
        Why::Needs(needs) => needed(needs),
        Why::From(sources) => from(sources),
        Why::HeldOut { signal, fit_percent } => {
            format!("On data it has not seen it follows {signal} with a fit of {}.", number::fit(*fit_percent))
        }
        Why::DependsOn(input) => {
            format!("What it leaves still depends on {input}: something is missing in the model.")
        }
        Why::DelaySeen { input, share } => format!(
            "Without the delay, what PI leaves depends on {input} at {} of the lags; with the delay it does not.",
            number::share(*share)
        ),
        Why::DelayNotSeen(input) => {
            format!("With the delay and without it, what PI leaves does not depend on {input}.")
        }
        Why::IntegrationRule => "The recordings cannot show which integration rule the controller uses; with another rule K_p would be less, by at \
             most K_i times the sample time."
            .to_owned(),
        Why::BeyondPi { level, terms, left_rad_s } => controller::beyond_pi(*level, terms, *left_rad_s),
        Why::PiAlone(fit_percent) => format!("PI alone follows the same stretch with {}.", number::fit(*fit_percent)),
        Why::BeyondFeedForward(terms) => controller::bends(terms),
        Why::ConstantInInitialState => controller::M_IS_NOT_SHOWN.to_owned(),
        Why::DelayAlone(fit_percent) => {
            format!("A delay alone follows the same stretch with {}.", number::fit(*fit_percent))
        }
        Why::ClockOfDelay { skew, delay } => torque::clock_of_delay(skew.as_ref(), delay.as_ref()),
        Why::BeforeDemand(delay) => torque::before_demand(symbol, delay) + ".",
        Why::LagBelowSample { lag_s, sample_s } => format!(
            "The lag of {} is shorter than the {} between samples of T_d,calc, so the sum of delay and lag is known better than each alone.",
            number::duration(*lag_s),
            number::duration(*sample_s)
        ),
        Why::SecondOrder(test) => wording::capitalised(&torque_control::beyond(test.as_ref())) + ".",
        Why::OtherRecordings { count, apart } => agreement(*count, apart),
        Why::BeyondNoise(share) => format!(
            "At {} of the frequencies the residual of the shaft is larger than noise explains.",
            number::share(*share)
        ),
        Why::IfStampsWereExact(plain) => timing(symbol, plain),
        Why::ComputedWithInertia { stated_kg_m2, uncertainty_percent, estimated } => {
            computed(*stated_kg_m2, *uncertainty_percent, estimated.as_ref())
        }
        Why::Together { recordings, apart, parameter } => together(symbol, *recordings, *apart, parameter),
        Why::NotChecked(variant) => not_checked(*variant).to_owned(),
        Why::Inertia { found, agree, stated_kg_m2 } => inertia(found, *agree, *stated_kg_m2),
        Why::Skew => {
            "A skew is by how much the time stamps of a signal are late. It is estimated with K and B; no second method checks it."
                .to_owned()
        }
        Why::AgainstDemand(source) => format!("Measured against T_d* in {}.", stretch(source)),
        Why::Methods { count, agree } => match agree {
            Some(true) => format!("{count} methods estimate it, and they agree."),
            Some(false) => format!("The {count} methods that estimate it do not agree."),
            None => "No second method checks it.".to_owned(),
        },
        Why::BesideBend { role, late } => beside_bend(*role, late),
        Why::ShaftOff { files, is_small } => shaft_off(files, *is_small),
        Why::InModel { files } => {
            format!("From {}, with the shaft off; predictions count it.", wording::join(files, "and"))
        }
        Why::SpeedsShowNone => "The recorded speeds do not show it.".to_owned(),
        Why::NoFriction(needs) => wording::capitalised(&format!("{}.", wording::reasons(needs))),
        Why::FrictionIn(file) => {
            format!("It is no part of the model; `dynoid friction` estimates it from {file}.")
        }
        Why::ShaftOn => {
            "With the shaft on it cannot be separated from engine torque, and no recording is without shaft; run NoShaft_N_NT."
                .to_owned()
        }
        Why::NotRecorded { replayed: false } => "No bench records it, and nothing was replayed.".to_owned(),
        Why::NotRecorded { replayed: true } => {
            "No bench records it; replays reconstruct it from N_e and T_shaft, `dynoid engine` with its uncertainty."
                .to_owned()
        }
        Why::Rebuilt { file, certainty } => rebuilt(file, certainty),
        Why::NoMasses(needs) => wording::capitalised(&format!("{}.", wording::reasons(needs))),
        Why::NotRebuilt => "It could be rebuilt in no recording.".to_owned(),
        Why::UncertainBy { parameter, share } => format!(
            "The largest part of its uncertainty, {}, comes from {}.",
            number::share(*share),
            parameter.symbol()
        ),
        Why::SineTests(tests) => sine_tests(*tests),
        Why::Inertias { dyno, engine } => inertias(*dyno, *engine),
        Why::NothingUnseen => {
            "No recording was replayed that the estimates have not seen; record another experiment.".to_owned()
        }
        Why::Replayed { file, fits } => replayed(file, fits),
        Why::ReplayHasItsEngine => "T_e, which drives the replay, is reconstructed from the same recording: a replay tests the dynamometer’s side and the shaft more than the engine’s.".to_owned(),
    }
}

fn needed(needs: &[Reason]) -> String {
    format!("It needs {}.", wording::needs(needs).trim_end_matches('.'))
}

/// From which recording an estimate is, for how long, and what was done in it.
fn from(sources: &[Source]) -> String {
    match sources {
        [] => "The study does not state from which data.".to_owned(),
        _ => format!("From {}.", wording::join(&sources.iter().map(stretch).collect::<Vec<_>>(), "and")),
    }
}

fn stretch(source: &Source) -> String {
    let done = source.label.as_ref().and_then(wording::experiment).map(|words| format!(" ({words})"));
    format!("{} of {}{}", number::duration(source.duration_s), source.file, done.unwrap_or_default())
}

fn agreement(count: usize, apart: &[(String, Parameter)]) -> String {
    let listed: Vec<String> =
        apart.iter().map(|(file, other)| format!("{file} ({})", number::parameter(other))).collect();
    match (count, listed.as_slice()) {
        (0, _) => "No second recording checks it.".to_owned(),
        (1, []) => "The one other recording that shows it agrees: the intervals overlap.".to_owned(),
        (2, []) => "Both other recordings that show it agree: the intervals overlap.".to_owned(),
        (n, []) => format!("All {n} other recordings that show it agree: the intervals overlap."),
        (n, _) => {
            format!(
                "Of {n} other recordings that show it, {} not agree: {}.",
                if listed.len() == 1 { "one does".to_owned() } else { format!("{} do", listed.len()) },
                wording::join(&listed, "and")
            )
        }
    }
}

fn timing(symbol: &str, plain: &Parameter) -> String {
    let plain = plain.written();
    format!(
        "{symbol} depends on the timing of the signals, which is estimated with it. If the time stamps were exact, {symbol} would be {}.",
        number::significant_with_unit(plain.value, 3, plain.notation.unit)
    )
}

fn computed(stated_kg_m2: f64, uncertainty_percent: f64, estimated: Option<&Parameter>) -> String {
    let value = number::measure(stated_kg_m2, "kg m²");
    let how = match estimated {
        Some(own) => format!(
            "estimated with it: {}. The bench file states {value}, used with a standard uncertainty of {uncertainty_percent} %",
            number::parameter(own)
        ),
        None => format!("taken as exact: {value}, as the bench file states it"),
    };
    format!("The shaft’s torque is not measured but computed with J_d, which is {how}.")
}

fn together(symbol: &str, recordings: usize, apart: bool, parameter: &Parameter) -> String {
    let verdict = if apart { "which differ in K and B by more than their own intervals allow" } else { "which agree" };
    format!("All {recordings} recordings together, {verdict}, give {symbol} = {}.", number::parameter(parameter))
}

fn not_checked(variant: BenchVariant) -> &'static str {
    match variant {
        BenchVariant::LoadCell => {
            "No recording shows whether it is true; WhiteNoise_T_TN or Multisine_T_TN would show it."
        }
        BenchVariant::TorqueFlange => {
            "No recording shows whether it is true; behind a dual-mass flywheel no recording with the shaft on can."
        }
    }
}

fn inertia(found: &[FoundInertia], agree: bool, stated_kg_m2: f64) -> String {
    let words = found.iter().map(|one| {
        let file = one.file.as_deref().unwrap_or("the recordings without shaft");
        format!("{file} gives {}", number::parameter(&one.parameter))
    });
    let words: Vec<String> = words.collect();
    let verdict = if agree { "which agrees, within 1 % or its interval, with" } else { "which does not hold" };
    let stated = number::measure(stated_kg_m2, "kg m²");
    format!("{}, {verdict} the {stated} of the bench file.", wording::join(&words, "and"))
}

/// How a torque signal lies against the moment at which the course of N_d bends, in a sentence.
fn beside_bend(role: Role, late: &Parameter) -> String {
    let turned = |value: f64| if late.value < 0.0 { -value } else { value };
    let (a, b) = (turned(late.interval.0), turned(late.interval.1));
    let apart = Parameter { value: late.value.abs(), interval: (a.min(b), a.max(b)), ..late.clone() };
    let order = if late.value < 0.0 { "before" } else { "after" };
    format!("{} comes {} {order} the course of N_d bends.", role.symbol(), number::parameter(&apart))
}

fn shaft_off(files: &[String], is_small: bool) -> String {
    let small = if is_small { " It does not differ significantly from zero, and is small in any case." } else { "" };
    format!("From {}, with the shaft off.{small}", wording::join(files, "and"))
}

fn rebuilt(file: &str, certainty: &Certainty) -> String {
    format!("No bench records it. Best in {file}: {}.", engine::rebuilt(certainty))
}

fn sine_tests(tests: Option<SineTests>) -> String {
    match tests {
        None => "No sine test checks it; Sine_T_TN would.".to_owned(),
        Some(SineTests { count, mean_deviation }) => format!(
            "{count} sine tests away from engine orders differ from it by {} on average. The model was not estimated from them.",
            number::share(mean_deviation)
        ),
    }
}

fn inertias(dyno: Option<f64>, engine: Option<f64>) -> String {
    let of = |symbol: &str, share: Option<f64>| match share {
        Some(share) => format!("{symbol} by {} %", number::significant(100.0 * share, 2)),
        None => format!("{symbol} as exact"),
    };
    format!(
        "The interval contains the standard uncertainty of the model’s inertias: {} and {}.",
        of("J_d", dyno),
        of("J_e", engine)
    )
}

fn replayed(file: &str, fits: &[(String, f64)]) -> String {
    let signals: Vec<String> =
        fits.iter().map(|(signal, fit_percent)| format!("{signal} {}", number::fit(*fit_percent))).collect();
    format!("Replayed on {file}: {}.", wording::join(&signals, "and"))
}
