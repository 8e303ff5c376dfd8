//! Speed and turn rate over the time of one run: as commanded, of the robot, and of the simulator.

use maud::html;

use super::Subject;
use crate::document::{Section, chart, table};
use crate::rates::{self, Rates};
use crate::words;
use mindgap_figures::report::curves::{Curve, CurveChart, Point};
use mindgap_learning::evaluation::replay::{Moment, PUT_BACK_STEPS, Player};
use mindgap_logs::{Robot, Run};

/// Runs among which the one with the largest differences is shown; more would only take longer.
const MOST_RUNS: usize = 40;

/// The curves, in the order of [`Step::rates`].
const CURVES: [&str; 3] = ["commanded", "the robot", "the simulator"];

/// A step of a run.
struct Step {
    /// When it begins, in seconds since the first row.
    t_s: f64,
    /// As commanded, of the robot, and of the simulator; without a pose at both ends there are none.
    rates: [Option<Rates>; 3],
}

/// The section; `None` where motion is not compared.
pub fn section(subject: &Subject) -> Option<Section> {
    let Subject { logs, baseline, .. } = subject;
    baseline.motion.as_ref()?;
    let (player, chain) = (Player::new(baseline, logs), baseline.chain());
    let runs = logs.runs.iter().take(MOST_RUNS).map(|run| {
        // Within these steps the simulated robot is never put back to the logged pose.
        let run = Run { name: run.name.clone(), rows: run.rows.beginning(PUT_BACK_STEPS) };
        let steps = steps(&logs.robot, &run, &[Player::logged(&run), player.simulated(&chain, &run)]);
        (run.name, steps)
    });
    let is_tracked = |steps: &[Step]| steps.iter().filter(|step| step.rates[1].is_some()).count() > 1;
    let shown = runs.filter(|(_, steps)| is_tracked(steps));
    let (name, steps) = shown.max_by(|a, b| difference(&a.1).total_cmp(&difference(&b.1)))?;
    let caption = format!(
        "{}, each step on its own: what the commands ask for by the textbook, what the robot did, and what the simulator predicts.",
        name
    );
    let body = html! {
        (chart("speed", &curves(&steps, 0, "forward speed (cm/s)").draw(), "Forward speed over time.", html! { (caption) }))
        (chart("turn-rate", &curves(&steps, 1, "turn rate (degrees/s)").draw(), "Turn rate over time.", html! {
            "Positive is to the left. The gap lies where the robot and the simulator differ."
        }))
        (table("The same in numbers", HEADER, &rows(&steps)))
    };
    Some(Section { id: "speeds", title: "Commanded, driven and simulated", body })
}

const HEADER: [&str; 7] = [
    "time (s)",
    "commanded (cm/s)",
    "robot (cm/s)",
    "simulator (cm/s)",
    "commanded (degrees/s)",
    "robot (degrees/s)",
    "simulator (degrees/s)",
];

/// Returns the steps of a run with the commands' speeds by the textbook's differential drive, and those of two robots.
fn steps(robot: &Robot, run: &Run, robots: &[Vec<Moment>; 2]) -> Vec<Step> {
    let step = |k: usize| {
        let [first_s, begin_s, end_s] = [0, k, k + 1].map(|k| run.rows.at(k).t_ms / 1000.0);
        let commanded = rates::commanded(robot, run.rows.at(k).command());
        let driven =
            |moments: &Vec<Moment>| Some(rates::driven(&moments[k].pose?, &moments[k + 1].pose?, end_s - begin_s));
        let [robot, simulator] = robots.each_ref().map(driven);
        Step { t_s: begin_s - first_s, rates: [Some(commanded), robot, simulator] }
    };
    (0..run.rows.len().saturating_sub(1)).map(step).collect()
}

/// Returns the mean difference between robot and simulator, each rate relative to the robot's mean.
fn difference(steps: &[Step]) -> f64 {
    let pairs = || steps.iter().filter_map(|step| step.rates[1].zip(step.rates[2]));
    let of = |i: usize| {
        let differences: f64 = pairs().map(|(robot, simulator)| (robot[i] - simulator[i]).abs()).sum();
        differences / pairs().map(|(robot, _)| robot[i].abs()).sum::<f64>().max(1.0)
    };
    of(0) + of(1)
}

fn curves(steps: &[Step], rate: usize, y_name: &str) -> CurveChart {
    let curve = |(i, name): (usize, &str)| Curve {
        name: name.into(),
        points: steps.iter().filter_map(|step| Some(Point::new(step.t_s, step.rates[i]?[rate]))).collect(),
    };
    let curves = CURVES.into_iter().enumerate().map(curve).collect();
    CurveChart { x_name: "time (s)".into(), y_name: y_name.into(), curves, ..CurveChart::default() }
}

fn rows(steps: &[Step]) -> Vec<[String; 7]> {
    let row = |step: &Step| {
        let number =
            |rate: usize| step.rates.map(|rates| rates.map_or_else(String::new, |r| words::number(r[rate], 1)));
        let ([a, b, c], [d, e, f]) = (number(0), number(1));
        [words::number(step.t_s, 1), a, b, c, d, e, f]
    };
    steps.iter().map(row).collect()
}
