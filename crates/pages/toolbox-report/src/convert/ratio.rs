//! Ratios of polynomials, a way from an input to an output each.

use ident::uncertainty::Dynamics;
use ident::{AnyModel, ModelDocument, RationalChannel, TransferFunctionModel};
use lti::{LtiError, PolynomialEquation, PolynomialModel, TransferFunction};
use page::decimal::{coefficients, significant};
use page::{Align, Block, Table};

use super::clock::{Conversion, Form, clock_words, noise_covariance, resampled_ratio};
use crate::blocks::heading;
use crate::words::pair;

/// Every way from an input to an output on the clock that is asked for.
pub(super) fn ratios(source: &ModelDocument, asked: &Conversion) -> Result<Vec<TransferFunction>, LtiError> {
    let inputs = source.inputs.len();
    let way = |n: usize| resampled_ratio(ratio(&source.model, n / inputs, n % inputs)?, asked);
    (0..source.outputs.len() * inputs).map(way).collect()
}

/// The way from an input to an output as a ratio with its delay.
fn ratio(model: &AnyModel, output: usize, input: usize) -> Result<TransferFunction, LtiError> {
    match (model, model.polynomials(output, input)?) {
        (AnyModel::Polynomial(m), _) => polynomial_ratio(m, output, input),
        (_, Some(ratio)) => {
            TransferFunction::continuous(ratio.numerator, ratio.denominator)?.with_delay(model.delay_s(output, input)?)
        }
        (_, None) => {
            let h = model.system()?.channel(output, input)?.to_transfer_function()?;
            h.with_delay(model.delay_s(output, input)?)
        }
    }
}

/// The ratio of a polynomial model. All but one sample of the delay are kept apart from it, so that it has no poles at
/// zero that are but a delay; the one left is that of the hold.
fn polynomial_ratio(model: &PolynomialModel, output: usize, input: usize) -> Result<TransferFunction, LtiError> {
    let mut equations = model.equations().to_vec();
    let samples = equations.get(output).and_then(|e| e.nk.get(input)).map_or(0, |nk| nk.saturating_sub(1));
    for nk in equations.iter_mut().filter_map(|e| e.nk.get_mut(input)) {
        *nk = nk.saturating_sub(samples);
    }
    let sooner = PolynomialModel::new(model.sample_time_s(), equations, model.noise_covariance().to_owned())?;
    match sooner.transfer_function(output, input) {
        Err(LtiError::OutputsCoupled { .. }) => {
            model.innovations()?.system().channel(output, input)?.to_transfer_function()
        }
        other => other?.with_delay(samples as f64 * model.sample_time_s()),
    }
}

/// Ratios as a model.
pub(super) fn ratio_model(all: &[TransferFunction], source: &ModelDocument) -> Result<AnyModel, LtiError> {
    if let Some(sample_time_s) = all.first().and_then(TransferFunction::sample_time_s) {
        return Ok(discrete_model(all, source, sample_time_s)?.into());
    }
    let channel = |h: &TransferFunction| {
        let lead = h.den()[0];
        let scaled = |p: &[f64]| p.iter().map(|v| v / lead).collect::<Vec<f64>>();
        RationalChannel::new(scaled(h.num()), scaled(&h.den()[1..]), h.delay_s())
    };
    let channels = all.iter().map(channel).collect::<Result<_, _>>()?;
    Ok(TransferFunctionModel::new(channels, source.inputs.len(), noise_covariance(source)?)?.into())
}

/// Discrete ratios as an output-error model: `B/F` with the delay in samples, the difference of the degrees and the
/// delay beside the ratio.
pub(super) fn discrete_model(
    all: &[TransferFunction],
    source: &ModelDocument,
    sample_time_s: f64,
) -> Result<PolynomialModel, LtiError> {
    let (inputs, outputs) = (source.inputs.len(), source.outputs.len());
    let mut equations = vec![PolynomialEquation { a: vec![Vec::new(); outputs], ..Default::default() }; outputs];
    for (n, h) in all.iter().enumerate() {
        let (num, den) = (h.num(), h.den());
        if num.len() > den.len() {
            return Err(LtiError::Improper { numerator: num.len() - 1, denominator: den.len() - 1 });
        }
        let equation = &mut equations[n / inputs];
        equation.b.push(num.iter().map(|v| v / den[0]).collect());
        equation.f.push(den[1..].iter().map(|v| v / den[0]).collect());
        equation.nk.push(den.len() - num.len() + (h.delay_s() / sample_time_s).round() as usize);
    }
    PolynomialModel::new(sample_time_s, equations, noise_covariance(source)?)
}

/// A ratio in the form that is asked for.
pub(super) fn blocks(name: &str, h: &TransferFunction, form: Form) -> Result<[Block; 2], LtiError> {
    let delay = if h.delay_s() > 0.0 { format!(", delay {} s", significant(h.delay_s())) } else { String::new() };
    let powers = match (form, h.sample_time_s()) {
        (Form::ZerosAndPoles, Some(_)) => "in z",
        (Form::ZerosAndPoles, None) => "in s, rad/s",
        (_, Some(_)) => "in falling powers of z",
        (_, None) => "in falling powers of s",
    };
    let title = heading(format!("{name}, {}{delay}, {powers}", clock_words(h.sample_time_s())));
    let rows = if form == Form::ZerosAndPoles { zeros_and_poles(h)? } else { polynomials(h) };
    let rows = rows.into_iter().map(|(what, numbers)| vec![what.into(), numbers.into()]);
    Ok([title, Block::Table(Table::new(&[("", Align::Left), ("", Align::Left)]).with_rows(rows))])
}

fn zeros_and_poles(h: &TransferFunction) -> Result<Vec<(&'static str, String)>, LtiError> {
    let zpk = h.to_zero_pole_gain()?;
    let roots = [("zeros", zpk.zeros()), ("poles", zpk.poles())].map(|(name, roots)| {
        let all: Vec<String> = roots.iter().filter(|root| root.im >= 0.0).map(|root| pair(*root)).collect();
        (name, if all.is_empty() { "none".to_owned() } else { all.join(", ") })
    });
    Ok(std::iter::once(("gain", significant(zpk.gain()))).chain(roots).collect())
}

/// The leading coefficient of the denominator is one.
fn polynomials(h: &TransferFunction) -> Vec<(&'static str, String)> {
    let list = |p: &[f64]| coefficients(&p.iter().map(|v| v / h.den()[0]).collect::<Vec<_>>());
    vec![("numerator", list(h.num())), ("denominator", list(h.den()))]
}
