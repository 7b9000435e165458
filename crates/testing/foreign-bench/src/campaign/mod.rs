//! The recordings from which a bench is identified.

mod demands;
mod recorded;

use recording::Recording;

use crate::bench::Bench;
use crate::run::run;
pub use recorded::{NAMES, recorded};

/// File names and recordings of BS_T_NT, WhiteNoise_T_TN, Levels_N_NT and Ramp_N_NT about a speed, each of a length.
pub fn campaign(bench: &Bench, speed_rad_s: f64, duration_s: f64, seed: u64) -> Vec<(String, Recording)> {
    let demands = demands::all(speed_rad_s, duration_s, seed);
    let record = |(place, (label, demand))| {
        let ran = run(bench, &demand, seed.wrapping_mul(4).wrapping_add(place));
        (format!("{label}.mf4"), recorded(bench, &demand, &ran))
    };
    (0..).zip(demands).map(record).collect()
}
