//! Consoles in documents: `$ ` and a command, then what it says. `[...]` stands for any lines; of a command below which
//! nothing stands only success is expected.

use std::env;
use std::fs;
use std::ops::Range;
use std::path::PathBuf;
use std::process::Command;

use libtest_mimic::Failed;
use mindgap_tests::command::{Sandbox, program, workspace};
use mindgap_tests::rooms::{SCENE, trained};

use crate::lines::{FENCE, PROMPT, is_run};
use crate::{FROM_NOTHING, is_asked_for};

/// A command in a console.
struct Call<'a> {
    command: &'a str,
    /// The lines of the document that say what it says.
    says: Range<usize>,
}

/// Any lines.
const ANY: &str = "[...]";

/// Runs all consoles of a document in their order in one folder.
pub fn run(name: &str, text: &str) -> Result<(), Failed> {
    let folder = folder_for(name);
    let bin = tempfile::tempdir()?;
    std::os::unix::fs::symlink(program(), bin.path().join("mindgap"))?;
    let others = env::var_os("PATH").unwrap_or_default();
    let paths = [bin.path().to_owned()].into_iter().chain(env::split_paths(&others));
    let path = env::join_paths(paths.collect::<Vec<PathBuf>>())?;
    let lines: Vec<&str> = text.lines().collect();
    let (mut updated, mut differing) = (lines.clone(), Vec::new());
    let mut outputs: Vec<(Range<usize>, String)> = Vec::new();
    for Call { command, says } in calls(&lines) {
        let mut shell = Command::new("sh");
        let output = shell
            .current_dir(folder.path())
            .env("PATH", &path)
            .args(["-c", &format!("({command}\n) 2>&1")])
            .output()?;
        let said = String::from_utf8(output.stdout)?;
        if !output.status.success() {
            return Err(format!("{command}\n{said}").into());
        }
        let is_as_stated = says.is_empty() || is_said(&lines[says.clone()], &said.lines().collect::<Vec<&str>>());
        if !is_as_stated {
            differing.push(format!("$ {command}\n{said}"));
            outputs.push((says, said));
        }
    }
    if is_asked_for("overwrite") {
        for (says, said) in outputs.iter().rev() {
            updated.splice(says.clone(), said.lines());
        }
        fs::write(workspace().join(name), updated.join("\n") + "\n")?;
        return Ok(());
    }
    if differing.is_empty() {
        Ok(())
    } else {
        Err(format!("these say something else:\n{}", differing.join("\n")).into())
    }
}

/// Where a document's commands are run.
fn folder_for(name: &str) -> Sandbox {
    let is_from_nothing = FROM_NOTHING.contains(&name);
    let folder = if is_from_nothing { Sandbox::new() } else { trained() };
    folder.write("scene.toml", SCENE);
    if !is_from_nothing {
        folder.run("record --out held-out --runs 6 --steps 25 --seed 2");
        let controller = fs::read(workspace().join("tests/tests/golden/controller.toml")).expect("a controller");
        folder.write("controller.toml", controller);
    }
    folder
}

fn calls<'a>(lines: &[&'a str]) -> Vec<Call<'a>> {
    let mut calls: Vec<Call> = Vec::new();
    let mut block: Option<&str> = None;
    for (i, line) in lines.iter().enumerate() {
        match (line.strip_prefix(FENCE), block) {
            (Some(_), Some(_)) => block = None,
            (Some(kind), None) => block = Some(kind),
            (None, Some(kind)) if is_run(kind) => match (line.strip_prefix(PROMPT), calls.last_mut()) {
                (Some(command), _) => calls.push(Call { command, says: i + 1..i + 1 }),
                (None, Some(call)) => call.says.end = i + 1,
                (None, None) => (),
            },
            (None, _) => (),
        }
    }
    calls
}

fn is_said(stated: &[&str], said: &[&str]) -> bool {
    match stated.split_first() {
        None => said.is_empty(),
        Some((&ANY, rest)) => (0..=said.len()).any(|skipped| is_said(rest, &said[skipped..])),
        Some((line, rest)) => said
            .split_first()
            .is_some_and(|(first, others)| first.trim_end() == line.trim_end() && is_said(rest, others)),
    }
}
