//! Short command scripts, each of which excites some effects better than random driving does.

/// A sequence of commands.
pub struct Script {
    /// Its description.
    pub name: &'static str,
    /// Left and right command of each step.
    pub commands: Vec<[f64; 2]>,
}

/// Number of steps of a script.
pub const STEPS: usize = 40;

/// Returns all scripts.
pub fn all() -> Vec<Script> {
    let repeated = |name, pattern: &[([f64; 2], usize)]| {
        let pattern = pattern.iter().flat_map(|(command, steps)| std::iter::repeat_n(*command, *steps));
        Script { name, commands: pattern.collect::<Vec<_>>().into_iter().cycle().take(STEPS).collect() }
    };
    vec![
        repeated("standing still", &[([0.0, 0.0], 1)]),
        repeated("slow spins to both sides", &[([20.0, -20.0], 8), ([-20.0, 20.0], 8)]),
        repeated("fast spins to both sides", &[([70.0, -70.0], 5), ([-70.0, 70.0], 5)]),
        repeated("a steady slow spin", &[([18.0, -18.0], 1)]),
        repeated(
            "left and right arcs",
            &[([30.0, 60.0], 4), ([-30.0, -60.0], 4), ([60.0, 30.0], 4), ([-60.0, -30.0], 4)],
        ),
        repeated("slow straight driving back and forth", &[([25.0, 25.0], 4), ([-25.0, -25.0], 4)]),
        repeated("fast straight driving back and forth", &[([70.0, 70.0], 3), ([-70.0, -70.0], 3)]),
        repeated("reversals at every step", &[([60.0, 60.0], 1), ([-60.0, -60.0], 1)]),
        repeated("reversals of one wheel", &[([50.0, 0.0], 2), ([-50.0, 0.0], 2), ([0.0, 50.0], 2), ([0.0, -50.0], 2)]),
        repeated("starts and stops", &[([80.0, 80.0], 2), ([0.0, 0.0], 2), ([-80.0, -80.0], 2), ([0.0, 0.0], 2)]),
        repeated("full power back and forth", &[([100.0, 100.0], 2), ([-100.0, -100.0], 2)]),
        ramp("a slow ramp through all commands"),
        heading_sweep("driving back and forth at many headings"),
    ]
}

/// Drives back and forth with growing power, which shows where friction ends and a limit begins.
fn ramp(name: &'static str) -> Script {
    let power = |step: usize| 5.0 + 95.0 * (step / 2) as f64 / (STEPS / 2) as f64;
    let commands = (0..STEPS).map(|step| if step % 2 == 0 { [power(step); 2] } else { [-power(step); 2] });
    Script { name, commands: commands.collect() }
}

/// Drives forward, back, and turns to the next heading.
fn heading_sweep(name: &'static str) -> Script {
    let pattern = [[50.0, 50.0], [50.0, 50.0], [-50.0, -50.0], [-50.0, -50.0], [-30.0, 30.0]];
    Script { name, commands: pattern.into_iter().cycle().take(STEPS).collect() }
}
