//! The random cases of a challenge: robot, effects, room and kind of driving.

use std::str::FromStr;

use rand::seq::{IndexedRandom, SliceRandom};
use rand::{Rng, RngExt};

use super::rooms;
use mindgap_built_in_robot::{ActiveEffect, Driving, Effect, HeldOut, record, record_driving};
use mindgap_foundations::error::Result;
use mindgap_foundations::random::{Generator, generator};
use mindgap_logs::Logs;

/// Number of robots in a challenge.
pub const ROBOTS: usize = 4;
/// Probability that a case is driven like the training logs of its simulator.
const DRIVEN_ALIKE: f64 = 0.5;
/// Number of cases in ten without an effect.
const WITHOUT: usize = 2;
/// Number of cases in ten with an effect unknown to the diagnosis.
const OUTSIDE: usize = 1;
/// Number of cases in ten with two known effects; the others have one.
const PAIRS: usize = 1;
/// Maximum number of rooms tried, since a robot with a strong effect may hit something in every small room.
const ROOMS_TRIED: usize = 20;
/// Keys of the random streams.
const ROBOT: u64 = 0;
const CASE: u64 = 1;

/// The set of effects unknown to the diagnosis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outside {
    /// Effects that were also used, with other seeds, to fit the thresholds of the diagnosis.
    Usual,
    /// Effects that were used neither to design nor to fit any part of the diagnosis.
    HeldOut,
}

/// How the randomness of echoes is correlated, in training logs and cases alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Echoes {
    /// Independent for every reading.
    Fresh,
    /// Mostly determined by the place, so that the effective sample size is smaller; every case has its own room.
    PlaceBound,
}

/// Amount of data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Steps per run.
    steps: usize,
    /// Training runs per robot.
    nominal_runs: usize,
    /// Smallest and largest number of runs per case.
    runs: [usize; 2],
}

impl Size {
    /// Size of a meaningful challenge.
    pub const USUAL: Size = Size { steps: 60, nominal_runs: 80, runs: [16, 28] };
    /// Smallest size that still allows a hold-out split.
    pub const QUICK: Size = Size { steps: 25, nominal_runs: 8, runs: [6, 6] };
}

/// Settings common to all cases of a challenge.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// Set of the unknown effects.
    pub outside: Outside,
    /// Correlation of the echoes.
    pub echoes: Echoes,
    /// Amount of data.
    pub size: Size,
}

impl Echoes {
    /// Draws the sensor of a robot for a new room.
    fn sensor(self, rng: &mut Generator) -> Option<ActiveEffect> {
        (self == Echoes::PlaceBound).then(|| {
            let range = Effect::PlaceBound.detail_range();
            let detail = range.map_or(0.0, |range| range.draw(rng));
            ActiveEffect { detail, ..ActiveEffect::new(Effect::PlaceBound) }
        })
    }
}

/// A recorded case.
pub struct Case {
    /// Index of the robot.
    pub robot: usize,
    /// Injected effects, and the sensor of its robot if that is place-bound.
    pub effects: Vec<ActiveEffect>,
    /// Kind of driving.
    pub driving: Driving,
    /// Logs of the case.
    pub logs: Logs,
    /// Generator for the remaining random choices of the case.
    pub rng: Generator,
}

/// Records the training logs of every robot.
///
/// # Errors
/// If a room has no space for its robot.
pub fn robots(seed: u64, Setting { echoes, size, .. }: Setting) -> Result<Vec<Logs>> {
    let robot = |robot: u64| {
        let mut rng = generator(seed, &[ROBOT, robot]);
        let spec = rooms::robot(&mut rng);
        let room = rooms::room(&mut rng);
        let sensor = Vec::from_iter(echoes.sensor(&mut rng));
        record(&spec, &room, size.nominal_runs, size.steps, &sensor, rng.next_u64())
    };
    (0..ROBOTS as u64).map(robot).collect()
}

/// Records the logs of a case.
///
/// # Errors
/// If the robot hits something in every room tried.
pub fn case(number: usize, effects: &[Effect], robots: &[Logs], setting: Setting, seed: u64) -> Result<Case> {
    let Setting { echoes, size, .. } = setting;
    let mut rng = generator(seed, &[CASE, number as u64]);
    let mut tried = 0;
    loop {
        let robot = rng.random_range(0..robots.len());
        let runs = rng.random_range(size.runs[0]..=size.runs[1]);
        let mut effects: Vec<ActiveEffect> = effects.iter().map(|e| ActiveEffect::random(*e, &mut rng)).collect();
        effects.extend(echoes.sensor(&mut rng));
        let alike = rng.random_bool(DRIVEN_ALIKE);
        let kind = Driving::ALL[1..].choose(&mut rng).filter(|_| !alike);
        let driving = *kind.unwrap_or(&Driving::MIXED);
        let (spec, scene) = (&robots[robot].robot, rooms::room(&mut rng));
        tried += 1;
        match record_driving(&driving, spec, &scene, [runs, size.steps], &effects, rng.next_u64()) {
            Ok(logs) => return Ok(Case { robot, effects, driving, logs, rng }),
            Err(error) if tried == ROOMS_TRIED => return Err(error),
            Err(_) => {}
        }
    }
}

/// Draws the effects of `cases` cases in random order; all effects of a kind occur about equally often.
pub fn effects(cases: usize, seed: u64, outside: Outside) -> Vec<Vec<Effect>> {
    let rng = &mut generator(seed, &[CASE]);
    let known: Vec<Effect> = Effect::all().filter(|e| e.in_table()).collect();
    let (mut known, mut outside) = (Deck::new(known), Deck::new(outside.effects()));
    let mut effects: Vec<Vec<Effect>> = (0..cases)
        .map(|case| match case % 10 {
            c if c < WITHOUT => Vec::new(),
            c if c < WITHOUT + OUTSIDE => vec![outside.draw(rng)],
            c if c < WITHOUT + OUTSIDE + PAIRS => {
                let first = known.draw(rng);
                let second = loop {
                    let other = known.draw(rng);
                    if other != first {
                        break other;
                    }
                };
                vec![first, second]
            }
            _ => vec![known.draw(rng)],
        })
        .collect();
    effects.shuffle(rng);
    effects
}

impl FromStr for Outside {
    type Err = String;

    fn from_str(name: &str) -> std::result::Result<Self, String> {
        match name {
            "usual" => Ok(Outside::Usual),
            "held-out" => Ok(Outside::HeldOut),
            _ => Err(format!("{name:?} is not a source of effects")),
        }
    }
}

impl Outside {
    fn effects(self) -> Vec<Effect> {
        let none = [Effect::PlaceBound, Effect::Unchanged];
        let usual =
            |effect: &Effect| !effect.in_table() && !none.contains(effect) && !matches!(effect, Effect::HeldOut(_));
        match self {
            Outside::Usual => Effect::all().filter(usual).collect(),
            Outside::HeldOut => HeldOut::all().map(Effect::HeldOut).collect(),
        }
    }
}

/// Draws effects in random order, each once before any repeats.
struct Deck {
    cards: Vec<Effect>,
    drawn: usize,
}

impl Deck {
    fn new(cards: Vec<Effect>) -> Self {
        Deck { cards, drawn: 0 }
    }

    fn draw(&mut self, rng: &mut Generator) -> Effect {
        let place = self.drawn % self.cards.len();
        if place == 0 {
            self.cards.shuffle(rng);
        }
        self.drawn += 1;
        self.cards[place]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_diagnosis::calibration::CALIBRATED_STEPS;

    #[test]
    fn training_size_matches_that_of_the_gates() {
        let Size { steps, nominal_runs, .. } = Size::USUAL;
        assert_eq!((steps * nominal_runs) as f64, CALIBRATED_STEPS);
    }

    #[test]
    fn held_out_effects_replace_the_usual_unknown_ones() {
        let drawn = |outside| -> Vec<Effect> {
            let effects = effects(400, 1, outside).into_iter().flatten();
            let mut outside: Vec<Effect> = effects.filter(|effect| !effect.in_table()).collect();
            assert_eq!(outside.len(), 40);
            outside.sort();
            outside.dedup();
            outside
        };
        assert_eq!(drawn(Outside::HeldOut), HeldOut::all().map(Effect::HeldOut).collect::<Vec<_>>());
        assert_eq!(drawn(Outside::Usual), Outside::Usual.effects());
    }
}
