//! Words and numbers as a page says them.

use crate::effects::Effect;
use crate::gap::Diagnosis;
use crate::gap::budget::{SCATTER, UNEXPLAINED};
use crate::gap::channel::Channel;

/// A part of a gap for people.
#[derive(Clone, Copy)]
pub struct Cause {
    /// Its name, without an article.
    pub name: &'static str,
    /// A sentence of what it is.
    pub what: &'static str,
    /// A sentence of how one checks it.
    pub check: &'static str,
}

const WIDER_SCATTER: Cause = Cause {
    name: "wider scatter",
    what: "The robot does the same thing less evenly than the simulator assumes, whatever the circumstances.",
    check: "Send the same short row of commands ten times from one mark on the floor and measure with a ruler how far \
            the ends lie apart; look for a loose wheel, a worn castor or a tracker that trembles while the robot \
            stands.",
};

const NOT_EXPLAINED: Cause = Cause {
    name: "unexplained",
    what: "The logs follow circumstances in a way that no named effect does.",
    check: "Watch the robot in the circumstances on which it depends.",
};

/// What an id of a budget means; none of an effect that is not among these.
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

/// What "with" means in charts of before and after.
pub fn with(diagnosis: &Diagnosis) -> &'static str {
    match diagnosis.effects.as_slice() {
        [] => "with the effects that came nearest, though they explain too little to be named",
        _ => "with the effects",
    }
}

/// What a channel is.
pub fn channel(channel: Channel) -> &'static str {
    match channel {
        Channel::Forward => "forward motion",
        Channel::Lateral => "sideways motion",
        Channel::Turn => "turn",
        Channel::EchoRate => "echo rate",
        Channel::EchoValue => "sonar reading",
    }
}

/// A list as one says it.
pub fn list(of: &[&str]) -> String {
    match of {
        [] => String::new(),
        [one] => (*one).into(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

/// A share in per cent, which no line ends within.
pub fn percent(share: f64) -> String {
    format!("{:.0}\u{a0}%", 100.0 * share)
}

/// A share with its interval.
pub fn percent_within(share: f64, [low, high]: [f64; 2]) -> String {
    format!("{} ({:.0} to {:.0})", percent(share), 100.0 * low, 100.0 * high)
}

/// A number with so many decimals and a true minus.
pub fn number(value: f64, decimals: usize) -> String {
    format!("{value:.decimals$}").replace('-', "−")
}

/// Tenths are as fine as a map of centimetres is seen.
pub fn tenths(value: f64) -> f64 {
    libm::round(10.0 * value) / 10.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::CATALOGUE;

    #[test]
    fn every_effect_says_what_it_is_and_how_one_checks_it() {
        for effect in CATALOGUE {
            let Cause { name, what, check } = cause(effect.id, CATALOGUE).expect("an effect of the catalogue");
            assert!(!name.is_empty() && !name.contains('_'), "{}", effect.id);
            assert!(what.ends_with('.') && check.ends_with('.') && check.len() > what.len() / 2, "{}", effect.id);
        }
        assert_eq!(name("caster", CATALOGUE), "caster");
    }

    #[test]
    fn lists_are_said_as_one_says_them() {
        assert_eq!([list(&[]), list(&["a"]), list(&["a", "b", "c"])], ["", "a", "a, b and c"]);
    }
}
