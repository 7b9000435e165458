//! A safety check: the verdict, how peaks spread over the benches drawn, and how large sines may be.

use capability::Beyond;
use design::safety::{Checked, FrictionSpread, Proposal, Quantity, SafeSine, Safety, SafetyCheck};
use page::{
    Align, Axis, Block, Blocks, Cell, Figure, Finding, Layer, Page, Panel, Rounded, Style, Table, Tone, rounded,
};
use rig::ControlMode;
use rig::engine_pulses::KnownPulses;
use rig::experiment::ExperimentPlan;
use units::RPM_RAD_S;
use virtual_bench::Assumption;

use crate::assumptions::{assumptions, friction, prior_ranges};
use crate::can::beyond_findings;
use crate::figures::HEIGHT;
use crate::wording::{self, number};

/// An experiment that was checked.
#[derive(Clone, Copy)]
pub struct CheckedPlan<'a> {
    /// The experiment.
    pub plan: &'a ExperimentPlan,
    /// The lowest and the highest speed demanded, rad/s: nobody may have stated them.
    pub speeds_rad_s: (f64, f64),
    /// Result of the check.
    pub check: &'a SafetyCheck,
    /// True where the benches were drawn from the covariance of a study.
    pub has_study: bool,
    /// Knowledge of the engine's firing pulses.
    pub pulses: &'a KnownPulses,
    /// Assumptions of the check.
    pub assumptions: &'a [Assumption],
    /// Friction of the dynamometer.
    pub friction: FrictionSpread,
    /// Where the experiment leaves the range of the recordings that the model is from.
    pub beyond: &'a [Beyond],
}

/// The verdict with what it rests on.
pub fn page(checked: &CheckedPlan<'_>) -> Page {
    let CheckedPlan { plan, check, .. } = *checked;
    let rpm = |speed_rad_s: f64| number::significant(speed_rad_s / RPM_RAD_S, 5);
    let speed = match (rpm(checked.speeds_rad_s.0), rpm(checked.speeds_rad_s.1)) {
        (low, high) if low == high => low,
        (low, high) => format!("{low} … {high}"),
    };
    let mut all = Blocks::from(Block::Callout {
        tone: overall_tone(check),
        kicker: "Safety check".to_owned(),
        title: format!("{} at {speed} rpm, {} s: {}", plan.label, plan.duration_s, verdict(check)),
        blocks: vec![Block::Table(limits(check))],
    });
    all.push(beyond_findings(checked.beyond));
    let drawn = check.unstable.of;
    all.push(Block::paragraph(format!("{drawn} benches drawn: {}.", spread_words(checked.has_study))));
    if plan.has_shaft {
        all.push(Block::paragraph(wording::engine_pulses(checked.pulses)));
    }
    if plan.label.mode == ControlMode::Tn && checked.assumptions.contains(&Assumption::Engine) {
        let drawn =
            "The bandwidth of the engine's speed control is drawn between a tenth of the assumed value and that value.";
        all.push(Block::paragraph(drawn));
    }
    all.push(findings(check));
    all.push(friction(&checked.friction));
    all.push(assumptions(checked.assumptions).collect::<Blocks>());
    all.push(check.sines.iter().map(propose).collect::<Blocks>());
    all.push(figures(check).into_iter().collect::<Blocks>());
    Page::new(format!("{}, checked", plan.label), all.into_vec())
}

/// The verdict, and of how many limits it speaks.
fn verdict(check: &SafetyCheck) -> String {
    let verdict = wording::safety(check.safety).to_uppercase();
    let stated: Vec<&Checked> = check.checked.iter().filter(|one| one.reached.is_some()).collect();
    let unchecked = match check.unchecked.len() {
        0 => String::new(),
        unchecked => format!("; {unchecked} of {} limits not checked", stated.len() + unchecked),
    };
    match check.safety {
        Safety::NotChecked => verdict,
        Safety::Safe if unchecked.is_empty() => verdict,
        Safety::Safe => format!("{verdict} by the limits that are stated{unchecked}"),
        Safety::Risky | Safety::Unsafe => {
            let missed = stated.iter().filter(|one| one.safety() != Safety::Safe);
            let names: Vec<String> = missed.map(|one| wording::quantity(one.of).0.to_owned()).collect();
            let by = if names.is_empty() { String::new() } else { format!(" by {}", wording::join(&names, "and")) };
            format!("{verdict}{by}{unchecked}")
        }
    }
}

/// Green is a verdict on all limits alone.
fn overall_tone(check: &SafetyCheck) -> Tone {
    match check.safety {
        Safety::Safe if !check.unchecked.is_empty() => Tone::Caution,
        safety => tone(safety),
    }
}

fn findings(check: &SafetyCheck) -> Blocks {
    let finding = |tone, what: &str, words: String| Block::Finding(Finding::new(tone, what, words));
    let mut all = Blocks::default();
    if check.safety == Safety::NotChecked {
        let words = "the bench file states no limit that bears on this; add [limits]";
        all.push(finding(Tone::Caution, "not checked", words.to_owned()));
    }
    if check.checked.iter().any(|one| one.reached.is_some()) {
        let words = format!("{} of the benches drawn", number::proportion(&check.any));
        all.push(finding(tone(check.safety), "any limit reached", words));
    }
    if check.safety != Safety::NotChecked && !check.unchecked.is_empty() {
        let names: Vec<String> = check.unchecked.iter().map(|of| wording::quantity(*of).0.to_owned()).collect();
        let words = format!("the bench file states no limit of {}; add it to [limits]", wording::join(&names, "and"));
        all.push(finding(Tone::Caution, "not checked", words));
    }
    if check.unstable.count > 0 {
        let words = format!("{} of the benches drawn", number::proportion(&check.unstable));
        all.push(finding(Tone::Bad, "not stable", words));
    }
    if let Some(hint) = check.thermal {
        let words = format!(
            "ignition efficiency below 0.8 for {}; {} of the torque is lost to the exhaust on average",
            number::measure(hint.below_80_percent_s, "s"),
            number::share(hint.mean_loss)
        );
        all.push(finding(Tone::Caution, "heat", words));
    }
    all
}

fn spread_words(has_study: bool) -> String {
    match has_study {
        true => "by the covariance of the study's estimates; all other parameters are taken as exact".to_owned(),
        false => prior_ranges(),
    }
}

fn limits(checked: &SafetyCheck) -> Table {
    let mut table = Table::new(&[
        ("", Align::Left),
        ("median", Align::Right),
        ("1 in 20 beyond", Align::Right),
        ("limit", Align::Right),
        ("reached (95 % interval)", Align::Left),
        ("", Align::Left),
    ]);
    for one in &checked.checked {
        let (name, unit, si) = wording::quantity(one.of);
        let limit = match (one.limit, one.of.has_limit()) {
            (Some(limit), _) => Cell::from(number::bounded(limit / si, unit)),
            (None, true) => Cell::toned("none stated", Tone::Faint),
            (None, false) => Cell::from(""),
        };
        let verdict = if one.of.has_limit() { wording::safety(one.safety()) } else { "" };
        table.row([
            name.into(),
            number::bounded(one.quantile(0.5) / si, unit).into(),
            number::bounded(beyond(one) / si, unit).into(),
            limit,
            one.reached.as_ref().map_or_else(String::new, number::proportion).into(),
            Cell::toned(verdict, tone(one.safety())),
        ]);
    }
    table
}

/// Value that one bench in twenty goes beyond.
fn beyond(checked: &Checked) -> f64 {
    checked.quantile(if checked.of == Quantity::LowestSpeed { 0.05 } else { 0.95 })
}

fn tone(safety: Safety) -> Tone {
    match safety {
        Safety::Safe => Tone::Good,
        Safety::Risky => Tone::Caution,
        Safety::Unsafe => Tone::Bad,
        Safety::NotChecked => Tone::Faint,
    }
}

/// The sines that are too large, and what they may be.
fn propose(proposal: &Proposal) -> Blocks {
    let too_large: Vec<&SafeSine> = proposal.sines.iter().filter(|sine| sine.safe_nm < sine.planned_nm).collect();
    if too_large.is_empty() {
        return Blocks::default();
    }
    let mut table = Table::new(&[
        ("sine", Align::Right),
        ("planned", Align::Right),
        ("safe amplitude", Align::Right),
        ("as planned, reaches a limit (95 % interval)", Align::Left),
    ]);
    for sine in &too_large {
        table.row([
            number::bounded(sine.frequency_hz, "Hz").into(),
            number::bounded(sine.planned_nm, "Nm").into(),
            number::bounded(sine.safe_nm, "Nm").into(),
            number::proportion(&sine.reached).into(),
        ]);
    }
    let sentence = match proposal.holds {
        true => "With these amplitudes, and all others as planned, the test keeps the limits on the random benches.",
        false => "Even with these amplitudes the test reaches a limit; change its mean torque or its speed.",
    };
    [Block::Table(table), Block::paragraph(sentence)].into_iter().collect()
}

/// The figures: the distribution of the largest shaft torque (of the torque demand without a shaft), and the amplitudes
/// of a sine test.
fn figures(check: &SafetyCheck) -> Vec<Figure> {
    let peak = check
        .checked
        .iter()
        .find(|checked| checked.of == Quantity::ShaftTorque)
        .or(check.checked.iter().find(|checked| checked.of == Quantity::TorqueDemand));
    peak.map(distribution).into_iter().chain(check.sines.as_ref().map(amplitudes)).collect()
}

fn distribution(checked: &Checked) -> Figure {
    let (name, unit, si) = wording::quantity(checked.of);
    let finite = checked.values.iter().filter(|value| value.is_finite());
    let values: Vec<f64> = finite.map(|value| value / si).collect();
    let share: Vec<f64> = (1..=values.len()).map(|k| 100.0 * k as f64 / checked.values.len() as f64).collect();
    let mut layers = vec![Layer::curve("benches at or below", Style::Modelled, &values, &share)];
    let mark = |limit: f64| Layer::VerticalMarks { x: rounded(&[limit / si]), label: "limit".to_owned() };
    layers.extend(checked.limit.map(mark));
    layers.push(Layer::HorizontalMark { y: Rounded(95.0), label: "95 %".to_owned() });
    let panel = Panel::new(Axis::linear("share of benches", "%"), HEIGHT, layers);
    Figure::new("How the peak spreads", Axis::linear(name, unit), vec![panel]).with_caption(
        "Every random bench runs the experiment; the curve shows on how many the peak stays below a value. Firing \
         pulses are included.",
    )
}

fn amplitudes(proposal: &Proposal) -> Figure {
    let of = |number: fn(&design::safety::SafeSine) -> f64| proposal.sines.iter().map(number).collect::<Vec<f64>>();
    let frequency_hz = of(|sine| sine.frequency_hz);
    let layers = vec![
        Layer::curve("safe", Style::Modelled, &frequency_hz, &of(|sine| sine.safe_nm)),
        Layer::dots("planned", Style::Other, &frequency_hz, &of(|sine| sine.planned_nm)),
    ];
    let panel = Panel::new(Axis::linear("amplitude of T_d*", "Nm"), HEIGHT, layers);
    Figure::new("How large a sine may be", Axis::linear("frequency", "Hz"), vec![panel])
        .with_caption("With all sines at the safe amplitude or below, few enough of the benches reach a limit.")
}
