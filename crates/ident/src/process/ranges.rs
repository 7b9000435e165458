//! Where the parameters of a process model are searched.

use faer::Mat;
use lti::ProcessModel;

use crate::continuous::{ProcessSystem, check_delays};
use crate::structure_error::StructureError;
use crate::{Bounds, IdentError, Parametric};

/// Damping of a pair of poles is searched up to here.
const MOST_DAMPED: f64 = 10.0;

/// What the options come to for one output of given data.
#[derive(Clone)]
pub(crate) struct Ranges {
    pub(crate) structure: Vec<ProcessModel>,
    pub(crate) delay_s: Vec<(f64, f64)>,
    pub(crate) lag_s: (f64, f64),
    /// The value of every parameter that is held.
    pub(crate) held: Vec<Option<f64>>,
}

impl Ranges {
    /// Delays that are held narrow what is searched to themselves.
    pub(super) fn new(
        structure: Vec<ProcessModel>,
        searched_s: &[(f64, f64)],
        lag_s: (f64, f64),
        held: Vec<Option<f64>>,
        jumps: bool,
    ) -> Result<Self, IdentError> {
        let (mut delay_s, mut next) = (Vec::with_capacity(structure.len()), 0);
        for (model, searched) in structure.iter().zip(searched_s) {
            next += model.parameters().len();
            let range = match (model.delay_s(), held[next - 1]) {
                (None, _) => (0.0, 0.0),
                (Some(_), Some(value)) => (value, value),
                (Some(_), None) => *searched,
            };
            check_zero(model, range.0 < range.1 && jumps)?;
            delay_s.push(range);
        }
        check_delays(&delay_s)?;
        Ok(Ranges { structure, delay_s, lag_s, held })
    }

    pub(super) fn bounds(&self) -> Vec<Bounds> {
        let lag = Bounds::new(self.lag_s.0, self.lag_s.1);
        let mut bounds = Vec::new();
        for (model, (low, high)) in self.structure.iter().zip(&self.delay_s) {
            bounds.push(Bounds::NONE);
            bounds.extend(model.pair().into_iter().flat_map(|_| [lag, Bounds::new(0.0, MOST_DAMPED)]));
            bounds.extend(vec![lag; model.lags_s().len()]);
            bounds.extend(model.zero_s().map(|_| Bounds::NONE));
            bounds.extend(model.delay_s().map(|_| Bounds::new(*low, *high)));
        }
        let fixed = |(free, held): (Bounds, &Option<f64>)| held.map_or(free, |value| Bounds::new(value, value));
        bounds.into_iter().zip(&self.held).map(fixed).collect()
    }

    /// The structures with these delays, with lags spread down from `longest_s`, and gains of one, but for what is held.
    pub(crate) fn at(&self, delay_s: &[f64], longest_s: &[f64]) -> Result<ProcessSystem, IdentError> {
        let mut channels = Vec::with_capacity(self.structure.len());
        for ((model, delay), longest) in self.structure.iter().zip(delay_s).zip(longest_s) {
            let mut theta = vec![1.0];
            theta.extend(model.pair().into_iter().flat_map(|_| [*longest, 0.5]));
            theta.extend((0..model.lags_s().len()).map(|i| (longest / 3.0_f64.powi(i as i32)).max(self.lag_s.0)));
            theta.extend(model.zero_s().map(|_| 0.0));
            theta.extend(model.delay_s().map(|_| *delay));
            channels.push(model.with_parameters(&theta)?);
        }
        let free = ProcessSystem::new(channels, self.structure.len(), Mat::identity(1, 1))?;
        let values = free.parameters().into_iter().zip(&self.held).map(|(value, held)| held.unwrap_or(value));
        Ok(free.with_parameters(&values.collect::<Vec<f64>>())?)
    }
}

/// Where the output follows the input at once and inputs jump, a delay shows only as a whole number of samples.
fn check_zero(model: &ProcessModel, delayed_jumps: bool) -> Result<(), IdentError> {
    let (zeros, poles) = (usize::from(model.zero_s().is_some()), model.order() + usize::from(model.integrates()));
    if zeros > poles {
        return Err(StructureError::TooMany { what: "zeros", found: zeros, most: poles }.into());
    }
    if zeros == poles && delayed_jumps {
        return Err(StructureError::DelayNotSearchable.into());
    }
    Ok(())
}
