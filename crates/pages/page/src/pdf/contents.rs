//! The list of contents, with numbers of pages.

use std::rc::Rc;

use super::layout::{BODY, GAP, Layout, Place, body, bold};
use super::strip::{Area, LinkArea, Shape, Strip, keep_together};
use super::structure::Role;
use super::text::{LINE, SOFT, Style};
use crate::prose::Prose;

/// Room for a number of a page.
const NUMBER: f32 = 30.0;

impl Layout<'_> {
    /// One entry a section of the page.
    pub(super) fn contents(&mut self, sections: &[(usize, String, String)], place: Place) -> Vec<Strip> {
        let list = self.structure.node(Role::TOC, place.node);
        let label = self.structure.node(Role::P, place.node);
        let mut all = self.paragraph(&Prose::verbatim("Contents"), bold(BODY), label, place.room);
        for (heading, id, title) in sections {
            all.push(self.contents_entry(*heading, id, title, list, place));
        }
        if let Some(first) = all.first_mut() {
            first.before = 2.0 * GAP;
        }
        keep_together(&mut all);
        all
    }

    fn contents_entry(&mut self, heading: usize, id: &str, title: &str, list: usize, place: Place) -> Strip {
        let item = self.structure.node(Role::TOCI, list);
        let node = self.structure.node(Role::Link, item);
        let style = body();
        let line = self.setter.cut(title, style, place.room - NUMBER);
        let height = style.line_height();
        let mut strip = Strip { height, ..Strip::default() };
        let from = line.width + 5.0;
        let ruled = Area { x: from, y: style.base() - 0.5, width: place.room - NUMBER - from, height: 0.4 };
        if ruled.width > 0.0 {
            strip.draw(None, Shape::Fill(ruled, LINE));
        }
        self.write(&mut strip, &line, (0.0, style.base()), node, &mut Vec::new());
        let look = self.setter.fragment(String::new(), Style { colour: SOFT, ..style }, None);
        strip.draw(node, Shape::PageOf(place.room, style.base(), heading, look));
        strip.links.push(LinkArea {
            area: Area { x: 0.0, y: 0.0, width: place.room, height },
            target: Rc::from(format!("#{id}")),
            node,
            words: title.to_owned(),
        });
        strip
    }
}
