//! `dynoid model convert`: a model in another form.

use std::f64::consts::TAU;

use dynoid::linear::ConvertedModel;
use dynoid::{Files, replace_file};
use lti::Discretisation;
use page::Block;
use toolbox_report::convert::{Conversion, Form};

use crate::cli::identify::{ModelConvertArguments, Representation, Sampling};
use crate::commands::result::{Sorted, check_plot, show_with};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// `dynoid model convert`
pub(crate) fn convert(arguments: &ModelConvertArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check(arguments, &terminal.files())?;
    let result = &arguments.result;
    let found = ConvertedModel::of(terminal.files().linear_model(&arguments.model)?, &asked(arguments))?;
    // No kind of model is written down by its zeros and poles.
    let is_model = arguments.to != Representation::Zpk && (result.json || arguments.out.is_some());
    let document = is_model.then(|| found.document()).transpose()?;
    let mut page = found.page(&dynoid::model_name(&arguments.model))?;
    if result.plot.is_some() {
        page.blocks.extend(found.figures()?.into_iter().map(Block::figure));
    }
    if let Some(document) = &document
        && let Some(lost) = found.lost(document)?
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
            let zeros_and_poles = result.json.then(|| found.zeros_and_poles()).transpose()?;
            show_with(result, &out, || page, || Sorted(zeros_and_poles), terminal)?;
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
