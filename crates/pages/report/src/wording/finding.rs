//! Each finding in plain words: what was found, and what to do about it.

use rig::results::{Parameter, Quantity};
use rig::{ControlMode, Diagnostic, Finding, LikelyUnit, NotReplayed, Role, SeenInstead};

use super::number::{self, NOT_KNOWN, duration, measure, plus_minus, share, significant, time};
use super::reason::reason_of;
use super::{join, mode_short, part, place, role, severity};

/// A signal this far ahead of what it follows is wrong, s: the two clocks of a bench are closer.
const EARLY_S: f64 = 1.5e-3;

/// A diagnostic on one line: severity, place, what was found, what to do.
pub fn diagnostic(found: &Diagnostic) -> String {
    format!("{}: {}", severity(found.severity), remark(found))
}

/// A diagnostic without its severity: where, what, and what to do.
pub fn remark(found: &Diagnostic) -> String {
    let place = place(&found.place).map(|place| format!("{place}: ")).unwrap_or_default();
    format!("{place}{} {}", finding(&found.finding), advice(&found.finding))
}

/// Finding as a sentence.
pub fn finding(finding: &Finding) -> String {
    match finding {
        Finding::UnreadableRecording { error } => {
            format!("The recording cannot be read: {}.", phrase(&error.to_string()))
        }
        Finding::ReaderDoubt { doubt } => {
            format!("The recording was read with a reservation: {}.", phrase(&doubt.to_string()))
        }
        Finding::NoLabel => "Neither the file name nor the bench file says which experiment this is.".to_owned(),
        Finding::DuplicateRecording { other } => format!("The recording is there twice: the same as {other}."),
        Finding::MissingChannel { role: missing, closest } => missing_channel(&role(*missing), closest),
        Finding::UnfitUnit { role: of, unit } => format!("The unit “{unit}” does not fit the {}.", role(*of)),
        Finding::NotANumber { count, mended } => not_a_number(*count, *mended),
        Finding::Gap { duration_s, mended } => gap(*duration_s, *mended),
        Finding::ShortGaps { count, longest_s, share: of } => short_gaps(*count, *longest_s, *of),
        Finding::Cut { kept_s: (from, to), lost_s } => {
            let lost = duration(*lost_s);
            format!(
                "Gaps too long to interpolate: only the stretch from {} to {} is used, {lost} are not.",
                time(*from),
                time(*to)
            )
        }
        Finding::LeftOut { stretches_s, used_s, unused_s } => left_out(stretches_s, *used_s, *unused_s),
        Finding::StretchOutside { from_s, to_s, recorded_s: (first, last) } => format!(
            "The stretch from {} to {} holds no sample; the recording is from {} to {}.",
            time(*from_s),
            time(*to_s),
            time(*first),
            time(*last)
        ),
        Finding::StretchOfNoRecording => "The bench file states stretches of it, but does not use the file.".to_owned(),
        Finding::SamplesRaised { every, interpolated } => raised(*every, *interpolated),
        Finding::SamplesRepeated { share: of, longest_s } => format!(
            "{} of the samples repeat the one before, for up to {}, although the values are in finer steps.",
            share(*of),
            duration(*longest_s)
        ),
        Finding::SamplesStraightened { share: of } => format!(
            "{} of the samples lie on straight lines between others: the recording system has interpolated a slower channel.",
            share(*of)
        ),
        Finding::Spikes { count, farthest } => {
            let what =
                if *count == 1 { "One sample is a spike".to_owned() } else { format!("{count} samples are spikes") };
            format!("{what}, up to {} (SI); left out.", si(*farthest))
        }
        Finding::SamplesFiltered { ratio } => format!(
            "At some frequencies it has only {} of the noise that it has at others: a low-pass filter or a mean has acted on it.",
            share(*ratio)
        ),
        Finding::SpeedSmoothed { mean_s, sample_time_s } => {
            let [mean, sample] = [mean_s, sample_time_s].map(|s| duration(*s));
            format!(
                "N_d is smoother than what the speed controller answers to, as by a mean over {mean} (a sample is {sample}). A filter or a \
                 mean has acted on it, or the controller has a derivative."
            )
        }
        Finding::TorquesDisagree { role: of, gain, offset_nm, looks_like } => {
            torques(&role(*of), *gain, *offset_nm, *looks_like)
        }
        Finding::LabelContradicted { label, seen } => format!("The recording is no {label}: {}.", seen_instead(*seen)),
        Finding::FiringOrderDisagrees { stated, found } => firing_order(*stated, *found),
        Finding::PulsesOffSpeed { ratio } => {
            let percent = significant(100.0 * (1.0 / ratio - 1.0).abs(), 2);
            let (speeds, stamps) = if *ratio < 1.0 { ("high", "much") } else { ("low", "little") };
            format!(
                "The engine fires {} times as often as its speed says. The speeds are {percent} % too {speeds}, or the time stamps count {percent} % too {stamps}.",
                significant(*ratio, 4)
            )
        }
        Finding::PulsesOffShaft { frequency_hz, ratio } => {
            let (at, ratio) = (measure(*frequency_hz, "Hz"), significant(*ratio, 2));
            format!(
                "The engine’s pulses of {at} are {ratio} times as strong in N_d, beside N_e, as K and B let them through. A filter or a \
                 mean has acted on one of the speeds, or there is a third mass."
            )
        }
        Finding::ClockRate { found_hz, mains_hz } => {
            let percent = significant(100.0 * (mains_hz / found_hz - 1.0).abs(), 2);
            let stamps = if found_hz < mains_hz { "much" } else { "little" };
            let (found, mains) = (significant(*found_hz, 5), significant(*mains_hz, 3));
            format!(
                "The ripple of the drive is at {found} Hz. It is at {mains} Hz, twice the mains, if the time stamps count {percent} % too {stamps}."
            )
        }
        Finding::LateSignal { role: of, late_s, standard_error_s } => {
            let apart = plus_minus(1e3 * late_s.abs(), 2e3 * standard_error_s, "ms");
            let order = if *late_s < 0.0 { "before" } else { "behind" };
            format!("The {} is {apart} {order} N_d, as the equation of the shaft shows.", role(*of))
        }
        Finding::SlowRaster { sample_time_s, is_in_ms } => {
            let hint = if *is_in_ms { " The time stamps seem to be in ms." } else { "" };
            format!("N_d is recorded every {} only.{hint}", duration(*sample_time_s))
        }
        Finding::ImplausibleMagnitude { role: of, largest, looks_like } => {
            let hint = looks_like.as_ref().map(|unit| format!(" They look like {unit}.")).unwrap_or_default();
            format!("The values of the {} reach {} (SI), more than a bench can do.{hint}", role(*of), si(*largest))
        }
        Finding::SpeedsDisagree { role: of, ratio_to_dyno_speed } => {
            format!(
                "The mean of the {} is {} times that of the dynamometer speed.",
                role(*of),
                si(*ratio_to_dyno_speed)
            )
        }
        Finding::TimeNotIncreasing => "Time stamps go backwards or repeat.".to_owned(),
        Finding::Bursts { sample_time_s, mean_s } => format!(
            "Its time stamps come in bursts: {} apart, and one in {} on average.",
            duration(*sample_time_s),
            duration(*mean_s)
        ),
        Finding::Jitter { largest_s, sample_time_s } => jitter(*largest_s, *sample_time_s),
        Finding::ClockOffset { against, offset_s } => {
            let order = if *offset_s > 0.0 { "after" } else { "before" };
            let apart = duration(offset_s.abs());
            format!(
                "Its time stamps begin and end {apart} {order} those of {against}, as if they counted from elsewhere."
            )
        }
        Finding::ClockDrift { against, rate, standard_error, apart_s } => {
            let rate = plus_minus(1e6 * rate, 2e6 * standard_error, "ppm");
            let (apart, order) = (duration(apart_s.abs()), if *apart_s > 0.0 { "later" } else { "earlier" });
            format!(
                "Its clock runs apart from that of {against} by {rate}: {apart} {order} at the end than at the start."
            )
        }
        Finding::Constant { value } => format!("The signal never changes; it rests at {} (SI).", si(*value)),
        Finding::Clipped { value, share: of } => {
            format!("The signal rests at its extreme value {} (SI) in {} of the samples.", si(*value), share(*of))
        }
        Finding::SpeedsExchanged { misfit_ratio } => {
            let times = significant(*misfit_ratio, 2);
            format!(
                "The channels of N_d and N_e seem exchanged: the other way round the residual of the shaft’s equation is {times} times smaller."
            )
        }
        Finding::TorquesExchanged { demand, torque, later_s } => format!(
            "The channels of T_d* and T_d,calc are exchanged: “{demand}” follows “{torque}” {} later, and “{torque}” is held as a demand is.",
            duration(*later_s)
        ),
        Finding::TooShort { duration_s, needed_s } => {
            format!("The recording lasts {}; the estimate needs {}.", duration(*duration_s), duration(*needed_s))
        }
        Finding::WrongTorqueSign { correlation } => {
            let found = significant(*correlation, 2);
            format!("T_d appears to brake with a negative sign (its correlation with the motion it causes is {found}).")
        }
        Finding::ImplausibleInertia { inertia: which, given_kg_m2, estimated_kg_m2, standard_error_kg_m2 } => {
            inertia(which.symbol(), *given_kg_m2, *estimated_kg_m2, *standard_error_kg_m2)
        }
        Finding::NoCheckOfShaft { quantity, value, standard_error } => {
            let found = number::parameter(Parameter::new(*quantity, *value, *standard_error, f64::INFINITY));
            format!("This recording alone would give {} = {found}, which the bench cannot have.", quantity.symbol())
        }
        Finding::Saturated { share: of, limit_nm } => {
            let limit = measure(*limit_nm, "Nm");
            format!("The torque is at its limit of {limit} in {} of the samples.", share(*of))
        }
        Finding::EarlySignal { role: early, advance_s } => {
            let advance = duration(*advance_s);
            format!(
                "The time stamps of the {} are {advance} before the torque demand T_d* that it follows: their clocks differ.",
                role(*early)
            )
        }
        Finding::ExcludedLines { frequencies_hz } => excluded_lines(frequencies_hz),
        Finding::ResidualsCorrelated { submodel, share_outside } => residuals(part(*submodel), *share_outside),
        Finding::NotConverged { submodel } => format!("The fit of the {} did not converge.", part(*submodel)),
        Finding::CoarseResolution { role: of @ (Role::DynoSpeed | Role::EngineSpeed), step } => {
            format!("The {} is recorded in steps of {} (SI), coarser than its noise should be.", role(*of), si(*step))
        }
        Finding::CoarseResolution { role: of, step } => {
            format!(
                "The {} is recorded in steps of {} (SI), too coarse compared with the noise to show the encoder’s gate.",
                role(*of),
                si(*step)
            )
        }
        Finding::NotReplayed { reason } => {
            format!("The recording was not replayed on the model: {}.", not_replayed(reason))
        }
        Finding::Simulated { files, beside_measured } => {
            let all = if *beside_measured { "" } else { "All recordings are simulated: " };
            format!("{all}{} from a virtual bench.", join(files, "and"))
        }
        Finding::PulsesFoldToRest { role: speed, rate_hz, firing_hz, multiple } => {
            let (rate, firing) = (measure(*rate_hz, "Hz"), measure(*firing_hz, "Hz"));
            format!(
                "The engine fires at {firing}; {multiple} times that is a multiple of the sample rate of the {}, {rate}. The alias of \
                 its pulses is at zero frequency and looks like slow changes. No residual shows it.",
                role(*speed)
            )
        }
        Finding::RoutesDisagree { quantity, first, second } => routes(*quantity, *first, *second),
    }
}

fn left_out(stretches_s: &[(f64, f64)], (from, to): (f64, f64), unused_s: f64) -> String {
    let each = |(from, to): &(f64, f64)| format!("{} to {}", time(*from), time(*to));
    let stretches: Vec<String> = stretches_s.iter().map(each).collect();
    let all: f64 = stretches_s.iter().map(|(from, to)| to - from).sum();
    let (all, listed) = (duration(all), join(&stretches, "and"));
    let (from, to) = (time(from), time(to));
    let used = format!(
        "Estimates leave out {all}, as the bench file states: from {listed}. The part from {from} to {to} is used"
    );
    match unused_s > 0.0 {
        true => format!("{used}; another {} are not used.", duration(unused_s)),
        false => format!("{used}."),
    }
}

/// Advice on a finding, as a sentence.
pub fn advice(finding: &Finding) -> &'static str {
    match finding {
        Finding::UnreadableRecording { .. } => "Export the recording again and check that the copy is complete.",
        Finding::ReaderDoubt { .. } => "Compare the affected channels with the original in the measuring system.",
        Finding::NoLabel => {
            "Put the label, such as BS_T_NT, into the file name, or as [[recordings.label]] with file and label into the bench file."
        }
        Finding::DuplicateRecording { .. } => "Remove one of the two; only the first was used.",
        Finding::MissingChannel { .. } => "Correct the channel’s name in the bench file, or record the channel.",
        Finding::UnfitUnit { .. } => {
            "State the unit in the bench file, for instance dyno_speed = { name = \"…\", unit = \"rpm\" }."
        }
        Finding::NotANumber { mended: true, .. } => "Nothing to do, unless it happens often: then check the sensor.",
        Finding::NotANumber { mended: false, .. } => "Check sensor and cable, and record again.",
        Finding::Gap { mended: true, .. } => {
            "Nothing to do, unless it happens often: then check the measuring system’s load."
        }
        Finding::Gap { mended: false, .. } => "Record again; a stretch with a gap cannot be used.",
        Finding::ShortGaps { .. } => "Nothing to do, unless it happens often: then check the measuring system’s load.",
        Finding::Cut { .. } => "Record again without interruption to use the whole recording.",
        Finding::LeftOut { unused_s, .. } if *unused_s > 0.0 => {
            "Estimates need one uninterrupted part, so the longest is used. To use another one, leave out the rest."
        }
        Finding::LeftOut { .. } => "Nothing to do.",
        Finding::StretchOutside { .. } => {
            "The recording was not used. Correct the times in [[recordings.stretch]] of the bench file: s of the recording’s own clock."
        }
        Finding::StretchOfNoRecording => "Correct the file’s name in [[recordings.stretch]] of the bench file.",
        Finding::SamplesRaised { .. } => {
            "Only its own samples are used. Export the channel with its own time stamps: the skew of the repeated ones is not known."
        }
        Finding::SamplesRepeated { .. } => {
            "These samples were left out and interpolated. Check the load of the measuring system, and record again."
        }
        Finding::SamplesStraightened { .. } => {
            "Do not trust what is estimated from this channel. Export it with its own time stamps, without interpolation."
        }
        Finding::Spikes { .. } => "They were interpolated. Check sensor and cable.",
        Finding::SamplesFiltered { .. } => {
            "Delays contain that of the filter, and damping and gains are biased. Record without the filter."
        }
        Finding::SpeedSmoothed { .. } => {
            "Record N_d without the filter, each sample as the encoder gives it. The report of dynoid speed-control shows a derivative."
        }
        Finding::TorquesDisagree { .. } => {
            "Check unit, channel and zero of both torques in the bench file; until then do not use what is estimated from this channel."
        }
        Finding::LabelContradicted { seen: SeenInstead::LargerInertia { .. }, .. } => {
            "If the shaft is on, correct the label; else check J_d and the torque’s unit."
        }
        Finding::LabelContradicted { seen: SeenInstead::SpeedDemandChanges, .. } => {
            "Correct the label in the file name or in [[recordings.label]]; feed-forward biases the controller’s gains here."
        }
        Finding::LabelContradicted { .. } => {
            "It was not used. Correct the label in the file name or in [[recordings.label]] of the bench file."
        }
        Finding::FiringOrderDisagrees { .. } => {
            "Correct cylinders and strokes in the bench file, or take out recordings of another bench."
        }
        Finding::PulsesOffSpeed { .. } => {
            "Check the number of lines of the encoders in the measuring system, and its clock."
        }
        Finding::PulsesOffShaft { .. } => {
            "Record both speeds without filters, each sample as the encoder gives it. With a dual-mass flywheel see dynoid shaft."
        }
        Finding::ClockRate { .. } => {
            "Check the clock of the measuring system: every time, frequency and inertia from this recording is wrong by as much."
        }
        Finding::LateSignal { role: Role::AirGapTorque, .. } => {
            "The delay of torque control contains this. Check the trigger, the filters and the time stamps of the channel."
        }
        Finding::LateSignal { .. } => "Check the trigger, the filters and the time stamps of the channel.",
        Finding::SlowRaster { is_in_ms: true, .. } => "State times in s.",
        Finding::SlowRaster { .. } => {
            "Record it every millisecond: delays and feed-forward of the controller cannot be trusted."
        }
        Finding::ImplausibleMagnitude { .. } => {
            "State the true unit in the bench file, for instance dyno_speed = { name = \"…\", unit = \"rpm\" }."
        }
        Finding::SpeedsDisagree { .. } => {
            "Check unit and channel in the bench file; a ratio of 9.55 or 0.105 means rpm taken for rad/s or the reverse."
        }
        Finding::TimeNotIncreasing => "Check how the file was exported or joined, and export it again.",
        Finding::Bursts { .. } => {
            "Export it with the time at which each sample was taken, not with the time at which the logger wrote it."
        }
        Finding::Jitter { .. } => "Record with hardware time stamps; delays below the jitter cannot be trusted.",
        Finding::ClockOffset { .. } => {
            "Check that all devices start on one trigger; only the time that both share is used, with its own time stamps."
        }
        Finding::ClockDrift { .. } => {
            "Synchronise the devices, or record for a shorter time: a part of it is an error of delays and of the shaft’s damping."
        }
        Finding::Constant { .. } => {
            "Check that the sensor is connected and that the right channel is named in the bench file."
        }
        Finding::Clipped { .. } => "Widen the measuring range, or lower the excitation, and record again.",
        Finding::SpeedsExchanged { .. } => {
            "Exchange the two channels in the bench file; until then use no number of this study."
        }
        Finding::TorquesExchanged { .. } => {
            "Exchange dyno_torque_demand and air_gap_torque in the bench file; until then use no number of this study."
        }
        Finding::TooShort { .. } => "Record for longer.",
        Finding::WrongTorqueSign { .. } => {
            "Invert the channel’s sign in the bench file; here positive T_d brakes the dynamometer."
        }
        Finding::ImplausibleInertia { .. } => {
            "Check the inertia in the bench file, and the scaling of torque and speed."
        }
        Finding::NoCheckOfShaft { .. } => {
            "Its K and B were not compared with the others; record torque faster, or in torque control."
        }
        Finding::Saturated { .. } => "These stretches were left out. Lower the excitation to use the whole recording.",
        Finding::EarlySignal { advance_s, .. } if *advance_s > EARLY_S => {
            "No torque is ahead of its demand by so much: check in the bench file that both channels are not exchanged, then the time stamps of both."
        }
        Finding::EarlySignal { .. } => {
            "Nothing to do for the model: the estimate of the shaft includes the skew. Record both on one clock to compare them."
        }
        Finding::ExcludedLines { .. } => "Nothing to do; the figure of the residual spectrum shows where they are.",
        Finding::ResidualsCorrelated { .. } => {
            "Do not trust the intervals of this part: the model lacks something. Look at its residual plots."
        }
        Finding::NotConverged { .. } => "Do not use this part. Record a longer or stronger excitation.",
        Finding::CoarseResolution { role: Role::DynoSpeed | Role::EngineSpeed, .. } => {
            "Delays, damping and feed-forward are less certain than their intervals. Record the speed with finer steps."
        }
        Finding::CoarseResolution { .. } => {
            "The controller’s delay is less certain for it. Record the signal with finer steps."
        }
        Finding::NotReplayed { .. } => "Nothing to do unless you need this replay: then record what is missing.",
        Finding::Simulated { beside_measured: true, .. } => {
            "Take the simulated recordings out of [recordings], or the results mix both benches."
        }
        Finding::Simulated { .. } => "Nothing to do; the results show a simulation and no real bench.",
        Finding::PulsesFoldToRest { .. } => {
            "The error of K may be several times its interval (on virtual benches twice, which is 0.1 %). Record at a speed 5 % higher or lower."
        }
        Finding::RoutesDisagree { quantity: Quantity::DynoInertia, .. } => {
            "Compare the scale of this recording’s torques with that of the others: J_d and K differ by one factor."
        }
        Finding::RoutesDisagree { .. } => {
            "Find out which method is disturbed before you use the value; the true value may lie outside both intervals."
        }
    }
}

fn missing_channel(role: &str, closest: &[String]) -> String {
    let quoted: Vec<String> = closest.iter().map(|name| format!("“{name}”")).collect();
    let hint =
        if quoted.is_empty() { String::new() } else { format!(" The closest names are {}.", join(&quoted, "and")) };
    format!("The channel the bench file names for the {role} is not in the recording.{hint}")
}

fn not_a_number(count: usize, mended: bool) -> String {
    let what = if count == 1 { "One sample is".to_owned() } else { format!("{count} samples are") };
    format!("{what} not a number; {}.", if mended { "interpolated" } else { "too many to interpolate" })
}

fn raised(every: usize, interpolated: bool) -> String {
    let others = if interpolated { "lie on straight lines between these" } else { "repeat the one before" };
    format!("Only one sample in {every} is measured; the others {others}: the recording system has raised the rate.")
}

fn torques(of: &str, gain: f64, offset_nm: f64, looks_like: Option<(Role, LikelyUnit)>) -> String {
    let unit = |unit: LikelyUnit| match unit {
        LikelyUnit::PercentOfLimit => "% of the torque limit",
        LikelyUnit::PoundFoot => "lbf ft",
        LikelyUnit::KiloNewtonMetre => "kNm",
    };
    let hint = looks_like.map(|(wrong, in_unit)| format!(" {} looks like {}.", wrong.symbol(), unit(in_unit)));
    let (gain, offset) = (significant(gain, 3), measure(offset_nm, "Nm"));
    format!("The {of} is {gain} times T_d,calc, and {offset} more.{}", hint.unwrap_or_default())
}

fn seen_instead(seen: SeenInstead) -> String {
    match seen {
        SeenInstead::SpeedControl => format!("T_d* answers to N_d, as in {}", mode_short(ControlMode::Nt)),
        SeenInstead::TorqueControl => format!("T_d* does not answer to N_d, as in {}", mode_short(ControlMode::Tn)),
        SeenInstead::ShaftOn => "the engine turns with the dynamometer, so the shaft is on".to_owned(),
        SeenInstead::LargerInertia { ratio } => {
            format!("T_d moves {} times the inertia J_d, as if the shaft were on", significant(ratio, 2))
        }
        SeenInstead::SpeedDemandChanges => "N_d* changes, which it does not where the torque is excited".to_owned(),
    }
}

fn firing_order(stated: f64, found: f64) -> String {
    let (stated, found, cylinders) = (significant(stated, 2), significant(found, 2), significant(2.0 * found, 2));
    format!(
        "The engine fires {found} times a turn, as its speed shows; the bench file says {stated}. An engine of four strokes and {cylinders} cylinders does so."
    )
}

fn short_gaps(count: usize, longest_s: f64, of: f64) -> String {
    let what = if count == 1 { "One short gap was".to_owned() } else { format!("{count} short gaps were") };
    format!("{what} interpolated: the longest lasts {}, together {} of the samples.", duration(longest_s), share(of))
}

fn gap(duration_s: f64, mended: bool) -> String {
    let fate = if mended { "interpolated" } else { "too long to interpolate" };
    format!("Time stamps are missing for {}; {fate}.", duration(duration_s))
}

fn jitter(largest_s: f64, sample_time_s: f64) -> String {
    let (largest, clock) = (duration(largest_s), duration(sample_time_s));
    format!("Time stamps deviate by up to {largest} from a uniform clock of {clock}.")
}

fn inertia(symbol: &str, given_kg_m2: f64, estimated_kg_m2: f64, standard_error_kg_m2: f64) -> String {
    let given = measure(given_kg_m2, "kg m²");
    let estimated = plus_minus(estimated_kg_m2, 2.0 * standard_error_kg_m2, "kg m²");
    format!("The inertia {symbol} of {given} in the bench file does not fit the data, which say {estimated}.")
}

fn residuals(submodel: &str, share_outside: f64) -> String {
    let outside = share(share_outside);
    format!(
        "The residual of the {submodel} is correlated with its input: {outside} of the lags lie outside the 99 % \
         region."
    )
}

/// Quantity to which two routes were taken.
pub fn twice_estimated(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::TorqueControlGain => "gain from T_d* to T_d,calc",
        other => other.symbol(),
    }
}

fn routes(quantity: Quantity, first: (f64, f64), second: (f64, f64)) -> String {
    let per_si = quantity.notation().per_si;
    let quantity = twice_estimated(quantity);
    let [first, second] = [first, second].map(|(value, error)| plus_minus(per_si * value, per_si * 2.0 * error, ""));
    format!("Two methods for {quantity} disagree: {first} and {second} (± two standard errors).")
}

fn excluded_lines(frequencies_hz: &[f64]) -> String {
    let listed: Vec<String> = frequencies_hz.iter().map(|f| significant(*f, 4)).collect();
    format!("Narrow bands around {} Hz were left out, because the model does not hold there.", join(&listed, "and"))
}

fn si(value: f64) -> String {
    if value.is_finite() { significant(value, 3) } else { NOT_KNOWN.to_owned() }
}

/// A reader's own words as part of a sentence: trimmed, without a closing full stop.
fn not_replayed(reason: &NotReplayed) -> String {
    match reason {
        NotReplayed::Lacks(reason) => phrase(&reason_of(reason)).to_owned(),
        NotReplayed::Clock { demand_s, controller_s } => format!(
            "the demand has a value every {} ms, and the controller runs every {} ms",
            si(1e3 * demand_s),
            si(1e3 * controller_s)
        ),
        NotReplayed::NotSimulated => "the model cannot be simulated at its sample time".to_owned(),
    }
}

fn phrase(reason: &str) -> &str {
    let trimmed = reason.trim().trim_end_matches('.');
    if trimmed.is_empty() { "no reason given" } else { trimmed }
}
