//! Inputs made of others: bytes changed, cut out, put in, repeated, and two inputs spliced.

use mindgap_host_sim::chance::Generator;
use rand::RngExt;

/// Inputs grow no longer than this.
const LONGEST: usize = 8192;
/// What readers look at more closely than at other bytes.
const PIECES: [&[u8]; 14] = [
    b"\n",
    b",",
    b"[",
    b"]",
    b"\"",
    b"=",
    b"-",
    b"1e308",
    b"nan",
    b"\xFF\xFE",
    b"\0",
    b"[[x]]\n",
    b"18446744073709551616",
    b"(",
];

/// An input made of one of some, with a few changes.
pub fn mutated(corpus: &[Vec<u8>], rng: &mut Generator) -> Vec<u8> {
    let some = |rng: &mut Generator| corpus[rng.random_range(0..corpus.len())].as_slice();
    let mut input = some(rng).to_vec();
    for _ in 0..rng.random_range(1..6) {
        let at = rng.random_range(0..=input.len());
        let to = rng.random_range(at..=input.len().min(at + 64));
        match rng.random_range(0..7) {
            0 => drop(input.drain(at..to)),
            1 => drop(input.splice(at..at, PIECES[rng.random_range(0..PIECES.len())].iter().copied())),
            2 => {
                let repeated = input[at..to].repeat(rng.random_range(1..8));
                input.splice(at..at, repeated);
            }
            3 => {
                let other = some(rng);
                let from = rng.random_range(0..=other.len());
                let piece = other[from..other.len().min(from + 256)].to_vec();
                input.splice(at..to, piece);
            }
            _ if at < input.len() && rng.random() => input[at] ^= 1 << rng.random_range(0..8),
            _ if at < input.len() => input[at] = rng.random(),
            _ => input.push(rng.random()),
        }
        input.truncate(LONGEST);
    }
    input
}
