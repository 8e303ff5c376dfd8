//! The inspection finds faults that are put into the built-in robot's logs, and no others.

use glam::DVec2;
use mindgap_built_in_robot::{ActiveEffect, Effect, default_robot, record, training_room};
use mindgap_diagnosis::{Method, findings};
use mindgap_foundations::executor::Serial;
use mindgap_foundations::geometry::Pose;
use mindgap_learning::learn::train::{TABLE_ONE, Trainer, train};
use mindgap_logs::inspection::{Handling, Inspection, Part};
use mindgap_logs::{Logs, Row};
use mindgap_models::simulator::baseline::Baseline;
use mindgap_tests::faults::{MOTION, RUN, SONAR, assert_found};

fn logs(runs: usize, effects: &[ActiveEffect]) -> Logs {
    record(&default_robot(), &training_room(), runs, 60, effects, 5).expect("room to drive")
}

#[test]
fn faults_are_found_and_corrected_or_left_out() {
    let good = logs(24, &[]);
    assert!(Inspection::new(good.clone()).findings.is_empty());
    MOTION.iter().chain(&SONAR).for_each(|fault| assert_found(&good, fault));
}

/// A changed robot still writes correct logs.
#[test]
fn no_effect_is_mistaken_for_a_fault() {
    for effect in Effect::all().filter(|effect| effect.id() != "lost_commands") {
        let logs = logs(12, &[ActiveEffect::new(effect)]);
        let inspected = Inspection::new(logs.clone());
        assert!(inspected.findings.is_empty(), "{effect}: {:?}", inspected.findings);
        assert!(inspected.logs == logs, "{effect}");
    }
}

/// A controller that makes up for a weak motor commands a turn that the robot does not make, or hardly.
#[test]
fn headings_of_a_robot_that_is_steered_straight_are_kept() {
    let mut logs = logs(1, &[]);
    let mut heading_deg = 0.0;
    for k in 0..logs.runs[0].rows.len() {
        // The median turn is as small as if it were in radians.
        heading_deg += [-0.05, 1.0, -1.0][k % 3];
        let pose = Pose::new(40.0 + 4.0 * k as f64, 110.0, f64::to_radians(heading_deg));
        logs.runs[0].rows.edit(k, |row| {
            [row.left, row.right] = [36.0, 33.0];
            row.pose = Some(pose);
        });
    }
    let inspected = Inspection::new(logs.clone());
    assert!(inspected.findings.iter().all(|found| found.id != "heading_radians"), "{:?}", inspected.findings);
    assert_eq!(inspected.logs, logs);
}

/// A robot that misses its commands for seconds may spin against them by 90 degrees per step, which looks like a jump of the
/// tracker. That happens in few rows, and they are reported.
#[test]
fn lost_commands_look_like_jumps_in_few_rows() {
    let lost = Effect::all().find(|effect| effect.id() == "lost_commands").expect("an effect outside the table");
    let logs = logs(12, &[ActiveEffect::new(lost)]);
    let rows: usize = logs.runs.iter().map(|run| run.rows.len()).sum();
    let findings = Inspection::new(logs).findings;
    assert!(
        findings.iter().all(|found| found.id.starts_with("heading_") && found.withholds.is_empty()),
        "{findings:?}"
    );
    let touched: usize = findings.iter().flat_map(|found| &found.rows_by_run).map(|place| place.rows.len()).sum();
    assert!(50 * touched <= rows, "{touched} of {rows} rows");
}

#[test]
fn a_shifted_clock_of_all_runs_withholds_motion() {
    let mut logs = logs(12, &[]);
    for run in &mut logs.runs {
        let commands: Vec<[f64; 2]> = run.rows.iter().map(|row| row.command()).collect();
        for k in 0..run.rows.len() {
            let command = if k < 2 { [0.0; 2] } else { commands[k - 2] };
            run.rows.edit(k, |row| [row.left, row.right] = command);
        }
    }
    let inspected = Inspection::new(logs);
    let [found] = inspected.findings.as_slice() else { panic!("{:?}", inspected.findings) };
    assert_eq!(found.id, "clock_shifted");
    assert!(found.sentence.contains("ms behind the motion"), "{}", found.sentence);
    assert!(inspected.withheld(Part::Motion).is_some() && inspected.withheld(Part::Sonar).is_none());
}

/// The id of a finding, and what makes a row have it.
type Fault<'a> = (&'a str, &'a dyn Fn(&mut Row));

/// A robot with a gyro, which shows the turn that follows.
fn logs_with_gyro(runs: usize) -> Logs {
    let mut logs = logs(runs, &[]);
    for run in &mut logs.runs {
        for k in 0..run.rows.len() - 1 {
            let [from, to] = [k, k + 1].map(|k| run.rows.at(k));
            let turn = from.pose.zip(to.pose).map(|(from, to)| from.relative(&to).heading_rad.to_degrees());
            let rate = turn.map(|turn| 1000.0 * turn / (to.t_ms - from.t_ms));
            run.rows.edit(k, |row| row.gyro_deg_s = rate);
        }
    }
    logs
}

#[test]
fn counters_and_gyros_that_cannot_be_right_are_left_out() {
    let good = logs_with_gyro(12);
    assert!(Inspection::new(good.clone()).findings.is_empty());
    let change = |row: &mut Row, change: fn(f64) -> f64| {
        row.rot_left_deg = row.rot_left_deg.map(change);
    };
    let faults: [Fault; 6] = [
        ("counter_backwards", &|row| change(row, |deg| -deg)),
        ("counter_wraps", &|row| change(row, |deg| deg.rem_euclid(360.0))),
        ("counter_unit", &|row| change(row, |deg| deg.to_radians())),
        ("gyro_sign", &|row| row.gyro_deg_s = row.gyro_deg_s.map(|rate| -rate)),
        ("gyro_unit", &|row| row.gyro_deg_s = row.gyro_deg_s.map(f64::to_radians)),
        ("gyro_unit", &|row| row.gyro_deg_s = row.gyro_deg_s.map(|rate| -rate.to_radians())),
    ];
    for (id, put) in faults {
        let mut faulty = good.clone();
        faulty.runs.iter_mut().for_each(|run| run.rows.edit_each(put));
        let inspected = Inspection::new(faulty);
        let found: Vec<_> = inspected.findings.iter().map(|found| (found.id, found.handling)).collect();
        assert_eq!(found, [(id, Handling::Excluded)]);
        let mut rows = inspected.logs.runs.iter().flat_map(|run| &run.rows);
        let is_counter = id.starts_with("counter");
        assert!(rows.all(|row| row.rot_left_deg.is_none() == is_counter && row.rot_right_deg.is_some()), "{id}");
    }
}

/// Of a counter that is reset, and of one that overflows at sixteen bits, only the step across the jump is lost.
#[test]
fn a_counter_that_jumps_loses_one_step() {
    for reset in [true, false] {
        let mut faulty = logs(12, &[]);
        let rows = &mut faulty.runs[RUN].rows;
        let at_reset = rows.at(20).rot_right_deg.expect("a counter");
        (20..rows.len()).for_each(|k| {
            rows.edit(k, |row| {
                row.rot_right_deg = row.rot_right_deg.map(|deg| deg - if reset { at_reset + 5000.0 } else { 65536.0 })
            });
        });
        let inspected = Inspection::new(faulty);
        let [found] = inspected.findings.as_slice() else { panic!("{:?}", inspected.findings) };
        assert_eq!((found.id, found.rows_by_run[0].rows.as_slice()), ("counter_jump", [20].as_slice()));
        let rows = &inspected.logs.runs[RUN].rows;
        assert!(rows.at(19).rot_right_deg.is_some() && rows.at(20).rot_right_deg.is_none());
        assert!(rows.at(21).rot_right_deg.is_some());
    }
}

/// Motion capture with another upright axis, read as if z were upright, shows no rotation.
#[test]
fn headings_that_never_change_withhold_everything() {
    for flips in [false, true] {
        let mut logs = logs(12, &[]);
        for run in &mut logs.runs {
            run.rows.edit_poses(|pose| {
                let is_flipped = flips && pose.heading_rad.abs() > 1.5;
                pose.heading_rad = if is_flipped { std::f64::consts::PI } else { 0.0 };
            });
        }
        let inspected = Inspection::new(logs);
        assert!(inspected.findings.iter().any(|found| found.id == "heading_constant"), "{:?}", inspected.findings);
        assert!(inspected.withheld(Part::Motion).is_some() && inspected.withheld(Part::Sonar).is_some());
    }
}

/// Someone carries the robot while its motors are at rest.
#[test]
fn motion_at_zero_commands_is_left_out() {
    let mut logs = logs(12, &[]);
    let rows = &mut logs.runs[RUN].rows;
    rows.truncate(40);
    let (carried, stood) = (26..32, rows.at(20).pose.expect("a pose"));
    for k in 20..rows.len() {
        let carried_cm = 5.0 * k.clamp(carried.start, carried.end) as f64 - 5.0 * carried.start as f64;
        let noise_cm = 0.05 * (k % 3) as f64;
        let [x_cm, y_cm] = (stood.position_cm + DVec2::new(carried_cm, noise_cm)).to_array();
        let pose = Some(Pose::new(x_cm, y_cm, stood.heading_rad));
        rows.edit(k, |row| *row = Row { left: 0.0, right: 0.0, pose, ..*row });
    }
    let inspected = Inspection::new(logs.clone());
    let found: Vec<&str> = inspected.findings.iter().map(|found| found.id).collect();
    assert_eq!(found, ["moves_at_zero_command"]);
    let place = &inspected.findings[0].rows_by_run[0];
    assert_eq!((&place.run, place.rows.first(), place.rows.last()), (&logs.runs[RUN].name, Some(&27), Some(&31)));
}

/// A brick acts a third of a second late, and its runs are cut out of longer drives.
#[test]
fn a_run_cut_from_a_drive_starts_moving() {
    let late: ActiveEffect = "latency=140".parse().expect("an effect");
    let mut logs = logs(12, &[late]);
    assert!(Inspection::new(logs.clone()).findings.is_empty());
    for run in &mut logs.runs {
        let begin_ms = run.rows.at(7).t_ms;
        let cut = run.rows.between(7..run.rows.len()).map(|row| Row { t_ms: row.t_ms - begin_ms, ..row }).collect();
        run.rows = cut;
    }
    let found: Vec<&str> = Inspection::new(logs).findings.iter().map(|found| found.id).collect();
    assert_eq!(found, ["starts_moving"]);
}

#[test]
fn logs_with_little_information_pass() {
    let mut still = logs(6, &[]);
    still.runs.iter_mut().for_each(|run| run.rows.edit_each(|row| (row.left, row.right) = (0.0, 0.0)));
    let mut unseen = logs(6, &[]);
    unseen.runs.iter_mut().for_each(|run| run.rows.edit_each(|row| row.pose = None));
    let mut silent = logs(1, &[]);
    silent.runs.iter_mut().for_each(|run| run.rows.edit_each(|row| row.echo_cm = None));
    let mut sparse = logs(6, &[]);
    for run in &mut sparse.runs {
        (1..run.rows.len()).step_by(2).for_each(|k| run.rows.edit(k, |row| row.pose = None));
    }
    for logs in [still, unseen, silent, sparse] {
        let inspected = Inspection::new(logs.clone());
        assert!(inspected.findings.is_empty() && inspected.logs == logs, "{:?}", inspected.findings);
    }
}

/// A fault of the logs is not a cause of a gap. Corrected faults leave the logs unchanged, as tested above. This test is about
/// faults that are left out or reported.
#[test]
fn no_fault_reaches_a_confident_cause() {
    const SURE: f64 = 0.9;
    let simulator = train(&Serial, &logs(24, &[]), &Trainer::Fast, &TABLE_ONE, 1, &|_| {}).expect("networks");
    let sure_of = |logs: Logs| {
        let baseline = Baseline::at_posterior_mean(&simulator).expect("a reference");
        // Nothing is sure where nothing can be compared.
        let found = findings(baseline, &Inspection::new(logs), Method::default());
        let effects = found.map_or_else(|_| Vec::new(), |found| found.diagnosis.effects.to_vec());
        effects.into_iter().filter(|effect| effect.probability > SURE).map(|effect| effect.id).collect::<Vec<_>>()
    };
    let fresh = |effects: &[ActiveEffect]| {
        record(&default_robot(), &training_room(), 8, 60, effects, 6).expect("room to drive")
    };
    let weak: ActiveEffect = "motor_asymmetry=0.15".parse().expect("an effect");
    assert_eq!(sure_of(fresh(&[weak])), ["motor_asymmetry"], "what is changed in the robot is found in such logs");
    for fault in MOTION.iter().chain(&SONAR).filter(|fault| fault.handling != Handling::Corrected) {
        let mut faulty = fresh(&[]);
        (fault.put)(&mut faulty);
        assert_eq!(sure_of(faulty), Vec::<&str>::new(), "{}", fault.what);
    }
}
