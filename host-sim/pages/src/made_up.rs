//! Made-up logs for tests of pages.

use mindgap_built_in_robot::default_robot;
use mindgap_foundations::geometry::Pose;
use mindgap_logs::{Logs, Row, Run, Scene};

/// A name that a page must not take for markup.
pub const EVIL: &str = "<x-mark onload=\"evil\">&'</script><!--";

/// Returns runs straight ahead on open ground, whose names begin with `name`.
pub fn logs(runs: usize, rows: usize, name: &str) -> Logs {
    let pose = |k: usize| Pose::new(30.0 + k as f64, 40.0, 0.0);
    let row = |k: usize| Row { t_ms: 400.0 * k as f64, left: 10.0, pose: Some(pose(k)), ..Row::default() };
    let run = |i: usize| Run { name: format!("{name}{i}"), rows: (0..rows).map(row).collect() };
    Logs { robot: default_robot(), scene: Scene::default(), runs: (0..runs).map(run).collect() }
}
