//! ROS 2 bags, written and read by the official Python package in a virtual environment under `target`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use serde_json::Value;

use crate::command::workspace;

/// The package that writes and reads bags.
const PACKAGE: &str = "mcap-ros2-support==0.6.0";

/// Writes `tracker.mcap`, `odometry.mcap`, `transforms.mcap`, `localised.mcap` and `untracked.mcap` of a drive into a folder. The drive
/// is a CSV file with columns t_s, v_m_s, w_rad_s, x_m, y_m, qz, qw and range_m.
pub fn write(drive: &Path, folder: &Path) {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/ros_bags.py");
    succeed(Command::new(&*PYTHON).arg(script).args([drive, folder]));
}

/// Reads a bag: for each topic, the time of each message (s), then its fields without headers.
pub fn messages(bag: &Path) -> BTreeMap<String, Vec<Vec<Value>>> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/ros_bag_messages.py");
    let read = succeed(Command::new(&*PYTHON).arg(script).arg(bag));
    serde_json::from_slice(&read).expect("JSON")
}

/// A Python with the package.
static PYTHON: LazyLock<PathBuf> = LazyLock::new(|| {
    let environment = workspace().join("target/ros-bags");
    let python = environment.join("bin/python");
    let has_it =
        Command::new(&python).args(["-c", "import mcap_ros2.writer"]).output().is_ok_and(|o| o.status.success());
    if !has_it {
        succeed(Command::new("python3").args(["-m", "venv", "--clear"]).arg(&environment));
        succeed(Command::new(&python).args([
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
            PACKAGE,
        ]));
    }
    python
});

fn succeed(command: &mut Command) -> Vec<u8> {
    let output = command.output().unwrap_or_else(|e| panic!("{command:?}: {e}; apt-get install python3-venv"));
    assert!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
    output.stdout
}
