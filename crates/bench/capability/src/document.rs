//! The documents of verdicts and maps, and of the statistics of a cycle that was run.

use bench_model::document::ResultFormat;
use cycle::Validation;

use crate::Verdict;
use crate::easier::Easier;
use crate::gradient::GradientPlace;
use crate::map::CapabilityMap;
use crate::wanted::WantedAnswer;

/// Answer to whether a bench can run a test.
pub const VERDICT: ResultFormat<Verdict> = ResultFormat::new("dynoid-verdict", 1);
/// Changes with which it can.
pub const EASIER: ResultFormat<Vec<Easier>> = ResultFormat::new("dynoid-easier", 1);
/// The largest sines.
pub const MAP: ResultFormat<CapabilityMap> = ResultFormat::new("dynoid-capability-map", 1);
/// The largest gradients of the speed.
pub const GRADIENTS: ResultFormat<Vec<GradientPlace>> = ResultFormat::new("dynoid-gradients", 1);
/// The answer to a wish.
pub const WANTED: ResultFormat<WantedAnswer> = ResultFormat::new("dynoid-wanted", 1);
/// How a run of a cycle is judged.
pub const VALIDATION: ResultFormat<Validation> = ResultFormat::new("dynoid-cycle-validation", 1);
