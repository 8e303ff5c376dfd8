//! What logs say, row by row, in the form that hypotheses are judged on.

use std::ops::Range;

use crate::effects::effect::{HISTORY, PoseIncrement, StepContext, middle};
use crate::geometry::{Pose, Wall, cast};
use crate::logs::{Logs, Robot, Run, samples};
use crate::simulator::baseline::Drive;
use crate::sonar::{Fan, fan_at};

/// A folder of logs, ready to be judged.
pub struct Observations {
    /// The robot.
    pub robot: Robot,
    /// Everything that a ray can meet.
    pub sides: Vec<Wall>,
    /// The beam against the usual fan.
    pub fan_width: f64,
    /// How many blocks of rows are judged together: the runs, or parts of them where there are few.
    pub blocks: usize,
    /// All rows with a pose.
    pub rows: Vec<Observation>,
}

/// A row at which the tracker saw the robot.
pub struct Observation {
    /// Which run of the folder,
    pub run: usize,
    /// and which row of that.
    pub at: usize,
    /// Which block.
    pub block: usize,
    /// Length of the step that begins here, against the usual one.
    pub stretch: f64,
    /// What effects may look at.
    pub context: StepContext,
    /// What effects may look at in the steps until the tracker saw the robot again, where these are judged as one; their
    /// poses are not known.
    pub then: Vec<StepContext>,
    /// What the step did, or those that are judged as one, where their end was seen too.
    pub motion: Option<PoseIncrement>,
    /// What the simulator expects of the commands as logged, once [`Observations::expect`] has asked it.
    pub expected: Option<PoseIncrement>,
    /// What the sensor said.
    pub echo_cm: Option<f64>,
    /// What it said the row before.
    pub previous_echo_cm: Option<f64>,
    /// What the sensor sees from here if nothing is changed.
    pub fan: Fan,
}

/// With fewer runs than this each is cut into parts, so that there is a scatter between blocks.
const FEWEST_BLOCKS: usize = 8;

impl Observations {
    /// Takes all that counts out of logs, for a sensor whose beam is `fan_width` times as wide as the usual fan.
    pub fn of(logs: &Logs, fan_width: f64) -> Self {
        let sides = logs.scene.sides();
        let middle_cm = middle(&sides);
        let steps = samples::motion(logs);
        // Where no step has a pose at both ends, whole ways between poses are judged.
        let whole_ways = steps.is_empty();
        let mut steps = steps.iter().peekable();
        let mut rows = Vec::new();
        let parts = FEWEST_BLOCKS.div_ceil(logs.runs.len());
        for (run, logged) in logs.runs.iter().enumerate() {
            let mut faced_before = None;
            for (k, row) in logged.rows.iter().enumerate() {
                let Some(pose) = row.pose else { continue };
                let step = steps.next_if(|s| (s.run, s.row) == (run, k));
                let motion = step.map(|s| PoseIncrement {
                    forward_cm: s.forward_cm,
                    lateral_cm: s.lateral_cm,
                    turn_rad: s.turn_rad,
                });
                let until = (k + 1..logged.rows.len()).find(|i| logged.rows[*i].pose.is_some());
                let way_until = until.filter(|_| whole_ways);
                let motion = motion.or_else(|| Some(PoseIncrement::between(&pose, &logged.rows[way_until?].pose?)));
                let unseen = way_until.map_or(k + 1..k + 1, |until| k + 1..until);
                let sensor = logs.robot.ultrasonic.pose_on(&pose);
                let hit = cast(&sides, sensor.position_cm, sensor.direction());
                let faced = hit.map(|hit| [hit.distance_cm, hit.incidence_rad]);
                let fan = fan_at(&sides, &sensor, fan_width);
                let before = |back: usize| k.checked_sub(back).map(|i| &logged.rows[i]);
                let elapsed_min = |i: usize| (logged.rows[i].t_ms - logged.rows[0].t_ms) / 60_000.0;
                let context = StepContext {
                    elapsed_min: elapsed_min(k),
                    commands: window(logged, k),
                    pose,
                    earlier: [1, 2].map(|back| before(back).and_then(|r| r.pose)),
                    faced,
                    faced_before: std::mem::replace(&mut faced_before, faced),
                    echo_before: before(1).map(|r| r.echo_cm.is_some()),
                    middle_cm,
                    track_cm: logs.robot.track_cm,
                };
                let then =
                    unseen.map(|i| StepContext { elapsed_min: elapsed_min(i), commands: window(logged, i), ..context });
                let previous_echo_cm = before(1).and_then(|r| r.echo_cm);
                let block = run * parts + k * parts / logged.rows.len();
                let until_ms = logged.rows.get(k + 1).map_or(row.t_ms, |next| next.t_ms);
                let stretch = (until_ms - row.t_ms) / logs.robot.step_ms;
                rows.push(Observation {
                    run,
                    at: k,
                    block,
                    stretch,
                    context,
                    then: then.collect(),
                    motion,
                    expected: None,
                    echo_cm: row.echo_cm,
                    previous_echo_cm,
                    fan,
                });
            }
        }
        Observations { robot: logs.robot, sides, fan_width, blocks: logs.runs.len() * parts, rows }
    }

    /// Asks the simulator once what it expects of every row: most hypotheses leave the commands as they are.
    pub fn expect(mut self, drive: Option<&Drive>) -> Self {
        for row in &mut self.rows {
            let [now, before, ..] = row.context.commands;
            row.expected = drive.map(|drive| drive.step(now, before));
        }
        self
    }

    /// The rows of a block.
    pub fn of_block(&self, block: usize) -> Range<usize> {
        let begin = self.rows.partition_point(|row| row.block < block);
        begin..self.rows.partition_point(|row| row.block <= block)
    }

    /// Sums a number of each row by block.
    pub fn by_block(&self, terms: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.blocks];
        self.rows.iter().zip(terms).for_each(|(row, t)| sums[row.block] += t);
        sums
    }

    /// What the sensor of a robot at `robot` sees, its axis turned and its beam widened.
    pub fn fan(&self, robot: &Pose, yaw_rad: f64, width: f64) -> Fan {
        let mut sensor = self.robot.ultrasonic.pose_on(robot);
        sensor.heading_rad += yaw_rad;
        fan_at(&self.sides, &sensor, self.fan_width * width)
    }
}

/// The commands of row `k` and of those before, the motors standing before the first.
fn window(run: &Run, k: usize) -> [[f64; 2]; HISTORY] {
    std::array::from_fn(|back| k.checked_sub(back).map_or([0.0; 2], |i| run.rows[i].command()))
}
