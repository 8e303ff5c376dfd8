//! The emulated brick is compared with `tests/conformance`: programs with the events that the standard firmware gives. The
//! README there explains the format.

use std::fs;

use mindgap_controller_export::brick::{
    self, Drive, EventKind, Level, Press, Program, RunConfig, ScriptedWorld, Sonar, Termination,
};
use mindgap_controller_export::onboard::NO_ECHO_CM;
use mindgap_tests::command::workspace;
use mindgap_tests::nbc::compile;

/// Smallest number of programs in the folder.
const MIN_PROGRAMS: usize = 19;

#[test]
fn programs_behave_as_in_the_firmware() {
    let folder = workspace().join("tests/conformance");
    let files = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    let programs: Vec<_> = files.filter(|path| path.extension().is_some_and(|ending| ending == "nxc")).collect();
    assert!(programs.len() >= MIN_PROGRAMS, "{} programs", programs.len());
    let mut differing = Vec::new();
    for path in programs {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        let source = fs::read_to_string(&path).unwrap();
        let expectation = fs::read_to_string(path.with_extension("events")).expect(&name);
        if let Err(difference) = differs(&compile(&source), &expectation) {
            differing.push(format!("{name}: {difference}"));
        }
    }
    assert!(differing.is_empty(), "{}", differing.join("\n"));
}

/// Runs a program in the world of the expectation and returns the first event that differs.
fn differs(file: &[u8], expectation: &str) -> Result<(), String> {
    let lines = expectation.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
    let (setting, expected): (Vec<&str>, Vec<&str>) =
        lines.partition(|line| ["sonar ", "press ", "level "].iter().any(|kind| line.starts_with(kind)));
    let mut world = ScriptedWorld::sonar([]);
    setting.iter().for_each(|line| set(&mut world, line));
    let report = brick::run(&Program::load(file).unwrap(), &mut world, &RunConfig::default());
    let mut events: Vec<(u32, String)> = report.events.iter().map(|event| (event.t_ms, text_of(&event.kind))).collect();
    let end = if report.end == Termination::Finished { "end finished" } else { "end failed" };
    events.push((report.ended_ms, end.to_owned()));
    for (i, line) in expected.iter().enumerate() {
        let (times, event) = match line.split_once(' ') {
            Some((times, event)) if times.contains("..") => (times.split_once(".."), event),
            _ => (None, *line),
        };
        let times = times.map_or(0..=u32::MAX, |(from, to)| from.parse().unwrap()..=to.parse().unwrap());
        match events.get(i) {
            Some((t_ms, actual)) if actual == event && times.contains(t_ms) => {}
            other => return Err(format!("expected {line}, got {other:?}; {:?}", report.failed_at)),
        }
    }
    if events.len() > expected.len() {
        Err(format!("unexpected further event {:?}", events[expected.len()]))
    } else {
        Ok(())
    }
}

fn set(world: &mut ScriptedWorld, line: &str) {
    let words: Vec<&str> = line.split_whitespace().collect();
    let number = |word: &str| word.parse::<u32>().expect(line);
    match words[..] {
        ["sonar", ..] => {
            let answer = |word: &&str| match *word {
                "none" => Sonar::Echo(NO_ECHO_CM),
                "silent" => Sonar::Silent,
                "hangs" => Sonar::Hangs,
                cm => Sonar::Echo(number(cm) as u8),
            };
            world.sonar = words[1..].iter().map(answer).collect();
        }
        ["press", "orange", down, up] => world.presses.push(Press::orange(number(down), number(up))),
        ["level", port, t_ms, percent] => world.levels.push(Level {
            port: number(port) as usize - 1,
            t_ms: number(t_ms),
            percent: number(percent) as u8,
        }),
        _ => panic!("{line}"),
    }
}

fn text_of(kind: &EventKind) -> String {
    match kind {
        EventKind::Motor { port, drive } => {
            let drive = match drive {
                Drive::Power(power) => power.to_string(),
                Drive::Brake => "brake".to_owned(),
                Drive::Coast => "coast".to_owned(),
            };
            format!("motor {} {drive}", ["A", "B", "C"][*port])
        }
        EventKind::Tone { hz, ms } => format!("tone {hz} {ms}"),
        EventKind::Sound(name) => format!("sound {name:?}"),
        EventKind::Text { text, .. } => format!("text {text:?}"),
    }
}
