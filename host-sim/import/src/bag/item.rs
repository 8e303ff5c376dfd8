//! A message as every container of bags holds it.

use std::borrow::Cow;
use std::io::Read;

use super::messages::Encoding;
#[cfg(not(target_family = "wasm"))]
use super::messages::{full_name, is_relevant};

/// An encoded message.
pub struct Item<'a> {
    /// Topic.
    pub topic: &'a str,
    /// Name of the message type, as by [`full_name`].
    pub schema: &'a str,
    /// Encoding of the content.
    pub wire: Wire,
    /// Logging time, ms.
    pub log_ms: f64,
    /// Encoded content; containers may omit that of irrelevant types.
    pub data: &'a [u8],
}

/// How a message's content is encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wire {
    /// By ROS.
    Known(Encoding),
    /// Otherwise, such as JSON or protobuf.
    Foreign,
}

/// How a file ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// Complete.
    Whole,
    /// Cut off, as after a power loss.
    Truncated,
}

/// First bytes of a zstd frame.
pub const ZSTD: &[u8] = &[0x28, 0xb5, 0x2f, 0xfd];
/// Maximum size of a decompressed message, bytes.
const MAX_MESSAGE_BYTES: u64 = 1 << 26;

impl Wire {
    /// Returns the encoding with a name, as written by recorders.
    pub fn named(name: &str) -> Self {
        match name {
            "cdr" => Wire::Known(Encoding::Cdr),
            "ros1" => Wire::Known(Encoding::Ros1),
            _ => Wire::Foreign,
        }
    }
}

impl Item<'_> {
    /// Returns the content, which some recorders compress message by message; `None` if it is corrupt.
    pub fn content(&self) -> Option<Cow<'_, [u8]>> {
        if !self.data.starts_with(ZSTD) {
            return Some(Cow::Borrowed(self.data));
        }
        let decoder = zstd::Decoder::with_buffer(self.data).ok()?;
        let mut content = Vec::new();
        decoder.take(MAX_MESSAGE_BYTES).read_to_end(&mut content).ok()?;
        Some(Cow::Owned(content))
    }
}

/// Returns the type's name and whether its messages are needed.
#[cfg(not(target_family = "wasm"))]
pub fn type_name(schema: &str) -> (String, bool) {
    let name = full_name(schema);
    let is_needed = is_relevant(&name);
    (name, is_needed)
}
