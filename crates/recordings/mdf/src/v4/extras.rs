//! Attachments and events.

use super::block::Walk;
use super::channel::quantity;
use crate::bytes::{array, f64_at, u8_at, u64_at};
use crate::model::{Attachment, Event};
use crate::{MdfError, Source};

impl<S: Source + ?Sized> Walk<'_, S> {
    pub(super) fn attachments(&mut self, first: u64) -> Result<Vec<Attachment>, MdfError> {
        let mut attachments = Vec::new();
        let mut next = first;
        while next != 0 {
            let block = self.own_block(next, &[b"##AT"])?;
            attachments.push(Attachment {
                file_name: self.text(block.link(1))?,
                mime_type: self.text(block.link(2))?,
                comment: self.text(block.link(3))?,
                embedded_bytes: u64_at(block.data(), 32),
            });
            next = block.link(0);
        }
        Ok(attachments)
    }

    pub(super) fn events(&mut self, first: u64) -> Result<Vec<Event>, MdfError> {
        let mut events = Vec::new();
        let mut next = first;
        while next != 0 {
            let block = self.own_block(next, &[b"##EV"])?;
            let data = block.data();
            let count = i64::from_le_bytes(array(data, 16));
            events.push(Event {
                name: self.text(block.link(3))?,
                comment: self.text(block.link(4))?,
                kind: u8_at(data, 0),
                quantity: quantity(u8_at(data, 1)),
                at: count as f64 * f64_at(data, 24),
            });
            next = block.link(0);
        }
        Ok(events)
    }
}
