//! The study: everything that was learnt from a campaign of recordings, as plain data.

mod result;

pub use result::*;
