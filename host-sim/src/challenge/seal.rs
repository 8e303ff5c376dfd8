//! Sealed answers: what is different in a case, and the commitment that binds whoever made it.

use std::fmt::Write;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// What is different in a case.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sealed {
    /// The case.
    pub case: String,
    /// The effects with their strengths, as `mindgap record --effect` takes them; none in a case without a gap.
    pub effects: Vec<String>,
    /// How it was driven.
    pub driving: String,
    /// Draws further runs of the case, on which nobody has sought anything.
    pub fresh_seed: u64,
    /// Keeps anybody from finding the effects by trying them all on the commitment.
    pub salt: String,
}

/// What is published of a case.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Published {
    /// The case.
    pub case: String,
    /// The robot that drove.
    pub robot: String,
    /// [`Sealed::commitment`].
    pub commitment: String,
}

impl Sealed {
    /// SHA-256 of case, effects, driving, seed and salt, one a line, in hexadecimal digits.
    pub fn commitment(&self) -> String {
        let text = format!(
            "{}\n{}\n{}\n{}\n{}\n",
            self.case,
            self.effects.join(" "),
            self.driving,
            self.fresh_seed,
            self.salt
        );
        Sha256::digest(text.as_bytes()).iter().fold(String::new(), |mut hex, byte| {
            // Writing to a string cannot fail.
            let _ = write!(hex, "{byte:02x}");
            hex
        })
    }

    /// The names of its effects.
    pub fn ids(&self) -> Vec<&str> {
        self.effects.iter().map(|effect| effect.split('=').next().unwrap_or(effect)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_change_breaks_the_commitment() {
        let sealed = Sealed {
            case: "003".into(),
            effects: vec!["slope=0.1@30".into()],
            driving: "cruise".into(),
            fresh_seed: 7,
            salt: "9f".into(),
        };
        // Of the text "003\nslope=0.1@30\ncruise\n7\n9f\n", by another program.
        assert_eq!(sealed.commitment(), "6c7dd456e7b610776516dcf0b30b4672512fcdc71dbba8b5395a1178c55b82b3");
        for other in [
            Sealed { case: "004".into(), ..sealed.clone() },
            Sealed { effects: vec!["slope=0.1@31".into()], ..sealed.clone() },
            Sealed { driving: "fast".into(), ..sealed.clone() },
            Sealed { fresh_seed: 8, ..sealed.clone() },
            Sealed { salt: "9e".into(), ..sealed.clone() },
        ] {
            assert_ne!(other.commitment(), sealed.commitment());
        }
        assert_eq!(sealed.ids(), ["slope"]);
    }
}
