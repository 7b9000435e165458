//! `dynoid model convert`: a model in another form.

use std::f64::consts::TAU;

use dynoid::{Files, replace_file};
use ident::IdentError;
use lti::{Complex64, Discretisation, LtiError};
use page::Block;
use page::decimal::significant;
use toolbox_report::convert::{Conversion, ConvertError, Form, convert as converted};
use toolbox_report::words::pair;

use crate::cli::identify::{ModelConvertArguments, Representation, Sampling};
use crate::commands::result::{check_plot, show_with};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

fn failed(error: ConvertError) -> CliError {
    let source = match error {
        ConvertError::Model(source) => source,
        ConvertError::DelaysDiffer => {
            return CliError::Usage {
                what: format!(
                    "{error}, which a state space with delayed inputs cannot hold; give --to tf, or --sample-time"
                ),
            };
        }
        ConvertError::WhiteNoise => return CliError::Usage { what: format!("{error}: there is nothing to convert") },
    };
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
    check(arguments, &terminal.files())?;
    let result = &arguments.result;
    let found = converted(terminal.files().linear_model(&arguments.model)?, &asked(arguments)).map_err(failed)?;
    // No kind of model is written down by its zeros and poles.
    let is_model = arguments.to != Representation::Zpk && (result.json || arguments.out.is_some());
    let document = is_model.then(|| found.document()).transpose().map_err(failed)?;
    let mut page = found.page(&dynoid::model_name(&arguments.model)).map_err(failed)?;
    if result.plot.is_some() {
        page.blocks.extend(found.figures().map_err(failed)?.into_iter().map(Block::figure));
    }
    if let Some(document) = &document
        && let Some(lost) = found.lost(document).map_err(|error| failed(error.into()))?
    {
        terminal.note(lost);
    }
    if let (Some(path), Some(document)) = (&arguments.out, &document) {
        let text = serde_json::to_string_pretty(document).map_err(CliError::internal)?;
        replace_file(path, text.as_bytes(), &terminal.files())?;
    }
    let out = [&arguments.out];
    match document {
        Some(document) => show_with(result, &out, || page, || document, terminal)?,
        None => {
            let zeros_and_poles = result.json.then(|| found.zeros_and_poles()).transpose().map_err(failed)?;
            show_with(result, &out, || page, || zeros_and_poles, terminal)?;
        }
    }
    Ok(Outcome::Done)
}

fn asked(arguments: &ModelConvertArguments) -> Conversion {
    Conversion {
        form: match arguments.to {
            Representation::Tf => Form::Ratio,
            Representation::Zpk => Form::ZerosAndPoles,
            Representation::Ss => Form::StateSpace,
        },
        sample_time_s: arguments.sample_time,
        continuous: arguments.continuous,
        rule: match arguments.method {
            Sampling::Zoh => Discretisation::ZeroOrderHold,
            Sampling::Foh => Discretisation::FirstOrderHold,
            Sampling::Tustin => Discretisation::Tustin { prewarp_rad_s: arguments.prewarp_hz.map(|hz| TAU * hz) },
            Sampling::Impulse => Discretisation::ImpulseInvariant,
            Sampling::Matched => Discretisation::Matched,
        },
    }
}

fn check(arguments: &ModelConvertArguments, files: &Files) -> Result<(), CliError> {
    check_plot(&arguments.result, files)?;
    if arguments.prewarp_hz.is_some() && arguments.method != Sampling::Tustin {
        return Err(CliError::Usage { what: "--prewarp belongs to --method tustin; give both".into() });
    }
    let Some(path) = &arguments.out else { return Ok(()) };
    if arguments.to == Representation::Zpk {
        let what = "--out writes a model file, which has no form of zeros and poles; give --to tf or --to ss".into();
        return Err(CliError::Usage { what });
    }
    Ok(dynoid::check_model_file(path, files)?)
}
