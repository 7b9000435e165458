//! System identification: estimators and their judgement.
//!
//! Notation follows Ljung, *System Identification: Theory for the User*, 2nd ed., 1999; the frequency-domain part
//! follows Pintelon & Schoukens, *System Identification: A Frequency Domain Approach*, 2nd ed., 2012. Rows are time,
//! columns are channels or parameters.
//!
//! The crate knows no file format, no test bench, prints nothing, reads no clock and holds no global random state.

mod arx;
pub mod closed_loop;
mod continuous;
pub mod covariance;
mod criteria;
mod data;
pub mod delay;
pub mod distributions;
pub mod document;
mod error;
mod fit;
mod focus;
pub mod frequency;
mod frequency_domain;
mod grey_box;
mod impulse_response;
mod instrumental;
pub mod least_squares;
pub mod nonlinear;
pub mod prediction;
pub mod prediction_error;
mod process;
pub mod recursive;
mod regression;
mod state_space;
mod subspace;
mod triangle;
pub mod uncertainty;
pub mod validate;

pub use arx::{Arx, ArxOrders, Criterion, OrderScan, OrderTable, ScannedStructure};
pub use continuous::{
    ContinuousChannel, ContinuousModel, ContinuousTransferFunction, ProcessSystem, RationalChannel,
    TransferFunctionModel,
};
pub use criteria::Criteria;
pub use data::{Advice, advise};
pub use data::{Channel, Dataset, Experiment, Intersample, Label};
pub use data::{Excitation, ExcitationOptions, Gap, Line, Prefilter, Split, Trend, TrendScope, TrendShape};
pub use document::{AnyModel, EstimateRecord, ModelDocument, Source};
pub use error::IdentError;
pub use fit::{Doubt, Fit, LinearModel, Parametric};
pub use focus::Focus;
pub use frequency_domain::{
    CostTest, FrequencyData, FrequencyGreyBox, FrequencyModel, FrequencyTransferFunction, Lines, Measured,
    RationalResponse, ResponseFunction, SpectralData, SpectralFit,
};
pub use grey_box::{Entry, GreyBox, GreyBoxModel, GreyNoise, GreyParameter, Structure, StructuredMatrices};
pub use impulse_response::{Hyperparameters, ImpulseFit, ImpulseResponse, Kernel, ResponseEstimate};
pub use instrumental::{InstrumentalVariables, Instruments, Iv4};
pub use least_squares::{LinearFit, least_squares};
pub use nonlinear::{Bounds, Minimum, NonlinearOptions, ResidualModel, Termination, minimise};
pub use prediction::InitialState;
pub use prediction_error::{Ararx, Arma, Armax, BoxJenkins, OutputError, Polynomial};
pub use process::ProcessFit;
pub use state_space::{StateSpaceModel, StateSpacePem};
pub use subspace::{StateOrder, Subspace, Weighting};
pub use triangle::Triangle;
