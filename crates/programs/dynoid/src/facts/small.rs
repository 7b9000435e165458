//! Results of which little is left out.

use part_friction::{Candidate, CurvePoint, Friction, Inertia, RunOut, TorqueUsed};
use part_shaft::shaft_analysis::{ShaftAnalysis, ShaftRecording, Together};
use part_torque::model_comparison::{ComparedRecording, Judgement, ModelComparison, Visibility};
use rig::results::{Estimate, Reason, Stretch};
use serde::Serialize;

/// Models of the torque control, compared, without their responses.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TorqueControlFacts<'a> {
    recordings: &'a [ComparedRecording],
    judgements: &'a [Judgement],
    visibility: &'a Option<Visibility>,
    unusable: &'a [(String, Reason)],
}

impl<'a> TorqueControlFacts<'a> {
    /// Of a comparison.
    pub fn of(found: &'a ModelComparison) -> Self {
        TorqueControlFacts {
            recordings: &found.recordings,
            judgements: &found.judgements,
            visibility: &found.visibility,
            unusable: &found.unusable,
        }
    }
}

/// The shaft of every recording and of all together.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ShaftFacts<'a> {
    recordings: &'a [ShaftRecording],
    together: &'a Option<Together>,
}

impl<'a> ShaftFacts<'a> {
    /// Of an analysis.
    pub fn of(found: &'a ShaftAnalysis) -> Self {
        ShaftFacts { recordings: &found.recordings, together: &found.together }
    }
}

/// Friction and inertia of the dynamometer, without the run-outs' samples.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FrictionFacts<'a> {
    inertia: &'a Inertia,
    friction: &'a Estimate,
    per_inertia: &'a Estimate,
    candidates: &'a [Candidate],
    curve: &'a [CurvePoint],
    used: Vec<RunOutFacts<'a>>,
}

impl<'a> FrictionFacts<'a> {
    /// Of an estimate.
    pub fn of(found: &'a Friction) -> Self {
        FrictionFacts {
            inertia: &found.inertia,
            friction: &found.friction,
            per_inertia: &found.per_inertia,
            candidates: &found.candidates,
            curve: &found.curve,
            used: found.run_outs.iter().map(RunOutFacts::of).collect(),
        }
    }
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct RunOutFacts<'a> {
    stretch: &'a Stretch,
    torque: &'a Option<TorqueUsed>,
    left_out: usize,
}

impl<'a> RunOutFacts<'a> {
    fn of(one: &'a RunOut) -> Self {
        RunOutFacts { stretch: &one.stretch, torque: &one.torque, left_out: one.left_out }
    }
}
