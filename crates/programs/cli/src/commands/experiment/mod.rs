//! `dynoid experiment`: what experiments there are, and what is made of one before it is run.

pub(crate) mod check;
pub(crate) mod design;
pub(crate) mod list;
pub(crate) mod next;
pub(in crate::commands) mod planned;
pub(crate) mod simulate;
