//! [`Focus`]: which errors an estimate makes small.

/// Which errors are made small.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Focus {
    /// Those of the prediction one step ahead, with a noise model: the maximum-likelihood estimate under normal noise.
    #[default]
    Prediction,
    /// Those of the simulation from the inputs alone. What noise model there is follows with the dynamics held.
    Simulation,
}

impl Focus {
    /// The method that makes them small, by name.
    pub(crate) fn method(self) -> &'static str {
        match self {
            Focus::Prediction => "prediction error",
            Focus::Simulation => "simulation error",
        }
    }
}
