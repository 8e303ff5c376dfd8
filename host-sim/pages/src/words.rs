//! Words and numbers for people.

use mindgap_diagnosis::Diagnosis;
use mindgap_diagnosis::budget::{SCATTER, UNEXPLAINED};
use mindgap_diagnosis::verdict::Verdict;
pub use mindgap_figures::report::style::number;
use mindgap_foundations::channel::Channel;
use mindgap_models::effects::Effect;

/// A part of a gap in words.
#[derive(Clone, Copy)]
pub struct Cause {
    /// Its name, without an article.
    pub name: &'static str,
    /// What it is, in a sentence.
    pub what: &'static str,
    /// How to check it, in a sentence.
    pub check: &'static str,
}

const WIDER_SCATTER: Cause = Cause {
    name: "wider scatter",
    what: "The same commands give more varied results than the simulator assumes, under all conditions.",
    check: "Send the same short sequence of commands ten times from one mark on the floor and measure with a ruler how far \
            apart the ends are; look for a loose wheel, a worn castor or a tracker that jitters while the robot stands \
            still.",
};

const NOT_EXPLAINED: Cause = Cause {
    name: "unexplained",
    what: "The residuals depend on the conditions in a way that no named effect describes.",
    check: "Watch the robot under the conditions on which the residuals depend.",
};

/// Returns what an id of a budget means; `None` if the effect is not in the catalogue.
pub fn cause(id: &str, catalogue: &[&'static Effect]) -> Option<Cause> {
    match id {
        SCATTER => Some(WIDER_SCATTER),
        UNEXPLAINED => Some(NOT_EXPLAINED),
        _ => {
            let effect = catalogue.iter().find(|effect| effect.id == id)?;
            Some(Cause { name: effect.name, what: effect.what, check: effect.check })
        }
    }
}

/// The name of an id.
pub fn name<'a>(id: &'a str, catalogue: &[&'static Effect]) -> &'a str {
    cause(id, catalogue).map_or(id, |cause| cause.name)
}

/// The verdict as a sentence.
pub fn verdict(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::NoGap => "No gap: the logs agree with the simulator within its own error.",
        Verdict::Known => "There is a gap, and known effects explain it.",
        Verdict::PartlyKnown => "There is a gap, and known effects explain a part of it.",
        Verdict::Unknown => "There is a gap, and no known effect explains it.",
    }
}

/// What "with" means in charts of before and after.
pub fn with(diagnosis: &Diagnosis) -> &'static str {
    match diagnosis.effects.as_slice() {
        [] => "with the best-fitting effects, which explain too little to be named",
        _ => "with the effects",
    }
}

/// Returns a number with its noun: "1 run", "2 runs".
pub fn count(of: usize, what: &str) -> String {
    format!("{of} {what}{}", if of == 1 { "" } else { "s" })
}

/// What a channel is.
pub fn channel(channel: Channel) -> &'static str {
    match channel {
        Channel::Forward => "forward motion",
        Channel::Lateral => "sideways motion",
        Channel::Turn => "turn",
        Channel::EchoRate => "echo rate",
        Channel::EchoValue => "sonar reading",
        Channel::RotLeft => "turn of the left wheel",
        Channel::RotRight => "turn of the right wheel",
        Channel::Gyro => "yaw rate",
    }
}

/// A list in words.
pub fn list(of: &[&str]) -> String {
    match of {
        [] => String::new(),
        [one] => (*one).into(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// A share in per cent, without a line break inside.
pub fn percent(share: f64) -> String {
    format!("{:.0}\u{a0}%", 100.0 * share)
}

/// A share with its interval.
pub fn percent_within(share: f64, [low, high]: [f64; 2]) -> String {
    format!("{} ({:.0} to {:.0})", percent(share), 100.0 * low, 100.0 * high)
}

/// Rounds to tenths, which is as fine as a map in centimetres needs.
pub fn tenths(value: f64) -> f64 {
    libm::round(10.0 * value) / 10.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_models::effects::CATALOGUE;

    #[test]
    fn every_effect_has_a_description_and_a_check() {
        for effect in CATALOGUE {
            let Cause { name, what, check } = cause(effect.id, CATALOGUE).expect("an effect of the catalogue");
            assert!(!name.is_empty() && !name.contains('_'), "{}", effect.id);
            assert!(what.ends_with('.') && check.ends_with('.') && check.len() > what.len() / 2, "{}", effect.id);
        }
        assert_eq!(name("caster", CATALOGUE), "caster");
    }

    #[test]
    fn lists_are_written_in_words() {
        assert_eq!([list(&[]), list(&["a"]), list(&["a", "b", "c"])], ["", "a", "a, b and c"]);
    }
}
