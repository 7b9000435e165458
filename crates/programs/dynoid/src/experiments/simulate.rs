//! An experiment on the virtual bench of a bench file.

use page::Page;
use recording::Recording;
use rig::ExperimentLabel;
use rig::experiment::ExperimentPlan;
use serde::Serialize;
use virtual_bench::{Assumption, Numerics, VirtualRun, rename, simulate_as_step};
use work::Context;

use crate::error::Error;
use crate::known::KnownBench;

/// A simulated experiment.
#[derive(Debug, Clone)]
pub struct SimulatedExperiment {
    label: ExperimentLabel,
    duration_s: f64,
    seed: u64,
    assumptions: Vec<Assumption>,
    /// The recording, with the channels of the bench file.
    pub recording: Recording,
    /// The true signals, without sensors, where they are wanted.
    pub truth: Option<Recording>,
}

impl SimulatedExperiment {
    /// Runs an experiment on the virtual bench, which keeps the true signals if that is wanted.
    ///
    /// # Errors
    /// A bench or a plan that cannot be simulated.
    pub fn of(
        bench: &KnownBench,
        plan: &ExperimentPlan,
        seed: u64,
        with_truth: bool,
        context: &Context,
    ) -> Result<Self, Error> {
        let numerics = if with_truth { Numerics::default() } else { Numerics::WITHOUT_TRUTH };
        let simulated = simulate_as_step(context, &bench.virtual_bench().parameters, plan, seed, numerics);
        let VirtualRun { mut recording, hidden } =
            simulated.map_err(|source| Error::VirtualBench { path: bench.path().to_owned(), source })?;
        rename(&mut recording, &bench.file().channels);
        Ok(SimulatedExperiment {
            label: plan.label.clone(),
            duration_s: plan.duration_s,
            seed,
            assumptions: bench.virtual_bench().assumed_for(plan),
            recording,
            truth: with_truth.then(|| hidden.recording()),
        })
    }

    /// The experiment.
    pub fn label(&self) -> &ExperimentLabel {
        &self.label
    }

    /// The recording as a page.
    pub fn page(&self) -> Page {
        report::recording::simulated(&self.label, &self.recording, &self.assumptions)
    }

    /// The recording in numbers.
    pub fn facts(&self) -> SimulationFacts<'_> {
        SimulationFacts {
            label: self.label.to_string(),
            duration_s: self.duration_s,
            seed: self.seed,
            channels: self.recording.channels.iter().map(ChannelFacts::of).collect(),
            assumptions: &self.assumptions,
        }
    }
}

/// Numbers of [`SimulatedExperiment`].
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SimulationFacts<'a> {
    label: String,
    duration_s: f64,
    seed: u64,
    channels: Vec<ChannelFacts<'a>>,
    assumptions: &'a [Assumption],
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct ChannelFacts<'a> {
    name: &'a str,
    unit: &'a str,
    samples: usize,
    peak: f64,
}

impl<'a> ChannelFacts<'a> {
    fn of(channel: &'a recording::Channel) -> Self {
        let peak =
            channel.samples.iter().copied().fold(0.0, |most: f64, v| if v.abs() > most.abs() { v } else { most });
        ChannelFacts { name: &channel.name, unit: &channel.unit, samples: channel.samples.len(), peak }
    }
}
