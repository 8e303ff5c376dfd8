//! `mindgap new`: a folder for a robot of one's own.

use mindgap_logs::{Robot, Scene};
use mindgap_tests::command::Workshop;

#[test]
fn its_files_are_read_and_its_commands_are_those_that_it_prints() {
    let workshop = Workshop::new();
    let said = workshop.done("new mine");
    let folder = workshop.path().join("mine");
    let robot = Robot::read(&folder.join("robot.toml")).expect("a robot");
    assert!(robot.ultrasonic.is_none());
    let scene = Scene::read(&folder.join("scene.toml")).expect("a scene");
    assert!(scene.sides().is_empty());
    assert!(folder.join("recordings").is_dir());
    let commands: Vec<&str> = said.lines().filter_map(|line| line.strip_prefix("  mindgap ")).collect();
    assert_eq!(commands.len(), 3, "{said}");
    let readme = workshop.text("mine/README.md");
    assert!(commands.iter().all(|command| readme.contains(command)), "{readme}");
    assert!(readme.contains("hold each command for ten steps or more"), "{readme}");
}

#[test]
fn nothing_that_is_there_is_touched() {
    let workshop = Workshop::new();
    workshop.done("new mine");
    workshop.write("mine/robot.toml", "my own");
    let refusal = workshop.refused("new mine");
    assert!(refusal.starts_with("mine: holds"), "{refusal}");
    workshop.write("file", "my own");
    assert!(workshop.refused("new file").starts_with("file: "), "{refusal}");
}
