//! Kinds of random driving: which commands are drawn, and for how long each is held.

use rand::RngExt;

use crate::chance::Generator;

/// A kind of random driving. Logs of another kind than a simulator was learned from excite other effects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Driving {
    /// Its name.
    pub name: &'static str,
    /// Slowest and fastest command of the faster wheel.
    pace: [f64; 2],
    /// A command is held for so many steps, at least and at most.
    held: [usize; 2],
    /// How often, in turn: nearly straight, an arc, a spin, nearly straight back, any two commands.
    weights: [u32; 5],
}

/// Spins, slowest and fastest.
const SPIN: [f64; 2] = [10.0, 60.0];
/// Any two commands lie between these.
const ANY: [f64; 2] = [-60.0, 80.0];
/// What is nearly straight differs from wheel to wheel by at most this.
const NEARLY: f64 = 12.0;
/// Driving back is slower by this factor.
const BACK: f64 = 0.7;

impl Driving {
    /// As the paper's robot was driven: straight on and back or nearly so, arcs, spins and single wheels, slow and fast.
    /// Controllers drive nearly straight much of the time, and there friction shows.
    pub const MIXED: Driving = Driving { name: "mixed", pace: [15.0, 85.0], held: [1, 3], weights: [3, 8, 4, 1, 4] };

    /// Every kind.
    pub const ALL: [Driving; 5] = [
        Driving::MIXED,
        Driving { name: "slow", pace: [15.0, 50.0], held: [2, 4], weights: [3, 8, 4, 1, 2] },
        Driving { name: "fast", pace: [45.0, 85.0], held: [1, 2], weights: [4, 8, 3, 2, 4] },
        Driving { name: "cruise", pace: [25.0, 75.0], held: [2, 5], weights: [8, 10, 2, 0, 0] },
        Driving { name: "back and forth", pace: [15.0, 85.0], held: [1, 3], weights: [5, 2, 4, 7, 2] },
    ];

    /// The kind of that name.
    pub fn named(name: &str) -> Option<Driving> {
        Driving::ALL.into_iter().find(|kind| kind.name == name)
    }

    /// For how many steps a command is held.
    pub(super) fn steps(&self, rng: &mut Generator) -> usize {
        rng.random_range(self.held[0]..=self.held[1])
    }

    /// A random command in whole numbers.
    pub(super) fn command(&self, rng: &mut Generator) -> [f64; 2] {
        let fastest = self.pace[1];
        let pace = rng.random_range(self.pace[0]..=fastest);
        let nearly = |pace: f64, rng: &mut Generator| [pace, (pace + rng.random_range(-NEARLY..=NEARLY)).min(fastest)];
        let command: [f64; 2] = match self.drawn(rng) {
            0 => nearly(pace, rng),
            1 => [pace * rng.random_range(0.2..=1.0), pace * rng.random_range(0.2..=1.0)],
            2 => {
                let turn = rng.random_range(SPIN[0]..=SPIN[1]);
                if rng.random() { [turn, -turn] } else { [-turn, turn] }
            }
            3 => nearly(-BACK * pace, rng),
            _ => [rng.random_range(ANY[0]..=ANY[1]), rng.random_range(ANY[0]..=ANY[1])],
        };
        command.map(|c| c.round())
    }

    /// The place of one of the weights, as often as it says.
    fn drawn(&self, rng: &mut Generator) -> usize {
        let drawn = rng.random_range(0..self.weights.iter().sum::<u32>());
        let until = self.weights.iter().scan(0, |sum, weight| {
            *sum += weight;
            Some(*sum)
        });
        until.take_while(|until| *until <= drawn).count()
    }
}
