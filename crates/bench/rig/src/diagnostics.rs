//! Doubts about data that can be used: structured findings, each with its place. Their wording belongs to the report.

use recording::RecordingError;
use serde::{Deserialize, Serialize};

use crate::Role;
use crate::experiment::ExperimentLabel;
use crate::results::{Part, Quantity, Reason, read_symbol, write_quantity, write_symbol};
use crate::words::InWords;

/// How much a finding matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Worth knowing; nothing to do.
    Note,
    /// A result is weaker than it could be.
    Warning,
    /// Something was left out, or a result must not be used.
    Error,
}

/// Share of the samples below which a finding costs no estimate anything that a user would see.
const FEW: f64 = 0.01;

impl Severity {
    /// Of what concerns this part of the samples.
    pub(crate) fn of_share(share: f64) -> Self {
        if share < FEW { Severity::Note } else { Severity::Warning }
    }
}

/// Where a finding was made; what does not apply is `None`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Place {
    /// File, as the user knows it.
    pub file: Option<String>,
    /// Channel by its source name.
    pub channel: Option<String>,
    /// Time in the recording, s.
    pub time_s: Option<f64>,
}

/// One doubt about the data or a result.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Diagnostic {
    /// How much it matters.
    pub severity: Severity,
    /// Where it is.
    pub place: Place,
    /// The finding.
    pub finding: Finding,
}

/// Units that a torque with a wrong gain may hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum LikelyUnit {
    /// Per cent of the drive's torque limit.
    PercentOfLimit,
    /// lbf ft, labelled Nm.
    PoundFoot,
    /// kNm, labelled Nm.
    KiloNewtonMetre,
}

/// Content of a recording that its label excludes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "seen", rename_all = "snake_case")]
pub enum SeenInstead {
    /// T_d* answers to every change of N_d: the dynamometer controls speed.
    SpeedControl,
    /// T_d* rests from sample to sample while N_d changes: the dynamometer controls torque.
    TorqueControl,
    /// The engine turns as the dynamometer does: the shaft is on.
    ShaftOn,
    /// T_d moves an inertia that is so many times J_d.
    LargerInertia {
        /// The ratio.
        ratio: f64,
    },
    /// N_d* changes where the torque should be excited at a constant speed.
    SpeedDemandChanges,
}

/// Why a recording could not be replayed on a model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum NotReplayed {
    /// The recording or the model lacks something.
    Lacks(Reason),
    /// The demand is on another clock than the controller.
    Clock {
        /// Sample time of the demand, s.
        demand_s: f64,
        /// Sample time of the controller, s.
        controller_s: f64,
    },
    /// The model cannot be simulated at the recording's sample time.
    NotSimulated,
}

/// Kinds of findings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Finding {
    /// The recording could not be decoded.
    UnreadableRecording {
        /// The reader's error; it serialises as its words.
        #[serde(rename = "reason")]
        error: InWords<RecordingError>,
    },
    /// The reader returned data, with a reservation.
    ReaderDoubt {
        /// The reader's finding; it serialises as its words.
        #[serde(rename = "reason")]
        doubt: InWords<recording::Finding>,
    },
    /// Neither file name nor bench file gives the experiment's label.
    NoLabel,
    /// Two recordings have the same file name or the same content.
    DuplicateRecording {
        /// The other one.
        other: String,
    },
    /// A channel the bench file names is not in the recording.
    MissingChannel {
        /// Its role.
        role: Role,
        /// Channels of the recording with the closest names.
        closest: Vec<String>,
    },
    /// A unit is unknown or belongs to another quantity than the role's.
    UnfitUnit {
        /// The role.
        role: Role,
        /// The unit found.
        unit: String,
    },
    /// Samples that are NaN or infinite.
    NotANumber {
        /// How many.
        count: usize,
        /// True where they were few enough to be interpolated.
        mended: bool,
    },
    /// A slow channel was held or interpolated up to a faster raster; only its own samples are used.
    SamplesRaised {
        /// It has a value of its own every so many samples.
        every: usize,
        /// True where the others lie on straight lines between these, rather than repeat the one before.
        interpolated: bool,
    },
    /// Samples repeat the one before at irregular instants; they are left out.
    SamplesRepeated {
        /// Their share, 0…1.
        share: f64,
        /// How long the longest run of them lasts, s.
        longest_s: f64,
    },
    /// Samples lie on straight lines between instants that are no samples: their own values are lost.
    SamplesStraightened {
        /// Their share, 0…1.
        share: f64,
    },
    /// Single samples far beside those about them; they are left out.
    Spikes {
        /// How many.
        count: usize,
        /// The farthest value in SI.
        farthest: f64,
    },
    /// The noise of a signal is not white, as behind a low-pass filter or a moving mean.
    SamplesFiltered {
        /// Its least power over that at other frequencies.
        ratio: f64,
    },
    /// N_d is smoother than what the speed controller answers to, as behind a mean or a filter.
    SpeedSmoothed {
        /// The mean that would do the same, s.
        mean_s: f64,
        /// Sample time of N_d, s.
        sample_time_s: f64,
    },
    /// Time stamps are missing for a while.
    Gap {
        /// Length, s.
        duration_s: f64,
        /// True where the gap was short enough to be interpolated.
        mended: bool,
    },
    /// Several short gaps, all interpolated.
    ShortGaps {
        /// How many.
        count: usize,
        /// Length of the longest, s.
        longest_s: f64,
        /// Share of the samples that were missing, 0…1.
        share: f64,
    },
    /// Gaps too long to be interpolated: only one stretch of the recording is used.
    Cut {
        /// Start and end of the stretch that is used, s.
        kept_s: (f64, f64),
        /// How much of the recording is not used, s.
        lost_s: f64,
    },
    /// Stretches that the bench file leaves out.
    LeftOut {
        /// Start and end of each, s.
        stretches_s: Vec<(f64, f64)>,
        /// Start and end of the uninterrupted part that is used, s.
        used_s: (f64, f64),
        /// How much of the recording is not used beside them, since it is no part of that, s.
        unused_s: f64,
    },
    /// A stretch of the bench file holds no sample of its recording.
    StretchOutside {
        /// Its beginning, s.
        from_s: f64,
        /// Its end, s.
        to_s: f64,
        /// Time of the first and last sample of the recording, s.
        recorded_s: (f64, f64),
    },
    /// The bench file states a stretch of a recording that is not there.
    StretchOfNoRecording,
    /// Time stamps go backwards or repeat.
    TimeNotIncreasing,
    /// Time stamps come in bursts, far closer to each other than one comes on average.
    Bursts {
        /// Time between stamps of a burst, s.
        sample_time_s: f64,
        /// Time between stamps on average, s.
        mean_s: f64,
    },
    /// Time stamps jitter by more than a tenth of the sample time.
    Jitter {
        /// Largest deviation from a uniform clock, s.
        largest_s: f64,
        /// Sample time, s.
        sample_time_s: f64,
    },
    /// N_d is recorded more slowly than a controller acts.
    SlowRaster {
        /// Its sample time, s.
        sample_time_s: f64,
        /// True where it is so long that the time stamps seem to be in ms.
        is_in_ms: bool,
    },
    /// The time stamps of a raster begin and end equally far from those of another.
    ClockOffset {
        /// A channel of the other raster.
        against: String,
        /// How much later they are, s.
        offset_s: f64,
    },
    /// The clock of a raster runs apart from that of another.
    ClockDrift {
        /// A channel of the other raster.
        against: String,
        /// How much later the channel becomes against it, s each second.
        rate: f64,
        /// Standard error of the rate.
        standard_error: f64,
        /// Difference that the drift makes over the recording, s.
        apart_s: f64,
    },
    /// The signal never changes although its role says it should.
    Constant {
        /// Its value in SI.
        value: f64,
    },
    /// The signal rests at its largest or smallest value.
    Clipped {
        /// Value in SI.
        value: f64,
        /// Share of the samples, 0…1.
        share: f64,
    },
    /// The values are larger than the role and the unit allow.
    ImplausibleMagnitude {
        /// The role.
        role: Role,
        /// Largest magnitude in SI.
        largest: f64,
        /// The unit the values seem to have, if one explains them.
        looks_like: Option<String>,
    },
    /// A speed that should have the dynamometer speed's mean has another: wrong unit, wrong channel, or a gear between.
    SpeedsDisagree {
        /// The speed that is compared with the dynamometer's.
        role: Role,
        /// Its mean over that of the dynamometer speed. 9.55 or 0.105 betrays rpm against rad/s.
        ratio_to_dyno_speed: f64,
    },
    /// Two torques of the dynamometer that should be equal but for noise and delay are not: a wrong unit, channel, gain
    /// or zero.
    TorquesDisagree {
        /// The torque that is compared with T_d,calc.
        role: Role,
        /// Its changes over those of T_d,calc.
        gain: f64,
        /// Its excess over the gain times T_d,calc, Nm.
        offset_nm: f64,
        /// Which of both has values in what other unit, if that explains the gain.
        looks_like: Option<(Role, LikelyUnit)>,
    },
    /// The recording is not what its label says.
    LabelContradicted {
        /// The label.
        label: ExperimentLabel,
        /// Evidence against the label.
        seen: SeenInstead,
    },
    /// The orders of the engine's speed are those of another number of cylinders or strokes.
    FiringOrderDisagrees {
        /// Firings a turn by the bench file.
        stated: f64,
        /// Firings a turn that the speeds show.
        found: f64,
    },
    /// The engine's pulses come more or less often than its speed and the time stamps say.
    PulsesOffSpeed {
        /// Pulses over those expected.
        ratio: f64,
    },
    /// The engine's pulses are stronger or weaker in N_d, beside N_e, than the shaft lets them through.
    PulsesOffShaft {
        /// Frequency of the pulses, Hz.
        frequency_hz: f64,
        /// Their strength in N_d over that in N_e, as a part of what K, B and J_d make of it.
        ratio: f64,
    },
    /// The ripple of the drive is beside twice the mains: the clock of the recording is wrong.
    ClockRate {
        /// Where the ripple is, Hz.
        found_hz: f64,
        /// Twice the mains, Hz.
        mains_hz: f64,
    },
    /// The shaft's equation dates a signal far from where its time stamps do.
    LateSignal {
        /// Its role.
        role: Role,
        /// By how much it is late against N_d, s; negative where it is early.
        late_s: f64,
        /// Standard error, s.
        standard_error_s: f64,
    },
    /// The equation of the shaft holds far better with N_d and N_e exchanged: their channels are mixed up.
    SpeedsExchanged {
        /// Mean of |error|²/σ² as the speeds are named, over that with them exchanged.
        misfit_ratio: f64,
    },
    /// The channels of T_d* and T_d,calc are exchanged: what is named T_d,calc is held, and what is named T_d* follows
    /// it.
    TorquesExchanged {
        /// The channel that is named T_d*.
        demand: String,
        /// The channel that is named T_d,calc.
        torque: String,
        /// By how much the first is later than the second, s.
        later_s: f64,
    },
    /// The recording is shorter than the estimate needs.
    TooShort {
        /// Its length, s.
        duration_s: f64,
        /// Length needed, s.
        needed_s: f64,
    },
    /// T_d brakes with a negative sign, against the convention.
    WrongTorqueSign {
        /// Correlation of T_d with −dω_d/dt at frequencies where inertia dominates, or with ω_d under speed control.
        correlation: f64,
    },
    /// The inertia in the bench file does not fit the measured torque and acceleration.
    ImplausibleInertia {
        /// Which: J_d or J_e.
        #[cfg_attr(feature = "schema", schemars(with = "crate::quantity::Symbol<'static>"))]
        #[serde(flatten, serialize_with = "write_symbol", deserialize_with = "read_symbol")]
        inertia: Quantity,
        /// Value in the bench file, kg m².
        given_kg_m2: f64,
        /// Estimate from the data, kg m².
        estimated_kg_m2: f64,
        /// Standard error, kg m².
        standard_error_kg_m2: f64,
    },
    /// A recording would give the bench an inertia or a skew that it cannot have, so that its K and B check nothing.
    NoCheckOfShaft {
        /// Which: J_d or a skew.
        #[cfg_attr(feature = "schema", schemars(with = "crate::quantity::Symbol<'static>"))]
        #[serde(flatten, serialize_with = "write_symbol", deserialize_with = "read_symbol")]
        quantity: Quantity,
        /// Value from the recording alone, SI.
        value: f64,
        /// Standard error, SI.
        standard_error: f64,
    },
    /// Torque or demand is at the drive's limit; these stretches are left out of the estimates.
    Saturated {
        /// Share of the samples, 0…1.
        share: f64,
        /// The limit, Nm.
        limit_nm: f64,
    },
    /// A signal is dated before the demand that it follows: the clocks of their rasters are apart.
    EarlySignal {
        /// Its role.
        role: Role,
        /// By how much it is early, s.
        advance_s: f64,
    },
    /// Narrow bands of frequency were left out because the model does not hold there.
    ExcludedLines {
        /// Centre frequencies, Hz.
        frequencies_hz: Vec<f64>,
    },
    /// Recordings that a virtual bench made.
    Simulated {
        /// They.
        files: Vec<String>,
        /// True where other recordings were measured.
        beside_measured: bool,
    },
    /// A multiple of the firing frequency is one of a speed's sample rate: the engine's pulses fold onto slow changes
    /// of their own strength.
    PulsesFoldToRest {
        /// Which speed.
        role: Role,
        /// Its sample rate, Hz.
        rate_hz: f64,
        /// Mean firing frequency, Hz.
        firing_hz: f64,
        /// The lowest such multiple of the firing frequency.
        multiple: u32,
    },
    /// The residuals of a submodel are correlated with its input beyond the 99 % region.
    ResidualsCorrelated {
        /// Which submodel.
        submodel: Part,
        /// Share of the lags outside, 0…1.
        share_outside: f64,
    },
    /// A fit did not converge.
    NotConverged {
        /// Which submodel.
        submodel: Part,
    },
    /// A signal is recorded in steps so coarse that part of an estimate had to be assumed.
    CoarseResolution {
        /// Its role.
        role: Role,
        /// The step in SI.
        step: f64,
    },
    /// A recording could not be replayed on the model.
    NotReplayed {
        /// Why.
        reason: NotReplayed,
    },
    /// Two routes to one number disagree by more than their uncertainty allows.
    RoutesDisagree {
        /// Quantity that was estimated twice.
        #[cfg_attr(feature = "schema", schemars(with = "crate::quantity::SymbolAsQuantity"))]
        #[serde(flatten, serialize_with = "write_quantity", deserialize_with = "read_symbol")]
        quantity: Quantity,
        /// First value and standard error, SI.
        first: (f64, f64),
        /// Second value and standard error, SI.
        second: (f64, f64),
    },
}
