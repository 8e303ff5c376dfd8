//! Files that a program holds are read like files on disk. They are held for the whole process, so this is a test of its own.

use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::time::{Duration, SystemTime};

use mindgap_files::source::{self, Held, hold};
use mindgap_files::{days_written, open, read_text};

const TEXTS: [(&str, &str); 3] =
    [("logs/robot.toml", "track_cm = 15\n"), ("logs/old/run-001.csv", "t_ms\n0\n"), ("sim.json", "{}")];

fn read_at(index: usize, offset: u64, buffer: &mut [u8]) -> usize {
    let rest = TEXTS[index].1.as_bytes().get(offset as usize..).unwrap_or_default();
    let count = rest.len().min(buffer.len());
    buffer[..count].copy_from_slice(&rest[..count]);
    count
}

#[test]
fn held_files_replace_the_disk() {
    let modified = Some(SystemTime::UNIX_EPOCH + Duration::from_secs(86_400));
    let held = |(path, text): &(&str, &str)| Held { path: path.into(), size: text.len() as u64, modified };
    hold(TEXTS.iter().map(held).collect(), read_at);

    assert_eq!(read_text(Path::new("logs/robot.toml")).unwrap(), TEXTS[0].1);
    assert_eq!(source::names(Path::new("logs")).unwrap(), ["old", "robot.toml"]);
    assert_eq!(source::names(Path::new("")).unwrap(), ["logs", "sim.json"]);
    assert!(source::is_folder(Path::new("logs/old")) && !source::is_folder(Path::new("sim.json")));
    assert!(source::is_file(Path::new("sim.json")) && !source::is_file(Path::new("logs")));
    assert_eq!(days_written(&["logs/old".into()]).unwrap().unwrap(), ["1970-01-02", "1970-01-02"]);

    let mut file = open(Path::new("logs/robot.toml")).unwrap();
    file.seek(SeekFrom::End(-3)).unwrap();
    let mut rest = String::new();
    file.read_to_string(&mut rest).unwrap();
    assert_eq!((rest.as_str(), file.size().unwrap()), ("15\n", 14));
    assert!(file.seek(SeekFrom::Current(-15)).is_err());

    let there = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
    assert!(!source::exists(&there) && read_text(&there).is_err());
}
