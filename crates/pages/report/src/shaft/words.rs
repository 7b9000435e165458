//! The shaft, in words and figures.

use page::{Abscissa, Axis, Figure, Layer, Panel, Style, rounded};
use part_shaft::shaft::{Beyond, Term, TermTest, Weight};
use part_shaft::shaft_analysis::{Band, DualMass, Routes, ShaftAnalysis, ShaftRecording, Together};
use part_shaft::shaft_routes::black_box::{BlackBoxDoubt, BlackBoxRoute};
use part_shaft::shaft_routes::multisine::{CostTest, MultisineRoute};
use rig::results::{Estimate, Notation, Outcome, Parameter, Quantity, Reason, Shaft, WrittenParameter};

use crate::figures::{BAND, HEIGHT};
use crate::wording::number;

/// A simple shaft whose errors are this many times what noise explains is not the whole truth.
const MISFIT: f64 = 2.0;
/// Samples of T_d further apart than this may hold what is folded, s.
const COARSE_S: f64 = 2e-3;
/// e^{−(T/w)²} over torque has the area √π w; w is 5 Nm in [`Weight::NearZeroTorque`].
const LOOSE_AREA_NM: f64 = 5.0 * 1.772_453_850_905_516;

/// A term in words.
pub fn term(term: Term) -> &'static str {
    match term {
        Term::LossFactor => "loss factor η, K (1 + iη)",
        Term::SecondMass => "a second mass at the engine's end (dual-mass flywheel), J₂/K₂",
        Term::DualMass => "a dual-mass flywheel",
        Term::OfStiffness(Weight::Torque) => "stiffness that changes with torque, per 100 Nm",
        Term::OfStiffness(Weight::TorqueSquared) => "stiffness that changes with torque squared, per (100 Nm)²",
        Term::OfStiffness(Weight::NearZeroTorque) => "stiffness about zero torque (backlash)",
        Term::OfStiffness(Weight::Speed) => "stiffness that changes with speed, per 1000 rpm",
        Term::OfDamping(Weight::Torque) => "damping that changes with torque, per 100 Nm",
        Term::OfDamping(Weight::TorqueSquared) => "damping that changes with torque squared, per (100 Nm)²",
        Term::OfDamping(Weight::NearZeroTorque) => "damping about zero torque",
        Term::OfDamping(Weight::Speed) => "damping that changes with speed, per 1000 rpm",
    }
}

/// A term's value: parts of K in per cent, everything else in its unit.
pub fn term_value(test: &TermTest) -> String {
    test.value.as_ref().map_or_else(|| "–".to_owned(), |value| number::parameter(shown(test.term, value)))
}

/// A term's interval at the level of the joint test.
pub fn term_interval(test: &TermTest) -> String {
    let within = |(value, interval): (&Parameter, (f64, f64))| {
        number::interval(shown(test.term, &Parameter { interval, ..value.clone() }))
    };
    test.value.as_ref().zip(test.joint_interval).map_or_else(|| "–".to_owned(), within)
}

fn shown(term: Term, value: &Parameter) -> WrittenParameter {
    let written = value.written();
    let (scale, unit) = match term {
        Term::OfStiffness(_) => (100.0, "%"),
        Term::SecondMass => (1e6, "ms²"),
        _ => return written,
    };
    WrittenParameter {
        notation: Notation { unit, ..written.notation },
        value: scale * written.value,
        standard_error: scale * written.standard_error,
        interval: (scale * written.interval.0, scale * written.interval.1),
        ..written
    }
}

/// Verdict on a term, in a word or two.
pub fn term_verdict(test: &TermTest) -> &'static str {
    match (&test.value, test.found) {
        (None, _) => "not testable here",
        (Some(_), true) => "found",
        (Some(_), false) => "not significant",
    }
}

/// Joint verdict of the terms, in a sentence.
pub fn beyond(found: &Beyond) -> String {
    let misfit = number::significant(found.simple_misfit, 2);
    let simple = format!("errors of the simple shaft are {misfit} times what the noise explains");
    match found.best() {
        None if found.simple_misfit < MISFIT => format!("nothing beyond K and B is significant; {simple}"),
        None => format!("{simple}, and none of these terms explains it: check the channels and J_d"),
        Some(best) => {
            let left = number::significant(best.misfit.unwrap_or(f64::NAN), 2);
            let others = if found.tests.iter().filter(|t| t.found).count() > 1 {
                "; the other terms that are found may be the same effect in another form"
            } else {
                ""
            };
            let play = backlash(best).map(|mrad| format!(", a play of some {mrad} mrad")).unwrap_or_default();
            format!("{simple}, {left} times with the best, {}{play}{others}", term(best.term))
        }
    }
}

/// The play that a loss of stiffness about zero torque amounts to, per K: ∫ −p w(T) dT/K.
fn backlash(best: &TermTest) -> Option<String> {
    let value = best.value.as_ref().filter(|_| best.term == Term::OfStiffness(Weight::NearZeroTorque))?;
    let stiffness = best.stiffness_nm_per_rad?;
    Some(number::significant(-1e3 * value.value * LOOSE_AREA_NM / stiffness, 2))
}

/// A route to K and B, and what it found.
pub struct Route<'a> {
    /// From what to what.
    pub name: &'static str,
    /// K, B and, where it shows them, the inertias.
    pub estimate: Result<&'a Estimate, &'a [Reason]>,
}

/// The recording's own estimate, then the other routes that its experiment allows.
pub fn routes(recording: &ShaftRecording) -> Vec<Route<'_>> {
    let Routes { state_space, black_box, multisine, .. } = &recording.routes;
    let own = Route { name: "Δω → T_shaft", estimate: recording.shaft.as_ref().map(|shaft| &shaft.estimate) };
    let others = [
        route("State space (T_d, ω_e) → ω_d", state_space.as_ref(), |found| &found.estimate),
        route("Black box T_d → ω_d", black_box.as_ref(), |found| &found.estimate),
        route("Means over periods", multisine.as_ref(), |found| &found.estimate),
    ];
    std::iter::once(own).chain(others.into_iter().flatten()).collect()
}

fn route<'a, T>(name: &'static str, found: Option<&'a Outcome<T>>, of: fn(&T) -> &Estimate) -> Option<Route<'a>> {
    found.map(|found| Route { name, estimate: found.as_ref().map(of) })
}

/// Remarks that one needs to read the routes: where one contradicts the recording's own estimate, and what each cannot
/// show.
pub fn route_remarks(recording: &ShaftRecording) -> Vec<String> {
    let Routes { state_space, black_box, multisine, torque_sample_time_s } = &recording.routes;
    let mut remarks: Vec<String> = recording.inertia_contradiction.map(torque_doubted).into_iter().collect();
    remarks.extend(apart(&routes(recording)));
    if let Some(apart_s) = torque_sample_time_s.filter(|apart_s| *apart_s > COARSE_S) {
        remarks.push(format!(
            "T_d is known only at its samples, {} apart, and no interval includes their aliasing; add \
             WhiteNoise_T_TN or Step_T_TN, which show T_d between the samples",
            number::duration(apart_s)
        ));
    }
    if state_space.as_ref().is_some_and(|found| found.estimated().is_some()) {
        remarks.push(
            "State space: the intervals are slightly narrow; on 40 virtual benches they contained K in 36 cases and B in 34 to 36"
                .to_owned(),
        );
    }
    remarks.extend(black_box.as_ref().and_then(Outcome::estimated).map(black_box_doubts).unwrap_or_default());
    remarks.extend(multisine.as_ref().and_then(Outcome::estimated).map(multisine_doubts).unwrap_or_default());
    remarks
}

/// Meaning for K and B of a J_d that does not fit.
fn torque_doubted(share: f64) -> String {
    format!(
        "The J_d of the bench file differs by {} from the one found, so J_d or the scale of T_d is wrong. K and B are proportional to \
         T_d. Only the intervals of `dynoid study` include that",
        number::significant_with_unit(100.0 * share, 2, "%")
    )
}

/// Routes whose interval of K or B lies wholly outside that of the first.
fn apart(routes: &[Route<'_>]) -> Vec<String> {
    let Some((Route { name: first, estimate: Ok(own) }, others)) = routes.split_first() else { return Vec::new() };
    let disjoint = |other: &Estimate, quantity| {
        let intervals = own.parameter(quantity).zip(other.parameter(quantity)).map(|(a, b)| (a.interval, b.interval));
        intervals.is_some_and(|(a, b)| a.1 < b.0 || b.1 < a.0)
    };
    let remark = |other: &Route<'_>| {
        let both = [Quantity::Stiffness, Quantity::Damping].into_iter();
        let apart = both.filter(|quantity| other.estimate.is_ok_and(|estimate| disjoint(estimate, *quantity)));
        let symbols: Vec<&str> = apart.map(Quantity::symbol).collect();
        let (name, which) = (other.name, symbols.join(" and "));
        let text =
            format!("{name}: its {which} and that of {first} disagree; one of them is wrong by more than its interval");
        (!symbols.is_empty()).then_some(text)
    };
    others.iter().filter_map(remark).collect()
}

/// Reasons not to take a black box's parameters for the bench's.
fn black_box_doubts(found: &BlackBoxRoute) -> Vec<String> {
    let doubt = |doubt: &BlackBoxDoubt| match doubt {
        BlackBoxDoubt::NotTwoMasses => format!(
            "Black box: its coefficients are not those of two masses and a spring (χ² = {} with {} degrees of \
             freedom); its intervals are wider by √(χ²/degrees of freedom) and may still miss the true values",
            number::significant(found.chi_squared.0, 3),
            found.chi_squared.1,
        ),
        BlackBoxDoubt::EngineInertiaTooSmall => {
            "Black box: J_e is too small compared with J_d to be estimated".to_owned()
        }
        BlackBoxDoubt::ModesNotSeparated => {
            "Black box: the antiresonance cannot be separated from the resonance".to_owned()
        }
    };
    found.doubts.iter().map(doubt).collect()
}

/// Reasons to doubt the estimate from means over periods.
fn multisine_doubts(found: &MultisineRoute) -> Vec<String> {
    let too_large = |test: &CostTest, of: &str| {
        let [achieved, limit] = [test.achieved, test.limits.1].map(|cost| number::significant(cost, 3));
        let text = format!(
            "Means over periods: the residual of {of} is larger than the scatter between periods explains (cost {achieved}, 95 % below {limit}); \
             its intervals are wider by √(cost/expected)"
        );
        (!test.passed()).then_some(text)
    };
    let shaft = too_large(&found.cost, "the shaft");
    let engine = found.engine_cost.as_ref().and_then(|test| too_large(test, "the engine’s side"));
    let no_inertia = found.engine_error.as_ref().map(|why| format!("Means over periods: {why}"));
    [shaft, engine, no_inertia].into_iter().flatten().collect()
}

/// Routes that none of the recordings allows, and what would.
pub fn routes_not_taken(study: &ShaftAnalysis) -> Vec<&'static str> {
    let taken = |is: fn(&Routes) -> bool| study.recordings.iter().any(|recording| is(&recording.routes));
    let with_shaft = study.recordings.iter().any(|recording| recording.shaft.estimated().is_some());
    let absent = [
        (
            taken(|routes| routes.state_space.is_some()),
            "State space (T_d, ω_e) → ω_d: not taken, it needs T_d, which a bench with torque flange does not record",
        ),
        (
            taken(|routes| routes.black_box.is_some()),
            "Black box T_d → ω_d: not taken, for motored engines alone (Unfired_N_NT); a fired one hides K and B behind its torque",
        ),
        (
            taken(|routes| routes.multisine.is_some()),
            "Means over periods: not taken, for a torque demand that repeats (Multisine_T_TN)",
        ),
    ];
    absent.into_iter().filter(|(taken, _)| with_shaft && !taken).map(|(_, why)| why).collect()
}

/// Verdict on a dual-mass flywheel, in a sentence.
pub fn dual_mass(found: &DualMass, simple_misfit: Option<f64>) -> String {
    let with = number::significant(found.misfit, 2);
    let without = simple_misfit.map(|misfit| format!(", {} times without", number::significant(misfit, 2)));
    let verdict = match simple_misfit {
        Some(simple) if found.misfit < MISFIT && simple > MISFIT => "this is a shaft with a dual-mass flywheel",
        Some(simple) if simple < MISFIT => "the simple shaft fits as well",
        _ => "a dual-mass flywheel does not explain it either",
    };
    format!(
        "with a dual-mass flywheel errors are {with} times what the noise explains{}: {verdict}",
        without.unwrap_or_default()
    )
}

/// Joint finding of several recordings, in a sentence.
pub fn together(of: &Together) -> String {
    let count = of.stiffness.by_recording.len();
    let chi = number::significant(of.chi_squared, 3);
    let distance = format!("χ² = {chi} with {} degrees of freedom", of.degrees_of_freedom);
    if of.apart {
        format!(
            "by their own intervals the {count} recordings do not show the same shaft ({distance}); the intervals above are wider by √(χ²/degrees of freedom), and the terms beyond K and B may show why"
        )
    } else {
        format!("the {count} recordings agree ({distance})")
    }
}

/// All recordings side by side, then response, values by band and by route, and errors of each.
pub fn figures(study: &ShaftAnalysis) -> Vec<Figure> {
    let of_each = study.recordings.iter().flat_map(|recording| {
        let shaft = recording.shaft.estimated();
        let response = shaft.map(|shaft| response_figure(recording, shaft));
        let bands = shaft.filter(|_| !recording.bands.is_empty()).map(|shaft| band_figure(recording, shaft));
        let by_route = shaft.and_then(|_| route_figure(recording));
        let errors = shaft.map(|shaft| error_figure(recording, shaft));
        [response, bands, by_route, errors].into_iter().flatten()
    });
    study.together.as_ref().map(together_figure).into_iter().chain(of_each).collect()
}

fn response_figure(recording: &ShaftRecording, shaft: &Shaft) -> Figure {
    let response = &shaft.frequency_response;
    let panel = |axis, measured: &[f64], modelled: &[f64]| {
        let layers = vec![
            Layer::curve("K/s + B", Style::Modelled, &response.frequencies_hz, modelled),
            Layer::dots("measured", Style::Measured, &response.frequencies_hz, measured),
        ];
        Panel::new(axis, HEIGHT, layers)
    };
    let panels = vec![
        panel(Axis::linear("gain", "dB"), &response.measured_gain_db, &response.modelled_gain_db),
        panel(Axis::angle("phase"), &response.measured_phase_deg, &response.modelled_phase_deg),
    ];
    Figure::new(&format!("{}: from Δω to T_shaft", recording.file), Axis::frequency(), panels)
        .with_caption("Timing of the signals taken out; the model is that of the whole band.")
}

fn band_figure(recording: &ShaftRecording, shaft: &Shaft) -> Figure {
    let panels = [Quantity::Stiffness, Quantity::Damping].map(|quantity| {
        let Notation { symbol, unit, .. } = quantity.notation();
        let whole = shaft.estimate.parameter(quantity).map_or(f64::NAN, |p| p.value);
        let layers = vec![
            by_band("as if time stamps were exact", Style::Other, recording, quantity, |band| &band.ignoring_timing),
            by_band("with gate and skews", Style::Modelled, recording, quantity, |band| &band.estimate),
            Layer::HorizontalMark { y: rounded(&[whole])[0], label: format!("{symbol} of the whole band") },
        ];
        Panel::new(Axis::linear(symbol, unit), HEIGHT, layers)
    });
    Figure::new(&format!("{}: by band of frequencies", recording.file), Axis::frequency().within(1.0, 110.0), panels.into())
        .with_caption(
            "At the middle of each band, with 95 % intervals. Gate and skews are those of the whole band. An error of timing looks like damping, differently in each band.",
        )
}

/// K and B by every route that shows them; none where there is one alone.
fn route_figure(recording: &ShaftRecording) -> Option<Figure> {
    let found: Vec<(&str, &Estimate)> =
        routes(recording).into_iter().filter_map(|route| Some((route.name, route.estimate.ok()?))).collect();
    if found.len() < 2 {
        return None;
    }
    let x: Vec<f64> = (1..=found.len()).map(|i| i as f64).collect();
    let panels = [Quantity::Stiffness, Quantity::Damping].map(|quantity| {
        let Notation { symbol, unit, .. } = quantity.notation();
        let values: Vec<_> = found
            .iter()
            .map(|(_, estimate)| {
                estimate.parameter(quantity).map_or((f64::NAN, (f64::NAN, f64::NAN)), |p| (p.value, p.interval))
            })
            .collect();
        Panel::new(Axis::linear(symbol, unit), HEIGHT, vec![points("with 95 % interval", Style::Modelled, &x, &values)])
    });
    let names = found.iter().enumerate().map(|(i, (name, _))| format!("{}: {name}", i + 1)).collect::<Vec<_>>();
    let title = format!("{}: by different methods", recording.file);
    let sentences: Vec<String> = std::iter::once(names.join(", ")).chain(route_remarks(recording)).collect();
    Some(
        Figure::new(&title, Axis::linear("method", ""), panels.into())
            .with_caption(format!("{}.", sentences.join(". "))),
    )
}

fn by_band(
    name: &str,
    style: Style,
    recording: &ShaftRecording,
    quantity: Quantity,
    of: impl Fn(&Band) -> &Estimate,
) -> Layer {
    let middle = |band: &Band| (band.band_hz.0 * band.band_hz.1).sqrt();
    let found: Vec<(f64, &Parameter)> =
        recording.bands.iter().filter_map(|band| Some((middle(band), of(band).parameter(quantity)?))).collect();
    let x: Vec<f64> = found.iter().map(|(x, _)| *x).collect();
    points(name, style, &x, &found.iter().map(|(_, p)| (p.value, p.interval)).collect::<Vec<_>>())
}

fn points(name: &str, style: Style, x: &[f64], values: &[(f64, (f64, f64))]) -> Layer {
    let column = |of: fn(&(f64, (f64, f64))) -> f64| rounded(&values.iter().map(of).collect::<Vec<_>>());
    Layer::Points {
        name: name.to_owned(),
        style,
        x: Abscissa::Values(rounded(x)),
        y: column(|v| v.0),
        low: Some(column(|v| v.1.0)),
        high: Some(column(|v| v.1.1)),
    }
}

fn error_figure(recording: &ShaftRecording, shaft: &Shaft) -> Figure {
    let errors = &shaft.residual_spectrum;
    let layers = vec![
        Layer::dots(
            "error over its standard deviation",
            Style::Residual,
            &errors.frequencies_hz,
            &errors.normalised_magnitude,
        ),
        Layer::HorizontalMark {
            y: rounded(&[errors.bound])[0],
            label: "99 % lie below, if the model is right".to_owned(),
        },
        Layer::VerticalMarks { x: rounded(&errors.excluded_hz), label: "left out".to_owned() },
    ];
    let panel = Panel::new(Axis::linear("|error|", "σ"), HEIGHT, layers);
    Figure::new(&format!("{}: residual of K and B", recording.file), Axis::frequency(), vec![panel])
        .with_caption("Residual of the shaft's equation by frequency, divided by the part that noise explains.")
}

/// An axis of 1, 2, …, with room at both ends.
fn numbered(what: &str, count: usize) -> Axis {
    Axis::linear(what, "").within(0.5, count as f64 + 0.5)
}

fn together_figure(of: &Together) -> Figure {
    let panels = [&of.stiffness, &of.damping].map(|common| {
        let Notation { symbol, unit, .. } = common.parameter.quantity.notation();
        let (low, high) = common.parameter.interval;
        let each: Vec<(f64, (f64, f64))> =
            common.by_recording.iter().map(|(_, v, s)| (*v, (v - BAND * s, v + BAND * s))).collect();
        let x: Vec<f64> = (1..=each.len()).map(|i| i as f64).collect();
        let ends = rounded(&[low, high]);
        let layers = vec![
            Layer::YRegion { low: ends[0], high: ends[1], label: "of all together, 95 %".to_owned() },
            points("of each recording", Style::Measured, &x, &each),
        ];
        Panel::new(Axis::linear(symbol, unit), HEIGHT, layers)
    });
    let names: Vec<String> =
        of.stiffness.by_recording.iter().enumerate().map(|(i, (file, ..))| format!("{}: {file}", i + 1)).collect();
    Figure::new("Recordings side by side", numbered("recording", names.len()), panels.into()).with_caption(format!(
        "{}. {}.",
        names.join(", "),
        together(of)
    ))
}
