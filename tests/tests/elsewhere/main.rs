//! Tests on logs of other robots and other programs. These logs are not part of the project. On machines without them each test
//! is reported as ignored, by name. So is a test that has only a long form.

mod gap_cases;
mod gap_real;
mod given_cases;
mod injections;
mod inspection;
mod own_robot;
mod reading;
mod sonar_law;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use libtest_mimic::{Arguments, Trial};
use mindgap_tests::command::workspace;
use mindgap_tests::form::is_long;

/// Makes a test from its function and the path of its logs below the folder of all logs.
macro_rules! trial {
    ($module:ident::$test:ident, $logs:literal) => {
        trial(concat!(stringify!($module), "::", stringify!($test)), $logs, $module::$test)
    };
}

fn main() -> ExitCode {
    let mut trials = vec![
        trial!(gap_cases::effects_of_another_robot_are_named, "data"),
        trial!(gap_cases::minimal_method_agrees_with_the_full_one, "data"),
        trial!(gap_cases::a_lagging_robot_with_a_weak_motor_carries_no_load, "cases/lag-and-weak-motor/logs"),
        trial!(gap_real::the_end_poses_of_a_neato_show_its_gap_to_the_kinematic_model, "real/neato"),
        trial!(gap_real::the_loss_in_turns_of_a_real_robot_is_found_as_a_formula, "real/create"),
        trial!(gap_real::a_real_sonar_at_rest_is_compared_with_the_kinematic_model, "real/nxt-sonar"),
        trial!(injections::changes_of_a_real_drive_are_named, "real/create"),
        only_long(trial!(injections::changes_of_a_real_sonar_at_rest_are_named, "real/nxt-sonar/sacha_repeat")),
        trial!(inspection::simulated_logs_are_left_unchanged, "data"),
        trial!(inspection::scans_at_rest_are_left_unchanged, "real/nxt-sonar"),
        trial!(inspection::runs_cut_from_a_drive_start_moving, "real/create"),
        trial!(inspection::faults_of_another_robots_logs_are_found, "data/nominal-holdout"),
        trial!(inspection::faults_of_a_real_drives_logs_are_found, "real/create"),
        trial!(own_robot::streams_lead_to_the_causes_in_three_commands, "real/create"),
        trial!(reading::nominal_logs_are_read_without_a_warning, "data"),
        trial!(reading::a_real_sonar_at_rest_trains_the_two_sonar_networks, "real/nxt-sonar/kentheo"),
        trial!(sonar_law::the_first_echo_law_predicts_scans_at_another_place, "real/nxt-sonar/chunnx"),
        trial!(reading::the_scene_with_four_obstacles_is_read, "data/scenes/four-obstacles.toml"),
    ];
    trials.extend(given_cases::trials(&folder().join("cases")));
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

/// Returns a test that is ignored if the folder of all logs is missing. If the folder is there, the logs must be too.
fn trial(name: &str, logs: &str, test: fn(&Path)) -> Trial {
    let folder = folder();
    let logs = folder.join(logs);
    let run = move || {
        let logs = logs.canonicalize().map_err(|e| format!("{}: {e}", logs.display()))?;
        test(&logs);
        Ok(())
    };
    Trial::test(name, run).with_ignored_flag(!folder.is_dir())
}

/// Ignores a test in the short form.
fn only_long(trial: Trial) -> Trial {
    if is_long() { trial } else { trial.with_ignored_flag(true) }
}

/// Returns `$MINDGAP_SHARED`, or else the folder `shared` next to the workspace.
fn folder() -> PathBuf {
    std::env::var_os("MINDGAP_SHARED").map_or_else(|| workspace().join("../shared"), PathBuf::from)
}
