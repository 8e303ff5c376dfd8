//! Checks the path of the robot against the map.

use super::finding::Finding;
use crate::{Logs, Row, Scene};
use glam::DVec2;
use mindgap_foundations::geometry::Rectangle;

/// The tracker may be off by this much at a wall, cm.
const TOLERANCE_CM: f64 = 5.0;
/// Fewer rows beyond walls may be errors of the tracker.
const MIN_ROWS: usize = 10;
/// Minimum fraction of poses that contradict the map.
const MIN_FRACTION: f64 = 0.02;

/// Reports a path that leaves the arena or passes through obstacles.
pub fn check(logs: &Logs) -> Vec<Finding> {
    let [outside, inside] = [outside as fn(&Scene, DVec2) -> bool, within_obstacle].map(|is_impossible| {
        let rows = logs.runs.iter().enumerate().flat_map(|(run, r)| {
            let impossible = move |(_, row): &(usize, Row)| {
                row.pose.is_some_and(|pose| is_impossible(&logs.scene, pose.position_cm))
            };
            r.rows.iter().enumerate().filter(impossible).map(move |(row, _)| (run, row))
        });
        rows.collect::<Vec<_>>()
    });
    let seen = logs.runs.iter().flat_map(|run| &run.rows).filter(|row| row.pose.is_some()).count() as f64;
    let is_enough = |rows: &[(usize, usize)]| rows.len() >= MIN_ROWS && rows.len() as f64 >= MIN_FRACTION * seen;
    let mut findings = Vec::new();
    if is_enough(&outside) {
        let sentence = format!(
            "The robot drives {} of the arena: the map is wrong (width_cm, height_cm), or poses are in another frame.",
            beyond(logs, &outside)
        );
        findings.push(Finding::of_readings(logs, "path_outside_arena", &outside, sentence));
    }
    if is_enough(&inside) {
        let names: Vec<String> = (1..)
            .zip(&logs.scene.obstacles)
            .filter(|(_, obstacle)| {
                let shrunk = shrunk(obstacle);
                inside.iter().any(|(run, row)| {
                    logs.runs[*run].rows.at(*row).pose.is_some_and(|pose| shrunk.contains(pose.position_cm))
                })
            })
            .map(|(number, obstacle)| format!("{number} (x_cm = {}, y_cm = {})", obstacle.low_cm.x, obstacle.low_cm.y))
            .collect();
        let sentence = format!(
            "The robot drives through obstacle {}: the map is wrong; x_cm and y_cm are an obstacle's lower-left corner, not its \
             centre.",
            names.join(", ")
        );
        findings.push(Finding::of_readings(logs, "path_through_obstacle", &inside, sentence));
    }
    findings
}

fn outside(scene: &Scene, at_cm: DVec2) -> bool {
    scene
        .arena_cm
        .is_some_and(|size_cm| at_cm.min_element() < -TOLERANCE_CM || (at_cm - size_cm).max_element() > TOLERANCE_CM)
}

fn within_obstacle(scene: &Scene, at_cm: DVec2) -> bool {
    scene.obstacles.iter().any(|obstacle| shrunk(obstacle).contains(at_cm))
}

/// Returns an obstacle without its margin, in which a robot may seem to be.
fn shrunk(obstacle: &Rectangle) -> Rectangle {
    let margin_cm = DVec2::splat(TOLERANCE_CM);
    Rectangle { low_cm: obstacle.low_cm + margin_cm, high_cm: obstacle.high_cm - margin_cm }
}

/// Returns how far rows lie outside the arena, in words.
fn beyond(logs: &Logs, rows: &[(usize, usize)]) -> String {
    let size_cm = logs.scene.arena_cm.unwrap_or_default();
    let mut farthest = (0.0, "");
    for (run, row) in rows {
        let Some(pose) = logs.runs[*run].rows.at(*row).pose else { continue };
        let at_cm = pose.position_cm;
        let sides = [
            (-at_cm.x, "to the left"),
            (at_cm.x - size_cm.x, "to the right"),
            (-at_cm.y, "below"),
            (at_cm.y - size_cm.y, "above"),
        ];
        sides.into_iter().for_each(|side| farthest = if side.0 > farthest.0 { side } else { farthest });
    }
    format!("up to {:.0} cm {}", farthest.0, farthest.1)
}
