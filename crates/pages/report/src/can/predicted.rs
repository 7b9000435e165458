//! The answer to whether a bench can run a test.

use capability::{Answer, Beyond, Easier, FollowingSpread, LimitOf, Verdict};
use cycle::RequirementSet;
use design::safety::FrictionSpread;
use page::{
    Abscissa, Align, Axis, Block, Blocks, Cell, Figure, Finding, Layer, Page, Panel, Style, Table, Tone, rounded,
};
use rig::engine_pulses::KnownPulses;
use signal::proportion::Proportion;
use units::RPM_RAD_S;
use virtual_bench::Assumption;

use super::{changes, words};
use crate::assumptions::{assumptions, friction, prior_ranges};
use crate::figures::COURSE_HEIGHT;
use crate::wording::{self, number};

/// A question with its answer.
#[derive(Debug, Clone, Copy)]
pub struct Asked<'a> {
    /// The test.
    pub test: &'a str,
    /// How long it lasts, s.
    pub duration_s: f64,
    /// The answer.
    pub verdict: &'a Verdict,
    /// Changes that would make a no a yes.
    pub easier: &'a [Easier],
    /// The requirement sets.
    pub sets: &'a [RequirementSet],
    /// True where the benches were drawn from the covariance of a study.
    pub has_study: bool,
    /// True where the test is a cycle.
    pub is_cycle: bool,
    /// Knowledge of the engine's firing pulses.
    pub pulses: &'a KnownPulses,
    /// Assumptions of the answer.
    pub assumptions: &'a [Assumption],
    /// Friction of the dynamometer.
    pub friction: FrictionSpread,
    /// How its engine follows torques that the test demands, where that is assumed.
    pub following: Option<FollowingSpread>,
}

/// The answer, what limits it, and the courses.
pub fn page(asked: &Asked<'_>) -> Page {
    let verdict = asked.verdict;
    let mut all = Blocks::from(Block::Callout {
        tone: tone(asked),
        kicker: "Can this bench run this test?".to_owned(),
        title: format!("{}, {}: {}", asked.test, number::duration(asked.duration_s), words::answer(verdict)),
        blocks: vec![Block::Table(limits(verdict))],
    });
    all.push(
        verdict.sets.iter().zip(asked.sets).map(|(judged, set)| statistics(verdict, judged, set)).collect::<Blocks>(),
    );
    if !verdict.own.is_empty() {
        all.push(Block::heading("Your requirements"));
        all.push(own(verdict));
    }
    all.push(changes::easier(verdict, asked.easier));
    all.push(changes::doubts(verdict));
    all.push(findings(asked));
    all.push(assumptions(asked.assumptions).collect::<Blocks>());
    all.push(Block::figure(courses(verdict)));
    Page::new(format!("{}, predicted", asked.test), all.into_vec())
}

/// The basis of the answer as findings: how benches were drawn, what was not checked, and what is assumed.
pub fn rests_on(asked: &Asked<'_>) -> Vec<Finding> {
    let finding = |block: Block| match block {
        Block::Finding(finding) => Some(finding),
        Block::Paragraph { text, .. } => Some(Finding::new(Tone::Plain, "how", text)),
        _ => None,
    };
    findings(asked).into_vec().into_iter().chain(assumptions(asked.assumptions)).filter_map(finding).collect()
}

/// Green is an answer on all limits alone.
fn tone(asked: &Asked<'_>) -> Tone {
    match asked.verdict.answer {
        Answer::Yes if asked.verdict.unchecked.is_empty() => Tone::Good,
        Answer::Yes | Answer::Perhaps | Answer::NotShown | Answer::NotJudged => Tone::Caution,
        Answer::No => Tone::Bad,
    }
}

fn limits(verdict: &Verdict) -> Table {
    let mut table = Table::new(&[
        ("", Align::Left),
        ("median", Align::Right),
        ("1 in 20 beyond", Align::Right),
        ("limit", Align::Right),
        ("reached (95 % interval)", Align::Left),
        ("largest at", Align::Right),
    ]);
    for one in &verdict.limits {
        let (name, unit, si) = words::limit_of(one.of);
        let value = |value: f64| number::bounded(value / si, unit);
        let limit = one.limit.map_or_else(|| Cell::toned("none stated", Tone::Faint), |limit| value(limit).into());
        let tone = one.reached.as_ref().map_or(Tone::Faint, of_reached);
        table.row([
            name.into(),
            value(one.values.quantile(0.5)).into(),
            value(one.values.quantile(0.95)).into(),
            limit,
            Cell::toned(one.reached.as_ref().map_or_else(String::new, number::proportion), tone),
            number::time(one.time_s).into(),
        ]);
    }
    table
}

fn of_reached(reached: &Proportion) -> Tone {
    match reached.estimate {
        share if share <= 0.05 => Tone::Good,
        share if share < 0.5 => Tone::Caution,
        _ => Tone::Bad,
    }
}

fn of_kept(kept: &Proportion) -> Tone {
    match kept.estimate {
        share if share >= 0.95 => Tone::Good,
        share if share > 0.5 => Tone::Caution,
        _ => Tone::Bad,
    }
}

fn statistics(verdict: &Verdict, judged: &capability::SetVerdict, set: &RequirementSet) -> Blocks {
    let mut table = Table::new(&[
        ("", Align::Left),
        ("", Align::Left),
        ("5 … 95 % of the benches", Align::Left),
        ("allowed", Align::Left),
        ("kept (95 % interval)", Align::Left),
    ]);
    for one in &judged.statistics {
        let at = |share: f64| words::value_of(one.signal, one.statistic, one.values.quantile(share));
        table.row([
            words::signal(one.signal).0.into(),
            words::statistic(one.statistic).into(),
            format!("{} … {}", at(0.05), at(0.95)).into(),
            words::allowed(one.signal, one.statistic, (one.low, one.high)).into(),
            Cell::toned(number::proportion(&one.kept), of_kept(&one.kept)),
        ]);
    }
    let met = format!("{} of the benches meet these statistics.", number::proportion(&judged.kept));
    let beside = match verdict.answer {
        Answer::Yes => "",
        _ => " The answer above also contains the limits of the bench and your own requirements.",
    };
    let mut all = Blocks::from(Block::heading(set.title.as_str()));
    all.push(table);
    all.push(Block::paragraph(met + beside));
    all.push(Block::Finding(words::required(set)));
    all
}

fn own(verdict: &Verdict) -> Table {
    let mut table = Table::new(&[
        ("", Align::Left),
        ("median", Align::Right),
        ("1 in 20 beyond", Align::Right),
        ("met (95 % interval)", Align::Left),
        ("worst at", Align::Right),
    ]);
    for one in &verdict.own {
        let at = |share: f64| words::own_value(&one.own, one.values.quantile(share));
        table.row([
            words::own(&one.own).into(),
            at(0.5).into(),
            at(0.95).into(),
            Cell::toned(number::proportion(&one.kept), of_kept(&one.kept)),
            number::time(one.time_s).into(),
        ]);
    }
    table
}

fn findings(asked: &Asked<'_>) -> Blocks {
    let verdict = asked.verdict;
    let finding = |tone, what: &str, words: String| Block::Finding(Finding::new(tone, what, words));
    let mut all = Blocks::default();
    all.push(beyond(&verdict.beyond));
    let drawn = match asked.has_study {
        true => "by the covariance of the study's estimates".to_owned(),
        false => prior_ranges(),
    };
    all.push(Block::paragraph(format!("{} benches drawn: {drawn}.", verdict.kept.of)));
    all.push(Block::paragraph(wording::engine_pulses(asked.pulses)));
    if !verdict.unchecked.is_empty() {
        let name = |of: &LimitOf| format!("{} (`{}`)", words::limit_of(*of).0, of.key());
        let names: Vec<String> = verdict.unchecked.iter().map(name).collect();
        let words = format!(
            "the bench file states no limit of {}. Write each into [limits], such as `torque = \"300 Nm\"`. With --allow-unchecked \
             the exit code does not count them.",
            wording::join(&names, "and")
        );
        all.push(finding(Tone::Caution, "not checked", words));
    }
    if verdict.unstable.count > 0 {
        let words = format!("{} of the benches drawn", number::proportion(&verdict.unstable));
        all.push(finding(Tone::Bad, "not stable", words));
    }
    all.push(friction(&asked.friction));
    if let Some(words) = following(asked) {
        all.push(finding(Tone::Caution, "assumed", words));
    }
    if asked.is_cycle {
        let engine = "Each engine is asked for the torque of the cycle at its flywheel, and for what its own inertia needs. It gives \
                      that through the intake of [virtual_bench.engine], firing by firing.";
        all.push(finding(Tone::Plain, "assumed", engine.to_owned()));
        let pulses = "Firing pulses count for every limit. Stretches of the cycle are simulated firing by firing: first those in which \
                      pulses could make the largest values.";
        all.push(finding(Tone::Plain, "how", pulses.to_owned()));
    }
    all
}

/// How engines follow torques that are demanded, where nobody states it.
fn following(asked: &Asked<'_>) -> Option<String> {
    let FollowingSpread { gain, offset, lag_s } = asked.following?;
    let percent = |share: f64| number::significant(100.0 * share, 2);
    Some(format!(
        "the torque of each engine has a gain within ±{} %, an offset within ±{} % of the largest torque (standard deviations), and a \
         lag of 0 … {} ms beside its intake. State your engine in [virtual_bench.engine] to leave this out.",
        percent(gain),
        percent(offset),
        number::significant(1e3 * lag_s, 2)
    ))
}

/// Demands that no bench drawn can show, each as a finding.
pub(crate) fn beyond(all: &[Beyond]) -> Blocks {
    let finding = |one: &Beyond| {
        let (what, remedy) = match one.is_of_engine() {
            true => ("beyond the engine", "Take an engine, or a map, that has it."),
            false => {
                ("beyond the model", "Record the bench there and study it again. Nobody has tested the model there.")
            }
        };
        let words = format!("{}. {remedy}", wording::capitalised(&words::beyond(one)));
        Block::Finding(Finding::new(Tone::Caution, what, words))
    };
    all.iter().map(finding).collect()
}

fn courses(verdict: &Verdict) -> Figure {
    let trace = &verdict.nominal;
    let clock = (trace.start_s, trace.step_s);
    let scaled = |values: &[f64], si: f64| values.iter().map(|value| value / si).collect::<Vec<_>>();
    let band = |[low, high]: &[Vec<f64>; 2], si: f64| Layer::Band {
        name: "90 % of the benches".to_owned(),
        style: Style::Modelled,
        x: Abscissa::Values(rounded(&verdict.bands.time_s)),
        low: rounded(&scaled(low, si)),
        high: rounded(&scaled(high, si)),
    };
    let panel = |label: &str, unit: &str, si: f64, demand: &[f64], value: &[f64], spread: &[Vec<f64>; 2]| {
        let mut layers = vec![
            band(spread, si),
            Layer::trace("demanded", Style::Other, clock, &scaled(demand, si)),
            Layer::trace("predicted", Style::Modelled, clock, &scaled(value, si)),
        ];
        layers.extend(marks(verdict));
        Panel::new(Axis::linear(label, unit), COURSE_HEIGHT, layers)
    };
    let bands = &verdict.bands;
    let speed = panel("speed", "rpm", RPM_RAD_S, &trace.speed_demand_rad_s, &trace.speed_rad_s, &bands.speed_rad_s);
    let torque = panel("torque", "Nm", 1.0, &trace.torque_demand_nm, &trace.torque_nm, &bands.torque_nm);
    let error: Vec<f64> =
        trace.speed_rad_s.iter().zip(&trace.speed_demand_rad_s).map(|(is, wanted)| is - wanted).collect();
    let error = vec![Layer::trace("speed less its demand", Style::Residual, clock, &scaled(&error, RPM_RAD_S))];
    let error = Panel::new(Axis::linear("error of the speed", "rpm"), COURSE_HEIGHT, error);
    let dyno = vec![Layer::trace("T_d*", Style::Modelled, clock, &trace.dyno_demand_nm)];
    let dyno = Panel::new(Axis::linear("T_d*", "Nm"), COURSE_HEIGHT, dyno);
    Figure::new("Demanded and predicted", Axis::time(), vec![speed, error, torque, dyno])
        .with_caption("The nominal bench, the band of the others, and the moments at which limits bind.")
}

/// Moments at which a limit is reached on some bench.
fn marks(verdict: &Verdict) -> Vec<Layer> {
    let reached = verdict.limits.iter().filter(|one| one.reached.is_some_and(|reached| reached.count > 0));
    reached
        .map(|one| Layer::VerticalMarks { x: rounded(&[one.time_s]), label: words::limit_of(one.of).0.to_owned() })
        .collect()
}
