//! The results of single analyses in numbers, as programs read them: without their long series of samples.

mod controller;
mod lines;
mod rebuilt;
mod short;
mod small;
mod written;

pub use controller::{ControllerFacts, SpeedControlFacts};
pub use lines::{LinesFacts, RecordingLinesFacts};
pub use rebuilt::{EngineFacts, TorqueSignalsFacts};
pub use short::{StudyFacts, VerdictFacts};
pub use small::{FrictionFacts, ShaftFacts, TorqueControlFacts};
pub use written::WrittenFacts;
