//! Changes put into held-out real logs: a simulator is trained on some of a robot's runs, others are changed as another
//! robot or tracker would have changed them, and the diagnosis has to name what was put in.

use std::path::Path;

use glam::DVec2;
use mindgap_foundations::geometry::{Pose, wrap_rad};
use mindgap_logs::{Logs, Run};
use mindgap_tests::command::Workshop;
use rand::rngs::SmallRng;
use rand::{RngExt, SeedableRng};
use serde_json::Value;

/// A change, what the diagnosis may call it, and how it changes a run.
struct Injection {
    name: &'static str,
    /// Empty where nothing is changed.
    called: &'static [&'static str],
    change: fn(&mut Run),
}

/// Changes put into the drive of a real robot at 400 ms a step and some 10 cm/s.
const DRIVE: &[Injection] = &[
    Injection { name: "none", called: &[], change: |_| {} },
    Injection { name: "latency of 120 ms", called: &["latency", "inertia"], change: |run| later(run, 120.0) },
    Injection { name: "latency of 240 ms", called: &["latency", "inertia"], change: |run| later(run, 240.0) },
    Injection { name: "7 % less ground", called: &["drive_scale"], change: |run| steps(run, |s, _| s.scale(0.93)) },
    Injection { name: "8 % more ground", called: &["drive_scale"], change: |run| steps(run, |s, _| s.scale(1.08)) },
    Injection {
        name: "turns 10 % smaller",
        called: &["track_width"],
        change: |run| steps(run, |s, _| s.turn_rad *= 0.9),
    },
    Injection {
        name: "turns 8 % larger",
        called: &["track_width"],
        change: |run| steps(run, |s, _| s.turn_rad *= 1.08),
    },
    Injection {
        name: "turns 15 % smaller",
        called: &["track_width"],
        change: |run| steps(run, |s, _| s.turn_rad *= 0.85),
    },
    Injection {
        name: "turns 15 % larger",
        called: &["track_width"],
        change: |run| steps(run, |s, _| s.turn_rad *= 1.15),
    },
    Injection {
        name: "turns cost 4 cm a radian",
        called: &["turn_loss"],
        change: |run| {
            steps(run, |s, _| s.forward_cm -= s.forward_cm.signum() * (4.0 * s.turn_rad.abs()).min(s.forward_cm.abs()))
        },
    },
    Injection {
        name: "left motor 5 % weaker",
        called: &["motor_asymmetry"],
        change: |run| steps(run, |s, _| s.wheels([0.95, 1.0])),
    },
    Injection {
        name: "right motor 7 % weaker",
        called: &["motor_asymmetry"],
        change: |run| steps(run, |s, _| s.wheels([1.0, 0.93])),
    },
    Injection {
        name: "camera turned by 4 degrees",
        called: &["tracker_rotation"],
        change: |run| seen(run, |p| p.heading_rad = wrap_rad(p.heading_rad + 0.07)),
    },
    Injection {
        name: "camera turned by -7 degrees",
        called: &["tracker_rotation"],
        change: |run| seen(run, |p| p.heading_rad = wrap_rad(p.heading_rad - 0.12)),
    },
    Injection {
        name: "camera's scale 6 % too large",
        called: &["tracker_scale"],
        change: |run| seen(run, |p| p.position_cm *= 1.06),
    },
    Injection {
        name: "camera's scale 5 % too small",
        called: &["tracker_scale"],
        change: |run| seen(run, |p| p.position_cm *= 0.95),
    },
    Injection {
        name: "compass off by 8 degrees",
        called: &["compass_disturbance"],
        change: |run| seen(run, |p| p.heading_rad = wrap_rad(p.heading_rad + 0.14 * libm::sin(p.heading_rad - 0.5))),
    },
    Injection {
        name: "compass off by 5 degrees",
        called: &["compass_disturbance"],
        change: |run| seen(run, |p| p.heading_rad = wrap_rad(p.heading_rad + 0.087 * libm::sin(p.heading_rad + 2.0))),
    },
    Injection {
        name: "battery fades by 15 % a minute",
        called: &["battery_sag"],
        change: |run| steps(run, |s, min| s.scale(1.0 - 0.15 * min)),
    },
    Injection {
        name: "battery fades by 25 % a minute",
        called: &["battery_sag"],
        change: |run| steps(run, |s, min| s.scale(1.0 - 0.25 * min)),
    },
    Injection {
        name: "wheels hold below 2 cm/s",
        called: &["deadband"],
        change: |run| steps(run, |s, _| s.each_wheel(|cm| cm.signum() * (cm.abs() - 0.8).max(0.0))),
    },
    Injection {
        name: "wheels end at 8 cm/s",
        called: &["saturation"],
        change: |run| steps(run, |s, _| s.each_wheel(|cm| cm.clamp(-3.2, 3.2))),
    },
    Injection { name: "marker 4 cm behind", called: &["marker_offset"], change: |run| marker(run, -4.0) },
    Injection { name: "marker 3 cm ahead", called: &["marker_offset"], change: |run| marker(run, 3.0) },
    Injection { name: "tracker scatters by 0.6 cm", called: &["scatter"], change: |run| noise(run, 0.6, 0.0) },
    Injection {
        name: "tracker scatters by 1 cm and 3 degrees",
        called: &["scatter"],
        change: |run| noise(run, 1.0, 0.05),
    },
];

/// Changes put into scans of a real sonar from places where it stands still.
const SCANS: &[Injection] = &[
    Injection { name: "none", called: &[], change: |_| {} },
    Injection {
        name: "readings 3 cm longer",
        called: &["sonar_offset"],
        change: |run| echoes(run, |cm, _| Some(cm + 3.0)),
    },
    Injection {
        name: "readings 4 cm shorter",
        called: &["sonar_offset"],
        change: |run| echoes(run, |cm, _| Some(cm - 4.0)),
    },
    Injection {
        name: "readings 8 % longer",
        called: &["sonar_scale"],
        change: |run| echoes(run, |cm, _| Some(1.08 * cm)),
    },
    Injection {
        name: "readings 7 % shorter",
        called: &["sonar_scale"],
        change: |run| echoes(run, |cm, _| Some(0.93 * cm)),
    },
    // Of a robot that stands still, a sensor that looks elsewhere is a heading that is wrong.
    Injection {
        name: "sensor turned by 8 degrees",
        called: &["sonar_yaw", "tracker_rotation"],
        change: |run| seen(run, |p| p.heading_rad = wrap_rad(p.heading_rad - 0.14)),
    },
    Injection {
        name: "sensor turned by -12 degrees",
        called: &["sonar_yaw", "tracker_rotation"],
        change: |run| seen(run, |p| p.heading_rad = wrap_rad(p.heading_rad + 0.21)),
    },
    Injection { name: "a ghost at 35 cm", called: &["sonar_ghost"], change: |run| ghost(run, 35.0, 0.1) },
    Injection { name: "a ghost at 60 cm", called: &["sonar_ghost"], change: |run| ghost(run, 60.0, 0.15) },
    Injection { name: "15 % of the readings lost", called: &["sonar_dropout"], change: |run| bursts(run, 0.15) },
    Injection { name: "30 % of the readings lost", called: &["sonar_dropout"], change: |run| bursts(run, 0.3) },
    Injection {
        name: "readings scatter by 4 cm",
        called: &["sonar_noise"],
        change: |run| echoes(run, |cm, rng| Some(cm + 4.0 * normal(rng))),
    },
    Injection {
        name: "readings scatter by 7 cm",
        called: &["sonar_noise"],
        change: |run| echoes(run, |cm, rng| Some(cm + 7.0 * normal(rng))),
    },
];

/// Nothing is where nothing was changed, no wrong name is sure, and nine of ten changes are named first: in the runs of one
/// third, and in those of all, each by what the others taught. What a third drives that the others hardly do, as spins, its
/// simulator does not know.
pub fn changes_of_a_real_drive_are_named(folder: &Path) {
    let logs = Logs::read(folder, |_| ()).expect("logs");
    let part = |third: usize, held_out: bool| {
        let runs = logs.runs.iter().enumerate().filter(|(i, _)| (i % 3 == third) == held_out);
        Logs { runs: runs.map(|(_, run)| run.clone()).collect(), ..logs.clone() }
    };
    let thirds = [0, 1, 2].map(|third| judged(&part(third, false), &part(third, true), DRIVE));
    enough(thirds[2]);
    enough(thirds.into_iter().reduce(|[named, asked], [n, a]| [named + n, asked + a]).expect("thirds"));
}

/// The same of a sonar that stands still: three of the five scans from each place are learned from.
pub fn changes_of_a_real_sonar_that_stands_still_are_named(folder: &Path) {
    let logs = Logs::read(folder, |_| ()).expect("logs");
    let part = |held_out: bool| {
        let runs = logs.runs.iter().enumerate().filter(|(i, _)| (i % 5 >= 3) == held_out).map(|(_, run)| run.clone());
        Logs { runs: runs.collect(), ..logs.clone() }
    };
    enough(judged(&part(false), &part(true), SCANS));
}

/// Nine of ten are named first.
fn enough([named, asked]: [usize; 2]) {
    assert!(10 * named >= 9 * asked, "{named} of {asked}");
}

/// How many changes are named first, of how many.
fn judged(training: &Logs, held_out: &Logs, injections: &[Injection]) -> [usize; 2] {
    let workshop = Workshop::new();
    training.write(&workshop.path().join("training")).expect("a folder");
    workshop.done("train training --out sim.json");
    let (mut named, mut asked) = (0, 0);
    let mut wrong = Vec::new();
    for (number, injection) in injections.iter().enumerate() {
        let mut changed = held_out.clone();
        changed.runs.iter_mut().for_each(injection.change);
        let place = format!("changed-{number}");
        changed.write(&workshop.path().join(&place)).expect("a folder");
        workshop.done(&format!("diagnose sim.json {place} --json {place}.json"));
        let diagnosis = workshop.json(&format!("{place}.json"));
        let effects = diagnosis["effects"].as_array().expect("a list");
        let first = effects.first().and_then(|effect| effect["id"].as_str());
        let probability = effects.first().and_then(|effect| effect["probability"].as_f64()).unwrap_or(0.0);
        println!("{}: {} {}", injection.name, diagnosis["verdict"], told(effects));
        if injection.called.is_empty() {
            if diagnosis["verdict"] != "no_gap" {
                wrong.push(format!("{}: {}", injection.name, diagnosis["verdict"]));
            }
            continue;
        }
        asked += 1;
        match first {
            Some(id) if injection.called.contains(&id) => named += 1,
            Some(id) if probability > 0.9 => wrong.push(format!("{}: {id} with {probability}", injection.name)),
            _ => {}
        }
    }
    println!("{named} of {asked} named first");
    assert!(wrong.is_empty(), "{wrong:#?}");
    [named, asked]
}

fn told(effects: &[Value]) -> String {
    let one = |effect: &Value| format!("{} {} {}", effect["id"], effect["probability"], effect["parameters"]);
    effects.iter().map(one).collect::<Vec<_>>().join(", ")
}

/// A step as its wheels make it.
struct Step {
    forward_cm: f64,
    lateral_cm: f64,
    turn_rad: f64,
}

/// Distance between the wheels, cm: half of what a turn takes is theirs.
const TRACK_CM: f64 = 23.5;

impl Step {
    fn scale(&mut self, factor: f64) {
        (self.forward_cm, self.lateral_cm, self.turn_rad) =
            (factor * self.forward_cm, factor * self.lateral_cm, factor * self.turn_rad);
    }

    fn wheels(&mut self, factors: [f64; 2]) {
        let mut wheel = 0;
        self.each_wheel(|cm| {
            wheel += 1;
            factors[wheel - 1] * cm
        });
    }

    /// Changes what the left and then the right wheel cover.
    fn each_wheel(&mut self, mut change: impl FnMut(f64) -> f64) {
        let half_cm = 0.5 * TRACK_CM * self.turn_rad;
        let left_cm = change(self.forward_cm - half_cm);
        let right_cm = change(self.forward_cm + half_cm);
        (self.forward_cm, self.turn_rad) = (0.5 * (left_cm + right_cm), (right_cm - left_cm) / TRACK_CM);
    }
}

/// Drives every step anew, changed; `change` is given the time since the run began, minutes.
fn steps(run: &mut Run, change: impl Fn(&mut Step, f64)) {
    let begin_ms = run.rows.at(0).t_ms;
    let poses: Vec<Option<Pose>> = run.rows.iter().map(|row| row.pose).collect();
    let mut here = poses[0];
    for i in 1..poses.len() {
        let (Some(from), Some(to)) = (poses[i - 1], poses[i]) else {
            here = poses[i];
            continue;
        };
        let moved = from.relative(&to);
        let mut step =
            Step { forward_cm: moved.position_cm.x, lateral_cm: moved.position_cm.y, turn_rad: moved.heading_rad };
        change(&mut step, (run.rows.at(i - 1).t_ms - begin_ms) / 60_000.0);
        here = Some(here.unwrap_or(from).compose(&Pose::new(step.forward_cm, step.lateral_cm, step.turn_rad)));
        run.rows.edit(i, |row| row.pose = here);
    }
}

/// Changes every pose as the tracker sees it.
fn seen(run: &mut Run, change: impl FnMut(&mut Pose)) {
    run.rows.edit_poses(change);
}

/// The robot is where it was so long ago.
fn later(run: &mut Run, ms: f64) {
    let poses: Vec<Option<Pose>> = run.rows.iter().map(|row| row.pose).collect();
    for i in 0..poses.len() {
        let (Some(here), Some(before)) = (poses[i], poses[i.saturating_sub(1)]) else { continue };
        let step_ms = run.rows.at(i).t_ms - run.rows.at(i.saturating_sub(1)).t_ms;
        let share = if step_ms > 0.0 { ms / step_ms } else { 0.0 };
        let turn_rad = wrap_rad(before.heading_rad - here.heading_rad);
        let late = Pose {
            position_cm: here.position_cm.lerp(before.position_cm, share),
            heading_rad: wrap_rad(here.heading_rad + share * turn_rad),
        };
        run.rows.edit(i, |row| row.pose = Some(late));
    }
}

/// The tracked marker sits ahead of the axle's middle.
fn marker(run: &mut Run, ahead_cm: f64) {
    seen(run, |pose| pose.position_cm += ahead_cm * pose.direction());
}

/// The tracker scatters.
fn noise(run: &mut Run, cm: f64, rad: f64) {
    let mut rng = generator(run);
    seen(run, |pose| {
        pose.position_cm += cm * DVec2::new(normal(&mut rng), normal(&mut rng));
        pose.heading_rad = wrap_rad(pose.heading_rad + rad * normal(&mut rng));
    });
}

/// Changes every reading, given in whole centimetres.
fn echoes(run: &mut Run, change: impl Fn(f64, &mut SmallRng) -> Option<f64>) {
    let mut rng = generator(run);
    run.rows.edit_each(|row| {
        row.echo_cm = row.echo_cm.and_then(|cm| change(cm, &mut rng)).map(|cm| cm.max(0.0).round());
    });
}

/// Now and then one wrong reading.
fn ghost(run: &mut Run, cm: f64, probability: f64) {
    echoes(run, |right_cm, rng| Some(if rng.random::<f64>() < probability { cm } else { right_cm }));
}

/// Readings fail for five rows in a row on average.
fn bursts(run: &mut Run, share: f64) {
    let begins = 0.2 * share / (1.0 - share);
    let mut rng = generator(run);
    let mut fails = false;
    run.rows.edit_each(|row| {
        fails = rng.random::<f64>() < if fails { 0.8 } else { begins };
        row.echo_cm = row.echo_cm.filter(|_| !fails);
    });
}

fn generator(run: &Run) -> SmallRng {
    SmallRng::seed_from_u64(run.rows.len() as u64 + run.name.bytes().map(u64::from).sum::<u64>())
}

/// The sum of twelve uniform draws is nearly normal.
fn normal(rng: &mut SmallRng) -> f64 {
    (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0
}
