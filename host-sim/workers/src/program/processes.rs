//! The processes of this machine, as `/proc` lists them. Where there is no `/proc`, the list is empty.

use std::fs;

use rustix::process::Pid;

/// A process.
#[derive(Clone, Copy)]
pub struct Process {
    /// Its id.
    pub id: Pid,
    /// Id of its parent; `None` for the first process and those started outside a container.
    pub parent: Option<Pid>,
    /// Id of its process group.
    pub group: Option<Pid>,
    /// Whether it has ended and only its parent has not asked how.
    pub is_dead: bool,
}

/// Lists all processes.
pub fn all() -> Vec<Process> {
    let Ok(entries) = fs::read_dir("/proc") else { return Vec::new() };
    let numbered = entries.flatten().filter(|entry| entry.file_name().as_encoded_bytes()[0].is_ascii_digit());
    numbered.filter_map(|entry| parse(&fs::read_to_string(entry.path().join("stat")).ok()?)).collect()
}

/// Parses `/proc/ID/stat`: id, name in parentheses, which may itself contain any character, state, parent, group.
fn parse(stat: &str) -> Option<Process> {
    let (id, _) = stat.split_once(' ')?;
    let mut fields = stat[stat.rfind(')')? + 1..].split_ascii_whitespace();
    // A process that is just ending has the group -1.
    let id_of = |field: &str| Pid::from_raw(field.parse().ok().filter(|id| *id > 0)?);
    let state = fields.next()?;
    Some(Process {
        id: id_of(id)?,
        parent: id_of(fields.next()?),
        group: id_of(fields.next()?),
        is_dead: matches!(state, "Z" | "X"),
    })
}

/// Returns whether a process descends from another.
pub fn descends(all: &[Process], process: &Process, from: Pid) -> bool {
    let parent_of = |child: &Process| all.iter().find(|process| Some(process.id) == child.parent).copied();
    let mut ancestor = parent_of(process);
    // A list taken while processes end and ids are used again may have a circle.
    for _ in 0..all.len() {
        match ancestor {
            Some(found) if found.id == from => return true,
            Some(found) => ancestor = parent_of(&found),
            None => break,
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_may_contain_anything() {
        let process = parse("12 (a) S 1 (b)) Z 7 12 12 0 -1").expect("a process");
        let ids = [Some(process.id), process.parent, process.group];
        assert_eq!(ids.map(|id| id.map(Pid::as_raw_pid)), [Some(12), Some(7), Some(12)]);
        assert!(process.is_dead && parse("12 (a").is_none());
        assert_eq!(parse("12 (a) X 0 -1 -1").map(|ending| (ending.parent, ending.group)), Some((None, None)));
    }

    #[test]
    fn descent_survives_circles() {
        let id = |number| Pid::from_raw(number).expect("an id");
        let process = |own, parent| Process { id: id(own), parent: Pid::from_raw(parent), group: None, is_dead: false };
        let all = [process(2, 1), process(3, 2), process(4, 3), process(5, 6), process(6, 5)];
        assert!(descends(&all, &all[2], id(2)) && !descends(&all, &all[0], id(2)) && !descends(&all, &all[3], id(2)));
    }
}
