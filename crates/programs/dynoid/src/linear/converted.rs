//! Linear models in another form.

use ident::ModelDocument;
use page::{Figure, Page};
use toolbox_report::convert::{Conversion, Converted, ZeroPoleGainFacts, convert};

use crate::error::Error;

/// A linear model in another form, or on another clock.
pub struct ConvertedModel {
    converted: Converted,
}

impl ConvertedModel {
    /// Converts a model.
    ///
    /// # Errors
    /// A model that does not have this form.
    pub fn of(document: ModelDocument, asked: &Conversion) -> Result<Self, Error> {
        let converted = convert(document, asked).map_err(|source| Error::NotConverted { source })?;
        Ok(ConvertedModel { converted })
    }

    /// The model as a model file holds it.
    ///
    /// # Errors
    /// A form that is no kind of model.
    pub fn document(&self) -> Result<ModelDocument, Error> {
        self.converted.document().map_err(|source| Error::NotConverted { source })
    }

    /// Parts that the model has lost in its file, in words.
    ///
    /// # Errors
    /// A model whose noise cannot be computed.
    pub fn lost(&self, document: &ModelDocument) -> Result<Option<&'static str>, Error> {
        self.converted.lost(document).map_err(|source| Error::NotConverted { source: source.into() })
    }

    /// Zeros, poles and gain of each channel in numbers.
    ///
    /// # Errors
    /// A model without them.
    pub fn zeros_and_poles(&self) -> Result<Vec<ZeroPoleGainFacts>, Error> {
        self.converted.zeros_and_poles().map_err(|source| Error::NotConverted { source })
    }

    /// The model as a page with this title.
    ///
    /// # Errors
    /// A model that does not have this form.
    pub fn page(&self, title: &str) -> Result<Page, Error> {
        self.converted.page(title).map_err(|source| Error::NotConverted { source })
    }

    /// Both forms over frequency.
    ///
    /// # Errors
    /// A model without a frequency response.
    pub fn figures(&self) -> Result<Vec<Figure>, Error> {
        self.converted.figures().map_err(|source| Error::NotConverted { source })
    }
}
