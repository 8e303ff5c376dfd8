//! Chooses the robot among several bodies of a track: the one that moves as commanded.

use std::path::Path;

use super::clocks::{align, lag};
use super::file_streams::BodyTrack;
use super::frame::Frame;
use super::left_out::LeftOut;
use super::motion::{CumulativeMotion, by_camera};
use super::recording::{Commands, Kind};
use mindgap_foundations::error::{Error, Result};

/// A body whose path is shorter than this and that turns less than [`STILL_RAD`] stands still, cm.
const STILL_CM: f64 = 5.0;
/// See [`STILL_CM`], rad.
const STILL_RAD: f64 = 0.3;
/// Motion lags the commands by at most this on a common clock, ms.
const MAX_LAG_MS: f64 = 1000.0;
/// Time between samples of the commanded motion, ms.
const STEP_MS: f64 = 200.0;
/// The robot leaves at most this fraction of what the next best body leaves unexplained.
const MAX_RATIO: f64 = 0.7;

/// Returns the robot's track and the bodies that are left out.
///
/// # Errors
/// When the named body does not exist, or several move alike.
pub fn robot(
    file: &Path,
    mut bodies: Vec<BodyTrack>,
    commands: &Commands,
    named: Option<&str>,
) -> Result<(BodyTrack, Vec<LeftOut>)> {
    let names = bodies.iter().map(|body| body.name.as_str()).collect::<Vec<_>>().join(", ");
    let (chosen, reason) = if let Some(named) = named {
        let found = bodies.iter().position(|body| body.name == named);
        let what = || Error::in_file(file, format!("has no body {named:?} for --body: its bodies are {names}"));
        (found.ok_or_else(what)?, "another body is chosen with --body")
    } else if bodies.len() == 1 {
        (0, "")
    } else {
        let moving: Vec<usize> = (0..bodies.len()).filter(|i| !is_still(&bodies[*i])).collect();
        match moving.as_slice() {
            [one] => (*one, "it stands still"),
            moving => {
                let commanded = commanded(commands);
                let mut ranked: Vec<(f64, usize)> =
                    moving.iter().map(|i| (unexplained(&commanded, &bodies[*i]), *i)).collect();
                ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
                match ranked.as_slice() {
                    [best, next, ..] if best.0 < MAX_RATIO * next.0 => (best.1, "it does not move as commanded"),
                    _ => {
                        let what =
                            format!("has several bodies that could be the robot: choose one of {names} with --body");
                        return Err(Error::in_file(file, what));
                    }
                }
            }
        }
    };
    let robot = bodies.swap_remove(chosen);
    bodies.sort_by(|a, b| a.name.cmp(&b.name));
    let others = bodies.into_iter().map(|body| LeftOut::body(&body.name, Some(body.frames.len()), reason));
    Ok((robot, others.collect()))
}

fn is_still(body: &BodyTrack) -> bool {
    let mut frames = body.frames.iter().flatten();
    let Some(first) = frames.next() else { return true };
    frames.all(|frame| {
        let change = first.pose.relative(&frame.pose);
        change.position_cm.length() < STILL_CM && change.heading_rad.abs() < STILL_RAD
    })
}

/// Returns the fraction of the body's motion that the commands do not explain, whatever the robot's dimensions.
fn unexplained(commanded: &[CumulativeMotion], body: &BodyTrack) -> f64 {
    let frames: Vec<Frame> = body.frames.iter().flatten().copied().collect();
    let in_order = frames.windows(2).all(|pair| pair[0].t_ms < pair[1].t_ms);
    let tracked = by_camera(if in_order { &frames } else { &[] });
    let on_one_clock = lag(commanded, &tracked, MAX_LAG_MS).map_or(1.0, |(_, unexplained)| unexplained);
    // Clocks are aligned only where they cannot be one.
    if on_one_clock < 0.5 {
        return on_one_clock;
    }
    align(commanded, &tracked).map_or(1.0, |found| found.unexplained.min(on_one_clock))
}

/// Integrates the commanded motion up to a factor per component, which comparisons ignore.
fn commanded(commands: &Commands) -> Vec<CumulativeMotion> {
    let Some(((first_ms, _), (last_ms, _))) = commands.samples.first().zip(commands.samples.last()) else {
        return Vec::new();
    };
    let mut by = [0.0; 2];
    let steps = ((last_ms - first_ms) / STEP_MS) as usize;
    let motion = (0..steps).map(|step| {
        let from_ms = first_ms + step as f64 * STEP_MS;
        let [a, b] = commands.mean(from_ms, from_ms + STEP_MS);
        let moved = if commands.kind == Kind::Twist { [b, a] } else { [b - a, a + b] };
        by = [by[0] + moved[0], by[1] + moved[1]];
        CumulativeMotion { t_ms: from_ms + STEP_MS, by }
    });
    motion.collect()
}
