//! How the models of this crate are written; those of [`lti`] are written there.

use std::fmt;

use lti::ChannelPair;
use lti::text::{Errors, Written, indented, parameter_list};

use crate::{
    ContinuousChannel, ContinuousModel, GreyBoxModel, LinearModel, Parametric, RationalChannel, RationalResponse,
    ResponseFunction, StateSpaceModel, Structure,
};

/// Text for parameters at which there is no system.
const NO_SYSTEM: &str = "no system at these parameters";

impl Written for StateSpaceModel {
    /// Without errors of single entries, which mean nothing: the states' basis is free.
    fn written(&self, _: Option<&[f64]>) -> String {
        self.innovations().written(None)
    }
}

impl Written for RationalChannel {
    fn written(&self, standard_errors: Option<&[f64]>) -> String {
        self.transfer_function().map_or_else(|_| NO_SYSTEM.to_owned(), |g| g.written(standard_errors))
    }
}

impl Written for RationalResponse {
    fn written(&self, standard_errors: Option<&[f64]>) -> String {
        self.transfer_function().map_or_else(|_| NO_SYSTEM.to_owned(), |g| g.written(standard_errors))
    }
}

impl<C: ContinuousChannel + Written> Written for ContinuousModel<C> {
    fn written(&self, standard_errors: Option<&[f64]>) -> String {
        let mut errors = Errors::new(standard_errors);
        let pairs = ChannelPair::all(self.outputs(), self.inputs());
        let several = self.outputs() * self.inputs() > 1;
        let parts = pairs.zip(self.channels()).map(|(pair, channel)| {
            let text = channel.written(errors.take(channel.parameters().len()));
            if several { format!("From {pair}:\n{}", indented(&text)) } else { text }
        });
        parts.collect::<Vec<_>>().join("\n")
    }
}

impl<S: Structure> Written for GreyBoxModel<S> {
    fn written(&self, standard_errors: Option<&[f64]>) -> String {
        let list = parameter_list(&self.parameter_names(), &self.parameters(), standard_errors);
        let system = self.system().map_or_else(|_| NO_SYSTEM.to_owned(), |system| system.written(None));
        format!("Grey-box model with the parameters\n{}\n\n{system}", indented(&list))
    }
}

impl<F: Clone> Written for ResponseFunction<F>
where
    ResponseFunction<F>: Parametric,
{
    fn written(&self, standard_errors: Option<&[f64]>) -> String {
        let list = parameter_list(&self.parameter_names(), &self.parameters(), standard_errors);
        format!("Frequency response with the parameters\n{}", indented(&list))
    }
}

macro_rules! display_as_written {
    ($($model:ty),+) => {$(
        impl fmt::Display for $model {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(&self.written(None))
            }
        }
    )+};
}
display_as_written!(StateSpaceModel, RationalChannel, RationalResponse, crate::AnyModel);

impl<C: ContinuousChannel + Written> fmt::Display for ContinuousModel<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.written(None))
    }
}

impl<S: Structure> fmt::Display for GreyBoxModel<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.written(None))
    }
}
