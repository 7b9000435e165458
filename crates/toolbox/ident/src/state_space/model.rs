//! [`StateSpaceModel`]: an innovations form whose free matrices are its parameters.

use faer::Mat;
use lti::{Innovations, LtiError, StateSpace};

use super::predictor::Free;
use crate::data::check_clock;
use crate::{Intersample, LinearModel, Parametric};

/// A discrete state-space model in innovations form,
///
/// `x(t+1) = A x(t) + B u(t) + K e(t)`, `y(t) = C x(t) + D u(t) + e(t)`,
///
/// whose parameters are all entries of `A`, `B`, `C`, of `D` where the model has feed-through and of `K` where it has a
/// noise model, in this order and each by rows.
///
/// The same behaviour has many such parameter vectors, one for each choice of the states. The covariance that comes
/// with an estimate therefore is singular: it holds the states' basis fixed. Whatever does not depend on that basis —
/// poles, frequency responses, impulse responses — gets its exact first-order variance from it; the standard error of
/// a single entry means nothing.
///
/// # Source
/// Pintelon, Schoukens, McKelvey & Rolain, *Minimum variance bounds for overparameterized models*, IEEE Trans. Autom.
/// Control 41(5), 1996; McKelvey, Helmersson & Ribarits, *Data driven local coordinates for multivariable linear
/// systems and their application to system identification*, Automatica 40(9), 2004.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StateSpaceModel {
    innovations: Innovations,
    feedthrough: bool,
    noise: bool,
}

impl StateSpaceModel {
    /// The model of `innovations`; `feedthrough` and `noise` say whether `D` and `K` are parameters or stay as they
    /// are.
    #[must_use]
    pub fn new(innovations: Innovations, feedthrough: bool, noise: bool) -> Self {
        StateSpaceModel { innovations, feedthrough, noise }
    }

    /// The innovations form.
    #[must_use]
    pub fn innovations(&self) -> &Innovations {
        &self.innovations
    }

    /// The way from `u` to `y`: `A`, `B`, `C`, `D`.
    #[must_use]
    pub fn system(&self) -> &StateSpace {
        self.innovations.system()
    }

    /// Returns true if `D` is a parameter.
    #[must_use]
    pub fn has_feedthrough(&self) -> bool {
        self.feedthrough
    }

    /// Returns true if `K` is a parameter.
    #[must_use]
    pub fn has_noise_model(&self) -> bool {
        self.noise
    }

    pub(crate) fn free(&self) -> Free {
        Free { dynamics: true, feedthrough: self.feedthrough, noise: self.noise }
    }

    /// Name and size of each free matrix.
    fn shapes(&self) -> Vec<(char, usize, usize)> {
        let system = self.system();
        let (n, m, p) = (system.states(), system.inputs(), system.outputs());
        let mut shapes = vec![('A', n, n), ('B', n, m), ('C', p, n)];
        if self.feedthrough {
            shapes.push(('D', p, m));
        }
        if self.noise {
            shapes.push(('K', n, p));
        }
        shapes
    }
}

impl Parametric for StateSpaceModel {
    fn parameters(&self) -> Vec<f64> {
        let system = self.system();
        let entry = |name: char, i: usize, j: usize| match name {
            'A' => system.a()[(i, j)],
            'B' => system.b()[(i, j)],
            'C' => system.c()[(i, j)],
            'D' => system.d()[(i, j)],
            _ => self.innovations.k()[(i, j)],
        };
        let places = self.shapes().into_iter();
        places
            .flat_map(|(name, rows, columns)| (0..rows * columns).map(move |q| (name, q / columns, q % columns)))
            .map(|(name, i, j)| entry(name, i, j))
            .collect()
    }

    fn parameter_names(&self) -> Vec<String> {
        let label = |(name, rows, columns)| {
            (0..rows * columns).map(move |q| format!("{name}[{},{}]", q / columns + 1, q % columns + 1))
        };
        self.shapes().into_iter().flat_map(label).collect()
    }

    fn with_parameters(&self, parameters: &[f64]) -> Result<Self, LtiError> {
        let shapes = self.shapes();
        let count = shapes.iter().map(|(_, rows, columns)| rows * columns).sum();
        if parameters.len() != count {
            return Err(LtiError::shape("parameters", (count, 1), (parameters.len(), 1)));
        }
        let mut start = 0;
        let mut matrices = shapes.iter().map(|(_, rows, columns)| {
            let first = start;
            start += rows * columns;
            Mat::from_fn(*rows, *columns, |i, j| parameters[first + i * columns + j])
        });
        let system = self.system();
        let mut next = |otherwise: Mat<f64>, free: bool| if free { matrices.next() } else { None }.unwrap_or(otherwise);
        let a = next(system.a().to_owned(), true);
        let b = next(system.b().to_owned(), true);
        let c = next(system.c().to_owned(), true);
        let d = next(system.d().to_owned(), self.feedthrough);
        let k = next(self.innovations.k().to_owned(), self.noise);
        let system = StateSpace::new(a, b, c, d, system.sample_time_s())?;
        let innovations = Innovations::new(system, k, self.innovations.noise_covariance().to_owned())?;
        Ok(StateSpaceModel { innovations, ..*self })
    }
}

impl LinearModel for StateSpaceModel {
    fn inputs(&self) -> usize {
        self.system().inputs()
    }

    fn outputs(&self) -> usize {
        self.system().outputs()
    }

    fn innovations(&self, sample_time_s: f64, _: Intersample) -> Result<Innovations, LtiError> {
        check_clock(self.system().sample_time_s().unwrap_or(f64::NAN), sample_time_s)?;
        Ok(self.innovations.clone())
    }
}
