//! Kinds of errors.

use ident::IdentError;
use lti::LtiError;
use toolbox_report::convert::ConvertError;

use crate::error::Error;

/// Kind of an [`Error`]: what has to change before the same work can go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// The request.
    Request,
    /// An input, which cannot be read or understood.
    Input,
    /// The place of an output, which cannot be written.
    Output,
    /// Dynoid itself.
    Internal,
}

impl Error {
    /// Kind of the fault.
    pub fn fault(&self) -> Fault {
        match self {
            Error::Write { .. }
            | Error::InTheWay { .. }
            | Error::Occupied { .. }
            | Error::IsReadOnly { .. }
            | Error::IsDevice { .. }
            | Error::NotADemoFolder { .. }
            | Error::AmongRecordings { .. }
            | Error::OtherFmi { .. }
            | Error::OtherSource { .. }
            | Error::Encode { .. } => Fault::Output,
            Error::IsRead { .. }
            | Error::OutputEnding { .. }
            | Error::LeftOut { .. }
            | Error::ModelEnding { .. }
            | Error::PageEnding { .. }
            | Error::NotABench { .. }
            | Error::ManyFiles { .. }
            | Error::NotToml { .. }
            | Error::NothingAdded { .. }
            | Error::ChannelTwice { .. }
            | Error::RecordingTwice { .. }
            | Error::EmptyWindow { .. }
            | Error::NoOutputNamed { .. }
            | Error::OtherEnding { .. }
            | Error::FileOfLinear { .. }
            | Error::NameInside { .. }
            | Error::Catalogue { .. }
            | Error::NotDesigned { .. }
            | Error::UnknownTest { .. }
            | Error::NeedsVehicle { .. }
            | Error::NeedsEngineMap { .. }
            | Error::Cycle { .. }
            | Error::Requirement { .. }
            | Error::NoRegressions { .. }
            | Error::NothingToJudgeBy { .. }
            | Error::SpeedOfMap { .. }
            | Error::SeveralIntoOne { .. }
            | Error::FileForSeveral { .. }
            | Error::OneTarget { .. }
            | Error::NoSuchChannel { .. }
            | Error::TwoClocks { .. }
            | Error::ClockOfModel { .. }
            | Error::NothingToSimulateOn
            | Error::TrendOfMissing { .. }
            | Error::LagsOfTest { .. }
            | Error::OneRecordingFile { .. }
            | Error::TwoKinds { .. }
            | Error::NoBenchBeside { .. }
            | Error::NoLabel { .. }
            | Error::TorqueOfSeveral { .. }
            | Error::NotRebuilt { .. } => Fault::Request,
            Error::NotConverted { source } if is_of_form(source) => Fault::Request,
            Error::Internal { .. } => Fault::Internal,
            _ => Fault::Input,
        }
    }

    /// Tells whether the content of an input is the cause, so that the same may work with another input.
    pub fn is_of_input(&self) -> bool {
        self.fault() == Fault::Input || matches!(self, Error::Encode { .. })
    }
}

/// Tells whether another form or rule would convert the model.
fn is_of_form(error: &ConvertError) -> bool {
    match error {
        ConvertError::DelaysDiffer | ConvertError::WhiteNoise => true,
        ConvertError::Model(IdentError::Lti(source)) => {
            matches!(source, LtiError::FractionalDelay { .. } | LtiError::NoLogarithm { .. })
        }
        ConvertError::Model(_) => false,
    }
}
