//! Quantities that follow from the parameters of a grey box.

use ident::uncertainty::Derived;
use ident::{AnyModel, Fit, IdentError, Structure};
use page::Block;

use super::facts::DerivedFacts;
use super::table::{INTERVAL, Known, estimate, estimates};
use crate::blocks::line;

/// Which parameters are not estimated.
pub(super) fn fixed(model: &AnyModel) -> Vec<usize> {
    let AnyModel::GreyBox(model) = model else { return Vec::new() };
    let parameters = model.structure().parameters();
    (0..parameters.len()).filter(|index| parameters[*index].fixed).collect()
}

/// Quantities that the structure says follow from the parameters: their names and values; none where it says nothing.
fn derived(fit: &Fit<AnyModel>) -> Result<Option<(Vec<String>, Derived)>, String> {
    let of = |model: &AnyModel| match model {
        AnyModel::GreyBox(model) => model.derived(),
        _ => Vec::new(),
    };
    let names: Vec<String> = of(&fit.model).into_iter().map(|(name, _)| name).collect();
    if names.is_empty() {
        return Ok(None);
    }
    match fit.derive(|model| Ok(of(model).into_iter().map(|(_, value)| value).collect())) {
        Ok(found) => Ok(Some((names, found))),
        Err(IdentError::NotFinite { index, .. }) if index < names.len() => {
            Err(format!("{} has no finite value at these parameters", names[index]))
        }
        Err(other) => Err(other.to_string()),
    }
}

/// The derived quantities as a table, where there are any.
pub(super) fn blocks(fit: &Fit<AnyModel>) -> Option<Block> {
    let (names, derived) = match derived(fit) {
        Ok(found) => found?,
        Err(reason) => return Some(line(format!("no derived quantities: {reason}"))),
    };
    let (errors, intervals) = (derived.standard_errors(), derived.intervals(INTERVAL));
    let mut table = estimates("derived");
    for (i, name) in names.iter().enumerate() {
        table.row(estimate(name, derived.values[i], &Known::Within(errors[i], intervals[i])));
    }
    Some(Block::Table(table))
}

/// The same in numbers; none where they cannot be computed.
pub(super) fn facts(fit: &Fit<AnyModel>) -> Option<Vec<DerivedFacts>> {
    let (names, derived) = match derived(fit) {
        Ok(None) => return Some(Vec::new()),
        Ok(Some(found)) => found,
        Err(_) => return None,
    };
    let (errors, intervals) = (derived.standard_errors(), derived.intervals(INTERVAL));
    let quantity = |(i, name): (usize, String)| DerivedFacts {
        name,
        value: derived.values[i],
        standard_error: errors[i],
        interval_95: intervals[i].into(),
    };
    Some(names.into_iter().enumerate().map(quantity).collect())
}
