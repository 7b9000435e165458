//! Where the parameters of a process model are searched.

use faer::Mat;
use lti::ProcessModel;

use crate::continuous::{ProcessSystem, check_delays};
use crate::{Bounds, IdentError, Parametric};
use fitting::{BoundsFault, StructureError};

/// Damping of a pair of poles is searched up to here.
const MOST_DAMPED: f64 = 10.0;

/// Kind of a parameter of a process model.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Gain,
    TimeConstant,
    Damping,
    Zero,
    Delay,
}

impl Kind {
    /// Those of the parameters of a model, in their order.
    fn of(model: &ProcessModel) -> Vec<Kind> {
        let mut kinds = vec![Kind::Gain];
        kinds.extend(model.pair().into_iter().flat_map(|_| [Kind::TimeConstant, Kind::Damping]));
        kinds.extend(vec![Kind::TimeConstant; model.lags_s().len()]);
        kinds.extend(model.zero_s().map(|_| Kind::Zero));
        kinds.extend(model.delay_s().map(|_| Kind::Delay));
        kinds
    }

    /// Fault of bounds of such a parameter.
    fn fault(self, bounds: Bounds) -> Option<BoundsFault> {
        let Bounds { lower, upper } = bounds;
        if lower.is_nan() || upper.is_nan() || lower > upper {
            return Some(BoundsFault::Order);
        }
        let (is_wrong, fault) = match self {
            Kind::Gain | Kind::Zero => return None,
            Kind::TimeConstant => (lower <= 0.0 || upper.is_infinite(), BoundsFault::TimeConstant),
            Kind::Damping => (lower < 0.0, BoundsFault::Damping),
            Kind::Delay => (lower < 0.0 || upper.is_infinite(), BoundsFault::Delay),
        };
        is_wrong.then_some(fault)
    }
}

/// Where parameters are searched unless something else is asked for.
pub(super) struct Usual {
    /// Of each input.
    pub(super) delay_s: Vec<(f64, f64)>,
    pub(super) lag_s: (f64, f64),
}

/// Request for one parameter: its value held, or its bounds.
#[derive(Debug, Clone, Default)]
pub(super) struct Asked {
    pub(super) name: String,
    pub(super) held: Option<f64>,
    pub(super) bounds: Option<Bounds>,
}

impl Asked {
    /// The bounds it is searched within, the same value twice where it is not.
    fn bounds(&self, kind: Kind, usual: Bounds) -> Result<Bounds, IdentError> {
        let fault = |Bounds { lower: low, upper: high }, fault| {
            IdentError::from(StructureError::ParameterBounds { name: self.name.clone(), low, high, fault })
        };
        if let Some(bounds) = self.bounds
            && let Some(wrong) = kind.fault(bounds)
        {
            return Err(fault(bounds, wrong));
        }
        match (self.held, self.bounds) {
            (Some(value), Some(bounds)) if bounds.clamp(value) != value => Err(fault(bounds, BoundsFault::HeldOutside)),
            (Some(value), _) => Ok(Bounds::new(value, value)),
            (None, bounds) => Ok(bounds.unwrap_or(usual)),
        }
    }
}

/// Ranges that the options give for one output of given data.
#[derive(Clone)]
pub(crate) struct Ranges {
    pub(crate) structure: Vec<ProcessModel>,
    pub(crate) delay_s: Vec<(f64, f64)>,
    pub(crate) lag_s: (f64, f64),
    bounds: Vec<Bounds>,
}

impl Ranges {
    pub(super) fn new(
        structure: Vec<ProcessModel>,
        usual: &Usual,
        asked: &[Asked],
        jumps: bool,
    ) -> Result<Self, IdentError> {
        let (lag, mut asked, mut bounds, mut delay_s) = (usual.lag_s, asked.iter(), Vec::new(), Vec::new());
        for (model, delay) in structure.iter().zip(&usual.delay_s) {
            for (kind, asked) in Kind::of(model).into_iter().zip(&mut asked) {
                let usual = match kind {
                    Kind::Gain | Kind::Zero => Bounds::NONE,
                    Kind::TimeConstant => Bounds::new(lag.0, lag.1),
                    Kind::Damping => Bounds::new(0.0, MOST_DAMPED),
                    Kind::Delay => Bounds::new(delay.0, delay.1),
                };
                bounds.push(asked.bounds(kind, usual)?);
            }
            // The delay is the last parameter of a model.
            let of_delay = model.delay_s().and_then(|_| bounds.last());
            let range = of_delay.map_or((0.0, 0.0), |b| (b.lower, b.upper));
            check_zero(model, range.0 < range.1 && jumps)?;
            delay_s.push(range);
        }
        check_delays(&delay_s)?;
        Ok(Ranges { structure, delay_s, lag_s: lag, bounds })
    }

    pub(super) fn bounds(&self) -> &[Bounds] {
        &self.bounds
    }

    /// Returns true if a parameter is not searched.
    pub(super) fn is_held(&self, parameter: usize) -> bool {
        self.bounds[parameter].lower == self.bounds[parameter].upper
    }

    /// The structures with these delays, with lags spread down from `longest_s`, and gains of one, each moved to within
    /// its bounds.
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
        let values = free.parameters().into_iter().zip(&self.bounds).map(|(value, bounds)| bounds.clamp(value));
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
