//! Numbers that figures share.

/// Height of a panel on the page.
pub(crate) const HEIGHT: u32 = 220;
/// Height of a panel with the course of a test.
pub(crate) const COURSE_HEIGHT: u32 = 200;
/// Half the width of a 95 % band or interval in standard deviations.
pub(crate) const BAND: f64 = 1.96;
