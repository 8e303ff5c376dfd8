//! What logs say, row by row, in the form that predictions are compared with.

use std::ops::Range;

use crate::effects::context::{RunHistory, Surroundings};
use crate::effects::{PoseIncrement, StepContext};
use crate::geometry::Pose;
use crate::logs::{Logs, Run, samples};
use crate::simulator::baseline::MotionModel;
use crate::sonar::Fan;

/// A folder of logs, ready to be judged.
pub struct Observations {
    /// The robot, and the walls round it.
    pub surroundings: Surroundings,
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
pub const FEWEST_BLOCKS: usize = 8;

impl Observations {
    /// Takes all that counts out of logs, for a sensor whose beam is `fan_width` times as wide as the usual fan.
    pub fn of(logs: &Logs, fan_width: f64) -> Self {
        let surroundings = Surroundings::new(&logs.robot, &logs.scene);
        let steps = samples::motion(logs);
        // Where no step has a pose at both ends, whole ways between poses are judged.
        let whole_ways = steps.is_empty();
        let mut steps = steps.iter().peekable();
        let mut rows = Vec::new();
        let parts = FEWEST_BLOCKS.div_ceil(logs.runs.len());
        for (run, logged) in logs.runs.iter().enumerate() {
            let contexts = contexts(logged, &surroundings);
            for (k, (row, (context, previous_echo_cm))) in logged.rows.iter().zip(&contexts).enumerate() {
                let (Some(pose), Some(context)) = (row.pose, context) else { continue };
                let step = steps.next_if(|s| (s.run, s.row) == (run, k));
                let motion = step.map(|s| PoseIncrement {
                    forward_cm: s.forward_cm,
                    lateral_cm: s.lateral_cm,
                    turn_rad: s.turn_rad,
                });
                let until = (k + 1..logged.rows.len()).find(|i| logged.rows[*i].pose.is_some());
                let way_until = until.filter(|_| whole_ways);
                let motion = motion.or_else(|| Some(PoseIncrement::between(&pose, &logged.rows[way_until?].pose?)));
                let until_ms = logged.rows.get(k + 1).map_or(row.t_ms, |next| next.t_ms);
                rows.push(Observation {
                    run,
                    at: k,
                    block: run * parts + k * parts / logged.rows.len(),
                    stretch: (until_ms - row.t_ms) / logs.robot.step_ms,
                    context: *context,
                    then: way_until.map_or_else(Vec::new, |until| unseen(logged, k + 1..until, context)),
                    motion,
                    expected: None,
                    echo_cm: row.echo_cm,
                    previous_echo_cm: *previous_echo_cm,
                    fan: surroundings.fan(&pose, 0.0, fan_width),
                });
            }
        }
        Observations { surroundings, fan_width, blocks: logs.runs.len() * parts, rows }
    }

    /// Asks the simulator once what it expects of every row: most hypotheses leave the commands as they are.
    pub fn expect(mut self, drive: Option<&MotionModel>) -> Self {
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
        self.surroundings.fan(robot, yaw_rad, self.fan_width * width)
    }

    /// The largest wheel speed that is commanded, cm/s.
    pub fn top_speed_cm_s(&self) -> f64 {
        let speeds =
            self.rows.iter().flat_map(|row| row.context.commands[0].map(|c| row.context.wheel_speed_cm_s(c).abs()));
        speeds.fold(0.0, f64::max)
    }
}

/// The context of every row at which the robot was seen, and the reading before each.
fn contexts(run: &Run, surroundings: &Surroundings) -> Vec<(Option<StepContext>, Option<f64>)> {
    let mut history = RunHistory::default();
    let begin_ms = run.rows[0].t_ms;
    let context = |row: &crate::logs::Row| {
        history.command(row.command());
        let context = row.pose.map(|pose| surroundings.context(&history, row.t_ms - begin_ms, pose));
        let previous_echo_cm = history.echo_before_cm();
        history.leave(context.as_ref(), row.echo_cm);
        (context, previous_echo_cm)
    };
    run.rows.iter().map(context).collect()
}

/// The contexts of rows at which the robot was not seen, as if it had stayed where it was seen last.
fn unseen(run: &Run, rows: Range<usize>, seen: &StepContext) -> Vec<StepContext> {
    let mut commands = seen.commands;
    let context = |i: usize| {
        commands.rotate_right(1);
        commands[0] = run.rows[i].command();
        let elapsed_min = (run.rows[i].t_ms - run.rows[0].t_ms) / 60_000.0;
        StepContext { elapsed_min, commands, ..*seen }
    };
    rows.map(context).collect()
}
