//! The sealed truth about a case and the commitment to it.

use std::fmt::Write;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use mindgap_built_in_robot::Effect;

/// The truth about a case.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sealed {
    /// Name of the case.
    pub case: String,
    /// Effects with strengths, as in `mindgap record --effect`; empty for a case without a gap.
    pub effects: Vec<String>,
    /// Name of the kind of driving.
    pub driving: String,
    /// Seed of further runs of the case, unseen by any diagnosis.
    pub fresh_seed: u64,
    /// Random salt, so that the effects cannot be found from the commitment by brute force.
    pub salt: String,
}

/// The public part of a case.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Published {
    /// Name of the case.
    pub case: String,
    /// Name of the robot.
    pub robot: String,
    /// [`Sealed::commitment`].
    pub commitment: String,
}

impl Sealed {
    /// Returns the SHA-256 of case, effects, driving, seed and salt, one per line, in hexadecimal digits.
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

    /// Returns the ids of the effects, without a place-bound sensor, which the robot has as well.
    pub fn ids(&self) -> Vec<&str> {
        let ids = self.effects.iter().map(|effect| effect.split('=').next().unwrap_or(effect));
        ids.filter(|id| *id != Effect::PlaceBound.id()).collect()
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
        let effects = ["slope=0.1@30", "place_bound=0.95@7"].map(String::from).into();
        assert_eq!(Sealed { effects, ..sealed }.ids(), ["slope"]);
    }
}
