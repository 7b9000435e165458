//! Models as text: equations with their numbers, and with standard errors where these are known.

mod layout;
mod number;
mod polynomial;
mod systems;

pub use layout::{Table, indented, matrices, parameter_list};
pub use number::{number, with_error};
pub use polynomial::{Fraction, Polynomial};

/// A model that can be written out as its equations.
///
/// Every model of this crate also implements `Display`, which is [`Written::written`] without standard errors.
pub trait Written {
    /// The kind of model and its equations, one or more lines without a newline at the end. `standard_errors` has one
    /// entry a parameter, in the order of the model's parameters; parameters beyond its length are written without an
    /// error.
    fn written(&self, standard_errors: Option<&[f64]>) -> String;
}

/// Implements `Display` by [`Written`].
macro_rules! display_as_written {
    ($($model:ty),+) => {$(
        impl std::fmt::Display for $model {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(&$crate::text::Written::written(self, None))
            }
        }
    )+};
}
pub(crate) use display_as_written;

/// The standard errors of a model's parameters, given out in their order.
#[derive(Debug)]
pub struct Errors<'a> {
    left: Option<&'a [f64]>,
}

impl<'a> Errors<'a> {
    /// From the errors of all parameters.
    #[must_use]
    pub fn new(all: Option<&'a [f64]>) -> Self {
        Errors { left: all }
    }

    /// Those of the next `count` parameters; `None` where errors are not known.
    pub fn take(&mut self, count: usize) -> Option<&'a [f64]> {
        let (own, rest) = self.left?.split_at_checked(count)?;
        self.left = Some(rest);
        Some(own)
    }
}

/// In which time a system runs: `continuous time`, or `discrete time, sample time 0.1 s`.
pub(crate) fn clock(sample_time_s: Option<f64>) -> String {
    match sample_time_s {
        None => "continuous time".to_owned(),
        Some(sample_time_s) => format!("discrete time, sample time {} s", number(sample_time_s)),
    }
}
