//! The origin of a controller, for the comments of a program.

/// The origin of a controller. Programs state it in their comments; unknown facts are omitted.
///
/// ```
/// use mindgap_controller_export::Origin;
///
/// let origin = Origin { scene: Some("maze.toml".to_owned()), seed: Some(7), ..Origin::default() };
/// assert_eq!(origin.lines(), ["scene: maze.toml", "seed: 7"]);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Origin {
    /// Simulator in which the controller was evolved, usually a file name.
    pub simulator: Option<String>,
    /// Scene for which it was evolved, usually a file name.
    pub scene: Option<String>,
    /// Number of the start within that scene, from 1.
    pub start: Option<usize>,
    /// Seed of the evolution.
    pub seed: Option<u64>,
    /// Total number of generations.
    pub generations: Option<u32>,
    /// Fitness in simulation (paper, equation 3).
    pub fitness: Option<f64>,
}

impl Origin {
    /// Returns one line of printable ASCII per known fact, safe in a comment of any C-like language.
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

/// Returns the text as printable ASCII. A backslash becomes a slash, because at the end of a line it would continue the
/// comment on the next one.
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
    fn facts_stay_inside_their_comment() {
        let origin =
            Origin { simulator: Some("a\n*/ \u{e9} C:\\sim\\".to_owned()), seed: Some(7), ..Origin::default() };
        assert_eq!(origin.lines(), ["simulator: a?*/ ? C:/sim/", "seed: 7"]);
    }
}
