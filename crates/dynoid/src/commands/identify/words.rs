//! What estimates have to say, in words.

use ident::validate::{Independence, JointTest, ResidualReport};
use ident::{Doubt, Label, Termination};

use crate::table::Style;
use crate::terminal::Terminal;

/// A reason to doubt, with what can be done.
pub(super) fn doubt(doubt: &Doubt, parameters: &[String]) -> String {
    match doubt {
        Doubt::NotConverged => {
            "the search stopped before it had converged; the numbers are provisional: try a lower order, or other data"
                .into()
        }
        Doubt::IllConditioned { condition } => format!(
            "the data barely tell the parameters apart (condition number {condition:.1e}); lower the order or excite the system better"
        ),
        Doubt::RowsLeftOut { rows, of } => format!(
            "{rows} of {of} rows were left out: samples are missing there, or the past that the model needs was not recorded"
        ),
        Doubt::AtBound { parameter } => format!(
            "{} rests on its bound, so its interval means nothing; widen the bound or leave the parameter out",
            parameters.get(*parameter).map_or("a parameter", String::as_str)
        ),
        Doubt::Unstable => "the model is not stable: simulating it runs away".into(),
        Doubt::LargerThanNoise { ratio } => format!(
            "what the model leaves is {ratio:.3} times what the measured noise explains, and the intervals rest on that noise: true errors are larger; try another structure"
        ),
        Doubt::CovarianceIsLowerBound => {
            "the intervals are the narrowest that any method could reach; the true ones are wider".into()
        }
        other => format!("{other:?}"),
    }
}

/// How a search ended.
pub(super) fn termination(termination: Termination) -> &'static str {
    match termination {
        Termination::Direct => "solved at once",
        Termination::SmallStep => "converged: the steps became negligible",
        Termination::SmallDecrease => "converged: the errors no longer fall",
        Termination::NoDescent => "as good as the arithmetic allows",
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
    let verdict =
        |test: &JointTest| if test.passes(level) { ("passed:", Style::Good) } else { ("failed:", Style::Bad) };
    for (output, whiteness) in report.whiteness.iter().enumerate() {
        let name = &outputs[output].name;
        let text = format!("residuals of {name} are white (p {:.3})", whiteness.joint.p_value);
        terminal.item(verdict(&whiteness.joint), &text);
        for (input, test) in report.independence[output].iter().enumerate() {
            let input = &inputs[input].name;
            let text =
                format!("they do not depend on past {input}: no dynamics is missing (p {:.3})", test.dynamics.p_value);
            terminal.item(verdict(&test.dynamics), &text);
            let text = format!("they do not show in future {input}: no feedback (p {:.3})", test.feedback.p_value);
            terminal.item(verdict(&test.feedback), &text);
        }
    }
}

/// The residual tests in numbers.
pub(super) fn tests_json(report: &ResidualReport, level: f64) -> serde_json::Value {
    let joint = |test: &JointTest| serde_json::json!({"p_value": test.p_value, "passed": test.passes(level)});
    let of = |i: &Independence| serde_json::json!({"dynamics": joint(&i.dynamics), "feedback": joint(&i.feedback), "cross": i.cross, "bound": i.bound});
    let independence: Vec<Vec<_>> = report.independence.iter().map(|row| row.iter().map(of).collect()).collect();
    let whiteness: Vec<_> = report
        .whiteness
        .iter()
        .map(|w| serde_json::json!({"joint": joint(&w.joint), "auto": w.auto, "bound": w.bound}))
        .collect();
    serde_json::json!({"level": level, "whiteness": whiteness, "independence": independence})
}

/// A fit in percent; a dash where nothing was measured.
pub(super) fn percent(value: f64) -> String {
    if value.is_finite() { format!("{value:.2} %") } else { "–".to_owned() }
}

/// Six significant digits.
pub(super) fn significant(value: f64) -> String {
    match value.abs() {
        _ if !value.is_finite() => format!("{value}"),
        0.0 => "0".to_owned(),
        size if (1e-4..1e6).contains(&size) => {
            let decimals = (5 - size.log10().floor() as i32).max(0) as usize;
            let text = format!("{value:.decimals$}");
            if decimals > 0 { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
        }
        _ => format!("{value:.5e}"),
    }
}
