//! `dynoid model convert`: a model in another form.

mod clock;
mod form;
mod ratio;
mod system;

use ident::{IdentError, LinearModel, ModelDocument};
use lti::{Complex64, LtiError};

use super::data::{check_plot, check_targets};
use super::judge::{picture, written};
use super::words::significant;
use super::{model_file, show};
use crate::cli::identify::{ModelConvertArguments, Representation, Sampling};
use crate::error::{CliError, Outcome};
use crate::output::replace_file;
use crate::terminal::Terminal;
use form::Converted;
use ratio::{pair, ratios};
use system::system;

fn failed(source: impl Into<IdentError>) -> CliError {
    let source = source.into();
    match &source {
        IdentError::Lti(LtiError::FractionalDelay { delay_s, sample_time_s }) => CliError::Usage {
            what: format!(
                "the delay of {} s is no whole number of samples of {sample_time_s} s, which this --method needs; --method zoh is exact for any delay (with --to ss foh is too), or choose a --sample-time that divides it",
                significant(*delay_s)
            ),
        },
        IdentError::Lti(LtiError::NoLogarithm { re, im }) => CliError::Usage {
            what: format!(
                "the model has a pole (or with --method matched a zero) at {}, which no continuous model of the same order has under this --method: one at 0 is that of numerator coefficients beyond the order of the denominator, a negative one turns at half the sample rate; --method tustin gives an approximation, a fit of another order or of a continuous model (tf) avoids it",
                pair(Complex64::new(*re, *im))
            ),
        },
        _ => CliError::identify("the conversion", source),
    }
}

/// `dynoid model convert`
pub(crate) fn convert(arguments: &ModelConvertArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check(arguments)?;
    let source = from_noise(model_file::read(&arguments.model)?, arguments)?;
    let converted = match arguments.to {
        Representation::Ss => Converted::System(Box::new(system(&source, arguments)?)),
        Representation::Tf | Representation::Zpk => Converted::Ratios(ratios(&source, arguments).map_err(failed)?),
    };
    let document = match arguments.to {
        // No kind of model is written down by its zeros and poles.
        Representation::Zpk => None,
        _ if arguments.result.json || arguments.out.is_some() => Some(converted.document(&source)?),
        _ => None,
    };
    if arguments.result.plot.is_some() {
        let both = [("as it was", source.clone()), ("converted", converted.document(&source)?)];
        let figures = show::bode_figures(both.map(|(name, document)| (name.to_owned(), document)))?;
        picture(&arguments.result, &model_file::name(&arguments.model), || figures)?;
    }
    if let Some(document) = &document
        && let Some(lost) = lost(&source, document).map_err(failed)?
    {
        terminal.note(lost);
    }
    if let (Some(path), Some(document)) = (&arguments.out, &document) {
        let text = serde_json::to_string_pretty(document).map_err(CliError::internal)?;
        replace_file(path, text.as_bytes())?;
    }
    match document {
        Some(document) if arguments.result.json => terminal.json(&document)?,
        _ if arguments.result.json => terminal.json(&converted.zeros_and_poles(&source)?)?,
        _ if terminal.is_quiet() => {}
        _ => {
            converted.print(&source, arguments.to, terminal)?;
            [&arguments.out, &arguments.result.plot].into_iter().for_each(|path| written(path, terminal));
        }
    }
    Ok(Outcome::Done)
}

/// What of a model its new form does not hold.
fn lost(source: &ModelDocument, converted: &ModelDocument) -> Result<Option<&'static str>, IdentError> {
    let models_noise = |document: &ModelDocument| -> Result<bool, IdentError> {
        let form = document.model.innovations(document.sample_time_s, document.intersample)?;
        Ok(form.k().norm_max() > 0.0)
    };
    let loses_noise = models_noise(source)? && !models_noise(converted)?;
    Ok(match (loses_noise, source.estimate.is_some()) {
        (true, true) => Some(
            "the noise model and the covariance of the estimate are left out: the noise model is kept by --to ss on the model's own clock alone, a covariance by no other form",
        ),
        (true, false) => Some("the noise model is left out: it is kept by --to ss on the model's own clock alone"),
        (false, true) => {
            Some("the covariance of the estimate is left out: it belongs to the parameters of the old form")
        }
        (false, false) => None,
    })
}

fn check(arguments: &ModelConvertArguments) -> Result<(), CliError> {
    check_plot(&arguments.result, &[std::slice::from_ref(&arguments.model)])?;
    if arguments.prewarp_hz.is_some() && arguments.method != Sampling::Tustin {
        return Err(CliError::Usage { what: "--prewarp belongs to --method tustin; give both".into() });
    }
    let Some(path) = &arguments.out else { return Ok(()) };
    if arguments.to == Representation::Zpk {
        let what = "--out writes a model file, which has no form of zeros and poles; give --to tf or --to ss".into();
        return Err(CliError::Usage { what });
    }
    model_file::check_ending(path)?;
    check_targets(&[&arguments.out], &[std::slice::from_ref(&arguments.model)])
}

/// A time series has no way but the one from its noise, which a state space on its own clock holds anyway.
fn from_noise(source: ModelDocument, arguments: &ModelConvertArguments) -> Result<ModelDocument, CliError> {
    let keeps_clock = arguments.sample_time.is_none() && !arguments.continuous;
    if !source.inputs.is_empty() || (arguments.to == Representation::Ss && keeps_clock) {
        return Ok(source);
    }
    let white = || CliError::Usage { what: "the model is white noise alone: there is nothing to convert".into() };
    source.of_noise().map_err(failed)?.ok_or_else(white)
}
