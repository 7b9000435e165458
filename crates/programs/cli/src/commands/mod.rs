//! The commands, one module each.

#[cfg(feature = "app")]
pub(crate) mod app;
pub(crate) mod can;
pub(crate) mod controller;
pub(crate) mod convert;
pub(crate) mod demo;
pub(crate) mod diff;
pub(crate) mod engine;
pub(crate) mod experiment;
mod experiments;
pub(crate) mod export;
pub(crate) mod friction;
pub(crate) mod identify;
pub(crate) mod init;
pub(crate) mod inspect;
pub(crate) mod lines;
pub(crate) mod report;
mod result;
pub(crate) mod schema;
pub(crate) mod shaft;
pub(crate) mod shell;
pub(crate) mod study;
pub(crate) mod torque_control;
pub(crate) mod torque_signals;
