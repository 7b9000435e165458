//! Properties of models: frequency responses, step responses, poles and zeros.

mod bode;
mod curves;
mod facts;
mod model;
mod plane;
pub(crate) mod poles;
mod roots;
mod step;

pub use bode::bode;
pub use curves::{Curves, Detail};
pub use facts::{CurveFacts, Fact, ModelRootsFacts, Points, QuantityFacts, RegionFacts, RootFacts, RootsFacts};
pub use model::{LoopMargins, Model};
pub use poles::{Poles, poles};
pub use step::step;
