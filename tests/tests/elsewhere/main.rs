//! Logs from elsewhere: other robots, other programs. They are not part of the project, so most machines lack them, and
//! there each of these tests is reported as ignored, by name.

mod gap_cases;
mod gap_real;
mod injections;
mod inspection;
mod own_robot;
mod reading;
mod sonar_law;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use libtest_mimic::{Arguments, Trial};
use mindgap_tests::command::workspace;

/// A test with the path of the logs that it needs, from the folder of all of them.
macro_rules! trial {
    ($module:ident::$test:ident, $logs:literal) => {
        trial(concat!(stringify!($module), "::", stringify!($test)), $logs, $module::$test)
    };
}

fn main() -> ExitCode {
    let trials = vec![
        trial!(gap_cases::effects_of_another_robot_are_named, "data"),
        trial!(gap_cases::minimal_method_agrees_with_the_full_one, "data"),
        trial!(gap_real::the_ends_of_a_neatos_runs_show_its_gap_to_the_textbook, "real/neato"),
        trial!(gap_real::the_loss_in_turns_of_a_real_robot_is_found_as_a_formula, "real/create"),
        trial!(gap_real::a_real_sonar_that_stands_still_is_compared_with_the_textbook, "real/nxt-sonar"),
        trial!(injections::changes_of_a_real_drive_are_named, "real/create"),
        trial!(injections::changes_of_a_real_sonar_that_stands_still_are_named, "real/nxt-sonar/sacha_repeat"),
        trial!(inspection::made_up_logs_stay_as_they_are, "data"),
        trial!(inspection::scans_at_rest_stay_as_they_are, "real/nxt-sonar"),
        trial!(inspection::a_drive_cut_into_runs_starts_moving, "real/create"),
        trial!(inspection::faults_of_another_robots_logs_are_found, "data/nominal-holdout"),
        trial!(inspection::faults_of_a_real_drives_logs_are_found, "real/create"),
        trial!(own_robot::streams_lead_to_the_causes_in_three_commands, "real/create"),
        trial!(reading::nominal_logs_are_read_without_a_warning, "data"),
        trial!(reading::a_real_sonar_that_stands_still_trains_the_two_sonar_networks, "real/nxt-sonar/kentheo"),
        trial!(sonar_law::a_scan_elsewhere_is_likely_by_the_first_echo_law, "real/nxt-sonar/chunnx"),
        trial!(reading::the_scene_with_four_obstacles_is_read, "data/scenes/four-obstacles.toml"),
    ];
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

/// A test that is ignored where there are no logs from elsewhere at all; where there are some, those that it needs have
/// to be among them.
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

/// `$MINDGAP_SHARED`, or `shared` beside the workspace.
fn folder() -> PathBuf {
    std::env::var_os("MINDGAP_SHARED").map_or_else(|| workspace().join("../shared"), PathBuf::from)
}
