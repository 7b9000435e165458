#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod arrays;
mod bench;
mod compare;
mod content;
mod dataset;
mod errors;
mod estimators;
mod explore;
mod fit;
mod interrupt;
mod made;
mod models;
mod program;
mod recording;
mod recursive;
mod results;
mod studied;
mod tried;

/// Compiled part of the package `dynoid`, which says what its parts are for.
#[pyo3::pymodule]
mod _dynoid {
    #[pymodule_export]
    use crate::bench::Bench;
    #[pymodule_export]
    use crate::compare::compare;
    #[pymodule_export]
    use crate::dataset::{Dataset, dataset};
    #[pymodule_export]
    use crate::estimators::{arx, grey_box, polynomial, process, state_space, subspace, transfer_function};
    #[pymodule_export]
    use crate::explore::{delays, orders, spectra};
    #[pymodule_export]
    use crate::fit::Fit;
    #[pymodule_export]
    use crate::made::Made;
    #[pymodule_export]
    use crate::models::{difference, export};
    #[pymodule_export]
    use crate::program::program;
    #[pymodule_export]
    use crate::recording::{Recording, read};
    #[pymodule_export]
    use crate::recursive::recursive;
    #[pymodule_export]
    use crate::studied::read_study;
    #[pymodule_export]
    use crate::tried::{can, capability, check, design, judge, simulate};
}
