//! Kinds of random driving: the distribution of commands and of how long each is held.

use rand::RngExt;

use mindgap_foundations::chance::Generator;

/// A kind of random driving. Logs of a kind other than that of the training logs excite other effects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Driving {
    /// Its name.
    pub name: &'static str,
    /// Slowest and fastest command of the faster wheel.
    pace: [f64; 2],
    /// Least and largest number of steps for which a command is held.
    held: [usize; 2],
    /// The largest such number in every third run, where it is another.
    long_hold: Option<usize>,
    /// Relative frequencies of: nearly straight, an arc, a spin, nearly straight back, any two commands.
    weights: [u32; 5],
}

/// Slowest and fastest command of a spin.
const SPIN: [f64; 2] = [10.0, 60.0];
/// Range of two independent commands.
const ANY: [f64; 2] = [-60.0, 80.0];
/// Largest difference between the wheels when driving nearly straight.
const NEARLY: f64 = 12.0;
/// Speed backwards relative to forwards.
const BACK: f64 = 0.7;
/// Of so many runs the last has commands that are held for long.
const LONG_EVERY: u64 = 3;

impl Driving {
    /// The mixture of the training logs (paper, section VI): straight and nearly straight, back, arcs, spins and single
    /// wheels, slow and fast. Controllers drive nearly straight much of the time, where friction matters most.
    pub const MIXED: Driving =
        Driving { name: "mixed", pace: [15.0, 85.0], held: [1, 3], long_hold: None, weights: [3, 8, 4, 1, 4] };

    /// All kinds.
    pub const ALL: [Driving; 5] = [
        Driving::MIXED,
        Driving { name: "slow", pace: [15.0, 50.0], held: [2, 4], long_hold: None, weights: [3, 8, 4, 1, 2] },
        Driving { name: "fast", pace: [45.0, 85.0], held: [1, 2], long_hold: None, weights: [4, 8, 3, 2, 4] },
        Driving { name: "cruise", pace: [25.0, 75.0], held: [2, 5], long_hold: None, weights: [8, 10, 2, 0, 0] },
        Driving { name: "back and forth", pace: [15.0, 85.0], held: [1, 3], long_hold: None, weights: [5, 2, 4, 7, 2] },
    ];

    /// The kind of a name; `None` for an unknown name.
    pub fn named(name: &str) -> Option<Driving> {
        Driving::ALL.into_iter().find(|kind| kind.name == name)
    }

    /// The same with commands that are held for up to so many steps in every third run, as controllers hold theirs.
    pub fn holding(self, long_hold: usize) -> Driving {
        Driving { long_hold: Some(long_hold.max(self.held[0])), ..self }
    }

    /// How a run of this number is driven.
    pub(super) fn of_run(&self, run: u64) -> Driving {
        match self.long_hold {
            Some(longest) if run % LONG_EVERY == LONG_EVERY - 1 => Driving { held: [self.held[0], longest], ..*self },
            _ => *self,
        }
    }

    /// Random number of steps for which a command is held.
    pub(super) fn steps(&self, rng: &mut Generator) -> usize {
        rng.random_range(self.held[0]..=self.held[1])
    }

    /// Random left and right command, integers.
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

    /// A random index, distributed by the weights.
    fn drawn(&self, rng: &mut Generator) -> usize {
        let drawn = rng.random_range(0..self.weights.iter().sum::<u32>());
        let until = self.weights.iter().scan(0, |sum, weight| {
            *sum += weight;
            Some(*sum)
        });
        until.take_while(|until| *until <= drawn).count()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_foundations::chance::generator;

    #[test]
    fn every_third_run_holds_commands_for_long() {
        let longest = |driving: Driving| {
            let mut rng = generator(1, &[]);
            (0..300).map(|_| driving.steps(&mut rng)).max()
        };
        let long = Driving::MIXED.holding(20);
        assert_eq!([0, 1, 2, 3, 5].map(|run| longest(long.of_run(run))), [3, 3, 20, 3, 20].map(Some));
        assert_eq!(Driving::MIXED.of_run(2), Driving::MIXED);
    }
}
