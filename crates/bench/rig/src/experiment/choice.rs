//! Which recording gives which part of a bench: the one table of it.

use serde::{Deserialize, Serialize};

use super::{ControlMode, Excitation, Experiment, ExperimentLabel, Test};
use crate::error::EstimateError;
use crate::words::InWords;

/// Result that is estimated from one recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Sought {
    /// PI with delay.
    SpeedController,
    /// Feed-forward of the speed controller.
    FeedForward,
    /// Inverter and machine, closed loop from T_d* to T_d.
    TorqueControl,
    /// Delays of the torque signals.
    Timing,
    /// Stiffness and damping of the shaft.
    Shaft,
    /// J_d and J_e as if nothing were known of them.
    Inertias,
}

/// From which experiments something is estimated.
struct Rule {
    sought: Sought,
    /// Tests that give it, the best first.
    tests: &'static [Test],
    /// Excitation that is wanted; recordings in which something else is excited come after the others of a test.
    excitation: Option<Excitation>,
    /// The mode that it needs.
    mode: Option<ControlMode>,
    /// Experiments to ask for where there is none.
    missing: &'static [ExperimentLabel],
}

const RULES: [Rule; 6] = [
    // With a constant N_d* the feed-forward rests, and the engine moves N_d.
    Rule {
        sought: Sought::SpeedController,
        tests: &[Test::Bs],
        excitation: None,
        mode: None,
        missing: &[ExperimentLabel::BS_T_NT],
    },
    // Many levels and slopes tell k and k_a apart; ramps have one slope.
    Rule {
        sought: Sought::FeedForward,
        tests: &[Test::Levels, Test::Ramp],
        excitation: None,
        mode: None,
        missing: &[ExperimentLabel::LEVELS_N_NT, ExperimentLabel::RAMP_N_NT],
    },
    // The wider the band of T_d*, the better; behind the engine's torque T_d* moves slowly.
    Rule {
        sought: Sought::TorqueControl,
        tests: &[Test::WhiteNoise, Test::Multisine, Test::Binary, Test::Step, Test::Bs],
        excitation: Some(Excitation::Torque),
        mode: None,
        missing: &[ExperimentLabel::WHITE_NOISE_T_TN, ExperimentLabel::STEP_T_TN, ExperimentLabel::BS_T_NT],
    },
    Rule {
        sought: Sought::Timing,
        tests: &[Test::WhiteNoise, Test::Multisine, Test::Binary, Test::Step],
        excitation: None,
        mode: None,
        missing: &[ExperimentLabel::WHITE_NOISE_T_TN, ExperimentLabel::STEP_T_TN],
    },
    // A designed excitation holds its power where it shows the shaft. A torque demand that does not answer to the
    // engine shows J_d with the shaft; BS moves the shaft more, and leaves J_d as stated.
    Rule {
        sought: Sought::Shaft,
        tests: &[Test::Multisine, Test::Binary, Test::WhiteNoise, Test::Bs, Test::Levels, Test::Ramp, Test::Step],
        excitation: None,
        mode: None,
        missing: &[ExperimentLabel::WHITE_NOISE_T_TN, ExperimentLabel::BS_T_NT],
    },
    // A T_d* that does not answer to the engine shows J_e, if it moves the bench over a wide band.
    Rule {
        sought: Sought::Inertias,
        tests: &[Test::Multisine, Test::Binary, Test::WhiteNoise],
        excitation: None,
        mode: Some(ControlMode::Tn),
        missing: &[ExperimentLabel::WHITE_NOISE_T_TN, ExperimentLabel::MULTISINE_T_TN],
    },
];

/// Why a recording was chosen.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Choice {
    /// Result that is estimated from it.
    pub sought: Sought,
    /// The file.
    pub file: String,
    /// The experiment's label.
    pub label: ExperimentLabel,
    /// Its test's place in the order of preference, from one.
    pub preference: usize,
    /// How many recordings of this test there are; the longest of them is tried first.
    pub of_the_test: usize,
    /// Recordings that were tried before it in vain, and why each did not do.
    pub passed_over: Vec<PassedOver>,
}

/// A recording that was tried in vain.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PassedOver {
    /// The file.
    pub file: String,
    /// Why it did not do; it serialises as its words.
    #[serde(rename = "reason")]
    pub error: InWords<EstimateError>,
}

impl Sought {
    fn rule(self) -> &'static Rule {
        let index = RULES.iter().position(|rule| rule.sought == self).unwrap_or(0);
        &RULES[index]
    }

    /// Labels of experiments that give it, to be asked for where there is none.
    pub fn missing(self) -> &'static [ExperimentLabel] {
        self.rule().missing
    }

    /// Tells whether an experiment may give it.
    pub fn is_given_by(self, experiment: &Experiment) -> bool {
        let rule = self.rule();
        rule.tests.contains(&experiment.label.test) && rule.mode.is_none_or(|mode| experiment.label.mode == mode)
    }

    /// The experiments that may give it, in the order in which they are tried: by the preference of their tests, the
    /// longest of a test first.
    pub fn candidates<'a>(self, experiments: &[&'a Experiment]) -> Vec<&'a Experiment> {
        let excitation = self.rule().excitation;
        let is_other = |e: &Experiment| excitation.is_some_and(|wanted| e.label.excitation != wanted);
        let mut found: Vec<&Experiment> = experiments.iter().copied().filter(|e| self.is_given_by(e)).collect();
        found.sort_by(|a, b| {
            let preference = self.preference(a).cmp(&self.preference(b)).then(is_other(a).cmp(&is_other(b)));
            preference.then(b.duration_s().total_cmp(&a.duration_s()))
        });
        found
    }

    /// Why one of the experiments was chosen after others had been tried.
    pub fn choice(self, chosen: &Experiment, experiments: &[&Experiment], passed_over: Vec<PassedOver>) -> Choice {
        let same = |e: &&&Experiment| e.label.test == chosen.label.test && self.is_given_by(e);
        Choice {
            sought: self,
            file: chosen.file.clone(),
            label: chosen.label.clone(),
            preference: self.preference(chosen) + 1,
            of_the_test: experiments.iter().filter(same).count(),
            passed_over,
        }
    }

    fn preference(self, experiment: &Experiment) -> usize {
        let tests = self.rule().tests;
        tests.iter().position(|test| *test == experiment.label.test).unwrap_or(tests.len())
    }
}
