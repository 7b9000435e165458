#![doc = include_str!("../README.md")]
//!
//! Notation follows Ljung, *System Identification: Theory for the User*, 2nd ed., 1999; the frequency-domain part
//! follows Pintelon & Schoukens, *System Identification: A Frequency Domain Approach*, 2nd ed., 2012. Rows are time,
//! columns are channels or parameters.
//!
//! Every estimator is a struct of options whose `fit` takes data and returns a [`Fit`]: the model, its covariance, how
//! the search ended and what to doubt.
//!
//! | what you want | what to call |
//! | --- | --- |
//! | data with gaps, offsets, several records | [`Dataset`] and its methods |
//! | what the data can show | [`advise`], [`ExcitationOptions`], [`delay`] |
//! | a first model, at once | [`Arx`], [`OrderScan`] for its orders; [`ImpulseResponse`] without any |
//! | the same under coloured noise | [`Iv4`] |
//! | dynamics and noise by polynomials | [`Armax`], [`OutputError`], [`BoxJenkins`], [`Polynomial`] |
//! | several inputs and outputs | [`Subspace`], then [`StateSpacePem`] |
//! | continuous time | [`ContinuousTransferFunction`], [`ProcessFit`] for gain, lags and delay |
//! | physical parameters | [`GreyBox`], of formulas with [`FormulaStructure`] |
//! | a model of measured spectra or responses | [`FrequencyTransferFunction`], [`FrequencyGreyBox`] |
//! | a plant under feedback | [`closed_loop`] |
//! | parameters that change | [`recursive`] |
//! | states that were not measured, afterwards | [`smoothing`] |
//! | a criterion of one's own | [`minimise`] |
//! | what a model says of data | [`prediction`] |
//! | whether it is right | [`validate`] |
//! | how certain it is | [`Fit::intervals`], [`uncertainty`] for poles, bands and whatever follows from it |
//! | to keep a model | [`ModelDocument`] |
//!
//! # Example
//! A model is fitted to one part of the data and judged on the rest.
//! ```
//! use ident::validate::{ResidualTest, TestData, judge};
//! use ident::{Arx, Dataset, InitialState};
//! let mut random = signal::excitation::Random::new(1);
//! let u: Vec<f64> = (0..1000).map(|_| random.normal()).collect();
//! // y(t) = 1.5 y(t−1) − 0.7 y(t−2) + u(t−1) + e(t)
//! let mut y = vec![0.0; 1000];
//! for t in 2..1000 {
//!     y[t] = 1.5 * y[t - 1] - 0.7 * y[t - 2] + u[t - 1] + 0.1 * random.normal();
//! }
//! let parts = Dataset::siso(0.1, &u, &y)?.split(0.6)?;
//! let fit = Arx::new(2, 1, 1).fit(&parts.estimation)?;
//! assert!((fit.parameters()[0] + 1.5).abs() < 4.0 * fit.standard_errors()[0]);
//! let judged = judge(&fit.model, &parts.validation, None, &InitialState::Estimated)?;
//! assert!(judged.fit_percent[0][0] > 80.0);
//! let residuals = ResidualTest::default().run(&fit, &parts.validation, TestData::Unseen)?;
//! assert!(residuals.whiteness[0].joint.passes(0.99));
//! # Ok::<(), ident::IdentError>(())
//! ```

mod advice;
pub mod closed_loop;
mod colour;
mod continuous;
mod data;
pub mod delay;
mod dense;
pub mod document;
mod fit;
mod frequency_domain;
mod grey_box;
mod impulse_response;
mod polynomial;
pub mod prediction;
pub mod prelude;
mod state_space;
mod summary;
pub mod uncertainty;
pub mod validate;

// The core of every fit.
pub use fitting::{Bounds, Minimum, NonlinearOptions, ResidualModel, minimise};
pub use fitting::{
    BoundsFault, ChannelKind, Count, IdentError, RefinedLimit, StructureError, StructureFault, UnstablePart,
};
pub use fitting::{LinearFit, Termination, Triangle, covariance, frequency, least_squares, nonlinear, smoothing};

// Data.
pub use advice::{Advice, SampleIndex, advise};
pub use data::excitation::{Excitation, ExcitationOptions};
pub use data::{Channel, Dataset, Experiment, Gap, Intersample, Label, Prefilter, Split};
pub use data::{Line, Trend, TrendScope, TrendShape};
pub use frequency_domain::{FrequencyData, Lines, Measured, SharedNoise, SpectralData};

// Models and fits.
pub use continuous::{
    ContinuousChannel, ContinuousModel, Degrees, ProcessSystem, RationalChannel, TransferFunctionModel,
};
pub use data::band_limited::BandLimitedForm;
pub use document::{AnyModel, DocumentHeader, EstimateRecord, ModelDocument, Source};
pub use fit::{Doubt, Fit, LinearModel, Parametric};
pub use frequency_domain::{FrequencyModel, RationalResponse, ResponseFunction, SpectralFit};
pub use grey_box::{
    Entry, Formula, FormulaParts, FormulaStructure, GreyBoxModel, GreyNoise, GreyParameter, Structure,
    StructuredMatrices,
};
pub use impulse_response::{Hyperparameters, ImpulseFit, ResponseEstimate};
pub use lti::ChannelPair;
pub use state_space::StateSpaceModel;

// Estimators and their options.
pub use continuous::process::ProcessFit;
pub use continuous::{ContinuousTransferFunction, TransferFunctionMethod};
pub use data::origin::Origin;
pub use fit::focus::Focus;
pub use frequency_domain::{FrequencyGreyBox, FrequencyTransferFunction};
pub use grey_box::GreyBox;
pub use impulse_response::{ImpulseResponse, Kernel};
pub use polynomial::arx::{Arx, ArxOrders, Criterion, OrderScan, OrderTable, ScannedStructure};
pub use polynomial::instrumental::{InstrumentalVariables, Instruments, Iv4};
pub use polynomial::prediction_error::{self, Ararx, Arma, Armax, BoxJenkins, OutputError, Polynomial};
pub use polynomial::recursive;
pub use prediction::InitialState;
pub use state_space::pem::{SearchStart, StateSpacePem};
pub use state_space::subspace::{StateOrder, Subspace, Weighting};

// Judgement; more in `validate` and `uncertainty`.
pub use fit::criteria::Criteria;
pub use frequency_domain::CostTest;
pub use signal::distributions;
