//! Torque signals, in words and figures.

use page::{Abscissa, Axis, Figure, Layer, Panel, Style, rounded};
use part_torque::timing::{Difference, Filter, FilterCandidate, ShaftFilter};
use part_torque::torque_signals::{OnceATurn, RebuiltShaft, TorqueRecording, TorqueSignals, Trust, TrustCheck};
use part_torque::torque_smoother::TorqueSource;
use rig::Role;
use rig::results::{Parameter, SignalDelay, Trace};

use crate::figures::{BAND, HEIGHT};
use crate::wording::number;

/// How much of the shaft torque is drawn, s.
const SHOWN_S: f64 = 0.5;
/// Intervals that are widened by more than this are worth a remark.
const WORTH_SAYING: f64 = 1.2;

/// A filter with its delay, e.g. `moving average over 16 samples, 7.5 ms late`.
pub fn filter(candidate: &FilterCandidate) -> String {
    let late = number::duration(candidate.filter_delay_s);
    match candidate.filter {
        Filter::MovingAverage { length: 1 } => "no filter".to_owned(),
        Filter::MovingAverage { length } => {
            format!("moving average over {length} samples of N_d, (N − 1)/2 samples = {late} late")
        }
        Filter::Lag { time_constant_s } => format!("first-order lag of {}", number::duration(time_constant_s)),
        Filter::Delay => format!("delay of {}", number::duration(candidate.delay_s)),
    }
}

/// Findings on the filter in T_d,shaft,calc.
pub fn shaft_filter(found: &ShaftFilter) -> String {
    let quotient = match found.best.difference {
        Difference::Backward => "backward difference",
        Difference::Central => "central difference",
    };
    let best = format!(
        "{}; with the {quotient} of N_d {} late in all; J_d in it is {}",
        filter(&found.best),
        number::duration(found.best.delay_s),
        number::measure(found.best.inertia_kg_m2, "kg m²"),
    );
    let rest = |residual_nm: f64| number::share(residual_nm / found.spread_nm);
    let second = found.others.first().map(|second| {
        let left =
            format!("leaves {} unexplained, the best {}", rest(second.residual_nm), rest(found.best.residual_nm));
        format!("the next best, {}, {left}", filter(second))
    });
    let doubt = if found.is_decided() { "" } else { "; the data cannot decide between the two: record longer" };
    best + &second.map(|second| format!("; {second}{doubt}")).unwrap_or_default()
}

/// Meaning of a delay behind T_d* that is below zero by more than its interval; none where it is not.
pub fn early(what: &str, delay: &Parameter) -> Option<String> {
    (delay.interval.1 < 0.0).then(|| before_demand(what, delay))
}

/// Meaning of a delay behind T_d* that is below zero.
pub fn before_demand(what: &str, delay: &Parameter) -> String {
    format!(
        "{what} is below zero ({}). No torque can react before T_d* changes, so the clocks differ by this and by \
         the true delay, which is not known. The estimate of the shaft includes the difference. To know the \
         delay, record both on one clock. If the residual depends on T_d*, delay and lag may not describe the \
         torque control",
        number::interval(delay)
    )
}

/// Clock of the torque control's delay in words: with the skew of T_d,calc, or without.
pub fn clock_of_delay(skew: Option<&Parameter>, delay: Option<&Parameter>) -> String {
    let recorded = |skew: &Parameter| Some(number::duration(delay?.value + skew.value));
    match skew {
        Some(skew) => format!(
            "The time stamps of T_d,calc are late against those of N_d by {}, its skew, from the estimate of the shaft. The delay is \
             without it; as recorded, it is {}.",
            number::parameter(skew),
            recorded(skew).unwrap_or_else(|| number::NOT_KNOWN.to_owned())
        ),
        None => "The delay is as recorded: if the clock of T_d,calc is late, the delay contains it. No estimate of the shaft \
                 shows how late."
            .to_owned(),
    }
}

/// Those of some parameters that are delays below zero, in words.
pub fn early_delays<'a>(parameters: impl IntoIterator<Item = &'a Parameter>) -> Vec<String> {
    let delays = parameters.into_iter().filter(|p| p.quantity.notation().unit == "s");
    delays.filter_map(|p| early(&format!("{} ({})", p.quantity.symbol(), p.quantity.name()), p)).collect()
}

/// The torque signals that are early against T_d*, in words.
pub fn early_signals(delays: &[SignalDelay]) -> Vec<String> {
    let of = |delay: &SignalDelay| {
        early(&format!("The delay of {} behind T_d*", delay.role.symbol()), delay.against_demand.as_ref()?)
    };
    delays.iter().filter_map(of).collect()
}

/// Verdict on the agreement of the routes to a delay.
pub fn agreement(delay: &SignalDelay) -> &'static str {
    match delay.routes_agree() {
        Some(true) => "yes",
        Some(false) => "no",
        None => "–",
    }
}

/// Each route to a delay with its 95 % interval, wider by what the route may be off by.
pub fn routes(delay: &SignalDelay) -> Vec<String> {
    let route = |r: &rig::results::DelayRoute| match r.interval_s {
        Some((low, high)) => {
            let ends = [low - r.systematic_s, high + r.systematic_s].map(|s| number::significant(1e3 * s, 4));
            format!("{} {} … {} ms", r.name, ends[0], ends[1])
        }
        None => format!("{} {}", r.name, number::duration(r.delay_s)),
    };
    delay.routes.iter().map(route).collect()
}

/// Which of T_d,calc and T_d,meas can be used for identification, in a sentence.
pub fn lateness(delays: &[SignalDelay]) -> Option<String> {
    let late = |role: Role| delays.iter().find(|d| d.role == role)?.against_demand.as_ref();
    let (calculated, measured) = (late(Role::AirGapTorque)?, late(Role::LoadCellTorque)?);
    let behind = number::duration(measured.value - calculated.value);
    Some(format!(
        "T_d,calc is {} behind T_d*, and T_d,meas is {behind} later than that: identify with T_d,calc",
        number::duration(calculated.value)
    ))
}

/// Routes that differ by more than this part of the standard deviation are worth a word.
const ROUTES_APART: f64 = 0.3;

/// How the shaft torque was rebuilt, and how certain it is.
pub fn rebuilt(shaft: &RebuiltShaft) -> String {
    let mut deviations = shaft.standard_deviation_nm.clone();
    deviations.sort_by(f64::total_cmp);
    let median = deviations.get(deviations.len() / 2).copied().unwrap_or(f64::NAN);
    let from = match shaft.torque {
        TorqueSource::Modelled => "T_d* through the torque control",
        TorqueSource::Calculated => "T_d,calc",
    };
    let certain = format!(
        "known to ±{} (95 %) from N_d and {from}, without bearing friction and differences of clocks",
        number::significant_with_unit(BAND * median, 2, "Nm")
    );
    let worth = |nm: f64| number::significant_with_unit(nm, 2, "Nm");
    let once = match shaft.once_a_turn {
        OnceATurn::TakenOut(nm) => format!("the encoder's once-a-turn error, worth {}, was taken out", worth(nm)),
        OnceATurn::Unknown(nm) => {
            format!("the encoder's once-a-turn error is unknown: each 0.01 % of it adds {} at order 1", worth(nm))
        }
    };
    let apart = match shaft.routes_apart_nm > ROUTES_APART * median {
        true => format!(
            "; the smoother and the filter without phase shift differ by {} (root mean square), which the interval holds",
            worth(shaft.routes_apart_nm)
        ),
        false => String::new(),
    };
    format!("{certain}; {once}{apart}{}", doubt(shaft.noise.widening, shaft.noise.converged))
}

/// Why a rebuilt torque is less certain than it could be, by the factor by which noise counts and the end of the search
/// for its levels; nothing where its smoother's model explains the speeds.
pub(crate) fn doubt(widening: f64, converged: bool) -> String {
    let widened = match widening > WORTH_SAYING {
        true => format!(
            "; noise counts {:.1} times in the intervals, since the speeds contain more than the smoother's model, such as errors of the encoders",
            widening
        ),
        false => String::new(),
    };
    let settled = if converged { "" } else { "; its noise levels did not settle" };
    format!("{widened}{settled}")
}

/// Needs of a comparison of T_d,calc with the load cell.
pub const NO_TRUST: &str = "both are needed, with steady torque for 6 s or more; run Step_T_TN with long dwells";

/// Verdict on T_d,calc where torque is steady, in plain words.
pub fn trust(check: &TrustCheck) -> String {
    let verdict = match check.verdict {
        Trust::Trusted => "steady T_d,calc can be trusted: within 1 % and 1 Nm of the load cell",
        Trust::Off => "steady T_d,calc is off: by more than 1 % or 1 Nm from the load cell",
        Trust::Undecided => "the recordings cannot show whether T_d,calc is within 1 % and 1 Nm of the load cell",
    };
    let gain = match &check.gain {
        Some(gain) => format!("gain {} %", scaled(gain.interval, 100.0)),
        None => "no gain, since all torques are alike: record another level of torque".to_owned(),
    };
    let drift = check.drift.as_ref().map(|d| format!(", drift {} Nm an hour", scaled(d.interval, 3600.0)));
    format!(
        "{verdict} (between {} and {} Nm: offset {} Nm, {gain}{}; 95 % intervals)",
        number::significant(check.torques_nm.0, 3),
        number::significant(check.torques_nm.1, 3),
        scaled(check.offset.interval, 1.0),
        drift.unwrap_or_default(),
    )
}

fn scaled((low, high): (f64, f64), by: f64) -> String {
    format!("{} … {}", number::significant(by * low, 2), number::significant(by * high, 2))
}

/// The rebuilt shaft torque of every recording, and T_d,calc against the load cell.
pub fn figures(signals: &TorqueSignals) -> Vec<Figure> {
    let shafts = signals.recordings.iter().filter_map(|recording| {
        let shaft = recording.shaft.as_ref()?.estimated()?;
        Some(shaft_figure(recording, shaft))
    });
    shafts.chain(signals.trust.as_ref().map(trust_figure)).collect()
}

fn shaft_figure(recording: &TorqueRecording, shaft: &RebuiltShaft) -> Figure {
    let count = ((SHOWN_S / shaft.sample_time_s) as usize).min(shaft.smoothed_nm.len());
    let from = (shaft.smoothed_nm.len() - count) / 2;
    let shown = from..from + count;
    let clock = (shaft.start_s + from as f64 * shaft.sample_time_s, shaft.sample_time_s);
    let (smoothed, deviation) = (&shaft.smoothed_nm[shown.clone()], &shaft.standard_deviation_nm[shown.clone()]);
    let end = |sign: f64| {
        let values: Vec<f64> = smoothed.iter().zip(deviation).map(|(t, s)| t + sign * BAND * s).collect();
        rounded(&values)
    };
    let band = |low, high| Layer::Band {
        name: "95 % band of the smoother".to_owned(),
        style: Style::Modelled,
        x: Abscissa::Uniform { start: clock.0, step: clock.1, skip: None },
        low,
        high,
    };
    let mut layers = vec![
        band(end(-1.0), end(1.0)),
        Layer::trace("filter without phase shift", Style::Measured, clock, &shaft.zero_phase_nm[shown.clone()]),
        Layer::trace("smoother", Style::Modelled, clock, smoothed),
    ];
    layers.extend(shaft.system.as_ref().map(|system| system_layer(system, clock.0)));
    let apart: Vec<f64> = shaft.zero_phase_nm[shown.clone()].iter().zip(smoothed).map(|(z, s)| z - s).collect();
    let below: Vec<f64> = deviation.iter().map(|s| -BAND * s).collect();
    let above: Vec<f64> = deviation.iter().map(|s| BAND * s).collect();
    let difference = vec![
        band(rounded(&below), rounded(&above)),
        Layer::trace("filter without phase shift", Style::Measured, clock, &apart),
    ];
    let panels = vec![
        Panel::new(Axis::linear("T_shaft", "Nm"), HEIGHT, layers),
        Panel::new(Axis::linear("less the smoother", "Nm"), HEIGHT, difference),
    ];
    Figure::new(&format!("{}: shaft torque rebuilt", recording.file), Axis::time(), panels)
        .with_caption(format!("Half a second of it; {}.", rebuilt(shaft)))
        .of_recording(&recording.file)
}

/// Layer of the system's own T_d,shaft,calc over the same half second.
fn system_layer(system: &Trace, start_s: f64) -> Layer {
    let index = |time_s: f64| ((time_s - system.start_s) / system.sample_time_s).ceil().max(0.0) as usize;
    let (from, to) = (index(start_s), index(start_s + SHOWN_S).min(system.values.len()));
    let clock = (system.start_s + from as f64 * system.sample_time_s, system.sample_time_s);
    let shown = system.values.get(from..to).unwrap_or_default();
    Layer::trace("T_d,shaft,calc of the system", Style::Other, clock, shown)
}

fn trust_figure(check: &TrustCheck) -> Figure {
    let (measured, apart): (Vec<f64>, Vec<f64>) = check.blocks.iter().copied().unzip();
    let panel = Panel::new(
        Axis::linear("T_d,calc − T_d,meas", "Nm"),
        HEIGHT,
        vec![Layer::dots("means over half a second", Style::Measured, &measured, &apart)],
    );
    Figure::new("Steady T_d,calc against the load cell", Axis::linear("T_d,meas", "Nm"), vec![panel])
        .with_caption(format!("{}.", trust(check)))
}
