//! A script of what a program in the emulated brick meets beside the ultrasonic sensor: touch, light and sound, and
//! buttons that somebody presses.

use std::path::Path;

use csv::StringRecord;
use mindgap_controller_export::brick::{Level, Press};

use mindgap_files::{self as files, Records, TextFile};
use mindgap_foundations::error::{Error, Result};

const TIME: &str = "t_ms";
/// Columns of the sensor ports, and of the buttons by their numbers.
const PORTS: [&str; 4] = ["port_1", "port_2", "port_3", "port_4"];
const BUTTONS: [(&str, u8); 3] = [("right", 1), ("left", 2), ("orange", 3)];

/// What sensors sense and which buttons are down, by time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorldScript {
    /// Levels of touch, light and sound sensors.
    pub levels: Vec<Level>,
    /// Presses of buttons.
    pub presses: Vec<Press>,
}

/// The names of all columns that a script may have.
fn all_columns() -> impl Iterator<Item = &'static str> {
    [TIME].into_iter().chain(PORTS).chain(BUTTONS.map(|(button, _)| button))
}

/// Reads a script: a CSV file with the column `t_ms` and any of `port_1` to `port_4` (percent; a touch sensor is pressed
/// at more than 0), `right`, `left` and `orange` (1 while the button is down). A row holds until the next; an empty cell
/// changes nothing.
///
/// # Errors
/// When the file cannot be read, or has another column or an invalid number.
pub fn read(path: &Path) -> Result<WorldScript> {
    let mut records = Records::new(path, TextFile::open(path)?);
    let header = records.header()?;
    if !header.iter().any(|name| name == TIME) {
        return Err(Error::at_line(path, 1, format!("column {TIME} is missing")));
    }
    if let Some(name) = header.iter().find(|name| all_columns().all(|known| known != *name)) {
        let meant = files::did_you_mean(name, all_columns());
        return Err(Error::at_line(path, 1, format!("column {name:?} is not known{meant}")));
    }
    let mut script = WorldScript::default();
    let mut last_ms = None;
    let mut down_since = [None; BUTTONS.len()];
    let mut record = StringRecord::new();
    while let Some(line) = records.read(&mut record)? {
        let wrong = |what: String| Error::at_line(path, line, what);
        let number = |name: &str, most: u32| {
            let cell = header.iter().zip(&record).find(|(column, _)| *column == name).map_or("", |(_, cell)| cell);
            match cell {
                "" => Ok(None),
                cell => match cell.parse() {
                    Ok(value) if value <= most => Ok(Some(value)),
                    _ => Err(wrong(format!("{name} = {cell:?} is no whole number of 0..{most}"))),
                },
            }
        };
        let t_ms = number(TIME, u32::MAX)?.ok_or_else(|| wrong(format!("{TIME} is empty")))?;
        if last_ms.is_some_and(|last_ms| t_ms <= last_ms) {
            return Err(wrong(format!("{TIME} = {t_ms} does not come after the row before")));
        }
        last_ms = Some(t_ms);
        for (port, name) in PORTS.iter().enumerate() {
            if let Some(percent) = number(name, 100)? {
                script.levels.push(Level { port, t_ms, percent: percent as u8 });
            }
        }
        for ((name, button), since) in BUTTONS.iter().zip(&mut down_since) {
            match (number(name, 1)?, *since) {
                (Some(1), None) => *since = Some(t_ms),
                (Some(0), Some(down_ms)) => {
                    script.presses.push(Press { button: *button, down_ms, up_ms: t_ms });
                    *since = None;
                }
                _ => {}
            }
        }
    }
    for ((_, button), since) in BUTTONS.iter().zip(down_since) {
        script.presses.extend(since.map(|down_ms| Press { button: *button, down_ms, up_ms: u32::MAX }));
    }
    Ok(script)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Result<WorldScript> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("world.csv");
        std::fs::write(&path, text).unwrap();
        read(&path)
    }

    #[test]
    fn rows_hold_until_the_next() {
        let script = of("t_ms,port_1,orange\n0,0,\n500,1,1\n700,,0\n900,,1\n").unwrap();
        let levels = [Level { port: 0, t_ms: 0, percent: 0 }, Level { port: 0, t_ms: 500, percent: 1 }];
        assert_eq!(script.levels, levels);
        assert_eq!(script.presses, [Press::orange(500, 700), Press::orange(900, u32::MAX)]);
    }

    #[test]
    fn what_is_no_script_is_refused_with_its_line() {
        for (text, what) in [
            ("port_1\n1\n", "world.csv:1: column t_ms is missing"),
            ("t_ms,port_5\n0,1\n", "world.csv:1: column \"port_5\" is not known"),
            ("t_ms,port_1\n0,1\n0,2\n", "world.csv:3: t_ms = 0 does not come after"),
            ("t_ms,port_1\n0,101\n", "world.csv:2: port_1 = \"101\" is no whole number of 0..100"),
            ("t_ms,left\n,1\n", "world.csv:2: t_ms is empty"),
        ] {
            let error = of(text).unwrap_err().to_string();
            assert!(error.contains(what), "{error}");
        }
    }
}
