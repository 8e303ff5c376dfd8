//! The random cases of a challenge: robot, effects, room and kind of driving.

use clap::ValueEnum;
use rand::seq::{IndexedRandom, SliceRandom};
use rand::{Rng, RngExt};

use super::rooms;
use mindgap_built_in_robot::{ActiveEffect, Driving, Effect, HeldOut, record, record_driving};
use mindgap_foundations::error::Result;
use mindgap_foundations::random::{Generator, generator};
use mindgap_logs::Logs;

/// Number of robots in a challenge.
pub const ROBOTS: usize = 4;
/// Probability that a case is driven like the logs that its simulator is learned from.
const DRIVEN_ALIKE: f64 = 0.5;
/// Of ten cases, this many have no effect.
const WITHOUT: usize = 2;
/// Of ten cases, this many have an effect outside the table of the diagnosis.
const OUTSIDE: usize = 1;
/// Of ten cases, this many have two effects of the table; the others have one.
const PAIRS: usize = 1;
/// Number of rooms tried, since with a strong effect a robot may hit something in every small room.
const ROOMS_TRIED: usize = 20;
/// Stream keys of the generators.
const ROBOT: u64 = 0;
const CASE: u64 = 1;

/// The effects outside the table of the diagnosis that cases are drawn from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Outside {
    /// Those that the thresholds of the diagnosis were fitted on as well, on cases of other seeds
    Usual,
    /// Those that no part of the diagnosis was made or fitted on
    HeldOut,
}

/// What the chance in echoes belongs to, in the logs of robots and cases alike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Echoes {
    /// To every reading anew.
    Fresh,
    /// To the place mostly, so that rows tell less than their number; every case has a room of its own.
    PlaceBound,
}

/// How much is logged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Number of steps of a run.
    steps: usize,
    /// Number of runs that a robot's simulator is learned from.
    nominal_runs: usize,
    /// Least and largest number of runs of a case.
    runs: [usize; 2],
}

impl Size {
    /// That of a challenge that tells something.
    pub const USUAL: Size = Size { steps: 60, nominal_runs: 80, runs: [16, 28] };
    /// Of everything as little as there has to be: so many runs as are held out from each other.
    pub const QUICK: Size = Size { steps: 25, nominal_runs: 8, runs: [6, 6] };
}

/// What all cases of a challenge have alike.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// What its effects outside the table are drawn from.
    pub outside: Outside,
    /// What the chance in its echoes belongs to.
    pub echoes: Echoes,
    /// How much is logged.
    pub size: Size,
}

impl Echoes {
    /// The sensor of a robot in another room.
    fn sensor(self, rng: &mut Generator) -> Option<ActiveEffect> {
        (self == Echoes::PlaceBound).then(|| {
            let range = Effect::PlaceBound.detail_range();
            let detail = range.map_or(0.0, |range| range.draw(rng));
            ActiveEffect { detail, ..ActiveEffect::new(Effect::PlaceBound) }
        })
    }
}

/// A case before it is written.
pub struct Case {
    /// Index of the robot.
    pub robot: usize,
    /// Its effects, and the sensor that it shares with its robot where that is none of the usual.
    pub effects: Vec<ActiveEffect>,
    /// The kind of driving.
    pub driving: Driving,
    /// Its logs.
    pub logs: Logs,
    /// Generator for everything else that is random about the case.
    pub rng: Generator,
}

/// The logs that the simulator of each robot is learned from.
///
/// # Errors
/// When a room has no space for its robot.
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
/// When the robot hits something in every room tried.
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

/// The effects of each of `cases` cases in random order; all effects of a kind occur about equally often.
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
    fn robots_are_trained_on_as_many_steps_as_the_gates_are_set_for() {
        let Size { steps, nominal_runs, .. } = Size::USUAL;
        assert_eq!((steps * nominal_runs) as f64, CALIBRATED_STEPS);
    }

    #[test]
    fn held_out_effects_take_the_place_of_the_usual_ones_outside_the_table() {
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
