//! Bags written by the `mcap` crate, with messages in CDR.
