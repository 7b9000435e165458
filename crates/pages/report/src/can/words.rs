//! Words of requirements, statistics and limits.

use bench_model::document::Range;
use capability::{Answer, Beyond, LimitOf, Verdict};
use cycle::{Checked, Omission, Omitted, Own, RequirementSet, Sensor, Signal, Statistic};
use page::{Finding, Tone};
use signal::proportion::Proportion;
use units::RPM_RAD_S;

use crate::wording::number;

/// Digits that a number beside its limit has at least.
const FEWEST_DIGITS: i32 = 4;
/// Digits that it has at most.
const MOST_DIGITS: i32 = 12;
/// Share of benches above which a miss prevents a yes on its own.
const PREVENTS: f64 = 0.05;

/// A signal by its name, with the unit it is reported in and SI per unit.
pub(super) fn signal(signal: Signal) -> (&'static str, &'static str, f64) {
    match signal {
        Signal::Speed => ("speed", "rpm", RPM_RAD_S),
        Signal::Torque => ("torque", "Nm", 1.0),
        Signal::Power => ("power", "kW", 1e3),
    }
}

/// A number of a requirement set by its name.
pub fn statistic(statistic: Statistic) -> &'static str {
    match statistic {
        Statistic::Slope => "slope a_1",
        Statistic::Intercept => "|intercept a_0|",
        Statistic::StandardError => "standard error SEE",
        Statistic::Determination => "r²",
        Statistic::Work => "work over that of the reference",
    }
}

/// A number of a requirement set with its unit.
pub fn value_of(of: Signal, statistic: Statistic, value: f64) -> String {
    to_digits(of, statistic, value, FEWEST_DIGITS)
}

fn to_digits(of: Signal, statistic: Statistic, value: f64, digits: i32) -> String {
    let (_, unit, si) = signal(of);
    match statistic {
        Statistic::Intercept | Statistic::StandardError => {
            format!("{} {unit}", number::significant(value / si, digits))
        }
        Statistic::Slope | Statistic::Determination | Statistic::Work => number::significant(value, digits),
    }
}

/// A number and what its limits allow, to the digits that separate it from them.
pub(super) fn compared(one: &Checked) -> (String, String) {
    let text = |value: f64, digits: i32| to_digits(one.signal, one.statistic, value, digits);
    let limits = [one.low, one.high].into_iter().flatten();
    let digits = limits.map(|limit| separating(one.value, limit, &text)).max().unwrap_or(FEWEST_DIGITS);
    (text(one.value, digits), allowed_to(one.signal, one.statistic, (one.low, one.high), digits))
}

/// The fewest digits to which two numbers differ in print; the usual ones where they are equal.
fn separating(value: f64, limit: f64, text: &dyn Fn(f64, i32) -> String) -> i32 {
    let differ = |digits: &i32| value == limit || text(value, *digits) != text(limit, *digits);
    (FEWEST_DIGITS..=MOST_DIGITS).find(differ).unwrap_or(MOST_DIGITS)
}

/// Values that a limit allows.
pub(super) fn allowed(of: Signal, statistic: Statistic, limits: (Option<f64>, Option<f64>)) -> String {
    allowed_to(of, statistic, limits, FEWEST_DIGITS)
}

fn allowed_to(of: Signal, statistic: Statistic, (low, high): (Option<f64>, Option<f64>), digits: i32) -> String {
    let value = |value: f64| to_digits(of, statistic, value, digits);
    match (low, high) {
        (Some(low), Some(high)) => format!("{} … {}", value(low), value(high)),
        (Some(low), None) => format!("at least {}", value(low)),
        (None, Some(high)) => format!("at most {}", value(high)),
        (None, None) => "none".to_owned(),
    }
}

/// Which rows of the table of omissions were used.
pub fn omission(omission: &Omission) -> String {
    let also = |omitted: Omitted| match omitted {
        Omitted::Nothing => None,
        Omitted::Torque => Some("torque and power"),
        Omitted::Speed => Some("speed and power"),
    };
    let rows = [
        omission.motoring.then(|| "torque and power where the engine is motored".to_owned()),
        omission.idle.then(|| "speed and power at idle".to_owned()),
        also(omission.above).map(|what| format!("{what} above the reference at least demand")),
        also(omission.below).map(|what| format!("{what} below the reference at most demand")),
    ];
    let used: Vec<String> = rows.into_iter().flatten().collect();
    if used.is_empty() { "none".to_owned() } else { used.join("; ") }
}

/// A requirement of one's own, in words.
pub fn own(own: &Own) -> String {
    let (name, unit, si) = signal(own.signal());
    match *own {
        Own::Within { error, share, .. } => {
            format!("{name} within {} {unit} for {}", number::significant(error / si, 4), number::share(share))
        }
        Own::Rise { most_s, .. } => format!("{name}: rise from 10 to 90 % below {}", number::measure(most_s, "s")),
        Own::Overshoot { most, .. } => format!("{name}: overshoot below {}", number::share(most)),
        Own::Settling { band, most_s, .. } => {
            format!("{name}: settled within {} below {}", number::share(band), number::measure(most_s, "s"))
        }
        Own::Phase { frequency_hz, most_rad, .. } => {
            let (hz, most) = (number::measure(frequency_hz, "Hz"), number::significant(most_rad.to_degrees(), 4));
            format!("{name}: phase at {hz} below {most}°")
        }
        Own::Amplitude { sensor, frequency_hz, most } => format!(
            "amplitude of {} at {} below {} {unit}",
            self::sensor(sensor),
            number::measure(frequency_hz, "Hz"),
            number::significant(most / si, 4)
        ),
    }
}

fn sensor(sensor: Sensor) -> &'static str {
    match sensor {
        Sensor::Speed => "the speed",
        Sensor::Torque => "the torque",
        Sensor::DynoSpeed => "the dynamometer's speed",
        Sensor::EngineSpeed => "the engine's speed",
        Sensor::ShaftTorque => "the shaft torque",
        Sensor::TorqueDemand => "T_d*",
    }
}

/// A number of a requirement of one's own.
pub(super) fn own_value(own: &Own, value: f64) -> String {
    own_value_to(own, value, FEWEST_DIGITS)
}

/// A number of a requirement of one's own, to the digits that separate it from its limit.
pub(super) fn own_value_beside(own: &Own, value: f64, limit: f64) -> String {
    let text = |value: f64, digits: i32| own_value_to(own, value, digits);
    own_value_to(own, value, separating(value, limit, &text))
}

fn own_value_to(own: &Own, value: f64, digits: i32) -> String {
    let (_, unit, si) = signal(own.signal());
    match own {
        _ if value.is_infinite() => "never".to_owned(),
        Own::Within { .. } | Own::Amplitude { .. } => format!("{} {unit}", number::significant(value / si, digits)),
        Own::Phase { .. } => format!("{}°", number::significant(value.to_degrees(), digits)),
        Own::Overshoot { .. } => format!("{} %", number::significant(100.0 * value, digits)),
        Own::Rise { .. } | Own::Settling { .. } => number::significant_with_unit(value, digits, "s"),
    }
}

/// A quantity with a limit, with its unit and SI per unit.
pub fn limit_of(of: LimitOf) -> (&'static str, &'static str, f64) {
    match of {
        LimitOf::ShaftTorque => ("shaft torque", "Nm", 1.0),
        LimitOf::ShaftTorqueSlew => ("slew of the shaft torque", "Nm/s", 1.0),
        LimitOf::TorqueDemand => ("torque demand T_d*", "Nm", 1.0),
        LimitOf::TorqueSlew => ("slew of T_d*", "Nm/s", 1.0),
        LimitOf::Speed => ("speed", "rpm", RPM_RAD_S),
        LimitOf::SpeedGradient => ("speed gradient", "rpm/s", RPM_RAD_S),
        LimitOf::Power => ("power of the dynamometer", "kW", 1e3),
        LimitOf::TimeAtResonance => ("time at resonance", "s", 1.0),
        LimitOf::DriveHeat => ("heat of the drive, I²t", "%", 0.01),
    }
}

/// A limit in a word or two.
pub(super) fn short(of: LimitOf) -> &'static str {
    match of {
        LimitOf::ShaftTorque => "shaft torque",
        LimitOf::ShaftTorqueSlew => "shaft slew",
        LimitOf::TorqueDemand => "T_d*",
        LimitOf::TorqueSlew => "T_d* slew",
        LimitOf::Speed => "speed",
        LimitOf::SpeedGradient => "gradient",
        LimitOf::Power => "power",
        LimitOf::TimeAtResonance => "resonance",
        LimitOf::DriveHeat => "I²t",
    }
}

/// Source of a set.
pub fn required(set: &RequirementSet) -> Finding {
    let words = format!("{}: {} ({}). {}", set.name, set.paragraph, set.year, set.note);
    let (tone, severity) = if set.seen { (Tone::Plain, "source") } else { (Tone::Caution, "not seen") };
    Finding::new(tone, severity, words)
}

/// Point of a test beyond what is known, in words.
pub fn beyond(beyond: &Beyond) -> String {
    let whole = |value: f64| number::significant(value.round(), 5);
    let between = |(low, high): Range| format!("{} … {}", whole(low), whole(high));
    let rpm = |(low, high): Range| between((low / RPM_RAD_S, high / RPM_RAD_S));
    match *beyond {
        Beyond::EngineSpeed { map_rad_s, test_rad_s } => {
            format!("the engine's map has speeds of {} rpm, and the test needs {} rpm", rpm(map_rad_s), rpm(test_rad_s))
        }
        Beyond::EngineTorque { asked_nm, given_nm, speed_rad_s, time_s } => format!(
            "the engine gives {} Nm at {} rpm, and the test asks it for {} Nm at {} s",
            whole(given_nm),
            whole(speed_rad_s / RPM_RAD_S),
            whole(asked_nm),
            number::significant(time_s, 4)
        ),
        Beyond::ModelSpeed { model_rad_s, test_rad_s } => format!(
            "recordings have tested the model at {} rpm, and the test needs {} rpm",
            rpm(model_rad_s),
            rpm(test_rad_s)
        ),
        Beyond::ModelTorque { model_nm, test_nm } => format!(
            "recordings have tested the model at T_d of {} Nm, and the test needs {} Nm",
            between(model_nm),
            between(test_nm)
        ),
    }
}

/// The answer in a sentence. Where the test goes beyond what is known, it begins with that; a no does only if the
/// engine is meant.
pub fn answer(verdict: &Verdict) -> String {
    let missed = missed(verdict);
    let first = verdict.beyond.first().map(beyond);
    let of_engine = verdict.beyond.iter().find(|one| one.is_of_engine()).map(beyond);
    match verdict.answer {
        Answer::NotShown => format!(
            "not shown: {}; by the model {} of the benches like yours keep everything",
            first.unwrap_or_default(),
            number::proportion(&verdict.kept)
        ),
        Answer::Perhaps if first.is_some() => format!(
            "perhaps: {}; {} of the benches like yours{}",
            first.unwrap_or_default(),
            number::proportion(&verdict.kept),
            with(missed)
        ),
        Answer::No if of_engine.is_some() => format!("no: {}{}", of_engine.unwrap_or_default(), with(missed)),
        Answer::Yes => yes(verdict, &verdict.kept),
        Answer::NotJudged => "not judged: no limit is stated, and nothing is required".to_owned(),
        Answer::Perhaps => {
            format!("perhaps, {} of the benches like yours{}", number::proportion(&verdict.kept), with(missed))
        }
        Answer::No if missed.is_none() => {
            format!("no, {} of the benches like yours", number::proportion(&verdict.kept))
        }
        Answer::No => format!("no{}", with(missed)).replacen("no;", "no:", 1),
    }
}

/// A yes of so many benches.
pub(super) fn yes(verdict: &Verdict, kept: &Proportion) -> String {
    let (all, unchecked) = (verdict.limits.len(), verdict.unchecked.len());
    let of_limits = match all - unchecked {
        checked if checked == all => String::new(),
        0 => format!(" by the requirements alone, as none of {all} limits is stated"),
        checked => format!(" for {checked} of {all} limits"),
    };
    format!("yes{of_limits}, {} of the benches like yours", number::proportion(kept))
}

/// A limit or requirement that benches miss, in words, with the share of them, and the time when that happens on the
/// nominal bench, s.
struct Missed {
    words: String,
    share: f64,
    time_s: f64,
}

/// The limit or requirement that most benches miss, the earliest of several, and how many others prevent a yes.
fn missed(verdict: &Verdict) -> Option<(Missed, usize)> {
    let mut all: Vec<Missed> =
        limits(verdict).chain(sets(verdict)).chain(own_missed(verdict)).chain(unstable(verdict)).collect();
    all.retain(|one| one.share > 0.0);
    all.sort_by(|a, b| b.share.total_cmp(&a.share).then(a.time_s.total_cmp(&b.time_s)));
    let others = all.iter().skip(1).filter(|one| one.share > PREVENTS).count();
    all.into_iter().next().map(|first| (first, others))
}

/// The first thing missed, and how many others there are.
fn with(missed: Option<(Missed, usize)>) -> String {
    let Some((first, others)) = missed else { return String::new() };
    let share = number::share(first.share);
    let others = match others {
        0 => String::new(),
        1 => "; one other fails, too (tables)".to_owned(),
        others => format!("; {others} others fail, too (tables)"),
    };
    format!("; {} on {share} of benches like yours{others}", first.words)
}

fn at(time_s: f64) -> String {
    format!("at {} s", number::significant(time_s, 4))
}

fn limits(verdict: &Verdict) -> impl Iterator<Item = Missed> {
    verdict.limits.iter().filter_map(|limit| {
        let words = format!("{} {}, reached", limit_of(limit.of).0, at(limit.time_s));
        Some(Missed { words, share: limit.reached?.estimate, time_s: limit.time_s })
    })
}

fn sets(verdict: &Verdict) -> impl Iterator<Item = Missed> {
    verdict.sets.iter().map(|set| {
        let worst = set.statistics.iter().min_by(|a, b| a.kept.estimate.total_cmp(&b.kept.estimate));
        let line = worst
            .map_or_else(String::new, |one| format!(", {} of the {}", statistic(one.statistic), signal(one.signal).0));
        Missed { words: format!("{}{line}, missed", set.name), share: 1.0 - set.kept.estimate, time_s: f64::INFINITY }
    })
}

fn own_missed(verdict: &Verdict) -> impl Iterator<Item = Missed> {
    verdict.own.iter().map(|one| {
        let words = format!("{} {}, missed", own(&one.own), at(one.time_s));
        Missed { words, share: 1.0 - one.kept.estimate, time_s: one.time_s }
    })
}

/// A bench that is not stable reaches every limit, too: this comes first.
fn unstable(verdict: &Verdict) -> impl Iterator<Item = Missed> {
    std::iter::once(Missed {
        words: "not stable".to_owned(),
        share: verdict.unstable.estimate,
        time_s: f64::NEG_INFINITY,
    })
}
