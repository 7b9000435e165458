//! The models of the torque control, in words and figures.

use page::{Axis, Figure, Layer, Marker, Panel, Rounded, Style, rounded};
use part_torque::model_comparison::{
    BlackBox, Closed, ComparedRecording, ELLIPSE_LEVEL, Excited, Family, Input, Judgement, LEVEL, Model,
    ModelComparison, Root, Scanned, Shown, Structure, Verdict, Visibility, VisibilityCase,
};
use part_torque::torque_control::SecondOrderTest;
use rig::results::Trace;

use crate::figures::HEIGHT;
use crate::torque;
use crate::wording::number;

/// Height of a panel of errors.
const ERROR_HEIGHT: u32 = 110;
/// Roots further from zero than this would make all others small: they are left out, and said to be.
const FURTHEST: f64 = 2.0;
/// Nobody records longer.
const ONE_DAY_S: f64 = 86_400.0;
/// Families and inputs in the order of the tables.
const KINDS: [(Family, Input); 4] = [
    (Family::Arx, Input::Demand),
    (Family::OutputError, Input::Demand),
    (Family::Arx, Input::Error),
    (Family::OutputError, Input::Error),
];

/// Mover of T_d*, e.g. `the dynamometer`.
pub fn mover(excited: Excited) -> &'static str {
    match excited {
        Excited::Dynamometer => "the dynamometer",
        Excited::Engine => "the engine",
    }
}

fn name(family: Family) -> &'static str {
    match family {
        Family::Arx => "ARX",
        Family::OutputError => "OE",
    }
}

fn driven_by(input: Input) -> &'static str {
    match input {
        Input::Demand => "T_d*",
        Input::Error => "T_d* − T_d",
    }
}

/// A structure with its orders, ARX(na, nb, nk) or OE(nb, nf, nk), e.g. `OE(2, 1, 1) on T_d*`.
pub fn structure(structure: &Structure) -> String {
    let Structure { poles, nb, nk, .. } = structure;
    let orders = match structure.family {
        Family::Arx => [poles, nb, nk],
        Family::OutputError => [nb, poles, nk],
    };
    let [first, second, delay] = orders;
    format!("{}({first}, {second}, {delay}) on {}", name(structure.family), driven_by(structure.input))
}

/// A model in a few words.
pub fn model(model: &Model) -> String {
    match model {
        Model::PureDelay => "delay".to_owned(),
        Model::DelayAndLag => "delay and lag".to_owned(),
        Model::BlackBox { structure: one } => structure(one),
    }
}

/// How a model stands to the bar.
pub fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Better => "better",
        Verdict::Worse => "worse",
        Verdict::NotSeparated => "no difference seen",
        Verdict::NoModel => "no model",
    }
}

/// Why a black box does not settle; none where it does.
pub fn closed(closed: Closed) -> Option<&'static str> {
    match closed {
        Closed::Stable => None,
        Closed::Unstable => Some("diverges with its loop closed"),
        Closed::Circular => Some("is T_d = T_d* − (T_d* − T_d), no model"),
    }
}

/// Verdict on models against the bar on a recording, with the one that beats it by most.
pub fn against_bar(study: &ModelComparison, recording: &ComparedRecording) -> String {
    let bar = format!(
        "T_d* one sample of T_d,calc ({}) ago leaves {} where {} moves T_d*",
        number::duration(recording.sample_time_s),
        nm(recording.bar_rms_nm),
        mover(recording.excited),
    );
    let ratio = |j: &&Judgement| j.ratio.unwrap_or(f64::INFINITY);
    let judged = || study.judged_on(recording.excited);
    let better = || judged().filter(|j| j.verdict == Verdict::Better);
    let least = better().min_by(|a, b| ratio(a).total_cmp(&ratio(b)));
    let tested = judged().filter(|j| j.test.is_some()).count();
    let all = judged().count();
    match least {
        None => format!(
            "{bar}, and no model is better: none of {all} models has smaller squared errors there (99 %, {tested} \
             tests in pairs together)"
        ),
        Some(least) => format!(
            "{bar}; {} of {all} models leave less (99 %, {tested} tests in pairs together), least {}: {}, {} of the bar's error",
            better().count(),
            model(&least.model),
            least.rms_nm.map_or_else(String::new, nm),
            number::share(least.ratio.unwrap_or(f64::NAN)),
        ),
    }
}

fn nm(value: f64) -> String {
    number::significant_with_unit(value, 3, "Nm")
}

/// Meaning of a feedback from T_d* − T_d without delay, where such were among those tried.
pub fn circular(recording: &ComparedRecording) -> Option<String> {
    let undelayed = || recording.scanned.iter().filter(|s| s.structure.input == Input::Error && s.structure.nk == 0);
    let unusable = undelayed().filter(|s| s.closed != Closed::Stable).count();
    let flattered = undelayed().filter_map(|s| s.fed_percent).max_by(f64::total_cmp)?;
    let honest = undelayed().filter_map(|s| s.fit_percent).max_by(f64::total_cmp);
    let closes = honest.map_or_else(
        || "none of them follows T_d*".to_owned(),
        |fit| format!("the best follows T_d* with a fit of {}", number::fit(fit)),
    );
    Some(format!(
        "T_d* − T_d contains T_d itself: with nk = 0 a model can be T_d = T_d* − (T_d* − T_d), with T_d* from the \
         sample before. With the measured T_d* − T_d as input, the best of {} such models has a fit of {}. With the \
         loop closed, {closes}, and {unusable} diverge or contain themselves. All are judged with the loop closed",
        undelayed().count(),
        number::fit(flattered),
    ))
}

/// The delay of a black box of a recording, and the delay with the sampling modelled.
pub fn belief(recording: &ComparedRecording, black_box: &BlackBox) -> Option<String> {
    let believed = black_box.delay.as_ref()?;
    let mode = black_box.lag_rad_s.map_or_else(
        || "and its slowest mode is no lag".to_owned(),
        |a| format!("and its slowest mode is a lag of {}", number::significant_with_unit(a, 3, "rad/s")),
    );
    let [_, lag, total] = recording.delay_and_lag.as_slice() else { return None };
    let written = [total, lag].map(number::parameter);
    Some(format!(
        "{} has a delay of {} at 10 Hz, {mode}; with the sampling modelled, the values are {} and {}",
        structure(&black_box.structure),
        number::parameter(believed),
        written[0],
        written[1],
    ))
}

/// Meaning of a delay below zero, of the delay alone or beside a lag.
pub fn early(recording: &ComparedRecording) -> Vec<String> {
    torque::early_delays(std::iter::once(&recording.pure_delay).chain(&recording.delay_and_lag))
}

/// Findings beyond delay and lag.
pub fn beyond(test: Option<&SecondOrderTest>) -> String {
    let Some(test) = test else {
        return "a second-order term cannot be tested, because no lag was found".to_owned();
    };
    let ruled_out = |p_value: f64| p_value < 1.0 - LEVEL;
    let shown = match (ruled_out(test.lag_p_value), ruled_out(test.damped_p_value)) {
        (true, _) => format!("more than a lag is seen (99 %), κ = {}", number::significant(test.term, 2)),
        (false, true) => {
            "no more than a lag is seen, and a critically damped loop (κ = 0.25) is ruled out (99 %)".to_owned()
        }
        (false, false) => "neither a lag (κ = 0) nor a critically damped loop (κ = 0.25) is ruled out".to_owned(),
    };
    let doubt = if test.white { "" } else { "; the residual is not white, so this is doubtful" };
    format!("Second order, 1/(1 + s/a + κ (s/a)²): {shown}{doubt}")
}

/// The length of a recording; below a second, which no estimate of this takes, and above a day it says no more than
/// that.
pub fn recording_needed(seconds: f64) -> String {
    match seconds {
        ..1.0 => "less than 1 s".to_owned(),
        ONE_DAY_S.. => "more than a day".to_owned(),
        _ => number::duration(seconds),
    }
}

/// The first rate and hold that distinguish a loop of second order from a lag, and the least term that any of them
/// shows.
pub fn first_visible(visibility: &Visibility) -> String {
    let hertz = |case: &VisibilityCase| {
        let held = number::duration(case.hold_s);
        format!("{} Hz with T_d* held {held}", number::significant(case.rate_hz, 4))
    };
    let assumed = format!(
        "Assumed: T_d* of {} (standard deviation), {} of white noise on each sample whatever the rate, clocks that keep time, a test \
         at 99 % that finds it in 95 of 100 recordings",
        nm(visibility.demand_nm),
        nm(visibility.noise_nm)
    );
    let loop_ = "A critically damped loop (κ = 0.25) is distinguished from a lag";
    let Some(first) = visibility.first() else {
        return format!("{loop_} by none of these in {}. {assumed}", number::duration(visibility.recording_s));
    };
    let least = visibility.cases.iter().min_by(|a, b| a.least_term.total_cmp(&b.least_term)).unwrap_or(first);
    format!(
        "{loop_} from {} on, in {}; in {}, κ down to {} is visible there, and down to {} at {}. {assumed}",
        hertz(first),
        recording_needed(first.needed_s),
        number::duration(visibility.recording_s),
        number::significant(first.least_term, 2),
        number::significant(least.least_term, 2),
        hertz(least),
    )
}

/// Figures of the models' T_d, pole–zero maps, fit against order, and the visibility at other rates and demands.
pub fn figures(study: &ModelComparison) -> Vec<Figure> {
    let of_recording = |recording: &ComparedRecording| {
        let shown = study.shown.iter().filter(|shown| shown.judged_on == recording.excited);
        let traces = shown.map(|shown| trace_figure(recording, shown));
        let maps = [Input::Demand, Input::Error].into_iter().filter_map(|input| map(recording, input));
        traces.chain(maps).chain(std::iter::once(orders(recording))).collect::<Vec<_>>()
    };
    study.recordings.iter().flat_map(of_recording).chain(study.visibility.as_ref().map(rates)).collect()
}

/// The held-out part as it was, and what models make of it, with their errors below.
fn trace_figure(recording: &ComparedRecording, shown: &Shown) -> Figure {
    let line = |name: &str, style: Style, trace: &Trace, values: &[f64]| {
        Layer::trace(name, style, (trace.start_s, trace.sample_time_s), values)
    };
    let left = |trace: &Trace| -> Vec<f64> {
        shown.measured.values.iter().zip(&trace.values).map(|(measured, modelled)| measured - modelled).collect()
    };
    let named = |(of, source, trace): &'_ (Model, Excited, Trace)| {
        let estimated = match *source == shown.judged_on {
            true => String::new(),
            false => format!(", estimated where {} moved T_d*", mover(*source)),
        };
        (format!("{}{estimated}", model(of)), trace.clone())
    };
    let bar = ("T_d* one sample ago (the bar)".to_owned(), shown.bar.clone());
    let all: Vec<(String, Trace)> = shown.models.iter().map(named).chain([bar]).collect();
    let drawn = |of: &dyn Fn(&Trace) -> Vec<f64>| -> Vec<Layer> {
        let layer = |(n, (name, trace)): (usize, &(String, Trace))| line(name, Style::of_model(n), trace, &of(trace));
        all.iter().enumerate().map(layer).collect()
    };
    let measured = line("measured", Style::Measured, &shown.measured, &shown.measured.values);
    let panels = vec![
        Panel::new(
            Axis::linear("T_d", "Nm"),
            HEIGHT,
            std::iter::once(measured).chain(drawn(&|t| t.values.clone())).collect(),
        ),
        Panel::new(Axis::linear("measured − model", "Nm"), ERROR_HEIGHT, drawn(&left)),
    ];
    Figure::new(&format!("{}: T_d of models, from T_d* alone", recording.label), Axis::time(), panels).with_caption(
        "The beginning of the part that no model has seen, without mean and ripple. Of each recording the black box \
         with the smallest errors there.",
    )
    .of_recording(&recording.file)
}

fn map(recording: &ComparedRecording, input: Input) -> Option<Figure> {
    let chosen: Vec<&BlackBox> = recording.black_boxes.iter().filter(|b| b.structure.input == input).collect();
    if chosen.is_empty() {
        return None;
    }
    let circle: Vec<[f64; 2]> =
        (0..=180).map(|n| f64::from(2 * n).to_radians().sin_cos()).map(|(sin, cos)| [cos, sin]).collect();
    let mut layers = vec![path("unit circle", Style::Guide, &circle)];
    let seen = |root: &&Root| root.re.hypot(root.im) <= FURTHEST;
    for (n, black_box) in chosen.iter().enumerate() {
        let style = Style::of_model(n);
        for root in black_box.poles.iter().chain(&black_box.zeros).filter(seen).filter(|r| !r.ellipse.is_empty()) {
            let whole: Vec<[f64; 2]> = root.ellipse.iter().chain(root.ellipse.first()).copied().collect();
            let within: Vec<[f64; 2]> = whole.into_iter().filter(|p| p[0].hypot(p[1]) <= FURTHEST).collect();
            layers.push(path(&format!("{:.0} % region", 100.0 * ELLIPSE_LEVEL), style, &within));
        }
        for (roots, marker, kind) in
            [(&black_box.poles, Marker::Cross, "poles"), (&black_box.zeros, Marker::Ring, "zeros")]
        {
            let (x, y): (Vec<f64>, Vec<f64>) = roots.iter().filter(seen).map(|r| (r.re, r.im)).unzip();
            if x.is_empty() {
                continue;
            }
            let name = format!("{kind} of {}", structure(&black_box.structure));
            layers.push(Layer::Markers { name, style, marker, x: rounded(&x), y: rounded(&y) });
        }
    }
    let outside = chosen.iter().flat_map(|b| b.poles.iter().chain(&b.zeros)).filter(|r| !seen(r)).count();
    let left_out = match outside {
        0 => String::new(),
        1 => format!(" Not shown: one root further than {FURTHEST} from zero."),
        count => format!(" Not shown: {count} roots further than {FURTHEST} from zero."),
    };
    let loop_ = match input {
        Input::Demand => "",
        Input::Error => ", their loops open",
    };
    let panel = Panel::new(Axis::linear("imaginary part", ""), 420, layers);
    let title = format!("{}: poles and zeros of black boxes on {}", recording.label, driven_by(input));
    let caption = format!(
        "Crosses are poles, rings zeros, with one colour per model; ellipses of the same colour contain the true \
         root with {:.0} %. Inside the grey circle models are stable. Estimated from {}; in z at {} Hz{loop_}. A \
         pole and a zero whose regions meet explain noise.{left_out}",
        100.0 * ELLIPSE_LEVEL,
        recording.file,
        number::significant(1.0 / recording.sample_time_s, 4)
    );
    Some(Figure::new(&title, Axis::linear("real part", ""), vec![panel]).with_equal_axes().with_caption(caption))
}

fn path(name: &str, style: Style, points: &[[f64; 2]]) -> Layer {
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().map(|p| (p[0], p[1])).unzip();
    Layer::Path { name: name.to_owned(), style, x: rounded(&x), y: rounded(&y) }
}

fn orders(recording: &ComparedRecording) -> Figure {
    let mut layers = Vec::new();
    for (n, (kind, input)) in KINDS.into_iter().enumerate() {
        let own: Vec<&Scanned> = recording
            .scanned
            .iter()
            .filter(|s| s.structure.family == kind && s.structure.input == input && s.fit_percent.is_some())
            .collect();
        let most = own.iter().map(|s| s.parameters).max().unwrap_or(0);
        let best = |count: usize| {
            let fits = own.iter().filter(|s| s.parameters == count).filter_map(|s| s.fit_percent);
            fits.max_by(f64::total_cmp).map(|fit| (count as f64, fit))
        };
        let (x, y): (Vec<f64>, Vec<f64>) = (1..=most).filter_map(best).unzip();
        if !x.is_empty() {
            layers.push(Layer::curve(&format!("{} on {}", name(kind), driven_by(input)), Style::of_model(n), &x, &y));
        }
    }
    let bar = Rounded(recording.bar_choice_percent);
    layers.push(Layer::HorizontalMark { y: bar, label: "one-sample delay".to_owned() });
    let panel = Panel::new(Axis::linear("fit", "%"), HEIGHT, layers);
    Figure::new(&format!("{}: fit against order", recording.label), Axis::linear("coefficients", ""), vec![panel])
        .with_caption(
            "Simulated from T_d* alone on data that the models were not estimated from: the best of each number of coefficients.",
        )
}

fn rates(visibility: &Visibility) -> Figure {
    let mut holds: Vec<f64> = visibility.cases.iter().map(|case| case.hold_s).collect();
    holds.sort_by(|a, b| b.total_cmp(a));
    holds.dedup();
    let panel = |label: &str, unit: &str, value: &dyn Fn(&VisibilityCase) -> f64| {
        let curve = |(n, hold_s): (usize, &f64)| {
            let own = visibility.cases.iter().filter(|case| case.hold_s == *hold_s);
            let (x, y): (Vec<f64>, Vec<f64>) = own.map(|case| (case.rate_hz, value(case))).unzip();
            Layer::curve(&format!("held {}", number::duration(*hold_s)), Style::of_model(n), &x, &y)
        };
        Panel::new(Axis::log(label, unit), HEIGHT, holds.iter().enumerate().map(curve).collect())
    };
    let mut needed = panel("recording needed", "s", &|case| case.needed_s);
    needed.layers.push(Layer::HorizontalMark {
        y: Rounded(visibility.recording_s),
        label: number::duration(visibility.recording_s),
    });
    let panels = vec![
        panel("error of τ", "ms", &|case| 1e3 * case.delay_s),
        panel("error of a", "%", &|case| 100.0 * case.lag_rad_s / visibility.control.1),
        panel("least κ seen", "", &|case| case.least_term),
        needed,
    ];
    Figure::new("What other rates and demands would show", Axis::log("rate of T_d,calc", "Hz"), panels).with_caption(
        format!(
            "Standard errors of τ and a and least κ seen in {}, and the recording in which κ = 0.25 is seen. {}.",
            number::duration(visibility.recording_s),
            first_visible(visibility),
        ),
    )
}
