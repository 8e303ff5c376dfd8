//! Origin of a controller.

/// Origin of a controller for the comments of an onboard program. Unknown facts are omitted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Origin {
    /// The simulator that the controller was evolved in, usually a file name.
    pub simulator: Option<String>,
    /// The scene that it was evolved for, usually a file name.
    pub scene: Option<String>,
    /// The start within that scene, from 1.
    pub start: Option<usize>,
    /// The seed of the evolution.
    pub seed: Option<u64>,
    /// Total number of generations.
    pub generations: Option<u32>,
    /// Fitness in simulation.
    pub fitness: Option<f64>,
}

impl Origin {
    /// One line of printable ASCII for each known fact, safe in a comment of any C-like language.
    pub fn lines(&self) -> Vec<String> {
        let facts = [
            ("simulator", self.simulator.clone()),
            ("scene", self.scene.clone()),
            ("start", self.start.map(|n| n.to_string())),
            ("seed", self.seed.map(|n| n.to_string())),
            ("generations", self.generations.map(|n| n.to_string())),
            ("fitness", self.fitness.map(|x| x.to_string())),
        ];
        facts.into_iter().filter_map(|(name, fact)| Some(format!("{name}: {}", plain(&fact?)))).collect()
    }
}

/// A backslash at a line's end would pull the next line into the comment, so it turns into a slash.
fn plain(text: &str) -> String {
    let plain = |c: char| match c {
        '\\' => '/',
        ' '..='~' => c,
        _ => '?',
    };
    text.chars().map(plain).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_fact_can_leave_its_comment() {
        let origin =
            Origin { simulator: Some("a\n*/ \u{e9} C:\\sim\\".to_owned()), seed: Some(7), ..Origin::default() };
        assert_eq!(origin.lines(), ["simulator: a?*/ ? C:/sim/", "seed: 7"]);
    }
}
