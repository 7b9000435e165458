//! Words of requirements, statistics and limits.

use capability::{Answer, LimitOf, Verdict};
use cycle::{Judged, Omission, Omitted, Own, RequirementSet, Sensor, Signal, Statistic};
use page::{Finding, Tone};
use units::RPM_RAD_S;

use crate::wording::number;

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
    let (_, unit, si) = signal(of);
    match statistic {
        Statistic::Intercept | Statistic::StandardError => format!("{} {unit}", number::significant(value / si, 4)),
        Statistic::Slope | Statistic::Determination | Statistic::Work => number::significant(value, 4),
    }
}

/// What a limit allows.
pub(super) fn allowed(of: Signal, statistic: Statistic, (low, high): (Option<f64>, Option<f64>)) -> String {
    let value = |value: f64| value_of(of, statistic, value);
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
    let (_, unit, si) = signal(own.signal());
    match own {
        _ if value.is_infinite() => "never".to_owned(),
        Own::Within { .. } | Own::Amplitude { .. } => format!("{} {unit}", number::significant(value / si, 4)),
        Own::Phase { .. } => format!("{}°", number::significant(value.to_degrees(), 4)),
        Own::Overshoot { .. } => number::share(value),
        Own::Rise { .. } | Own::Settling { .. } => number::measure(value, "s"),
    }
}

/// What a run makes of such a requirement.
pub(super) fn judged(own: &Own, judged: &Judged) -> String {
    own_value(own, judged.value)
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

/// What a set rests on.
pub fn required(set: &RequirementSet) -> Finding {
    let words = format!("{}: {} ({}). {}", set.name, set.paragraph, set.year, set.note);
    let (tone, severity) = if set.seen { (Tone::Plain, "source") } else { (Tone::Caution, "not seen") };
    Finding::new(tone, severity, words)
}

/// The answer in a sentence.
pub fn answer(verdict: &Verdict) -> String {
    let kept = number::proportion(&verdict.kept);
    let binds = binding(verdict);
    match (verdict.answer, binds) {
        (Answer::Yes, _) => format!("yes{}, {kept} of the benches like yours", of_limits(verdict)),
        (Answer::Perhaps, Some(binds)) => format!("perhaps, {kept} of the benches like yours; {binds}"),
        (Answer::No, Some(binds)) => format!("no: {binds}"),
        (Answer::Perhaps, None) => format!("perhaps, {kept} of the benches like yours"),
        (Answer::No, None) => format!("no, {kept} of the benches like yours"),
    }
}

/// Of how many limits a yes speaks, where some are not stated.
fn of_limits(verdict: &Verdict) -> String {
    let (all, unchecked) = (verdict.limits.len(), verdict.unchecked.len());
    if unchecked == 0 { String::new() } else { format!(" for {} of {all} limits", all - unchecked) }
}

/// The limit or requirement that most benches fail.
fn binding(verdict: &Verdict) -> Option<String> {
    let time = |time_s: f64| format!("at {} s", number::significant(time_s, 4));
    let limits = verdict.limits.iter().filter_map(|limit| {
        let reached = limit.reached?;
        let (name, ..) = limit_of(limit.of);
        let words = format!(
            "{name} {}, reached on {} of benches like yours",
            time(limit.time_s),
            number::share(reached.estimate)
        );
        Some((reached.estimate, words))
    });
    let sets = verdict.sets.iter().map(|set| {
        let worst = set.statistics.iter().min_by(|a, b| a.kept.estimate.total_cmp(&b.kept.estimate));
        let line = worst
            .map_or_else(String::new, |one| format!(", {} of the {}", statistic(one.statistic), signal(one.signal).0));
        let missed = 1.0 - set.kept.estimate;
        (missed, format!("{}{line}, missed on {} of benches like yours", set.name, number::share(missed)))
    });
    let own = verdict.own.iter().map(|one| {
        let missed = 1.0 - one.kept.estimate;
        (
            missed,
            format!(
                "{} {}, missed on {} of benches like yours",
                self::own(&one.own),
                time(one.time_s),
                number::share(missed)
            ),
        )
    });
    let unstable = (
        verdict.unstable.estimate,
        format!("not stable on {} of benches like yours", number::share(verdict.unstable.estimate)),
    );
    let all = limits.chain(sets).chain(own).chain([unstable]);
    all.filter(|one| one.0 > 0.0).max_by(|a, b| a.0.total_cmp(&b.0)).map(|one| one.1)
}
