use mindgap_foundations::geometry::{Pose, wrap_rad};
use mindgap_logs::{Logs, Row, Run, Scene};

/// A robot that drives on at 1 cm in 20 ms and turns from 170 to -170 degrees, its commands rising by one a row.
fn logs() -> Logs {
    let row = |i: u32| {
        let i = f64::from(i);
        let pose = Some(Pose::new(i, 0.0, wrap_rad((170.0 + i).to_radians())));
        Row { t_ms: 20.0 * i, left: i, right: 2.0 * i, pose, echo_cm: Some(100.0 - i), ..Row::default() }
    };
    let mut robot = mindgap_built_in_robot::default_robot();
    robot.step_ms = 20.0;
    Logs {
        robot,
        scene: Scene::default(),
        runs: vec![Run { name: "run-000".into(), rows: (0..=20).map(row).collect() }],
    }
}

#[test]
fn steps_are_as_long_as_asked_for() {
    let resampled = logs().in_steps_of(110.0);
    assert_eq!(resampled.robot.step_ms, 110.0);
    let times: Vec<f64> = resampled.runs[0].rows.iter().map(|row| row.t_ms).collect();
    assert_eq!(times, [0.0, 110.0, 220.0, 330.0]);
}

#[test]
fn a_command_is_the_mean_of_those_held() {
    // Five and a half rows: 0 to 4 held for 20 ms each and 5 for 10 ms.
    let rows = &logs().in_steps_of(110.0).runs[0].rows;
    assert!((rows.at(0).left - (0.0 + 1.0 + 2.0 + 3.0 + 4.0 + 2.5) / 5.5).abs() < 1e-12, "{}", rows.at(0).left);
    assert!((rows.at(1).right - 2.0 * (2.5 + 6.0 + 7.0 + 8.0 + 9.0 + 10.0) / 5.5).abs() < 1e-12);
}

#[test]
fn a_pose_lies_between_its_neighbours_across_the_seam_of_headings() {
    let rows = &logs().in_steps_of(210.0).runs[0].rows;
    let pose = rows.at(1).pose.expect("a pose");
    assert!((pose.position_cm.x - 10.5).abs() < 1e-9);
    assert!((pose.heading_rad.to_degrees() + 179.5).abs() < 1e-9, "{}", pose.heading_rad.to_degrees());
    assert_eq!(rows.at(1).echo_cm, Some(90.0));
}

#[test]
fn where_the_tracker_lost_the_robot_there_is_no_pose() {
    let mut lost = logs();
    lost.runs[0].rows.edit(11, |row| row.pose = None);
    assert!(lost.in_steps_of(210.0).runs[0].rows.at(1).pose.is_none());
    assert!(lost.in_steps_of(200.0).runs[0].rows.at(1).pose.is_some());
}

#[test]
fn the_same_step_changes_nothing() {
    assert_eq!(logs().in_steps_of(20.0), logs());
}
