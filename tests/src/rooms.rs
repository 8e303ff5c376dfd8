//! A small room and a simulator for it, and a small challenge, quick to make and to answer.

use std::sync::LazyLock;

use crate::command::Workshop;

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

/// A folder with small logs in `logs` and a simulator that was trained on them in `sim.json`.
pub fn trained() -> Workshop {
    static TRAINED: LazyLock<Workshop> = LazyLock::new(|| {
        let workshop = Workshop::with_logs();
        workshop.done("train logs --out sim.json");
        workshop
    });
    TRAINED.copy()
}

/// The same with the room in `scene.toml`.
pub fn with_scene() -> Workshop {
    let workshop = trained();
    workshop.write("scene.toml", SCENE);
    workshop
}

/// Short cases of a challenge in `blind`.
pub fn challenge(cases: usize) -> Workshop {
    let workshop = Workshop::new();
    workshop.done(&format!("challenge make --quick --cases {cases} --seed 5 --out blind"));
    workshop
}

/// The built-in robot, with a weak motor, as the command `robot.sh` of a loop. `before` prepares its arguments, and `after`
/// is done to the log, a file `$4`.
///
/// # Panics
/// When the path of the command is no UTF-8.
pub fn robot(workshop: &Workshop, before: &str, after: &str) {
    let command = workshop.command("");
    let mindgap = command.get_program().to_str().expect("a path in UTF-8");
    let drive = format!("'{mindgap}' drive \"$1\" --scene \"$2\" --start \"$3\" --out \"$4\" --seed \"$5\"");
    workshop.write("robot.sh", format!("set -e\n{before}\n{drive} --effect motor_asymmetry=0.1\n{after}\n"));
}
