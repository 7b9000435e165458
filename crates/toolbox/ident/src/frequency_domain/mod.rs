//! Maximum likelihood from frequency responses and from periodic spectra, weighted by the measured noise.

mod basis;
mod data;
mod grey_box;
mod misfit;
mod rational;
mod shared_noise;
mod start;

pub use data::{FrequencyData, Lines, Measured, SpectralData};
pub use grey_box::{FrequencyGreyBox, FrequencyModel, ResponseFunction};
pub use misfit::{CostTest, SpectralFit};
pub use rational::{FrequencyTransferFunction, RationalResponse};
pub use shared_noise::SharedNoise;
