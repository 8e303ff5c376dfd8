//! Scripted answers of the ultrasonic sensor for a program that runs in the emulated brick: a list, or a column of a log.

use std::path::Path;

use csv::StringRecord;
use mindgap_controller_export::brick::Sonar;
use mindgap_controller_export::onboard::NO_ECHO_CM;

use mindgap_files::{Records, TextFile};
use mindgap_foundations::error::{Error, Result};

const COLUMN: &str = "echo_cm";

/// Parses readings from a list such as `120,80.5,none,silent`, or from the column `echo_cm` of the CSV file of that name.
///
/// A reading is a distance in cm, 0..=255, which is rounded; `none`, `255` or an empty cell if no echo returned; `silent`
/// if the sensor does not answer; `hangs` if its answer never ends.
///
/// # Errors
/// When the text is neither a list nor a file, or when a reading is invalid.
pub fn read(list_or_file: &str) -> Result<Vec<Sonar>> {
    let path = Path::new(list_or_file);
    if path.is_file() {
        return read_column(path);
    }
    list_or_file.split(',').map(reading).collect::<std::result::Result<_, _>>().map_err(|what| {
        Error::new(format!("--readings {list_or_file:?} is no file, and as a list it has a reading that {what}"))
    })
}

fn read_column(path: &Path) -> Result<Vec<Sonar>> {
    let mut records = Records::new(path, TextFile::open(path)?);
    let column = records.header()?.iter().position(|name| name == COLUMN);
    let column = column.ok_or_else(|| Error::at_line(path, 1, format!("column {COLUMN} is missing")))?;
    let (mut record, mut readings) = (StringRecord::new(), Vec::new());
    while let Some(line) = records.read(&mut record)? {
        let cell = record.get(column).unwrap_or_default();
        let answer = reading(cell).map_err(|what| Error::at_line(path, line, format!("{COLUMN} {what}")))?;
        readings.push(answer);
    }
    Ok(readings)
}

fn reading(word: &str) -> std::result::Result<Sonar, String> {
    match word.trim() {
        "" | "none" => Ok(Sonar::Echo(NO_ECHO_CM)),
        "silent" => Ok(Sonar::Silent),
        "hangs" => Ok(Sonar::Hangs),
        word => match word.parse::<f64>() {
            Ok(cm) if (0.0..=f64::from(NO_ECHO_CM)).contains(&cm) => Ok(Sonar::Echo(libm::round(cm) as u8)),
            Ok(_) => Err(format!("is {word}, outside 0..255 cm")),
            Err(_) => Err(format!("is {word:?}, neither a distance nor none, silent or hangs")),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_says_what_the_sensor_answers() {
        let answers =
            [Sonar::Echo(120), Sonar::Echo(81), Sonar::Echo(255), Sonar::Silent, Sonar::Hangs, Sonar::Echo(0)];
        assert_eq!(read("120, 80.6,none,silent,hangs,0").unwrap(), answers);
    }

    #[test]
    fn what_is_no_reading_is_refused() {
        for (list, what) in [("12,256", "outside"), ("-1", "outside"), ("NaN", "outside"), ("1,far", "neither")] {
            let error = read(list).unwrap_err().to_string();
            assert!(error.contains(what) && error.contains(list), "{error}");
        }
    }
}
