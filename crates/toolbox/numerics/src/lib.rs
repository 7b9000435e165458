#![doc = include_str!("../README.md")]

pub mod linalg;
pub mod null;
pub mod order;
pub mod parallel;
pub mod random;
pub mod search;
pub mod sliding_median;
pub mod vector;
