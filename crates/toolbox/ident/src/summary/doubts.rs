//! Doubts in words.

use lti::text::number;

use crate::Doubt;

/// The doubts, one a line, below the other facts; nothing without any.
pub(super) fn list(doubts: &[Doubt], parameters: &[String]) -> String {
    doubts.iter().map(|doubt| format!("\n  Doubt: {}", sentence(doubt, parameters))).collect()
}

fn sentence(doubt: &Doubt, parameters: &[String]) -> String {
    match doubt {
        Doubt::NotConverged => "the search stopped before it converged.".to_owned(),
        Doubt::IllConditioned { condition } => {
            format!("the data hardly separate the parameters (condition number {}).", number(*condition))
        }
        Doubt::RowsLeftOut { rows, of } => format!("{rows} of {of} rows could not be used."),
        Doubt::HeldBefore => "inputs count as constant before the record, at their first value.".to_owned(),
        Doubt::HeldBeforeRefuted => {
            "the outputs refute that inputs were constant before the record, and the other rows are too few.".to_owned()
        }
        Doubt::NotTheLeast { output } => format!(
            "other parameters give smaller errors of output {}, and cannot be estimated; the standard errors are too small.",
            output + 1
        ),
        Doubt::AtBound { parameter } => {
            let name = parameters.get(*parameter).map_or("a parameter", String::as_str);
            format!("{name} is at its bound and has no standard error; those of the others hold with it there.")
        }
        Doubt::Unstable => "the model is not stable.".to_owned(),
        Doubt::LargerThanNoise { ratio } => {
            format!("the errors are {} times what the measured noise explains.", number(*ratio))
        }
        Doubt::CovarianceIsLowerBound => "the standard errors are lower bounds.".to_owned(),
        Doubt::DependentInputs { input } => {
            format!("input {} is a linear combination of the inputs before it.", input + 1)
        }
        Doubt::DependentOutputs { output } => {
            format!("the errors of output {} follow from those of the outputs before it.", output + 1)
        }
        Doubt::NothingLeft { output } => {
            format!(
                "the model leaves no errors of output {}, so criteria and standard errors mean nothing.",
                output + 1
            )
        }
        Doubt::RootAtEdge { output, polynomial, magnitude, .. } => format!(
            "the search for output {} stopped with a root of {polynomial} at the unit circle (magnitude {}).",
            output + 1,
            number(*magnitude)
        ),
        Doubt::UnseenMode { output, input, pole: (re, im), .. } => {
            let turns = if *im > 0.0 { format!(" ± {}i", number(*im)) } else { String::new() };
            format!(
                "the data do not show the pole {}{turns} of input {} in output {}: other poles may do as well.",
                number(*re),
                input + 1,
                output + 1
            )
        }
        Doubt::AboveNyquist { frequency_hz } => format!(
            "a mode turns at {} Hz, faster than the samples can show; a slower one may be the true one.",
            number(*frequency_hz)
        ),
        Doubt::UncertainNoiseModel { output } => {
            format!("the samples are few for the noise model of output {}, and its intervals too narrow.", output + 1)
        }
        Doubt::ExplainsLittle { output, simulated } => {
            let how = if *simulated { "simulates" } else { "predicts" };
            format!("the model {how} next to nothing of output {}.", output + 1)
        }
        Doubt::WithinSample { output, input } => format!(
            "input {} and the errors of output {} move together within a sample: it acts at once, or follows the output.",
            input + 1,
            output + 1
        ),
        Doubt::FewLines { input, lines, needed, .. } => {
            format!("input {} has {lines} lines of frequency, and the structure needs {needed}.", input + 1)
        }
        Doubt::Feedback { output, input } => format!(
            "input {} follows the residual of output {}, as under feedback, so the estimate is biased.",
            input + 1,
            output + 1
        ),
        Doubt::FollowsInputs { output, share } => format!(
            "{} % of what the model leaves of output {} still follows the inputs; true errors are larger than the standard errors.",
            number((100.0 * share).round()),
            output + 1
        ),
    }
}
