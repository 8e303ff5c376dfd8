//! Further range sensors for logs of the built-in robot, which has one.

use mindgap_built_in_robot::{BuiltInRobot, default_robot};
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::random::generator;
use mindgap_logs::{Logs, Robot, Ultrasonic};

use crate::command::Sandbox;

/// The mounting of a further sensor that points to `yaw_deg`.
const fn mount(yaw_deg: f64) -> Ultrasonic {
    Ultrasonic { x_cm: 0.0, y_cm: 6.0, yaw_deg, min_cm: 4.0, max_cm: 240.0 }
}

/// Adds a further sensor to a folder of logs: the sonar of the built-in robot, which points to `points_deg`, where `robot.toml`
/// says `mounted_deg`.
pub fn add(sandbox: &Sandbox, folder: &str, name: &str, [mounted_deg, points_deg]: [f64; 2]) {
    let logs = Logs::read(&sandbox.path().join(folder), |_| ()).expect("logs");
    let spec = Robot { ultrasonic: Some(mount(points_deg)), ..default_robot() };
    let robot = BuiltInRobot::new(&spec, &logs.scene, &[]);
    let mut random = generator(7, &[]);
    let mut reading = |pose: Pose| robot.start(pose, &mut random).read_sonar(&mut random);
    for run in &logs.runs {
        let readings = run.rows.iter().map(|row| row.pose.and_then(&mut reading));
        let cells = readings.map(|cm| cm.map_or(String::new(), |cm| format!("{cm:.0}")));
        let column: Vec<String> = std::iter::once(format!("echo_{name}_cm")).chain(cells).collect();
        sandbox.edit(&format!("{folder}/{}.csv", run.name), |text| {
            text.lines().zip(&column).map(|(line, cell)| format!("{line},{cell}\n")).collect()
        });
    }
    sandbox.edit(&format!("{folder}/robot.toml"), |text| text + &table(name, mounted_deg));
}

/// Returns the table of a further sensor for `robot.toml`.
pub fn table(name: &str, yaw_deg: f64) -> String {
    let Ultrasonic { x_cm, y_cm, yaw_deg, min_cm, max_cm } = mount(yaw_deg);
    let keys = format!("x_cm = {x_cm}\ny_cm = {y_cm}\nyaw_deg = {yaw_deg}\nmin_cm = {min_cm}\nmax_cm = {max_cm}\n");
    format!("\n[[range_sensor]]\nname = \"{name}\"\n{keys}")
}
