//! Names that most programs use: `use ident::prelude::*;`.
//!
//! From data to a fitted model, a printed summary and a Bode plot as numbers:
//! ```
//! use ident::prelude::*;
//! let u: Vec<f64> = (0..500).map(|t| if (t * t / 7) % 2 == 0 { 1.0 } else { -1.0 }).collect();
//! let mut y = vec![0.0; 500];
//! (1..500).for_each(|t| y[t] = 0.8 * y[t - 1] + 0.5 * u[t - 1] + 0.01 * (t as f64 * 1.7).sin());
//! let fit = Arx::new(1, 1, 1).fit(&Dataset::siso(0.1, &u, &y)?)?;
//! println!("{fit}");
//! let bode = fit.bode()?.remove(0);
//! println!("{:.2} dB at {:.3} Hz", bode.magnitude_db[0], bode.freq_hz[0]);
//! # assert!(fit.fit_percent()[0] > 95.0);
//! # Ok::<(), IdentError>(())
//! ```

pub use crate::closed_loop;
pub use crate::delay;
pub use crate::polynomial::recursive;
pub use crate::uncertainty::{BodeChart, Dynamics, Features, StepChart};
pub use crate::validate::{Comparison, ResidualTest, TestData, compare, fit_percent, judge};
pub use crate::{
    AnyModel, Arma, Armax, Arx, ArxOrders, BoxJenkins, ContinuousTransferFunction, Dataset, Fit, Focus,
    FormulaStructure, FrequencyData, FrequencyGreyBox, FrequencyTransferFunction, GreyBox, IdentError, ImpulseResponse,
    InitialState, Intersample, Iv4, LinearModel, ModelDocument, OrderScan, OutputError, Parametric, Polynomial,
    ProcessFit, StateOrder, StateSpacePem, Subspace, Trend, TrendScope, TrendShape, advise,
};
pub use lti::{ChannelPair, PolynomialModel, StateSpace, TransferFunction};
