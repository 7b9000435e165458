//! Demands of a test.

use cycle::{EngineMap, Reference};
use rig::experiment::{Demands, ExperimentPlan};

/// A test.
#[derive(Debug, Clone, Copy)]
pub enum Demand<'a> {
    /// A cycle, in speed control of the dynamometer and torque control of the engine.
    Cycle(CycleDemand<'a>),
    /// A plan with its demands at every millisecond.
    Plan(&'a ExperimentPlan, &'a Demands),
}

/// A cycle, and the engine that runs it.
#[derive(Debug, Clone, Copy)]
pub struct CycleDemand<'a> {
    /// Speeds and torques.
    pub reference: &'a Reference,
    /// Map of what the engine can give; without one, it gives all that is demanded.
    pub map: Option<&'a EngineMap>,
}

impl Demand<'_> {
    /// How long it lasts, s.
    pub fn duration_s(&self) -> f64 {
        match self {
            Demand::Cycle(cycle) => cycle.reference.end_s() - cycle.reference.start_s,
            Demand::Plan(plan, _) => plan.duration_s,
        }
    }

    /// Tells whether dynamometer and engine are connected.
    pub fn has_shaft(&self) -> bool {
        match self {
            Demand::Cycle(_) => true,
            Demand::Plan(plan, _) => plan.has_shaft,
        }
    }
}
