//! Commands, speeds and readings over the time of a few runs.

use glam::DVec2;
use maud::{Markup, html};

use super::drawn::{Drawn, MARKED, chosen};
use super::paths::how_many;
use crate::document::{Section, chart};
use crate::rates::{self, Rates};
use crate::words;
use mindgap_diagnosis::split;
use mindgap_figures::report::curves::{Curve, CurveChart, Point};
use mindgap_logs::samples::{self, LONGEST_STEP, wheels_cm};
use mindgap_logs::{Logs, Robot, Row, Run};

/// Runs that are shown.
const MOST_RUNS: usize = 4;
/// Points of a curve: more than there are pixels along a chart.
const MOST_POINTS: usize = 600;

/// Points of a curve; those that are not finite break it.
type Points = Vec<DVec2>;

/// The section.
pub fn section(runs: &[Drawn], corrected: &Logs) -> Section {
    let shown = chosen(runs, MOST_RUNS);
    let step_ms = split::step_ms(corrected.robot.step_ms);
    let body = html! {
        p {
            (how_many(shown.len(), runs.len()))
            " Commanded speeds are those that the commands ask for by the textbook, from the dimensions in robot.toml. Measured "
            "speeds are means over " (words::number(step_ms, 0)) " ms. Speeds are positive forwards and to the left."
        }
        @for drawn in shown { (run(drawn, corrected, step_ms)) }
    };
    Section { id: "speeds", title: "Commands, speeds and readings over time", body }
}

fn run(drawn: &Drawn, corrected: &Logs, step_ms: f64) -> Markup {
    let Logs { robot, scene, .. } = corrected;
    let run = drawn.run;
    let own = Logs { robot: *robot, scene: scene.clone(), runs: vec![run.clone()] };
    let coarse = if step_ms > robot.step_ms { own.resampled(step_ms) } else { own.clone() };
    let commands = commands(run);
    let wheel =
        |wheel: usize| -> Points { commands.iter().map(|(t_s, command)| DVec2::new(*t_s, command[wheel])).collect() };
    let of_commands = vec![("left", wheel(0)), ("right", wheel(1))];
    let asked: Vec<(f64, Option<Rates>)> =
        commands.iter().map(|(t_s, command)| (*t_s, Some(rates::commanded(robot, *command)))).collect();
    let measured = coarse.runs.first().map(|run| Measured::of(run, &coarse.robot)).unwrap_or_default();
    let [forward, turn] = [0, 1].map(|rate| {
        let gyro = if rate == 1 { measured.gyro.clone() } else { Vec::new() };
        vec![
            ("commanded", rate_of(&asked, rate)),
            ("tracked", rate_of(&measured.tracked, rate)),
            ("rotation counters", rate_of(&measured.counters, rate)),
            ("gyro", gyro),
        ]
    });
    let marked = bands(drawn);
    let draw = |name: &str, y_name: &str, curves: Vec<(&str, Points)>| {
        let curves: Vec<(&str, Points)> =
            curves.into_iter().filter(|(_, points)| points.iter().any(|point| point.is_finite())).collect();
        let said = format!("{}: {y_name} over time: {}.", run.name, described(&curves));
        let figure = CurveChart {
            x_name: "time (s)".into(),
            y_name: y_name.into(),
            curves: curves.into_iter().map(|(name, points)| curve(name, points)).collect(),
            dense: true,
            bands: marked.clone(),
            bands_name: MARKED.into(),
            ..CurveChart::default()
        };
        chart(name, &figure.draw(), &said, html! {})
    };
    html! {
        h3 { (drawn.name()) }
        div.pairs {
            (draw("commands", "command (% of full speed)", of_commands))
            (draw("forward", "forward speed (cm/s)", forward))
            (draw("turn", "turn rate (degrees/s)", turn))
            @if robot.ultrasonic.is_some() { (draw("reading", "reading (cm)", readings(&own))) }
        }
    }
}

/// Readings of the first range sensor of a run, and the distances to what is straight ahead of it.
fn readings(own: &Logs) -> Vec<(&'static str, Points)> {
    let run = &own.runs[0];
    let mut ahead_cm = vec![f64::NAN; run.rows.len()];
    samples::readings(own).for_each(|sample| ahead_cm[sample.row] = sample.distance_cm);
    let at = |row: &Row, cm: f64| DVec2::new(since_start_s(run, row.t_ms), cm);
    let heard = run.rows.iter().map(|row| at(&row, row.echo_cm.unwrap_or(f64::NAN)));
    let ahead = run.rows.iter().zip(ahead_cm).map(|(row, cm)| at(&row, cm));
    vec![("reading", heard.collect()), ("distance to the wall", ahead.collect())]
}

/// Speeds of a run in the middle of its steps, in seconds since its first row.
#[derive(Default)]
struct Measured {
    tracked: Vec<(f64, Option<Rates>)>,
    counters: Vec<(f64, Option<Rates>)>,
    gyro: Points,
}

impl Measured {
    fn of(run: &Run, robot: &Robot) -> Self {
        let step_s = robot.step_ms / 1000.0;
        let middle_s = |[from, to]: &[Row; 2]| since_start_s(run, 0.5 * (from.t_ms + to.t_ms));
        let steps = || run.rows.pairs().enumerate().map(|(k, rows)| (k, middle_s(&rows), rows));
        let tracked = |(_, t_s, [from, to]): (usize, f64, [Row; 2])| {
            let duration_s = (to.t_ms - from.t_ms) / 1000.0;
            let is_step = duration_s <= LONGEST_STEP * step_s;
            (t_s, from.pose.zip(to.pose).filter(|_| is_step).map(|(from, to)| rates::driven(&from, &to, duration_s)))
        };
        let counters = |(k, t_s, _)| {
            let cm_s = wheels_cm(robot, run, k).map(|wheels| wheels.map(|cm| cm / step_s));
            (t_s, cm_s.map(|cm_s| rates::of_wheels(robot, cm_s)))
        };
        let gyro =
            run.rows.iter().map(|row| DVec2::new(since_start_s(run, row.t_ms), row.gyro_deg_s.unwrap_or(f64::NAN)));
        Measured {
            tracked: steps().map(tracked).collect(),
            counters: steps().map(counters).collect(),
            gyro: gyro.collect(),
        }
    }
}

fn rate_of(speeds: &[(f64, Option<Rates>)], rate: usize) -> Points {
    speeds.iter().map(|(t_s, rates)| DVec2::new(*t_s, rates.map_or(f64::NAN, |rates| rates[rate]))).collect()
}

fn since_start_s(run: &Run, t_ms: f64) -> f64 {
    (t_ms - run.rows.at(0).t_ms) / 1000.0
}

/// Commands with their times, twice each: when they are set, and when the next is.
fn commands(run: &Run) -> Vec<(f64, [f64; 2])> {
    let end_ms = run.rows.at(run.rows.len() - 1).t_ms;
    let set: Vec<(f64, [f64; 2])> = match run.rows.changes() {
        Some(changes) => changes.before(end_ms).iter().map(|change| (change.t_ms, change.command)).collect(),
        None => run.rows.between(0..run.rows.len() - 1).map(|row| (row.t_ms, row.command())).collect(),
    };
    let ends = set.iter().skip(1).map(|(t_ms, _)| *t_ms).chain([end_ms]);
    let held = set.iter().zip(ends).flat_map(|((from_ms, command), to_ms)| [(*from_ms, *command), (to_ms, *command)]);
    held.map(|(t_ms, command)| (since_start_s(run, t_ms), command)).collect()
}

/// Times of the rows with a defect.
fn bands(drawn: &Drawn) -> Vec<(std::ops::Range<f64>, String)> {
    let rows = &drawn.run.rows;
    let last = rows.len() - 1;
    let time = |row: usize| since_start_s(drawn.run, rows.at(row.min(last)).t_ms);
    let band = |(id, [first, end]): &(&'static str, [usize; 2])| (time(*first)..time(end + 1), (*id).to_owned());
    drawn.marked.iter().map(band).collect()
}

/// A curve with few enough points: of each stretch of time its smallest and its largest value.
fn curve(name: &str, points: Points) -> Curve {
    let each = points.len().div_ceil(MOST_POINTS / 2);
    let thinned: Points = match points.len() {
        few if few <= MOST_POINTS => points,
        _ => points.chunks(each).flat_map(extremes).collect(),
    };
    Curve { name: name.into(), points: thinned.into_iter().map(|point| Point::new(point.x, point.y)).collect() }
}

fn extremes(points: &[DVec2]) -> Points {
    let finite = || points.iter().copied().filter(|point| point.is_finite());
    let low = finite().min_by(|a, b| a.y.total_cmp(&b.y));
    let high = finite().max_by(|a, b| a.y.total_cmp(&b.y));
    match low.zip(high) {
        Some((low, high)) if low.x < high.x => vec![low, high],
        Some((low, high)) => vec![high, low],
        None => vec![DVec2::NAN],
    }
}

/// The ranges of curves in words.
fn described(curves: &[(&str, Points)]) -> String {
    let of = |(name, points): &(&str, Points)| {
        let values = || points.iter().map(|point| point.y).filter(|y| y.is_finite());
        let [low, high] = [values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)];
        format!("{name} {} to {}", words::number(low, 0), words::number(high, 0))
    };
    curves.iter().map(of).collect::<Vec<String>>().join(", ")
}
