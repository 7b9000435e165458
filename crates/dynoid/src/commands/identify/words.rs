//! What estimates have to say, in words.

use ident::validate::{Independence, JointTest, ResidualReport};
use ident::{Doubt, Label, Termination};
use lti::Mode;

use crate::terminal::Terminal;
use page::Tone;

/// A reason to doubt, with what can be done.
pub(super) fn doubt(doubt: &Doubt, parameters: &[String], outputs: &[Label]) -> String {
    match doubt {
        Doubt::NotConverged => {
            "the search stopped before it had converged; the numbers are provisional: try a lower order, or other data"
                .into()
        }
        Doubt::IllConditioned { condition } => format!(
            "the data barely tell the parameters apart (condition number {condition:.1e}); lower the order or excite the system better"
        ),
        Doubt::RowsLeftOut { rows, of } => format!(
            "{rows} of {of} rows were left out: samples are missing there (those of a slower output count so), or what the model needs of the past, or of the time around a record with band-limited inputs, was not recorded"
        ),
        Doubt::AtBound { parameter } => format!(
            "{} rests on its bound, so its interval means nothing; widen the bound or leave the parameter out",
            parameters.get(*parameter).map_or("a parameter", String::as_str)
        ),
        Doubt::Unstable => {
            "the model is not stable: simulating it runs away, and it has no gain at rest and no final value; where the system itself is stable, change the order or the channels, or fit the simulated output (oe, tf, ss --simulation)".into()
        }
        Doubt::LargerThanNoise { ratio } => format!(
            "what the model leaves is {ratio:.3} times what the measured noise explains, and the intervals rest on that noise: true errors are larger; try another structure"
        ),
        Doubt::CovarianceIsLowerBound => {
            "the intervals are the narrowest that any method could reach; the true ones are wider".into()
        }
        Doubt::ExplainsLittle { output, simulated } => {
            let name = outputs.get(*output).map_or("an output", |label| label.name.as_str());
            let how = if *simulated { "simulated" } else { "even one step ahead" };
            format!(
                "the model explains next to nothing of {name}, {how} (a fit below 5 % on its own data); check the channels, the delay, the orders and the detrending before using it"
            )
        }
        Doubt::DependentInputs { input } => format!(
            "input {} is a linear combination of the inputs before it, so the data cannot tell their effects apart; leave it out",
            input + 1
        ),
        Doubt::DependentOutputs { output } => {
            let name = outputs.get(*output).map_or("an output", |label| label.name.as_str());
            format!(
                "the errors of {name} follow from those of the outputs before it: its values add nothing, and no criterion is defined; leave it out"
            )
        }
        Doubt::NothingLeft { output } => {
            let name = outputs.get(*output).map_or("an output", |label| label.name.as_str());
            format!(
                "the model leaves nothing of {name}, or nothing that can be squared, so intervals and criteria mean nothing; check the channel, and the scale of its values"
            )
        }
        Doubt::RootAtEdge { output, polynomial, input, magnitude, angle, cancelled_by } => {
            let name = outputs.get(*output).map_or("an output", |label| label.name.as_str());
            root_at_edge(name, (*polynomial, *input), (*magnitude, *angle), *cancelled_by)
        }
        other => format!("{other:?}"),
    }
}

/// The pole with which a model runs away, and how fast.
pub(super) fn growing_pole(mode: &Mode) -> String {
    let pole = match mode.pole.im {
        0.0 => digits(mode.pole.re, 4),
        im => format!("{} ± {}i", digits(mode.pole.re, 4), digits(im.abs(), 4)),
    };
    format!("pole at {pole}, which grows e-fold in {} s", digits(-mode.time_constant_s(), 3))
}

/// Of a root at which a search had to stop.
fn root_at_edge(
    output: &str,
    (polynomial, input): (char, Option<usize>),
    (magnitude, angle): (f64, f64),
    cancelled_by: Option<char>,
) -> String {
    let whose = input.map_or(String::new(), |input| format!(" of input {}", input + 1));
    let order = |letter: char| format!("n{}", letter.to_ascii_lowercase());
    let (reason, remedy) = match cancelled_by {
        Some(other) => (
            format!(", and one of {other} nearly cancels it: both are longer than the data ask for"),
            format!("lower {} and {}", order(polynomial), order(other)),
        ),
        None if polynomial == 'C' => (
            ": the noise has next to nothing at that frequency, as after a difference or a trend taken off".to_owned(),
            "lower nc, or leave the data as they are".to_owned(),
        ),
        None => {
            (": the response hardly decays".to_owned(), format!("lower {}, or record for longer", order(polynomial)))
        }
    };
    let side = if magnitude > 1.0 { "just outside" } else { "just inside" };
    format!(
        "the search for {output} stopped with a root of {polynomial}{whose} {side} the unit circle (magnitude {magnitude:.4}, {angle:.3} rad a sample){reason}; the model can be used, but its intervals hold only roughly; {remedy}"
    )
}

/// How a search ended.
pub(super) fn termination(termination: Termination) -> &'static str {
    match termination {
        Termination::Direct => "solved at once",
        Termination::SmallStep => "converged: the steps became negligible",
        Termination::SmallDecrease => "converged: the errors no longer fall",
        Termination::NoDescent => "as good as the arithmetic allows",
        Termination::Edge => {
            "stopped where there is no model any more, as at the edge of stability: the errors would fall further beyond it"
        }
        Termination::IterationLimit => "stopped at the limit of iterations",
    }
}

/// Prints what the residual tests found, at a level.
pub(super) fn print_tests(
    report: &ResidualReport,
    (inputs, outputs): (&[Label], &[Label]),
    level: f64,
    terminal: &mut Terminal,
) {
    let verdict = |test: &JointTest| if test.passes(level) { ("passed:", Tone::Good) } else { ("failed:", Tone::Bad) };
    let mut say = |test: &JointTest, good: String, bad: String| {
        let text = format!("{} ({})", if test.passes(level) { good } else { bad }, probability(test.p_value));
        terminal.item(verdict(test), &text);
    };
    for (output, whiteness) in report.whiteness.iter().enumerate() {
        let name = &outputs[output].name;
        let (good, bad) = (format!("residuals of {name} are white"), format!("residuals of {name} are not white"));
        say(&whiteness.joint, good, bad);
        for (input, test) in report.independence[output].iter().enumerate() {
            let input = &inputs[input].name;
            let missing = match test.past.passes(level) {
                true => format!(
                    "residuals of {name} go with {input} of the same sample only: {input} acts at once, or follows {name} \
                     within the sample, as a controller's output does"
                ),
                false => format!("residuals of {name} depend on past {input}: dynamics are missing"),
            };
            say(
                &test.dynamics,
                format!("residuals of {name} do not depend on past {input}: the dynamics are captured"),
                missing,
            );
            // An input that remembers its past carries missing dynamics to its future too.
            let seen = match test.dynamics.passes(level) {
                true => "there is feedback",
                false => "feedback, or the missing dynamics again, as with an input that is not white",
            };
            say(
                &test.feedback,
                format!("residuals of {name} do not show in future {input}: no feedback"),
                format!("residuals of {name} show in future {input}: {seen}"),
            );
        }
    }
}

/// The residual tests in numbers.
pub(super) fn tests_json(report: &ResidualReport, level: f64) -> serde_json::Value {
    let joint = |test: &JointTest| serde_json::json!({"p_value": test.p_value, "passed": test.passes(level)});
    let of = |i: &Independence| serde_json::json!({"dynamics": joint(&i.dynamics), "past": joint(&i.past), "feedback": joint(&i.feedback), "cross": i.cross, "bounds": i.bounds});
    let independence: Vec<Vec<_>> = report.independence.iter().map(|row| row.iter().map(of).collect()).collect();
    let whiteness: Vec<_> = report
        .whiteness
        .iter()
        .map(|w| serde_json::json!({"joint": joint(&w.joint), "auto": w.auto, "bounds": w.bounds}))
        .collect();
    serde_json::json!({"level": level, "whiteness": whiteness, "independence": independence})
}

/// So many of something, in the plural where it is not one.
pub(in crate::commands) fn counted(count: usize, what: &str) -> String {
    if count == 1 { format!("1 {what}") } else { format!("{count} {what}s") }
}

/// Six significant digits of each coefficient of a polynomial; what is rounding beside the largest is none.
pub(super) fn coefficients(all: &[f64]) -> String {
    const ROUNDING: f64 = 1e-15;
    let largest = all.iter().fold(0.0, |largest: f64, v| largest.max(v.abs()));
    let text = |v: &f64| if v.abs() < ROUNDING * largest { "0".to_owned() } else { significant(*v) };
    all.iter().map(text).collect::<Vec<_>>().join(", ")
}

/// A fit in percent; a dash where nothing was measured, or nothing that varies.
pub(super) fn percent(value: f64) -> String {
    match value {
        _ if !value.is_finite() => "–".to_owned(),
        _ if value.abs() < 1e6 => format!("{value:.2} %"),
        _ => format!("{value:.1e} %"),
    }
}

/// Six significant digits.
pub(in crate::commands) fn significant(value: f64) -> String {
    digits(value, 6)
}

/// So many significant digits.
pub(super) fn digits(value: f64, count: i32) -> String {
    match value.abs() {
        _ if !value.is_finite() => format!("{value}"),
        0.0 => "0".to_owned(),
        size if (1e-4..1e6).contains(&size) => {
            let decimals = (count - 1 - size.log10().floor() as i32).max(0) as usize;
            let text = format!("{value:.decimals$}");
            if decimals > 0 { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
        }
        _ => format!("{value:.*e}", count as usize - 1),
    }
}

/// An interval; one-sided where an end is nowhere, and nothing where there is none.
pub(super) fn range(interval: Option<(f64, f64)>) -> String {
    match interval {
        None => String::new(),
        Some((low, high)) if low.is_infinite() && high.is_infinite() => "anything".to_owned(),
        Some((low, high)) if high.is_infinite() => format!("above {}", digits(low, 4)),
        Some((low, high)) if low.is_infinite() => format!("below {}", digits(high, 4)),
        Some((low, high)) => {
            let decimals = decimals(low, high);
            format!("{} … {}", to_decimals(low, decimals, 4), to_decimals(high, decimals, 4))
        }
    }
}

/// Decimals after which an interval has two digits of its width; none where numbers are too small or too large for that.
fn decimals(low: f64, high: f64) -> Option<usize> {
    // Of an interval without width, as of data without noise, −∞.
    let decimals = 1_i32.saturating_sub((high - low).abs().log10().floor() as i32);
    let largest = low.abs().max(high.abs());
    ((0..=6).contains(&decimals) && (1e-3..1e6).contains(&largest)).then_some(decimals as usize)
}

fn to_decimals(value: f64, decimals: Option<usize>, otherwise: i32) -> String {
    decimals.map_or_else(|| digits(value, otherwise), |decimals| format!("{value:.decimals$}"))
}

/// A value with its unit and, in brackets, its interval.
pub(super) fn with_range(value: f64, unit: &str, interval: Option<(f64, f64)>) -> String {
    let space = if unit.is_empty() { "" } else { " " };
    let decimals = interval.and_then(|(low, high)| decimals(low, high)).map(|decimals| decimals + 1);
    let range = interval.map(|_| format!(" ({})", range(interval)));
    format!("{}{space}{unit}{}", to_decimals(value, decimals, 5), range.unwrap_or_default())
}

/// The unit of an output over an input.
pub(super) fn ratio_unit(output: &str, input: &str) -> String {
    let factor = |unit: &str| if unit.contains(['/', ' ', '*', '·']) { format!("({unit})") } else { unit.to_owned() };
    match (output, input) {
        (output, input) if output == input => String::new(),
        (output, "") => output.to_owned(),
        ("", input) => format!("1/{}", factor(input)),
        (output, input) => format!("{output}/{}", factor(input)),
    }
}

/// A probability; the smallest ones only as such.
pub(super) fn probability(p: f64) -> String {
    if p < 0.001 { "p < 0.001".to_owned() } else { format!("p = {p:.3}") }
}
