//! Statements about estimates, in words.

use ident::{Doubt, Label, Termination};
use lti::{Complex64, Mode};
use page::decimal::{digits, fixed, scientific, significant};

/// A reason to doubt, with what can be done.
pub(crate) fn doubt(doubt: &Doubt, parameters: &[String], outputs: &[Label]) -> String {
    match doubt {
        Doubt::NotConverged => {
            "the search stopped before it had converged; the numbers are provisional: try a lower order, or other data"
                .into()
        }
        Doubt::IllConditioned { condition } => format!(
            "the data barely separate the parameters (condition number {}); lower the order or excite the system better",
            scientific(*condition, 1)
        ),
        Doubt::RowsLeftOut { rows, of } => format!(
            "{rows} of {of} rows were left out, because a sample is missing there or the model needs more of the past; samples between those of a slower output count as missing, and band-limited inputs also need the time around a record"
        ),
        Doubt::HeldBefore => {
            "the inputs count as constant before the record, at their first value; start the record earlier if they moved shortly before"
                .into()
        }
        Doubt::HeldBeforeRefuted => {
            "the estimate assumes that the inputs were constant before the record, and the outputs refute that; the rows that need no such assumption are too few; start the record earlier, or search a shorter delay"
                .into()
        }
        Doubt::NotTheLeast { output } => format!(
            "other parameters leave smaller errors of {}, but the data do not determine all of them there; the intervals are too narrow; lower the order, or fix a parameter",
            outputs.get(*output).map_or("an output", |label| label.name.as_str())
        ),
        Doubt::AtBound { parameter } => format!(
            "{} is at its bound, so it has no interval; the intervals of the others hold with it there; widen the bound, or fix the parameter",
            parameters.get(*parameter).map_or("a parameter", String::as_str)
        ),
        Doubt::Unstable => {
            "the model is not stable: its simulation diverges whatever it is worth, so judge it by its prediction; it has no static gain and no final value; if the system itself is stable, change the order or the channels, or fit the simulated output (oe, tf, ss --simulation)".into()
        }
        Doubt::LargerThanNoise { ratio } => format!(
            "the residual is {} times what the measured noise explains, but the intervals follow from that noise; true errors are larger; try another structure",
            fixed(*ratio, 3)
        ),
        Doubt::CovarianceIsLowerBound => {
            "the intervals are the narrowest that any method could reach; the true ones are wider".into()
        }
        Doubt::ExplainsLittle { output, simulated } => explains_little(*output, *simulated, outputs, "its own"),
        Doubt::DependentInputs { input } => format!(
            "input {} is a linear combination of the inputs before it, so the data cannot separate their effects; leave it out",
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
                "the residual of {name} is zero, or too small to be squared, so intervals and criteria mean nothing; check the channel, and the scale of its values"
            )
        }
        Doubt::Feedback { output, input } => {
            let name = outputs.get(*output).map_or("an output", |label| label.name.as_str());
            format!(
                "input {} follows what the model leaves of {name}, as under feedback, and this method is biased then; use a method that holds under feedback (ss --weighting ssarx, or a model with noise: armax, bj)",
                input + 1
            )
        }
        Doubt::WithinSample { output, input } => {
            let name = outputs.get(*output).map_or("an output", |label| label.name.as_str());
            format!(
                "input {} moves with what the model leaves of {name} in the same sample; either it acts at once (allow it with --nk 0 or --feedthrough), or it follows {name} as a controller's output does; under feedback this method is biased, even in sign, so use a model with noise (armax, bj)",
                input + 1
            )
        }
        Doubt::FewLines { input, lines, needed, strongest_hz } => format!(
            "input {} has only {}, the strongest at {} Hz; each gives a gain and a phase, and this structure needs {needed} lines; a delay cannot be separated from a phase shift then; excite with steps or noise, or fix parameters",
            input + 1,
            counted(*lines, "line of frequency").replace("line of frequencys", "lines of frequency"),
            digits(*strongest_hz, 4)
        ),
        Doubt::FollowsInputs { output, share } => {
            let name = outputs.get(*output).map_or("an output", |label| label.name.as_str());
            format!(
                "{} % of what the model leaves of {name} still follows the inputs: the structure is too simple, or the search ended in a local minimum; the intervals do not contain this error; try another structure, or the part of the data in which the inputs vary",
                fixed(100.0 * share, 0)
            )
        }
        Doubt::RootAtEdge { output, polynomial, input, magnitude, angle, cancelled_by } => {
            let name = outputs.get(*output).map_or("an output", |label| label.name.as_str());
            root_at_edge(name, *polynomial, *input, *magnitude, *angle, *cancelled_by)
        }
        Doubt::UnseenMode { output, input, pole: (re, im), .. } => {
            let name = outputs.get(*output).map_or("an output", |label| label.name.as_str());
            let turns = if *im > 0.0 { format!(" ± {}i", digits(*im, 4)) } else { String::new() };
            format!(
                "the data do not show the pole {}{turns} of input {}: its part of {name} is below the noise; other poles may do as well, far beyond its intervals; lower the order, or excite more there",
                digits(*re, 4),
                input + 1
            )
        }
        Doubt::AboveNyquist { frequency_hz } => format!(
            "a mode of the estimate turns at {} Hz, faster than the samples can show; the search may have ended far from the truth, and its intervals mean nothing then; give nearer starting values or bounds, or more --starts",
            digits(*frequency_hz, 4)
        ),
        Doubt::UncertainNoiseModel { output } => {
            let name = outputs.get(*output).map_or("an output", |label| label.name.as_str());
            format!(
                "the samples are few for the coefficients of the noise model of {name}, or a root of it may be on the unit circle: its 95 % intervals hold 75 to 92 times in 100; those of the dynamics hold; record for longer, or lower nc and nd"
            )
        }
        other => format!("{other:?}"),
    }
}

/// The pole with which a model runs away, and how fast.
pub fn growing_pole(mode: &Mode) -> String {
    let pole = match mode.pole.im {
        0.0 => digits(mode.pole.re, 4),
        im => format!("{} ± {}i", digits(mode.pole.re, 4), digits(im.abs(), 4)),
    };
    format!("pole at {pole}, which grows e-fold in {} s", digits(-mode.time_constant_s(), 3))
}

/// Of a root at which a search had to stop.
fn root_at_edge(
    output: &str,
    polynomial: char,
    input: Option<usize>,
    magnitude: f64,
    angle: f64,
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
    let intervals = match (polynomial, cancelled_by) {
        ('C', Some('D')) => "C and D have no intervals, and those of the dynamics hold only roughly",
        ('C', _) => "C has no intervals, and those of the others hold only roughly",
        _ => "the model can be used, but its intervals hold only roughly",
    };
    let side = if magnitude > 1.0 { "just outside" } else { "just inside" };
    format!(
        "the search for {output} stopped with a root of {polynomial}{whose} {side} the unit circle (magnitude {}, {} rad a sample){reason}; {intervals}; {remedy}",
        fixed(magnitude, 4),
        fixed(angle, 3)
    )
}

/// How a search ended.
pub(crate) fn termination(termination: Termination) -> &'static str {
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

/// So many of something, in the plural where it is not one.
pub fn counted(count: usize, what: &str) -> String {
    if count == 1 { format!("1 {what}") } else { format!("{count} {what}s") }
}

/// The unit of an output over an input.
pub(crate) fn ratio_unit(output: &str, input: &str) -> String {
    let factor = |unit: &str| if unit.contains(['/', ' ', '*', '·']) { format!("({unit})") } else { unit.to_owned() };
    match (output, input) {
        (output, input) if output == input => String::new(),
        (output, "") => output.to_owned(),
        ("", input) => format!("1/{}", factor(input)),
        (output, input) => format!("{output}/{}", factor(input)),
    }
}

/// A root, with its conjugate where it has one.
pub fn pair(root: Complex64) -> String {
    match root.im.abs() {
        0.0 => significant(root.re),
        im => format!("{} ± {}i", significant(root.re), significant(im)),
    }
}

/// That a model explains next to nothing of an output of some data.
pub(crate) fn explains_little(output: usize, simulated: bool, outputs: &[Label], whose: &str) -> String {
    let name = outputs.get(output).map_or("an output", |label| label.name.as_str());
    let how = if simulated { "simulated" } else { "even one step ahead" };
    format!(
        "the model explains next to nothing of {name}, {how} (a fit below 5 % on {whose} data); check the channels, the delay, the orders and the detrending before using it"
    )
}
