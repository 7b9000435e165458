//! A result as Python gets it: its numbers, its page, and the whole of it as a document.

use std::path::PathBuf;

use bench_model::document::ResultFormat;
use dynoid::{Error, Files, Mark, check_file, pages, replace_file};
use page::{Page, Screen};
use pyo3::prelude::*;
use serde::Serialize;

use crate::errors::Fault;

/// The maker that results name.
const MAKER: &str = "python";
/// A text for a notebook or a Python prompt.
const SCREEN: Screen = Screen { width: 100, colour: false, is_narrow: false };

/// The files of one call.
pub(crate) fn files(overwrite: bool) -> Files {
    Files::new(MAKER, overwrite)
}

/// A result: its numbers and its page.
#[pyclass(frozen, module = "dynoid._dynoid")]
#[derive(Debug)]
pub(crate) struct Made {
    facts: String,
    document: Option<String>,
    notes: Vec<String>,
    is_yes: Option<bool>,
    shown: Shown,
}

/// The page, or, of a result that another process made, what it looks like.
#[derive(Debug)]
enum Shown {
    Page(Box<Page>),
    Texts { text: String, markdown: String, html: String },
}

impl Made {
    /// A result with its numbers and its page.
    pub(crate) fn new(facts: &impl Serialize, page: Page) -> Result<Self, Error> {
        let facts = serde_json::to_string(facts).map_err(Error::internal)?;
        Ok(Made { facts, document: None, notes: Vec::new(), is_yes: None, shown: Shown::Page(Box::new(page)) })
    }

    /// A result of which the library has a document, too.
    pub(crate) fn whole<T: Serialize>(
        facts: &impl Serialize,
        page: Page,
        format: &ResultFormat<T>,
        found: &T,
    ) -> Result<Self, Error> {
        Ok(Self::new(facts, page)?.with_document(format.json(found).map_err(Error::internal)?))
    }

    /// The same with all of it as JSON, which the library reads back.
    pub(crate) fn with_document(self, document: String) -> Self {
        Made { document: Some(document), ..self }
    }

    /// The same with what should be known of it.
    pub(crate) fn with_notes(self, notes: impl IntoIterator<Item = String>) -> Self {
        Made { notes: notes.into_iter().collect(), ..self }
    }

    /// The same with the answer to what was asked.
    pub(crate) fn with_answer(self, is_yes: bool) -> Self {
        Made { is_yes: Some(is_yes), ..self }
    }
}

#[pymethods]
impl Made {
    /// The numbers, as JSON.
    #[getter]
    fn facts(&self) -> &str {
        &self.facts
    }

    /// All of the result as JSON, where there is more than the numbers.
    #[getter]
    fn document(&self) -> Option<&str> {
        self.document.as_deref()
    }

    /// Notes that should be known of it, in words.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// The answer to what was asked; none where nothing was.
    #[getter]
    fn is_yes(&self) -> Option<bool> {
        self.is_yes
    }

    /// The page as text.
    fn text(&self) -> String {
        match &self.shown {
            Shown::Page(page) => page::terminal(page, SCREEN),
            Shown::Texts { text, .. } => text.clone(),
        }
    }

    /// The page as Markdown.
    fn markdown(&self) -> String {
        match &self.shown {
            Shown::Page(page) => page::markdown(page),
            Shown::Texts { markdown, .. } => markdown.clone(),
        }
    }

    /// The page for a browser, with its figures.
    fn html(&self) -> String {
        match &self.shown {
            Shown::Page(page) => pages::html(page, &files(false)),
            Shown::Texts { html, .. } => html.clone(),
        }
    }

    /// Figures of the page, as one SVG.
    fn svg(&self) -> Result<String, Fault> {
        match &self.shown {
            Shown::Page(page) => Ok(page::svg(page.figures())),
            Shown::Texts { .. } => Err(of_another_process()),
        }
    }

    /// Writes the page, or its figures, as the ending asks for.
    fn save(&self, path: PathBuf, overwrite: bool) -> Result<(), Fault> {
        let files = files(overwrite);
        pages::check_page(&path, &files)?;
        match &self.shown {
            Shown::Page(page) => {
                pages::write_page(&path, page, &files)?;
            }
            Shown::Texts { html, .. } if is_browsers(&path) => {
                check_file(&path, &Mark::of_run(&files), &files)?;
                replace_file(&path, html.as_bytes(), &files)?;
            }
            Shown::Texts { .. } => return Err(of_another_process()),
        }
        Ok(())
    }

    fn __copy__(slf: Bound<'_, Self>) -> Bound<'_, Self> {
        slf
    }

    fn __deepcopy__<'py>(slf: Bound<'py, Self>, _memo: &Bound<'py, PyAny>) -> Bound<'py, Self> {
        slf
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let own = slf.get();
        let state = (
            own.facts.as_str(),
            own.document.as_deref(),
            own.notes.clone(),
            own.is_yes,
            (own.text(), own.markdown(), own.html()),
        );
        (slf.get_type().getattr("_restored")?, state).into_pyobject(slf.py()).map(Bound::into_any)
    }

    #[staticmethod]
    fn _restored(
        facts: String,
        document: Option<String>,
        notes: Vec<String>,
        is_yes: Option<bool>,
        texts: (String, String, String),
    ) -> Self {
        let (text, markdown, html) = texts;
        Made { facts, document, notes, is_yes, shown: Shown::Texts { text, markdown, html } }
    }
}

fn is_browsers(path: &std::path::Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("html") || ending.eq_ignore_ascii_case("htm"))
}

fn of_another_process() -> Fault {
    Fault::argument(
        "this result was pickled, and a pickle has its page as HTML only; write PDF, SVG and PNG where it was made",
    )
}
