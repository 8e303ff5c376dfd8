use super::*;
use crate::made_up::{EVIL, logs};
use glam::DVec2;

fn page_of(logs: &Logs, folder: &str, notes: &[String]) -> String {
    let (survey, corrected) = Survey::with_logs(logs.clone());
    page(&Subject { survey: &survey, logged: logs, corrected: &corrected, folder, notes })
}

/// Returns logs of runs that differ, so that none counts as a copy.
fn different(runs: usize, rows: usize, name: &str) -> Logs {
    let mut logs = logs(runs, rows, name);
    for (number, run) in logs.runs.iter_mut().enumerate() {
        run.rows.edit_poses(|pose| pose.position_cm.y += 0.01 * number as f64);
    }
    logs
}

#[test]
fn markup_in_names_and_notes_is_escaped() {
    let page = page_of(&different(3, 40, EVIL), EVIL, &[EVIL.into()]);
    assert!(!page.contains("<x-mark") && page.contains("&lt;x-mark"), "markup came through");
    assert!(!page.contains("<script"), "charts need no scripts");
}

#[test]
fn hundreds_of_runs_are_thinned_out_and_the_page_says_so() {
    let page = page_of(&different(500, 200, "run-"), "logs", &[]);
    assert!(page.len() < 600_000, "{} bytes", page.len());
    assert!(page.contains("40 of 500 runs") && page.contains("4 of 500 runs"));
}

#[test]
fn rows_with_a_defect_are_named_by_run_and_line_and_marked() {
    let mut copied = different(4, 30, "run-");
    let mut copy = copied.runs[1].clone();
    copy.name = "run-copy".into();
    copied.runs.push(copy);
    let page = page_of(&copied, "logs", &[]);
    assert!(page.contains("run_copied, excluded") && page.contains("run-copy: all rows"));
    assert!(page.contains("run-copy, row 1: run_copied") && page.contains("<h3>run-copy (excluded)</h3>"));
}

#[test]
fn logs_without_poses_or_readings_have_a_page_that_says_so() {
    let mut blind = different(3, 30, "run-");
    blind.runs.iter_mut().for_each(|run| run.rows.edit_each(|row| row.pose = None));
    let page = page_of(&blind, "logs", &[]);
    assert!(page.contains("never saw the robot") && !page.contains("data-chart=\"driven\""));
    assert!(page.contains("readings cannot be compared with distances"));
    blind.robot.ultrasonic = None;
    assert!(!page_of(&blind, "logs", &[]).contains("id=\"readings\""));
}

#[test]
fn readings_are_drawn_against_distance_and_angle() {
    let mut walled = different(3, 30, "run-");
    walled.scene.arena_cm = Some(DVec2::new(300.0, 200.0));
    walled.runs.iter_mut().for_each(|run| run.rows.edit_each(|row| row.echo_cm = Some(200.0)));
    let page = page_of(&walled, "logs", &[]);
    for chart in ["by-distance", "by-angle", "covered"] {
        assert!(page.contains(&format!("data-chart=\"{chart}\"")), "{chart}");
    }
    assert!(page.contains("90 of 90 rows in which the pose is known"), "how many");
}
