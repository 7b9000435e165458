//! How finely the bench is simulated.

use rig::bench_parameters::require;

use super::drive::SAMPLES_PER_UPDATE;
use super::error::VirtualBenchError;

/// How finely the bench is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Numerics {
    /// Steps of the mechanics in one update of the controllers (1 ms).
    pub steps_per_update: usize,
    /// Steps from one sample of `HiddenTruth` to the next; without it the truth is left empty.
    pub steps_per_hidden_sample: Option<usize>,
}

impl Default for Numerics {
    /// Steps of 50 µs, hidden truth every 1 ms.
    fn default() -> Self {
        Self { steps_per_hidden_sample: Some(20), ..Self::WITHOUT_TRUTH }
    }
}

impl Numerics {
    /// Steps of 50 µs, and no hidden truth: half the memory.
    pub const WITHOUT_TRUTH: Numerics = Numerics { steps_per_update: 20, steps_per_hidden_sample: None };

    pub(super) fn check(self, has_machine: bool) -> Result<(), VirtualBenchError> {
        let (steps, hidden) = (self.steps_per_update, self.steps_per_hidden_sample);
        let requirement = "between 1 and 10 000";
        require("numerics.steps_per_update", steps as f64, (1..=10_000).contains(&steps), requirement)?;
        let samples = SAMPLES_PER_UPDATE;
        let fits = !has_machine || steps.is_multiple_of(samples);
        let whole = "a multiple of 4, as the drive samples four times a millisecond";
        require("numerics.steps_per_update", steps as f64, fits, whole)?;
        if let Some(hidden) = hidden {
            require("numerics.steps_per_hidden_sample", hidden as f64, hidden > 0, "at least 1")?;
        }
        Ok(())
    }
}
