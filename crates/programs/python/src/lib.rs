#![doc = include_str!("../README.md")]
#![warn(missing_docs)]

mod arrays;
mod compare;
mod dataset;
mod errors;
mod estimators;
mod fit;
mod interrupt;
mod program;
mod recording;
mod results;
mod study;

/// Compiled part of the package `dynoid`, which says what its parts are for.
#[pyo3::pymodule]
mod _dynoid {
    #[pymodule_export]
    use crate::compare::compare;
    #[pymodule_export]
    use crate::dataset::{Dataset, dataset};
    #[pymodule_export]
    use crate::estimators::{arx, grey_box, polynomial, process, state_space, subspace, transfer_function};
    #[pymodule_export]
    use crate::fit::Fit;
    #[pymodule_export]
    use crate::program::program;
    #[pymodule_export]
    use crate::recording::{Recording, read};
    #[pymodule_export]
    use crate::study::study;
}
