//! The commands, one module each.

pub(crate) mod convert;
pub(crate) mod demo;
pub(crate) mod experiment;
pub(crate) mod identify;
pub(crate) mod init;
pub(crate) mod inspect;
pub(crate) mod look;
pub(crate) mod simulate;
pub(crate) mod study;
