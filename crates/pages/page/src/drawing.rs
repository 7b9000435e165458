//! How SVG is read: with the fonts that are built in, and without a look at any file.

use std::sync::Arc;

use resvg::usvg::{self, fontdb};

/// Options for a drawing of our own or from outside.
pub(crate) fn options() -> usvg::Options<'static> {
    let mut options = usvg::Options { font_family: crate::svg::FONT.to_owned(), ..Default::default() };
    for font in [dejavu::sans::regular(), dejavu::sans::bold()] {
        options.fontdb_mut().load_font_source(fontdb::Source::Binary(Arc::new(font)));
    }
    options.image_href_resolver.resolve_string = Box::new(|_, _| None);
    options
}
