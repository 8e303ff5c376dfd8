//! A small room with its simulator, a simulator trained on more logs, and a small challenge.

use std::sync::LazyLock;

use crate::command::{Sandbox, program};

/// A room with one obstacle, a target and two starts.
pub const SCENE: &str = "\
[arena]
width_cm = 200
height_cm = 150

[[obstacle]]
x_cm = 90
y_cm = 70
width_cm = 20
height_cm = 20

[target]
x_cm = 160
y_cm = 40

[[start]]
x_cm = 40
y_cm = 40
heading_deg = 0

[[start]]
x_cm = 100
y_cm = 30
heading_deg = 90
";

/// Returns a folder with small logs in `logs` and a simulator in `sim.json` that was trained on them.
pub fn trained() -> Sandbox {
    static TRAINED: LazyLock<Sandbox> = LazyLock::new(|| {
        let sandbox = Sandbox::with_logs();
        sandbox.run("train logs --out sim.json");
        sandbox
    });
    TRAINED.copy()
}

/// Returns the same folder with the room in `scene.toml`.
pub fn with_scene() -> Sandbox {
    let sandbox = trained();
    sandbox.write("scene.toml", SCENE);
    sandbox
}

/// Returns a folder with forty runs in `logs` and a simulator in `sim.json` that was trained on them.
pub fn with_forty_runs() -> Sandbox {
    static FORTY_RUNS: LazyLock<Sandbox> = LazyLock::new(|| {
        let sandbox = Sandbox::new();
        sandbox.run("record --out logs --runs 40 --seed 1");
        sandbox.run("train logs --out sim.json");
        sandbox
    });
    FORTY_RUNS.copy()
}

/// Returns a folder with short cases of a challenge in `blind`.
pub fn challenge(cases: usize) -> Sandbox {
    let sandbox = Sandbox::new();
    sandbox.run(&format!("challenge make --quick --cases {cases} --seed 5 --out blind"));
    sandbox
}

/// Writes `robot.sh`, which drives the built-in robot with a weak motor for `mindgap loop`. The shell code `before` may change the
/// arguments, and `after` may change the log, the file `$4`.
pub fn robot(sandbox: &Sandbox, before: &str, after: &str) {
    let mindgap = program().display();
    let drive = format!("'{mindgap}' drive \"$1\" --scene \"$2\" --start \"$3\" --out \"$4\" --seed \"$5\"");
    sandbox.write("robot.sh", format!("set -e\n{before}\n{drive} --effect motor_asymmetry=0.1\n{after}\n"));
}
