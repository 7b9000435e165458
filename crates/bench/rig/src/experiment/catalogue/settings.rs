//! The numbers an experiment is given.

use recording::names::likely_meant;
use serde::Serialize;

use super::CatalogueError;
use crate::experiment::catalogue::parameter::Parameter;

/// A value for every parameter of an experiment, in the parameters' units.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Settings {
    values: Vec<(&'static str, f64)>,
    /// The parameters that were given a value.
    given: Vec<&'static str>,
}

impl Settings {
    /// The values of texts such as `("low", "35")` or `("low", "35 Nm")`; what is not given has its default.
    ///
    /// # Errors
    /// A name that is no parameter's, a value that is no number in its unit or outside its range, a name given twice.
    pub fn parse(parameters: &[Parameter], given: &[(&str, &str)]) -> Result<Self, CatalogueError> {
        let mut settings =
            Settings { values: parameters.iter().map(|p| (p.name, p.default)).collect(), given: Vec::new() };
        for (name, text) in given {
            let (name, text) = (name.trim(), text.trim());
            let Some(place) = parameters.iter().position(|p| p.name.eq_ignore_ascii_case(name)) else {
                return Err(unknown(parameters, name));
            };
            let parameter = &parameters[place];
            if settings.is_given(parameter.name) {
                return Err(CatalogueError::GivenTwice { name: parameter.name.to_owned() });
            }
            settings.given.push(parameter.name);
            settings.values[place].1 = value(parameter, text)?;
        }
        Ok(settings)
    }

    /// The value of a parameter; NaN for a name that is none, which every check of a plan refuses.
    pub fn get(&self, name: &str) -> f64 {
        self.values.iter().find(|(known, _)| *known == name).map_or(f64::NAN, |(_, value)| *value)
    }

    /// Tells whether a parameter was given a value.
    pub fn is_given(&self, name: &str) -> bool {
        self.given.contains(&name)
    }

    /// Names and values, in the parameters' order.
    pub fn values(&self) -> &[(&'static str, f64)] {
        &self.values
    }
}

fn unknown(parameters: &[Parameter], name: &str) -> CatalogueError {
    let known: Vec<String> = parameters.iter().map(|p| p.name.to_owned()).collect();
    let closest = likely_meant(name, known.iter().map(String::as_str));
    CatalogueError::UnknownParameter { name: name.to_owned(), closest, known }
}

fn value(parameter: &Parameter, text: &str) -> Result<f64, CatalogueError> {
    let number = text.strip_suffix(parameter.unit).unwrap_or(text).trim_end();
    let Some(value) = number.parse::<f64>().ok().filter(|value| value.is_finite()) else {
        return Err(CatalogueError::NotANumber {
            name: parameter.name,
            text: text.to_owned(),
            unit: parameter.unit,
            example: parameter.default,
        });
    };
    if (parameter.lowest..=parameter.highest).contains(&value) {
        return Ok(value);
    }
    Err(CatalogueError::OutOfRange {
        name: parameter.name,
        value,
        unit: parameter.unit,
        lowest: parameter.lowest,
        highest: parameter.highest,
        meaning: parameter.meaning,
    })
}
