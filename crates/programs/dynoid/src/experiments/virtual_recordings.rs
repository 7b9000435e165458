//! Recordings of a virtual bench.

use std::path::{Path, PathBuf};

use recording::Recording;
use rig::bench_parameters::BenchParameters;
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan};
use study::Source;
use units::RPM_RAD_S;
use virtual_bench::{Numerics, simulate_as_step};
use work::Context;

use crate::error::Error;
use crate::files::Files;
use crate::formats::FileFormat;

/// Recordings of a virtual bench, in memory. A study knows them by their names, such as `BS_T_NT_1200.mf4`.
#[derive(Debug, Clone, PartialEq)]
pub struct VirtualRecordings {
    all: Vec<(String, Recording)>,
}

impl VirtualRecordings {
    /// Runs experiments on a bench of these parameters. Each has a seed of its own, counted from this one.
    ///
    /// # Errors
    /// A bench or a plan that cannot be simulated.
    pub fn of(
        parameters: &BenchParameters,
        plans: &[ExperimentPlan],
        seed: u64,
        context: &Context,
    ) -> Result<Self, Error> {
        let step = context.step("simulating the bench", plans.len() as u64);
        let mut all = Vec::new();
        for (plan, seed) in plans.iter().zip(seed..) {
            let first_rad_s = Demands::of(plan, seed, DEMAND_HOLD_S).speed_rad_s.first().copied().unwrap_or_default();
            let name = format!("{}_{:.0}.mf4", plan.label, first_rad_s / RPM_RAD_S);
            let run = simulate_as_step(&step, parameters, plan, seed, Numerics::WITHOUT_TRUTH);
            let run = run.map_err(|source| Error::VirtualBench { path: PathBuf::from(&name), source })?;
            all.push((name, run.recording));
        }
        Ok(VirtualRecordings { all })
    }

    /// The recordings for [`crate::Session::of`].
    pub fn sources(self) -> Vec<Source> {
        let source =
            |(file, recording): (String, Recording)| Source { file, sha256: String::new(), recording: Ok(recording) };
        self.all.into_iter().map(source).collect()
    }

    /// Writes each into a folder, and returns the files.
    ///
    /// # Errors
    /// A file that must stay, and a place where nothing can be written.
    pub fn write(&self, folder: &Path, files: &Files) -> Result<Vec<PathBuf>, Error> {
        let write = |(name, recording): &(String, Recording)| {
            let path = folder.join(name);
            FileFormat::Mf4.write(recording, &path, files).map(|()| path)
        };
        self.all.iter().map(write).collect()
    }
}
