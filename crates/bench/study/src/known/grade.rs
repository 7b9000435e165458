//! Grades, and the widths of intervals that they are given by.

use serde::Serialize;

/// Widest intervals, to either side, as parts of the value.
pub const WIDTHS: Widths = Widths { well: 0.05, roughly: 0.20 };
/// The same of a time, as parts of the fastest sample time of the recordings.
pub const TIME_WIDTHS: Widths = Widths { well: 0.1, roughly: 0.5 };
/// Friction known to within this is known well, however little there is of it, Nm.
pub const FRICTION_NM: f64 = 1.0;

/// Widest interval, to either side, of what is known well, and of what is known roughly.
#[derive(Debug, Clone, Copy)]
pub struct Widths {
    /// Of what is known well.
    pub well: f64,
    /// Of what is known roughly.
    pub roughly: f64,
}

/// How well something is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Grade {
    /// Well.
    Well,
    /// Roughly.
    Roughly,
    /// Poorly.
    Poorly,
    /// Stated in the bench file; no recording says whether it is true.
    OnTrust,
    /// Not at all.
    NotAtAll,
}

impl Grade {
    /// All of them, the best first.
    pub const ALL: [Grade; 5] = [Grade::Well, Grade::Roughly, Grade::Poorly, Grade::OnTrust, Grade::NotAtAll];

    /// Grade that is left when something else contradicts it.
    pub(super) fn contradicted(self) -> Grade {
        match self {
            Grade::Well => Grade::Roughly,
            Grade::Roughly => Grade::Poorly,
            other => other,
        }
    }

    /// By an interval, and the widths that are well and roughly.
    pub(super) fn of_width(width: f64, widest: Widths) -> Grade {
        match width {
            w if w <= widest.well => Grade::Well,
            w if w <= widest.roughly => Grade::Roughly,
            _ => Grade::Poorly,
        }
    }
}
