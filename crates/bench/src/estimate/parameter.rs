//! Making [`Parameter`]s and [`Estimate`]s from numbers.

use ident::distributions::interval;

use crate::study::Parameter;

/// Level of every parameter's interval.
const INTERVAL_LEVEL: f64 = 0.95;

/// What a parameter is called and measured in.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Label {
    pub(crate) symbol: &'static str,
    pub(crate) name: &'static str,
    pub(crate) unit: &'static str,
}

impl Parameter {
    /// A parameter with its 95 % Student-t interval.
    pub(crate) fn new(label: Label, value: f64, standard_error: f64, degrees_of_freedom: f64) -> Self {
        Parameter {
            symbol: label.symbol.to_owned(),
            name: label.name.to_owned(),
            unit: label.unit.to_owned(),
            value,
            standard_error,
            degrees_of_freedom,
            interval: interval(value, standard_error, degrees_of_freedom, INTERVAL_LEVEL),
        }
    }
}
