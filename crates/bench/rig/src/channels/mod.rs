//! Which channel plays which role, guessed from names, units, comments and samples.
//!
//! The guess is a proposal for a bench file, with its reasons; nothing in a study rests on it until a person has
//! accepted it there.

mod assign;
mod candidate;
mod compare;
pub(crate) mod evidence;
mod guess;
mod mapping;
mod score;
mod words;

use recording::Recording;

pub use guess::{Ambiguity, Choice, Guess, Meaning, Reason};
pub use mapping::ChannelMapping;

/// Guesses the role of the channels of a campaign's recordings, given with their files' names.
///
/// # Example
///
/// ```
/// # let text = b"time [s],N_DYNO [rpm],TQ_AIRGAP [Nm]\n0,1200,60\n0.1,1201,61\n0.2,1200,60\n";
/// # let recording = recording::decode("a.csv", text, &recording::Selection::All)?;
/// let guess = rig::channels::guess_roles(&[("a.csv", &recording)]);
/// assert_eq!(guess.choices[&rig::Role::DynoSpeed].channel, "N_DYNO");
/// # Ok::<(), recording::RecordingError>(())
/// ```
pub fn guess_roles(recordings: &[(&str, &Recording)]) -> Guess {
    assign::guess(recordings)
}
