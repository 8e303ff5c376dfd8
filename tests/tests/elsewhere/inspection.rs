//! The inspection of logs that other robots and other programs wrote.

use std::fs;
use std::path::{Path, PathBuf};

use mindgap_logs::Logs;
use mindgap_logs::inspection::{Handling, Inspection};
use mindgap_tests::faults::{MOTION, SONAR, assert_found};

fn read(folder: &Path) -> Logs {
    Logs::read(folder, |warning| panic!("{warning}")).unwrap_or_else(|problem| panic!("{problem}"))
}

fn folders(parent: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(parent).expect("a folder").map(|entry| entry.expect("an entry").path());
    let mut folders: Vec<PathBuf> = entries.filter(|path| path.join("robot.toml").is_file()).collect();
    folders.sort();
    folders
}

fn inspected(folder: &Path) -> (Logs, Inspection) {
    let logs = read(folder);
    let inspected = Inspection::new(logs.clone());
    for found in &inspected.findings {
        let places = found.rows_by_run.iter().map(|place| format!("{} {:?}", place.run, place.rows));
        let places: String = places.collect::<Vec<_>>().join("; ").chars().take(300).collect();
        println!("{}: {} {:?}: {places}", folder.display(), found.id, found.handling);
    }
    (logs, inspected)
}

/// A changed robot still writes correct logs.
pub fn simulated_logs_are_left_unchanged(data: &Path) {
    let changed: Vec<PathBuf> = folders(data)
        .into_iter()
        .chain(folders(&data.join("cases")))
        .filter(|folder| {
            let (logs, inspected) = inspected(folder);
            !inspected.findings.is_empty() || inspected.logs != logs
        })
        .collect();
    assert!(changed.is_empty(), "{changed:?}");
}

/// The only fault of the scans is a zero where the sensor had no echo.
pub fn scans_at_rest_are_left_unchanged(folder: &Path) {
    for team in folders(folder) {
        let (logs, inspected) = inspected(&team);
        let rows = |logs: &Logs| logs.runs.iter().flat_map(|run| &run.rows).collect::<Vec<_>>();
        for (before, after) in rows(&logs).iter().zip(rows(&inspected.logs)) {
            assert_eq!(before.pose, after.pose);
            assert_eq!(before.echo_cm.filter(|cm| *cm > 0.0), after.echo_cm, "{}", team.display());
        }
        assert!(inspected.findings.iter().all(|found| found.id == "echo_none_number"), "{}", team.display());
    }
}

/// These runs were cut out of longer drives.
pub fn runs_cut_from_a_drive_start_moving(folder: &Path) {
    let (logs, inspected) = inspected(folder);
    let [found] = inspected.findings.as_slice() else { panic!("{:?}", inspected.findings) };
    assert_eq!((found.id, found.handling), ("starts_moving", Handling::Excluded));
    assert!(found.rows_by_run.iter().all(|place| place.rows == [0]));
    assert!(2 * found.rows_by_run.len() > logs.runs.len(), "{} of {}", found.rows_by_run.len(), logs.runs.len());
}

pub fn faults_of_another_robots_logs_are_found(folder: &Path) {
    let good = read(folder);
    MOTION.iter().chain(&SONAR).for_each(|fault| assert_found(&good, fault));
}

/// The robot drives so smoothly that a clock error of 1.6 s in one run cannot be found.
pub fn faults_of_a_real_drives_logs_are_found(folder: &Path) {
    let good = read(folder);
    MOTION.iter().filter(|fault| fault.id != "clock_shifted").for_each(|fault| assert_found(&good, fault));
}
