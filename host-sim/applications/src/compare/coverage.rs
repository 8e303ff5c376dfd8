//! Whether a simulator's logs are enough to learn what the robot was commanded.

use std::collections::BTreeSet;

use mindgap_import::ros2_bag::{Bag, Content};
use mindgap_logs::{Logs, Robot};

/// Fewer steps than this teach no networks.
const FEWEST_STEPS: usize = 200;
/// Width of the cells in which commands count as alike.
const CELL: f64 = 25.0;
/// Share of the robot's commands that must be like some of the simulator's.
const COVERED: f64 = 0.9;
/// Rest between two runs, ms.
const REST_MS: f64 = 2000.0;

/// Commands to drive a simulator with: time in ms, left, right; each held until the next.
pub struct Script(Vec<(f64, [f64; 2])>);

/// Returns what the simulator's logs lack, in words, or `None` if they suffice.
pub fn missing(simulator: &Logs, real: &Logs) -> Option<String> {
    let steps = steps(simulator);
    if steps < FEWEST_STEPS {
        return Some(format!("the simulator's recording has {steps} steps, and learning needs {FEWEST_STEPS}"));
    }
    let known: BTreeSet<[i64; 2]> = commands(simulator).map(cell).collect();
    let is_known = |[left, right]: [i64; 2]| (-1..=1).any(|i| (-1..=1).any(|j| known.contains(&[left + i, right + j])));
    let all: Vec<[i64; 2]> = commands(real).map(cell).collect();
    let covered = all.iter().filter(|cell| is_known(**cell)).count() as f64 / all.len().max(1) as f64;
    (covered < COVERED).then(|| {
        format!(
            "the simulator's recording has commands like {:.0} % of the robot's, and learning needs {:.0} %",
            100.0 * covered,
            100.0 * COVERED
        )
    })
}

impl Script {
    /// Returns the robot's own commands, run after run, and mirrored until they are enough to learn from.
    pub fn of(real: &Logs) -> Self {
        let (mut script, mut t_ms) = (Vec::new(), 0.0);
        let rounds = FEWEST_STEPS.div_ceil(steps(real).max(1)).max(1);
        for round in 0..rounds {
            for run in &real.runs {
                let first_ms = run.rows.first().map_or(0.0, |row| row.t_ms);
                for row in run.rows.iter() {
                    let [left, right] = row.command();
                    let command = if round % 2 == 0 { [left, right] } else { [right, left] };
                    script.push((t_ms + row.t_ms - first_ms, command));
                }
                let last_ms = run.rows.last().map_or(0.0, |row| row.t_ms) - first_ms;
                t_ms += last_ms + real.robot.step_ms;
                script.push((t_ms, [0.0, 0.0]));
                t_ms += REST_MS;
            }
        }
        Script(script)
    }

    /// Returns it as CSV.
    pub fn to_csv(&self) -> String {
        let rows = self.0.iter().map(|(t_ms, [left, right])| format!("{t_ms},{left},{right}\n"));
        format!("t_ms,left,right\n{}", rows.collect::<String>())
    }

    /// Returns it as a ROS 2 bag of `cmd_vel`, by the robot's full speed and track.
    pub fn to_bag(&self, robot: &Robot) -> Vec<u8> {
        let mut bag = Bag::default();
        for (t_ms, wheels) in &self.0 {
            let [left_cm_s, right_cm_s] = wheels.map(|command| command / 100.0 * robot.full_speed_cm_s);
            let twist = Content::Twist {
                forward_cm_s: (left_cm_s + right_cm_s) / 2.0,
                turn_rad_s: (right_cm_s - left_cm_s) / robot.track_cm,
            };
            bag.write("/cmd_vel", *t_ms, &twist);
        }
        bag.finish()
    }
}

fn steps(logs: &Logs) -> usize {
    logs.runs.iter().map(|run| run.rows.pairs().filter(|[a, b]| a.pose.is_some() && b.pose.is_some()).count()).sum()
}

fn commands(logs: &Logs) -> impl Iterator<Item = [f64; 2]> + '_ {
    logs.runs.iter().flat_map(|run| run.rows.iter().map(|row| row.command()))
}

fn cell(command: [f64; 2]) -> [i64; 2] {
    command.map(|c| (c / CELL).round() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_foundations::geometry::Pose;
    use mindgap_logs::{Row, Rows, Run, Scene};

    fn logs(rows: usize, command: impl Fn(usize) -> [f64; 2]) -> Logs {
        let mut all = Rows::default();
        for k in 0..rows {
            let [left, right] = command(k);
            all.push(Row {
                t_ms: 400.0 * k as f64,
                left,
                right,
                pose: Some(Pose::new(0.0, 0.0, 0.0)),
                ..Row::default()
            });
        }
        let robot = mindgap_built_in_robot::default_robot();
        Logs { robot, scene: Scene::default(), runs: vec![Run { name: "run-000".into(), rows: all }] }
    }

    #[test]
    fn few_steps_and_other_commands_are_not_enough() {
        let real = logs(50, |k| [(k % 5) as f64 * 20.0, 40.0]);
        let missing = |simulator: &Logs| missing(simulator, &real).unwrap_or_default();
        assert_eq!(missing(&logs(300, |k| [(k % 5) as f64 * 20.0, 40.0])), "");
        assert!(missing(&logs(100, |_| [40.0, 40.0])).contains("has 99 steps"));
        assert!(missing(&logs(300, |_| [-90.0, -90.0])).contains("commands like 0 %"));
    }

    #[test]
    fn script_is_the_robots_own_commands_and_enough_of_them() {
        let script = Script::of(&logs(150, |k| [k as f64 / 2.0, 10.0]));
        let text = script.to_csv();
        assert!(text.starts_with("t_ms,left,right\n0,0,10\n400,0.5,10\n"), "{text}");
        assert!(text.trim_end().ends_with(",0,0"), "it ends at rest");
        assert!(text.contains(",10,0.5\n"), "mirrored, since once is not enough");
        assert!(script.0.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }
}
