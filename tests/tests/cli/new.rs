//! `mindgap new`: a folder for the user's own robot.

use mindgap_logs::{Robot, Scene};
use mindgap_tests::command::Sandbox;

#[test]
fn a_new_folder_is_readable_and_lists_its_commands() {
    let sandbox = Sandbox::new();
    let said = sandbox.run("new mine");
    let folder = sandbox.path().join("mine");
    let robot = Robot::read(&folder.join("robot.toml")).expect("a robot");
    assert!(robot.ultrasonic.is_none());
    let scene = Scene::read(&folder.join("scene.toml")).expect("a scene");
    assert!(scene.sides().is_empty());
    assert!(folder.join("recordings").is_dir());
    let commands: Vec<&str> = said.lines().filter_map(|line| line.strip_prefix("  mindgap ")).collect();
    assert_eq!(commands.len(), 3, "{said}");
    let readme = sandbox.text("mine/README.md");
    assert!(commands.iter().all(|command| readme.contains(command)), "{readme}");
    assert!(readme.contains("hold each command for ten steps or more"), "{readme}");
}

#[test]
fn existing_files_are_not_touched() {
    let sandbox = Sandbox::new();
    sandbox.run("new mine");
    sandbox.write("mine/robot.toml", "my own");
    let refusal = sandbox.refused("new mine");
    assert!(refusal.starts_with("mine: already contains"), "{refusal}");
    sandbox.write("file", "my own");
    assert!(sandbox.refused("new file").starts_with("file: "), "{refusal}");
}
