//! Learns the filter between commands and wheels, for robots that take more than a step to respond: networks that know a
//! command and the one before cannot.
//!
//! For each filter a regression predicts the logged steps from filtered commands; the filter with the least residuals is the
//! most likely one, whatever the law of the drive behind it is.

use mindgap_foundations::motion::{Axis, Motion};
use mindgap_foundations::statistics::summary::median;
use mindgap_logs::samples::{self, MotionSample};
use mindgap_logs::{Logs, Robot};
use mindgap_models::effects::context::{CommandHistory, RunHistory};
use mindgap_models::effects::drive_filter::{DriveFilter, FilteredDrive, MostChange};
use mindgap_models::effects::pieces::Pieces;
use mindgap_models::simulator::nominal::motion_bias::{FEATURES, features};
use nalgebra::{DMatrix, DVector};

/// Times that are tried first, steps. A longer one would leave a controller without any sense of what it does.
const TRIED_STEPS: [f64; 7] = [0.0, 0.25, 0.5, 1.0, 1.5, 2.0, 3.0];
/// The best of them is refined in moves of this size, halved until the last, steps: a hundredth of a step changes the motion by
/// less than a tracker sees.
const FIRST_MOVE_STEPS: f64 = 0.25;
const LAST_MOVE_STEPS: f64 = 0.01;
/// Steps that suffice: more are thinned out.
const MOST: usize = 2000;
/// Steps per feature below which nothing is learned: the regression would follow the noise.
const FEWEST_PER_FEATURE: usize = 3;
/// Nats per step that a filter has to gain over none. Robots that respond within a step lose by it; 100 ms of dead time and
/// 100 ms of lag at steps of 400 ms gain 0.01, twice as much of each gains 1.6.
const LEAST_NATS_PER_STEP: f64 = 0.005;
/// Residuals beyond this many median magnitudes are the tracker's, and left out.
const FARTHEST: f64 = 10.0;
/// Ratio of noise variance to prior variance, which keeps the regression solvable where commands are few.
const RIDGE: f64 = 0.1;

/// Returns the filter of the robot that was logged; none where it responds within a step.
pub fn learn(logs: &Logs) -> DriveFilter {
    let Some(regression) = Regression::new(logs) else { return DriveFilter::default() };
    let best = regression.most_likely();
    let likelihood = |filter| regression.log_likelihood(filter, Inputs::NowAndBefore);
    let gain = (likelihood(best) - likelihood(DriveFilter::default())) / regression.steps.len() as f64;
    log::info!("{best:?} gains {gain:.4} nats per step");
    if gain > LEAST_NATS_PER_STEP { regression.with_drift(best) } else { DriveFilter::default() }
}

/// Returns the steps of logs with commands as they come out of a filter, less the drift that it adds.
pub fn steps(filter: DriveFilter, logs: &Logs) -> impl Iterator<Item = MotionSample> {
    let drive = FilteredDrive::from(filter);
    sent(logs).map(move |(step, commands)| filtered(&drive, step, &commands, &logs.robot))
}

/// The commands so far, by steps and at their own times.
type Sent = (CommandHistory, Pieces);

/// Returns the steps of logs, each with the commands so far.
fn sent(logs: &Logs) -> impl Iterator<Item = (MotionSample, Sent)> {
    let (mut run, mut rows, mut history) = (0, 0, RunHistory::default());
    samples::steps(logs).map(move |step| {
        if step.run != run {
            (run, rows, history) = (step.run, 0, RunHistory::default());
        }
        while rows <= step.row {
            history.command_of(&logs.runs[run].rows, rows);
            rows += 1;
        }
        (step, (*history.commands(), *history.pieces()))
    })
}

fn filtered(drive: &FilteredDrive, step: MotionSample, (commands, pieces): &Sent, robot: &Robot) -> MotionSample {
    let speeds = drive.speeds_of(commands, pieces, robot);
    MotionSample { speeds: speeds.inputs(), lateral_cm: step.lateral_cm - speeds.drift_cm, ..step }
}

/// Dead time, lag, lag of the turn, and the steps in which a ramp changes speed and turn by the reference speed.
type Times = [f64; 5];

/// What a ramp acts on.
#[derive(Clone, Copy)]
enum Ramp {
    None,
    Wheel,
    Twist,
}

impl Ramp {
    fn filter(self, [dead_time_steps, lag_steps, turn_lag_steps, ramp_steps, turn_ramp_steps]: Times) -> DriveFilter {
        let change = |steps: f64| 1.0 / steps.max(LAST_MOVE_STEPS);
        let most_change = match self {
            Ramp::None => None,
            Ramp::Wheel => Some(MostChange::Wheel(change(ramp_steps))),
            Ramp::Twist => Some(MostChange::Twist([change(ramp_steps), change(turn_ramp_steps)])),
        };
        DriveFilter { dead_time_steps, lag_steps, turn_lag_steps, most_change, ..DriveFilter::default() }
    }

    /// Returns the directions in which times are refined. They stand for each other in part, so they are also moved against each
    /// other.
    fn moves(self) -> &'static [Times] {
        const MOVES: [Times; 8] = [
            [1.0, 0.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0, 0.0],
            [1.0, -1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, -1.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 1.0, 0.0],
            [0.0, 1.0, 0.0, -1.0, 0.0],
            [0.0, 0.0, 0.0, 0.0, 1.0],
        ];
        match self {
            Ramp::None => &MOVES[..5],
            Ramp::Wheel => &MOVES[..7],
            Ramp::Twist => &MOVES,
        }
    }
}

/// What a step is predicted from.
#[derive(Clone, Copy)]
enum Inputs {
    /// The mean speeds in the step alone, which is all that the right filter leaves to know.
    Now,
    /// Those and the speeds with which it begins, as the networks have them.
    NowAndBefore,
}

impl Inputs {
    fn of(self, [left, right, left_before, right_before]: [f64; 4]) -> [f64; 4] {
        match self {
            Inputs::Now => [left, right, left, right],
            Inputs::NowAndBefore => [left, right, left_before, right_before],
        }
    }
}

/// The regression of steps on filtered commands.
struct Regression<'a> {
    robot: &'a Robot,
    /// Scales commands to about one.
    share: f32,
    /// The steps that are used, each with the commands so far.
    steps: Vec<(MotionSample, Sent)>,
}

impl<'a> Regression<'a> {
    /// Returns `None` where there are too few steps.
    fn new(logs: &'a Logs) -> Option<Self> {
        let (count, top) = samples::steps(logs).fold((0, 0.0), |(count, top), step| {
            (count + 1, step.speeds.iter().fold(top, |top: f64, command| top.max(command.abs())))
        });
        let steps: Vec<_> = sent(logs).step_by(usize::div_ceil(count, MOST).max(1)).collect();
        if top == 0.0 || steps.len() < FEWEST_PER_FEATURE * FEATURES {
            return None;
        }
        let mut regression = Regression { robot: &logs.robot, share: (1.0 / top) as f32, steps };
        let residuals = regression.residuals(DriveFilter::default(), Inputs::NowAndBefore);
        let widths = Motion::from_fn(|axis| median(residuals.iter().map(|r| r[axis].abs())));
        let is_near = |r: &Motion<f64>| Axis::ALL.iter().all(|axis| r[*axis].abs() <= FARTHEST * widths[*axis]);
        let near = regression.steps.into_iter().zip(&residuals).filter(|(_, residual)| is_near(residual));
        regression.steps = near.map(|(step, _)| step).collect();
        Some(regression)
    }

    /// Returns the most likely filter: with a ramp only where that gains enough over none.
    fn most_likely(&self) -> DriveFilter {
        let times = TRIED_STEPS.iter().flat_map(|dead| TRIED_STEPS.iter().map(move |lag| [*dead, *lag, 0.0, 0.0, 0.0]));
        let (without, likelihood) = self.refined(times.collect(), Ramp::None);
        let least = likelihood + LEAST_NATS_PER_STEP * self.steps.len() as f64;
        let ramps = TRIED_STEPS[1..].iter().flat_map(|ramp| TRIED_STEPS.map(|dead| [dead, 0.0, 0.0, *ramp, *ramp]));
        let of_wheels = self.refined(ramps.collect(), Ramp::Wheel);
        let of_twist = self.refined(vec![of_wheels.0], Ramp::Twist);
        let kinds = [(Ramp::Wheel, of_wheels), (Ramp::Twist, of_twist)];
        let best = kinds.into_iter().max_by(|(_, (_, a)), (_, (_, b))| a.total_cmp(b));
        match best.filter(|(_, (_, likelihood))| *likelihood > least) {
            Some((kind, (times, _))) => kind.filter(times),
            None => Ramp::None.filter(without),
        }
    }

    /// Refines the best of some times, with a ramp of this kind. Returns their log-likelihood with them.
    fn refined(&self, starts: Vec<Times>, ramp: Ramp) -> (Times, f64) {
        let tried = |times: Times| (times, self.log_likelihood(ramp.filter(times), Inputs::Now));
        let better = |a: (Times, f64), b: (Times, f64)| if b.1 > a.1 { b } else { a };
        let mut best = starts.into_iter().map(tried).fold(([0.0; 5], f64::NEG_INFINITY), better);
        let mut by = FIRST_MOVE_STEPS;
        while by >= LAST_MOVE_STEPS {
            let moved = ramp.moves().iter().flat_map(|direction| {
                let along = |by: f64| std::array::from_fn(|i| (best.0[i] + by * direction[i]).max(0.0));
                [along(by), along(-by)]
            });
            let next = moved.map(tried).fold(best, better);
            if next.1 == best.1 {
                by *= 0.5;
            }
            best = next;
        }
        best
    }

    /// Returns the log-likelihood of the steps behind a filter, with the law of the drive and its noise at their best.
    fn log_likelihood(&self, filter: DriveFilter, inputs: Inputs) -> f64 {
        let residuals = self.residuals(filter, inputs);
        let count = residuals.len() as f64;
        let of_axis = |axis: Axis| {
            let mean_square = residuals.iter().map(|r| r[axis] * r[axis]).sum::<f64>() / count;
            -0.5 * count * libm::log(mean_square.max(f64::MIN_POSITIVE))
        };
        Axis::ALL.into_iter().map(of_axis).sum()
    }

    /// Returns the filter with the drift that the logs show.
    fn with_drift(&self, filter: DriveFilter) -> DriveFilter {
        let lateral = |drift_factor: f64| {
            let residuals = self.residuals(DriveFilter { drift_factor, ..filter }, Inputs::NowAndBefore);
            residuals.into_iter().map(|residual| residual.lateral)
        };
        // Residuals are linear in the factor.
        let (mut product, mut square) = (0.0, 0.0);
        for (without, with) in lateral(0.0).zip(lateral(1.0)) {
            product += without * (without - with);
            square += (without - with) * (without - with);
        }
        DriveFilter { drift_factor: if square > 0.0 { product / square } else { 0.0 }, ..filter }
    }

    /// Returns what a regression on the filtered commands leaves of the steps.
    fn residuals(&self, filter: DriveFilter, inputs: Inputs) -> Vec<Motion<f64>> {
        let drive = FilteredDrive::from(filter);
        let steps = self.steps.iter().map(|(step, commands)| filtered(&drive, *step, commands, self.robot));
        let (rows, logged): (Vec<[f64; FEATURES]>, Vec<Motion<f64>>) =
            steps.map(|step| (features(inputs.of(step.speeds), self.share), step.motion())).unzip();
        let rows = DMatrix::from_row_iterator(rows.len(), FEATURES, rows.into_iter().flatten());
        let factor = (rows.tr_mul(&rows) + DMatrix::identity(FEATURES, FEATURES) * RIDGE).cholesky();
        let left = Motion::from_fn(|axis| {
            let logged = DVector::from_iterator(logged.len(), logged.iter().map(|motion| motion[axis]));
            let weights = factor.as_ref().map(|factor| factor.solve(&rows.tr_mul(&logged)));
            weights.map_or(logged.clone(), |weights| logged - &rows * weights)
        });
        (0..logged.len()).map(|i| Motion::from_fn(|axis| left[axis][i])).collect()
    }
}
