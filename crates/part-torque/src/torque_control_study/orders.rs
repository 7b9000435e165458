//! The orders that black boxes are tried with.

/// Which orders are tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OrdersTried {
    /// Poles and coefficients of B: from one to this many.
    pub highest: usize,
    /// Delays: from none to this many samples.
    pub longest_delay: usize,
}

impl Default for OrdersTried {
    fn default() -> Self {
        OrdersTried { highest: 6, longest_delay: 4 }
    }
}
