//! State-space models: what the prediction error says about their matrices, and the search that minimises it.

mod coordinates;
mod correlated;
mod derivatives;
mod extrapolation;
mod gather;
mod lineariser;
mod model;
pub(crate) mod pem;
mod predictor;
mod search;
mod sensitivities;
pub(crate) mod subspace;

pub(crate) use gather::{Information, Known, estimate, gather, regress_inputs};
pub use model::StateSpaceModel;
pub(crate) use predictor::Free;
pub(crate) use search::{Search, Searchable, entries};
