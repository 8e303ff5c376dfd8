//! Networks and controllers as bytes: a magic number, a version, the kind, the body, and a checksum over all of it.
//!
//! | bytes | meaning |
//! | --- | --- |
//! | 0..4 | `MGAP` |
//! | 4 | version, [`VERSION`] |
//! | 5 | kind, [`Kind`] |
//! | 6..n-4 | body in postcard's wire format |
//! | n-4..n | CRC-32 (ISO-HDLC) of all bytes before, little endian |

use crc::{CRC_32_ISO_HDLC, Crc};
use serde::{Serialize, de::DeserializeOwned};

use crate::controller::Controller;
use crate::network::Network;

/// The version that is written and the only one that is read.
pub const VERSION: u8 = 1;

const MAGIC: [u8; 4] = *b"MGAP";
const HEADER: usize = 6;
const CHECKSUM: usize = 4;

/// Something that has a binary form.
pub trait Binary: Serialize + DeserializeOwned {
    /// Its mark in the header.
    const KIND: Kind;

    /// Whether the numbers in a decoded body can be used.
    fn is_sound(&self) -> bool;

    /// Writes `self` to the front of `buffer` and returns the written part.
    ///
    /// # Errors
    /// [`BinaryError::BufferTooSmall`].
    fn to_bytes<'b>(&self, buffer: &'b mut [u8]) -> Result<&'b [u8], BinaryError> {
        let room = buffer.len().checked_sub(CHECKSUM).ok_or(BinaryError::BufferTooSmall)?;
        let (front, _) = buffer.split_at_mut_checked(room).ok_or(BinaryError::BufferTooSmall)?;
        let (header, body) = front.split_at_mut_checked(HEADER).ok_or(BinaryError::BufferTooSmall)?;
        for (to, from) in header.iter_mut().zip(MAGIC.into_iter().chain([VERSION, Self::KIND as u8])) {
            *to = from;
        }
        let end = HEADER + postcard::to_slice(self, body).map_err(|_| BinaryError::BufferTooSmall)?.len();
        let checksum = buffer.get(..end).map(checksum).ok_or(BinaryError::BufferTooSmall)?;
        let tail = buffer.get_mut(end..end + CHECKSUM).ok_or(BinaryError::BufferTooSmall)?;
        for (to, from) in tail.iter_mut().zip(checksum) {
            *to = from;
        }
        buffer.get(..end + CHECKSUM).ok_or(BinaryError::BufferTooSmall)
    }

    /// Reads what [`to_bytes`](Binary::to_bytes) wrote.
    ///
    /// # Errors
    /// A [`BinaryError`] for anything else; nothing is read past the end.
    fn from_bytes(bytes: &[u8]) -> Result<Self, BinaryError> {
        let (front, tail) = bytes
            .len()
            .checked_sub(CHECKSUM)
            .and_then(|at| bytes.split_at_checked(at))
            .ok_or(BinaryError::Truncated)?;
        let (header, body) = front.split_at_checked(HEADER).ok_or(BinaryError::Truncated)?;
        let (magic, mark) = header.split_at_checked(MAGIC.len()).ok_or(BinaryError::Truncated)?;
        if magic != MAGIC {
            return Err(BinaryError::NotOurs);
        }
        if mark.first() != Some(&VERSION) {
            return Err(BinaryError::Version);
        }
        if tail != checksum(front) {
            return Err(BinaryError::Checksum);
        }
        if mark.last() != Some(&(Self::KIND as u8)) {
            return Err(BinaryError::Kind);
        }
        let (value, rest) = postcard::take_from_bytes::<Self>(body).map_err(|_| BinaryError::Body)?;
        if rest.is_empty() && value.is_sound() { Ok(value) } else { Err(BinaryError::Body) }
    }
}

/// What a binary form holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    /// A [`Controller`].
    Controller = 1,
    /// A [`Network`] of two inputs with f32 weights (sonar).
    SonarNetwork = 2,
    /// A [`Network`] of four inputs with f32 weights (motion).
    MotionNetwork = 3,
}

/// Why bytes could not be written or read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BinaryError {
    /// The buffer does not hold the whole.
    BufferTooSmall,
    /// Too short for a header and a checksum.
    Truncated,
    /// The magic number is missing.
    NotOurs,
    /// Another version.
    Version,
    /// Bytes were changed.
    Checksum,
    /// Something else than what was asked for.
    Kind,
    /// The body does not decode to a valid value.
    Body,
}

impl Binary for Controller {
    const KIND: Kind = Kind::Controller;

    fn is_sound(&self) -> bool {
        self.check().is_ok()
    }
}

impl Binary for Network<f32, 2> {
    const KIND: Kind = Kind::SonarNetwork;

    fn is_sound(&self) -> bool {
        self.check().is_ok()
    }
}

impl Binary for Network<f32, 4> {
    const KIND: Kind = Kind::MotionNetwork;

    fn is_sound(&self) -> bool {
        self.check().is_ok()
    }
}

fn checksum(bytes: &[u8]) -> [u8; CHECKSUM] {
    Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(bytes).to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::controller::{Tuple, When};
    use crate::network::{ProductUnit, Scaling, SummationUnit};
    use proptest::prelude::*;

    fn network() -> Network<f32, 2> {
        let mut n = Network::constant([Scaling::onto_one_to_two(0.0, 255.0); 2], 0.5);
        n.summation.push(SummationUnit { weights: [0.25, -1.0], bias: 0.125, output: 2.0 }).unwrap();
        n.product.push(ProductUnit { exponents: [1.5, -0.75], output: -0.5 }).unwrap();
        n
    }

    fn controller() -> Controller {
        let tuple = Tuple { left: -100, right: 33, when: When::Larger, threshold_cm: 42 };
        Controller { step_ms: 400, max_steps: 150, tuples: [tuple; 6] }
    }

    #[test]
    fn bytes_and_text_give_back_the_same() {
        let mut buffer = [0; 512];
        assert_eq!(Network::from_bytes(network().to_bytes(&mut buffer).unwrap()), Ok(network()));
        assert_eq!(Controller::from_bytes(controller().to_bytes(&mut buffer).unwrap()), Ok(controller()));
        let text = serde_json::to_string(&network()).unwrap();
        assert_eq!(serde_json::from_str::<Network<f32, 2>>(&text).unwrap(), network());
        let text = serde_json::to_string(&controller()).unwrap();
        assert_eq!(serde_json::from_str::<Controller>(&text).unwrap(), controller());
    }

    #[test]
    fn every_changed_bit_and_every_cut_is_noticed() {
        let mut buffer = [0; 512];
        let bytes = network().to_bytes(&mut buffer).unwrap().to_vec();
        for bit in 0..bytes.len() * 8 {
            let mut broken = bytes.clone();
            broken[bit / 8] ^= 1 << (bit % 8);
            assert!(Network::<f32, 2>::from_bytes(&broken).is_err(), "bit {bit}");
        }
        for length in 0..bytes.len() {
            assert!(Network::<f32, 2>::from_bytes(&bytes[..length]).is_err(), "length {length}");
        }
    }

    #[test]
    fn one_kind_is_not_read_as_another() {
        let mut buffer = [0; 512];
        let bytes = controller().to_bytes(&mut buffer).unwrap();
        assert_eq!(Network::<f32, 4>::from_bytes(bytes), Err(BinaryError::Kind));
    }

    #[test]
    fn unsound_numbers_are_refused_behind_a_right_checksum() {
        let mut broken = network();
        broken.bias = f32::NAN;
        let mut buffer = [0; 512];
        let bytes = broken.to_bytes(&mut buffer).unwrap();
        assert_eq!(Network::<f32, 2>::from_bytes(bytes), Err(BinaryError::Body));
    }

    #[test]
    fn a_small_buffer_is_an_error() {
        for length in 0..60 {
            assert_eq!(network().to_bytes(&mut vec![0; length]), Err(BinaryError::BufferTooSmall));
        }
    }

    proptest! {
        #[test]
        fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..200), body in any::<bool>()) {
            let mut bytes = bytes;
            if body && bytes.len() > HEADER + CHECKSUM {
                // A right header and checksum, so that the body is reached.
                let end = bytes.len() - CHECKSUM;
                bytes[..HEADER].copy_from_slice(&[b'M', b'G', b'A', b'P', VERSION, Kind::SonarNetwork as u8]);
                let sum = checksum(&bytes[..end]);
                bytes[end..].copy_from_slice(&sum);
            }
            let _ = Network::<f32, 2>::from_bytes(&bytes);
            let _ = Controller::from_bytes(&bytes);
        }
    }
}
