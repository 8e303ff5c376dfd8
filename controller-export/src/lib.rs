//! Turns a six-tuple controller into an onboard program.
