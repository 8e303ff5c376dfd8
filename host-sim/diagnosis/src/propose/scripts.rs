//! Short command scripts, and the search for the one that says most.

use rayon::prelude::*;

/// A sequence of commands.
#[derive(Clone, Debug, PartialEq)]
pub struct Script {
    /// Its description.
    pub name: String,
    /// Left and right command of each step.
    pub commands: Vec<[f64; 2]>,
}

/// A manoeuvre that excites some effects better than random driving does.
struct Manoeuvre {
    name: String,
    /// Commands of the steps, repeated from the start at its end.
    pattern: Vec<[f64; 2]>,
}

/// Number of parts of a script, each a manoeuvre.
const PARTS: usize = 4;
/// Number of steps of a part: one cycle of most manoeuvres.
const STEPS_PER_PART: usize = 10;
/// Number of steps of a script.
pub const STEPS: usize = PARTS * STEPS_PER_PART;
/// A part is exchanged for one that adds at least this fraction: smaller differences are below the error of the predictions.
const LEAST_RISE: f64 = 0.01;
/// Maximum number of rounds of exchanges; most searches end after two.
const MOST_ROUNDS: usize = 2;
/// Powers of a manoeuvre. Commands that were logged often say little more, since the simulator's own error is the same in all of
/// them.
const POWERS: [f64; 3] = [1.0, 0.75, 1.2];

/// Returns the script with the highest value and the value, or `None` if no script has one. Commands stay within `known`, the
/// range in which the simulator predicts anything.
///
/// The parts of the best single manoeuvre are exchanged one at a time (coordinate exchange: Meyer and Nachtsheim, "The
/// coordinate-exchange algorithm for constructing exact optimal experimental designs", 1995).
pub fn best<T: Send>(known: [f64; 2], value: impl Fn(&Script) -> Option<(f64, T)> + Sync) -> Option<(Script, T)> {
    let manoeuvres = manoeuvres(known);
    let valued = |parts: [usize; PARTS]| {
        let script = script(&manoeuvres, parts);
        value(&script).map(|(rises, about)| (rises, parts, script, about))
    };
    let best_of = |candidates: Vec<[usize; PARTS]>| {
        let valued: Vec<_> = candidates.into_par_iter().filter_map(valued).collect();
        // The first of equal ones, whatever the number of threads.
        valued.into_iter().reduce(|best, next| if next.0 > best.0 { next } else { best })
    };
    let mut best = best_of((0..manoeuvres.len()).map(|manoeuvre| [manoeuvre; PARTS]).collect())?;
    for _ in 0..MOST_ROUNDS {
        let before = best.0;
        for part in 0..PARTS {
            let exchanged = |manoeuvre: usize| {
                let mut parts = best.1;
                parts[part] = manoeuvre;
                parts
            };
            let exchanges = (0..manoeuvres.len()).filter(|manoeuvre| *manoeuvre != best.1[part]).map(exchanged);
            let next = best_of(exchanges.collect());
            if let Some(next) = next.filter(|next| next.0 > best.0 * (1.0 + LEAST_RISE)) {
                best = next;
            }
        }
        if best.0 <= before {
            break;
        }
    }
    let (_, _, script, about) = best;
    Some((script, about))
}

fn script(manoeuvres: &[Manoeuvre], parts: [usize; PARTS]) -> Script {
    let mut names: Vec<&str> = parts.iter().map(|part| manoeuvres[*part].name.as_str()).collect();
    names.dedup();
    let commands = (0..STEPS).map(|step| {
        let pattern = &manoeuvres[parts[step / STEPS_PER_PART]].pattern;
        // A long manoeuvre repeats its pattern.
        pattern[step % pattern.len()]
    });
    Script { name: names.join(", then "), commands: commands.collect() }
}

fn manoeuvres(known: [f64; 2]) -> Vec<Manoeuvre> {
    let held = |name: &str, pattern: &[([f64; 2], usize)]| {
        let pattern = pattern.iter().flat_map(|(command, steps)| std::iter::repeat_n(*command, *steps));
        Manoeuvre { name: name.into(), pattern: pattern.collect() }
    };
    let all = vec![
        held("standing still", &[([0.0, 0.0], 1)]),
        held("slow spins to both sides", &[([20.0, -20.0], 8), ([-20.0, 20.0], 8)]),
        held("fast spins to both sides", &[([70.0, -70.0], 5), ([-70.0, 70.0], 5)]),
        held("a steady slow spin", &[([18.0, -18.0], 1)]),
        held("a steady spin to the right", &[([40.0, -40.0], 1)]),
        held("circles", &[([60.0, 20.0], 1)]),
        held("left and right arcs", &[([30.0, 60.0], 4), ([-30.0, -60.0], 4), ([60.0, 30.0], 4), ([-60.0, -30.0], 4)]),
        held("slow straight driving back and forth", &[([25.0, 25.0], 4), ([-25.0, -25.0], 4)]),
        held("straight driving back and forth", &[([45.0, 45.0], 4), ([-45.0, -45.0], 4)]),
        held("fast straight driving back and forth", &[([70.0, 70.0], 3), ([-70.0, -70.0], 3)]),
        held("reversals at every step", &[([60.0, 60.0], 1), ([-60.0, -60.0], 1)]),
        held("reversals of one wheel", &[([50.0, 0.0], 2), ([-50.0, 0.0], 2), ([0.0, 50.0], 2), ([0.0, -50.0], 2)]),
        held("starts and stops", &[([80.0, 80.0], 2), ([0.0, 0.0], 2), ([-80.0, -80.0], 2), ([0.0, 0.0], 2)]),
        held("full power back and forth", &[([100.0, 100.0], 2), ([-100.0, -100.0], 2)]),
        held("driving back and forth at many headings", &[([50.0; 2], 2), ([-50.0; 2], 2), ([-30.0, 30.0], 1)]),
        Manoeuvre { name: "a slow ramp through all commands".into(), pattern: ramp() },
    ];
    let mut distinct: Vec<Manoeuvre> = Vec::new();
    let at_powers = POWERS.iter().flat_map(|power| all.iter().map(move |manoeuvre| manoeuvre.at_power(*power, known)));
    for manoeuvre in at_powers {
        if distinct.iter().all(|known| known.pattern != manoeuvre.pattern) {
            distinct.push(manoeuvre);
        }
    }
    distinct
}

impl Manoeuvre {
    /// Returns it with commands multiplied by a power and kept within `known`.
    fn at_power(&self, power: f64, known: [f64; 2]) -> Self {
        let scaled = |command: &[f64; 2]| command.map(|c| (power * c).round().clamp(known[0], known[1]));
        let name = if power == 1.0 { self.name.clone() } else { format!("{} at {:.0} %", self.name, 100.0 * power) };
        Manoeuvre { name, pattern: self.pattern.iter().map(scaled).collect() }
    }
}

/// Drives back and forth with growing power, which shows where friction ends and a limit begins.
fn ramp() -> Vec<[f64; 2]> {
    let power = |step: usize| 5.0 + 95.0 * (step / 2) as f64 / (STEPS / 2) as f64;
    (0..STEPS).map(|step| if step % 2 == 0 { [power(step); 2] } else { [-power(step); 2] }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The value counts steps with a command at which something shows.
    fn worth(shows: impl Fn([f64; 2]) -> bool + Sync) -> Script {
        let value = |script: &Script| {
            let shown = script.commands.iter().filter(|command| shows(**command)).count();
            Some((shown as f64, ()))
        };
        best([-60.0, 85.0], value).expect("a script").0
    }

    #[test]
    fn the_manoeuvre_in_which_most_shows_is_found() {
        assert_eq!(worth(|command| command == [0.0, 0.0]).name, "standing still");
        assert_eq!(worth(|[left, right]| left == -right && left.abs() > 30.0).name, "a steady spin to the right");
    }

    /// Half of the value needs standing still, and half slow spins.
    #[test]
    fn parts_are_exchanged_where_a_mixture_says_more() {
        let value = |script: &Script| {
            let count = |command| script.commands.iter().filter(|c| **c == command).count() as f64;
            Some((f64::sqrt(count([0.0, 0.0])) + f64::sqrt(count([18.0, -18.0])), ()))
        };
        let (script, ()) = best([-100.0, 100.0], value).expect("a script");
        assert!(
            script.name.contains("standing still") && script.name.contains("a steady slow spin"),
            "{}",
            script.name
        );
        assert_eq!(script.commands.len(), STEPS);
    }

    #[test]
    fn commands_stay_within_what_the_simulator_knows() {
        let range = worth(|[left, _]| left == 85.0);
        assert!(range.commands.iter().flatten().all(|command| (-60.0..=85.0).contains(command)));
        assert!(best([-60.0, 85.0], |_| None::<(f64, ())>).is_none());
    }
}
