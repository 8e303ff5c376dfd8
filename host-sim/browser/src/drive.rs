//! Where the robot drove, for the page to draw.

use mindgap_foundations::geometry::Wall;
use mindgap_logs::{Logs, Row, Run};
use serde::Serialize;

/// The drives of all runs, in the room.
#[derive(Serialize)]
pub struct Drives {
    /// Both ends of each wall and side of an obstacle: x, y, x, y; cm.
    walls_cm: Vec<[f64; 4]>,
    /// The runs.
    runs: Vec<Drive>,
}

/// The drive of one run.
#[derive(Serialize)]
struct Drive {
    name: String,
    /// Time of each pose, ms.
    t_ms: Vec<f64>,
    /// Poses as x and y in cm and heading in rad; nothing where the tracker lost the robot.
    poses: Vec<Option<[f64; 3]>>,
}

impl Drives {
    /// Returns the drives of logs.
    pub fn of(logs: &Logs) -> Self {
        let wall = |wall: &Wall| [wall.from_cm.x, wall.from_cm.y, wall.to_cm.x, wall.to_cm.y];
        Drives {
            walls_cm: logs.scene.sides().iter().map(wall).collect(),
            runs: logs.runs.iter().map(Drive::of).collect(),
        }
    }
}

impl Drive {
    fn of(run: &Run) -> Self {
        let pose = |row: Row| row.pose.map(|pose| [pose.position_cm.x, pose.position_cm.y, pose.heading_rad]);
        Drive {
            name: run.name.clone(),
            t_ms: run.rows.iter().map(|row| row.t_ms).collect(),
            poses: run.rows.iter().map(pose).collect(),
        }
    }
}
