//! Scale of the torques in words.

use study::Study;

use super::number::plus_minus;

/// Effect of a wrong scale of all torques, and how large it may be. It is no part of the intervals.
pub fn torque_scale(study: &Study) -> String {
    let size = match study::torque_scale(study) {
        Some(scale) => format!(
            "By J_d they are {} times the true torques; no other interval contains that.",
            plus_minus(scale.factor, scale.half_width, "")
        ),
        None => "No recording shows that scale, and no interval contains it.".to_owned(),
    };
    format!("K, B, the inertias and the gains of the speed control have the scale of the recorded torques. {size}")
}
