//! The command `mindgap`.
fn main() {}
