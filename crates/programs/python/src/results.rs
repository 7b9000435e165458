//! Results as Python has them: dataclasses of `dynoid.results`, and plain data.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::Serialize;

use crate::errors::Fault;

/// Data as dictionaries, lists and numbers.
pub(crate) fn to_python<'py>(py: Python<'py>, data: &impl Serialize) -> PyResult<Bound<'py, PyAny>> {
    let text = serde_json::to_string(data).map_err(|error| Fault::argument(error.to_string()))?;
    py.import("json")?.call_method1("loads", (text,))
}

/// A result of this class of `dynoid.results`, with its fields.
pub(crate) fn result<'py>(py: Python<'py>, class: &str, fields: &Bound<'py, PyDict>) -> PyResult<Bound<'py, PyAny>> {
    py.import("dynoid.results")?.getattr(class)?.call((), Some(fields))
}

/// Fields of a result by their names.
macro_rules! fields {
    ($py:expr, $($name:ident: $value:expr),+ $(,)?) => {{
        let fields = pyo3::types::PyDict::new($py);
        $(fields.set_item(stringify!($name), $value)?;)+
        fields
    }};
}
pub(crate) use fields;
