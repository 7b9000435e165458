//! Recordings replayed on the assembled model (thesis §7.3).

mod compare;
mod encoder_error;
mod error;
mod initial;
mod inputs;
mod once_a_turn;
mod reconstruct;
mod result;
mod run;

use rig::Experiment;
use rig::results::Stretch;

use crate::model::BenchModel;
pub use encoder_error::{EncoderError, encoder_error};
pub use error::ReplayError;
pub use inputs::ReplayInputs;
use reconstruct::reconstruct;
pub use result::Replay;
use run::Run;

/// Replays a recording: simulates the model under the demands that were given and the engine torque that acted, and
/// compares N_d, N_e, T_d, T_shaft and, in speed control, T_d* with what was recorded.
///
/// The engine torque is reconstructed, T_e = J_e dω_e/dt + T_shaft with T_shaft = J_d dω_d/dt + T_d, by zero-phase
/// means. It holds N_d and N_e themselves, so agreement of the speeds is partly built in; what is tested is the shaft
/// between them, the controller, and the torque control.
///
/// Speed control: ω_d, ω_e, Δθ and the integrator at the start are refined by least squares on the speeds of the first
/// ten seconds. Torque control: nothing holds the speed, so the smallest error of the mean torque grows into a drift;
/// ω_d, ω_e, Δθ at the start and a constant error of T_e are fitted to the speeds of the whole stretch. A linear drift
/// of the speeds is therefore no test of the model in torque control. Torque control is driven by T_d* where the model
/// has a torque control, else by T_d.
///
/// The ripple of the drive is a known disturbance: its amplitudes, phases and frequencies are taken from the
/// recording's own T_d,calc, not predicted, while the torque it is relative to is the modelled one; N_d and T_shaft
/// answer it. So the comparison of T_d says how well controller and torque control are modelled, and nothing of how
/// well ripple can be foretold.
///
/// The engine's encoder has a once-a-turn error too, which makes a torque appear in T_e that never was; near the
/// resonance it would drown all else. Its two amplitudes are fitted with the start, so at order 1 of the speed
/// agreement is partly built in.
///
/// T_d* is taken to stand on the clock of N_d; the torque control's delay, which was estimated on the clock of
/// T_d,calc, is corrected by what that is late.
///
/// # Errors
/// N_d, N_e, T_d or the demand is missing; less than a second is common to all; the model lacks the speed controller or
/// torque control that speed control needs.
pub fn replay(experiment: &Experiment, model: &BenchModel, inputs: &ReplayInputs<'_>) -> Result<Replay, ReplayError> {
    let acted = reconstruct(experiment, model, inputs)?;
    let run = Run::new(experiment, model, inputs, acted)?;
    let start = run.fitted_start()?;
    let response = run.simulate(&start)?;
    let (acted, comparison) = (&run.acted, run.comparison(&start));
    Ok(Replay {
        stretch: Stretch { file: experiment.file.clone(), start_s: acted.start_s, end_s: acted.end_s() },
        label: experiment.label.clone(),
        mode: experiment.label.mode,
        seen_in_estimation: inputs.seen_in_estimation,
        signals: comparison.all(response)?,
    })
}
