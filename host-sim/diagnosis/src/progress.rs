//! Progress of a diagnosis.

/// A stage of a diagnosis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Fits each effect alone.
    Fitting,
    /// Compares effects and combinations of them.
    Comparing,
    /// Confirms the best ones on held-out runs.
    Confirming,
    /// Explains what was found and what remains.
    Explaining,
}

impl Stage {
    /// Returns the approximate fraction of the time before this stage. It depends on how many combinations are compared.
    pub fn share_before(self) -> f64 {
        match self {
            Stage::Fitting => 0.0,
            Stage::Comparing => 0.3,
            Stage::Confirming => 0.7,
            Stage::Explaining => 0.75,
        }
    }

    /// Describes it for people.
    pub fn words(self) -> &'static str {
        match self {
            Stage::Fitting => "fitting each effect",
            Stage::Comparing => "comparing effects and combinations",
            Stage::Confirming => "confirming on held-out runs",
            Stage::Explaining => "explaining the remainder",
        }
    }
}
