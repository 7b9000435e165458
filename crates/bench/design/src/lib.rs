//! Experiments before they are run: excitations designed for what is to be learnt, and how probably limits are reached.

pub mod excitation_design;
pub mod safety;
