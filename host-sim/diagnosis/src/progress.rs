//! How far a diagnosis is, for those who wait.

/// What a diagnosis is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Fitting each effect alone.
    Fitting,
    /// Comparing effects and their combinations.
    Comparing,
    /// Confirming the best on runs that were kept back.
    Confirming,
    /// Explaining what was found, and what is left.
    Explaining,
}

impl Stage {
    /// The share of the time that has gone by when it begins, roughly: logs differ in how many effects are compared.
    pub fn share_before(self) -> f64 {
        match self {
            Stage::Fitting => 0.0,
            Stage::Comparing => 0.3,
            Stage::Confirming => 0.7,
            Stage::Explaining => 0.75,
        }
    }

    /// What it is, for people.
    pub fn words(self) -> &'static str {
        match self {
            Stage::Fitting => "fitting each effect",
            Stage::Comparing => "comparing effects and combinations",
            Stage::Confirming => "confirming on runs kept back",
            Stage::Explaining => "explaining what is left",
        }
    }
}
